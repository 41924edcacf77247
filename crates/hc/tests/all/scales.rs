//! Families whose parameters enter on scales from 1e-7 to 1e7.

#[path = "../../examples/scaled_families/families.rs"]
mod families;

use families::{FAMILIES, Outcome};

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
