//! How calibrations go wrong that call their network unique: 250 simulated networks of 6 receivers
//! and 10 transmitters, 1 cm of noise, a tenth of the measurements gone and a tenth of the others
//! wrong, beside the same search started at the truth.
//!
//!     cargo run --release -p experiments --example mistaken

use experiments::trials::calibration::{judge, oracle};
use tdoa::{CalibrateOptions, SimulateOptions, calibrate, simulate};

const NETWORKS: u64 = 250;
const NOISE: f64 = 0.01;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut unique, mut wrong, mut noisy, mut preferred) = (0, 0, 0, 0);
    for seed in 0..NETWORKS {
        let mut options = SimulateOptions::default();
        (options.receivers, options.transmitters, options.seed) = (6, 10, seed);
        (options.noise, options.outliers, options.missing) = (NOISE, 0.1, 0.1);
        let simulation = simulate(&options)?;
        let mut options = CalibrateOptions::default();
        options.seed = seed;
        let result = calibrate(&simulation.pseudoranges, &options);
        let trial = judge(&simulation, NOISE, seed, 0.0, &result);
        unique += usize::from(trial.unique);
        if !trial.unique || trial.success() {
            continue;
        }
        let Ok(found) = result else { continue };

        // Where the search ends if it starts at the truth: elsewhere, if the data prefer that.
        let truth: Vec<_> = simulation.network.receivers.iter().map(|&r| Some(r)).collect();
        let best = oracle(&simulation.pseudoranges, &truth, &options)?;
        let rms = best.truth.as_ref().map_or(f64::NAN, |truth| truth.receiver_rms);
        let astray = rms > 3.0 * trial.bound;
        let error = trial.receiver_rms.unwrap_or(f64::NAN);
        let factor = found.sigma / NOISE;
        println!(
            "seed {seed:3}: receivers off by {error:6.3} m (allowed {:6.3} m), noise taken for {factor:5.1} times as large; from the truth {rms:6.3} m",
            3.0 * trial.bound
        );
        wrong += 1;
        noisy += usize::from(factor > 1.5);
        preferred += usize::from(astray);
    }
    println!("{NETWORKS} networks, {unique} called unique, {wrong} of them wrong");
    println!(
        "noise estimated at more than 1.5 times what it is: {noisy}; searches from the truth that fail too: {preferred}"
    );
    Ok(())
}
