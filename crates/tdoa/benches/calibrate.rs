//! The calibration and the exact solvers on simulated networks, on all cores.

use divan::{Bencher, black_box};
use tdoa::minimal::{MinimalOptions, Solver};
use tdoa::{CalibrateOptions, Layout, SimulateOptions, calibrate, simulate};

fn main() {
    divan::main();
}

/// Receivers, transmitters, and the share of outliers: 1 cm of noise in a room of 10 m, a tenth of
/// the measurements missing.
#[divan::bench(args = [(8, 12, 0.0), (8, 12, 0.1), (10, 20, 0.1), (25, 20, 0.1)], sample_count = 10)]
fn networks(bencher: Bencher<'_, '_>, (receivers, transmitters, outliers): (usize, usize, f64)) {
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters, options.outliers) = (receivers, transmitters, outliers);
    (options.noise, options.missing) = (0.01, 0.1);
    let measured = simulate(&options).expect("a network").pseudoranges;
    bencher.bench_local(|| calibrate(black_box(&measured), &CalibrateOptions::default()));
}

/// Receivers and transmitters of a network without noise; a solver that has been used before.
#[divan::bench(args = [(6, 3), (5, 4), (4, 5), (5, 6), (7, 4)])]
fn exact(bencher: Bencher<'_, '_>, (receivers, transmitters): (usize, usize)) {
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters) = (receivers, transmitters);
    options.layout = Layout::Normal;
    let measured = simulate(&options).expect("a network").pseudoranges;
    let mut solver = Solver::new();
    bencher.bench_local(|| solver.solve(black_box(&measured), &MinimalOptions::default()));
}
