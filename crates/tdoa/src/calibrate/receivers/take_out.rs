//! Errors of whole receivers, removed: they are estimated together with the network, or the
//! measurements that have them are left out.

use faer::Mat;
use faer::prelude::Solve;
use hc::Monitor;

use crate::calibrate::input::middle_delays::middle_delays;
use crate::calibrate::judge::neighbours::{Neighbour, Reason};
use crate::calibrate::options::{CalibrateError, ReceiverDelays, check};
use crate::calibrate::receivers::evidence::{Shown, look};
use crate::calibrate::receivers::refits::Refit;
use crate::calibrate::receivers::score_test::{Fault, ReceiverErrorKind};
use crate::calibrate::search::deviation::{inlier_deviation, spread_of_residuals, typical_deviation};
use crate::calibrate::search::finish::CAUCHY;
use crate::calibrate::search::same_network::merged;
use crate::calibrate::search::truncated_cost::{annealed, truncated_cost};
use crate::calibrate::state::State;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{Cancelled, Motion, NetworkRefiner, Projection, RefineOptions, RefinedNetwork, SEARCH, dot, gram};

/// Rounds of looking for further errors once those found are taken out.
const ROUNDS: usize = 6;

/// Steps of estimating the errors and refining the network in turns.
const STEPS: usize = 12;

/// An error below this many of its own deviations, or below this share of the deviation of a
/// measurement, is none.
const LEAST_DEVIATIONS: f64 = 3.0;
const LEAST_SHARE: f64 = 0.2;

/// Networks whose delays are estimated to the end where all receivers have one.
const CANDIDATES: usize = 10;

/// Deviations, in those that the residuals have, at which such a network is fitted by least squares at first, and
/// where measurements are still given up after that.
const WIDEST: [f64; 2] = [10.0, 100.0];

/// Steps of bringing a network and the delays of all receivers near their best fit.
const COARSE: usize = 24;

/// Errors with their sizes, the network beside them, and the deviation that is left.
type Estimated<const D: usize> = (Vec<Fault<D>>, RefinedNetwork<D>, f64);

