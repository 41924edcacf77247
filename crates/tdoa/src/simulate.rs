//! Random networks and their measurements.

mod layout;

use std::array::from_fn;

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_distr::{Exp1, StandardNormal};
use rand_pcg::Pcg64Mcg;
use thiserror::Error;

pub use layout::Layout;

use crate::clocks::Emissions;
use crate::network::Network;
use crate::points::distance;
use crate::pseudoranges::{PseudorangeError, Pseudoranges};

/// An error that all measurements of one receiver have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ReceiverFault {
    /// All its measurements are this much too long, metres.
    Delay(f64),
    /// Its clock drifts: the error grows evenly from zero at the first transmitter to this value at
    /// the last one, metres.
    Drift(f64),
    /// It is moved by this much in x, metres, after half of the transmitters.
    Move(f64),
}

/// Options of a simulation. `Default` is the plane; `SimulateOptions::<3>::new()` is space.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SimulateOptions<const D: usize = 2> {
    /// Number of receivers. Default 8.
    pub receivers: usize,
    /// Number of transmitters. Default 12.
    pub transmitters: usize,
    /// Where the nodes lie. Default: a room of 10 m by 10 m, in space 3 m high.
    pub layout: Layout<D>,
    /// Standard deviation of the normal noise on every measurement, metres. Default 0.
    pub noise: f64,
    /// Share of the measurements, 0 to 1, that are outliers; their number is rounded. Default 0.
    pub outliers: f64,
    /// Outliers have an additional error that is uniform in plus or minus this, metres. Default 10.
    pub outlier_size: f64,
    /// Share of the measurements, 0 to 1, that are missing; their number is rounded. Default 0.
    pub missing: f64,
    /// Number of receivers, the nearest ones, that hear each transmitter. Default `None`: all.
    pub hearing: Option<usize>,
    /// Share of the measurements, 0 to 1, that take a detour; their number is rounded. Default 0.
    pub detours: f64,
    /// Detours are longer by an exponentially distributed length with this mean, metres. Default 1.
    pub detour_size: f64,
    /// Number of candidates of each measurement, 1 to 100. Further ones are late by exponentially distributed
    /// lengths with the mean `detour_size`, but the second candidate of outliers and detours is the right value.
    /// Default 1.
    pub candidates: usize,
    /// Error of the first receiver. Default `None`.
    pub fault: Option<ReceiverFault>,
    /// Standard deviation of a constant error of each recorder, metres. Default 0.
    pub delays: f64,
    /// Standard deviation of the rates of the recorders' clocks, as a share: 1e-6 is one part in a million. Default 0.
    pub rates: f64,
    /// Receivers that share a recorder, 1 or more: the first ones, the next ones, and so on. Default 1.
    pub channels: usize,
    /// Transmitters send at times that are uniform over this, metres: seconds times the speed. Default `None`: as the layout
    /// says.
    pub duration: Option<f64>,
    /// Whether transmitters have offsets of their own, one offset, or none. Default [`Emissions::Unknown`]: each has one.
    pub emissions: Emissions,
    /// Seed of the random numbers. Default 0.
    pub seed: u64,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl<const D: usize> SimulateOptions<D> {
    /// The defaults, in the plane or in space.
    pub fn new() -> Self {
        SimulateOptions {
            receivers: 8,
            transmitters: 12,
            layout: Layout::Room { extent: from_fn(|k| if k < 2 { 10.0 } else { 3.0 }) },
            noise: 0.0,
            outliers: 0.0,
            outlier_size: 10.0,
            missing: 0.0,
            hearing: None,
            detours: 0.0,
            detour_size: 1.0,
            candidates: 1,
            fault: None,
            delays: 0.0,
            rates: 0.0,
            channels: 1,
            duration: None,
            emissions: Emissions::Unknown,
            seed: 0,
        }
    }
}

/// A simulated network with its measurements.
#[derive(Debug, Clone)]
pub struct Simulation<const D: usize = 2> {
    /// The true network.
    pub network: Network<D>,
    /// The measurements.
    pub pseudoranges: Pseudoranges,
    /// Which cells are outliers, row-major.
    pub outliers: Vec<bool>,
    /// The clock of each receiver's recorder: its offset in metres, and its rate as a share.
    pub clocks: Vec<[f64; 2]>,
}

