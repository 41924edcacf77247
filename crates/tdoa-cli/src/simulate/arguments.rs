//! The options of `tdoa simulate`.

use std::path::PathBuf;

use super::sound_arguments::SoundArguments;
use crate::clocks::EmissionArguments;
use crate::units::UnitArguments;

/// Makes a random network and its measurements: pseudoranges.csv, receivers.csv, transmitters.csv, offsets.csv and,
/// where receivers have clocks of their own, clocks.csv; with --sound recordings.
///
/// Lengths are metres; --units gives pseudoranges.csv in another unit, and offsets.csv a column in
/// it.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Number of receivers.
    #[arg(long, default_value_t = 8)]
    pub(super) receivers: usize,
    /// Number of transmitters.
    #[arg(long, default_value_t = 12)]
    pub(super) transmitters: usize,
    /// Standard deviation of the noise, metres.
    #[arg(long, default_value_t = 0.0)]
    pub(super) noise: f64,
    /// Share of outliers among the measurements, 0 to 1; their number is rounded.
    #[arg(long, default_value_t = 0.0)]
    pub(super) outliers: f64,
    /// Largest error of an outlier, metres.
    #[arg(long, default_value_t = 10.0)]
    pub(super) outlier_size: f64,
    /// Share of missing measurements, 0 to 1; their number is rounded.
    #[arg(long, default_value_t = 0.0)]
    pub(super) missing: f64,
    /// Whether the network is in the plane or in space; by default what --layout says, else the
    /// plane.
    #[arg(long, value_name = "2|3", value_parser = clap::value_parser!(u8).range(2..=3))]
    pub(super) dimensions: Option<u8>,
    /// Positions uniform in a room of WIDTHxHEIGHT metres, in space of LENGTHxWIDTHxHEIGHT, or
    /// `normal` for standard normal positions and offsets. 10x10 by default, in space 10x10x3.
    #[arg(long)]
    pub(super) layout: Option<String>,
    /// How receivers stand in the room: anywhere, one after the other along its first side, or at
    /// the points of a grid over its first two.
    #[arg(long, value_enum, default_value = "anywhere")]
    pub(super) shape: Shape,
    /// Each transmitter is heard by this many receivers, the nearest ones; by all if not given.
    #[arg(long, value_name = "RECEIVERS")]
    pub(super) hearing: Option<usize>,
    /// Share of measurements that come by a detour, 0 to 1; their number is rounded.
    #[arg(long, default_value_t = 0.0)]
    pub(super) detours: f64,
    /// Mean length of a detour, metres; lengths are exponentially distributed.
    #[arg(long, default_value_t = 1.0)]
    pub(super) detour_size: f64,
    /// Candidates of each measurement, as of a detector that finds several peaks: further ones are late by --detour-size
    /// in the mean, but the second of outliers and detours is the right one. With 2 or more, pseudoranges.csv is a list
    /// with the columns value, value2, ...
    #[arg(long, default_value_t = 1)]
    pub(super) candidates: usize,
    /// An error of the first receiver in all its measurements: `delay=METRES`, `drift=METRES` from
    /// the first transmitter to the last one, or `move=METRES` after half of the transmitters.
    #[arg(long, value_name = "KIND=METRES")]
    pub(super) fault: Option<String>,
    /// Standard deviation of a constant delay of each recorder, metres: of its clock's offset.
    #[arg(long, default_value_t = 0.0)]
    pub(super) delays: f64,
    /// Standard deviation of the rates of the recorders' clocks, millionths.
    #[arg(long, value_name = "PPM", default_value_t = 0.0)]
    pub(super) rate_sigma: f64,
    /// Receivers that share a recorder, and so a clock.
    #[arg(long, default_value_t = 1)]
    pub(super) channels: usize,
    /// Has transmitters send at times that are uniform over this, metres: seconds times the speed.
    #[arg(long, value_name = "METRES")]
    pub(super) duration: Option<f64>,
    #[command(flatten)]
    pub(super) sending: EmissionArguments,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Threads; accepted everywhere, simulation needs only one.
    #[arg(long)]
    pub(super) threads: Option<usize>,
    #[command(flatten)]
    pub(super) units: UnitArguments,
    #[command(flatten, next_help_heading = "Recordings")]
    pub(super) sound: SoundArguments,
    /// Directory for the files; made if it is not there.
    #[arg(long)]
    pub(super) output: PathBuf,
    /// Replaces the files if they are in the directory already.
    #[arg(long)]
    pub(super) force: bool,
}

/// How receivers stand in the room.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub(super) enum Shape {
    Anywhere,
    Chain,
    Grid,
}
