//! Every network that explains a small table of arrival times exactly, for each size that has a
//! solver of its own:
//!
//!     cargo run --release -p tdoa --example candidates

use std::time::Instant;
use tdoa::align::align;
use tdoa::minimal::{MinimalOptions, Solver};
use tdoa::{SimulateOptions, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A solver keeps its start solutions and its memory for the next network; here each is used
    // once.
    let (mut solver, exact) = (Solver::new(), MinimalOptions::default());
    println!("size    paths  lost  real  physical  milliseconds  truth among them");
    for (receivers, transmitters) in [(6, 3), (7, 3), (6, 4), (5, 4), (5, 5), (4, 5), (4, 6), (5, 6), (7, 4), (9, 3)] {
        let mut options = SimulateOptions::default();
        (options.receivers, options.transmitters) = (receivers, transmitters);
        let simulation = simulate(&options)?;
        let started = Instant::now();
        let found = solver.solve(&simulation.pseudoranges, &exact)?;
        let milliseconds = 1e3 * started.elapsed().as_secs_f64();

        let truth = &simulation.network.receivers;
        let near = |receivers: &[[f64; 2]]| align(receivers, truth, false).is_some_and(|a| a.rms < 1e-6);
        let among = found.candidates.iter().any(|candidate| near(&candidate.network.receivers));
        println!(
            "{:7} {:5} {:5} {:5} {:9} {milliseconds:13.1}  {among}",
            found.configuration, found.paths.tracked, found.paths.failed, found.counts.real, found.counts.physical
        );
        if !among {
            return Err(format!("{}: the true network is missing", found.configuration).into());
        }
    }
    Ok(())
}
