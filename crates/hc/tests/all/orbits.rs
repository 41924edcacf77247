//! Families with several orbits, solutions that no parameter moves, and solutions that are multiple for all
//! parameters. Their numbers follow from how the equations are made.

use hc::family::{Multiple, Stopped};
use hc::poly::Complex64;
use hc::{Family, FamilyError, Fibre, Monodromy, MonodromyOptions};

/// A family, the number of its regular solutions, and the multiplicities of the others.
struct Kind {
    family: Family,
    count: usize,
    multiplicities: Vec<usize>,
}

fn kind(unknowns: &str, parameters: &str, equations: &str, count: usize, multiplicities: &[usize]) -> Kind {
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let equations: Vec<&str> = equations.split(';').collect();
    let family = Family::from_formulas(&words(unknowns), &words(parameters), &equations).unwrap();
    Kind { family, count, multiplicities: multiplicities.to_vec() }
}

/// Members of each kind with other degrees and numbers.
fn kinds(k: usize) -> Vec<Kind> {
    let (d, e) = (2 + k % 3, 1 + k % 2);
    let (far, scale) = (10 * 10usize.pow(k as u32 % 4), 10usize.pow(2 * (k as u32 % 4)));
    let mut kinds = Vec::new();
    let mut add = |unknowns: &str, parameters: &str, equations: String, count: usize, multiplicities: &[usize]| {
        kinds.push(kind(unknowns, parameters, &equations, count, multiplicities));
    };
    // Several orbits: factors with parameters of their own; the same with some far away.
    add("x", "a b c", format!("(x^{d} - a*x - c)*(x^{e} - b)"), d + e, &[]);
    add("x", "a b", format!("(x^{d} - a)*((x - {far})^{e} - b)"), d + e, &[]);
    // Lines and conics: of each pair of factors as many points as the product of their degrees, but for x*y = a,
    // which meets the parabola in three points besides one at infinity, and each line in two or, x + y = b and
    // x - y = c, in one.
    add("x y", "a b c", format!("(x*y - a)*(x + y - b); (x - y - c)*(x^2 + y - a - {far})"), 2 + 3 + 1 + 2, &[]);
    // Solutions that no parameter moves, zero and others.
    add("x", "a b", format!("x*(x^{d} - a*x - b)"), 1 + d, &[]);
    add("x", "a b", format!("(x - {d})*(x^2 + {e})*(x^{d} - a*x + b)"), 3 + d, &[]);
    add("x y", "a b", format!("x^{d} - a*y; b*x - y"), d, &[]);
    // Two species that compete, each of which may be absent.
    add("x y", "a b c d e f", "x*(a + b*x + c*y); y*(d + e*x + f*y)".to_owned(), 4, &[]);
    // Multiple for all parameters, moved by them and not.
    add("x", "a", format!("(x - {e})^{d}*(x^{d} - a)"), d, &[d]);
    add("x", "a b", format!("(x - a)^{d}*(x^{e} - b)"), e, &[d]);
    add("x y", "a b", "x^2 - a*x; y^2 - b*x".to_owned(), 2, &[2]);
    // Sheets that nearly part.
    add("x", "a b", format!("((x - {far})^2 - a)*(x^2 - b) - 1/100"), 4, &[]);
    // Scales that differ.
    add("x y", "a b", format!("(x^{d} - a/{scale})*(x - {scale}*b); x*y - 1"), d + 1, &[]);
    // More equations than unknowns, of which the last follows from the others.
    add("x y", "a b", format!("x^{d} - a; x*y - b; a*y^{d} - b^{d}"), d, &[]);
    // A stated symmetry, with orbits of two, and with zero besides.
    for (equation, count) in [(format!("x^{} + a*x^2 + b", 2 * d), 2 * d), (format!("x*(x^{} - a)", 2 * e), 1 + 2 * e)]
    {
        let symmetric = hc::poly::Family::from_formulas(&["x"], &["a", "b"], &[equation]).unwrap();
        let family = Family::new(symmetric.with_symmetry(&["-x"]).unwrap()).unwrap();
        kinds.push(Kind { family, count, multiplicities: Vec::new() });
    }
    kinds
}

