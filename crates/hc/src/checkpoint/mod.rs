//! Checkpoints: runs that continue after they were killed.
//!
//! A [`Checkpoint`] is a directory in which a run records its finished work
//! ([`Run::recorded`](crate::Run::recorded)): batches of paths with their ends
//! ([`Run::solve`](crate::Run::solve)), targets of a family with their solutions
//! ([`Run::track`](crate::Run::track)), loops of monodromy with the solutions that they find
//! ([`Run::complete`](crate::Run::complete)). If it is opened again with
//! [`resume`](CheckpointOptions::resume), the same run reads what is recorded and computes only
//! what is missing. The result is the same to the bit as that of a run without interruption, on any
//! number of threads.
//!
//! The directory has three files. `checkpoint.json` describes the run: the versions of records and
//! of this crate, hashes of the system as it was read and of other input, and all options on which
//! the result depends. Any difference when the run is resumed is [named](CheckpointError::Differs).
//! `records.log` has the records, each with its length and a checksum. They are written as they
//! come and flushed to disk every few [seconds](CheckpointOptions::interval). A record that is
//! incomplete or damaged is cut off together with all records after it, and their content is
//! computed again. `lock` is locked while a run records in the directory, and remains afterwards.
//!
//! Serde writes the contents of records in the postcard format: numbers in as few bytes as they
//! need, doubles to the bit, no names. That format is specified and will not change; the
//! alternative, bincode, is no longer maintained.
//!
//! ```
//! use hc::checkpoint::{Checkpoint, CheckpointOptions};
//! use hc::{Run, SolveOptions, System};
//!
//! # let folder = tempfile::tempdir()?;
//! # let directory = folder.path().join("run");
//! let system: System = "x^2 + y^2 - 5; x*y - 2".parse()?;
//! let options = SolveOptions::new().seed(1);
//! let checkpoint = Checkpoint::open(&directory, &CheckpointOptions::new())?;
//! let found = Run::new().recorded(&checkpoint).solve(&system, &options)?;
//! drop(checkpoint);
//!
//! let again = Checkpoint::open(&directory, &CheckpointOptions::new().resume(true))?;
//! assert_eq!(Run::new().recorded(&again).solve(&system, &options)?, found);
//! let status = hc::checkpoint::status(&directory)?;
//! assert_eq!((status.done, status.total, status.running), (4, Some(4), true));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod header;
mod keeper;
mod log;
mod note;
mod pieces;
mod recorded;
mod status;
#[cfg(all(test, feature = "threads"))]
pub(crate) mod support;

pub use error::CheckpointError;
pub(crate) use header::{Hash, Job, System};
pub(crate) use keeper::Part;
pub use keeper::{Checkpoint, CheckpointOptions};
pub use note::Note;
pub(crate) use pieces::{Piece, Pieces};
pub(crate) use recorded::{Recordable, Recorded};
pub use status::{Status, status};
