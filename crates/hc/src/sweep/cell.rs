//! One cell of a sweep: its real solutions, and how sure their number is.

use poly::counted;
use serde::{Serialize, Serializer};
use std::fmt;

/// A real solution in a cell.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RealSolution {
    /// The coordinates, in the order of the unknowns.
    pub value: Vec<f64>,
    /// Its multiplicity, 1 if it is regular.
    pub multiplicity: usize,
    /// Whether all coordinates are positive, beyond their rounding errors.
    pub positive: bool,
    /// The number of its branch, from 0. `None` for multiple solutions, at which branches end, and in cells where
    /// neighbours were not compared.
    pub branch: Option<usize>,
}

/// What is found in a cell.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Cell {
    /// How sure the numbers are.
    pub standing: Standing,
    /// The distinct real solutions, in ascending order of their coordinates.
    pub solutions: Vec<RealSolution>,
    /// Number of distinct solutions that are not real.
    pub complex: usize,
    /// Paths that went to infinity.
    pub at_infinity: usize,
}

impl Cell {
    /// Number of real solutions.
    pub fn real(&self) -> usize {
        self.solutions.len()
    }

    /// Number of real solutions all of whose coordinates are positive.
    pub fn positive(&self) -> usize {
        self.solutions.iter().filter(|s| s.positive).count()
    }
}

/// How sure the number of real solutions of a cell is.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Standing {
    /// The work was stopped before.
    #[default]
    Unreached,
    /// All solutions of the fibre are accounted for by paths with ends of their own. The conjugate of each end is
    /// itself, which makes it real, or another end.
    Counted,
    /// The solutions are proved to exist, to be distinct, and to be real or not, by interval arithmetic.
    Certified,
    /// As [`Counted`](Self::Counted), but there are multiple solutions: the cell lies on a fold, to its last digit.
    Multiple,
    /// The number is not shown, for this reason.
    Doubtful(Doubt),
}

impl Standing {
    /// Whether the number of real solutions is shown.
    pub fn is_shown(&self) -> bool {
        matches!(self, Standing::Counted | Standing::Certified | Standing::Multiple)
    }

    /// Its name, one word.
    pub fn name(&self) -> &'static str {
        match self {
            Standing::Unreached => "unreached",
            Standing::Counted => "counted",
            Standing::Certified => "certified",
            Standing::Multiple => "multiple",
            Standing::Doubtful(_) => "doubtful",
        }
    }

    /// Why the number is not shown, if it is not.
    pub fn doubt(&self) -> Option<&Doubt> {
        match self {
            Standing::Doubtful(doubt) => Some(doubt),
            _ => None,
        }
    }
}

/// As its [name](Standing::name).
impl Serialize for Standing {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Why the number of real solutions of a cell is not shown.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Paths were lost.
    Lost {
        /// Number of these.
        paths: usize,
    },
    /// Paths ended on a set of solutions of positive dimension.
    Component {
        /// Number of these.
        paths: usize,
    },
    /// The ends do not add up to the solutions of the fibre.
    Sum {
        /// Solutions with their multiplicities, and paths to infinity.
        found: usize,
        /// Solutions of the fibre.
        fibre: usize,
    },
    /// Solutions are so near each other or the real points that neither pairs of conjugates nor certificates tell
    /// which are real.
    Unclear {
        /// Number of these.
        solutions: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Doubt::Lost { paths } => write!(f, "{} lost", counted(*paths, "path")),
            Doubt::Component { paths } => {
                write!(f, "{} on a set of solutions of positive dimension", counted(*paths, "path"))
            }
            Doubt::Sum { found, fibre } => {
                write!(f, "the ends of paths add up to {found}, the fibre has {}", counted(*fibre, "solution"))
            }
            Doubt::Unclear { solutions } => {
                write!(f, "{} neither shown real nor shown not real", counted(*solutions, "solution"))
            }
        }
    }
}