/// Why nothing can be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A number is outside its range.
    #[error("{name} must be {range}, not {value}")]
    Range {
        /// Name of the option.
        name: &'static str,
        /// The allowed range.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// The size of the network is not possible.
    #[error(transparent)]
    Matrix(#[from] PseudorangeError),
}

/// A random network in the plane (`D` = 2) or in space (`D` = 3) and its measurements. The same
/// options give the same result on any machine.
///
/// # Errors
/// If an option is out of range, or there are too many cells.
///
/// ```
/// let mut options = tdoa::SimulateOptions::default();
/// options.noise = 0.01;
/// let simulation = tdoa::simulate(&options)?;
/// assert!(simulation.network.rms(&simulation.pseudoranges) < 0.02);
/// # Ok::<(), tdoa::SimulateError>(())
/// ```
///
/// In space:
///
/// ```
/// let mut options = tdoa::SimulateOptions::<3>::new();
/// options.layout = tdoa::Layout::Room { extent: [20.0, 10.0, 4.0] };
/// let [x, y, z] = tdoa::simulate(&options)?.network.receivers[0];
/// assert!(x <= 20.0 && y <= 10.0 && z <= 4.0);
/// # Ok::<(), tdoa::SimulateError>(())
/// ```
///
/// No other dimension compiles:
///
/// ```compile_fail,E0080
/// let _ = tdoa::simulate(&tdoa::SimulateOptions::<4>::new());
/// ```
pub fn simulate<const D: usize>(options: &SimulateOptions<D>) -> Result<Simulation<D>, SimulateError> {
    const { assert!(D == 2 || D == 3, "networks are in the plane (D = 2) or in space (D = 3)") }
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
    let mut network = options.layout.network(m, n, &mut rng);
    if let Some(duration) = options.duration {
        network.offsets.iter_mut().for_each(|offset| *offset = duration * rng.random::<f64>());
    }
    options.emissions.settle(&mut network.offsets);
    let mut values = network.pseudoranges();
    for value in &mut values {
        *value += options.noise * rng.sample::<f64, _>(StandardNormal);
    }
    spoil(&mut values, &network, options);
    let clocks = clocks(options, &mut rng);
    for ((value, clock), reading) in
        values.iter_mut().zip(clocks.iter().flat_map(|c| std::iter::repeat_n(c, n))).zip(network.pseudoranges())
    {
        *value += clock[0] + clock[1] * reading;
    }
    let mut order = audible(&network, options.hearing);
    for (k, value) in values.iter_mut().enumerate() {
        if order.binary_search(&k).is_err() {
            *value = f64::NAN;
        }
    }
    order.shuffle(&mut rng);
    // Missing cells come first so that a share of outliers means outliers that are there to be
    // seen.
    let share = |share: f64| (share * order.len() as f64).round() as usize;
    let missing = share(options.missing).min(order.len());
    let outlying = share(options.outliers).min(order.len() - missing);
    let detours = share(options.detours).min(order.len() - missing - outlying);
    for &k in &order[..missing] {
        values[k] = f64::NAN;
    }
    let right = if options.candidates > 1 { values.clone() } else { Vec::new() };
    let mut outliers = vec![false; cells];
    for &k in &order[missing + outlying..missing + outlying + detours] {
        values[k] += options.detour_size * rng.sample::<f64, _>(Exp1);
        outliers[k] = true;
    }
    for &k in &order[missing..missing + outlying] {
        values[k] += options.outlier_size * rng.random_range(-1.0..=1.0);
        outliers[k] = true;
    }
    let mut further = Vec::new();
    for (k, &value) in right.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
        for candidate in 1..options.candidates {
            let late = if candidate == 1 && outliers[k] { 0.0 } else { rng.sample::<f64, _>(Exp1) };
            further.push((k / n, k % n, value + options.detour_size * late));
        }
    }
    let mut pseudoranges = Pseudoranges::new(m, n, values)?.with_candidates(further)?;
    if options.channels > 1 {
        let channel = |i: usize| (i / options.channels + 1, i % options.channels + 1);
        let names = (0..m).map(channel).map(|(recorder, channel)| format!("rec{recorder}:{channel}")).collect();
        pseudoranges = pseudoranges.with_receiver_names(names)?;
    }
    Ok(Simulation { network, pseudoranges, outliers, clocks })
}

