//! Why a matrix cannot be solved.

use crate::clocks::Emissions;
use crate::degeneracy::list;
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
        "{configuration} is underdetermined{}: {} for {} (positions up to a rigid motion{}); the smallest solvable networks are \
         {}",
        if *.dimensions == 2 { "" } else { " in space" },
        counted(*.constraints, if *.emissions == Emissions::Unknown { "measurement" } else { "range" }),
        counted(*.unknowns, "unknown"),
        match *.emissions {
            Emissions::Unknown => ", offsets",
            Emissions::Known => "",
            Emissions::Constant => ", a constant",
        },
        smallest(*.dimensions, *.emissions)
    )]
    Underdetermined {
        /// 2 in the plane, 3 in space.
        dimensions: usize,
        /// What is known of offsets.
        emissions: Emissions,
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
    /// A start that the size does not have.
    #[error(
        "{configuration} in space, and of ranges, is solved from stored solutions alone; leave out the polyhedral start"
    )]
    StoredOnly {
        /// Size, such as `7r/5s`.
        configuration: String,
    },
    /// The solve was stopped through its [`Monitor`](hc::Monitor).
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
    /// A range that is none.
    #[error(
        "the range of receiver {receiver} and transmitter {transmitter} is negative ({value} m): distances are positive; \
         leave out that these are ranges if every transmitter has an offset"
    )]
    NegativeRange {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// The range, metres.
        value: f64,
    },
    /// A network to start from that is not one of the matrix.
    #[error(
        "the network to start from is not a finite one of {configuration}: give a position for every node and an offset for every transmitter"
    )]
    UnusableStart {
        /// Size of the matrix, such as `7r/5s`.
        configuration: String,
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
    /// A size that has finitely many networks in space, but is none of those that are solved.
    #[error(
        "{configuration} is not solved exactly in space: with five receivers it has tens of thousands of solutions; add a receiver, or use \
         `calibrate --dimensions 3`, which searches and takes noisy measurements"
    )]
    NotSolvedInSpace {
        /// Size, such as `5r/9s`.
        configuration: String,
    },
    /// Nodes in space that lie in one plane or line.
    #[error(
        "all receivers or all transmitters lie in one plane (or line), as far as the measurements tell: which side of it the other nodes \
         are on is not determined in space; move a node of each kind off it, or if all nodes lie in one plane, solve in the plane"
    )]
    InOnePlane,
    /// Nodes in the plane, of which ranges are known, that lie in one line.
    #[error(
        "all receivers or all transmitters lie in one line, as far as the ranges tell: which side of it the other nodes are on is not \
         determined; move a node of each kind off it"
    )]
    InOneLine,
    /// Four of five transmitters in space that lie in one plane, or three in one line.
    #[error(
        "transmitters {} lie in one {}, as far as the measurements tell: linear equations in space need five transmitters of which no four \
         lie in one plane; move one of these, or add a transmitter elsewhere",
        list(names),
        if names.len() > 3 { "plane" } else { "line" }
    )]
    TransmittersInOnePlane {
        /// Their names.
        names: Vec<String>,
    },
    /// Nodes in special position, so that the equations of the solver do not determine them.
    #[error(
        "the equations do not determine the nodes in space, as far as the measurements tell: all receivers, all transmitters, or all but one \
         lie in one plane, or the receivers are the corners of a box or on another surface of degree two; move or add nodes"
    )]
    SpecialPosition,
    /// Measurements that are not those of a network.
    #[error(
        "no network in space explains the measurements; look for wrong ones or, if they are noisy, use `calibrate --dimensions 3`"
    )]
    NoNetwork,
}

/// The smallest solvable sizes, in words.
fn smallest(dimensions: usize, emissions: Emissions) -> &'static str {
    match (dimensions, emissions) {
        (2, Emissions::Unknown) => "6 receivers with 3 transmitters, 5 with 4, and 4 with 5",
        (_, Emissions::Unknown) => "10 receivers with 4 transmitters, 7 with 5, 6 with 6, and 5 with 9",
        (2, Emissions::Known) => "3 receivers with 3 transmitters",
        (_, Emissions::Known) => "6 receivers with 4 transmitters, 5 with 5, and 4 with 6",
        (2, Emissions::Constant) => "4 receivers with 3 transmitters, and 3 with 4",
        (_, Emissions::Constant) => "7 receivers with 4 transmitters, 5 with 5, and 4 with 7",
    }
}
