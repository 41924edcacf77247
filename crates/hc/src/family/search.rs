//! The search for all solutions of a family: its settings, its result, and what is known of it.

use super::fibre::{Fibre, FibreOptions};
use super::group::MonodromyGroup;
use crate::setters::setters;
use crate::tolerances::families;
use num_complex::Complex64;
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
    /// Whether only the orbit of the first solution is sought: what loops join to it. The number of
    /// roots that the family states is then left aside. Default false: orbits that no loop joins to
    /// the first are sought by other first pairs, and by a start system for the same parameters if
    /// that has no more paths than the loops (or 64), and 10,000 at most.
    pub only_component: bool,
    /// Loops along which all solutions are followed in the end, to tell the [monodromy group](Monodromy::group); each
    /// takes three paths a solution. Default 0: it is not asked for.
    #[serde(skip)]
    pub group: usize,
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
    only_component: bool,
    group: usize,
});

impl Default for MonodromyOptions {
    fn default() -> Self {
        let mut fibre = FibreOptions::default();
        fibre.tracker.max_steps = 2_000;
        fibre.retries = 1;
        let (trace_test, only_component) = (true, false);
        MonodromyOptions {
            seed: 0,
            roots: None,
            patience: 8,
            max_solutions: 100_000,
            fibre,
            trace_test,
            only_component,
            group: 0,
        }
    }
}

/// What monodromy found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Monodromy {
    /// The fibre, refined: its regular solutions.
    pub fibre: Fibre,
    /// Why the search ended.
    pub stopped: Stopped,
    /// The sizes of the orbits, largest first: sets of solutions that loops in the parameters join. A
    /// solution that no parameter moves is an orbit of its own. Solutions that a stated symmetry maps
    /// to each other count as joined. Loops that have not been tried could join further ones.
    pub orbits: Vec<usize>,
    /// Solutions that are multiple for all parameters. They are no part of the fibre, and are not
    /// tracked. They are known where a start system was solved.
    pub multiple: Vec<Multiple>,
    /// Number of loops.
    pub loops: usize,
    /// Number of paths tracked.
    pub paths: usize,
    /// What the trace test found, if it was requested and completed.
    pub trace: Option<TraceTest>,
    /// What loops tell of the monodromy group of the fibre, if that was asked for and the search was not cancelled.
    pub group: Option<MonodromyGroup>,
}

/// A solution that is multiple for all parameters, at those of the fibre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Multiple {
    /// The coordinates, in the order of the unknowns.
    #[serde(with = "pairs")]
    pub value: Vec<Complex64>,
    /// The multiplicity.
    pub multiplicity: usize,
}

/// Why the search for solutions ended, and what is known about others.
///
/// The trace test shows that what was found is a union of whole orbits, no more: other orbits may
/// have been missed. They are excluded by the known number of solutions, or where a start system
/// for the same parameters has led to no other solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stopped {
    /// The known number of solutions was reached.
    RootsReached,
    /// The last loops brought nothing new, the trace test has passed, and a start system, all of whose
    /// paths are accounted for, leads to the same solutions.
    Trace,
    /// The last loops brought nothing new, and a start system, all of whose paths are accounted for,
    /// leads to the same solutions. The trace test was left out or has not passed, as where its own further
    /// points were not all found.
    StartSystem,
    /// The last loops brought nothing new, and the trace test has passed. Other orbits are not
    /// excluded.
    OrbitsWhole,
    /// The orbit of the first solution is whole by the trace test, and no other was asked for
    /// ([`MonodromyOptions::only_component`]).
    ComponentWhole,
    /// The last loops brought nothing new. This is no proof, and the trace test has given none.
    NoProgress,
    /// More solutions than allowed.
    TooMany,
    /// The monitor was cancelled: these are the solutions found so far.
    Cancelled,
}

impl Stopped {
    /// All there are.
    const ALL: [Stopped; 8] = [
        Stopped::RootsReached,
        Stopped::Trace,
        Stopped::StartSystem,
        Stopped::OrbitsWhole,
        Stopped::ComponentWhole,
        Stopped::NoProgress,
        Stopped::TooMany,
        Stopped::Cancelled,
    ];

    /// The one with these words.
    pub(super) fn in_words(words: &str) -> Option<Stopped> {
        Stopped::ALL.into_iter().find(|stopped| stopped.to_string() == words)
    }

    /// Whether it is known that the regular solutions are all.
    pub fn is_complete(self) -> bool {
        matches!(self, Stopped::RootsReached | Stopped::Trace | Stopped::StartSystem)
    }

    /// How other orbits are excluded, in words: `roots`, `start system`, `not excluded`, `not sought`.
    pub fn others(self) -> &'static str {
        match self {
            Stopped::RootsReached => "roots",
            Stopped::Trace | Stopped::StartSystem => "start system",
            Stopped::ComponentWhole => "not sought",
            Stopped::OrbitsWhole | Stopped::NoProgress | Stopped::TooMany | Stopped::Cancelled => "not excluded",
        }
    }
}

/// The words of start files and programs.
impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stopped::RootsReached => "roots reached",
            Stopped::Trace => "trace",
            Stopped::StartSystem => "start system",
            Stopped::OrbitsWhole => "orbits whole",
            Stopped::ComponentWhole => "component whole",
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
    /// single points. It is rounding error if the points are all those of some orbits, and of the order
    /// of one if a point of an orbit is missing.
    pub deviation: f64,
    /// Points of the fibre that were counted after the further points had been added. Solutions that no
    /// parameter moves are counted without a test: each of them is a whole orbit.
    pub fibre: usize,
    /// Number of further points.
    pub further: usize,
    /// Whether every path of the test ended well; otherwise the deviation means nothing.
    pub complete: bool,
}

impl TraceTest {
    /// Whether the test shows that a fibre of `len` points is a union of whole orbits: it has a
    /// [result](Self::result), and the result is below 1e-18. It does not tell of orbits of which no
    /// point is known.
    pub fn passed(&self, len: usize) -> bool {
        self.result(len).is_some_and(|deviation| deviation < families::TRACE_PASSED)
    }

    /// The deviation for a fibre of `len` points, if it means something: every path ended well, and
    /// exactly these points were found on the fibre.
    pub fn result(&self, len: usize) -> Option<f64> {
        (self.complete && self.fibre == len && self.deviation.is_finite()).then_some(self.deviation)
    }
}

/// Coordinates as pairs `[re, im]`, as in the other fields of start files.
mod pairs {
    use num_complex::Complex64;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &[Complex64], serializer: S) -> Result<S::Ok, S::Error> {
        value.iter().map(|z| [z.re, z.im]).collect::<Vec<_>>().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Complex64>, D::Error> {
        let pairs = Vec::<[f64; 2]>::deserialize(deserializer)?;
        Ok(pairs.into_iter().map(|[re, im]| Complex64::new(re, im)).collect())
    }
}