/// The clock of each receiver: offset and rate.
fn clocks<const D: usize>(options: &SimulateOptions<D>, rng: &mut Pcg64Mcg) -> Vec<[f64; 2]> {
    let recorders = options.receivers.div_ceil(options.channels);
    let mut deviating = |deviation: f64| -> Vec<f64> {
        let draw = |_| if deviation > 0.0 { deviation * rng.sample::<f64, _>(StandardNormal) } else { 0.0 };
        (0..recorders).map(draw).collect()
    };
    let (offsets, rates) = (deviating(options.delays), deviating(options.rates));
    (0..options.receivers).map(|i| i / options.channels).map(|recorder| [offsets[recorder], rates[recorder]]).collect()
}

/// Adds the error of the first receiver.
fn spoil<const D: usize>(values: &mut [f64], network: &Network<D>, options: &SimulateOptions<D>) {
    let n = network.transmitters.len();
    for j in 0..n {
        values[j] += match options.fault {
            None => 0.0,
            Some(ReceiverFault::Delay(delay)) => delay,
            Some(ReceiverFault::Drift(total)) => total * j as f64 / (n.max(2) - 1) as f64,
            Some(ReceiverFault::Move(_)) if j < n / 2 => 0.0,
            Some(ReceiverFault::Move(by)) => {
                let mut moved = network.receivers[0];
                moved[0] += by;
                distance(moved, network.transmitters[j]) - network.distance(0, j)
            }
        };
    }
}

/// The cells, row-major, of transmitters and the receivers that hear them, in ascending order.
fn audible<const D: usize>(network: &Network<D>, hearing: Option<usize>) -> Vec<usize> {
    let (m, n) = (network.receivers.len(), network.transmitters.len());
    let Some(hearing) = hearing.filter(|&hearing| hearing < m) else { return (0..m * n).collect() };
    let mut cells = Vec::with_capacity(hearing * n);
    let mut order: Vec<usize> = (0..m).collect();
    for j in 0..n {
        order.sort_by(|&a, &b| network.distance(a, j).total_cmp(&network.distance(b, j)));
        cells.extend(order[..hearing].iter().map(|i| i * n + j));
    }
    cells.sort_unstable();
    cells
}

