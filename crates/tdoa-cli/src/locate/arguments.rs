//! The options of `tdoa locate`.

use std::path::PathBuf;

use crate::recordings::RecordingArguments;

/// Locates new transmitters in a network that is calibrated: a line of JSON each, as they come.
///
/// Receivers are known by their names. Each transmitter is located by itself, with its covariance, the receivers that do not
/// agree, and other places that explain the measurements about as well (`others`); `unique` says that there is none.
/// Values are those that the network would have been calibrated with: by the same clocks, and at the same speed. In recordings
/// the sounds are found as `tdoa listen` does, and each has the time at which it was made too (`seconds`).
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The network: what `tdoa calibrate --json` has written.
    pub(super) network: PathBuf,
    /// The measurements, in any form that `tdoa calibrate` reads; - for standard input. A list from there is read as it
    /// comes: a transmitter is located when the next one begins. Or recordings, which are listened to; their channels are
    /// known by their names, FILE:1 and so on, and those of one file by their numbers.
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) input: crate::units::InputArguments,
    #[command(flatten, next_help_heading = "Recordings")]
    pub(super) recording: RecordingArguments,
    /// Standard deviation of the measurements in metres; that of the calibration if not given.
    #[arg(long, allow_negative_numbers = true)]
    pub(super) sigma: Option<f64>,
    /// Threads; accepted everywhere, locating needs only one.
    #[arg(long)]
    pub(super) threads: Option<usize>,
}
