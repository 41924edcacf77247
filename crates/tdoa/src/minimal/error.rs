//! Why a matrix cannot be solved.

use hc::poly::counted;
use hc::tracker::OptionError;
use thiserror::Error;

/// Why a matrix cannot be solved.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MinimalError {
    /// A setting of the tracker is out of range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Fewer constraints than unknowns.
    #[error(
        "{configuration} is underdetermined: {} for {} (positions up to a rigid motion, offsets); the smallest solvable networks are \
         6 receivers with 3 transmitters, 5 with 4, and 4 with 5",
        counted(*.constraints, "measurement"),
        counted(*.unknowns, "unknown")
    )]
    Underdetermined {
        /// Size, such as `4r/4s`.
        configuration: String,
        /// Number of measurements.
        constraints: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// There are more measurements than dense algebra can refine with.
    #[error(
        "{configuration} has more than the {limit} measurements that exact solvers take; use `calibrate`, or select nodes"
    )]
    TooLarge {
        /// Size, such as `400r/300s`.
        configuration: String,
        /// Largest number of measurements.
        limit: usize,
    },
    /// The polyhedral route failed before any path was tracked.
    #[error("the polyhedral start system: {0}")]
    Polyhedral(String),
    /// The polyhedral route was stopped through its [`Monitor`](hc::Monitor).
    #[error("the solve was cancelled")]
    Cancelled,
    /// A missing measurement.
    #[error(
        "receiver {receiver} did not hear transmitter {transmitter}: the exact solvers need every measurement; use `calibrate`"
    )]
    Missing {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
    },
    /// Two receivers that cannot be told apart.
    #[error(
        "receivers {first} and {second} measure the same up to a constant: they coincide (or lie on one line with every transmitter); \
         remove one of them"
    )]
    IdenticalReceivers {
        /// Name of the one.
        first: String,
        /// Name of the other.
        second: String,
    },
    /// Two transmitters that cannot be told apart.
    #[error("transmitters {first} and {second} are heard alike up to a constant: they coincide; remove one of them")]
    IdenticalTransmitters {
        /// Name of the one.
        first: String,
        /// Name of the other.
        second: String,
    },
    /// Another size than a solver in space takes.
    #[error("{configuration}: five transmitters and nine receivers or more are needed; select such nodes")]
    NotFiveTransmitters {
        /// Size, such as `8r/5s`.
        configuration: String,
    },
    /// Nodes in special position, so that linear equations do not determine them.
    #[error(
        "linear equations in space do not determine the nodes, as far as the measurements tell: all receivers or four of the transmitters \
         lie in one plane, or the receivers are the corners of a box or on another surface of degree two; select other nodes"
    )]
    SpecialPosition,
    /// Measurements that are not those of a network.
    #[error("no network in space explains the measurements; look for wrong ones, or select other nodes")]
    NoNetwork,
}
