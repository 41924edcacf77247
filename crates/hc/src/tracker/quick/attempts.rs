//! The state of one path with quick steps and all decisions about it.

use super::super::options::TrackerOptions;
use super::super::result::{PathEnd, PathResult};
use super::super::resume::{Counts, ResumePoint};
use crate::tolerances::{QuickTolerances, quick_ends, tracking};

/// What becomes of an attempt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    Accepted,
    Rejected,
    /// The point where the path goes on is not yet on it; the corrected one is nearer.
    Nearer,
}

/// One path on its way.
#[derive(Clone, Debug, Default)]
pub(super) struct QuickPath {
    /// `None` in a lane without a path.
    pub(super) path: Option<usize>,
    /// Whether the first point has still to be checked and the first derivatives taken.
    pub(super) fresh: bool,
    pub(super) t: f64,
    step: f64,
    pub(super) t_next: f64,
    pub(super) radius: f64,
    /// Lipschitz constant of Newton's method.
    pub(super) omega: f64,
    /// `|predicted - corrected| / step^4` of the last accepted step.
    error: f64,
    /// Size of the last correction at the end.
    pub(super) last: f64,
    /// Attempts since the path goes on.
    attempts: usize,
    /// Rejections in a row.
    rejections: usize,
    /// Corrections of the first point.
    approaches: usize,
    counts: Counts,
}

impl QuickPath {
    /// A lane without a path.
    pub(super) fn idle() -> Self {
        let omega = tracking::INITIAL_OMEGA;
        QuickPath { fresh: true, t: 1.0, t_next: 1.0, omega, error: f64::NAN, ..QuickPath::default() }
    }

    /// A path that goes on.
    pub(super) fn from(stop: &ResumePoint) -> Self {
        QuickPath { path: Some(stop.path), t: stop.t, t_next: stop.t, counts: stop.counts, ..QuickPath::idle() }
    }

    /// Decides about the attempt with corrections of these sizes; a size that is not a number is not small.
    pub(super) fn judge(&mut self, [first, second, third]: [f64; 3], quick: &QuickTolerances) -> Verdict {
        self.attempts += 1;
        self.counts.jacobians += 1;
        if self.fresh && self.t == 1.0 {
            return if first < quick.start { Verdict::Accepted } else { Verdict::Rejected };
        }
        let small = first < quick.small && second < quick.small;
        let contracts = first < quick.first && second < quick.contraction * first;
        // An end has to be accurate, a point on the way only on its path.
        let arrives = self.t_next == 0.0;
        let settles = third < if arrives { quick.third } else { (quick.contraction * second).max(quick.third) };
        if !(small || contracts && settles) {
            let nearer = first < quick_ends::APPROACH && second < quick_ends::APPROACH_CONTRACTION * first;
            if self.fresh && nearer && self.approaches < quick_ends::APPROACHES {
                self.approaches += 1;
                return Verdict::Nearer;
            }
            return Verdict::Rejected;
        }
        if self.fresh {
            return Verdict::Accepted;
        }
        let telling = first >= quick.telling[0] && second >= quick.telling[1];
        let seen = if telling { 2.0 * second / (first * first) } else { 0.0 };
        self.omega = seen.max(0.5 * self.omega).max(tracking::LEAST_OMEGA);
        // Never zero, so that one lucky step does not free the next from the bound.
        self.error = first.max(quick.epsilon) / (self.step * self.step * self.step * self.step);
        Verdict::Accepted
    }

    /// Takes the accepted step, after which the radius of trust is as given, and chooses the next one.
    pub(super) fn advance(&mut self, radius: f64, options: &TrackerOptions, quick: &QuickTolerances) {
        self.radius = radius;
        self.t = self.t_next;
        let error = if self.fresh { radius.powi(-4) } else { self.error };
        let newton = (quick.aim / (self.omega.max(quick.least_omega) * error)).sqrt().sqrt();
        let mut trust = options.beta_tau * radius;
        if self.t < trust {
            trust = options.beta_tau_last * radius;
        }
        let step = newton.min(trust);
        self.choose(if self.fresh { step } else { step.min(quick.growth * self.step) });
        self.counts.accepted += usize::from(!self.fresh);
        self.counts.jacobians += 1;
        self.rejections = 0;
        self.fresh = false;
    }

    /// Shortens the step after a rejection.
    pub(super) fn retreat(&mut self, quick: &QuickTolerances) {
        self.counts.rejected += 1;
        self.rejections += 1;
        self.choose(quick.cut * self.step);
    }

    fn choose(&mut self, step: f64) {
        let last = step >= self.t;
        self.step = if last { self.t } else { step };
        self.t_next = if last { 0.0 } else { self.t - step };
    }

    /// Whether the path has come to its end.
    pub(super) fn has_arrived(&self) -> bool {
        self.t == 0.0 && !self.fresh
    }

    /// Whether the point where the path was to go on does not lie near it.
    pub(super) fn strayed(&self) -> bool {
        self.fresh && self.t < 1.0
    }

    /// Whether the path is better left to others.
    pub(super) fn is_difficult(&self, options: &TrackerOptions, quick: &QuickTolerances) -> bool {
        if self.fresh {
            return self.rejections > 0;
        }
        let long = self.attempts >= options.max_steps.min(quick.attempts) || self.rejections >= quick.patience;
        let moves = self.t_next < self.t && self.step > 4.0 * f64::EPSILON * self.t;
        long || !moves || self.t < quick.least_t
    }

    /// Where others go on, in the point just reached; its number is not known here.
    pub(super) fn stop(&self) -> ResumePoint {
        ResumePoint { path: self.path.unwrap_or_default(), t: self.t, point: 0, counts: self.counts }
    }

    /// The record of the path at its end.
    pub(super) fn arrived(&self, pivot: f64) -> PathResult {
        PathResult {
            path: self.path.unwrap_or_default(),
            end: PathEnd::Success,
            t: 0.0,
            accuracy: self.last.max(f64::EPSILON),
            omega: self.omega,
            pivot,
            accepted: self.counts.accepted,
            rejected: self.counts.rejected,
            jacobians: self.counts.jacobians,
            extended: false,
        }
    }
}