impl<const D: usize> State<'_, D> {
    /// Looks for errors of receivers in the best network and takes them out as the options say.
    pub(crate) fn clear(&mut self) -> Result<(), CalibrateError<D>> {
        let near = std::mem::take(&mut self.neighbours);
        match self.options.receiver_delays {
            ReceiverDelays::None => {
                let Shown { found, doubted, .. } = self.look()?;
                self.left = found;
                self.doubt_of(doubted);
            }
            ReceiverDelays::Auto => self.take_out_shown()?,
            ReceiverDelays::All => self.take_out_all()?,
        }
        // They are near the network that has the errors.
        if self.taken.is_empty() {
            self.neighbours.splice(0..0, near);
        }
        self.measured = self.corrected(&self.taken);
        Ok(())
    }

    /// Takes out the errors that receivers show until none is left.
    fn take_out_shown(&mut self) -> Result<(), CalibrateError<D>> {
        // Errors that were none once others were taken out.
        let mut none: Vec<Fault<D>> = Vec::new();
        let mut rivals = Vec::new();
        for _ in 0..ROUNDS {
            let shown = self.look()?;
            let known = |f: &Fault<D>, t: &Fault<D>| t.receiver == f.receiver && t.kind == f.kind;
            let fresh = |f: &&Fault<D>| !self.taken.iter().chain(&none).any(|t| known(f, t));
            let fresh: Vec<Fault<D>> = shown.found.iter().filter(fresh).copied().collect();
            if fresh.is_empty() {
                self.doubt_of(shown.doubted.into_iter().chain(rivals));
                self.left = shown.found;
                break;
            }
            self.taken.extend(fresh);
            rivals = shown.rivals;
            if let Some(network) = shown.hidden {
                let first = RefinedNetwork { network, ..self.ranked[0].clone() };
                self.ranked.insert(0, first);
            }
            self.fit_without_taken()?;
            while let Some(k) = self.negligible()? {
                none.push(self.taken.remove(k));
                self.fit_without_taken()?;
            }
        }
        Ok(())
    }

    /// Errors that the best network shows.
    fn look(&self) -> Result<Shown<D>, CalibrateError<D>> {
        let (best, least) = (&self.ranked[0].network, self.least_size(self.deviation));
        look(&self.observations, best, self.deviation, least, self.options, self.monitor)
    }

    /// Adds networks without errors that are worth a doubt to the neighbours.
    fn doubt_of(&mut self, doubted: impl IntoIterator<Item = Refit<D>>) {
        let is_new =
            |f: &Refit<D>| !self.taken.iter().any(|t| t.receiver == f.fault.receiver && t.kind == f.fault.kind);
        let of = |f: Refit<D>| Neighbour::new(&f.network, -f.lead, Reason::Error(f.fault), &self.ranked[0].network);
        let doubted: Vec<Neighbour<D>> = doubted.into_iter().filter(is_new).filter_map(of).collect();
        self.neighbours.extend(doubted);
    }

    /// Smaller errors of receivers are none.
    fn least_size(&self, deviation: f64) -> f64 {
        LEAST_SHARE * deviation * typical_deviation(&self.measured)
    }

    /// The smallest of the errors taken out, in its own deviations, if it is none.
    fn negligible(&self) -> Result<Option<usize>, CalibrateError<D>> {
        let network = &self.ranked[0].network;
        let reach = self.options.inlier_threshold * self.deviation;
        let kept = self.observations.subset(|o| o.residual(network).abs() <= reach);
        let Some(projection) = Projection::new(&kept, network, self.monitor)? else { return Ok(None) };
        let columns = columns(&kept, &projection, &self.taken, self.monitor)?;
        let Some(gram) = gram(&columns, self.monitor)? else { return Ok(None) };
        let inverse = gram.solve(&Mat::<f64>::identity(columns.len(), columns.len()));
        let at = self.taken.iter().enumerate().filter(|(_, fault)| fault.kind != ReceiverErrorKind::Move);
        let sizes = at.enumerate().map(|(a, (k, fault))| {
            let size = fault.size[0].abs();
            let own = size / (self.deviation * inverse[(a, a)].max(0.0).sqrt());
            (k, own / LEAST_DEVIATIONS, size / self.least_size(self.deviation))
        });
        let least = sizes.min_by(|a, b| a.1.min(a.2).total_cmp(&b.1.min(b.2)));
        Ok(least.filter(|least| least.1.min(least.2) < 1.0).map(|least| least.0))
    }

    /// Fits the networks again, with the errors in `taken` estimated for the best of them.
    fn fit_without_taken(&mut self) -> Result<(), CalibrateError<D>> {
        let taken = std::mem::take(&mut self.taken);
        (self.taken, _, _) = self.estimate(self.ranked[0].clone(), self.deviation, taken)?;
        self.observations = self.observe(&self.taken);
        let wide = spread_of_residuals(&self.observations, &self.ranked[0].network);
        self.finish(self.known.unwrap_or(wide))
    }

    /// The measurements without these errors, of which some are unknowns.
    fn observe(&self, faults: &[Fault<D>]) -> Observations<D> {
        Observations::new(&self.corrected(faults), |_, _| true).beside(linear(faults).count())
    }

    /// Takes a delay of every receiver out, relative to their mean, for each of the best networks on its own.
    fn take_out_all(&mut self) -> Result<(), CalibrateError<D>> {
        let receivers = self.measured.receivers();
        let middle = middle_delays(&self.measured);
        let delay = |receiver: usize, size: f64| {
            let mut fault = Fault::new(receiver, ReceiverErrorKind::Delay, 0);
            fault.size[0] = size;
            fault
        };
        // The mean of all delays cannot be told from the offsets.
        let unknown: Vec<Fault<D>> = (1..receivers).map(|i| delay(i, middle[i] - middle[0])).collect();
        // The search took the first receiver's too: what it says of offsets lacks that.
        let networks = std::mem::take(&mut self.ranked).into_iter().map(|mut refined| {
            refined.network.offsets.iter_mut().for_each(|offset| *offset += middle[0]);
            refined
        });
        let (measurements, unknowns) = (self.observations.len(), self.observations.unknowns() + unknown.len());
        if measurements < unknowns {
            return Err(CalibrateError::Delays { measurements, unknowns, receivers });
        }
        let mut near = Vec::new();
        for candidate in networks {
            near.push(self.approach(candidate, unknown.clone())?);
        }
        self.rank_by_cost(&mut near);
        let mut all = Vec::new();
        for candidate in near.into_iter().take(CANDIDATES) {
            let (faults, refined, deviation) = self.relaxed(candidate)?;
            all.push(self.estimate(refined, deviation, faults)?);
        }
        // One that has run away fits what few measurements it has left.
        let (sound, lost): (Vec<_>, Vec<_>) = all.into_iter().partition(|estimated| self.is_left_over(estimated));
        let mut all = if sound.is_empty() { lost } else { sound };
        self.rank_by_cost(&mut all);
        // They were apart only for as long as the delays were wrong.
        let all = merged(all, |(_, refined, _)| refined);
        let (mut taken, _, deviation) = all[0].clone();
        let mean = taken.iter().map(|fault| fault.size[0]).sum::<f64>() / receivers as f64;
        taken.insert(0, delay(0, 0.0));
        for fault in &mut taken {
            fault.size[0] -= mean;
        }
        self.observations = Observations::new(&self.corrected(&taken), |_, _| true).beside(unknown.len());
        self.ranked = all.into_iter().map(|(_, refined, _)| refined).collect();
        for refined in &mut self.ranked {
            for offset in refined.network.offsets.iter_mut() {
                *offset += mean;
            }
        }
        (self.taken, self.deviation) = (taken, deviation);
        Ok(())
    }

    /// Sizes of errors and a network brought near their best fit, with the deviation that is left:
    /// the loss is as wide as the residuals, which are those of wrong sizes at first.
    fn approach(
        &self,
        mut best: RefinedNetwork<D>,
        mut faults: Vec<Fault<D>>,
    ) -> Result<Estimated<D>, CalibrateError<D>> {
        let least = self.known.unwrap_or(self.floor);
        let mut deviation = least;
        for _ in 0..COARSE {
            check(self.monitor)?;
            let observations = self.observe(&faults);
            deviation = spread_of_residuals(&observations, &best.network).max(least);
            let refine = RefineOptions { scale: Some(CAUCHY * deviation), steps: 8, rounds: 1, ..SEARCH };
            let refined = NetworkRefiner::new(&observations, 1.0).heeding(self.monitor).refine(best.network, &refine);
            best = RefinedNetwork { starts: best.starts, ..refined };
            let wide = inlier_deviation(&observations, &best.network, deviation, self.options.inlier_threshold);
            let Some(steps) = self.step(&observations, &best.network, wide, &faults)? else { break };
            if moved(&mut faults, steps) < 1e-2 * deviation {
                break;
            }
        }
        Ok((faults, best, deviation))
    }

    /// The same by least squares, at first over measurements that were given up too: a network may
    /// have bent itself to a wrong delay. What it was, where that costs less.
    fn relaxed(&self, near: Estimated<D>) -> Result<Estimated<D>, CalibrateError<D>> {
        let deviation = near.2;
        let cost =
            |(faults, refined, _): &Estimated<D>| truncated_cost(&self.observe(faults), &refined.network, deviation);
        let gives_up = |(faults, refined, _): &Estimated<D>| {
            let reach = self.options.inlier_threshold * deviation;
            self.observe(faults).all().iter().any(|o| o.residual(&refined.network).abs() > reach)
        };
        let mut best = near.clone();
        for widest in WIDEST {
            let next = self.narrowed(near.clone(), annealed(widest))?.filter(|next| cost(next) < cost(&best));
            best = next.unwrap_or(best);
            if !gives_up(&best) {
                break;
            }
        }
        Ok(best)
    }

    /// Least squares over the inliers of so many deviations one after the other; `None` where the
    /// errors are not determined.
    fn narrowed(&self, from: Estimated<D>, factors: &[f64]) -> Result<Option<Estimated<D>>, CalibrateError<D>> {
        let (mut faults, mut refined, deviation) = from;
        for factor in factors {
            for _ in 0..STEPS {
                check(self.monitor)?;
                let observations = self.observe(&faults);
                let wide = factor * deviation;
                let reach = self.options.inlier_threshold * wide;
                let inliers = observations.subset(|o| o.residual(&refined.network).abs() <= reach);
                let refine = RefineOptions { scale: Some(wide), steps: 8, rounds: 0, ..SEARCH };
                let mut refiner = NetworkRefiner::new(&inliers, f64::INFINITY).heeding(self.monitor);
                refined.network = refiner.refine(refined.network, &refine).network;
                let Some(steps) = self.step(&observations, &refined.network, wide, &faults)? else { return Ok(None) };
                if moved(&mut faults, steps) < 1e-2 * deviation {
                    break;
                }
            }
        }
        Ok(Some((faults, refined, deviation)))
    }

    /// Whether a network has more inliers than unknowns.
    fn is_left_over(&self, (faults, refined, deviation): &Estimated<D>) -> bool {
        let observations = self.observe(faults);
        let reach = self.options.inlier_threshold * deviation;
        let inliers = observations.all().iter().filter(|o| o.residual(&refined.network).abs() <= reach).count();
        refined.network.is_finite() && inliers > observations.unknowns()
    }

    /// Sorts networks, each with its errors, by the truncated cost with the smallest deviation that
    /// one of them leaves: with deviations of their own the one that fits worst would look best.
    fn rank_by_cost(&self, all: &mut [Estimated<D>]) {
        let least = all.iter().map(|(.., deviation)| *deviation).fold(f64::INFINITY, f64::min);
        let deviation = self.known.unwrap_or(least).max(self.floor);
        for (faults, refined, _) in all.iter_mut() {
            refined.objective = truncated_cost(&self.observe(faults), &refined.network, deviation);
        }
        all.sort_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
    }

    /// Sizes of errors beside a network: steps of least squares for the errors with the network,
    /// and the robust refinement of the network at these sizes, in turns.
    fn estimate(
        &self,
        mut best: RefinedNetwork<D>,
        mut deviation: f64,
        mut faults: Vec<Fault<D>>,
    ) -> Result<Estimated<D>, CalibrateError<D>> {
        for step in 0..STEPS {
            check(self.monitor)?;
            let observations = self.observe(&faults);
            let wide = spread_of_residuals(&observations, &best.network).max(self.known.unwrap_or(self.floor));
            let first = if step == 0 { self.known.unwrap_or(wide) } else { self.known.unwrap_or(deviation.min(wide)) };
            let (mut ranked, next) = self.finished(&observations, vec![best.clone()], first)?;
            (best, deviation) = (ranked.swap_remove(0), next);
            let wide = inlier_deviation(&observations, &best.network, wide, self.options.inlier_threshold);
            let Some(steps) = self.step(&observations, &best.network, wide, &faults)? else { break };
            if moved(&mut faults, steps) < 1e-3 * deviation {
                break;
            }
        }
        Ok((faults, best, deviation))
    }

    /// The change of the sizes by least squares over the inliers, network and sizes together;
    /// `None` if it is not determined.
    fn step(
        &self,
        observations: &Observations<D>,
        network: &Network<D>,
        wide: f64,
        faults: &[Fault<D>],
    ) -> Result<Option<Vec<f64>>, CalibrateError<D>> {
        let kept = observations.subset(|o| o.residual(network).abs() <= self.options.inlier_threshold * wide);
        let Some(projection) = Projection::new(&kept, network, self.monitor)? else { return Ok(None) };
        let residuals: Vec<f64> = kept.all().iter().map(|o| o.residual(network)).collect();
        let columns = columns(&kept, &projection, faults, self.monitor)?;
        let Some(gram) = gram(&columns, self.monitor)? else { return Ok(None) };
        let right = Mat::from_fn(columns.len(), 1, |a, _| dot(&columns[a].0, &residuals));
        let solved = gram.solve(&right);
        let steps: Vec<f64> = (0..columns.len()).map(|a| solved[(a, 0)]).collect();
        Ok(Some(steps).filter(|steps| steps.iter().all(|x| x.is_finite())))
    }

    fn corrected(&self, faults: &[Fault<D>]) -> Pseudoranges {
        without_errors(&self.measured, faults)
    }
}

