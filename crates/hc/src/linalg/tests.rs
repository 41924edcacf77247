use super::Lu;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{Evaluate, Lane, Lanes8, Scalar};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn random(rng: &mut Pcg64) -> Complex64 {
    Complex64::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0))
}

fn residual(n: usize, a: &[Complex64], x: &[Complex64], b: &[Complex64]) -> f64 {
    (0..n).map(|i| ((0..n).map(|j| a[j * n + i] * x[j]).sum::<Complex64>() - b[i]).norm()).fold(0.0, f64::max)
}

#[test]
fn solves_and_every_lane_equals_the_one_lane_result() {
    let mut rng = Pcg64::seed_from_u64(1);
    for n in 1..=12 {
        let mut wide = Lu::<Lanes8>::new(n, Isa::detect());
        let mut portable = Lu::<Lanes8>::new(n, Isa::Portable);
        let mut a8 = vec![Lanes8::zero(); n * n];
        let mut b8 = vec![Lanes8::zero(); n];
        let mut w8 = vec![Lanes8::real(1.0); n];
        for l in 0..8 {
            for a in a8.iter_mut() {
                a.set(l, random(&mut rng));
            }
            for b in b8.iter_mut() {
                b.set(l, random(&mut rng));
            }
            for w in w8.iter_mut() {
                w.as_mut()[l] = rng.random_range(0.1..10.0);
            }
        }
        wide.factor(&a8, &w8);
        portable.factor(&a8, &w8);
        let (mut x8, mut y8) = (b8.clone(), b8.clone());
        wide.solve(&mut x8);
        portable.solve(&mut y8);
        assert_eq!(x8, y8);
        for l in 0..8 {
            let a: Vec<_> = a8.iter().map(|a| a.get(l)).collect();
            let b: Vec<_> = b8.iter().map(|b| b.get(l)).collect();
            let w: Vec<_> = w8.iter().map(|w| [w.0[l]]).collect();
            let mut lu = Lu::<Complex64>::new(n, Isa::Portable);
            lu.factor(&a, &w);
            let mut x = b.clone();
            lu.solve(&mut x);
            assert!(residual(n, &a, &x, &b) < 1e-11, "order {n}");
            for j in 0..n {
                assert_eq!(x[j], x8[j].get(l));
            }
            let mut y = b.clone();
            lu.solve_adjoint(&mut y);
            let adjoint: Vec<_> = (0..n * n).map(|e| a[(e % n) * n + e / n].conj()).collect();
            assert!(residual(n, &adjoint, &y, &b) < 1e-11, "order {n}");
        }
    }
}

/// A system whose Jacobian is zero where a mask says so; nothing else of it is used.
struct Structure(Vec<u64>);

impl Evaluate for Structure {
    type Memory<S: Scalar> = ();

    fn equations(&self) -> usize {
        self.0.len()
    }
    fn variables(&self) -> usize {
        self.0.len()
    }
    fn parameters(&self) -> usize {
        0
    }
    fn memory<S: Scalar>(&self, _: Isa) {}
    fn values<S: Scalar>(&self, (): &mut (), _: &[S], _: &[S], _: &mut [S]) {}
    fn jacobian<S: Scalar>(&self, (): &mut (), _: &[S], _: &[S], _: &mut [S], _: &mut [S]) {}
    fn taylor<S: Scalar>(&self, (): &mut (), _: usize, _: &[S], _: &[S], _: &mut [S]) {}
    fn vanishes(&self, row: usize, column: usize) -> bool {
        self.0[column] >> row & 1 == 0
    }
}

