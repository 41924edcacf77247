//! Formulas that multiply many sums, which are tracked as they are written.

use crate::common::{multiplicities, options, real, solved};
use hc::Start;

/// `y^2 + y` is one of 20 roots of unity, so that there are 40 solutions, all simple since none of these is
/// -1/4; those of 1 are real, and those of -1 are not.
#[test]
fn powers_of_sums_keep_all_solutions() {
    for seed in 0..5 {
        let found = solved("2\n(x+y)^20-1;\nx-y^2;", &options(seed));
        assert_eq!((&multiplicities(&found)[..], real(&found)), ("40x1", 2), "{seed}");
        for solution in &found {
            let [x, y] = solution.value[..] else { panic!("two unknowns") };
            assert!((x - y * y).norm() < 1e-12 && ((x + y).powi(20) - 1.0).norm() < 1e-11, "{seed}: {x} {y}");
        }
    }
}

/// `((x^2 + 1)^4 - x^5)^4 = x^16` in `x` alone, of degree 32; its greatest common divisor with its
/// derivative is 1, and it has no real roots (SymPy, exact).
#[test]
fn nested_powers_from_every_start_system() {
    for start in [Start::Auto, Start::Polyhedral, Start::TotalDegree] {
        let mut options = options(1);
        options.start = start;
        let found = solved("2\n((x+y)^4-x)^4-1;\nx*y-1;", &options);
        assert_eq!((&multiplicities(&found)[..], real(&found)), ("32x1", 0), "{start:?}");
        assert!(found.iter().all(|s| (s.value[0] * s.value[1] - 1.0).norm() < 1e-12), "{start:?}");
    }
}

/// `(1, -1)` and `(-1, 1)`, where one equation vanishes to order 16 and the other to order 1.
#[test]
fn powers_that_vanish_have_their_multiplicities() {
    let found = solved("2\n(x+y)^16;\nx^2-1;", &options(0));
    let mut multiplicities: Vec<usize> = found.iter().map(|s| s.multiplicity).collect();
    multiplicities.sort_unstable();
    assert_eq!((multiplicities, found.paths.failed), (vec![16, 16], 0));
}