/// The measurements without these errors: the shorter part of a receiver that was moved is missing.
pub(crate) fn without_errors<const D: usize>(measured: &Pseudoranges, faults: &[Fault<D>]) -> Pseudoranges {
    let n = measured.transmitters();
    let mut kept = measured.clone();
    let mut shifts: Vec<Vec<&Fault<D>>> = vec![Vec::new(); measured.receivers()];
    for fault in faults {
        if fault.kind == ReceiverErrorKind::Move {
            let (before, after): (Vec<usize>, Vec<usize>) =
                kept.cells().row(fault.receiver).map(|(j, _)| j).partition(|j| *j < fault.from);
            let before_is_shorter = before.len() < after.len();
            kept = kept.filter(|i, j, _| i != fault.receiver || (j < fault.from) != before_is_shorter);
        } else {
            shifts[fault.receiver].push(fault);
        }
    }
    kept.map(|i, j, value| shifts[i].iter().fold(*value, |value, fault| value - fault.size[0] * fault.shape(j, n)))
}

/// Errors that are unknowns beside the network; of a move measurements are left out instead.
fn linear<const D: usize>(faults: &[Fault<D>]) -> impl Iterator<Item = &Fault<D>> {
    faults.iter().filter(|fault| fault.kind != ReceiverErrorKind::Move)
}

