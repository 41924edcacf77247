//! The program as one of several processes, which MPI starts.

#[cfg(feature = "mpi")]
mod carrier;
#[cfg(feature = "mpi")]
mod world;

use hc::ranks::RanksOptions;

#[cfg(feature = "mpi")]
pub(crate) use world::with;

/// Runs the program: this build knows of no other processes.
#[cfg(not(feature = "mpi"))]
pub(crate) fn with(
    work: impl FnOnce(Option<&dyn hc::ranks::Exchange>) -> std::process::ExitCode,
) -> std::process::ExitCode {
    work(None)
}

#[derive(clap::Args)]
#[command(next_help_heading = "Several machines (mpirun)")]
pub(crate) struct Sharing {
    /// After this many seconds paths that another rank has not sent back are given to one more; the
    /// first answer counts. The result does not depend on it.
    #[cfg(feature = "mpi")]
    #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u32).range(1..))]
    rank_timeout: u32,
}

impl Sharing {
    /// The settings that were asked for.
    #[cfg(feature = "mpi")]
    pub(crate) fn options(&self) -> RanksOptions {
        RanksOptions::new().patience(std::time::Duration::from_secs(self.rank_timeout.into()))
    }

    /// The defaults.
    #[cfg(not(feature = "mpi"))]
    pub(crate) fn options(&self) -> RanksOptions {
        RanksOptions::new()
    }
}
