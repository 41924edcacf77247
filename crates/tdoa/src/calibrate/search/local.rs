//! Networks in which each transmitter is heard only by the receivers near it: small networks of
//! neighbouring receivers, laid together where they overlap, then refined as one.

use crate::calibrate::options::{CalibrateError, CalibrateOptions, SearchOptions, check};
use crate::calibrate::search::candidates::search_candidates;
use crate::calibrate::search::deviation::{median_size, typical_deviation};
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::search::submaps::{FIT, PlacedReceiver, Submap, fit, largest, overlap};
use crate::calibrate::state::State;
use crate::calibrate::unfinished::Unfinished;
use crate::clocks::Recorders;
use crate::degeneracy::usable;
use crate::loss::{Loss, SEARCH_NU, normal_deviation};
use crate::network::Network;
use crate::points::{distance, spread};
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, PartialNetwork, RefineOptions, SEARCH, extend};
use hc::{Monitor, Stage};

/// Receivers and transmitters of a submap.
const RECEIVERS: usize = 10;
const TRANSMITTERS: usize = 60;

/// Fewest and most starts of the search of one submap, and how many must agree: submaps check each
/// other, and one that needs more is no help.
const STARTS: usize = 16;
const MOST_STARTS: usize = 128;
const AGREEING: usize = 5;

/// Receivers that must hear a transmitter of a submap: two more than locate it, or nearly so.
pub(crate) const fn heard_by<const D: usize>() -> usize {
    D + 3
}

/// Pairs of receivers with fewer common transmitters say nothing of their distance; where they are
/// more than this share of all, hearing is local.
const COMMON: usize = 3;
const LOCAL: f64 = 0.2;

/// What the submaps say of the receivers: those that hang together.
pub(crate) struct ReceiverLayout<const D: usize> {
    pub(crate) submaps: Vec<Submap<D>>,
    /// In one frame, with clocks against one of them; `None` where no submap ties a receiver to the others.
    pub(crate) receivers: Vec<Option<PlacedReceiver<D>>>,
    /// How many submaps were solved.
    pub(crate) solved: usize,
    /// Size of the largest submap, metres.
    pub(crate) size: f64,
}

/// Whether so many pairs of receivers hear no transmitter in common that no small part stands for
/// the whole.
pub(crate) fn hearing_is_local(measured: &Pseudoranges) -> bool {
    let m = measured.receivers();
    if m <= RECEIVERS {
        return false;
    }
    let common = common_transmitters(measured);
    let few = (0..m).flat_map(|a| (a + 1..m).map(move |b| (a, b))).filter(|&(a, b)| common[a * m + b] < COMMON).count();
    few as f64 > LOCAL * (m * (m - 1) / 2) as f64
}

/// Row-major: how many transmitters each two receivers hear in common.
fn common_transmitters(measured: &Pseudoranges) -> Vec<usize> {
    let m = measured.receivers();
    let mut common = vec![0; m * m];
    for j in 0..measured.transmitters() {
        let heard: Vec<usize> = (0..m).filter(|&i| measured.get(i, j).is_some()).collect();
        for &a in &heard {
            for &b in &heard {
                common[a * m + b] += 1;
            }
        }
    }
    common
}

/// Solves the neighbourhood of each receiver and lays the results together; stopped, those that it has.
///
/// # Errors
/// Cancelled, or no neighbourhood could be solved.
pub(crate) fn lay_out<const D: usize>(
    measured: &Pseudoranges,
    known: Option<f64>,
    options: &CalibrateOptions<D>,
    monitor: &Monitor,
    so_far: &mut Option<Unfinished<D>>,
) -> Result<ReceiverLayout<D>, CalibrateError<D>> {
    let m = measured.receivers();
    let mut submaps: Vec<Submap<D>> = Vec::new();
    let solved = solve_neighbourhoods(measured, known, options, monitor, &mut submaps);
    if submaps.is_empty() {
        solved?;
        return Err(CalibrateError::NotFound(m));
    }
    let receivers = largest(&submaps, m);
    let size = submaps.iter().map(|submap| submap.size).fold(0.0, f64::max);
    let layout = ReceiverLayout { solved: submaps.len(), submaps, receivers, size };
    *so_far = Some(layout.unfinished(measured));
    solved.map(|()| layout)
}

