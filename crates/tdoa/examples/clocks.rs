//! What unknown clocks cost: Cramer-Rao bounds of the receivers' positions, as multiples of the bound where receivers share a
//! clock and nothing is known of send times. Root mean square over twenty random networks of ten receivers and thirty
//! transmitters in a room of 10 m by 10 m, in space 3 m high, heard for ten minutes at 343 m/s:
//!
//!     cargo run --release -p tdoa --example clocks

use std::error::Error;
use tdoa::accuracy::cramer_rao_with_clocks;
use tdoa::{Clocks, Emissions, ReceiverClocks, SimulateOptions, simulate};

const NOISE: f64 = 0.01;
const NETWORKS: u64 = 20;
const MINUTES: f64 = 10.0;
const SPEED: f64 = 343.0;

/// The options of a pinger that sends by a schedule of its own clock.
const SCHEDULE: &str = "--emissions constant --times FILE";

/// The bound with these unknowns and so many receivers a recorder, metres. Transmitters may send by a schedule: at times that
/// are known, by a clock of their own.
fn bound<const D: usize>(clocks: Clocks, channels: usize, is_scheduled: bool) -> Result<f64, Box<dyn Error>> {
    let mut squares = 0.0;
    for seed in 0..NETWORKS {
        let mut options = SimulateOptions::<D>::new();
        (options.receivers, options.transmitters, options.noise, options.seed) = (10, 30, NOISE, seed);
        let emissions = if is_scheduled { Emissions::Unknown } else { clocks.emissions };
        (options.channels, options.emissions, options.duration) = (channels, emissions, Some(60.0 * MINUTES * SPEED));
        let made = simulate(&options)?;
        let mut measured = made.pseudoranges;
        if is_scheduled {
            measured = measured.with_emission_times(made.network.offsets.clone())?;
        }
        squares += cramer_rao_with_clocks(&measured, &made.outliers, &made.network, NOISE, &clocks).powi(2);
    }
    Ok((squares / NETWORKS as f64).sqrt())
}

fn main() -> Result<(), Box<dyn Error>> {
    let model = |emissions, receivers| {
        let mut clocks = Clocks::default();
        (clocks.emissions, clocks.receivers) = (emissions, receivers);
        clocks
    };
    let plain = (bound::<2>(Clocks::default(), 1, false)?, bound::<3>(Clocks::default(), 1, false)?);
    for (options, emissions, receivers) in [
        ("none", Emissions::Unknown, ReceiverClocks::Common),
        ("--ranges", Emissions::Known, ReceiverClocks::Common),
        ("--emissions constant", Emissions::Constant, ReceiverClocks::Common),
        (SCHEDULE, Emissions::Constant, ReceiverClocks::Common),
        ("--receiver-clocks offset", Emissions::Unknown, ReceiverClocks::Offset),
        ("--receiver-clocks rate", Emissions::Unknown, ReceiverClocks::Rate),
        ("--ranges --receiver-clocks offset", Emissions::Known, ReceiverClocks::Offset),
        ("--ranges --receiver-clocks rate", Emissions::Known, ReceiverClocks::Rate),
    ] {
        let channels: &[usize] = if receivers == ReceiverClocks::Common { &[1] } else { &[1, 2] };
        for &channels in channels {
            let clocks = model(emissions, receivers);
            let is_scheduled = options == SCHEDULE;
            let plane = bound::<2>(clocks, channels, is_scheduled)? / plain.0;
            let space = bound::<3>(clocks, channels, is_scheduled)? / plain.1;
            println!("{options:<33} {channels} to a recorder: {plane:.2} in the plane, {space:.2} in space");
        }
    }
    Ok(())
}
