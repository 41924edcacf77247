//! The factorisations of a step: one matrix, and eight in the lanes of a vector unit.

// The crate keeps its linear algebra to itself; the folder stands on its own.
#[path = "../src/linalg/mod.rs"]
#[allow(dead_code, unused_imports)]
mod linalg;

use divan::{Bencher, black_box};
use hc::poly::simd::Isa;
use hc::poly::{Complex64, Lane, Lanes8};
use hc::random::Random;
use linalg::Lu;

fn main() {
    divan::main();
}

/// Factors matrices of order `n` with random entries, one a lane, and solves with them.
fn measure<S: Lane>(bencher: Bencher<'_, '_>, n: usize) {
    let mut random = Random::new(0, 5);
    let mut entries = || {
        let mut entry = S::zero();
        for l in 0..S::LANES {
            entry.set(l, random.normal());
        }
        entry
    };
    let matrix: Vec<S> = (0..n * n).map(|_| entries()).collect();
    let right: Vec<S> = (0..n).map(|_| entries()).collect();
    let weights = vec![S::real(1.0); n];
    let mut lu = Lu::<S>::new(n, Isa::detect());
    let mut x = right.clone();
    bencher.bench_local(|| {
        lu.factor(black_box(&matrix), &weights);
        x.copy_from_slice(&right);
        lu.solve(black_box(&mut x));
    });
}

#[divan::bench(args = [4, 6, 8, 16])]
fn one(bencher: Bencher<'_, '_>, n: usize) {
    measure::<Complex64>(bencher, n);
}

#[divan::bench(args = [4, 6, 8, 16])]
fn eight_lanes(bencher: Bencher<'_, '_>, n: usize) {
    measure::<Lanes8>(bencher, n);
}
