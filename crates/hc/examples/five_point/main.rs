//! A solver generated for one minimal problem: the relative pose of two calibrated cameras from
//! five points.
//!
//! `generated.rs` comes from `cargo xtask codegen` (family: `examples/families/five_point.toml`).
//! Here it solves 1,000 problems with a planted pose, says whether the pose is among the solutions
//! each time, and how long a path takes:
//!
//!     cargo run --release -p hc --example five_point

#[rustfmt::skip]
mod generated;

use hc::family::{FibreOptions, FibreTracker, OneChart};
use hc::poly::Complex64;
use hc::random::Random;
use hc::refine::Refiner;
use hc::tracker::PathEnd;
use std::time::Instant;

/// Unknowns: rotation `x y z` by Cayley's parameters, translation `(1, u, v)`.
const UNKNOWNS: usize = 5;
const PROBLEMS: usize = 1000;

fn main() {
    let fibre = generated::fibre();
    let (count, system, options) = (fibre.len(), generated::System, FibreOptions::default());
    let mut tracker = FibreTracker::new(&system, OneChart, &fibre).stating(generated::stated());
    let mut refiner = Refiner::new(&system);
    let mut random = Random::new(0, 5);
    let (mut found, mut lost, mut retracked, mut seconds) = (0, 0, 0, 0.0);
    for _ in 0..PROBLEMS {
        let (pose, points) = problem(&mut random);
        let target: Vec<Complex64> = points.iter().map(|&p| p.into()).collect();
        let started = Instant::now();
        // Paths that fail or jump are tracked again with shorter steps.
        let counts = tracker.track(&fibre, &target, &options);
        seconds += started.elapsed().as_secs_f64();
        retracked += counts.retracked;
        lost += counts.failed;
        let near = |x: &[Complex64]| {
            let error = |x: &[Complex64]| x.iter().zip(&pose).map(|(x, p)| (x - p).norm()).fold(0.0, f64::max);
            error(x) < 1e-3 && error(&refiner.refine(&target, x).point) < 1e-8
        };
        let mut ends = tracker.paths().iter().filter(|(r, _)| r.end == PathEnd::Success).map(|(_, x)| x);
        found += usize::from(ends.any(near));
    }
    println!("planted poses found: {found} of {PROBLEMS}");
    println!("paths: {}, tracked again: {retracked}, lost: {lost}", PROBLEMS * count);
    println!("microseconds a path on one thread: {:.1}", 1e6 * seconds / (PROBLEMS * count) as f64);
    if found < PROBLEMS || lost > 0 {
        std::process::exit(1);
    }
}

/// A random pose, and five points in both images as the family's parameters `a_k1 a_k2 b_k1 b_k2`.
fn problem(random: &mut Random) -> ([f64; UNKNOWNS], Vec<f64>) {
    let mut uniform = |low: f64, high: f64| low + (high - low) * (random.unit().arg() / std::f64::consts::TAU + 0.5);
    let pose @ [x, y, z, u, v] = [(); UNKNOWNS].map(|()| uniform(-0.5, 0.5));
    let norm = 1.0 + x * x + y * y + z * z;
    let rotation = [
        [1.0 + x * x - y * y - z * z, 2.0 * (x * y - z), 2.0 * (x * z + y)],
        [2.0 * (x * y + z), 1.0 - x * x + y * y - z * z, 2.0 * (y * z - x)],
        [2.0 * (x * z - y), 2.0 * (y * z + x), 1.0 - x * x - y * y + z * z],
    ];
    let mut points = Vec::new();
    while points.len() < 20 {
        let (b, depth) = ([uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1.0], uniform(2.0, 6.0));
        let [p, q, r]: [f64; 3] =
            std::array::from_fn(|i| depth * (0..3).map(|j| rotation[i][j] * b[j]).sum::<f64>() / norm + [1.0, u, v][i]);
        // The points lie in front of both cameras.
        if r > 0.1 {
            points.extend([p / r, q / r, b[0], b[1]]);
        }
    }
    (pose, points)
}
