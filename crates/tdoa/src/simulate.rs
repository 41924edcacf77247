//! Random networks and their measurements.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use thiserror::Error;

use crate::network::Network;
use crate::pseudoranges::{PseudorangeError, Pseudoranges};

/// Where the nodes of a random network lie.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Layout {
    /// Coordinates and offsets standard normal, as in the paper's experiments.
    Normal,
    /// Positions uniform in a rectangle, offsets uniform in plus or minus its diagonal.
    Room {
        /// Extent in x, metres.
        width: f64,
        /// Extent in y, metres.
        height: f64,
    },
}

/// What to simulate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SimulateOptions {
    /// Number of receivers. Default 8.
    pub receivers: usize,
    /// Number of transmitters. Default 12.
    pub transmitters: usize,
    /// Where the nodes lie. Default: a room of 10 m by 10 m.
    pub layout: Layout,
    /// Standard deviation of the normal noise on every measurement, metres. Default 0.
    pub noise: f64,
    /// Share of the measurements, 0 to 1, that are outliers; their number is rounded. Default 0.
    pub outliers: f64,
    /// Outliers have an error added that is uniform in plus or minus this, metres. Default 10.
    pub outlier_size: f64,
    /// Share of the measurements, 0 to 1, that are missing; their number is rounded. Default 0.
    pub missing: f64,
    /// Seed of the random numbers. Default 0.
    pub seed: u64,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        SimulateOptions {
            receivers: 8,
            transmitters: 12,
            layout: Layout::Room { width: 10.0, height: 10.0 },
            noise: 0.0,
            outliers: 0.0,
            outlier_size: 10.0,
            missing: 0.0,
            seed: 0,
        }
    }
}

/// A simulated network with its measurements.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The true network.
    pub network: Network,
    /// What is measured of it.
    pub pseudoranges: Pseudoranges,
    /// Row-major: which cells are outliers.
    pub outliers: Vec<bool>,
}

/// Why nothing can be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A number outside its range.
    #[error("{name} must be {range}, not {value}")]
    Range {
        /// Name of the option.
        name: &'static str,
        /// What is allowed.
        range: &'static str,
        /// What was given.
        value: f64,
    },
    /// The size of the network.
    #[error(transparent)]
    Matrix(#[from] PseudorangeError),
}

/// A random network and its measurements, the same for the same options on any machine.
///
/// # Errors
/// Options outside their range, or too many cells.
///
/// ```
/// let mut options = tdoa::SimulateOptions::default();
/// options.noise = 0.01;
/// let simulation = tdoa::simulate(&options)?;
/// assert!(simulation.network.rms(&simulation.pseudoranges) < 0.02);
/// # Ok::<(), tdoa::SimulateError>(())
/// ```
pub fn simulate(options: &SimulateOptions) -> Result<Simulation, SimulateError> {
    check(options)?;
    let (m, n) = (options.receivers, options.transmitters);
    // The size is checked before anything of that size is made.
    let cells = m.checked_mul(n).filter(|&cells| cells <= crate::pseudoranges::MAX_CELLS);
    let cells = cells.ok_or(PseudorangeError::TooLarge { receivers: m, transmitters: n })?;
    // No cells at all do not bound the number of nodes.
    if cells == 0 {
        return Err(PseudorangeError::Empty { receivers: m, transmitters: n }.into());
    }
    let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
    let network = random_network(m, n, options.layout, &mut rng);
    let mut values = network.pseudoranges();
    for value in &mut values {
        *value += options.noise * rng.sample::<f64, _>(StandardNormal);
    }
    let mut order: Vec<usize> = (0..cells).collect();
    order.shuffle(&mut rng);
    // Missing cells come first so that a share of outliers means outliers that are there to be seen.
    let missing = ((options.missing * cells as f64).round() as usize).min(cells);
    let outlying = ((options.outliers * cells as f64).round() as usize).min(cells - missing);
    for &k in &order[..missing] {
        values[k] = f64::NAN;
    }
    let mut outliers = vec![false; cells];
    for &k in &order[missing..missing + outlying] {
        values[k] += options.outlier_size * rng.random_range(-1.0..=1.0);
        outliers[k] = true;
    }
    Ok(Simulation { network, pseudoranges: Pseudoranges::new(m, n, values)?, outliers })
}

