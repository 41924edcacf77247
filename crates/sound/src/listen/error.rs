//! Why recordings cannot be listened to.

use thiserror::Error;

use crate::error::ReadError;
use crate::events::EventError;
use crate::times::TimeError;

/// Why recordings cannot be listened to.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ListenError {
    /// Events cannot be found.
    #[error(transparent)]
    Events(EventError),
    /// Arrival times cannot be taken.
    #[error(transparent)]
    Times(#[from] TimeError),
    /// A recorder without files.
    #[error("recorder {number} has no files; give at least one for each recorder")]
    NoFiles {
        /// Number of the recorder, from 1.
        number: usize,
    },
    /// More recorders than are compared, each with each.
    #[error("there are {found} recorders, and at most {most} are aligned; take some of them at a time")]
    TooManyRecorders {
        /// How many there are.
        found: usize,
        /// How many there may be.
        most: usize,
    },
    /// The monitor has stopped the work.
    #[error("listening was stopped")]
    Stopped,
}

impl From<EventError> for ListenError {
    fn from(error: EventError) -> ListenError {
        match error {
            EventError::Read(ReadError::Stopped) => ListenError::Stopped,
            error => ListenError::Events(error),
        }
    }
}
