//! The search: many starts, each refined on its own, until enough of them agree.

use hc::{Monitor, Stage};
#[cfg(feature = "threads")]
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use crate::calibrate::judge::neighbours::minima;
use crate::calibrate::options::{CalibrateError, SearchOptions};
use crate::calibrate::search::deviation::typical_deviation;
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::search::same_network::{distinct, same, same_but_for_sides};
use crate::calibrate::search::shaken::{Round, least, part_of};
use crate::calibrate::search::truncated_cost::truncated_cost;
use crate::loss::{Loss, SEARCH_NU, normal_deviation};
use crate::network::Network;
use crate::observations::{Observation, Observations};
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, PartialNetwork, RefineOptions, RefinedNetwork, extend, residuals};
use std::ops::Range;

/// Starts that run between two looks at the result. Fixed, so that the result does not depend on
/// the number of threads.
const BATCH: usize = 16;

/// Proposals of one call that are refined in any case, and at most; also the most networks that the
/// search returns.
const REFINED: usize = 3;
const MOST_REFINED: usize = 40;

/// Further proposals are refined if they fit about as well as the best (units of log-likelihood).
const AS_GOOD: f64 = 4.0;

/// A start counts for the best network if it found the same one with an objective this close to it
/// (units of log-likelihood): where few measurements are left over, one network has many minima of
/// nearly the same objective.
const SAME_BASIN: f64 = 20.0;

/// What the search found, also where it was stopped.
pub(crate) struct SearchOutcome<const D: usize> {
    /// Different networks, best objective first, each with the starts that ended in it. Only the best, or none,
    /// where the search was stopped.
    pub(crate) networks: Vec<RefinedNetwork<D>>,
    /// Networks that count as the best one and end in other minima.
    pub(crate) near: Vec<Network<D>>,
    /// Starts that were made.
    pub(crate) starts: usize,
}

/// The measurements to search and how.
pub(crate) struct Search<'a, const D: usize> {
    pub(crate) measured: &'a Pseudoranges,
    pub(crate) observations: &'a Observations<D>,
    pub(crate) refine: RefineOptions,
    /// Sources of starts, which take turns.
    pub(crate) sources: Vec<&'a dyn Hypotheses<D>>,
    /// Loss with which proposals are completed and ranked.
    pub(crate) wide: Loss,
    /// Deviation of the measurements if it is known: networks are then ranked by what they explain.
    pub(crate) deviation: Option<f64>,
    /// Whether networks are ranked by what they are searched by, so that parts of the best one lead to better ones.
    pub(crate) shakes: bool,
}

/// Starts that must end in the best network before it counts as found: one or two may have ended there while a better one
/// was missed.
pub(crate) const SETTLED: usize = 3;

/// Deviations from which on a measurement is an outlier, share of the measurements that are many, and share of the
/// network's size that is a large deviation.
const OUTLIER: f64 = 3.0;
const MANY: f64 = 0.15;
const LARGE: f64 = 0.04;

/// Number of the first call of a source in another's turn; far above the numbers of its own turns.
const EXTRA_TURNS: usize = 1 << 24;

