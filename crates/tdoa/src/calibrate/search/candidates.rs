//! The choice among the candidates of cells for which a detector found several.
//!
//! At most one candidate of a cell is right, so that a network can be sought among all of them at once: the others
//! are gross errors, which the robust loss bears. Right candidates agree on one network, and there are more of them
//! than among the first ones alone. Each cell then takes the candidate that is nearest to the network, the network is
//! refined, and both are repeated until the choice stays. From then on a cell has one value, and the search is that of
//! any other measurements.

use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::search::choices::{RandomChoices, nearest};
use crate::calibrate::search::dense::{RESOLUTION, complete, search_part, search_whole};
use crate::calibrate::search::deviation::{spread_of_residuals, typical_deviation};
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::search::same_network::same;
use crate::calibrate::search::starts::{SETTLED, Search};
use crate::calibrate::state::State;
use crate::loss::{Loss, SEARCH_NU, normal_deviation};
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, RefineOptions, RefinedNetwork, SEARCH};

/// Rounds of choosing and refining, and of searching again, at most.
const ROUNDS: usize = 10;
const SEARCHES: usize = 3;

/// Networks among all candidates from which a choice is made.
const NETWORKS: usize = 12;

/// Scale of the loss among all candidates, as a share of the network's diameter: far below what candidates of a cell
/// differ by. It cannot be estimated, as half of the candidates or more are wrong.
const SCALE: f64 = 3e-3;

/// What speaks against a choice where clocks are unknown.
const CLOCKS: &str =
    "clocks of recorders are unknown besides, and one whose late candidates are chosen seems to be late itself";

/// Searches networks for the measurements of a state, which has none yet, and chooses among their candidates.
pub(crate) fn search_candidates<const D: usize>(
    state: &mut State<'_, D>,
    sources: &[&dyn Hypotheses<D>],
) -> Result<(), CalibrateError<D>> {
    if !state.measured.has_candidates() {
        return search_whole(state, sources);
    }
    let chosen = choose_among_all(state, sources)?;
    state.take_choice(chosen);
    search_whole(state, sources)?;
    // A network that was found from many wrong candidates may tell better ones, and these a better network.
    for _ in 1..SEARCHES {
        let (chosen, _) = settle(state, state.ranked[0].network.clone())?;
        if !state.measured.chooses_otherwise(&chosen) {
            break;
        }
        state.take_choice(chosen);
        search_whole(state, sources)?;
    }
    Ok(())
}

impl<const D: usize> State<'_, D> {
    /// Takes another choice among the candidates of the measurements.
    pub(crate) fn take_choice(&mut self, chosen: Pseudoranges) {
        self.observations = Observations::new(&chosen, |_, _| true);
        self.measured = chosen;
    }

    /// Chooses the candidates that are nearest to the best network, where small networks were laid together.
    pub(crate) fn settle_candidates(&mut self) -> Result<(), CalibrateError<D>> {
        if !self.measured.has_candidates() {
            return Ok(());
        }
        self.doubts_choice = self.measured.unknown_clocks().map(|_| CLOCKS);
        let (chosen, refined) = settle(self, self.ranked[0].network.clone())?;
        if self.measured.chooses_otherwise(&chosen) {
            self.take_choice(chosen);
            self.ranked[0].network = refined.network;
            let wide = spread_of_residuals(&self.observations, &self.ranked[0].network);
            self.finish(self.known.unwrap_or(wide).max(self.floor))?;
        }
        Ok(())
    }
}

