//! The search where most receivers hear most transmitters: from some of the nodes to all of them.

use crate::calibrate::judge::neighbours::neighbours;
use crate::calibrate::options::{CalibrateError, CalibrateOptions, Errors, check};
use crate::calibrate::search::deviation::typical_deviation;
use crate::calibrate::search::hypotheses::{Hypotheses, RandomRestarts};
use crate::calibrate::search::minimal::MinimalHypotheses;
use crate::calibrate::search::rivals::add_rivals;
use crate::calibrate::search::starts::{Search, SearchOutcome};
use crate::calibrate::state::State;
use crate::calibrate::unfinished::Unfinished;
use crate::degeneracy::{Usable, usable};
use crate::loss::{Loss, SEARCH_NU, normal_deviation};
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, PartialNetwork, RefineOptions, RefinedNetwork, SEARCH, extend};
use hc::Monitor;

/// No measurement is trusted beyond this share of the network's diameter.
pub(crate) const RESOLUTION: f64 = 1e-9;

/// Networks of a part of the nodes that are extended to all of them, at most.
const COMPLETED: usize = 4;

/// Searches networks for the measurements of a state, which has none yet.
pub(crate) fn search_whole<const D: usize>(
    state: &mut State<'_, D>,
    sources: &[&dyn Hypotheses<D>],
) -> Result<(), CalibrateError<D>> {
    if state.options.errors != Errors::OneSided {
        return search(state, sources);
    }
    // Late measurements bend every network at first: at a given deviation few of its residuals would count.
    let given = state.known.take();
    let ended = search(state, sources);
    state.known = given;
    state.deviation = given.unwrap_or(state.deviation);
    ended
}

fn search<const D: usize>(state: &mut State<'_, D>, sources: &[&dyn Hypotheses<D>]) -> Result<(), CalibrateError<D>> {
    let State { options, monitor, known, .. } = *state;
    let part = search_part(&state.measured, options);
    let small = state.measured.select(&part.receivers, &part.transmitters);
    let small_observations = Observations::new(&small, |_, _| true);
    let to_deviation = normal_deviation(SEARCH_NU);
    let restarts = RandomRestarts::new(&small_observations);
    let diameter = restarts.diameter();
    // Where measurements carry deviations, residuals are multiples of them, and so is the network's
    // size.
    let unit = typical_deviation(&state.measured);
    state.floor = RESOLUTION * diameter / unit;
    let has_clocks = small.unknown_clocks().is_some();
    let refine = RefineOptions {
        scale: known.map(|sigma| sigma / to_deviation),
        anneal_from: Some(0.1 * diameter / unit),
        by_leverage: has_clocks || !small.distances().is_empty(),
        floor: state.floor,
        ..SEARCH
    };
    let mut all: Vec<&dyn Hypotheses<D>> = sources.to_vec();
    let minimal = MinimalHypotheses::at_most(options.search.minimal_subsets).heeding(monitor);
    if options.search.restarts || all.is_empty() {
        all.insert(0, &restarts);
        // Receivers of the smallest networks share a clock.
        if options.search.minimal_subsets > 0 && !has_clocks && MinimalHypotheses::fit::<D>(&small) {
            all.push(&minimal);
        }
    }
    let search = Search {
        measured: &small,
        observations: &small_observations,
        refine,
        sources: all,
        wide: Loss { nu: SEARCH_NU, scale: 0.03 * diameter / unit },
        deviation: known.map(|sigma| sigma.max(refine.floor)),
        shakes: options.errors != Errors::OneSided,
    };
    let found = state.run(&search, &part)?;
    let (m, n) = (state.measured.receivers(), state.measured.transmitters());

    state.starts = found.starts;
    let best = found.networks[0].objective;
    let close = found.networks.into_iter().filter(|r| r.objective <= best + 4.0 * options.alternative_margin);
    let complete_part = part.receivers.len() == m && part.transmitters.len() == n;
    state.ranked = if complete_part {
        close.collect()
    } else {
        let most = if state.is_rough { 1 } else { COMPLETED };
        complete(&state.observations, &part, close.take(most), &refine, monitor)?
    };
    let Some(scale) = state.ranked.iter().min_by(|a, b| a.objective.total_cmp(&b.objective)).map(|r| r.scale) else {
        return Err(CalibrateError::NotFound(found.starts));
    };
    state.finish(known.unwrap_or(scale * to_deviation).max(refine.floor))?;
    if complete_part {
        let found_by_search = state.ranked.len();
        add_rivals(state)?;
        if options.errors == Errors::OneSided && state.ranked.len() > found_by_search {
            state.finish(state.deviation)?;
        }
        state.neighbours = neighbours(&state.observations, &state.ranked[0], found.near, state.deviation, monitor)?;
    }
    Ok(())
}

