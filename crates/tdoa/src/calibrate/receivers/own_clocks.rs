//! Clocks of recorders: a search of networks with them, and what they are in the result.
//!
//! First guesses of clocks that were started apart are wrong by as much as receivers are apart, so that few starts end in
//! the best network. With the clocks of a network that was found, as many do as in a search of receivers that share a
//! clock.

use crate::calibrate::input::selection::{Input, synchronised};
use crate::calibrate::options::{CalibrateError, CalibrateOptions, SearchOptions};
use crate::calibrate::report::clocks::RecorderClock;
use crate::calibrate::search::candidates::search_candidates;
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::search::same_network::same;
use crate::calibrate::state::State;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::Covariance;

/// Searches with the clocks of networks found before, at most.
const ROUNDS: usize = 2;

/// Searches networks together with the clocks of the recorders.
pub(crate) fn search_with_clocks<const D: usize>(
    state: &mut State<'_, D>,
    sources: &[&dyn Hypotheses<D>],
) -> Result<(), CalibrateError<D>> {
    let few = SearchOptions { max_starts: state.options.search.min_starts, ..state.options.search };
    let few = CalibrateOptions { search: few, ..state.options.clone() };
    state.search_like(state.measured.clone(), &few, sources)?;
    // What fits best before the clocks are known says little.
    let all = CalibrateOptions { alternative_margin: 1e9, ..state.options.clone() };
    for _ in 0..ROUNDS {
        let before = std::mem::take(&mut state.ranked);
        state.search_like(state.measured.clone().with_unknown_clocks(None), &all, sources)?;
        // What other clocks led to is not found again with these.
        state.ranked.extend(before.iter().cloned());
        state.finish_with_clocks()?;
        if same(&state.ranked[0].network, &before[0].network) {
            return Ok(());
        }
    }
    // Clocks and networks lead away from each other.
    let before = std::mem::take(&mut state.ranked);
    state.search_like(state.measured.clone(), &all, sources)?;
    state.ranked.extend(before);
    state.finish_with_clocks()
}

impl<const D: usize> State<'_, D> {
    /// Searches networks for these measurements, which may have clocks that are known, and adjusts clocks to them.
    fn search_like(
        &mut self,
        measured: Pseudoranges,
        options: &CalibrateOptions<D>,
        sources: &[&dyn Hypotheses<D>],
    ) -> Result<(), CalibrateError<D>> {
        let mut found = State::new(measured, None, options, self.monitor);
        let ended = search_candidates(&mut found, sources);
        (self.so_far, self.ranked, self.deviation) = (found.so_far, found.ranked, found.deviation);
        (self.floor, self.starts, self.doubts_choice) = (found.floor, found.starts, found.doubts_choice);
        if self.measured.has_candidates() {
            self.take_choice(self.measured.choosing_as(&found.measured));
        }
        ended?;
        self.finish_with_clocks()
    }

    /// Refines the networks with their clocks, and takes the best one's off the measurements.
    fn finish_with_clocks(&mut self) -> Result<(), CalibrateError<D>> {
        // Wrong clocks make residuals larger than a given deviation.
        let given = self.known.take();
        let ended = self.finish(self.deviation);
        self.known = given;
        ended?;
        if let Some(given) = given {
            self.finish(given)?;
        }
        let clocks = self.ranked[0].network.clocks.clone();
        self.measured = synchronised(self.measured.clone(), &clocks);
        self.observations = Observations::new(&self.measured, |_, _| true);
        self.ranked.iter_mut().for_each(|refined| add(&mut refined.network.clocks, &clocks, -1.0));
        self.clocks.resize(clocks.len(), [0.0; 2]);
        add(&mut self.clocks, &clocks, 1.0);
        Ok(())
    }

    /// The clocks of the recorders of a network, in their order; none where receivers share a clock.
    pub(crate) fn recorder_clocks(&self, input: &Input<'_>, uncertainty: &Covariance<D>) -> Vec<RecorderClock> {
        let (Some(recorders), best) = (self.measured.unknown_clocks(), &self.ranked[0].network) else {
            return Vec::new();
        };
        let mut clocks = input.clocks.clone();
        add(&mut clocks, &self.clocks, 1.0);
        add(&mut clocks, &best.clocks, 1.0);
        let (first, size) = (D * self.observations.receivers, self.observations.reduced());
        let deviation = |at: Option<usize>| -> Option<f64> {
            let Some(at) = at else { return Some(0.0) };
            let variance = uncertainty.joint.get((first + at) * (size + 1))?;
            (variance.is_finite() && *variance >= 0.0).then(|| variance.sqrt())
        };
        let shown = |recorder: usize| {
            let i = recorders.of_receivers().iter().position(|of| *of == recorder)?;
            let [offset, drift] = clocks[i];
            let [of_offset, of_drift] = self.observations.clocks().of_receiver(i).map(deviation);
            let rates = recorders.drift();
            Some(RecorderClock {
                recorder: self.measured.recorder_name(i).to_string(),
                offset,
                offset_std: of_offset,
                // Readings run ahead by the drift, times by less.
                rate: rates.then(|| 1.0 / (1.0 - recorders.rate(drift)) - 1.0),
                rate_std: of_drift.filter(|_| rates).map(|deviation| recorders.rate(deviation)),
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
    use crate::calibrate::{Calibrates, Dimension};
    use crate::{CalibrateError, CalibrateOptions, Emissions, ReceiverClocks, SimulateOptions, calibrate, simulate};

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
