//! Errors of whole receivers taken out: estimated beside the network, or left out with the
//! measurements that have them.

use faer::Mat;
use faer::prelude::Solve;
use hc::Monitor;

use super::deviation::{inlier_deviation, spread_of_residuals};
use super::finish::finish;
use super::options::{CalibrateError, CalibrateOptions, ReceiverDelays, check};
use super::receiver_errors::{Fault, ReceiverErrorKind, find};
use super::refits::refits;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{Motion, Projection, Refined};

/// Rounds of looking for further errors once those found are taken out.
const ROUNDS: usize = 6;

/// Steps of estimating the errors and refining the network in turns.
const STEPS: usize = 12;

/// Networks whose delays are estimated where all receivers have one.
const CANDIDATES: usize = 6;

/// What the measurements are and how they are refined.
pub(super) struct Clearing<'a> {
    /// The measurements as they are.
    pub(super) measured: &'a Pseudoranges,
    pub(super) known: Option<f64>,
    pub(super) floor: f64,
    pub(super) options: &'a CalibrateOptions,
    pub(super) monitor: &'a Monitor,
}

/// Networks for the measurements without the errors of receivers.
pub(super) struct Cleared {
    /// The measurements without the errors that were taken out.
    pub(super) measured: Pseudoranges,
    pub(super) observations: Observations,
    pub(super) ranked: Vec<Refined>,
    pub(super) deviation: f64,
    /// Errors that were taken out.
    pub(super) taken: Vec<Fault>,
    /// Errors that were found and left in.
    pub(super) left: Vec<Fault>,
}