/// Solves the neighbourhood of each receiver.
fn solve_neighbourhoods<const D: usize>(
    measured: &Pseudoranges,
    known: Option<f64>,
    options: &CalibrateOptions<D>,
    monitor: &Monitor,
    submaps: &mut Vec<Submap<D>>,
) -> Result<(), CalibrateError<D>> {
    let m = measured.receivers();
    let common = common_transmitters(measured);
    let options = &CalibrateOptions {
        search: SearchOptions {
            min_starts: options.search.min_starts.min(STARTS),
            max_starts: options.search.max_starts.min(MOST_STARTS),
            agreeing: options.search.agreeing.min(AGREEING),
            ..options.search
        },
        ..options.clone()
    };
    let mut tried: Vec<Vec<usize>> = Vec::new();
    monitor.enter(Stage::Search, m as u64);
    for centre in 0..m {
        check(monitor)?;
        let mut order: Vec<usize> = (0..m).filter(|&i| common[centre * m + i] >= COMMON).collect();
        // The receiver itself hears all that it hears.
        order.sort_by_key(|&i| std::cmp::Reverse(common[centre * m + i]));
        order.truncate(RECEIVERS);
        order.sort_unstable();
        if tried.contains(&order) {
            continue;
        }
        tried.push(order.clone());
        submaps.extend(solve(measured, &order, known, options, &monitor.quiet())?);
        monitor.reach(centre as u64 + 1, submaps.len() as u64);
    }
    Ok(())
}

/// The network of some receivers if their transmitters determine it and no other network fits about
/// as well.
fn solve<const D: usize>(
    measured: &Pseudoranges,
    receivers: &[usize],
    known: Option<f64>,
    options: &CalibrateOptions<D>,
    monitor: &Monitor,
) -> Result<Option<Submap<D>>, CalibrateError<D>> {
    let heard = |j: usize| receivers.iter().filter(|&&i| measured.get(i, j).is_some()).count();
    let mut transmitters: Vec<usize> = (0..measured.transmitters()).filter(|&j| heard(j) >= heard_by::<D>()).collect();
    transmitters.sort_by_key(|&j| std::cmp::Reverse(heard(j)));
    transmitters.truncate(TRANSMITTERS);
    transmitters.sort_unstable();
    let part = measured.select(receivers, &transmitters);
    let Ok(kept) = usable::<D>(&part) else { return Ok(None) };
    let part = part.select(&kept.receivers, &kept.transmitters);
    let mut found = State::new(part, known, options, monitor);
    match search_candidates(&mut found, &[]) {
        Ok(()) => {}
        Err(error @ CalibrateError::Cancelled(_)) => return Err(error),
        Err(_) => return Ok(None),
    }
    let rivals =
        found.ranked[1..].iter().any(|r| r.objective <= found.ranked[0].objective + options.alternative_margin);
    let best = &found.ranked[0];
    if rivals || best.starts < 2 {
        return Ok(None);
    }
    Ok(Some(Submap {
        receivers: kept.receivers.iter().map(|&i| receivers[i]).collect(),
        positions: best.network.receivers.clone(),
        clocks: clocks_of(&found.measured, &best.network),
        size: best.network.size(),
    }))
}

/// The clocks of the receivers of a network with all that was taken off its measurements; zero where they share one.
fn clocks_of<const D: usize>(measured: &Pseudoranges, network: &Network<D>) -> Vec<[f64; 2]> {
    let taken = measured.unknown_clocks().map_or(&[][..], Recorders::taken);
    let of = |clocks: &[[f64; 2]], i: usize| clocks.get(i).copied().unwrap_or_default();
    let both = |i| [0, 1].map(|k| of(taken, i)[k] + of(&network.clocks, i)[k]);
    (0..measured.receivers()).map(both).collect()
}

