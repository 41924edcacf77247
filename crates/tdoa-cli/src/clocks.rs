//! Options of clocks.

use tdoa::Emissions;

use crate::provenance::{named, said};

/// What is known of the times at which transmitters send.
#[derive(Clone, Copy, clap::Args)]
pub(crate) struct EmissionArguments {
    /// What is known of the times at which transmitters send: nothing, so that each has an offset (unknown), all but one
    /// constant that they share, such as the delay of a cable or an antenna (constant), or all, so that measurements are
    /// distances (known).
    #[arg(long, value_enum, default_value = "unknown", conflicts_with = "ranges")]
    emissions: Sending,
    /// Short for `--emissions known`: measurements are distances, such as two-way ranges or arrival times less known send
    /// times, and transmitters have no offsets.
    #[arg(long)]
    ranges: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Sending {
    Unknown,
    Constant,
    Known,
}

impl EmissionArguments {
    pub(crate) fn emissions(self) -> Emissions {
        match self.emissions {
            _ if self.ranges => Emissions::Known,
            Sending::Unknown => Emissions::Unknown,
            Sending::Constant => Emissions::Constant,
            Sending::Known => Emissions::Known,
        }
    }

    /// Names and values of the options.
    pub(crate) fn settings(self) -> [Option<(String, String)>; 2] {
        [named("emissions", Some(said(self.emissions))), named("ranges", self.ranges.then_some("yes"))]
    }
}