/// Changes the sizes of the errors that have one by these steps; the largest step.
fn moved<const D: usize>(faults: &mut [Fault<D>], steps: Vec<f64>) -> f64 {
    let mut largest = 0.0f64;
    for (fault, step) in linear_mut(faults).zip(steps) {
        fault.size[0] += step;
        largest = largest.max(step.abs());
    }
    largest
}

fn linear_mut<const D: usize>(faults: &mut [Fault<D>]) -> impl Iterator<Item = &mut Fault<D>> {
    faults.iter_mut().filter(|fault| fault.kind != ReceiverErrorKind::Move)
}

/// What errors of size 1 add to the residuals, less what motions of the nodes make of it, with
/// those motions.
pub(crate) fn columns<const D: usize>(
    kept: &Observations<D>,
    projection: &Projection<'_, D>,
    faults: &[Fault<D>],
    monitor: &Monitor,
) -> Result<Vec<(Vec<f64>, Motion<D>)>, Cancelled> {
    let n = kept.transmitters;
    let column = |fault: &Fault<D>| -> Vec<f64> {
        let part = |o: &crate::observations::Observation| {
            if o.receiver == fault.receiver { o.precision * fault.shape(o.transmitter, n) } else { 0.0 }
        };
        kept.all().iter().map(part).collect()
    };
    let off = |fault| {
        crate::refine::check(monitor)?;
        Ok(projection.off(&column(fault)))
    };
    linear(faults).map(off).collect()
}

