//! Errors of whole receivers, removed: they are estimated together with the network, or the
//! measurements that have them are left out.

use faer::Mat;
use faer::prelude::Solve;
use hc::Monitor;

use crate::calibrate::judge::neighbours::{Neighbour, Reason};
use crate::calibrate::options::{CalibrateError, ReceiverDelays, check};
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind};
use crate::calibrate::receivers::evidence::{Evidence, find_errors};
use crate::calibrate::receivers::refits::Refit;
use crate::calibrate::search::deviation::{inlier_deviation, spread_of_residuals, typical_deviation};
use crate::calibrate::state::State;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{Cancelled, Motion, Projection, RefinedNetwork, dot, gram};

/// Rounds of looking for further errors once those found are taken out.
const ROUNDS: usize = 6;

/// Steps of estimating the errors and refining the network in turns.
const STEPS: usize = 12;

/// An error below this many of its own deviations, or below this share of the deviation of a
/// measurement, is none.
const LEAST_DEVIATIONS: f64 = 3.0;
const LEAST_SHARE: f64 = 0.2;

/// Errors with their sizes, the network beside them, and the deviation that is left.
pub(crate) type Estimated<const D: usize> = (Vec<Fault<D>>, RefinedNetwork<D>, f64);

impl<const D: usize> State<'_, D> {
    /// Looks for errors of receivers in the best network and takes them out as the options say.
    pub(crate) fn clear(&mut self) -> Result<(), CalibrateError<D>> {
        let near = std::mem::take(&mut self.neighbours);
        match self.options.receiver_delays {
            ReceiverDelays::None => {
                let Evidence { found, doubted, .. } = self.look()?;
                self.left = found;
                self.doubt_of(doubted);
            }
            ReceiverDelays::Auto => {
                let before = self.ranked.clone();
                self.take_out_shown()?;
                self.prefer_delays_of_all(&before)?;
            }
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
    fn look(&self) -> Result<Evidence<D>, CalibrateError<D>> {
        let (best, least) = (&self.ranked[0].network, self.least_size(self.deviation));
        find_errors(&self.observations, best, self.deviation, least, self.options, self.monitor)
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
    pub(crate) fn observe(&self, faults: &[Fault<D>]) -> Observations<D> {
        Observations::new(&self.corrected(faults), |_, _| true).with_other_unknowns(linear(faults).count())
    }

    /// Sizes of errors beside a network: steps of least squares for the errors with the network,
    /// and the robust refinement of the network at these sizes, in turns.
    pub(crate) fn estimate(
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
    pub(crate) fn step(
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

    pub(crate) fn corrected(&self, faults: &[Fault<D>]) -> Pseudoranges {
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
