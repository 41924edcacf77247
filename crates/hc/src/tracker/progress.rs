//! The state of one path and all decisions about it: convergence, precision, step size, divergence.
//!
//! Nothing here depends on other paths, so that a path takes the same steps alone and among seven
//! others.

use super::options::TrackerOptions;
use super::result::{PathEnd, PathResult};
use super::stop::{Counts, Stop};
use crate::tolerances::TRACKING;

/// `h(a) = 2a (sqrt(4a^2 + 1) - 2a)` (Timme 2020, lemma 4.2).
fn h(a: f64) -> f64 {
    2.0 * a * ((4.0 * a * a + 1.0).sqrt() - 2.0 * a)
}

/// How far the step of a path has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StepState {
    /// No path in this lane.
    Idle,
    /// More iterations are needed.
    Iterating,
    /// Quadratic convergence was seen; the closing correction comes next.
    Converged,
    /// The step is too long; `theta` is the contraction seen, infinite where none was.
    Rejected { theta: f64 },
    /// The path has come to an end for this reason.
    Failed(PathEnd),
    /// The step is to be tried again with residuals in double-double.
    Retry,
    /// The step was accepted.
    Accepted,
}

/// Constants derived from the options once.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    pub(crate) options: TrackerOptions,
    h: f64,
    /// `sqrt(1 + 2 h) - 1`
    reach: f64,
    h_half: f64,
    reach_half: f64,
    /// `omega mu` above which double precision is left.
    leave_double: f64,
    /// `omega mu` (of double precision, `omega` at least 1) below which it is taken up again.
    enter_double: f64,
    /// `omega mu` above which even extended precision ends.
    limit: f64,
    /// Square of the option.
    pub(crate) least_share_sqr: f64,
}

impl Bounds {
    pub(crate) fn new(options: &TrackerOptions) -> Self {
        let a = options.contraction;
        let (h_a, h_half) = (h(a), h(0.5 * a));
        Bounds {
            h: h_a,
            reach: (1.0 + 2.0 * h_a).sqrt() - 1.0,
            h_half,
            reach_half: (1.0 + 2.0 * h_half).sqrt() - 1.0,
            leave_double: a.powi(5) * h_a,
            enter_double: a.powi(7) * h_a,
            limit: a.powi(3) * h_a,
            least_share_sqr: options.least_share * options.least_share,
            options: options.clone(),
        }
    }
}

/// One path on its way.
#[derive(Clone, Debug)]
pub(crate) struct PathProgress {
    pub(crate) path: usize,
    pub(crate) state: StepState,
    /// Whether the start point has still to be checked and the first derivatives taken.
    pub(crate) fresh: bool,
    pub(crate) t: f64,
    pub(crate) t_next: f64,
    /// The number of pieces of the path, and how many lie ahead when this one is done.
    pieces: usize,
    ahead: usize,
    /// Whether logarithms of its coordinates are predicted.
    pub(super) exponential: bool,
    pub(crate) radius: f64,
    pub(crate) extended: bool,
    /// Whether the point is kept in double-double too: another path is so near that doubles hardly
    /// tell them apart.
    pub(crate) wide: bool,
    /// Whether the point of the last accepted step was kept in double-double.
    pub(crate) kept: bool,
    step: f64,
    /// Rejections since the last accepted step.
    failed_before: usize,
    /// `|predicted - corrected| / step^4` of the last accepted step.
    local_error: f64,
    omega: f64,
    omega_before: f64,
    mu: f64,
    /// Size of corrections that are rounding error alone, as far as seen.
    noise: f64,
    /// The work before the path went on here.
    before: Counts,
    accepted: usize,
    rejected: usize,
    pub(crate) jacobians: usize,
    used_extended: bool,
    /// The `t` from which on the valuations say that the path diverges.
    diverges_since: Option<f64>,
    first: f64,
    last: f64,
    omega_now: f64,
    theta_bound: f64,
    /// Newton iterations of this step.
    iterations: usize,
    /// Whether the closing correction after the first iteration said that more are needed.
    resumed: bool,
}

impl PathProgress {
    pub(crate) fn idle() -> Self {
        PathProgress {
            path: usize::MAX,
            state: StepState::Idle,
            fresh: false,
            t: 1.0,
            t_next: 1.0,
            pieces: 1,
            ahead: 0,
            exponential: false,
            radius: 0.0,
            extended: false,
            wide: false,
            kept: false,
            step: 0.0,
            failed_before: 0,
            local_error: f64::NAN,
            omega: TRACKING.initial_omega,
            omega_before: TRACKING.initial_omega,
            mu: f64::EPSILON,
            noise: f64::EPSILON,
            before: Counts::default(),
            accepted: 0,
            rejected: 0,
            jacobians: 0,
            used_extended: false,
            diverges_since: None,
            first: 0.0,
            last: 0.0,
            omega_now: TRACKING.initial_omega,
            theta_bound: 0.0,
            iterations: 0,
            resumed: false,
        }
    }

