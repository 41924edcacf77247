//! What the report says about errors of single receivers, and how much certainty estimating them
//! costs.

use crate::calibrate::judge::neighbours::{Neighbour, Reason};
use crate::calibrate::options::ReceiverDelays;
use crate::calibrate::receivers::errors::{Fault, MovedPlace, ReceiverError, ReceiverErrorKind};
use crate::calibrate::receivers::take_out::columns;
use crate::calibrate::state::State;
use crate::degeneracy::list;
use crate::observations::Observations;
use crate::quantity::length;
use crate::refine::{Cancelled, Covariance, Motion, Projection, check, covariance, gram, sampled_covariance};
use faer::Mat;
use faer::prelude::Solve;

/// What a receiver has, in words after "has".
fn what_is_wrong(error: &ReceiverError, metre: f64) -> String {
    let size = metre * error.size;
    let from = error.from.as_deref().unwrap_or_default();
    match error.kind {
        ReceiverErrorKind::Delay => format!("a delay of {size:.3} m in all its measurements"),
        ReceiverErrorKind::Drift => {
            format!("a clock that drifts by {size:.3} m from the first transmitter to the last")
        }
        ReceiverErrorKind::Jump => format!("a clock that jumps by {size:.3} m at transmitter {from}"),
        ReceiverErrorKind::Move => format!("been moved by about {size:.3} m before transmitter {from}"),
    }
}

