//! The search for all solutions of a family: its settings, its result, and what the trace test found.

use super::fibre::{Fibre, FibreOptions};
use crate::setters::setters;
use crate::tolerances::families;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Settings of [`Family::monodromy`](crate::Family::monodromy). The serialized settings are those
/// on which loops depend.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MonodromyOptions {
    /// Seed of the loops. Default 0.
    pub seed: u64,
    /// The known number of solutions, if any; reaching it ends the search. Default `None`.
    pub roots: Option<usize>,
    /// Loops without a new solution after which the search ends, provided that they had at least
    /// 128 chances (loops times solutions) to bring one. Where single parameters have to move
    /// further than others before they have an effect, it is twice as many, because loops then have
    /// two sizes in turn. Default 8.
    pub patience: usize,
    /// Largest number of solutions; the search gives up a fibre that exceeds it. Default 100,000.
    pub max_solutions: usize,
    /// Settings for the paths. By default difficult paths are given up early (2,000 steps, one
    /// retry), because easier paths of later loops find the same solutions.
    pub fibre: FibreOptions,
    /// Whether the [trace test](crate::Family::trace_test) comes last, unless the known number of
    /// solutions is reached. It takes several times as long as the search. Default true.
    #[serde(skip)]
    pub trace_test: bool,
}

impl MonodromyOptions {
    /// The defaults.
    pub fn new() -> Self {
        MonodromyOptions::default()
    }
}

setters!(MonodromyOptions {
    seed: u64,
    roots: usize,
    patience: usize,
    max_solutions: usize,
    fibre: FibreOptions,
    trace_test: bool,
});

impl Default for MonodromyOptions {
    fn default() -> Self {
        let mut fibre = FibreOptions::default();
        fibre.tracker.max_steps = 2_000;
        fibre.retries = 1;
        MonodromyOptions { seed: 0, roots: None, patience: 8, max_solutions: 100_000, fibre, trace_test: true }
    }
}

/// What monodromy found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Monodromy {
    /// The fibre, refined.
    pub fibre: Fibre,
    /// Why the search ended.
    pub stopped: Stopped,
    /// Number of loops.
    pub loops: usize,
    /// Number of paths tracked.
    pub paths: usize,
    /// What the trace test found, if it was requested and completed.
    pub trace: Option<TraceTest>,
}

/// Why the search for solutions ended, and whether it is known that there are no others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stopped {
    /// The known number of solutions was reached.
    RootsReached,
    /// The last loops brought nothing new, and the trace test shows that there are no others.
    Trace,
    /// The last loops brought nothing new. This is no proof, and the trace test has given none.
    NoProgress,
    /// More solutions than allowed.
    TooMany,
    /// The monitor was cancelled: these are the solutions found so far.
    Cancelled,
}

impl Stopped {
    /// All there are.
    const ALL: [Stopped; 5] =
        [Stopped::RootsReached, Stopped::Trace, Stopped::NoProgress, Stopped::TooMany, Stopped::Cancelled];

    /// The one with these words.
    pub(super) fn in_words(words: &str) -> Option<Stopped> {
        Stopped::ALL.into_iter().find(|stopped| stopped.to_string() == words)
    }

    /// Whether a known number of roots or the trace test shows that the solutions are all.
    pub fn is_complete(self) -> bool {
        matches!(self, Stopped::RootsReached | Stopped::Trace)
    }
}

/// The words of start files and programs.
impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stopped::RootsReached => "roots reached",
            Stopped::Trace => "trace",
            Stopped::NoProgress => "no progress",
            Stopped::TooMany => "too many solutions",
            Stopped::Cancelled => "interrupted",
        })
    }
}

/// What the trace test found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct TraceTest {
    /// Deviation of the sum of the points from linear motion, relative to the deviations of the
    /// single points. It is rounding error if the fibre is whole, and of the order of one if a
    /// point is missing.
    pub deviation: f64,
    /// Points of the fibre that were counted after the further points had been added.
    pub fibre: usize,
    /// Number of further points.
    pub further: usize,
    /// Whether every path of the test ended well; otherwise the deviation means nothing.
    pub complete: bool,
}

impl TraceTest {
    /// Whether the test shows that a fibre of `len` points is whole: it has a
    /// [result](Self::result), and the result is below 1e-18.
    pub fn passed(&self, len: usize) -> bool {
        self.result(len).is_some_and(|deviation| deviation < families::TRACE_PASSED)
    }

    /// The deviation for a fibre of `len` points, if it means something: every path ended well, and
    /// exactly these points were found on the fibre.
    pub fn result(&self, len: usize) -> Option<f64> {
        (self.complete && self.fibre == len && self.deviation.is_finite()).then_some(self.deviation)
    }
}
