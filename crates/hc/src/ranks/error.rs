//! Why ranks cannot work together.

use super::exchange::ExchangeError;

/// Why ranks cannot work together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RanksError {
    /// Nothing can be sent or received.
    #[error("messages between ranks cannot be sent or received ({0})")]
    Exchange(#[from] ExchangeError),
    /// A message that cannot be read.
    #[error("rank {rank} has sent a message that cannot be read ({reason}); run the same program on all ranks")]
    Message {
        /// The rank that sent it.
        rank: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A rank with another system, other options or another program.
    #[error("rank {rank} has another system, other options or another version of the program than rank 0")]
    Differs {
        /// That rank.
        rank: usize,
    },
    /// A rank that cannot work.
    #[error("rank {rank}: {message}")]
    Failed {
        /// That rank.
        rank: usize,
        /// Why.
        message: String,
    },
}