impl<const D: usize> Search<'_, D> {
    pub(crate) fn run(
        &self,
        options: &SearchOptions,
        seed: u64,
        monitor: &Monitor,
    ) -> Result<SearchOutcome<D>, CalibrateError<D>> {
        let mut ends: Vec<RefinedNetwork<D>> = Vec::new();
        let mut starts = 0;
        let mut round = Round::default();
        monitor.enter(Stage::Search, options.max_starts as u64);
        loop {
            let batch = starts..starts + BATCH.min(options.max_starts - starts);
            let ended = self.batch(batch.clone(), round.shaken(), seed, monitor);
            if monitor.is_cancelled() {
                // The refinements of a batch that was stopped have not ended.
                if ends.is_empty() {
                    starts = batch.start + ended.iter().filter(|networks| !networks.is_empty()).count();
                    ends.extend(ended.into_iter().flatten());
                }
                let best = least(&ends);
                let best = best.map(|best| RefinedNetwork { starts: starts_in(best, &ends), ..best.clone() });
                return Ok(SearchOutcome { networks: best.into_iter().collect(), near: Vec::new(), starts });
            }
            starts = batch.end;
            round.take(&mut ends, ended.into_iter().flatten().collect(), batch.len());
            let last = starts >= options.max_starts;
            if last {
                round.end(&mut ends);
            }
            let agreeing = least(&ends).map_or(0, |best| starts_in(best, &ends));
            monitor.reach(starts as u64, agreeing as u64);
            if last || starts >= options.min_starts && agreeing >= options.agreeing {
                break;
            }
            let is_bent = self.shakes && agreeing < SETTLED && least(&ends).is_some_and(|best| self.is_bent(best));
            round.go_on(&mut ends, options.min_starts, is_bent);
        }
        if ends.is_empty() {
            return Err(CalibrateError::NotFound(starts));
        }
        ends.sort_by(|a, b| a.objective.total_cmp(&b.objective));
        let mut networks = distinct(ends.clone(), MOST_REFINED);
        for network in &mut networks {
            // Parts of another network may have led to it: that, too, began with a start.
            network.starts = starts_in(network, &ends).max(1);
        }
        let best = &networks[0];
        let close = ends.iter().take_while(|r| r.objective <= best.objective + SAME_BASIN);
        let close = close.filter(|r| same(&r.network, &best.network)).map(|r| r.network.clone());
        let near = minima(&best.network, close);
        Ok(SearchOutcome { networks, near, starts })
    }

    /// Whether measurements that are wrong seem to bend a network: many are outliers, or what it leaves is large. Else
    /// starts end apart since the measurements hardly tell networks apart, and the one of least objective is no better.
    fn is_bent(&self, found: &RefinedNetwork<D>) -> bool {
        let deviation = self.deviation.unwrap_or(found.scale * normal_deviation(SEARCH_NU));
        let is_outlier = |o: &&Observation| o.residual(&found.network).abs() > OUTLIER * deviation;
        let outliers = self.observations.all().iter().filter(is_outlier).count();
        let left = deviation * typical_deviation(self.measured) / found.network.size();
        self.observations.len() > self.observations.unknowns()
            && (outliers as f64 > MANY * self.observations.len() as f64 || left > LARGE)
    }

    /// The ends of a batch of starts, from parts of a network if one is `shaken`; empty where stopped.
    fn batch(
        &self,
        batch: Range<usize>,
        shaken: Option<&Network<D>>,
        seed: u64,
        monitor: &Monitor,
    ) -> Vec<Vec<RefinedNetwork<D>>> {
        let refiner = || NetworkRefiner::new(self.observations, SEARCH_NU, monitor);
        let start = |refiner: &mut NetworkRefiner<'_, D>, index| {
            if monitor.is_cancelled() {
                return Vec::new();
            }
            let proposals = match shaken {
                Some(network) => vec![part_of(network, index, seed)],
                None => self.proposals(index, seed),
            };
            self.start(refiner, &proposals, self.adapts(index), monitor)
        };
        #[cfg(feature = "threads")]
        return batch.into_par_iter().map_init(refiner, start).collect();
        #[cfg(not(feature = "threads"))]
        {
            let mut refiner = refiner();
            batch.map(|index| start(&mut refiner, index)).collect()
        }
    }

    /// What the source whose turn it is proposes.
    fn proposals(&self, index: usize, seed: u64) -> Vec<PartialNetwork<D>> {
        let source = self.sources[index % self.sources.len()];
        let proposals = source.propose(self.measured, index / self.sources.len(), seed);
        if proposals.is_empty() && self.sources.len() > 1 {
            // A source that has nothing more to say leaves its turn to the first, under a number
            // that no other call has.
            return self.sources[0].propose(self.measured, EXTRA_TURNS + index, seed);
        }
        proposals
    }

    /// Whether a start estimates the scale of its residuals first, where the noise is known: every other one of each
    /// source. The loss of known noise is narrow, and has a minimum wherever as many measurements fit as there are unknowns.
    fn adapts(&self, index: usize) -> bool {
        self.deviation.is_some() && index / self.sources.len() % 2 == 1
    }

    fn start(
        &self,
        refiner: &mut NetworkRefiner<'_, D>,
        proposals: &[PartialNetwork<D>],
        adapts: bool,
        monitor: &Monitor,
    ) -> Vec<RefinedNetwork<D>> {
        let mut ranked: Vec<(f64, Network<D>)> = proposals
            .iter()
            .filter_map(|part| extend(self.observations, part, &self.wide, monitor).ok().flatten())
            .filter(|network| network.is_finite())
            .map(|network| (self.rank(&network), network))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let limit = ranked.first().map_or(0.0, |best| best.0 + AS_GOOD);
        let promising = ranked.iter().take(MOST_REFINED).filter(|(cost, _)| *cost <= limit).count();
        let mut refined: Vec<RefinedNetwork<D>> = ranked
            .into_iter()
            .take(promising.max(REFINED))
            .map(|(_, network)| self.refined(refiner, network, adapts))
            .map(|refined| self.judge(refined))
            .filter(|refined| refined.objective.is_finite() && refined.network.is_finite())
            .collect();
        refined.sort_by(|a, b| a.objective.total_cmp(&b.objective));
        distinct(refined, MOST_REFINED)
    }

    fn refined(&self, refiner: &mut NetworkRefiner<'_, D>, network: Network<D>, adapts: bool) -> RefinedNetwork<D> {
        if !adapts {
            return refiner.refine(network, &self.refine);
        }
        let free = refiner.refine(network, &RefineOptions { scale: None, ..self.refine });
        let near = RefineOptions { anneal_from: Some(free.scale), by_leverage: false, ..self.refine };
        refiner.refine(free.network, &near)
    }

    /// Replaces the objective by the truncated cost where the noise is known.
    fn judge(&self, refined: RefinedNetwork<D>) -> RefinedNetwork<D> {
        match self.deviation {
            Some(deviation) => {
                let objective = truncated_cost(self.observations, &refined.network, deviation);
                RefinedNetwork { objective, ..refined }
            }
            None => refined,
        }
    }

    fn rank(&self, network: &Network<D>) -> f64 {
        let mut all = vec![0.0; self.observations.len()];
        residuals(self.observations, network, &mut all);
        self.wide.total(all.into_iter())
    }
}

/// How many of `all` ended in the basin of `best`. Where receivers lie in one plane, transmitters have mirror
/// images, and hardly two starts choose the same side for all of them.
fn starts_in<const D: usize>(best: &RefinedNetwork<D>, all: &[RefinedNetwork<D>]) -> usize {
    let near = all.iter().filter(|r| r.starts > 0 && r.objective < best.objective + SAME_BASIN);
    near.filter(|r| same_but_for_sides(&r.network, &best.network)).count()
}
