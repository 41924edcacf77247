//! Calibrations that start at networks found before: at a planar one with heights, or as they are.

use crate::calibrate::options::{CalibrateError, CalibrateOptions, SearchOptions};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::hypotheses::{Hypotheses, generator};
use crate::calibrate::steps::Draft;
use crate::points::spread;
use crate::pseudoranges::Pseudoranges;
use crate::refine::PartialNetwork;
use hc::Monitor;
use rand::RngExt;
use rand_distr::StandardNormal;

/// Heights of a planar network's starts in space, as shares of its size.
const LIFTED: [f64; 6] = [0.03, 0.1, 0.3, 0.03, 0.1, 0.3];

/// Starts in space from a planar network.
struct Lifted<'a> {
    names: &'a [String],
    receivers: &'a [Option<[f64; 2]>],
    size: f64,
}

impl Hypotheses<3> for Lifted<'_> {
    fn propose(&self, measured: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork<3>> {
        let mut rng = generator(seed ^ 0x2f0b_4c47_91d3_55e9, index);
        let height = LIFTED[index % LIFTED.len()] * self.size;
        let lift = |p: [f64; 2]| [p[0], p[1], height * rng.sample::<f64, _>(StandardNormal)];
        vec![start(measured, self.names, self.receivers, lift)]
    }
}

/// One start at a network that was found before.
pub(super) struct Known<'a, const D: usize>(pub(super) &'a Calibration<D>);

impl<const D: usize> Hypotheses<D> for Known<'_, D> {
    fn propose(&self, measured: &Pseudoranges, index: usize, _: u64) -> Vec<PartialNetwork<D>> {
        if index == 0 { vec![start(measured, &self.0.receiver_names, &self.0.receivers, |p| p)] } else { Vec::new() }
    }
}

/// Receivers of these names in other places. The search may work on some of the nodes.
fn start<const D: usize, const E: usize>(
    measured: &Pseudoranges,
    names: &[String],
    receivers: &[Option<[f64; D]>],
    mut to: impl FnMut([f64; D]) -> [f64; E],
) -> PartialNetwork<E> {
    let place = |name: &String| names.iter().position(|other| other == name);
    let of = |name: &String| receivers[place(name)?].map(&mut to);
    let receivers = measured.receiver_names().iter().map(of).collect();
    PartialNetwork { receivers, transmitters: vec![None; measured.transmitters()], clocks: Vec::new() }
}

/// A search of so many starts, all from sources that are given.
pub(super) fn from_sources(starts: usize, search: SearchOptions) -> SearchOptions {
    SearchOptions { min_starts: starts, max_starts: starts, restarts: false, minimal_subsets: 0, ..search }
}

/// These options for starts from a planar network.
pub(super) fn from_plane(options: &CalibrateOptions<3>) -> CalibrateOptions<3> {
    CalibrateOptions { search: from_sources(LIFTED.len(), options.search), ..options.clone() }
}

/// Networks in space whose search starts at a planar one, with options [`from_plane`]; `None` where there is none.
pub(super) fn lifted<'a>(
    measured: &'a Pseudoranges,
    options: &'a CalibrateOptions<3>,
    flat: &Draft<'_, 2>,
    monitor: &'a Monitor,
) -> Result<Option<Draft<'a, 3>>, CalibrateError<3>> {
    let receivers: Vec<Option<[f64; 2]>> = flat.state.ranked[0].network.receivers.iter().copied().map(Some).collect();
    let names = flat.state.measured.receiver_names();
    let source = Lifted { names, receivers: &receivers, size: spread(receivers.iter().flatten()) };
    unless_stopped(Draft::roughly(measured, options, &source, monitor))
}

/// What there is; stopping is an error, failing is none.
pub(super) fn unless_stopped<T, const D: usize>(
    ended: Result<T, CalibrateError<D>>,
) -> Result<Option<T>, CalibrateError<D>> {
    match ended {
        Ok(found) => Ok(Some(found)),
        Err(error @ CalibrateError::Cancelled(_)) => Err(error),
        Err(_) => Ok(None),
    }
}
