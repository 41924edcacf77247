//! What whoever started a run should hear about its checkpoint.

use std::fmt;

/// What is said about a checkpoint while the work goes on.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// There is nothing to resume: the work starts from the beginning.
    Nothing,
    /// The work goes on after what is recorded.
    Resumed {
        /// Records that are whole.
        records: usize,
        /// Seconds of work until the last of them.
        seconds: f64,
    },
    /// The log ends in the middle of a record: the process ended while it was written, or its length
    /// is damaged. What it held is computed again.
    Torn {
        /// Bytes from there on, which are cut off.
        dropped: u64,
    },
    /// A record does not have its checksum. It and those after it are cut off; what they held is
    /// computed again.
    Damaged {
        /// Where it begins in the log, in bytes.
        at: u64,
        /// Bytes that are cut off.
        dropped: u64,
    },
    /// Records that are whole but of other paths than those that are due; they are computed again.
    Unfit,
    /// A record cannot be written; the work goes on, and writing is tried again with the next.
    Unwritten(String),
    /// Records can be written again.
    WrittenAgain,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Note::Nothing => f.write_str("there is no checkpoint yet; starts from the beginning"),
            Note::Resumed { records, seconds } => {
                write!(f, "goes on after {records} records, {seconds:.1} s of work")
            }
            Note::Torn { dropped } => {
                write!(f, "the log ends within a record; its last {dropped} bytes are cut off and computed again")
            }
            Note::Damaged { at, dropped } => write!(
                f,
                "the record at byte {at} is damaged; it and those after it ({dropped} bytes) are cut off and computed again"
            ),
            Note::Unfit => f.write_str("a record is of other paths than those that are due; they are computed again"),
            Note::Unwritten(message) => {
                write!(
                    f,
                    "cannot be written ({message}); the work goes on, and what cannot be recorded would be computed again"
                )
            }
            Note::WrittenAgain => f.write_str("can be written again"),
        }
    }
}