    /// A path in so many pieces that goes on.
    pub(super) fn from(stop: &Stop, pieces: usize) -> Self {
        let Stop { path, t, counts, .. } = *stop;
        let (pieces, state) = (pieces.max(1), StepState::Accepted);
        let ahead = ((t * pieces as f64).ceil() as usize).saturating_sub(1);
        PathProgress { path, t, t_next: t, pieces, ahead, before: counts, state, fresh: true, ..Self::idle() }
    }

    /// The `t` at which this piece of the path ends.
    fn stop(&self) -> f64 {
        self.ahead as f64 / self.pieces as f64
    }

    /// Whether the path has come to the end of a piece, not the last; if so, the next piece begins.
    pub(super) fn begins_piece(&mut self) -> bool {
        let begins = self.ahead > 0 && self.t == self.stop();
        self.ahead -= usize::from(begins);
        begins
    }

    pub(crate) fn is_live(&self) -> bool {
        self.state != StepState::Idle
    }

    fn widen(&mut self) {
        self.wide = true;
        self.noise = self.rounding();
    }

    /// Goes back to double precision and its rounding errors: corrections of size `double` have just been
    /// seen to be nothing else.
    fn narrow(&mut self, double: f64) {
        (self.extended, self.wide, self.kept) = (false, false, false);
        self.noise = self.noise.max(double).max(self.rounding());
    }

    /// Relative size below which a correction is less than the rounding error of the point.
    fn rounding(&self) -> f64 {
        if self.wide { f64::EPSILON * f64::EPSILON } else { f64::EPSILON }
    }

    /// Lipschitz constant of Newton's method, as last estimated.
    pub(crate) fn omega(&self) -> f64 {
        self.omega
    }

    /// Signed step in `t` that the predictor has to make.
    pub(crate) fn signed_step(&self) -> f64 {
        self.t_next - self.t
    }

