//! Messages about a checkpoint for whoever started the run.

use poly::counted;
use std::fmt;

/// A message about a checkpoint while the work goes on.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// There is nothing to resume: the work starts from the beginning.
    Nothing,
    /// The work continues after the recorded part.
    Resumed {
        /// Number of complete records.
        records: usize,
        /// Seconds of work up to the last of them.
        seconds: f64,
    },
    /// The log ends in the middle of a record: the process ended while it wrote the record, or the
    /// record's length is damaged. Its content is computed again.
    Torn {
        /// Number of bytes from there on, which are cut off.
        dropped: u64,
    },
    /// A record does not match its checksum. This record and all after it are cut off; their
    /// content is computed again.
    Damaged {
        /// Offset of the record in the log, in bytes.
        at: u64,
        /// Number of bytes that are cut off.
        dropped: u64,
    },
    /// Records that are complete, but for other paths than those that are due; these paths are
    /// computed again.
    Unfit,
    /// A record cannot be written. The work goes on, and the next record is tried again.
    Unwritten(String),
    /// Records can be written again.
    WrittenAgain,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Note::Nothing => f.write_str("there is no checkpoint yet; starts from the beginning"),
            Note::Resumed { records, seconds } => {
                write!(f, "goes on after {}, {seconds:.1} s of work", counted(*records, "record"))
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
