//! Fibres: all solutions of a family for one parameter point.

use crate::tolerances::same;
use crate::tracker::{OptionError, TrackerOptions};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// The solutions of a family for one parameter point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fibre {
    /// The parameter point.
    pub parameters: Vec<Complex64>,
    /// Number of unknowns `n`.
    pub dimension: usize,
    /// The solutions, `n` coordinates each, one after the other.
    pub solutions: Vec<Complex64>,
    /// Numbers of the solutions that represent the others, one for each orbit, if the family is
    /// known to be [symmetric](crate::Family::symmetry). `None` if each solution represents only
    /// itself.
    pub representatives: Option<Vec<usize>>,
    /// Whether solutions may be missing. Ends of paths then do not show which of them have jumped, and no
    /// [quick steps](TrackerOptions::quick) are taken.
    pub is_partial: bool,
}

impl Fibre {
    /// The fibre with these solutions, `dimension` coordinates each, one after the other; they are all that
    /// there are.
    pub fn new(parameters: Vec<Complex64>, dimension: usize, solutions: Vec<Complex64>) -> Fibre {
        Fibre { parameters, dimension, solutions, representatives: None, is_partial: false }
    }

    /// The fibre from pairs `[re, im]`, as generated modules store them: the parameters, and the
    /// solutions one after the other.
    pub fn from_pairs(parameters: &[[f64; 2]], dimension: usize, solutions: &[[f64; 2]]) -> Fibre {
        let numbers = |pairs: &[[f64; 2]]| pairs.iter().map(|&[re, im]| Complex64::new(re, im)).collect();
        Fibre::new(numbers(parameters), dimension, numbers(solutions))
    }

    /// Number of solutions.
    pub fn len(&self) -> usize {
        self.solutions.len().checked_div(self.dimension).unwrap_or(0)
    }

    /// Whether there are no solutions.
    pub fn is_empty(&self) -> bool {
        self.solutions.is_empty()
    }

    /// The `k`-th solution.
    ///
    /// # Panics
    /// If there are not that many solutions.
    pub fn solution(&self, k: usize) -> &[Complex64] {
        &self.solutions[k * self.dimension..(k + 1) * self.dimension]
    }

    /// The solutions, one after the other.
    pub fn iter(&self) -> impl Iterator<Item = &[Complex64]> {
        (0..self.len()).map(|k| self.solution(k))
    }

    /// All but the first so many solutions, as a part of the fibre.
    pub(super) fn without_first(&self, count: usize) -> Fibre {
        let solutions = self.solutions.iter().skip(count * self.dimension).copied().collect();
        Fibre { is_partial: true, ..Fibre::new(self.parameters.clone(), self.dimension, solutions) }
    }

    /// The solutions that are tracked: the representatives of orbits, or all.
    pub(crate) fn tracked(&self) -> Fibre {
        let Some(which) = &self.representatives else { return self.clone() };
        let solutions = which.iter().flat_map(|&k| self.solution(k)).copied().collect();
        Fibre { is_partial: self.is_partial, ..Fibre::new(self.parameters.clone(), self.dimension, solutions) }
    }
}

/// Settings for tracking whole fibres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct FibreOptions {
    /// Settings of the tracker in the first pass.
    pub tracker: TrackerOptions,
    /// How often jumped and failed paths are tracked again, each time with steps half as long.
    /// Default 4.
    pub retries: u32,
    /// Most paths that are tracked again; where more are doubtful, all of them stay as they are. Default `None`: as
    /// many as there are.
    pub again: Option<usize>,
    /// Relative distance below which two endpoints are the same point. Default 1e-8.
    pub coincidence: f64,
}

impl Default for FibreOptions {
    fn default() -> Self {
        FibreOptions { tracker: TrackerOptions::default(), retries: 4, again: None, coincidence: same::REGULAR }
    }
}

impl FibreOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first setting that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        self.tracker.validate()?;
        OptionError::positive(&[("coincidence", self.coincidence)])
    }
}

/// How much may be spent on one target of [`Family::track`](crate::Family::track) beyond its first pass. Paths that
/// are still lost then count as failed, and [`Solutions::limited`](crate::Solutions::limited) says why they were left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TargetLimits {
    /// Paths that are tracked again, at most, in multiples of the paths of the first pass. Doubtful paths are tracked
    /// again with shorter steps, round after round. With 2 and more the whole fibre is first tracked to the target by
    /// a detour, which takes two paths for each solution; a second detour takes as many. Default 1.
    pub again: f64,
    /// Seconds of wall-clock time after which no further path is begun. What is found by then depends on the machine.
    /// Default `None`: no limit.
    pub seconds: Option<f64>,
}

impl Default for TargetLimits {
    fn default() -> Self {
        TargetLimits { again: 1.0, seconds: None }
    }
}

impl TargetLimits {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first setting that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        OptionError::at_least("again", self.again, 0.0, "zero or more")?;
        OptionError::at_least("seconds", self.seconds.unwrap_or(0.0), 0.0, "zero or more")
    }
}

/// The limit for whose sake paths are left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Limit {
    /// The number of paths that may be tracked again: [`TargetLimits::again`] or [`FibreOptions::again`].
    Again,
    /// The time: [`TargetLimits::seconds`].
    Time,
}

/// How paths ended; `tracked` is the sum of the next four.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathCounts {
    /// Paths tracked, one for each start solution.
    pub tracked: usize,
    /// Paths that ended at a regular solution of their own.
    pub finite: usize,
    /// Paths that are shown to diverge.
    pub at_infinity: usize,
    /// Paths that ended otherwise, including those that still share their end with another, and those of a
    /// family to points where a factor vanishes that it declares nonzero.
    pub failed: usize,
    /// Paths that were left once all solutions were known
    /// ([`SolveOptions::known`](crate::SolveOptions::known)).
    pub dropped: usize,
    /// How often a path was tracked again.
    pub retracked: usize,
}

/// The number that each point has once some are left out; `None` for these.
pub(super) fn numbers_without(left_out: &[bool]) -> Vec<Option<usize>> {
    let mut next = 0..;
    left_out.iter().map(|&gone| if gone { None } else { next.next() }).collect()
}