fn check<const D: usize>(options: &SimulateOptions<D>) -> Result<(), SimulateError> {
    let fraction = "between 0 and 1";
    let size = "finite and not negative";
    let fault = match options.fault {
        None => 0.0,
        Some(ReceiverFault::Delay(size) | ReceiverFault::Drift(size) | ReceiverFault::Move(size)) => size,
    };
    let checks = [
        ("the share of outliers", fraction, options.outliers, (0.0..=1.0).contains(&options.outliers)),
        ("the share of missing measurements", fraction, options.missing, (0.0..=1.0).contains(&options.missing)),
        ("the noise", size, options.noise, (0.0..1e9).contains(&options.noise)),
        ("the size of outliers", size, options.outlier_size, (0.0..1e9).contains(&options.outlier_size)),
        ("the share of detours", fraction, options.detours, (0.0..=1.0).contains(&options.detours)),
        ("the size of detours", size, options.detour_size, (0.0..1e9).contains(&options.detour_size)),
        (
            "the number of candidates",
            "from 1 to 100",
            options.candidates as f64,
            (1..=100).contains(&options.candidates),
        ),
        ("the deviation of delays", size, options.delays, (0.0..1e9).contains(&options.delays)),
        ("the deviation of rates", "from 0 to 0.1", options.rates, (0.0..=0.1).contains(&options.rates)),
        ("the number of channels", "1 or more", options.channels as f64, options.channels > 0),
        (
            "the duration",
            size,
            options.duration.unwrap_or_default(),
            (0.0..1e11).contains(&options.duration.unwrap_or_default()),
        ),
        ("the first receiver's error", "finite and below 1e9 m", fault, fault.abs() < 1e9),
    ];
    let names = ["the extent in x", "the extent in y", "the extent in z"];
    let extents = names.into_iter().zip(options.layout.extent());
    let extents = extents.map(|(name, side)| (name, "positive and at most 1e9 m", side, side > 0.0 && side <= 1e9));
    match checks.into_iter().chain(extents).find(|(.., good)| !good) {
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

    fn assert_nearest_hear<const D: usize>(layout: Layout<D>) {
        let options =
            SimulateOptions { receivers: 17, transmitters: 30, hearing: Some(6), layout, ..SimulateOptions::new() };
        let simulation = simulate(&options).unwrap();
        let (network, measured) = (&simulation.network, &simulation.pseudoranges);
        for j in 0..30 {
            let (heard, silent): (Vec<usize>, Vec<usize>) = (0..17).partition(|&i| measured.get(i, j).is_some());
            let farthest = heard.iter().map(|&i| network.distance(i, j)).fold(0.0, f64::max);
            assert_eq!(heard.len(), 6);
            assert!(silent.iter().all(|&i| network.distance(i, j) >= farthest));
        }
    }

    #[test]
    fn a_transmitter_is_heard_by_the_nearest_receivers() {
        assert_nearest_hear(Layout::Chain { extent: [1000.0, 50.0] });
        assert_nearest_hear(Layout::Grid { extent: [1000.0, 1000.0] });
        assert_nearest_hear(SimulateOptions::default().layout);
        assert_nearest_hear(Layout::Chain { extent: [1000.0, 50.0, 200.0] });
        assert_nearest_hear(Layout::Grid { extent: [100.0, 100.0, 100.0] });
        assert_nearest_hear(SimulateOptions::<3>::new().layout);
    }

    #[test]
    fn networks_in_space_have_no_residuals_without_noise() {
        let extent = [30.0, 20.0, 10.0];
        for layout in [Layout::Normal, Layout::Room { extent }, Layout::Chain { extent }, Layout::Grid { extent }] {
            let simulation = simulate(&SimulateOptions { layout, ..SimulateOptions::new() }).unwrap();
            let measured = &simulation.pseudoranges;
            assert_eq!((measured.receivers(), measured.transmitters(), measured.observed()), (8, 12, 96));
            for (i, j, value) in measured.cells().iter() {
                let [[a, b, c], [x, y, z]] = [simulation.network.receivers[i], simulation.network.transmitters[j]];
                let distance = ((a - x).powi(2) + (b - y).powi(2) + (c - z).powi(2)).sqrt();
                assert!((value - distance - simulation.network.offsets[j]).abs() < 1e-12, "{layout:?}");
            }
        }
    }

    #[test]
    fn faults_are_those_of_the_first_receiver() {
        assert_faults(&SimulateOptions::default());
        assert_faults(&SimulateOptions::<3>::new());
    }

    fn assert_faults<const D: usize>(options: &SimulateOptions<D>) {
        for (fault, first, last) in [
            (ReceiverFault::Delay(0.3), Some(0.3), Some(0.3)),
            (ReceiverFault::Drift(0.4), Some(0.0), Some(0.4)),
            (ReceiverFault::Move(1.0), Some(0.0), None),
        ] {
            let simulation = simulate(&SimulateOptions { fault: Some(fault), ..options.clone() }).unwrap();
            let residuals = simulation.network.residuals(&simulation.pseudoranges);
            assert!(residuals[12..].iter().all(|e| e.abs() < 1e-12));
            for (found, expected) in [(residuals[0], first), (residuals[11], last)] {
                assert!(expected.is_none_or(|expected| (found - expected).abs() < 1e-12), "{fault:?}: {found}");
            }
            // The triangle inequality bounds what a move changes.
            assert!(residuals[..12].iter().all(|e| e.abs() <= 1.0 + 1e-12));
        }
    }

    #[test]
    fn detours_only_lengthen() {
        let options = SimulateOptions { detours: 0.25, detour_size: 0.5, ..Default::default() };
        let simulation = simulate(&options).unwrap();
        let residuals = simulation.network.residuals(&simulation.pseudoranges);
        assert_eq!(residuals.iter().filter(|e| **e > 1e-9).count(), 24);
        assert!(residuals.iter().all(|e| *e > -1e-9));
    }

    #[test]
    fn recorders_are_off_and_run_fast_or_slow() {
        let options = SimulateOptions {
            delays: 5.0,
            rates: 2e-5,
            channels: 3,
            duration: Some(2e5),
            missing: 0.2,
            ..SimulateOptions::<3>::new()
        };
        let made = simulate(&options).unwrap();
        let (measured, network) = (&made.pseudoranges, &made.network);
        assert_eq!(measured.recorders(), [0, 0, 0, 1, 1, 1, 2, 2]);
        assert_eq!((measured.recorder_name(5), measured.receiver_names()[5].as_str()), ("rec2", "rec2:3"));
        assert!(made.clocks[0] == made.clocks[2] && made.clocks[2] != made.clocks[3]);
        for (i, j, value) in measured.cells().iter() {
            let ([offset, rate], time) = (made.clocks[i], network.pseudorange(i, j));
            assert!((value - offset - (1.0 + rate) * time).abs() < 1e-9 && (0.0..2.1e5).contains(&time));
        }
    }

    fn assert_seed_decides<const D: usize>(mut options: SimulateOptions<D>) {
        options.noise = 0.1;
        let first = simulate(&options).unwrap();
        let again = simulate(&options).unwrap();
        assert_eq!(first.network, again.network);
        assert_eq!(first.pseudoranges.dense(), again.pseudoranges.dense());
        options.seed = 1;
        assert_ne!(first.pseudoranges.dense(), simulate(&options).unwrap().pseudoranges.dense());
    }

    #[test]
    fn same_seed_same_network() {
        assert_seed_decides(SimulateOptions { layout: Layout::Normal, ..Default::default() });
        assert_seed_decides(SimulateOptions::<3>::new());
    }

    #[test]
    fn the_second_candidate_of_what_is_wrong_is_right() {
        let options =
            SimulateOptions { detours: 0.25, outliers: 0.125, missing: 0.5, candidates: 3, ..Default::default() };
        let made = simulate(&options).unwrap();
        let (measured, network) = (&made.pseudoranges, &made.network);
        let mut wrong = 0;
        for (i, j, value) in measured.cells().iter() {
            let off: Vec<f64> = measured.candidates(i, j).iter().map(|f| f - network.pseudorange(i, j)).collect();
            assert!(off.len() == 3 && measured.candidates(i, j)[0] == *value);
            let is_wrong = made.outliers[12 * i + j];
            assert_eq!([off[0].abs() > 1e-9, off[1].abs() > 1e-9, off[2] > 1e-9], [is_wrong, !is_wrong, true]);
            wrong += usize::from(is_wrong);
        }
        // A quarter and an eighth of all 96 cells, none of them among the 48 that are missing.
        assert_eq!(wrong, 24 + 12);
        // First ones are those without further ones.
        let plain = simulate(&SimulateOptions { candidates: 1, ..options }).unwrap();
        assert!(!plain.pseudoranges.has_candidates() && plain.pseudoranges.cells() == measured.cells());
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

    #[test]
    fn refuses_extents_out_of_range_by_name() {
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            for side in [0.0, -1.0, 2e9, f64::INFINITY, f64::NAN] {
                let mut extent = [5.0; 3];
                extent[k] = side;
                for layout in [Layout::Room { extent }, Layout::Chain { extent }, Layout::Grid { extent }] {
                    let error = simulate(&SimulateOptions { layout, ..SimulateOptions::new() }).unwrap_err();
                    let expected = format!("the extent in {name} must be positive and at most 1e9 m, not {side}");
                    assert_eq!(error.to_string(), expected);
                }
            }
        }
        let layout = Layout::Room { extent: [5.0, 0.0] };
        let error = simulate(&SimulateOptions { layout, ..Default::default() }).unwrap_err();
        assert!(error.to_string().starts_with("the extent in y"));
    }
}