#[cfg(test)]
mod tests {
    use super::{Fault, ReceiverErrorKind, State};
    use crate::refine::RefinedNetwork;
    use crate::{CalibrateOptions, SimulateOptions, simulate};
    use hc::Monitor;

    /// Whether exact measurements of seven receivers are more than the unknowns, with a delay of each receiver but
    /// one beside the network.
    fn is_left_over<const D: usize>(transmitters: usize) -> bool {
        let mut made = SimulateOptions::<D>::new();
        (made.receivers, made.transmitters) = (7, transmitters);
        let made = simulate(&made).unwrap();
        let options = CalibrateOptions::<D>::new();
        let monitor = Monitor::default();
        let state = State::new(made.pseudoranges, None, &options, &monitor);
        let faults: Vec<Fault<D>> = (1..7).map(|i| Fault::new(i, ReceiverErrorKind::Delay, 0)).collect();
        assert_eq!(state.observations.unknowns(), D * 7 + (D + 1) * transmitters - D * (D + 1) / 2);
        let refined = RefinedNetwork { network: made.network, scale: 1.0, objective: 0.0, starts: 1 };
        state.is_left_over(&(faults, refined, 1e-3))
    }

    #[test]
    fn unknowns_are_those_of_the_dimension() {
        // 7r/n in the plane: 7 n measurements for 17 + 3 n unknowns. In space: for 21 + 4 n.
        assert_eq!([4, 5].map(is_left_over::<2>), [false, true]);
        assert_eq!([5, 6, 7, 8].map(is_left_over::<3>), [false, false, false, true]);
    }
}