impl<const D: usize> State<'_, D> {
    /// The covariance of all nodes, with what the uncertainty of errors that were taken out adds, and
    /// how far errors that were left in may have moved them.
    pub(crate) fn covariance(&self, kept: &Observations<D>, sigma: f64) -> Result<Covariance<D>, Cancelled> {
        let monitor = self.monitor;
        let best = &self.ranked[0].network;
        let mut found = covariance(kept, best, sigma, monitor)?.unwrap_or_default();
        if found.receivers.is_empty() {
            return Ok(found);
        }
        if self.taken.is_empty() && self.left.is_empty() {
            return Ok(sampled_covariance(kept, best, sigma, self.options.seed, monitor)?.unwrap_or(found));
        }
        let Some(projection) = Projection::new(kept, best, monitor)? else { return Ok(found) };
        let taken = columns(kept, &projection, self.unknown_errors(), monitor)?;
        let Some(gram) = gram(&taken, monitor)? else { return Ok(Covariance::default()) };
        // With sizes of covariance C = sigma^2 (products of the columns)^-1 and motions M that
        // absorb them, M C M^T is added.
        let inverse = gram.solve(&Mat::<f64>::identity(taken.len(), taken.len()));
        let pairs = (0..taken.len()).flat_map(|a| (0..taken.len()).map(move |b| (a, b)));
        for (a, b) in pairs {
            check(monitor)?;
            found.add_product(sigma * sigma * inverse[(a, b)], &taken[a].1, &taken[b].1);
        }
        for fault in &self.left {
            if fault.kind == ReceiverErrorKind::Move {
                // Its place is somewhere between the two.
                let mut motion = Motion {
                    reduced: vec![0.0; kept.reduced()],
                    transmitters: vec![([0.0; D], 0.0); kept.transmitters],
                };
                motion.reduced[D * fault.receiver..D * (fault.receiver + 1)].copy_from_slice(&fault.size);
                found.add_product(1.0, &motion, &motion);
            } else {
                for (_, motion) in columns(kept, &projection, &[*fault], monitor)? {
                    found.add_product(fault.size[0].powi(2), &motion, &motion);
                }
            }
        }
        Ok(found)
    }

    pub(crate) fn receiver_errors(&self) -> Vec<ReceiverError> {
        let taken = self.taken.iter().map(|fault| self.receiver_error(fault, true));
        taken.chain(self.left.iter().map(|fault| self.receiver_error(fault, false))).collect()
    }

    pub(crate) fn receiver_error(&self, fault: &Fault<D>, taken_out: bool) -> ReceiverError {
        let later = matches!(fault.kind, ReceiverErrorKind::Jump | ReceiverErrorKind::Move);
        ReceiverError {
            receiver: self.measured.receiver_names()[fault.receiver].clone(),
            kind: fault.kind,
            from: later.then(|| self.measured.transmitter_names()[fault.from].clone()),
            place: (taken_out && fault.kind == ReceiverErrorKind::Move).then(|| self.place_of(fault)),
            size: fault.length(),
            gain: fault.gain,
            taken_out,
        }
    }

    /// What to do about a neighbour that the search has not ended in.
    pub(crate) fn doubt(&self, other: &Neighbour<D>) -> Option<String> {
        let apart = length(self.metre() * other.rms());
        let fault = match other.reason {
            Reason::Found => return None,
            Reason::Late { late, all } => {
                return Some(format!(
                    "{late} of {all} measurements that do not fit are late; if errors are late ones, by detours, the receivers lie {apart} \
                     elsewhere (see alternatives): use --errors one-sided"
                ));
            }
            Reason::Delays { .. } => {
                return Some(format!(
                    "all receivers may have delays of their own, which these measurements cannot tell for sure; without these the receivers \
                     lie {apart} elsewhere (see alternatives): use --receiver-clocks offset if their clocks were started apart, or measure more \
                     transmitters"
                ));
            }
            Reason::Error(fault) => fault,
        };
        let error = self.receiver_error(&fault, true);
        Some(format!(
            "receiver {} may have {}, which these measurements cannot tell for sure; without it the receivers lie {apart} elsewhere (see \
             alternatives); check that receiver, or measure more transmitters",
            error.receiver,
            what_is_wrong(&error, self.metre()),
        ))
    }

    /// Which place of a receiver that was moved is in the result: what it measured at the other one was
    /// left out.
    fn place_of(&self, fault: &Fault<D>) -> MovedPlace {
        let is_before = (0..fault.from).any(|j| self.measured.get(fault.receiver, j).is_some());
        if is_before { MovedPlace::Before } else { MovedPlace::After }
    }

    /// Warnings that name the receivers, what is wrong with them, by how much, and what to do.
    pub(crate) fn warn_of_receivers(&self, warnings: &mut Vec<String>) {
        let all = self.has_delays_of_all();
        let metre = self.metre();
        let delays = |f: &&Fault<D>| f.kind == ReceiverErrorKind::Delay;
        if self.left.iter().filter(delays).count() > 4 {
            let names: Vec<String> =
                self.left.iter().map(|f| self.measured.receiver_names()[f.receiver].clone()).collect();
            warnings.push(format!(
                "many receivers seem to have errors of their own ({}): are their clocks synchronised{}? \
                 --receiver-clocks offset estimates one for each recorder",
                list(&names),
                if D == 2 { ", and do all nodes lie in one plane" } else { "" }
            ));
            return;
        }
        if all {
            if self.options.receiver_delays == ReceiverDelays::Auto {
                warnings.push(
                    "all receivers seem to have delays of their own, which were estimated and taken out; --receiver-clocks offset says that they do"
                        .to_string(),
                );
            }
            return;
        }
        for error in self.receiver_errors() {
            let name = &error.receiver;
            let from = error.from.as_deref().unwrap_or_default();
            let what = what_is_wrong(&error, metre);
            let remedy = match (error.taken_out, error.kind) {
                (true, ReceiverErrorKind::Move) => {
                    let place = if error.place == Some(MovedPlace::After) { "after" } else { "before" };
                    format!(
                        "its position here is the one {place} the move, where more was measured; the rest was not used"
                    )
                }
                (true, _) => "it was taken out".to_string(),
                (false, ReceiverErrorKind::Move) => {
                    format!(
                        "its position here is between both; give it another name from {from} on, or use --receiver-delays auto"
                    )
                }
                (false, _) => "remove it from the measurements, or use --receiver-delays auto".to_string(),
            };
            warnings.push(format!("receiver {name} seems to have {what}; {remedy}"));
        }
    }
}