/// The choice that the best network among all candidates leads to.
fn choose_among_all<const D: usize>(
    state: &mut State<'_, D>,
    sources: &[&dyn Hypotheses<D>],
) -> Result<Pseudoranges, CalibrateError<D>> {
    let State { options, monitor, known, .. } = *state;
    let part = search_part(&state.measured, options);
    let small = state.measured.select(&part.receivers, &part.transmitters);
    let observations = Observations::of_all_candidates(&small);
    let unit = typical_deviation(&state.measured);
    let choices = RandomChoices::new(&small, unit, monitor);
    let diameter = choices.diameter() / unit;
    state.floor = RESOLUTION * diameter;
    let least = known.map_or(0.0, |sigma| sigma / normal_deviation(SEARCH_NU));
    let refine = RefineOptions {
        scale: Some(least.max(SCALE * diameter)),
        anneal_from: Some(0.1 * diameter),
        floor: state.floor,
        ..SEARCH
    };
    let mut all: Vec<&dyn Hypotheses<D>> = sources.to_vec();
    if options.search.restarts || all.is_empty() {
        all.insert(0, &choices);
    }
    let search = Search {
        measured: &small,
        observations: &observations,
        refine,
        sources: all,
        wide: Loss { nu: SEARCH_NU, scale: 0.03 * diameter },
        deviation: None,
        shakes: true,
    };
    let found = state.run(&search, &part)?;
    let (m, n) = (state.measured.receivers(), state.measured.transmitters());
    let networks = found.networks.into_iter().take(NETWORKS);
    let networks = if part.receivers.len() == m && part.transmitters.len() == n {
        networks.collect()
    } else {
        complete(&Observations::of_all_candidates(&state.measured), &part, networks, &refine, monitor)?
    };
    let settled = networks.into_iter().map(|found| {
        let (chosen, refined) = settle(state, found.network)?;
        Ok((chosen, RefinedNetwork { starts: found.starts, ..refined }))
    });
    let mut settled: Vec<(Pseudoranges, RefinedNetwork<D>)> = settled.collect::<Result<_, CalibrateError<D>>>()?;
    settled.sort_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
    let Some((chosen, best)) = settled.first() else { return Err(CalibrateError::NotFound(found.starts)) };
    // Starts that ended apart may lead to one choice.
    let alike = settled.iter().filter(|(_, other)| same(&other.network, &best.network));
    let starts: usize = alike.map(|(_, other)| other.starts).sum();
    let rivals = settled.iter().filter(|(_, other)| other.objective <= best.objective + options.alternative_margin);
    let mut rivals = rivals.map(|(_, other)| other);
    state.doubts_choice = if state.measured.unknown_clocks().is_some() {
        Some(CLOCKS)
    } else if rivals.any(|other| !same(&other.network, &best.network)) {
        Some("another choice among the candidates fits another network about as well")
    } else if starts < SETTLED.min(options.search.agreeing).min(options.search.max_starts) {
        Some(
            "few starts of the search among all candidates ended in the network that was chosen by; a better choice may have been missed",
        )
    } else {
        None
    };
    Ok(chosen.clone())
}

/// The choice that a network leads to: of each cell the nearest candidate, the network refined to these, and so on
/// until the choice stays.
fn settle<const D: usize>(
    state: &State<'_, D>,
    mut network: Network<D>,
) -> Result<(Pseudoranges, RefinedNetwork<D>), CalibrateError<D>> {
    let scale = state.known.map(|sigma| sigma / normal_deviation(SEARCH_NU));
    let refine = RefineOptions { scale, floor: state.floor, ..SEARCH };
    let mut chosen = nearest(&state.measured, &network);
    let mut round = 0;
    loop {
        let observations = Observations::new(&chosen, |_, _| true);
        let refined = NetworkRefiner::new(&observations, SEARCH_NU, state.monitor).refine(network, &refine);
        check(state.monitor)?;
        let next = nearest(&state.measured, &refined.network);
        round += 1;
        if round == ROUNDS || !chosen.chooses_otherwise(&next) {
            return Ok((chosen, refined));
        }
        (chosen, network) = (next, refined.network);
    }
}

#[cfg(test)]
mod tests {
    use crate::align::align;
    use crate::calibrate::{Calibrates, Dimension};
    use crate::{CalibrateOptions, Calibration, Pseudoranges, SimulateOptions, Simulation, calibrate, simulate};

    /// A network and its measurements; of each cell two candidates, of which `is_wrong` tells whether the first is
    /// late. The other one is right, and the second of the others is late.
    fn peaks<const D: usize>(
        made: SimulateOptions<D>,
        is_wrong: impl Fn(usize) -> bool,
    ) -> (Simulation<D>, Pseudoranges) {
        let made = simulate(&made).unwrap();
        let (m, n) = (made.pseudoranges.receivers(), made.pseudoranges.transmitters());
        let right = made.pseudoranges.dense();
        // From a third of a metre to seven metres, in no order.
        let late = |k: usize| right[k] + 0.3 + 6.7 * (k as f64 * 0.618_033_988_75).fract();
        let first = (0..m * n).map(|k| if is_wrong(k) { late(k) } else { right[k] }).collect();
        let second = (0..m * n).map(|k| (k / n, k % n, if is_wrong(k) { right[k] } else { late(k) }));
        let measured = Pseudoranges::new(m, n, first).unwrap().with_candidates(second).unwrap();
        (made, measured)
    }

