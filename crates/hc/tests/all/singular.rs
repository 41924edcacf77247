//! Ends that are not regular, and systems that hide their solutions: right, or said to be unknown.
//!
//! What is expected is known by hand: factors, intersection numbers, Chebyshev's polynomials, roots
//! of unity.

use crate::common::{multiplicities, options, real, solve_text, solved};
use hc::Solutions;
use hc::poly::Complex64;

/// From some seeds: multiplicities, the number of real solutions, and whether there is a component.
fn check(text: &str, seeds: u64, expected: &str, expected_real: usize, component: bool) {
    for seed in 0..seeds {
        let found = solve_text(text, &options(seed)).unwrap();
        assert_eq!(
            (&multiplicities(&found)[..], real(&found), found.on_components > 0, found.paths.failed),
            (expected, expected_real, component, 0),
            "{text} {seed}"
        );
        assert!(found.solutions.iter().all(|s| s.residual < 1e-12), "{text} {seed}: {found}");
    }
}

fn has(found: &Solutions, point: &[f64], tolerance: f64) -> bool {
    let near = |value: &[Complex64]| value.iter().zip(point).all(|(z, p)| (z - p).norm() < tolerance);
    found.solutions.iter().any(|s| near(&s.value))
}

#[test]
fn overdetermined_with_a_zero_coordinate() {
    check("3 2\nx*y;\nx-1;\ny*(x+2);", 20, "1x1", 1, false);
    check("4 3\nx*y;\nx*z;\nx^2-1;\ny^2-z;", 20, "2x1", 2, false);
    // And two lines: x = y = 0 and x = y - z = 0.
    check("4 3\nx*y;\nx*z;\nx*(x-1);\ny*(y-z);", 12, "1x1", 1, true);
}

#[test]
fn components_that_are_not_reduced() {
    // (-1/2, 3/2) and a line.
    check("2\nx^2*(x+y-1);\nx^2*(x-y+2);", 10, "1x1", 1, true);
    check("2\n(x-y)^2*(x+y-1);\n(x-y)^2*(x+2*y+2);", 10, "1x1", 1, true);
}

/// `y^20 = 1` and `x = 2 y^2 + 1`, beside the line `x = 0`.
#[test]
fn beside_a_line_of_solutions() {
    check("2\ny^20*x-x;\nx*(x-2*y^2-1);", 16, "20x1", 2, true);
}

#[test]
fn ends_that_solve_nothing() {
    let sum: Vec<String> = (0..=150).map(|k| format!("x^{k}")).collect();
    check(&format!("1\n{};", sum.join("+")), 2, "150x1", 0, false);
}

/// `y^10 = x^2 + 1` and `y^3 = 2 x^-20`: then `x^200 (x^2 + 1)^3 = 2^10`, and
/// `y = (x^2 + 1) x^60 / 8`.
#[test]
fn sparse_of_high_degree() {
    check("2\nx^20*y^3-2;\nx^2-y^10+1;", 2, "206x1", 2, false);
}

#[test]
fn badly_conditioned_in_one_unknown() {
    // T_50 = 2 T_25^2 - 1, T_25 = T_5 (T_5).
    let t5 = |x: &str| format!("(16*{x}^5-20*{x}^3+5*{x})");
    let chebyshev = format!("1\n2*{}^2-1;", t5(&t5("x")));
    check(&chebyshev, 1, "50x1", 50, false);
    let factors: Vec<String> = (1..=16).map(|k| format!("(x-{k})")).collect();
    check(&format!("1\n{};", factors.join("*")), 1, "16x1", 16, false);
    check("1\nx^2-2*x+1-1E-12;", 6, "2x1", 2, false);
    check("1\n(x-1)^3*(x-1.0001)^2*(x+1/3);", 6, "1x1 1x2 1x3", 3, false);
}

#[test]
fn isolated_or_on_a_component() {
    for seed in 0..6 {
        let found = solved("2\ny+x-1;\nx^4+y*(y+x-1);", &options(seed));
        assert_eq!((multiplicities(&found), found.on_components), ("1x4".to_owned(), 0), "{seed}");
        assert!(has(&found, &[1.0, 0.0], 1e-14));
        let near = solve_text("2\n(x-1-1E-7)*(x^2+y^2-1);\ny*(x^2+y^2-1);", &options(seed)).unwrap();
        assert_eq!((multiplicities(&near), near.on_components > 0), ("1x1".to_owned(), true), "{seed}");
        assert!(has(&near, &[1.0000001, 0.0], 1e-12));
    }
    check("2\nx^4;\ny+x^3;", 4, "1x4", 1, false);
    // x = z^4 and z^6 (1 + z^2) = 0.
    check("3\nx-y^2;\ny-z^2;\nz^2*x+x^2;", 4, "2x1 1x6", 1, false);
}

#[test]
fn multiplicities_of_overdetermined_systems() {
    check("3 2\nx^2;\nx*y;\ny^2;", 6, "1x3", 1, false);
}

#[test]
fn a_condition_of_ten_to_the_twelve() {
    check("2\nx^2+y^2-2;\n(x^2+y^2-2)*3+1E-12*(x*y-1)*(x-3)+1E-12*(y-2);", 6, "6x1", 4, false);
}

