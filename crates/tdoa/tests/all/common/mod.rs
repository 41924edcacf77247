//! Networks that several tests solve.

use tdoa::{Layout, SimulateOptions, Simulation, simulate};

/// A network without noise whose positions and offsets are standard normal.
pub(crate) fn clean(receivers: usize, transmitters: usize, seed: u64) -> Simulation {
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters, options.seed) = (receivers, transmitters, seed);
    options.layout = Layout::Normal;
    simulate(&options).unwrap()
}