impl<const D: usize> State<'_, D> {
    /// Runs a search among a part of the nodes, and keeps its best network as the one so far.
    pub(crate) fn run(&mut self, search: &Search<'_, D>, part: &Usable) -> Result<SearchOutcome<D>, CalibrateError<D>> {
        let found = search.run(&self.options.search, self.options.seed, self.monitor)?;
        if let Some(best) = found.networks.first() {
            let (m, n) = (self.measured.receivers(), self.measured.transmitters());
            let best = Unfinished::of(&best.network, found.starts, best.starts);
            self.so_far = Some(best.among(m, &part.receivers, n, &part.transmitters));
        }
        check(self.monitor)?;
        Ok(found)
    }
}

/// The nodes that the search works on: where there are many, some of the better observed half,
/// evenly spaced, because neighbours in a recording are often neighbours in the plane.
pub(crate) fn search_part<const D: usize>(measured: &Pseudoranges, options: &CalibrateOptions<D>) -> Usable {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let pick = |total: usize, most: usize, count: &dyn Fn(usize) -> usize| -> Vec<usize> {
        if total <= most {
            return (0..total).collect();
        }
        let mut order: Vec<usize> = (0..total).collect();
        order.sort_by_key(|&k| std::cmp::Reverse(count(k)));
        let better = most.max(total / 2);
        let mut better: Vec<usize> = order[..better].to_vec();
        better.sort_unstable();
        (0..most).map(|k| better[k * better.len() / most]).collect()
    };
    let receivers = pick(m, options.search.receivers, &|i| measured.cells().row(i).count());
    let heard = |j: usize| receivers.iter().filter(|&&i| measured.get(i, j).is_some()).count();
    let transmitters = pick(n, options.search.transmitters, &heard);
    // A part that cannot be solved on its own is no help.
    match usable::<D>(&measured.select(&receivers, &transmitters)) {
        Ok(part) => Usable {
            receivers: part.receivers.iter().map(|&i| receivers[i]).collect(),
            transmitters: part.transmitters.iter().map(|&j| transmitters[j]).collect(),
            warnings: Vec::new(),
        },
        Err(_) => Usable { receivers: (0..m).collect(), transmitters: (0..n).collect(), warnings: Vec::new() },
    }
}

/// Extends networks of a part of the nodes to all of them and refines them.
pub(crate) fn complete<const D: usize>(
    observations: &Observations<D>,
    part: &Usable,
    networks: impl Iterator<Item = RefinedNetwork<D>>,
    refine: &RefineOptions,
    monitor: &Monitor,
) -> Result<Vec<RefinedNetwork<D>>, CalibrateError<D>> {
    let mut refiner = NetworkRefiner::new(observations, SEARCH_NU, monitor);
    let refine = RefineOptions { anneal_from: None, ..*refine };
    let mut all = Vec::new();
    for refined in networks {
        let mut known = PartialNetwork::unknown(observations.receivers, observations.transmitters);
        known.place(&refined.network, &part.receivers, &part.transmitters);
        known.clocks = observations.clocks().of_all(&refined.network.clocks, &part.receivers);
        let loss = Loss { nu: SEARCH_NU, scale: refined.scale };
        let Some(network) = extend(observations, &known, &loss, monitor)? else { continue };
        let next = RefinedNetwork { starts: refined.starts, ..refiner.refine(network, &refine) };
        check(monitor)?;
        if next.objective.is_finite() && next.network.is_finite() {
            all.push(next);
        }
    }
    Ok(all)
}
