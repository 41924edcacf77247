//! Generated solvers for the relative pose of two cameras from five points (20 solutions) and of
//! three cameras from three points with lines through two of them (312 solutions): random problems
//! with a planted pose, and the time that a path takes on one thread.
//!
//!     cargo run --release --manifest-path examples/cameras/Cargo.toml -- 50
//!
//! The number is that of the problems with three cameras; there are ten times as many with two. The exit
//! status is 1 if a path was lost or a planted pose was not found.

mod scene;
include!(concat!(env!("OUT_DIR"), "/five_point.rs"));
include!(concat!(env!("OUT_DIR"), "/chicago.rs"));

use hc::family::{FibreTracker, OneChart};
use hc::poly::{Complex64, Evaluate};
use hc::random::Random;
use hc::refine::Refiner;
use hc::tracker::PathEnd;
use hc::{Fibre, FibreOptions, TrackerOptions};
use scene::Problem;
use std::sync::LazyLock;
use std::time::Instant;

fn main() {
    let problems = std::env::args().nth(1).map_or(50, |text| text.parse().expect("a number of problems"));
    let whole = [
        solve("five points", five_point::System, &five_point::fibre(), 10 * problems, scene::five_points),
        solve("Chicago", chicago::System, &chicago::fibre(), problems, scene::chicago),
    ];
    if whole.contains(&false) {
        std::process::exit(1);
    }
}

/// Solves problems of a family with three settings, and says whether nothing was lost.
fn solve<E: Evaluate>(name: &str, system: E, fibre: &Fibre, problems: usize, draw: fn(&mut Random) -> Problem) -> bool {
    let mut random = Random::new(0, 5);
    let problems: Vec<Problem> = (0..problems).map(|_| draw(&mut random)).collect();
    let mut quick = TrackerOptions::fast();
    quick.quick = true;
    let settings = [("default", TrackerOptions::default()), ("fast", TrackerOptions::fast()), ("quick", quick)];
    let mut refiner = Refiner::new(&system);
    let mut whole = true;
    for (setting, steps) in settings {
        let mut options = FibreOptions::default();
        options.tracker = steps;
        let mut tracker = FibreTracker::new(&system, OneChart, fibre);
        let (mut found, mut retracked, mut ended, mut infinite) = (0, 0, 0, 0);
        let started = now();
        for Problem { parameters, solution } in &problems {
            let target: Vec<Complex64> = parameters.iter().map(|&p| p.into()).collect();
            let counts = tracker.track(fibre, &target, &options);
            retracked += counts.retracked;
            ended += counts.finite;
            infinite += counts.at_infinity;
            let error = |x: &[Complex64]| x.iter().zip(solution).map(|(x, s)| (x - s).norm()).fold(0.0, f64::max);
            let near = |x: &[Complex64]| error(x) < 0.1 && error(&refiner.refine(&target, x).point) < 1e-6;
            let mut ends = tracker.paths().iter().filter(|(r, _)| r.end == PathEnd::Success).map(|(_, x)| x);
            found += usize::from(ends.any(near));
        }
        let seconds = now() - started;
        let paths = problems.len() * fibre.len();
        let lost = paths - ended - infinite;
        println!(
            "{name}, {setting}: poses found {found} of {}; paths {paths}, tracked again {retracked}, at infinity \
             {infinite}, lost {lost}; microseconds a path {:.1}",
            problems.len(),
            1e6 * seconds / paths as f64
        );
        whole &= found == problems.len() && lost == 0;
    }
    whole
}

/// Seconds that this thread has spent on a processor, as Linux counts them; elsewhere those of a clock.
fn now() -> f64 {
    static STARTED: LazyLock<Instant> = LazyLock::new(Instant::now);
    let counted = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = counted.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| STARTED.elapsed().as_secs_f64(), |n| n * 1e-9)
}