impl<const D: usize> ReceiverLayout<D> {
    /// The places that a source of networks proposes first, if it has receivers for all.
    pub(crate) fn proposed(
        measured: &Pseudoranges,
        source: &dyn Hypotheses<D>,
        seed: u64,
    ) -> Option<ReceiverLayout<D>> {
        if measured.unknown_clocks().is_some() {
            // Positions tell nothing of clocks.
            return None;
        }
        let positions = source.propose(measured, 0, seed).into_iter().next()?.receivers;
        let positions: Vec<[f64; D]> = positions.into_iter().collect::<Option<_>>()?;
        // As much as ten neighbours would take of it.
        let size = (RECEIVERS as f64 / positions.len() as f64).sqrt() * spread(positions.iter());
        let placed = |position| Some(PlacedReceiver { position, clock: [0.0; 2] });
        let receivers = positions.into_iter().map(placed).collect();
        Some(ReceiverLayout { submaps: Vec::new(), receivers, solved: 1, size })
    }

    /// The receivers alone.
    pub(crate) fn unfinished(&self, measured: &Pseudoranges) -> Unfinished<D> {
        let positions = (0..self.receivers.len()).map(|i| self.position(i)).collect();
        Unfinished::laid(positions, measured.transmitters(), self.solved)
    }

    pub(crate) fn position(&self, receiver: usize) -> Option<[f64; D]> {
        self.receivers[receiver].map(|placed| placed.position)
    }

    /// How many submaps fit a network of these receivers, and the places of receivers among them that
    /// are in none of these, or only in such as share too few receivers with others.
    fn support(&self, network: &Network<D>, receivers: &[usize]) -> (usize, Vec<usize>) {
        let mut placed = vec![None; self.receivers.len()];
        for (&i, &p) in receivers.iter().zip(&network.receivers) {
            placed[i] = Some(p);
        }
        let mut fitting: Vec<Vec<usize>> = Vec::new();
        for submap in &self.submaps {
            let Some((_, map)) = fit(submap, |i| placed[i]) else { continue };
            let near = |(&i, &p): (&usize, &[f64; D])| {
                let limit = 3.0 * FIT * submap.size;
                placed[i].is_some_and(|q| distance(map.apply(p), q) <= limit).then_some(i)
            };
            fitting.push(submap.receivers.iter().zip(&submap.positions).filter_map(near).collect());
        }
        let mut counts = vec![0; self.receivers.len()];
        fitting.iter().flatten().for_each(|&i| counts[i] += 1);
        let overlaps = |submap: &&Vec<usize>| submap.iter().filter(|&&i| counts[i] > 1).count() >= overlap::<D>();
        let sure: Vec<&Vec<usize>> = fitting.iter().filter(overlaps).collect();
        let weak = (0..receivers.len()).filter(|&k| !sure.iter().any(|submap| submap.contains(&receivers[k])));
        (fitting.len(), weak.collect())
    }

    /// The clocks of these receivers beside what was taken off their measurements, as far as a receiver of the same
    /// recorder is placed; empty where all share one.
    pub(crate) fn clocks(&self, measured: &Pseudoranges, receivers: &[usize]) -> Vec<Option<[f64; 2]>> {
        let Some(recorders) = measured.unknown_clocks() else { return Vec::new() };
        let of_recorder = |recorder: usize| {
            let mut all = recorders.of_receivers().iter().zip(receivers).filter(move |(of, _)| **of == recorder);
            all.find_map(|(_, &i)| self.receivers[i]).map(|placed| placed.clock)
        };
        let both = recorders.of_receivers().iter().zip(recorders.taken());
        let beside = |(recorder, taken): (&usize, &[f64; 2])| {
            of_recorder(*recorder).map(|clock| [clock[0] - taken[0], clock[1] - taken[1]])
        };
        both.map(beside).collect()
    }

