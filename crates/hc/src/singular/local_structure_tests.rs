//! Points whose local structure is known by hand.

use super::{Effort, LocalStructure, local_structure};
use crate::singular::equations::ExactEquations;
use num_complex::Complex64;
use poly::parse::phcpack;

fn structure(text: &str, point: &[f64], paths: usize, error: f64) -> LocalStructure {
    let system = phcpack(text).unwrap();
    let given = ExactEquations::new(&system.expand(&Default::default()).unwrap(), vec![0; system.variables().len()]);
    // Beside the point by the error that is said.
    let point: Vec<Complex64> = point
        .iter()
        .enumerate()
        .map(|(j, &x)| Complex64::new(x, 0.0) + Complex64::from_polar(0.7 * error, 1.0 + j as f64))
        .collect();
    local_structure(&given, &point, paths, paths, error, Effort::Much)
}

fn isolated(text: &str, at: &[f64], paths: usize, error: f64) -> usize {
    match structure(text, at, paths, error) {
        LocalStructure::Isolated { multiplicity, point, residual, .. } => {
            for (z, x) in point.iter().zip(at) {
                assert!((z - x).norm() < 1e-14, "{text}: {point:?}");
            }
            assert!(residual < 1e-15, "{text}: {residual}");
            multiplicity
        }
        other => panic!("{text}: {other:?}"),
    }
}

/// Multiplicities by hand: intersection numbers, or monomials outside the leading ideal.
#[test]
fn multiplicities_from_inaccurate_ends() {
    for error in [0.0, 1e-14, 1e-9, 1e-5] {
        assert_eq!(isolated("3 2\nx^2;\nx*y;\ny^2;", &[0.0, 0.0], 4, error), 3);
        assert_eq!(isolated("2\ny+x-1;\nx^4+y*(y+x-1);", &[1.0, 0.0], 4, error), 4);
        assert_eq!(isolated("1\n(x-3)^2;", &[3.0], 2, error), 2);
        assert_eq!(isolated("2\n(29/16)*x^3-2*x*y;\nx^2-y;", &[0.0, 0.0], 3, error), 3);
        assert_eq!(isolated("2\nx*(x-y);\ny*(x+y);", &[0.0, 0.0], 4, error), 4);
        assert_eq!(isolated("3\nx^2-y;\ny^2-z;\nz^2;", &[0.0, 0.0, 0.0], 8, error), 8);
        assert_eq!(isolated("3\nx^2+y*z;\ny^2-x*z;\nz^2+2*x*y+x^3;", &[0.0, 0.0, 0.0], 8, error), 8);
        // Two cusps that cross transversally: order of the product.
        assert_eq!(isolated("2\ny^2-x^3;\nx^2-y^3;", &[0.0, 0.0], 4, error), 4);
        // The tacnode y (y - x^2) and a line through it in a general direction, and its
        // tangent: 2 and 4 with y - x^4.
        assert_eq!(isolated("2\ny*(y-x^2);\nx-2*y;", &[0.0, 0.0], 2, error), 2);
        assert_eq!(isolated("2\n(x-1)^3*(y+2);\n(y-1)^2*(x+y-5);", &[1.0, 1.0], 6, error), 6);
    }
}

#[test]
fn high_multiplicities() {
    for error in [1e-8, 1e-4] {
        assert_eq!(isolated("1\n(x-3)^12;", &[3.0], 12, error), 12);
        assert_eq!(isolated("2\n(x-1)^5+y-2;\n(y-2)^3;", &[1.0, 2.0], 15, error), 15);
    }
    assert_eq!(isolated("4\nx^2;\ny^2+x*z;\nz^2-x*y;\nw^2+x+y;", &[0.0; 4], 16, 1e-7), 16);
}

#[test]
fn regular_solutions_with_others_nearby() {
    for (text, at, error) in [
        ("1\nx^2-2*x+1-1E-12;", vec![1.000001], 1e-9),
        ("2\n(x-1-1E-7)*(x^2+y^2-1);\ny*(x^2+y^2-1);", vec![1.0000001, 0.0], 1e-10),
        ("3 2\nx*y;\nx-1;\ny*(x+2);", vec![1.0, 0.0], 1e-9),
        ("4 3\nx*y;\nx*z;\nx*(x-1);\ny*(y-z);", vec![1.0, 0.0, 0.0], 1e-9),
    ] {
        let found = structure(text, &at, 1, error);
        assert!(matches!(found, LocalStructure::Regular { .. }), "{text}: {found:?}");
    }
}

#[test]
fn points_on_sets_of_positive_dimension() {
    for error in [0.0, 1e-12, 1e-8] {
        for (text, at) in [
            ("2\nx^2*(x+y-1);\nx^2*(x-y+2);", vec![0.0, 0.3]),
            ("2\n(x-y)^2*(x+y-1);\n(x-y)^2*(x+2*y+2);", vec![0.7, 0.7]),
            ("2\n(x-1-1E-7)*(x^2+y^2-1);\ny*(x^2+y^2-1);", vec![0.6, 0.8]),
            ("4 3\nx*y;\nx*z;\nx*(x-1);\ny*(y-z);", vec![0.0, 0.4, 0.4]),
            ("3\nx*(x^2+y+z);\nx*(y^2-3+z);\nx*(z-x*y+1);", vec![0.0, 0.4, 0.9]),
        ] {
            let found = structure(text, &at, 1, error);
            assert!(matches!(found, LocalStructure::OnComponent { .. }), "{text} {error}: {found:?}");
        }
        // The axis of x, doubled, and what else ends at the origin.
        let found =
            structure("3\nx^3*z^2+x*y*z+y^3+z^5;\nx^2*z^3+x*y^2+y*z^3;\nx^2*y*z+x*z^4+y^2;", &[0.0; 3], 28, error);
        assert!(matches!(found, LocalStructure::OnComponent { .. }), "{found:?}");
        // Where two planes meet, one of them with an embedded line.
        let found = structure("3\nx^3*y;\nx*y^2;\nx*y*(x+y);", &[0.0, 0.0, 0.5], 1, error);
        assert!(matches!(found, LocalStructure::OnComponent { .. }), "{error}: {found:?}");
    }
}

#[test]
fn points_that_solve_nothing() {
    assert_eq!(structure("2\nx*y-1;\nx+y-7;", &[1.0, 2.0], 2, 1e-9), LocalStructure::NotASolution);
    assert_eq!(structure("3 2\nx^2+y^2-2;\nx-y;\nx*y+3;", &[1.0, 1.0], 2, 1e-9), LocalStructure::NotASolution);
}

/// The double line `x = -y`, made thicker: a line that crosses it at a small angle, where coordinates are
/// large, meets it in a point. On the crossing line, `s` is a small multiple of the unknown: its power is zero in
/// few digits.
#[test]
fn a_thick_line_crossed_at_a_small_angle() {
    for n in [3, 6, 12, 18, 20] {
        for bits in [1, 3, 6] {
            let (slope, y) = (1.0 - 0.5f64.powi(bits), 82.123456789);
            let text = format!("4 3\ns^{n}*(x-1);\ns^{n}*(y-2);\nx+{slope}*y-({});\ns-x-y;", slope * y - y);
            for error in [1e-5, 1e-8, 0.0] {
                let found = structure(&text, &[0.0, -y, y], n, error);
                let LocalStructure::Isolated { multiplicity, point, .. } = found else { panic!("{text} {found:?}") };
                assert!(multiplicity == n && (point[2] - y).norm() < 1e-10, "{text} {multiplicity} {point:?}");
            }
        }
    }
}
