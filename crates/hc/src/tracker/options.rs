//! Settings of the tracker, with presets.

use poly::simd::Isa;
use serde::{Deserialize, Serialize};

/// A setting outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("option {name} must be {range}, not {value}")]
#[non_exhaustive]
pub struct OptionError {
    /// The name of the setting.
    pub name: &'static str,
    /// The allowed range.
    pub range: &'static str,
    /// The given value.
    pub value: f64,
}

impl OptionError {
    /// The first of the named values that is not positive and finite.
    pub(crate) fn positive(values: &[(&'static str, f64)]) -> Result<(), OptionError> {
        let wrong = values.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        wrong.map_or(Ok(()), |&(name, value)| Err(OptionError { name, range: "positive and finite", value }))
    }

    /// An error unless the value is at least this.
    pub(crate) fn at_least(name: &'static str, value: f64, least: f64, range: &'static str) -> Result<(), OptionError> {
        if value >= least { Ok(()) } else { Err(OptionError { name, range, value }) }
    }
}

/// Settings of the path tracker. Two bounds limit the steps: the radius of trust of the predictor
/// (`beta_tau`) and the length for which Newton's method converges at once (`beta_omega`); see
/// [`crate::tracker`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct TrackerOptions {
    /// Largest contraction `|dx_1| / |dx_0|` of Newton's method that is accepted (dimensionless).
    /// Default 1/8 (Timme 2020); fast 1/5.
    pub contraction: f64,
    /// Safety factor of the Newton bound: the step is divided by it. Default 3; fast 1;
    /// conservative 4.
    pub beta_omega: f64,
    /// Share of the radius of trust that a step may cover. Default 0.4; fast 0.85; conservative
    /// 0.25.
    pub beta_tau: f64,
    /// `beta_tau` for the step that reaches the target. Default 0.3; fast 0.6; conservative 0.1875.
    pub beta_tau_last: f64,
    /// Newton's method stops when `omega |dx|` falls below this (dimensionless). One correction
    /// with the last Jacobian follows, which leaves a relative error of about the third power of
    /// this. Default 1e-4; fast 1e-3.
    pub corrector_tolerance: f64,
    /// Number of steps, accepted and rejected, after which a path is given up; with `quick`, of those with
    /// all care. Default 10,000.
    pub max_steps: usize,
    /// A path whose `t` has fallen below this without reaching the target ends as singular or at
    /// infinity. Default 1e-14.
    pub min_t: f64,
    /// Valuations are watched for divergence from this `t` on. Default 0.1.
    pub endgame_start: f64,
    /// Corrections are measured relative to the size of their coordinate. Coordinates below this
    /// share of the largest, or below 1e-6, count as that large. Default 1e-4. The endgame takes
    /// zero: near the target a path may have coordinates of very different sizes, and similar paths
    /// may differ only in the small ones.
    #[serde(default = "least_share")]
    pub least_share: f64,
    /// Whether residuals may be computed in double-double where double precision is not enough.
    /// Default true.
    pub extended_precision: bool,
    /// Whether all paths are tracked first with one attempt at a step for all lanes at once and a corrector
    /// that takes one Jacobian, three corrections and no second look, in single precision as far as that
    /// goes, then in double precision. Where that is not enough, paths go on with all care. Of the other
    /// settings quick steps heed `beta_tau`, `beta_tau_last`, `max_steps`, `least_share` and `isa`. For sets
    /// of paths whose ends show which have jumped. Default false; true in
    /// [`SolveOptions`](crate::SolveOptions).
    #[serde(default)]
    pub quick: bool,
    /// Instruction set of the lane kernels; `None` takes the widest of the machine. The result does
    /// not depend on it. Default `None`.
    #[serde(skip)]
    pub isa: Option<Isa>,
}

/// The default of [`TrackerOptions::least_share`].
fn least_share() -> f64 {
    1e-4
}

impl Default for TrackerOptions {
    fn default() -> Self {
        TrackerOptions {
            contraction: 0.125,
            beta_omega: 3.0,
            beta_tau: 0.4,
            beta_tau_last: 0.3,
            corrector_tolerance: 1e-4,
            max_steps: 10_000,
            min_t: 1e-14,
            endgame_start: 0.1,
            least_share: least_share(),
            extended_precision: true,
            quick: false,
            isa: None,
        }
    }
}

impl TrackerOptions {
    /// Longer steps, for whole solution sets: there the ends show which paths have jumped, and
    /// these are tracked again. results/counts.md says how many, system by system. The factors are
    /// less careful than those of HomotopyContinuation.jl's fast preset (2, 0.75, 0.4).
    pub fn fast() -> Self {
        TrackerOptions {
            contraction: 0.2,
            beta_omega: 1.0,
            beta_tau: 0.85,
            beta_tau_last: 0.6,
            corrector_tolerance: 1e-3,
            ..Self::default()
        }
    }

    /// Shorter steps (the factors of HomotopyContinuation.jl's conservative preset).
    pub fn conservative() -> Self {
        TrackerOptions { beta_omega: 4.0, beta_tau: 0.25, beta_tau_last: 0.1875, ..Self::default() }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first setting that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        OptionError::positive(&[
            ("contraction", self.contraction),
            ("beta_omega", self.beta_omega),
            ("beta_tau", self.beta_tau),
            ("beta_tau_last", self.beta_tau_last),
            ("corrector_tolerance", self.corrector_tolerance),
        ])?;
        OptionError::at_least("max_steps", self.max_steps as f64, 1.0, "at least 1")?;
        OptionError::at_least("min_t", self.min_t, 0.0, "zero or more")?;
        OptionError::at_least("endgame_start", self.endgame_start, 0.0, "zero or more")?;
        OptionError::at_least("least_share", self.least_share, 0.0, "zero or more")
    }

    /// These, for the first pass from all solutions there are, or from a part of them: then without quick
    /// steps, because the ends do not show which paths have jumped.
    pub(crate) fn first(&self, from_part: bool) -> Self {
        TrackerOptions { quick: self.quick && !from_part, ..self.clone() }
    }

    /// Shorter steps than these, for paths that are tracked again: at `level` 1 about half as long,
    /// at each further level half of that.
    pub(crate) fn stricter(&self, level: u32) -> Self {
        let factor = 0.5f64.powi(level as i32);
        TrackerOptions {
            beta_omega: self.beta_omega / factor,
            beta_tau: self.beta_tau.min(0.4) * factor,
            beta_tau_last: self.beta_tau_last.min(0.3) * factor,
            max_steps: self.max_steps.saturating_mul(1 << level.min(10)),
            quick: false,
            ..self.clone()
        }
    }
}
