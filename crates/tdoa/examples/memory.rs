//! What the minimal solvers keep in memory, and what a solve takes besides once the solver has been
//! used:
//!
//!     cargo run --release -p tdoa --example memory

use allocation_counter::measure;
use tdoa::minimal::{MinimalOptions, Solver};
use tdoa::{Layout, Pseudoranges, SimulateOptions, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // What the process allocates once is no solver's.
    Solver::new().solve(&problem(5, 6, 0)?, &MinimalOptions::default())?;
    println!("size   kept by the solver  of later solves: largest peak  most allocations  of these in the result");
    for (receivers, transmitters) in [(6, 3), (5, 4), (4, 5), (5, 6)] {
        let problems = (0..20).map(|seed| problem(receivers, transmitters, seed)).collect::<Result<Vec<_>, _>>()?;
        let (mut solver, options) = (Solver::new(), MinimalOptions::default());
        let mut first = None;
        let start = measure(|| first = solver.solve(&problems[0], &options).ok());
        let result = measure(|| drop(first.clone()));
        let kept = start.bytes_current - result.bytes_max as i64;

        let (mut peak, mut most, mut own) = (0, 0, 0);
        for problem in &problems[1..] {
            let mut found = None;
            let solve = measure(|| found = solver.solve(problem, &options).ok());
            if solve.count_total > most {
                (most, own) = (solve.count_total, measure(|| drop(found.clone())).count_total);
            }
            peak = peak.max(solve.bytes_max);
        }
        println!("{receivers}r/{transmitters}s {:16} KB {:26} KB {most:17} {own:23}", kept / 1024, peak / 1024);
    }
    Ok(())
}

fn problem(receivers: usize, transmitters: usize, seed: u64) -> Result<Pseudoranges, tdoa::SimulateError> {
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters, options.seed) = (receivers, transmitters, seed);
    options.layout = Layout::Normal;
    Ok(simulate(&options)?.pseudoranges)
}