/// With `x = 1 + y` and `s` the sum of all `y`: `y_i^2 = -s`, so that all are `r` or `-r`, `s = k r`
/// and `r = -k` for odd `k`, or all are zero. Five unknowns have 16 such points and one of what is
/// left of 32 paths.
#[test]
fn an_isolated_point_of_a_high_multiplicity() {
    let equation = |i: usize| format!("x{i}^2+(x1+x2+x3+x4+x5)-2*x{i}-4;\n");
    check(&format!("5\n{}", (1..=5).map(equation).collect::<String>()), 4, "16x1 1x16", 17, false);
}

/// Six points 1e-9 apart at (13/3, 2/3), and twelve in a space of three dimensions.
#[test]
fn clusters_away_from_the_origin() {
    let factor = |line: &str, k: usize| format!("(1e9*({line})-{k})");
    let [six, two, others] = [("x+y-5", [1, 2, 4]), ("x-2*y-3", [1, 3, 0]), ("x+y+z-1", [1, 2, 0])]
        .map(|(line, at)| at.iter().filter(|&&k| k > 0).map(|&k| factor(line, k)).collect::<Vec<_>>().join("*"));
    check(&format!("2\n{six};\n{two};"), 6, "6x1", 6, false);
    check(&format!("3\n{six};\n{two};\n{others};"), 3, "12x1", 12, false);
}

/// Two pairs of lines 1e-10 apart: their crossings near (1, -3) lie where paths seem to go on to
/// infinity, by the equations as doubles.
#[test]
fn clusters_that_seem_to_be_at_infinity() {
    let pair = |line: &str, a: usize, b: usize| format!("(1E10*({line})-{a})*(1E10*({line})-{b})");
    let (first, second) = (pair("-3*x-y", 1, 5), pair("3*x-4*y-15", 2, 4));
    check(&format!("2\n{first}*(-6*x+2*y-2);\n{second}*(-6*x-4*y-5);"), 4, "9x1", 9, false);
}

/// Wilkinson's and Chebyshev's polynomials beside a parabola, and a point of multiplicity six.
#[test]
fn ends_that_doubles_do_not_reach() {
    let factors: Vec<String> = (1..=17).map(|k| format!("(x-{k})")).collect();
    check(&format!("2\n{};\ny+2*x^2+1;", factors.join("*")), 1, "17x1", 17, false);
    let curve = "(x-y+1-5*(3*x-4*y+4)^2)";
    check(&format!("2\n{curve};\n(3*x-4*y+4)^6+{curve}*(x+2*y-3);"), 2, "1x6", 1, false);
}

/// Where nothing is zero, all `x_i^5` are the product of the unknowns: `x_i = w_i x` with fifth roots
/// of unity and `x = w_2 w_3 w_4`, 5^3 simple solutions. Of Bezout's 4^4, 131 are left for the origin
/// (Dayton & Zeng 2005).
#[test]
fn an_isolated_point_of_multiplicity_131() {
    check("4\nx^4-y*z*w;\ny^4-x*z*w;\nz^4-x*y*w;\nw^4-x*y*z;", 2, "125x1 1x131", 2, false);
}

/// `x^60 y^3 = 2` and `y^30 = x^2 + 1`: `x^600 (x^2 + 1) = 2^10` and for each of its 602 `x` the
/// three common `y` of `y^3 = 2 x^-60` and `y^30 = x^2 + 1`, simple and real for two of them. Other
/// paths go to infinity, slowly.
#[test]
fn paths_that_seem_to_end() {
    check("2\nx^60*y^3-2;\nx^2-y^30+1;", 1, "1806x1", 2, false);
}

/// Mignotte's polynomial is irreducible (Eisenstein at 2) and has two roots near 1/1000, 4e-35 apart.
#[test]
fn roots_that_doubles_do_not_tell_apart() {
    let mignotte = |x: &str| format!("{x}^21-2000000*{x}^2+4000*{x}-2");
    check(&format!("1\n{};", mignotte("x")), 3, "21x1", 3, false);
    check(&format!("2\n{};\ny-x^2+1;", mignotte("x")), 3, "21x1", 3, false);
    check(&format!("2\n{};\nx-2*y-1;", mignotte("(x+y)")), 3, "21x1", 3, false);
    check(&format!("3\n{};\nx-2*y-1;\nz-x-y;", mignotte("z")), 3, "21x1", 3, false);
}

#[path = "../../examples/singular_families/families/mod.rs"]
mod families;
#[path = "../../examples/singular_families/verdict.rs"]
mod verdict;

/// The example `singular_families` takes more of each kind.
#[test]
fn random_systems_of_each_kind() {
    for (name, kind) in families::KINDS {
        // Some take a second or more each.
        let systems = match name {
            "corank 5" | "Chebyshev, two unknowns" | "cluster beside others" => 1,
            "cluster, two unknowns" | "cluster, three unknowns" | "cluster on a curve" => 2,
            "multiple, irrational" | "multiple, equal squares" | "multiplicity to 32, three unknowns" => 2,
            _ => 6,
        };
        for seed in 0..systems {
            let case = kind(&mut families::Draw(1000 + seed));
            assert_ne!(verdict::answer(&case, seed), verdict::Answer::Wrong, "{name} {seed}: {}", case.text);
        }
    }
}