/// Factors without the zeros and with them give the same solutions and pivots, whatever rows are
/// exchanged.
#[test]
fn zeros_left_out_change_nothing() {
    let mut rng = Pcg64::seed_from_u64(2);
    for (n, filled) in [(1, 0.5), (5, 0.4), (8, 0.5), (17, 0.3), (40, 0.1), (64, 0.1)] {
        for _ in 0..20 {
            // A permutation of the diagonal makes the matrix regular.
            let shift = rng.random_range(0..n);
            let column = |rng: &mut Pcg64, j: usize| {
                (0..n).fold(1u64 << ((j + shift) % n), |m, i| m | u64::from(rng.random_bool(filled)) << i)
            };
            let structure = Structure((0..n).map(|j| column(&mut rng, j)).collect());
            let mut a = vec![Lanes8::zero(); n * n];
            for (e, a) in a.iter_mut().enumerate().filter(|(e, _)| !structure.vanishes(e % n, e / n)) {
                let size = if rng.random_bool(0.3) || (e / n + shift) % n == e % n { 1.0 } else { 1e-3 };
                (0..8).for_each(|l| a.set(l, random(&mut rng) * size));
            }
            let mut b = vec![Lanes8::zero(); n];
            b.iter_mut().for_each(|b| (0..8).for_each(|l| b.set(l, random(&mut rng))));
            let weights = vec![Lanes8::real(1.0); n];
            let [mut sparse, mut dense] = [Lu::of_jacobian(&structure, Isa::detect()), Lu::new(n, Isa::detect())];
            assert!(n < 5 || !sparse.structure.is_empty());
            let [mut x, mut y] = [b.clone(), b];
            for _ in 0..2 {
                sparse.factor(&a, &weights);
                dense.factor(&a, &weights);
                sparse.solve(&mut x);
                dense.solve(&mut y);
                assert_eq!(x, y, "order {n}");
                assert_eq!((&sparse.moved, &sparse.row_scale), (&dense.moved, &dense.row_scale));
            }
        }
    }
}

#[test]
fn badly_scaled_rows_do_not_spoil_the_pivots() {
    // Without scaling, the first row would give the pivot 1e10 and lose all of (1, 1).
    let a = [1e10, 1.0, 1e20, 1.0].map(|v| Complex64::new(v, 0.0));
    let mut lu = Lu::new(2, Isa::Portable);
    lu.factor(&a, &[[1.0], [1.0]]);
    let mut x = [1e20 + 1e10, 2.0].map(|v| Complex64::new(v, 0.0));
    lu.solve(&mut x);
    assert!(x.iter().all(|z| (z - 1.0).norm() < 1e-9), "{x:?}");
}

#[test]
fn smallest_pivots_of_known_matrices() {
    let mut lu = Lu::<Complex64>::new(3, Isa::Portable);
    let mut pivot = |a: [f64; 9], weights_sqr: &[[f64; 1]]| {
        lu.factor(&a.map(|v| Complex64::new(v, 0.0)), weights_sqr);
        lu.smallest_pivot(0, weights_sqr)
    };
    let ones = [[1.0]; 3];
    // A permutation, rows of different sizes: both are scaled away.
    assert_eq!(pivot([0.0, 0.0, 3.0, 1e9, 0.0, 0.0, 0.0, 1e-9, 0.0], &ones), 1.0);
    // Columns (1, 0, 0), (0, 1, 0), (0, 1, e): rank two but for e, measured against the 1 of
    // the row's scale.
    assert!((pivot([1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1e-30], &ones) / 1e-30 - 1.0).abs() < 1e-12);
    assert_eq!(pivot([1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0], &ones), 0.0);
    // An unknown on a scale of 1e-30 is as good as any other.
    assert!((pivot([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1e30], &[[1.0], [1.0], [1e-60]]) - 1.0).abs() < 1e-12);
}

#[test]
fn condition_of_known_matrices() {
    let identity = [1.0, 0.0, 0.0, 1.0].map(|v| Complex64::new(v, 0.0));
    let (mut lu, mut scratch) = (Lu::new(2, Isa::Portable), super::Estimate::with_capacity(2));
    lu.factor(&identity, &[[1.0], [1.0]]);
    assert_eq!(lu.condition(&identity, &[[1.0]; 2], &mut scratch), 1.0);
    // [[1, 1], [1, 1 + e]] has condition (2 + e)^2 / e in the maximum norm (nearly unchanged by
    // row scaling).
    let e = 1e-6;
    let near = [1.0, 1.0, 1.0, 1.0 + e].map(|v| Complex64::new(v, 0.0));
    lu.factor(&near, &[[1.0], [1.0]]);
    let condition = lu.condition(&near, &[[1.0]; 2], &mut scratch);
    assert!((condition * e / 4.0 - 1.0).abs() < 1e-4, "{condition}");
    let singular = [1.0, 1.0, 1.0, 1.0].map(|v| Complex64::new(v, 0.0));
    lu.factor(&singular, &[[1.0], [1.0]]);
    assert_eq!(lu.condition(&singular, &[[1.0]; 2], &mut scratch), f64::INFINITY);
}