fn random_network(m: usize, n: usize, layout: Layout, rng: &mut Pcg64Mcg) -> Network {
    let mut point = || match layout {
        Layout::Normal => [rng.sample(StandardNormal), rng.sample(StandardNormal)],
        Layout::Room { width, height } => [width * rng.random::<f64>(), height * rng.random::<f64>()],
    };
    let receivers = (0..m).map(|_| point()).collect();
    let transmitters = (0..n).map(|_| point()).collect();
    let offsets = (0..n).map(|_| match layout {
        Layout::Normal => rng.sample(StandardNormal),
        Layout::Room { width, height } => width.hypot(height) * rng.random_range(-1.0..=1.0),
    });
    Network { receivers, transmitters, offsets: offsets.collect() }
}

fn check(options: &SimulateOptions) -> Result<(), SimulateError> {
    let fraction = "between 0 and 1";
    let size = "finite and not negative";
    let (width, height) = match options.layout {
        Layout::Normal => (1.0, 1.0),
        Layout::Room { width, height } => (width, height),
    };
    let checks = [
        ("the share of outliers", fraction, options.outliers, (0.0..=1.0).contains(&options.outliers)),
        ("the share of missing measurements", fraction, options.missing, (0.0..=1.0).contains(&options.missing)),
        ("the noise", size, options.noise, (0.0..1e9).contains(&options.noise)),
        ("the size of outliers", size, options.outlier_size, (0.0..1e9).contains(&options.outlier_size)),
        ("the room's width", "positive and at most 1e9 m", width, width > 0.0 && width <= 1e9),
        ("the room's height", "positive and at most 1e9 m", height, height > 0.0 && height <= 1e9),
    ];
    match checks.into_iter().find(|(.., good)| !good) {
        None => Ok(()),
        Some((name, range, value, _)) => Err(SimulateError::Range { name, range, value }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_outliers_and_missing_cells_are_exact() {
        let options =
            SimulateOptions { outliers: 0.1, missing: 0.2, receivers: 10, transmitters: 20, ..Default::default() };
        let simulation = simulate(&options).unwrap();
        assert_eq!(simulation.pseudoranges.observed(), 160);
        assert_eq!(simulation.outliers.iter().filter(|&&o| o).count(), 20);
        // Without noise exactly the outliers have a residual.
        let residuals = simulation.network.residuals(&simulation.pseudoranges);
        for (residual, outlier) in residuals.iter().zip(&simulation.outliers) {
            assert!(residual.is_nan() || (residual.abs() > 1e-9) == *outlier);
        }
    }

    #[test]
    fn same_seed_same_network() {
        let mut options = SimulateOptions { noise: 0.1, layout: Layout::Normal, ..Default::default() };
        let first = simulate(&options).unwrap();
        assert_eq!(first.pseudoranges.values(), simulate(&options).unwrap().pseudoranges.values());
        options.seed = 1;
        assert_ne!(first.pseudoranges.values(), simulate(&options).unwrap().pseudoranges.values());
    }

    #[test]
    fn refuses_numbers_out_of_range() {
        for (outliers, noise, receivers) in [(1.5, 0.0, 3), (f64::NAN, 0.0, 3), (0.0, -1.0, 3), (0.0, 0.0, 0)] {
            let options = SimulateOptions { outliers, noise, receivers, ..Default::default() };
            assert!(simulate(&options).is_err());
        }
        let options = SimulateOptions { receivers: usize::MAX, ..Default::default() };
        assert!(simulate(&options).is_err());
    }
}