    /// Gives a state that has no network that of the placed receivers, refined as one. The state has these
    /// receivers alone, with their indices beside.
    ///
    /// # Errors
    /// Cancelled, or a transmitter that cannot be located.
    pub(crate) fn refine(&self, state: &mut State<'_, D>, receivers: &[usize]) -> Result<(), CalibrateError<D>> {
        let State { measured, observations, monitor, known, so_far, .. } = state;
        let unit = typical_deviation(measured);
        let size = self.size / unit;
        let mut part = PartialNetwork::unknown(measured.receivers(), measured.transmitters());
        part.receivers = receivers.iter().map(|&i| self.position(i)).collect();
        let clocks: Option<Vec<[f64; 2]>> = self.clocks(measured, receivers).into_iter().collect();
        part.clocks = observations.clocks().against_the_first(clocks.unwrap_or_default());
        let wide = Loss { nu: SEARCH_NU, scale: FIT * size };
        *so_far = Some(Unfinished::laid(part.receivers.clone(), measured.transmitters(), self.solved));
        let network = extend(observations, &part, &wide, monitor)?.ok_or(CalibrateError::NotFound(self.solved))?;
        // Submaps that were laid one beside the other bend a little as a whole.
        let bent = median_size(observations, &network).max(FIT * size);
        let refine = RefineOptions { anneal_from: Some(bent), steps: 60, floor: 1e-9 * size, ..SEARCH };
        let to_deviation = normal_deviation(SEARCH_NU);
        let start = RefineOptions { scale: known.map(|sigma| sigma / to_deviation), ..refine };
        let mut refiner = NetworkRefiner::new(observations, SEARCH_NU, monitor);
        let mut refined = refiner.refine(network, &start);
        *so_far = Some(Unfinished::of(&refined.network, self.solved, 0));
        check(monitor)?;
        let (fitting, weak) = self.support(&refined.network, receivers);
        refined.starts = fitting;
        let first = known.unwrap_or(refined.scale * to_deviation).max(refine.floor);
        (state.floor, state.starts, state.weak) = (refine.floor, self.solved, Some(weak));
        state.ranked = vec![refined];
        state.finish(first)
    }
}

#[cfg(test)]
mod tests {
    use crate::accuracy::cramer_rao_with_clocks;
    use crate::align::align;
    use crate::calibrate::{Calibrates, Dimension};
    use crate::{
        CalibrateOptions, Layout, Pseudoranges, ReceiverClocks, SimulateOptions, Simulation, calibrate, points,
        simulate,
    };

    fn chain(seed: u64) -> Simulation {
        let layout = Layout::Chain { extent: [400.0, 50.0] };
        let options = SimulateOptions {
            receivers: 20,
            transmitters: 120,
            hearing: Some(8),
            noise: 0.1,
            outliers: 0.02,
            outlier_size: 50.0,
            layout,
            seed,
            ..Default::default()
        };
        simulate(&options).unwrap()
    }

    #[test]
    fn a_chain_that_nobody_hears_whole_is_found() {
        let simulation = chain(1);
        let found = calibrate(&simulation.pseudoranges, &CalibrateOptions::default()).unwrap();
        let receivers: Vec<[f64; 2]> = found.receivers.iter().map(|p| p.unwrap()).collect();
        let error = align(&receivers, &simulation.network.receivers, false).unwrap().rms;
        // The covariance is that of least squares without the outliers.
        let variance: f64 = found.receiver_std.iter().map(|std| std.map_or(f64::NAN, |[x, y]| x * x + y * y)).sum();
        let expected = (variance / 20.0).sqrt();
        assert!(error < 3.0 * expected && expected < 5.0, "{error} {expected}");
        assert!(found.unique, "{:?}", found.warnings);
    }

    #[test]
    fn a_chain_in_space_is_found() {
        let mut options = SimulateOptions::<3>::new();
        (options.receivers, options.transmitters, options.hearing) = (20, 160, Some(9));
        (options.noise, options.seed) = (0.05, 1);
        options.layout = Layout::Chain { extent: [300.0, 60.0, 40.0] };
        let simulation = simulate(&options).unwrap();
        let found = calibrate(&simulation.pseudoranges, &CalibrateOptions::<3>::new()).unwrap();
        assert!(found.laid_together && found.unique, "{:?}", found.warnings);
        let receivers: Vec<[f64; 3]> = found.receivers.iter().map(|p| p.unwrap()).collect();
        let error = align(&receivers, &simulation.network.receivers, false).unwrap().rms;
        let variance: f64 =
            found.receiver_std.iter().map(|std| std.map_or(f64::NAN, |std| points::dot(std, std))).sum();
        let expected = (variance / 20.0).sqrt();
        assert!(error < 3.0 * expected && expected < 5.0, "{error} {expected}");
    }

