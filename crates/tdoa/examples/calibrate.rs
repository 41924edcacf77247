//! A network calibrated from a table of arrival times, and a picture of the result where a file for
//! it is named:
//!
//!     cargo run --release -p tdoa --example calibrate -- network.svg

use tdoa::{CalibrateOptions, SimulateOptions, calibrate, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // In place of a recording: `tdoa::read::read` takes one from a file.
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters) = (10, 20);
    (options.noise, options.outliers, options.missing) = (0.01, 0.1, 0.1);
    let simulation = simulate(&options)?;

    let network = calibrate(&simulation.pseudoranges, &CalibrateOptions::default())?;
    println!("{}, noise {:.4} m, unique: {}", network.configuration, network.sigma, network.unique);
    let receivers = network.receivers.iter().zip(&network.receiver_std);
    for (name, (position, deviation)) in network.receiver_names.iter().zip(receivers) {
        match (position, deviation) {
            (Some([x, y]), Some([dx, dy])) => println!("{name:>4}: {x:8.3} +- {dx:.3}  {y:8.3} +- {dy:.3} m"),
            _ => println!("{name:>4}: not determined"),
        }
    }
    for warning in &network.warnings {
        println!("warning: {warning}");
    }
    let called = network.residuals.outliers().count();
    println!("{called} measurements called outliers, {} are", simulation.outliers.iter().filter(|&&o| o).count());

    if let Some(file) = std::env::args_os().nth(1) {
        std::fs::write(file, tdoa::picture::picture(&network))?;
    }
    Ok(())
}