impl Clearing<'_> {
    /// Looks for errors of receivers in the best of some networks and takes them out as the options
    /// say.
    pub(super) fn clear(&self, ranked: Vec<Refined>, deviation: f64) -> Result<Cleared, CalibrateError> {
        let observations = Observations::new(self.measured, |_, _| true);
        let mut now = Cleared {
            measured: self.measured.clone(),
            observations,
            ranked,
            deviation,
            taken: Vec::new(),
            left: Vec::new(),
        };
        match self.options.receiver_delays {
            ReceiverDelays::None => now.left = self.look(&now)?.0,
            ReceiverDelays::Auto => {
                for _ in 0..ROUNDS {
                    let (found, hidden) = self.look(&now)?;
                    let fresh = |f: &&Fault| !now.taken.iter().any(|t| t.receiver == f.receiver && t.kind == f.kind);
                    let fresh: Vec<Fault> = found.iter().filter(fresh).copied().collect();
                    if fresh.is_empty() {
                        now.left = found;
                        break;
                    }
                    now.taken.extend(fresh);
                    if let Some(network) = hidden {
                        let first = Refined { network, ..now.ranked[0].clone() };
                        now.ranked.insert(0, first);
                    }
                    now = self.without(now)?;
                }
            }
            ReceiverDelays::All => now = self.all(now)?,
        }
        Ok(now)
    }

    /// Errors that the best network shows, or the one that it hides if that tells more, with the
    /// network that does not.
    fn look(&self, now: &Cleared) -> Result<(Vec<Fault>, Option<Network>), CalibrateError> {
        let (observations, limit) = (&now.observations, self.options.inlier_threshold);
        let found = find(observations, &now.ranked[0].network, now.deviation, limit);
        // What a move leaves looks like other errors too.
        if found.first().is_some_and(|first| first.kind == ReceiverErrorKind::Move) {
            return Ok((found, None));
        }
        let hidden = refits(observations, &now.ranked[0].network, now.deviation, limit, self.monitor)?;
        let shown = found.first().map_or(0.0, |first| first.gain);
        Ok(match hidden.filter(|hidden| hidden.fault.gain > shown) {
            Some(hidden) => (vec![hidden.fault], Some(hidden.network)),
            None => (found, None),
        })
    }

    /// The networks again with the errors in `taken` estimated for the best of them.
    fn without(&self, mut now: Cleared) -> Result<Cleared, CalibrateError> {
        let best = now.ranked[0].clone();
        let (taken, _, _) = self.estimate(best, now.deviation, now.taken)?;
        now.taken = taken;
        now.measured = self.corrected(&now.taken);
        now.observations = Observations::new(&now.measured, |_, _| true).beside(linear(&now.taken).count());
        let first = self.known.unwrap_or(spread_of_residuals(&now.observations, &now.ranked[0].network));
        let (ranked, deviation) =
            finish(&now.observations, now.ranked, first, self.known.is_some(), self.floor, self.options, self.monitor)?;
        Ok(Cleared { ranked, deviation, ..now })
    }

    /// A delay for every receiver, for each of the best networks on its own; relative to their
    /// mean.
    fn all(&self, now: Cleared) -> Result<Cleared, CalibrateError> {
        let receivers = self.measured.receivers();
        let middle = middle_delays(self.measured);
        let delay = |receiver: usize, size: f64| Fault {
            receiver,
            kind: ReceiverErrorKind::Delay,
            from: 0,
            size: [size, 0.0],
            gain: 0.0,
        };
        // The mean of all delays cannot be told from the offsets.
        let unknown: Vec<Fault> = (1..receivers).map(|i| delay(i, middle[i] - middle[0])).collect();
        let unknowns = now.observations.unknowns() + unknown.len();
        if now.observations.len() < unknowns {
            return Err(CalibrateError::Delays { measurements: now.observations.len(), unknowns, receivers });
        }
        let mut all = Vec::new();
        for candidate in now.ranked.into_iter().take(CANDIDATES) {
            all.push(self.estimate(candidate, now.deviation, unknown.clone())?);
        }
        all.sort_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
        let (mut taken, _, deviation) = all[0].clone();
        let mean = taken.iter().map(|fault| fault.size[0]).sum::<f64>() / receivers as f64;
        taken.insert(0, delay(0, 0.0));
        for fault in &mut taken {
            fault.size[0] -= mean;
        }
        let measured = self.corrected(&taken);
        let observations = Observations::new(&measured, |_, _| true).beside(unknown.len());
        let mut ranked: Vec<Refined> = all.into_iter().map(|(_, refined, _)| refined).collect();
        for refined in &mut ranked {
            for offset in refined.network.offsets.iter_mut() {
                *offset += mean;
            }
        }
        Ok(Cleared {
            measured,
            observations,
            ranked: super::same::distinct(ranked, CANDIDATES),
            deviation,
            taken,
            left: Vec::new(),
        })
    }

    /// Sizes of errors beside a network: steps of least squares for the errors with the network,
    /// and the robust refinement of the network at these sizes, in turns.
    fn estimate(
        &self,
        mut best: Refined,
        mut deviation: f64,
        mut faults: Vec<Fault>,
    ) -> Result<(Vec<Fault>, Refined, f64), CalibrateError> {
        let count = linear(&faults).count();
        for step in 0..STEPS {
            check(self.monitor)?;
            let observations = Observations::new(&self.corrected(&faults), |_, _| true).beside(count);
            let wide = spread_of_residuals(&observations, &best.network).max(self.known.unwrap_or(self.floor));
            let first = if step == 0 { self.known.unwrap_or(wide) } else { self.known.unwrap_or(deviation.min(wide)) };
            let (mut ranked, next) = finish(
                &observations,
                vec![best.clone()],
                first,
                self.known.is_some(),
                self.floor,
                self.options,
                self.monitor,
            )?;
            (best, deviation) = (ranked.swap_remove(0), next);
            let wide = inlier_deviation(&observations, &best.network, wide, self.options.inlier_threshold);
            let Some(steps) = self.step(&observations, &best.network, wide, &faults) else { break };
            let mut largest = 0.0f64;
            for (fault, step) in linear_mut(&mut faults).zip(steps) {
                fault.size[0] += step;
                largest = largest.max(step.abs());
            }
            if largest < 1e-3 * deviation {
                break;
            }
        }
        Ok((faults, best, deviation))
    }

    /// The change of the sizes by least squares over the inliers, network and sizes together;
    /// `None` if it is not determined.
    fn step(&self, observations: &Observations, network: &Network, wide: f64, faults: &[Fault]) -> Option<Vec<f64>> {
        let kept = observations.subset(|o| o.residual(network).abs() <= self.options.inlier_threshold * wide);
        let projection = Projection::new(&kept, network)?;
        let residuals: Vec<f64> = kept.all().iter().map(|o| o.residual(network)).collect();
        let columns = columns(&kept, &projection, faults);
        let gram = gram(&columns)?;
        let right = Mat::from_fn(columns.len(), 1, |a, _| dot(&columns[a].0, &residuals));
        let solved = gram.solve(&right);
        let steps: Vec<f64> = (0..columns.len()).map(|a| solved[(a, 0)]).collect();
        steps.iter().all(|x| x.is_finite()).then_some(steps)
    }

    /// The measurements without these errors: the shorter part of a receiver that was moved is
    /// missing.
    fn corrected(&self, faults: &[Fault]) -> Pseudoranges {
        let (m, n) = (self.measured.receivers(), self.measured.transmitters());
        let mut values = self.measured.values().to_vec();
        debug_assert_eq!(values.len(), m * n);
        for fault in faults {
            let row = &mut values[fault.receiver * n..(fault.receiver + 1) * n];
            if fault.kind == ReceiverErrorKind::Move {
                let count = |part: &[f64]| part.iter().filter(|value| !value.is_nan()).count();
                let (before, after) = row.split_at_mut(fault.from);
                let shorter = if count(before) < count(after) { before } else { after };
                shorter.fill(f64::NAN);
            } else {
                for (j, value) in row.iter_mut().enumerate() {
                    *value -= fault.size[0] * fault.shape(j, n);
                }
            }
        }
        self.measured.with_values(values)
    }
}

