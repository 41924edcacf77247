//! Why a search for the solutions of a family ended.

use std::fmt;

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
