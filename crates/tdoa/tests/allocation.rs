//! A minimal solver that has been used allocates memory for its results alone, whatever becomes of
//! the paths.

use allocation_counter::measure;
use tdoa::minimal::{MinimalOptions, Solver};
use tdoa::{Layout, SimulateOptions, simulate};

#[test]
fn later_solves_allocate_their_results_alone() {
    let mut retracked = 0;
    for (receivers, transmitters) in [(6, 3), (5, 4), (4, 5), (5, 6)] {
        let (mut solver, solve_options) = (Solver::new(), MinimalOptions::default());
        for seed in 0..40 {
            let mut options = SimulateOptions::default();
            (options.receivers, options.transmitters, options.seed) = (receivers, transmitters, seed);
            options.layout = Layout::Normal;
            let problem = simulate(&options).unwrap().pseudoranges;
            let mut found = None;
            let solve = measure(|| found = solver.solve(&problem, &solve_options).ok());
            let result = measure(|| drop(found.clone()));
            let found = found.unwrap();
            retracked += found.paths.retracked;
            // The first call makes all memory; warnings are written piece by piece.
            if seed > 0 && found.warnings.is_empty() {
                let (all, own) = (solve.count_total, result.count_total);
                assert!(
                    all <= own,
                    "{receivers}r/{transmitters}s, seed {seed}: {all} allocations, {own} in the result"
                );
            }
        }
    }
    assert!(retracked > 0, "no path was ever tracked again");
}