/// A first guess of the delays of all receivers: a transmitter on the far side of one of two
/// receivers makes their difference as large as one on the far side of the other makes it small, so
/// that the middle of the differences is the delay between them. Zero in the mean.
fn middle_delays(measured: &Pseudoranges) -> Vec<f64> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let mut delays = vec![0.0; m];
    let mut between = vec![None; m * m];
    for a in 0..m {
        for b in a + 1..m {
            let common = (0..n).filter_map(|j| Some(measured.get(a, j)? - measured.get(b, j)?));
            let mut differences: Vec<f64> = common.collect();
            if differences.len() < 3 {
                continue;
            }
            differences.sort_by(f64::total_cmp);
            // Gross errors sit at the ends.
            let tenth = differences.len() / 10;
            let middle = 0.5 * (differences[tenth] + differences[differences.len() - 1 - tenth]);
            between[a * m + b] = Some(middle);
            between[b * m + a] = Some(-middle);
        }
    }
    // Least squares over all pairs, receiver by receiver.
    for _ in 0..50 {
        for a in 0..m {
            let pairs = (0..m).filter_map(|b| Some(between[a * m + b]? + delays[b]));
            let (sum, count) = pairs.fold((0.0, 0usize), |(sum, count), x| (sum + x, count + 1));
            if count > 0 {
                delays[a] = sum / count as f64;
            }
        }
        let mean = delays.iter().sum::<f64>() / m as f64;
        for delay in delays.iter_mut() {
            *delay -= mean;
        }
    }
    delays
}

/// The measurements without these guesses.
pub(super) fn without_middle_delays(measured: &Pseudoranges) -> Pseudoranges {
    let (delays, n) = (middle_delays(measured), measured.transmitters());
    let values = measured.values().iter().enumerate().map(|(k, value)| value - delays[k / n]).collect();
    measured.with_values(values)
}

/// Errors that are unknowns beside the network; of a move measurements are left out instead.
fn linear(faults: &[Fault]) -> impl Iterator<Item = &Fault> {
    faults.iter().filter(|fault| fault.kind != ReceiverErrorKind::Move)
}

fn linear_mut(faults: &mut [Fault]) -> impl Iterator<Item = &mut Fault> {
    faults.iter_mut().filter(|fault| fault.kind != ReceiverErrorKind::Move)
}

/// What errors of size 1 add to the residuals, less what motions of the nodes make of it, with
/// those motions.
pub(super) fn columns(kept: &Observations, projection: &Projection<'_>, faults: &[Fault]) -> Vec<(Vec<f64>, Motion)> {
    let n = kept.transmitters;
    let column = |fault: &Fault| -> Vec<f64> {
        let part = |o: &crate::observations::Observation| {
            if o.receiver == fault.receiver { o.precision * fault.shape(o.transmitter, n) } else { 0.0 }
        };
        kept.all().iter().map(part).collect()
    };
    linear(faults).map(|fault| projection.off(&column(fault))).collect()
}

/// Products of the columns; `None` where two of them, or one and the network, cannot be told apart.
pub(super) fn gram(columns: &[(Vec<f64>, Motion)]) -> Option<faer::linalg::solvers::Llt<f64>> {
    let size = columns.len();
    let products = Mat::from_fn(size, size, |a, b| dot(&columns[a].0, &columns[b].0));
    products.llt(faer::Side::Lower).ok()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
