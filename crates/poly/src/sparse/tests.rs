//! The kernel against programs compiled from the same polynomials with named coefficients.

use super::{SparseSystem, SupportError};
use crate::{ComplexDd, Evaluate, Expr, Interpreter, Isa, Lane, Lanes8, Scalar, System};
use num_complex::Complex64;
use proptest::prelude::*;

const N: usize = 3;

fn supports() -> impl Strategy<Value = Vec<Vec<Vec<i32>>>> {
    let term = proptest::collection::vec(prop_oneof![3 => Just(0), 2 => Just(1), 2 => -3..6i32], N);
    let support = proptest::collection::btree_set(term, 0..9);
    proptest::collection::vec(support.prop_map(|s| s.into_iter().collect::<Vec<_>>()), 0..4)
}

/// The polynomials as formulas.
fn interpreter(supports: &[Vec<Vec<i32>>]) -> Interpreter {
    let system = System::build(|s| {
        let x: Vec<Expr<'_>> = (0..N).map(|j| s.variable(&format!("x{j}"))).collect();
        let mut count = 0;
        let mut term = |exponents: &Vec<i32>| {
            count += 1;
            let c = s.parameter(&format!("c{count}"));
            exponents.iter().zip(&x).fold(c, |product, (&e, x)| product * x.powi(e))
        };
        supports.iter().map(|support| s.sum(support.iter().map(&mut term).collect::<Vec<_>>())).collect()
    });
    system.unwrap().compile().unwrap()
}

/// A number of modulus between 0.5 and 2, the same for equal `k`.
fn number<S: Lane>(k: usize) -> S {
    let mut z = S::zero();
    for lane in 0..S::LANES {
        let angle = (k * 8 + lane) as f64;
        z.set(lane, Complex64::from_polar(1.25 + 0.75 * (1.7 * angle).sin(), angle));
    }
    z
}

fn all<E: Evaluate, S: Scalar>(f: &E, isa: Isa, x: &[S], p: &[S]) -> Vec<S> {
    let (m, n, k) = (f.equations(), f.variables(), f.parameters());
    let mut memory = f.memory::<S>(isa);
    let mut out = vec![S::from_c64(Complex64::new(f64::NAN, 0.0)); m * (n + 5)];
    let (values, rest) = out.split_at_mut(m);
    let (again, rest) = rest.split_at_mut(m);
    let (jacobian, rest) = rest.split_at_mut(m * n);
    f.values(&mut memory, &x[..n], &p[..k], values);
    f.jacobian(&mut memory, &x[..n], &p[..k], again, jacobian);
    for order in 1..=3 {
        let out = &mut rest[(order - 1) * m..][..m];
        f.taylor(&mut memory, order, &x[..order * n], &p[..(order + 1) * k], out);
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn agrees_with_the_compiled_formulas(supports in supports()) {
        let sparse = SparseSystem::new(N, &supports).unwrap();
        let compiled = interpreter(&supports);
        let terms: usize = supports.iter().map(Vec::len).sum();
        prop_assert_eq!(sparse.parameters(), terms);
        let x: Vec<Complex64> = (0..4 * N).map(number).collect();
        let p: Vec<Complex64> = (100..100 + 4 * terms).map(number).collect();
        // The formulas leave out unknowns that no term has; N unknowns are mentioned all the same.
        let (a, b) = (all(&sparse, Isa::Portable, &x, &p), all(&compiled, Isa::Portable, &x, &p));
        for (a, b) in a.iter().zip(&b) {
            prop_assert!((a - b).norm() <= 1e-10 * (1e3 + a.norm()), "{a} {b}");
        }
        // Wide numbers see the same point in lane 0.
        let wide: Vec<Lanes8> = (0..4 * N).map(number).collect();
        let coefficients: Vec<Lanes8> = (100..100 + 4 * terms).map(number).collect();
        for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
            let lanes = all(&sparse, isa, &wide, &coefficients);
            for l in [0, 5] {
                let x: Vec<Complex64> = wide.iter().map(|z| z.get(l)).collect();
                let p: Vec<Complex64> = coefficients.iter().map(|z| z.get(l)).collect();
                let lane: Vec<Complex64> = lanes.iter().map(|z| z.get(l)).collect();
                prop_assert_eq!(lane, all(&sparse, Isa::Portable, &x, &p));
            }
        }
        let dd = |z: &Vec<Complex64>| z.iter().map(|&z| ComplexDd::new(z)).collect::<Vec<_>>();
        let c = all(&sparse, Isa::detect(), &dd(&x), &dd(&p));
        for (a, c) in a.iter().zip(&c) {
            prop_assert!((a - c.high()).norm() <= 1e-10 * (1e3 + a.norm()));
        }
    }
}

#[test]
fn wrong_supports_are_refused() {
    let new = |support: Vec<Vec<i32>>| SparseSystem::new(2, &[vec![vec![1, 0]], support]).unwrap_err();
    assert_eq!(new(vec![vec![1, 2, 3]]), SupportError::Length { equation: 2, term: 1, found: 3, expected: 2 });
    assert_eq!(new(vec![vec![1, 2], vec![1, 2]]), SupportError::Repeated { equation: 2, term: 2 });
    assert_eq!(new(vec![vec![1, i32::MIN]]), SupportError::Exponent { equation: 2, term: 1 });
}

#[test]
fn giant_exponents_cost_little() {
    let system = SparseSystem::new(1, &[vec![vec![i32::MAX], vec![-i32::MAX]]]).unwrap();
    let one = Complex64::new(1.0, 0.0);
    let mut v = [one];
    let mut j = [one];
    system.jacobian(&mut system.memory(Isa::Portable), &[one], &[one, one], &mut v, &mut j);
    assert_eq!((v[0].re, j[0].re), (2.0, 0.0));
}
