//! The state of one path with quick steps and all decisions about it.

use super::options::TrackerOptions;
use super::result::{PathEnd, PathResult};
use crate::tolerances::{QUICK, TRACKING};

/// One path on its way.
#[derive(Clone, Debug)]
pub(super) struct Attempts {
    /// `None` in a lane without a path.
    pub(super) path: Option<usize>,
    /// Whether the start solution has still to be checked and the first derivatives taken.
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
    accepted: usize,
    rejected: usize,
}

impl Attempts {
    /// A path that begins, or none.
    pub(super) fn of(path: Option<usize>) -> Self {
        Attempts {
            path,
            fresh: true,
            t: 1.0,
            step: 0.0,
            t_next: 1.0,
            radius: 0.0,
            omega: TRACKING.initial_omega,
            error: f64::NAN,
            last: 0.0,
            accepted: 0,
            rejected: 0,
        }
    }

    /// Whether the attempt with corrections of these sizes is accepted; a size that is not a number is not.
    pub(super) fn judge(&mut self, [first, second, third]: [f64; 3]) -> bool {
        if self.fresh {
            return first < QUICK.start;
        }
        let small = first < QUICK.small && second < QUICK.small;
        let contracts = first < QUICK.first && second < QUICK.contraction * first;
        // An end has to be accurate, a point on the way only on its path.
        let arrives = self.t_next == 0.0;
        let settles = third < if arrives { QUICK.third } else { (QUICK.contraction * second).max(QUICK.third) };
        if !(small || contracts && settles) {
            return false;
        }
        let telling = first >= QUICK.telling[0] && second >= QUICK.telling[1];
        let seen = if telling { 2.0 * second / (first * first) } else { 0.0 };
        self.omega = seen.max(0.5 * self.omega).max(TRACKING.least_omega);
        // Never zero, so that one lucky step does not free the next from the bound.
        self.error = first.max(f64::EPSILON) / (self.step * self.step * self.step * self.step);
        true
    }

    /// Takes the accepted step, after which the radius of trust is as given, and chooses the next one.
    pub(super) fn advance(&mut self, radius: f64, options: &TrackerOptions) {
        self.radius = radius;
        self.t = self.t_next;
        let error = if self.fresh { radius.powi(-4) } else { self.error };
        let newton = (QUICK.aim / (self.omega.max(QUICK.least_omega) * error)).sqrt().sqrt();
        let mut trust = options.beta_tau * radius;
        if self.t < trust {
            trust = options.beta_tau_last * radius;
        }
        let step = newton.min(trust);
        self.choose(if self.fresh { step } else { step.min(QUICK.growth * self.step) });
        self.accepted += usize::from(!self.fresh);
        self.fresh = false;
    }

    /// Shortens the step after a rejection.
    pub(super) fn retreat(&mut self) {
        self.rejected += 1;
        self.choose(QUICK.cut * self.step);
    }

    fn choose(&mut self, step: f64) {
        let last = step >= self.t;
        self.step = if last { self.t } else { step };
        self.t_next = if last { 0.0 } else { self.t - step };
    }

    /// The record of a path with this number at its end.
    pub(super) fn arrived(&self, path: usize, pivot: f64) -> PathResult {
        PathResult {
            path,
            end: PathEnd::Success,
            t: 0.0,
            accuracy: self.last.max(f64::EPSILON),
            omega: self.omega,
            pivot,
            accepted: self.accepted,
            rejected: self.rejected,
            // At the start solution, at each predicted and at each accepted point.
            jacobians: 2 + 2 * self.accepted + self.rejected,
            extended: false,
        }
    }

    /// Whether the path is better left to the careful tracker.
    pub(super) fn is_difficult(&self, options: &TrackerOptions) -> bool {
        let moves = self.t_next < self.t && self.step > 4.0 * f64::EPSILON * self.t;
        self.accepted + self.rejected >= options.max_steps.min(QUICK.attempts) || !moves
    }
}
