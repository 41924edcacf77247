//! Clocks of recorders beside a network that was found, and in the result.

use crate::calibrate::input::selection::{Input, synchronised};
use crate::calibrate::report::clocks::RecorderClock;
use crate::calibrate::state::State;
use crate::clocks::ReceiverClocks;
use crate::observations::Observations;
use crate::refine::Covariance;

impl<const D: usize> State<'_, D> {
    /// Takes the clocks of the best network off the measurements.
    pub(crate) fn take_off_clocks(&mut self) {
        if self.measured.unknown_clocks().is_none() {
            return;
        }
        let clocks = self.ranked[0].network.clocks.clone();
        self.measured = synchronised(self.measured.clone(), &clocks);
        self.observations = Observations::new(&self.measured, |_, _| true);
        for refined in &mut self.ranked {
            add(&mut refined.network.clocks, &clocks, -1.0);
        }
    }

    /// The clocks of the recorders of the best network, in their order; none where receivers share a clock.
    pub(crate) fn recorder_clocks(&self, input: &Input<'_>, uncertainty: &Covariance<D>) -> Vec<RecorderClock> {
        let (Some(recorders), best) = (self.measured.unknown_clocks(), &self.ranked[0].network) else {
            return Vec::new();
        };
        let mut clocks = recorders.taken().to_vec();
        add(&mut clocks, &best.clocks, 1.0);
        let (first, size) = (D * self.observations.receivers, self.observations.reduced());
        // The deviation of a sum of unknowns.
        let deviation = |all: &[Option<usize>]| -> Option<f64> {
            let places = || all.iter().flatten().map(|at| first + at);
            let pairs = places().flat_map(|a| places().map(move |b| a * size + b));
            let variance = pairs.map(|place| uncertainty.joint.get(place)).sum::<Option<f64>>()?;
            (variance.is_finite() && variance >= 0.0).then(|| variance.sqrt() + 0.0)
        };
        // Where send times are known, what transmitters seem to have in common is the first recorder's.
        let of_first = self.observations.clocks().constant().filter(|_| self.sends_at_known_times());
        let shared = of_first.map_or(0.0, |_| best.offsets[0] + input.shifts[0] - self.measured.emission_time(0));
        let shown = |recorder: usize| {
            let i = recorders.of_receivers().iter().position(|of| *of == recorder)?;
            let [offset, drift] = clocks[i];
            let [of_offset, of_drift] = self.observations.clocks().of_receiver(i);
            let rates = recorders.drift();
            Some(RecorderClock {
                recorder: if self.options.clocks.receivers == ReceiverClocks::Common {
                    RecorderClock::ALL_RECEIVERS.to_string()
                } else {
                    self.measured.recorder_name(i).to_string()
                },
                offset: offset + shared,
                offset_std: deviation(&[of_offset, of_first]),
                // Readings run ahead by the drift, times by less.
                rate: rates.then(|| 1.0 / (1.0 - recorders.rate(drift)) - 1.0),
                rate_std: deviation(&[of_drift]).filter(|_| rates).map(|deviation| recorders.rate(deviation)),
                at: rates.then(|| recorders.middle(i)),
            })
        };
        recorders.present().into_iter().filter_map(shown).collect()
    }
}

/// Adds a multiple of other clocks.
fn add(clocks: &mut [[f64; 2]], others: &[[f64; 2]], factor: f64) {
    for (clock, other) in clocks.iter_mut().flatten().zip(others.iter().flatten()) {
        *clock += factor * other;
    }
}

#[cfg(test)]
mod tests {
    use crate::accuracy::cramer_rao_with_clocks;
    use crate::align::align;
    use crate::calibrate::{Calibrates, Dimension, KnownReceivers};
    use crate::summary::clock_model;
    use crate::{
        CalibrateError, CalibrateOptions, Emissions, Monitor, ReceiverClocks, SimulateOptions, calibrate,
        calibrate_with, simulate,
    };

