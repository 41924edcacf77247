//! Families whose parameters enter on scales from 1e-7 to 1e7.

#[path = "../../examples/scaled_families/families.rs"]
mod families;

use families::{FAMILIES, Outcome};
use hc::family::Stopped;
use hc::{Family, MonodromyOptions};

/// The example `scaled_families` takes more scales and seeds.
#[test]
fn a_fibre_is_whole_or_said_to_be_unsettled() {
    const FACTORS: [&str; 5] = ["1e-7", "1e-4", "1", "1e4", "1e7"];
    let mut whole = 0;
    for family in &FAMILIES {
        for factor in FACTORS {
            let outcome = family.outcome(factor, 0);
            assert!(!matches!(outcome, Outcome::False(_)), "{} {factor} {outcome:?}", family.family(factor));
            whole += usize::from(outcome == Outcome::Whole);
        }
    }
    // Nearly always whole.
    assert!(100 * whole >= 95 * FAMILIES.len() * FACTORS.len(), "{whole}");
}

/// Six sheets of which one nearly parts from the others, at parameters of size one: branch points lie
/// at 1e-9.
#[test]
fn sheets_that_nearly_part() {
    let family = families::Scaled { unknowns: &["x"], equations: &["x^6 - S*a*x - 1"], count: 6 };
    for seed in 0..5 {
        assert_eq!(family.outcome("1e9", seed), Outcome::Whole, "{seed}");
    }
}

/// A cubic, the three roots of which the family states, and a line that its equation has besides: whichever the
/// first pair lies on, the fibre is that of the cubic. Where the number is that of both, so is the fibre.
#[test]
fn a_first_pair_that_is_not_counted() {
    let of = |roots: usize| -> Family {
        let equation = "(x^3 - a*x - c)*(x - b)";
        let text = format!(
            "name = 'both'\nunknowns = ['x']\nparameters = ['a', 'b', 'c']\nequations = ['{equation}']\nroots = {roots}\n"
        );
        text.parse().unwrap()
    };
    let (three, four) = (of(3), of(4));
    let mut beside = 0;
    for seed in 0..16 {
        let options = MonodromyOptions::new().seed(seed);
        let found = three.monodromy(&options).unwrap();
        assert_eq!((found.fibre.len(), found.stopped), (3, Stopped::RootsReached), "{seed}");
        let [a, b, c] = found.fibre.parameters[..] else { panic!() };
        for x in found.fibre.iter() {
            assert!((x[0].powu(3) - a * x[0] - c).norm() < 1e-9 && (x[0] - b).norm() > 1e-9, "{seed}");
        }
        let found = four.monodromy(&options).unwrap();
        assert_eq!((found.fibre.len(), found.stopped), (4, Stopped::RootsReached), "{seed}");
        beside += usize::from((found.fibre.solution(0)[0] - b).norm() < 1e-9);
    }
    // The first pair is the same for both families; some lie on the line and some on the cubic.
    assert!((1..16).contains(&beside), "{beside}");
}
