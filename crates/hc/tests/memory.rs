//! Memory of a solve grows with the solutions, hardly with the paths: points are kept of solutions only.

use allocation_counter::measure;
use hc::poly::parse::phcpack;
use hc::solve::{SolveOptions, Start, solve};

/// Pairs of equations in unknowns of their own with equal leading forms: of four paths a pair two go to infinity, so that of `4^pairs`
/// paths `2^pairs` end at solutions.
fn deficient(pairs: usize) -> String {
    let pair =
        |k: usize| format!("x{k}^2 + x{k}*y{k} + x{k} + {};\nx{k}^2 + x{k}*y{k} + y{k} + {};\n", k + 2, 2 * k + 5);
    format!("{}\n{}", 2 * pairs, (0..pairs).map(pair).collect::<String>())
}

#[test]
fn memory_grows_with_solutions_not_with_paths() {
    // Counted are the allocations of this thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    for (start, bound) in [(Start::TotalDegree, 20.0), (Start::Polyhedral, 160.0)] {
        let peak = |pairs: usize| {
            let system = phcpack(&deficient(pairs)).unwrap().expand(&Default::default()).unwrap();
            let mut options = SolveOptions::default();
            options.start = start;
            let mut found = None;
            let memory = measure(|| found = pool.install(|| solve(&system, &options).ok()));
            let found = found.unwrap();
            let counts = (found.solutions.len(), found.paths.finite, found.paths.failed);
            assert_eq!(counts, (1 << pairs, 1 << pairs, 0), "{:?}", found.paths);
            println!("{start:?}, {pairs} pairs: {:?}, {} KB", found.paths, memory.bytes_max / 1024);
            (found.paths.tracked, memory.bytes_max)
        };
        let (few, more) = (peak(5), peak(6));
        let a_path = (more.1 as f64 - few.1 as f64) / (more.0 - few.0) as f64;
        assert!(a_path < bound, "{start:?}: {a_path} bytes a path");
    }
}
