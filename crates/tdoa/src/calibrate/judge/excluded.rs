//! Whether a plane is out of the question, before errors of receivers are looked for in it.

use crate::calibrate::judge::lifted::{LIFTED, Lifted, from_sources};
use crate::calibrate::options::{CalibrateOptions, Errors, ReceiverDelays};
use crate::calibrate::search::candidates::search_candidates;
use crate::calibrate::search::local::hearing_is_local;
use crate::calibrate::search::truncated_cost::{OUTLIER_COST, truncated};
use crate::calibrate::state::State;
use crate::degeneracy::{Usable, usable};
use crate::observations::{Observation, Observations};
use crate::points::spread;

/// The mean gain of a measurement by heights, as a share of what an outlier costs, above which a plane is out of the
/// question.
const GAIN: f64 = 1.0 / 6.0;

/// Measurements over unknowns in space, at least: fewer fit anything.
const SPARE: f64 = 1.5;

/// Whether heights explain nearly all that a planar network leaves, at the half of the receivers where that is least:
/// errors of fewer receivers are no reason for it. Then what a plane would have of such errors need not be known.
pub(super) fn plane_is_excluded(plane: &State<'_, 2>, options: &CalibrateOptions<3>) -> bool {
    let State { measured, known, monitor, .. } = plane;
    let has_delays = options.receiver_delays == ReceiverDelays::All;
    if has_delays || options.errors == Errors::OneSided || hearing_is_local(measured) {
        return false;
    }
    let Ok(Usable { receivers, transmitters, .. }) = usable::<3>(measured) else { return false };
    let options = CalibrateOptions { search: from_sources(LIFTED.len(), options.search), ..options.clone() };
    let mut space = State::new(measured.select(&receivers, &transmitters), *known, &options, monitor);
    let flat = &plane.ranked[0].network;
    let places: Vec<Option<[f64; 2]>> = flat.receivers.iter().copied().map(Some).collect();
    let source = Lifted { names: measured.receiver_names(), receivers: &places, size: spread(places.iter().flatten()) };
    if search_candidates(&mut space, &[&source]).is_err() || monitor.is_cancelled() {
        return false;
    }
    let (observations, best) = (&space.observations, &space.ranked[0].network);
    if (observations.len() as f64) < SPARE * observations.unknowns() as f64 || space.deviation <= 0.0 {
        return false;
    }
    let in_plane = Observations::<2>::new(measured, |_, _| true);
    let cost = |residual: f64| truncated(residual / space.deviation);
    let of = |receiver: usize| -> (f64, usize) {
        let in_plane = in_plane.of_receiver(receivers[receiver]);
        let in_plane = in_plane.filter(|o| transmitters.binary_search(&o.transmitter).is_ok());
        let before: f64 = in_plane.map(|o| cost(o.residual(flat))).sum();
        let of_receiver: Vec<&Observation> = observations.of_receiver(receiver).collect();
        let after: f64 = of_receiver.iter().map(|o| cost(o.residual(best))).sum();
        (before - after, of_receiver.len())
    };
    let mut gains: Vec<(f64, usize)> = (0..receivers.len()).map(of).collect();
    gains.sort_by(|a, b| (a.0 / a.1 as f64).total_cmp(&(b.0 / b.1 as f64)));
    gains.truncate(gains.len().div_ceil(2));
    let (gain, count) = gains.iter().fold((0.0, 0), |sum, of| (sum.0 + of.0, sum.1 + of.1));
    gain > GAIN * OUTLIER_COST * count as f64
}

#[cfg(test)]
mod tests {
    use crate::calibrate::{Calibrated, calibrate_either};
    use crate::{CalibrateOptions, Layout, ReceiverDelays, ReceiverFault, SimulateOptions, simulate};

    fn is_excluded<const D: usize>(made: &SimulateOptions<D>) -> bool
    where
        crate::calibrate::Dimension<D>: crate::calibrate::Calibrates<D>,
    {
        let made = simulate(made).unwrap();
        let (plane, space) = (CalibrateOptions::<2>::new(), CalibrateOptions::<3>::new());
        let mut excluded = false;
        crate::calibrate::steps::calibrate_looking(&made.pseudoranges, &plane, &[], &hc::Monitor::default(), |state| {
            excluded = super::plane_is_excluded(state, &space);
            !excluded
        })
        .unwrap();
        excluded
    }

    #[test]
    fn rooms_exclude_a_plane() {
        for seed in 0..6 {
            let mut made = SimulateOptions::<3>::new();
            (made.receivers, made.transmitters, made.noise, made.outliers, made.seed) = (10, 30, 0.01, 0.05, seed);
            made.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            assert!(is_excluded(&made), "seed {seed}");
        }
    }

    #[test]
    fn planar_networks_do_not_with_errors_of_receivers_or_without() {
        let faults =
            [None, Some(ReceiverFault::Delay(0.5)), Some(ReceiverFault::Drift(1.0)), Some(ReceiverFault::Move(2.0))];
        for (seed, fault) in (0..).zip(faults) {
            let made =
                SimulateOptions { receivers: 10, transmitters: 30, noise: 0.01, fault, seed, ..Default::default() };
            assert!(!is_excluded(&made), "{fault:?}");
        }
    }

    #[test]
    fn with_a_plane_excluded_the_network_is_the_one_in_space() {
        let mut made = SimulateOptions::<3>::new();
        (made.receivers, made.transmitters, made.noise) = (10, 30, 0.01);
        let measured = simulate(&made).unwrap().pseudoranges;
        let mut options = CalibrateOptions::<3>::new();
        options.receiver_delays = ReceiverDelays::Auto;
        let Ok(Calibrated::Space(found)) = calibrate_either(&measured, &options, &Default::default()) else { panic!() };
        let alone = crate::calibrate(&measured, &options).unwrap();
        assert_eq!((found.receivers, found.unique), (alone.receivers, alone.unique));
        assert!(found.dimension_test.unwrap().gain.unwrap() > 100.0);
    }
}
