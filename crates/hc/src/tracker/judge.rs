//! What the corrections of Newton's method say of a step: convergence, and the precision that it takes.

use super::progress::{Bounds, PathProgress, StepState};
use super::result::PathEnd;
use crate::tolerances::tracking;

impl PathProgress {
    pub(crate) fn begin_correction(&mut self, bounds: &Bounds) {
        if self.is_live() {
            self.state = StepState::Iterating;
            self.theta_bound = bounds.options.contraction;
            self.omega_now = self.omega;
            self.iterations = 0;
            self.resumed = false;
        }
    }

    /// Judges the correction of size `norm`.
    pub(crate) fn judge(&mut self, norm: f64, bounds: &Bounds) {
        if self.state != StepState::Iterating {
            return;
        }
        let i = self.iterations;
        self.iterations += 1;
        self.jacobians += 1;
        if !norm.is_finite() {
            self.state = StepState::Rejected { theta: f64::INFINITY };
            return;
        }
        if i == 0 {
            self.first = norm;
            // Predicted not to be an approximate zero (the Newton-Kantorovich bound with a margin
            // of 4).
            if !self.fresh && 0.125 * self.omega * norm > bounds.h {
                self.last = norm;
                self.state = StepState::Rejected { theta: f64::INFINITY };
                return;
            }
        } else if norm > tracking::NOISE_MARGIN * self.noise {
            let theta = norm / self.last;
            if i == 1 && !self.resumed {
                self.omega_now = 2.0 * norm / (self.last * self.last);
            }
            if theta > self.theta_bound {
                self.state = StepState::Rejected { theta: if i == 1 { theta } else { f64::INFINITY } };
                return;
            }
            self.theta_bound *= self.theta_bound;
        } else {
            // Rounding error: it says nothing about contraction, and no correction will be smaller.
            self.omega_now = if i == 1 { 0.5 * self.omega } else { self.omega_now };
            self.last = norm;
            self.state = StepState::Converged;
            return;
        }
        self.last = norm;
        if self.omega_now.max(tracking::LEAST_OMEGA) * norm <= bounds.options.corrector_tolerance {
            self.state = StepState::Converged;
        } else if i + 1 >= tracking::ITERATIONS {
            self.state = StepState::Rejected { theta: f64::INFINITY };
        }
    }

    /// Judges the closing correction with the last Jacobian, of size `norm` (an upper bound for the
    /// limiting accuracy `mu`); `double` is the size that residuals in double precision give at the
    /// same point, for paths in extended precision.
    pub(crate) fn judge_closing(&mut self, norm: f64, double: Option<f64>, bounds: &Bounds) {
        if self.state != StepState::Converged {
            return;
        }
        if !norm.is_finite() {
            self.state = StepState::Rejected { theta: f64::INFINITY };
            return;
        }
        let matters =
            self.omega_now.max(1.0) * norm > 0.01 * bounds.leave_double && norm > tracking::NOISE_MARGIN * self.noise;
        if matters && norm > tracking::UNFINISHED * self.last && self.iterations + 1 < tracking::ITERATIONS {
            self.resume(norm, bounds);
            return;
        }
        if self.omega_now == self.omega && self.first == self.last {
            // One iteration only: the closing correction tells omega, unless it is rounding error.
            self.omega_now = if norm > tracking::NOISE_MARGIN * self.noise {
                (2.0 * norm / (self.first * self.first)).min(self.omega)
            } else {
                0.5 * self.omega
            };
        }
        let mut omega = self.omega_now.max(0.5 * self.omega).max(tracking::LEAST_OMEGA);
        if norm <= omega * self.last * self.last {
            self.noise = self.noise.min(norm).max(self.rounding());
        } else if norm <= tracking::MOST_NOISE {
            // More than quadratic convergence leaves is rounding error, if it is small enough for
            // that.
            self.noise = norm.max(self.rounding());
        } else {
            // Newton's method converges more slowly than was estimated. With a point in double-double the
            // cause is not the rounding of the point: Newton's method has not converged yet.
            omega = norm / (self.last * self.last);
            let unfinished = norm > tracking::UNFINISHED * self.last || omega * norm > bounds.leave_double;
            if self.wide && unfinished && self.iterations + 1 < tracking::ITERATIONS {
                self.resume(norm, bounds);
                return;
            }
        }
        let noise = omega * norm;
        if noise > bounds.leave_double && self.extend(bounds) {
            self.state = StepState::Retry;
            return;
        }
        if noise > bounds.limit {
            self.state = if self.wide || !self.extended {
                StepState::Failed(PathEnd::AccuracyLimit)
            } else {
                self.widen();
                StepState::Retry
            };
            return;
        }
        if let Some(double) = double
            && omega.max(1.0) * double < bounds.enter_double
        {
            self.narrow(double);
        }
        self.omega_before = self.omega;
        self.omega = omega;
        self.mu = norm.max(self.rounding());
        self.state = StepState::Accepted;
    }

    /// Goes on with Newton's method after a closing correction of size `norm`.
    fn resume(&mut self, norm: f64, bounds: &Bounds) {
        if self.iterations == 1 {
            // The next correction tells nothing of omega: it follows one with an old Jacobian.
            self.omega_now = 2.0 * norm / (self.last * self.last);
            self.resumed = true;
        }
        self.last = norm;
        self.theta_bound = bounds.options.contraction;
        self.state = StepState::Iterating;
    }
}