    /// A network with recorders that were started apart is as near to the truth as its measurements tell.
    fn is_laid_at_the_bound<const D: usize>(made: SimulateOptions<D>, clocks: ReceiverClocks)
    where
        Dimension<D>: Calibrates<D>,
    {
        let made = simulate(&made).unwrap();
        let mut options = CalibrateOptions::<D>::new();
        options.clocks.receivers = clocks;
        let found = calibrate(&made.pseudoranges, &options).unwrap();
        assert!(found.laid_together && found.unique, "{:?}", found.warnings);
        let receivers: Vec<[f64; D]> = found.receivers.iter().map(|p| p.unwrap()).collect();
        let error = align(&receivers, &made.network.receivers, false).unwrap().rms;
        let bound = cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, &made.network, 0.01, &options.clocks);
        assert!(error < 3.0 * bound, "{D} {clocks:?}: {error} {bound}");
    }

    #[test]
    fn clocks_of_recorders_are_laid_together_too() {
        let clocked = |layout| SimulateOptions::<2> {
            receivers: 20,
            transmitters: 120,
            hearing: Some(8),
            noise: 0.01,
            outliers: 0.02,
            delays: 1e3,
            layout,
            ..Default::default()
        };
        let mut field = clocked(Layout::Room { extent: [10.0; 2] });
        (field.receivers, field.transmitters, field.hearing) = (30, 200, Some(9));
        is_laid_at_the_bound(field, ReceiverClocks::Offset);
        let chain = || clocked(Layout::Chain { extent: [400.0, 50.0] });
        is_laid_at_the_bound(SimulateOptions { channels: 2, ..chain() }, ReceiverClocks::Offset);
        is_laid_at_the_bound(SimulateOptions { rates: 2e-5, duration: Some(2e5), ..chain() }, ReceiverClocks::Rate);
        let mut in_space = SimulateOptions::<3>::new();
        (in_space.receivers, in_space.transmitters, in_space.hearing) = (20, 160, Some(9));
        (in_space.noise, in_space.delays) = (0.01, 1e3);
        in_space.layout = Layout::Chain { extent: [300.0, 60.0, 40.0] };
        is_laid_at_the_bound(in_space, ReceiverClocks::Offset);
    }

    #[test]
    fn parts_that_do_not_hang_together_are_named() {
        let simulation = chain(2);
        // Whoever is heard on both sides of the gap is not heard at all: only receivers up to the
        // twelfth, or from the thirteenth on.
        let measured = &simulation.pseudoranges;
        let n = measured.transmitters();
        let side = |j: usize| simulation.network.transmitters[j][0] < 240.0;
        let values = measured.dense().into_iter().enumerate();
        let values = values.map(|(k, value)| if side(k % n) == (k / n < 12) { value } else { f64::NAN }).collect();
        let mut cut = Pseudoranges::new(20, n, values).unwrap();
        // Two common transmitters leave each part free to turn about the other.
        let mut joined = cut.dense();
        for j in (0..n).filter(|&j| (simulation.network.transmitters[j][0] - 240.0).abs() < 20.0).take(2) {
            for i in 9..15 {
                joined[i * n + j] = simulation.network.pseudorange(i, j);
            }
        }
        cut = Pseudoranges::new(20, n, joined).unwrap();
        let found = calibrate(&cut, &CalibrateOptions::default()).unwrap();
        let placed: Vec<usize> = (0..20).filter(|&i| found.receivers[i].is_some()).collect();
        assert_eq!(placed, (0..12).collect::<Vec<_>>(), "{:?}", found.warnings);
        assert!(found.warnings.iter().any(|warning| warning.contains("without r13, r14")), "{:?}", found.warnings);
    }
}
