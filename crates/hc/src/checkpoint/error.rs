//! Why a checkpoint is refused.

use std::io;
use std::path::{Path, PathBuf};

/// Why a checkpoint is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// A file or directory that cannot be read or written.
    #[error("{}: cannot be read or written ({message}); check that the directory is writable and has space", path.display())]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// The message of the operating system.
        message: String,
    },
    /// Another process records in the directory.
    #[error("{}: another run records its work there; wait for its end, or give another directory", .0.display())]
    InUse(PathBuf),
    /// The directory has the checkpoint of an earlier run, but resuming was not requested.
    #[error("{}: has the checkpoint of an earlier run already; resume that, or give another directory", .0.display())]
    Taken(PathBuf),
    /// A file that does not belong to a checkpoint.
    #[error("{}: is not of a checkpoint ({reason}); give another directory", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The checkpoint of another run.
    #[error("{}: the checkpoint is of {name} {recorded}, this run has {name} {own}; run it as before, or give another directory", directory.display())]
    Differs {
        /// The directory of the checkpoint.
        directory: PathBuf,
        /// What differs: version, system or the name of an option.
        name: String,
        /// Its value in the checkpoint.
        recorded: String,
        /// Its value in this run.
        own: String,
    },
    /// One [`Checkpoint`](super::Checkpoint) was given to two runs.
    #[error("{}: this checkpoint has served a run already; open it again for the next", .0.display())]
    Used(PathBuf),
    /// Work that does not record itself.
    #[error("{0} is not recorded; run it without a checkpoint")]
    Unrecorded(&'static str),
}

impl CheckpointError {
    pub(super) fn io(path: &Path, error: &io::Error) -> CheckpointError {
        CheckpointError::Io { path: path.to_owned(), message: error.to_string() }
    }
}
