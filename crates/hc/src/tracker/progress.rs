//! The state of one path and the decisions about its steps: size, precision, divergence.
//!
//! Nothing here depends on other paths, so that a path takes the same steps alone and among seven
//! others.

use super::options::TrackerOptions;
use super::result::{PathEnd, PathResult};
use super::resume::{Counts, ResumePoint};
use crate::tolerances::tracking;

/// `h(a) = 2a (sqrt(4a^2 + 1) - 2a)` (Timme 2020, lemma 4.2).
fn h(a: f64) -> f64 {
    2.0 * a * ((4.0 * a * a + 1.0).sqrt() - 2.0 * a)
}

/// How far the step of a path has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum StepState {
    /// No path in this lane.
    #[default]
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
    pub(super) h: f64,
    /// `sqrt(1 + 2 h) - 1`
    pub(super) reach: f64,
    pub(super) h_half: f64,
    pub(super) reach_half: f64,
    /// `omega mu` above which double precision is left.
    pub(super) leave_double: f64,
    /// `omega mu` (of double precision, `omega` at least 1) below which it is taken up again.
    pub(super) enter_double: f64,
    /// `omega mu` above which even extended precision ends.
    pub(super) limit: f64,
    /// Square of the option.
    pub(crate) least_share_sqr: f64,
}

/// The lanes of which this holds, as bits.
pub(super) fn mask(lanes: &[PathProgress], holds: impl Fn(&PathProgress) -> bool) -> u16 {
    lanes.iter().enumerate().fold(0, |mask, (l, lane)| mask | u16::from(holds(lane)) << l)
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
#[derive(Clone, Debug, Default)]
pub(crate) struct PathProgress {
    pub(crate) path: usize,
    pub(crate) state: StepState,
    /// Whether the start point has still to be checked and the first derivatives taken.
    pub(crate) fresh: bool,
    pub(crate) t: f64,
    pub(crate) t_next: f64,
    /// The number of pieces of the path, and how many lie ahead when this one is done.
    pub(super) pieces: usize,
    pub(super) ahead: usize,
    /// Whether logarithms of its coordinates are predicted.
    pub(super) exponential: bool,
    pub(crate) radius: f64,
    pub(crate) extended: bool,
    /// Whether the point is kept in double-double too: another path is so near that doubles hardly
    /// tell them apart.
    pub(crate) wide: bool,
    /// Whether the point of the last accepted step was kept in double-double.
    pub(crate) kept: bool,
    pub(super) step: f64,
    /// Rejections since the last accepted step.
    pub(super) failed_before: usize,
    /// `|predicted - corrected| / step^4` of the last accepted step.
    pub(super) local_error: f64,
    /// Lipschitz constant of Newton's method, as last estimated.
    pub(super) omega: f64,
    pub(super) omega_before: f64,
    pub(super) mu: f64,
    /// Size of corrections that are rounding error alone, as far as seen.
    pub(super) noise: f64,
    /// The work before the path went on here.
    pub(super) before: Counts,
    pub(super) accepted: usize,
    pub(super) rejected: usize,
    pub(crate) jacobians: usize,
    pub(super) used_extended: bool,
    /// The `t` from which on the valuations say that the path diverges.
    pub(super) diverges_since: Option<f64>,
    pub(super) first: f64,
    pub(super) last: f64,
    pub(super) omega_now: f64,
    pub(super) theta_bound: f64,
    /// Newton iterations of this step.
    pub(super) iterations: usize,
    /// Whether the closing correction after the first iteration said that more are needed.
    pub(super) resumed: bool,
}

impl PathProgress {
    /// A lane without a path.
    pub(crate) fn idle() -> Self {
        PathProgress {
            path: usize::MAX,
            t: 1.0,
            t_next: 1.0,
            pieces: 1,
            local_error: f64::NAN,
            omega: tracking::INITIAL_OMEGA,
            omega_before: tracking::INITIAL_OMEGA,
            mu: f64::EPSILON,
            noise: f64::EPSILON,
            omega_now: tracking::INITIAL_OMEGA,
            ..PathProgress::default()
        }
    }

    /// A path in so many pieces that goes on.
    pub(super) fn from(point: &ResumePoint, pieces: usize) -> Self {
        let ResumePoint { path, t, counts, .. } = *point;
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

    /// Turns to residuals in double-double, if that is allowed; false if it is not, or they are in use.
    pub(super) fn extend(&mut self, bounds: &Bounds) -> bool {
        let turns = !self.extended && bounds.options.extended_precision;
        self.extended |= turns;
        self.used_extended |= turns;
        turns
    }

    pub(super) fn widen(&mut self) {
        self.wide = true;
        self.noise = self.rounding();
    }

    /// Goes back to double precision and its rounding errors: corrections of size `double` have just been
    /// seen to be nothing else.
    pub(super) fn narrow(&mut self, double: f64) {
        (self.extended, self.wide, self.kept) = (false, false, false);
        self.noise = self.noise.max(double).max(self.rounding());
    }

    /// Relative size below which a correction is less than the rounding error of the point.
    pub(super) fn rounding(&self) -> f64 {
        if self.wide { f64::EPSILON * f64::EPSILON } else { f64::EPSILON }
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
            // A solution near a singularity may fail the test for rounding errors alone.
            return if self.extend(bounds) { None } else { Some(PathEnd::InvalidStart) };
        }
        self.rejected += 1;
        self.failed_before += 1;
        let h_theta = if theta.is_finite() { h(theta) } else { 0.0 };
        let factor = if h_theta < bounds.h_half {
            tracking::HARD_CUT
        } else {
            (bounds.reach_half / ((1.0 + 2.0 * h_theta).sqrt() - 1.0)).sqrt().sqrt().max(tracking::HARD_CUT)
        };
        self.step *= factor;
        if self.failed_before >= tracking::RESISTANT {
            self.extend(bounds);
        }
        if self.t - self.step == self.t || self.step < 4.0 * f64::EPSILON * self.t {
            // Rounding errors alone may have made the corrector fail: try once more from a workable step. And
            // once more, because rounding errors of the point may have made the predictor fail.
            if !self.extend(bounds) {
                if self.wide || !bounds.options.extended_precision {
                    return Some(PathEnd::StepTooSmall);
                }
                self.widen();
            }
            self.step = 1e-3 * self.radius.min(self.t - self.stop());
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
