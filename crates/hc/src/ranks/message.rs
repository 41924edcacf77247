//! Messages between rank 0 and the others.
//!
//! Serde writes their contents in the postcard format, as for the records of
//! [checkpoints](crate::checkpoint). A message that is too long, incomplete or of another version
//! is refused.

use super::error::RanksError;
use crate::runner::Round;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The version of messages, their first byte; another one whenever they change.
const VERSION: u8 = 2;
/// Longer messages are refused.
pub(super) const LONGEST: usize = 1 << 30;

/// Paths for a rank to track, or other items for it to compute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Portion {
    /// Its number in the part.
    pub number: u64,
    pub(super) round: Round,
    /// The numbers of the paths, in ascending order.
    pub paths: Vec<usize>,
}

/// From rank 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Order {
    /// A part of a job begins: a start system or a fibre, which is described by the content.
    Begin { job: u64, part: u32, content: Vec<u8> },
    /// Paths are to be tracked.
    Track { job: u64, part: u32, portion: Portion },
    /// The job is over.
    Over { job: u64 },
    /// There are no more jobs.
    End,
}

/// To rank 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Report {
    /// A part can be worked at, on so many threads. The rank has the job with this fingerprint.
    Ready { job: u64, part: u32, threads: usize, fingerprint: String },
    /// What has become of the paths of a portion, and the seconds that they took.
    Done { job: u64, part: u32, number: u64, seconds: f64, content: Vec<u8> },
    /// The rank cannot work.
    Failed { job: u64, message: String },
}

/// A message in bytes; `None` only if it is too long.
pub(super) fn encoded(message: &impl Serialize) -> Option<Vec<u8>> {
    postcard::to_extend(message, vec![VERSION]).ok().filter(|bytes| bytes.len() <= LONGEST)
}

/// The message that a rank has sent.
///
/// # Errors
/// If it cannot be read.
pub(super) fn decoded<T: DeserializeOwned>(rank: usize, bytes: &[u8]) -> Result<T, RanksError> {
    let refused = |reason: String| RanksError::Message { rank, reason };
    if bytes.len() > LONGEST {
        return Err(refused(format!("{} bytes", bytes.len())));
    }
    match bytes.split_first() {
        Some((&VERSION, rest)) => match postcard::take_from_bytes(rest) {
            Ok((message, [])) => Ok(message),
            Ok((_, more)) => Err(refused(format!("{} bytes too many", more.len()))),
            Err(error) => Err(refused(error.to_string())),
        },
        Some((version, _)) => Err(refused(format!("version {version} instead of {VERSION}"))),
        None => Err(refused("it is empty".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn messages_are_read_back_and_others_refused() {
        let portion = Portion { number: 3, round: Round { level: 1, chart: 0 }, paths: vec![5, 7, 1 << 40] };
        let order = Order::Track { job: 1, part: 2, portion };
        let bytes = encoded(&order).unwrap();
        assert_eq!(decoded(0, &bytes), Ok(order));
        let refused = |bytes: &[u8]| match decoded::<Order>(3, bytes) {
            Err(RanksError::Message { rank: 3, reason }) => reason,
            other => panic!("{other:?}"),
        };
        for end in 0..bytes.len() {
            refused(&bytes[..end]);
        }
        assert_eq!(refused(&[&bytes[..], &[0]].concat()), "1 bytes too many");
        assert_eq!(refused(&[&[9], &bytes[1..]].concat()), "version 9 instead of 2");
        // A list that claims to be longer than anything.
        let long = [&[VERSION, 0, 1, 1][..], &[0xff; 9], &[1]].concat();
        refused(&long);
    }

    proptest! {
        #[test]
        fn no_bytes_are_too_strange(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let bytes = [&[VERSION], &bytes[..]].concat();
            let _ = decoded::<Order>(1, &bytes);
            let _ = decoded::<Report>(1, &bytes);
        }
    }
}