    fn error<const D: usize>(made: &Simulation<D>, found: &Calibration<D>) -> f64 {
        let placed: Option<Vec<[f64; D]>> = found.receivers.iter().copied().collect();
        placed.and_then(|placed| align(&placed, &made.network.receivers, false)).map_or(f64::NAN, |a| a.rms)
    }

    /// Two of five first candidates are wrong, all second ones of these are right.
    fn assert_recovered<const D: usize>(receivers: usize, transmitters: usize, seeds: std::ops::Range<u64>)
    where
        Dimension<D>: Calibrates<D>,
    {
        for seed in seeds {
            let options = SimulateOptions { receivers, transmitters, seed, ..SimulateOptions::<D>::new() };
            let is_wrong = |k: usize| [1, 3].contains(&((k * 7 + k / transmitters) % 5));
            let (made, measured) = peaks(options, is_wrong);
            let found = calibrate(&measured, &CalibrateOptions { seed, ..CalibrateOptions::<D>::new() }).unwrap();
            assert!(error(&made, &found) < 1e-6, "seed {seed}: {} {:?}", error(&made, &found), found.warnings);
            let cells: Vec<(String, String)> = (0..receivers * transmitters)
                .filter(|&k| is_wrong(k))
                .map(|k| (format!("r{}", k / transmitters + 1), format!("s{}", k % transmitters + 1)))
                .collect();
            let told: Vec<(String, String)> =
                found.chosen.iter().map(|c| (c.receiver.clone(), c.transmitter.clone())).collect();
            assert_eq!((told, found.with_candidates), (cells, receivers * transmitters), "seed {seed}");
            assert!(found.chosen.iter().all(|chosen| chosen.candidate == 2));
            assert_eq!(found.residuals.outliers().count(), 0, "seed {seed}");
            assert!(found.unique, "seed {seed}: {:?}", found.warnings);
        }
    }

    #[test]
    fn two_of_five_first_candidates_are_wrong_in_the_plane() {
        assert_recovered::<2>(8, 12, 0..4);
    }

    #[test]
    fn two_of_five_first_candidates_are_wrong_in_space() {
        assert_recovered::<3>(9, 16, 0..2);
    }

    #[test]
    fn right_first_candidates_stay_and_a_cell_without_a_right_one_is_an_outlier() {
        let options = SimulateOptions { noise: 0.01, seed: 3, ..SimulateOptions::default() };
        let (made, measured) = peaks(options, |_| false);
        let plain = calibrate(&made.pseudoranges, &CalibrateOptions::default()).unwrap();
        assert_eq!((plain.with_candidates, plain.chosen.len()), (0, 0));
        let found = calibrate(&measured, &CalibrateOptions::default()).unwrap();
        assert!(found.chosen.is_empty() && found.with_candidates == 96, "{:?}", found.chosen);
        // The steps after the choice are those of the plain measurements.
        assert_eq!((&found.receivers, &found.residuals), (&plain.receivers, &plain.residuals));

        let mut values = measured.dense();
        values[29] += 5.0;
        let second = measured.cells().iter().map(|(i, j, _)| (i, j, measured.candidates(i, j)[1]));
        let second: Vec<_> = second.map(|(i, j, f)| (i, j, if (i, j) == (2, 5) { f + 1.0 } else { f })).collect();
        let wrong = Pseudoranges::new(8, 12, values).unwrap().with_candidates(second).unwrap();
        let found = calibrate(&wrong, &CalibrateOptions::default()).unwrap();
        let outliers: Vec<(usize, usize)> = found.residuals.outliers().map(|(i, j, _)| (i, j)).collect();
        assert!(outliers.contains(&(2, 5)) && outliers.len() <= 2, "{outliers:?}");
        assert!(error(&made, &found) < 0.05);
    }
}
