//! Options of clocks.

use std::path::PathBuf;

use tdoa::read::Units;
use tdoa::{Clocks, Emissions, Pseudoranges, ReceiverClocks};

use crate::provenance::{named, said};
use crate::{Failure, input};

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

/// What the clocks of receivers do.
#[derive(clap::Args)]
pub(crate) struct ReceiverClockArguments {
    /// What the clocks of receivers do: all share one (common), each recorder was started by itself (offset), or its clock
    /// runs fast or slow too (rate), where values are readings of that clock. Receivers are a recorder each, but for those
    /// of --recorders and for names such as `rec1:1` and `rec1:2`, which are channels of one. Common if not given, but rate for
    /// recordings of several recorders.
    #[arg(long, value_enum)]
    receiver_clocks: Option<Clock>,
    /// The recorder of each receiver: a line `receiver,recorder` each.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) recorders: Option<PathBuf>,
    /// When each transmitter sends, by a clock that they share: a line `transmitter,time` each, in the unit of the
    /// measurements. With --emissions known the times are those of the receivers' clock too; with --emissions constant an
    /// offset and a rate between both clocks are unknown, as of a pinger that runs by its own.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) times: Option<PathBuf>,
    /// Standard deviation of the recorders' offsets about their mean in metres, where something is known of them.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    clock_sigma: Option<f64>,
    /// Standard deviation of the recorders' rates about their mean in parts in a million, where something is known of them:
    /// 20 for common quartz crystals.
    #[arg(long, value_name = "PPM", allow_negative_numbers = true)]
    rate_sigma: Option<f64>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Clock {
    Common,
    Offset,
    Rate,
}

impl ReceiverClockArguments {
    /// What is unknown of clocks, where `--receiver-delays all` says that receivers are started `apart`, or not, and where
    /// measurements come from recordings of several recorders.
    pub(crate) fn clocks(&self, sending: EmissionArguments, apart: bool, are_recorders: bool) -> Clocks {
        let mut clocks = Clocks::default();
        clocks.emissions = sending.emissions();
        clocks.receivers = match self.receiver_clocks {
            _ if apart => ReceiverClocks::Offset,
            None if are_recorders => ReceiverClocks::Rate,
            None | Some(Clock::Common) => ReceiverClocks::Common,
            Some(Clock::Offset) => ReceiverClocks::Offset,
            Some(Clock::Rate) => ReceiverClocks::Rate,
        };
        (clocks.offset_sigma, clocks.rate_sigma) = (self.clock_sigma, self.rate_sigma.map(|ppm| 1e-6 * ppm));
        clocks
    }

    /// Measurements in these units with the recorders and the send times of the files, if there are any.
    pub(crate) fn recorded(
        &self,
        mut measured: Pseudoranges,
        sending: EmissionArguments,
        units: Units,
    ) -> Result<Pseudoranges, Failure> {
        if let Some(path) = &self.recorders {
            let recorders = input::recorders(path, &measured)?;
            measured = measured.with_recorders(recorders).map_err(Failure::unusable)?;
        }
        if let Some(path) = &self.times {
            if sending.emissions() == Emissions::Unknown {
                return Err(Failure::unusable("--times needs --emissions known or --emissions constant"));
            }
            let times = input::emission_times(path, &measured, units, sending.emissions())?;
            measured = measured.with_emission_times(times).map_err(Failure::unusable)?;
        }
        Ok(measured)
    }

    /// Measurements with a recorder for each receiver, as `--receiver-delays all` says.
    pub(crate) fn apart(&self, measured: Pseudoranges) -> Result<Pseudoranges, Failure> {
        if self.recorders.is_some() || !matches!(self.receiver_clocks, None | Some(Clock::Common)) {
            let problem = "--receiver-delays all is short for --receiver-clocks offset with a recorder for each receiver: give one of both";
            return Err(Failure::Unusable(problem.to_string()));
        }
        let names = measured.receiver_names().to_vec();
        measured.with_recorders(names).map_err(Failure::unusable)
    }

    /// Names and values of the options.
    pub(crate) fn settings(&self) -> [Option<(String, String)>; 5] {
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        [
            named("receiver-clocks", self.receiver_clocks.map(said)),
            named("recorders", path(&self.recorders)),
            named("times", path(&self.times)),
            named("clock-sigma", self.clock_sigma),
            named("rate-sigma", self.rate_sigma),
        ]
    }
}
