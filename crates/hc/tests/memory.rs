//! Memory of a solve grows with the solutions, not with the paths: what is kept of each path lies
//! in files beyond a fixed size.

use allocation_counter::measure;
use hc::poly::parse::phcpack;
use hc::{SolveOptions, Start, solve};

/// Five pairs of quadrics in unknowns of their own with equal leading forms, and `z^degree - 1`: by
/// the theorem of Bezout `1024 degree` paths, of which only `32 degree` end at solutions, since the
/// difference of a pair is linear.
fn deficient(degree: usize) -> String {
    let pair = |k: usize| {
        let leading = format!("x{k}^2 + x{k}*y{k}");
        format!("{leading} + x{k} + {};\n{leading} + y{k} + {};\n", k + 2, 2 * k + 5)
    };
    format!("11\nz^{degree} - 1;\n{}", (0..5).map(pair).collect::<String>())
}

/// Bytes of a solution in eleven unknowns, with what is found out about it on the way.
const A_SOLUTION: usize = 600;

#[test]
fn memory_grows_with_solutions_not_with_paths() {
    // Counted are the allocations of this thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    // Beyond what the paths under way take, which are at most 2048, and what is in memory before
    // files are used: 13,000 paths need these.
    for (start, degrees) in [(Start::TotalDegree, [13, 27]), (Start::Polyhedral, [54, 81])] {
        let peak = |degree: usize| {
            let system = phcpack(&deficient(degree)).unwrap();
            let mut options = SolveOptions::default();
            options.start = start;
            let mut found = None;
            let memory = measure(|| found = pool.install(|| solve(&system, &options).ok()));
            let found = found.unwrap();
            let counts = (found.solutions.len(), found.paths.finite, found.paths.failed);
            assert_eq!(counts, (32 * degree, 32 * degree, 0), "{:?}", found.paths);
            println!("{start:?}, degree {degree}: {:?}, {} KB", found.paths, memory.bytes_max / 1024);
            (found.paths.tracked, memory.bytes_max)
        };
        let [few, more] = degrees.map(peak);
        let allowed = A_SOLUTION * 32 * (degrees[1] - degrees[0]);
        assert!(more.1 <= few.1 + allowed as u64, "{start:?}: {few:?} and {more:?} paths and bytes");
    }
}