fn sorted(multiple: &[Multiple]) -> Vec<usize> {
    let mut all: Vec<usize> = multiple.iter().map(|m| m.multiplicity).collect();
    all.sort_unstable();
    all
}

fn search(family: &Family, seed: u64) -> Monodromy {
    family.monodromy(&MonodromyOptions::new().seed(seed)).unwrap()
}

#[test]
fn fibres_have_all_orbits_or_are_said_to_be_in_doubt() {
    let (mut all, mut whole) = (0, 0);
    for k in 0..4 {
        for (number, kind) in kinds(k).iter().enumerate() {
            for seed in 0..2 {
                let found = search(&kind.family, seed);
                let words = format!("kind {number}, {k}, seed {seed}: {} {}", kind.family.system(), found.stopped);
                all += 1;
                assert_eq!(found.orbits.iter().sum::<usize>(), found.fibre.len(), "{words}");
                if found.stopped.is_complete() {
                    assert_eq!(found.fibre.len(), kind.count, "{words}");
                    assert_eq!(sorted(&found.multiple), kind.multiplicities, "{words}");
                    whole += 1;
                }
            }
        }
    }
    assert!(20 * whole >= 19 * all, "{whole} of {all}");
}

/// Three oscillators: four states in which each is in phase with the others or opposite, whatever the couplings, and
/// two that move with these. A parametron: at rest, and four more.
#[test]
fn oscillators_have_states_that_no_parameter_moves() {
    let kuramoto = "k12*y2 + k23*(x3*y2 - x2*y3); k13*y3 + k23*(x2*y3 - x3*y2); x2^2 + y2^2 - 1; x3^2 + y3^2 - 1";
    let parametron = "u*(u^2 + v^2) + (1 - w^2 - l)*u + g*w*v; v*(u^2 + v^2) + (1 - w^2 + l)*v - g*w*u";
    for (kind, orbits) in [
        (kind("x2 x3 y2 y3", "k12 k13 k23", kuramoto, 6, &[]), vec![2, 1, 1, 1, 1]),
        (kind("u v", "w g l", parametron, 5, &[]), vec![4, 1]),
    ] {
        for seed in 0..5 {
            let found = search(&kind.family, seed);
            assert_eq!((found.fibre.len(), found.stopped), (kind.count, Stopped::Trace), "{seed}");
            assert_eq!(found.orbits, orbits, "{seed}");
        }
    }
}

/// Solutions that vanish are zero to the last bit, each is listed once, and they are tracked like others.
#[test]
fn the_origin_is_listed_once() {
    let Kind { family, .. } = kind("x y", "a b", "x^2 - a*y; b*x - y", 2, &[]);
    for seed in 0..10 {
        let found = search(&family, seed);
        assert_eq!((found.stopped, found.fibre.len()), (Stopped::Trace, 2), "{seed}");
        let zeros = found.fibre.iter().filter(|x| x.iter().all(|z| *z == Complex64::default())).count();
        assert_eq!(zeros, 1, "{seed}");
        let at = &family.track(&found.fibre, &[[2.0, 3.0]]).run().unwrap()[0];
        let mut real: Vec<Vec<f64>> = at.real_solutions().collect();
        real.sort_by(|x, y| x[0].total_cmp(&y[0]));
        assert_eq!((real.len(), at.paths.failed), (2, 0), "{seed}");
        assert!(real[0] == [0.0, 0.0] && (real[1][0] - 6.0).abs() < 1e-12 && (real[1][1] - 18.0).abs() < 1e-12);
    }
}

/// Quotients of unknowns have no start system: that orbits are whole is then all that is known.
#[test]
fn orbits_that_are_not_excluded_are_said() {
    let Kind { family, .. } = kind("x y", "a b c", "x/y - a; (y^2 - b)*(y - c)", 3, &[]);
    let found = search(&family, 1);
    assert_eq!((found.stopped, found.stopped.is_complete()), (Stopped::OrbitsWhole, false));
    assert_eq!((found.stopped.others(), found.fibre.is_partial), ("not excluded", true));
    let known = family.monodromy(&MonodromyOptions::new().roots(3)).unwrap();
    assert_eq!((known.fibre.len(), known.stopped), (3, Stopped::RootsReached));
}