    /// Chooses the next step from the radius of trust and the Newton bound (reference: Timme 2020,
    /// section 5).
    pub(crate) fn choose_step(&mut self, bounds: &Bounds) {
        if self.fresh || self.state == StepState::Retry {
            return;
        }
        if let StepState::Rejected { .. } = self.state {
            self.t_next = self.t - self.step; // shortened when it was rejected
            return;
        }
        let o = &bounds.options;
        let error = if self.local_error.is_finite() { self.local_error } else { self.radius.powi(-4) };
        let omega = (self.omega + 2.0 * (self.omega - self.omega_before)).clamp(self.omega, 8.0 * self.omega);
        let newton = (bounds.reach / (omega * error)).sqrt().sqrt() / o.beta_omega;
        let stop = self.stop();
        let mut trust = o.beta_tau * self.radius;
        if self.t - stop < trust {
            trust = o.beta_tau_last * self.radius;
        }
        let mut step = newton.min(trust); // ignores NaN
        if self.step > 0.0 {
            step = step.min(10.0 * self.step);
            if self.failed_before > 0 {
                step = step.min(self.step);
            }
        }
        if step >= self.t - stop || step.is_nan() {
            self.step = self.t - stop;
            self.t_next = stop;
        } else {
            self.step = step;
            self.t_next = self.t - step;
        }
    }

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
        } else if norm > TRACKING.noise_margin * self.noise {
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
        if self.omega_now.max(TRACKING.least_omega) * norm <= bounds.options.corrector_tolerance {
            self.state = StepState::Converged;
        } else if i + 1 >= TRACKING.iterations {
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
            self.omega_now.max(1.0) * norm > 0.01 * bounds.leave_double && norm > TRACKING.noise_margin * self.noise;
        if matters && norm > TRACKING.unfinished * self.last && self.iterations + 1 < TRACKING.iterations {
            self.resume(norm, bounds);
            return;
        }
        if self.omega_now == self.omega && self.first == self.last {
            // One iteration only: the closing correction tells omega, unless it is rounding error.
            self.omega_now = if norm > TRACKING.noise_margin * self.noise {
                (2.0 * norm / (self.first * self.first)).min(self.omega)
            } else {
                0.5 * self.omega
            };
        }
        let mut omega = self.omega_now.max(0.5 * self.omega).max(TRACKING.least_omega);
        if norm <= omega * self.last * self.last {
            self.noise = self.noise.min(norm).max(self.rounding());
        } else if norm <= TRACKING.most_noise {
            // More than quadratic convergence leaves is rounding error, if it is small enough for
            // that.
            self.noise = norm.max(self.rounding());
        } else {
            // Newton's method converges more slowly than was estimated. With a point in double-double the
            // cause is not the rounding of the point: Newton's method has not converged yet.
            omega = norm / (self.last * self.last);
            let unfinished = norm > TRACKING.unfinished * self.last || omega * norm > bounds.leave_double;
            if self.wide && unfinished && self.iterations + 1 < TRACKING.iterations {
                self.resume(norm, bounds);
                return;
            }
        }
        let noise = omega * norm;
        if noise > bounds.leave_double && !self.extended && bounds.options.extended_precision {
            self.extended = true;
            self.used_extended = true;
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

    /// Takes the accepted step; `distance` is that of the corrected from the predicted point.
    pub(crate) fn advance(&mut self, distance: f64, radius: f64) {
        if self.fresh {
            self.fresh = false;
        } else {
            self.accepted += 1;
            let step = self.t - self.t_next;
            // Never zero, so that one lucky step does not free the next from the Newton bound.
            self.local_error = distance.max(f64::EPSILON) / (step * step * step * step);
            self.t = self.t_next;
        }
        self.failed_before = 0;
        self.radius = radius;
    }

    /// Shortens the step after a rejection, or ends the path.
    pub(crate) fn retreat(&mut self, bounds: &Bounds) -> Option<PathEnd> {
        let theta = match self.state {
            StepState::Rejected { theta } => theta,
            StepState::Failed(end) => return Some(end),
            _ => return None,
        };
        if self.fresh {
            if !self.extended && bounds.options.extended_precision {
                // A solution near a singularity may fail the test for rounding errors alone.
                self.extended = true;
                self.used_extended = true;
                return None;
            }
            return Some(PathEnd::InvalidStart);
        }
        self.rejected += 1;
        self.failed_before += 1;
        let h_theta = if theta.is_finite() { h(theta) } else { 0.0 };
        let factor = if h_theta < bounds.h_half {
            TRACKING.hard_cut
        } else {
            (bounds.reach_half / ((1.0 + 2.0 * h_theta).sqrt() - 1.0)).sqrt().sqrt().max(TRACKING.hard_cut)
        };
        self.step *= factor;
        if self.failed_before >= TRACKING.resistant && !self.extended && bounds.options.extended_precision {
            self.extended = true;
            self.used_extended = true;
        }
        if self.t - self.step == self.t || self.step < 4.0 * f64::EPSILON * self.t {
            if !self.extended && bounds.options.extended_precision {
                // Rounding errors alone may have made the corrector fail: try once more from a
                // workable step.
                self.extended = true;
                self.used_extended = true;
                self.step = 1e-3 * self.radius.min(self.t - self.stop());
                return None;
            }
            if !self.wide && bounds.options.extended_precision {
                // And once more, because rounding errors of the point may have made the predictor
                // fail.
                self.widen();
                self.step = 1e-3 * self.radius.min(self.t - self.stop());
                return None;
            }
            return Some(PathEnd::StepTooSmall);
        }
        None
    }

    /// The end of the path, if it has come to one.
    pub(crate) fn finished(&self, bounds: &Bounds) -> Option<PathEnd> {
        if self.fresh {
            return None;
        }
        if self.t == 0.0 {
            return Some(PathEnd::Success);
        }
        if self.diverges_since.is_some() && self.t < 1e-10 {
            return Some(PathEnd::AtInfinity);
        }
        if self.t < bounds.options.min_t {
            return Some(PathEnd::Singular);
        }
        let most = bounds.options.max_steps.saturating_mul(self.pieces);
        (self.accepted + self.rejected >= most).then_some(PathEnd::MaxSteps)
    }

    /// Watches the valuations: `settled` says that some are negative and constant at the current
    /// point.
    pub(crate) fn watch(&mut self, settled: bool) {
        self.diverges_since = if settled { self.diverges_since.or(Some(self.t)) } else { None };
    }

    /// The record of the path; a path that breaks off while it has long been diverging ends at
    /// infinity.
    pub(crate) fn result(&self, end: PathEnd, pivot: f64) -> PathResult {
        let long = self.diverges_since.is_some_and(|since| self.t < 1e-3 * since);
        let end = match end {
            PathEnd::AccuracyLimit | PathEnd::StepTooSmall | PathEnd::MaxSteps | PathEnd::Singular if long => {
                PathEnd::AtInfinity
            }
            other => other,
        };
        PathResult {
            path: self.path,
            end,
            t: self.t,
            // The point is given in double precision.
            accuracy: self.mu.max(f64::EPSILON),
            omega: self.omega,
            pivot,
            accepted: self.before.accepted + self.accepted,
            rejected: self.before.rejected + self.rejected,
            jacobians: self.before.jacobians + self.jacobians,
            extended: self.used_extended,
        }
    }
}

#[cfg(test)]
#[path = "progress_tests.rs"]
mod tests;