#[test]
fn in_order_the_same_where_no_rows_are_exchanged() {
    let mut random = Pcg64::seed_from_u64(11);
    for n in [1, 3, 8, 13] {
        let mut entry = || Complex64::new(random.random::<f64>() - 0.5, random.random::<f64>() - 0.5);
        let mut a: Vec<Complex64> = (0..n * n).map(|_| entry()).collect();
        // A dominant diagonal stays where it is.
        (0..n).for_each(|k| a[k * n + k] += 4.0 * n as f64);
        let weights = vec![[1.0]; n];
        let (mut one, mut other) = (Lu::new(n, Isa::detect()), Lu::new(n, Isa::detect()));
        one.factor(&a, &weights);
        other.matrix().copy_from_slice(&a);
        other.factor_in_order();
        let mut x: Vec<Complex64> = (0..n).map(|_| entry()).collect();
        let mut y = x.clone();
        one.solve(&mut x);
        other.solve(&mut y);
        assert_eq!(x, y, "{n}");
        assert_eq!(one.smallest_pivot(0, &weights), other.smallest_pivot_in_order(0, &a, &weights), "{n}");
    }
}

#[test]
fn in_order_a_zero_pivot_shows() {
    let [zero, one] = [0.0, 1.0].map(Complex64::from);
    let a = [zero, one, one, zero];
    let mut lu = Lu::new(2, Isa::detect());
    lu.matrix().copy_from_slice(&a);
    lu.factor_in_order();
    let mut x = [one, one];
    lu.solve(&mut x);
    assert!(x.iter().any(|z| !z.is_finite()), "{x:?}");
    // With the rows exchanged it is the easiest matrix of all; the memory serves for both.
    lu.factor(&a, &[[1.0]; 2]);
    let mut x = [one, zero];
    lu.solve(&mut x);
    assert_eq!(x, [zero, one]);
}

/// With rows exchanged, factors in order are those of the matrix whose rows come in this order, sparse ones too.
#[test]
fn in_order_after_exchanges() {
    let mut random = Pcg64::seed_from_u64(12);
    for n in [4, 9, 17] {
        // The diagonal is zero, and the largest entry of each row comes to the diagonal.
        let structure = Structure((0..n).map(|j| 1u64 << ((j + 1) % n) | 1 << ((j + 2) % n)).collect());
        let mut a = vec![Lanes8::zero(); n * n];
        for (e, a) in a.iter_mut().enumerate().filter(|(e, _)| !structure.vanishes(e % n, e / n)) {
            let size = if (e / n + 1) % n == e % n { 1.0 } else { 0.3 };
            (0..8).for_each(|l| a.set(l, random_unit(&mut random) * size));
        }
        let exchanges: Vec<[usize; 2]> = (0..n - 1).map(|k| [k, k + 1]).collect();
        let weights = vec![Lanes8::real(1.0); n];
        let b: Vec<Lanes8> = (0..n).map(|_| Lanes8::from_c64(random_unit(&mut random))).collect();
        let mut lus = [Lu::of_jacobian(&structure, Isa::detect()), Lu::new(n, Isa::detect())];
        assert!(!lus[0].structure.is_empty());
        let solved = lus.each_mut().map(|lu| {
            lu.set_exchanges(&exchanges);
            lu.matrix().copy_from_slice(&a);
            lu.factor_in_order();
            let mut x = b.clone();
            lu.solve(&mut x);
            // The largest entry of each row is 1; fill-in changes the last pivot alone, by less than 0.31.
            let pivots: Vec<f64> = (0..8).map(|l| lu.smallest_pivot_in_order(l, &a, &weights)).collect();
            assert!(pivots.iter().all(|pivot| (pivot - 1.0).abs() < 0.31), "order {n}: {pivots:?}");
            // The memory serves for exchanges lane by lane as before.
            lu.factor(&a, &weights);
            let mut y = b.clone();
            lu.solve(&mut y);
            for l in 0..8 {
                let [a, x, y, b] = [&a, &x, &y, &b].map(|v| v.iter().map(|z| z.get(l)).collect::<Vec<_>>());
                assert!(residual(n, &a, &x, &b) < 1e-13 && residual(n, &a, &y, &b) < 1e-13, "order {n}");
            }
            x
        });
        assert_eq!(solved[0], solved[1], "order {n}");
    }
}

fn random_unit(rng: &mut Pcg64) -> Complex64 {
    Complex64::from_polar(1.0, rng.random_range(0.0..std::f64::consts::TAU))
}
