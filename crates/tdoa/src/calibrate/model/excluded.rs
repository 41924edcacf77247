//! Whether a plane is out of the question, before errors of receivers are looked for in it.

use crate::calibrate::options::Errors;
use crate::calibrate::search::local::hearing_is_local;
use crate::calibrate::search::truncated_cost::{OUTLIER_COST, truncated};
use crate::calibrate::steps::Draft;
use crate::observations::{Observation, Observations};

/// The mean gain of a measurement by heights, as a share of what an outlier costs, above which a plane is out of the
/// question.
const GAIN: f64 = 1.0 / 6.0;

/// Measurements over unknowns in space, at least: fewer fit anything.
const SPARE: f64 = 1.5;

/// Whether heights explain nearly all that a planar network leaves, at the half of the receivers where that is least:
/// errors of fewer receivers are no reason for it. Then what a plane would have of such errors need not be known.
pub(super) fn plane_is_excluded(plane: &Draft<'_, 2>, space: &Draft<'_, 3>) -> bool {
    let (measured, options) = (&plane.state.measured, plane.state.options);
    if options.errors == Errors::OneSided || hearing_is_local(measured) {
        return false;
    }
    let (flat, best) = (&plane.state.ranked[0].network, &space.state.ranked[0].network);
    let (observations, deviation) = (&space.state.observations, space.state.deviation);
    if (observations.len() as f64) < SPARE * observations.unknowns() as f64 || deviation <= 0.0 {
        return false;
    }
    // Nodes of space, as nodes of the plane.
    let (of_plane, of_space) = (&plane.input.usable, &space.input.usable);
    let among = |all: &[usize], some: &[usize]| some.iter().map(|i| all.binary_search(i).ok()).collect();
    let receivers: Option<Vec<usize>> = among(&of_plane.receivers, &of_space.receivers);
    let transmitters: Option<Vec<usize>> = among(&of_plane.transmitters, &of_space.transmitters);
    let Some((receivers, transmitters)) = receivers.zip(transmitters) else { return false };
    let in_plane = Observations::<2>::new(measured, |_, _| true);
    let cost = |residual: f64| truncated(residual / deviation);
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
    use crate::calibrate::model::lifted::{from_plane, lifted};
    use crate::calibrate::steps::Draft;
    use crate::calibrate::{Calibrated, calibrate_either};
    use crate::{CalibrateOptions, Layout, ReceiverDelays, ReceiverFault, SimulateOptions, simulate};
    use hc::Monitor;

    fn is_excluded<const D: usize>(made: &SimulateOptions<D>) -> bool
    where
        crate::calibrate::Dimension<D>: crate::calibrate::Calibrates<D>,
    {
        let measured = simulate(made).unwrap().pseudoranges;
        let (plane, space) = (CalibrateOptions::<2>::new(), from_plane(&CalibrateOptions::new()));
        let monitor = Monitor::default();
        let plane = Draft::searched(&measured, &plane, &[], &monitor).unwrap();
        let space = lifted(&measured, &space, &plane, &monitor).unwrap().unwrap();
        super::plane_is_excluded(&plane, &space)
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
