//! Why nothing can be located.

use thiserror::Error;

/// Why transmitters cannot be located in a network.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LocateError {
    /// The network is not to be trusted.
    #[error("the network is not to be trusted: {why}; calibrate it anew, with more or better measurements")]
    Distrust {
        /// Why.
        why: &'static str,
    },
    /// The standard deviation is no positive number.
    #[error("sigma is {value}, but must be a positive number of metres")]
    Sigma {
        /// What was given.
        value: f64,
    },
    /// The standard deviation of the measurements is not known.
    #[error(
        "how precise the measurements are is not known: the network was calibrated with standard deviations of single measurements, or \
         without any redundancy; give these here too, or sigma in metres"
    )]
    NoSigma,
    /// Receivers that are not in the network.
    #[error("receivers are not in the network: {names}; its receivers are {known}")]
    Unknown {
        /// Their names.
        names: String,
        /// Those of the network.
        known: String,
    },
    /// Measurements without names have another number of receivers.
    #[error(
        "there are {given} receivers without names, and the network has {known}; name them, or give a row for each"
    )]
    Count {
        /// Receivers of the measurements.
        given: usize,
        /// Receivers of the network.
        known: usize,
    },
    /// Moments, which each table counts from its first one, where clocks have rates.
    #[error(
        "measurements are moments, and clocks with rates need readings that go on from those of the calibration; give seconds in both"
    )]
    Moments,
    /// A recorder whose clock is not known.
    #[error(
        "the clock of recorder {recorder} is not known in the network; give the recorder of each receiver as in the calibration"
    )]
    Recorder {
        /// Its name.
        recorder: String,
    },
}
