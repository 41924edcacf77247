//! Options of work over several ranks.

use hc::ranks::RanksOptions;

/// Options of a command that several ranks can do together; none in a build without MPI.
#[derive(clap::Args)]
#[command(next_help_heading = "Several machines (mpirun)")]
pub struct Sharing {
    /// After this many seconds work that another rank has not sent back is given to one more; the
    /// first answer counts. The result does not depend on it.
    #[cfg(feature = "mpi")]
    #[arg(long, global = true, value_name = "SECONDS", default_value_t = 600)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    rank_timeout: u32,
}

impl Sharing {
    /// The settings that were asked for.
    #[cfg(feature = "mpi")]
    pub fn options(&self) -> RanksOptions {
        RanksOptions::new().patience(std::time::Duration::from_secs(self.rank_timeout.into()))
    }

    /// The defaults.
    #[cfg(not(feature = "mpi"))]
    pub fn options(&self) -> RanksOptions {
        RanksOptions::new()
    }
}