    /// Networks are as near to the truth as measurements with these unknowns tell.
    fn are_at_the_bound<const D: usize>(emissions: Emissions, receivers: ReceiverClocks, channels: usize)
    where
        Dimension<D>: Calibrates<D>,
    {
        let (mut squares, mut of_bound) = (0.0, 0.0);
        for seed in 0..2 {
            let mut made = SimulateOptions::<D>::new();
            (made.receivers, made.transmitters, made.noise, made.seed) = (12, 40, 0.01, seed);
            (made.missing, made.outliers, made.emissions, made.channels) = (0.1, 0.05, emissions, channels);
            // An hour, and as much of a drift as a clock of 20 ppm has in ten minutes.
            made.delays = 1.2e6;
            if receivers == ReceiverClocks::Rate {
                (made.rates, made.duration) = (2e-5, Some(2e5));
            }
            let made = simulate(&made).unwrap();
            let mut options = CalibrateOptions::<D>::new();
            (options.clocks.emissions, options.clocks.receivers, options.seed) = (emissions, receivers, seed);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            assert_eq!(found.clocks.len(), 12usize.div_ceil(channels), "seed {seed}");
            let truth = &made.network;
            for (k, clock) in found.clocks.iter().enumerate().filter(|_| receivers == ReceiverClocks::Offset) {
                // Against the first recorder's, or against send times where these are known.
                let reference = if emissions == Emissions::Known { 0.0 } else { made.clocks[0][0] };
                let off = (clock.offset - (made.clocks[k * channels][0] - reference)).abs();
                let deviation = clock.offset_std.unwrap();
                assert!(off <= 5.0 * deviation + 1e-6 && deviation < 0.1, "{emissions:?} {k}: {off} {deviation}");
            }
            let of_known = |offset: &Option<f64>| *offset == Some(0.0);
            let known = found.offsets.iter().chain(&found.offset_std).all(of_known);
            assert_eq!(known, emissions == Emissions::Known);
            let places: Vec<[f64; D]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&places, &truth.receivers, false).unwrap().rms;
            let bound = cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, truth, 0.01, &options.clocks);
            assert!(apart < 3.0 * bound, "{emissions:?} {receivers:?} {channels} seed {seed}: {apart} {bound}");
            squares += apart * apart;
            of_bound += bound * bound;
        }
        // A robust estimate of two networks of 21 coordinates or more: 1.9 times the bound's mean square would have a chance
        // of less than one in a thousand, if all coordinates were equally certain.
        assert!(squares < 1.9 * of_bound, "{emissions:?} {receivers:?} {channels}: {squares} {of_bound}");
    }

    #[test]
    fn recorders_with_clocks_of_their_own_are_calibrated_at_the_bound() {
        for receivers in [ReceiverClocks::Offset, ReceiverClocks::Rate] {
            for channels in [1, 3] {
                are_at_the_bound::<2>(Emissions::Unknown, receivers, channels);
                are_at_the_bound::<3>(Emissions::Unknown, receivers, channels);
            }
        }
        are_at_the_bound::<2>(Emissions::Constant, ReceiverClocks::Offset, 1);
        are_at_the_bound::<3>(Emissions::Known, ReceiverClocks::Offset, 2);
    }

    /// Ten recorders and twenty events, which leave 58 to 94 of 180 measurements over; ten measurements are wrong.
    fn all_are_found<const D: usize>(receivers: ReceiverClocks)
    where
        Dimension<D>: Calibrates<D>,
    {
        for seed in 0..4 {
            let mut made = SimulateOptions::<D>::new();
            (made.receivers, made.transmitters, made.noise, made.seed) = (10, 20, 0.01, seed);
            (made.missing, made.outliers, made.delays) = (0.1, 0.05, 1e3);
            if receivers == ReceiverClocks::Rate {
                (made.rates, made.duration) = (2e-5, Some(2e5));
            }
            let made = simulate(&made).unwrap();
            let mut options = CalibrateOptions::<D>::new();
            (options.clocks.receivers, options.seed) = (receivers, seed);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let places: Vec<[f64; D]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&places, &made.network.receivers, false).unwrap().rms;
            let bound =
                cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, &made.network, 0.01, &options.clocks);
            assert!(apart < 3.0 * bound, "{D} {receivers:?} seed {seed}: {apart} {bound}");
        }
    }

    #[test]
    fn clocks_are_found_where_few_measurements_are_left_over() {
        for receivers in [ReceiverClocks::Offset, ReceiverClocks::Rate] {
            all_are_found::<2>(receivers);
            all_are_found::<3>(receivers);
        }
    }

    /// Every other start estimates the deviation first, so that more than half agree only if both kinds do.
    fn a_given_deviation_is_kept<const D: usize>()
    where
        Dimension<D>: Calibrates<D>,
    {
        for seed in 0..3 {
            let mut made = SimulateOptions::<D>::new();
            (made.receivers, made.transmitters, made.noise, made.seed, made.delays) = (10, 20, 0.01, seed, 1e3);
            let made = simulate(&made).unwrap();
            let mut options = CalibrateOptions::<D> { sigma: Some(0.01), seed, ..CalibrateOptions::new() };
            options.clocks.receivers = ReceiverClocks::Offset;
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            assert!(2 * found.agreeing > found.starts, "{D} {seed}: {} of {}", found.agreeing, found.starts);
        }
    }

    #[test]
    fn starts_agree_where_the_deviation_is_given() {
        a_given_deviation_is_kept::<2>();
        a_given_deviation_is_kept::<3>();
    }

    /// Positions in the coordinates of a country lead where those near the origin do.
    #[test]
    fn known_positions_may_be_far_from_the_origin() {
        let mut made = SimulateOptions::<2>::new();
        (made.receivers, made.transmitters, made.noise, made.seed, made.delays) = (10, 20, 0.01, 1, 1e3);
        let made = simulate(&made).unwrap();
        let mut options = CalibrateOptions::default();
        options.clocks.receivers = ReceiverClocks::Offset;
        options.search.restarts = false;
        (options.search.min_starts, options.search.max_starts) = (1, 1);
        for origin in [[0.0, 0.0], [4e5, 5e6]] {
            let place = |(i, at): (usize, &[f64; 2])| (format!("r{}", i + 1), [at[0] + origin[0], at[1] + origin[1]]);
            let positions = made.network.receivers.iter().enumerate().map(place).collect();
            let known = KnownReceivers { positions };
            let found = calibrate_with(&made.pseudoranges, &options, &[&known], &Monitor::default()).unwrap();
            let places: Vec<[f64; 2]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&places, &made.network.receivers, false).unwrap().rms;
            let bound =
                cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, &made.network, 0.01, &options.clocks);
            assert!(apart < 3.0 * bound, "{origin:?}: {apart} {bound}");
        }
    }

    /// A pinger that sends by its own clock, which is off by an hour and runs fast against that of the receivers.
    fn is_told_from_a_schedule<const D: usize>()
    where
        Dimension<D>: Calibrates<D>,
    {
        for seed in 0..2 {
            let mut made = SimulateOptions::<D>::new();
            (made.receivers, made.transmitters, made.noise, made.seed) = (8, 20, 0.01, seed);
            (made.missing, made.outliers, made.channels) = (0.1, 0.05, 8);
            (made.delays, made.rates, made.duration) = (1.2e6, 2e-5, Some(2e5));
            let made = simulate(&made).unwrap();
            let (truth, measured) = (&made.network, made.pseudoranges.clone());
            let measured = measured.with_emission_times(truth.offsets.clone()).unwrap();
            let mut options = CalibrateOptions::<D>::new();
            (options.clocks.emissions, options.seed) = (Emissions::Constant, seed);
            let bound = |measured: &crate::Pseudoranges, clocks: &crate::Clocks| {
                cramer_rao_with_clocks(measured, &made.outliers, truth, 0.01, clocks)
            };
            let of_schedule = bound(&measured, &options.clocks);
            // More than a constant is unknown, and less than every offset.
            assert!(bound(&made.pseudoranges, &options.clocks) < of_schedule);
            assert!(of_schedule < bound(&measured, &crate::Clocks::default()));
            let found = calibrate(&measured, &options).unwrap();
            let places: Vec<[f64; D]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&places, &truth.receivers, false).unwrap().rms;
            assert!(apart < 3.0 * of_schedule, "{D} {seed}: {apart} {of_schedule}");
            for (offset, time) in found.offsets.iter().zip(&truth.offsets) {
                assert_eq!(*offset, Some(*time));
            }
            assert!(
                clock_model(&found)
                    .unwrap()
                    .ends_with("the receivers' clock has an unknown offset and an unknown rate against theirs")
            );
            let [clock] = found.clocks.as_slice() else { panic!("{:?}", found.clocks) };
            let (rate, deviation) = (clock.rate.unwrap(), clock.rate_std.unwrap());
            assert!((rate - made.clocks[0][1]).abs() <= 5.0 * deviation && deviation < 1e-6, "{rate} {deviation}");
            // By the clock's own reading: at a true time of zero it shows its offset.
            let [offset, of_truth] = made.clocks[0];
            let at = clock.at.unwrap();
            let expected = at - (at - offset) / (1.0 + of_truth);
            let (off, deviation) = (clock.offset - expected, clock.offset_std.unwrap());
            assert!(off.abs() <= 5.0 * deviation && deviation < 0.1, "{off} {deviation}");
        }
    }

    #[test]
    fn the_rate_of_a_pinger_is_unknown() {
        is_told_from_a_schedule::<2>();
        is_told_from_a_schedule::<3>();
    }

    /// With times that are known, and recorders with clocks of their own.
    #[test]
    fn known_times_leave_the_clocks_of_recorders() {
        let mut made = SimulateOptions::<2>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (8, 30, 0.01, 1);
        (made.delays, made.rates, made.duration, made.channels) = (300.0, 2e-5, Some(2e5), 2);
        let made = simulate(&made).unwrap();
        let measured = made.pseudoranges.clone().with_emission_times(made.network.offsets.clone()).unwrap();
        let mut options = CalibrateOptions::default();
        (options.clocks.emissions, options.clocks.receivers) = (Emissions::Known, ReceiverClocks::Rate);
        let bound = cramer_rao_with_clocks(&measured, &made.outliers, &made.network, 0.01, &options.clocks);
        let found = calibrate(&measured, &options).unwrap();
        let places: Vec<[f64; 2]> = found.receivers.iter().flatten().copied().collect();
        assert!(align(&places, &made.network.receivers, false).unwrap().rms < 3.0 * bound);
        for (k, clock) in found.clocks.iter().enumerate() {
            // The first one's too.
            let (off, deviation) = (clock.rate.unwrap() - made.clocks[2 * k][1], clock.rate_std.unwrap());
            assert!(off.abs() <= 5.0 * deviation && deviation < 1e-6 && deviation > 0.0, "{off} {deviation}");
        }
        // Nothing but distances is left where no clock is wrong.
        let plain = SimulateOptions { noise: 0.01, duration: Some(2e5), ..SimulateOptions::default() };
        let plain = simulate(&plain).unwrap();
        let measured = plain.pseudoranges.clone().with_emission_times(plain.network.offsets.clone()).unwrap();
        options.clocks.receivers = ReceiverClocks::Common;
        let found = calibrate(&measured, &options).unwrap();
        let ranges = plain.pseudoranges.map(|_, j, value| value - plain.network.offsets[j]);
        let alike = calibrate(&ranges, &options).unwrap();
        let apart = |a: &[f64; 2], b: &[f64; 2]| crate::points::distance(*a, *b);
        let pairs = found.receivers.iter().flatten().zip(alike.receivers.iter().flatten());
        assert!(pairs.map(|(a, b)| apart(a, b)).fold(0.0, f64::max) < 1e-6);
        assert_eq!(found.offsets[3], Some(plain.network.offsets[3]));
        let wrong = plain.pseudoranges.with_emission_times(vec![f64::NAN; 12]);
        assert!(wrong.is_err_and(|error| error.to_string().contains("time of sending")));
    }

    /// Rates of 20 parts in a million of few events. That they are expected so sharpens the network and the rates, and
    /// what is expected wrongly is said.
    #[test]
    fn expected_rates_sharpen_rates() {
        let mut made = SimulateOptions::<2>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (10, 20, 0.01, 3);
        (made.missing, made.outliers, made.delays, made.rates, made.duration) = (0.1, 0.05, 1e3, 2e-5, Some(2e5));
        let made = simulate(&made).unwrap();
        let mut options = CalibrateOptions::default();
        options.clocks.receivers = ReceiverClocks::Rate;
        let bound = |options: &CalibrateOptions| {
            cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, &made.network, 0.01, &options.clocks)
        };
        let free = bound(&options);
        options.clocks.rate_sigma = Some(2e-5);
        assert!(bound(&options) < free);
        let found = calibrate(&made.pseudoranges, &options).unwrap();
        let places: Vec<[f64; 2]> = found.receivers.iter().flatten().copied().collect();
        let apart = align(&places, &made.network.receivers, false).unwrap().rms;
        assert!(apart < 3.0 * bound(&options), "{apart} {}", bound(&options));
        for (clock, truth) in found.clocks.iter().zip(&made.clocks) {
            let (off, deviation) = (clock.rate.unwrap() - (truth[1] - made.clocks[0][1]), clock.rate_std.unwrap());
            assert!(off.abs() <= 5.0 * deviation + 1e-10 && deviation < 1e-6, "{off} {deviation}");
        }
        let said = |found: &crate::Calibration| found.warnings.iter().any(|warning| warning.contains("--rate-sigma"));
        assert!(!said(&found), "{:?}", found.warnings);
        options.clocks.rate_sigma = Some(4e-6);
        let wrongly = calibrate(&made.pseudoranges, &options).unwrap();
        assert!(said(&wrongly), "{:?} {:?}", wrongly.warnings, wrongly.clocks);
        options.clocks.receivers = ReceiverClocks::Offset;
        let refused = calibrate(&made.pseudoranges, &options);
        assert!(matches!(refused, Err(CalibrateError::Option { name: "clocks.rate_sigma", .. })), "{refused:?}");
    }

    #[test]
    fn the_network_does_not_depend_on_how_far_clocks_are_apart() {
        const SIGMA: f64 = 0.01;
        for seed in 0..2 {
            let at = |delays: f64| {
                let mut made = SimulateOptions { receivers: 10, transmitters: 30, delays, seed, ..Default::default() };
                made.noise = SIGMA;
                let made = simulate(&made).unwrap();
                let mut options = CalibrateOptions { sigma: Some(SIGMA), seed, ..Default::default() };
                options.clocks.receivers = ReceiverClocks::Offset;
                let found = calibrate(&made.pseudoranges, &options).unwrap();
                let receivers: Vec<[f64; 2]> = found.receivers.iter().flatten().copied().collect();
                (align(&receivers, &made.network.receivers, false).unwrap().rms, receivers, found.unique)
            };
            let (error, first, unique) = at(0.1);
            assert!(unique && error < 5.0 * SIGMA, "seed {seed}: {error}");
            let (_, receivers, unique) = at(1000.0);
            let apart = align(&receivers, &first, false).unwrap().rms;
            assert!(unique && apart < 1e-3 * SIGMA, "seed {seed}: {apart}");
        }
    }

    #[test]
    fn fewer_measurements_than_unknowns_are_refused() {
        let made = simulate(&SimulateOptions { receivers: 6, transmitters: 5, ..Default::default() }).unwrap();
        let mut options = CalibrateOptions::default();
        options.clocks.receivers = ReceiverClocks::Offset;
        // 10 + 15 - 3 of the network, and four of clocks.
        let fewer = made.pseudoranges.select(&[0, 1, 2, 3, 4], &[0, 1, 2, 3, 4]);
        let refused = calibrate(&fewer, &options);
        let expected: CalibrateError = CalibrateError::Clocks { measurements: 25, unknowns: 26, of_clocks: 4 };
        assert!(matches!(refused, Err(ref error) if error.to_string() == expected.to_string()), "{refused:?}");
    }
}