/// Newton's method in unknowns and parameters is drawn to the double solutions, which a small change of `a` leads to.
#[test]
fn double_solutions_do_not_hide_the_others() {
    let equations = "((x + 2*y) - 13*a - 10)^2*((x + 2*y)^2 + 19*b*(x + 2*y) - 23); y^3 - 20*(x + 2*y) - b + 4";
    let Kind { family, .. } = kind("x y", "a b", equations, 6, &[2, 2, 2]);
    for seed in 0..3 {
        let found = search(&family, seed);
        assert_eq!(
            (found.fibre.len(), found.stopped, sorted(&found.multiple)),
            (6, Stopped::Trace, vec![2, 2, 2]),
            "{seed}"
        );
    }
}

/// A line that moves is a component; a line and a conic meet in two points besides.
#[test]
fn points_of_a_component_are_no_solutions() {
    let line = "(9*a + 14*(x + 3*y) + 25*y + 1)";
    let conic = "12*(x + 3*y)^2 - 8*(x + 3*y)*y - 12*y^2 + 12*(x + 3*y) - 16*y - 19";
    let equations = format!("{line}*(12*(x + 3*y) - 13*y + 22*a - 25*b + 16); {line}*({conic})");
    let Kind { family, .. } = kind("x y", "a b", &equations, 2, &[]);
    for seed in [1, 4, 7] {
        let found = search(&family, seed);
        assert_eq!((found.fibre.len(), found.stopped), (2, Stopped::Trace), "{seed}");
    }
}

/// From a first solution in each orbit.
#[test]
fn one_component_is_what_loops_join() {
    let Kind { family, .. } = kind("x", "a b", "(x^3 - a*x - 1)*(x^2 - b)*(x - 7)", 6, &[]);
    let parameters = [Complex64::new(0.3, 0.8), Complex64::new(-0.5, 0.6)];
    let all = family.complete(&search(&family, 0).fibre, &MonodromyOptions::new()).unwrap();
    assert_eq!((all.fibre.len(), all.orbits), (6, vec![3, 2, 1]));
    let root = parameters[1].sqrt();
    let cubic = (0..20).fold(Complex64::new(1.0, 0.1), |x, _| {
        x - (x * x * x - parameters[0] * x - 1.0) / (3.0 * x * x - parameters[0])
    });
    for (x, size) in [(cubic, 3), (root, 2), (Complex64::new(7.0, 0.0), 1)] {
        let first = Fibre::new(parameters.to_vec(), 1, vec![x]);
        let found = family.complete(&first, &MonodromyOptions::new().only_component(true)).unwrap();
        assert_eq!((found.fibre.len(), found.stopped, found.orbits), (size, Stopped::ComponentWhole, vec![size]));
    }
}

/// A hyperbola and a circle: (1, 2), and points that are not on them, to one of which Newton's method leads (1, 3).
#[test]
fn first_solutions_are_refined_or_refused() {
    let Kind { family, .. } = kind("x y", "a b", "x^2 + y^2 - a; x*y - b", 4, &[]);
    let of = |x: f64, y: f64, a: f64, b: f64| {
        let numbers = |z: [f64; 2]| z.map(Complex64::from).to_vec();
        family.complete(&Fibre::new(numbers([a, b]), 2, numbers([x, y])), &MonodromyOptions::new())
    };
    let found = of(1.001, 1.999, 5.0, 2.0).unwrap();
    assert_eq!((found.fibre.len(), found.stopped), (4, Stopped::Trace));
    assert!(found.fibre.iter().all(|x| (x[0] * x[1] - 2.0).norm() < 1e-14));
    assert!(matches!(of(1.0, 3.0, 5.0, 2.0), Err(FamilyError::FirstSolution { solution: 1, .. })));
    for (x, y) in [(1.0, 1.0), (0.0, 0.0), (f64::NAN, 1.0), (1e300, -1e300)] {
        let refused = of(x, y, 2.0, 1.0);
        assert!(
            matches!(refused, Err(FamilyError::FirstSingular { .. } | FamilyError::FirstSolution { .. })),
            "{x} {y}: {refused:?}"
        );
    }
}
