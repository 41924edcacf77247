//! A program from its arguments to its exit status, and its options of work over several ranks.

use crate::machine::Machine;
use clap::Parser;
use cli::Failure;
use hc::ranks::{Exchange, Ranks, RanksOptions};
use std::process::ExitCode;

/// A program that several ranks can run together: its arguments, and what it does with them.
pub trait Program: Parser {
    /// Name of the program, before its messages.
    const NAME: &'static str;
    /// A sentence that names the commands several ranks can do; others are refused with it.
    const SHARED: &'static str;

    /// Options about the machine.
    fn machine(&self) -> &Machine;

    /// Options of work over several ranks, where the command has them.
    fn sharing(&self) -> Option<&Sharing>;

    /// Does what was asked for, as one of several ranks if there are others. Rank 0 alone prints, and
    /// writes files.
    ///
    /// # Errors
    /// Why it could not be done.
    fn execute(&self, ranks: Option<&Ranks<'_>>) -> Result<(), Failure>;

    /// What an interrupt leaves.
    fn left(&self) -> &'static str;
}

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

/// Runs a program with the arguments of the process; its exit status.
pub fn main<P: Program>() -> ExitCode {
    #[cfg(feature = "mpi")]
    return crate::world::with(P::NAME, run::<P>);
    // This build knows of no other processes.
    #[cfg(not(feature = "mpi"))]
    run::<P>(None)
}

/// Runs a program, as one of the ranks between which `exchange` carries messages.
fn run<P: Program>(exchange: Option<&dyn Exchange>) -> ExitCode {
    let is_lead = exchange.is_none_or(|exchange| exchange.rank() == 0);
    let program = match P::try_parse() {
        Ok(program) => program,
        Err(error) => {
            if is_lead {
                // Nobody is there to be told that the words cannot be printed.
                let _ = error.print();
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let options = program.sharing().map(Sharing::options);
    let ranks = exchange.map(|exchange| Ranks::new(exchange, &options.clone().unwrap_or_default()));
    let result = if ranks.is_some() && options.is_none() {
        Err(Failure::Unusable(format!("{}; start this without mpirun", P::SHARED)))
    } else {
        program.machine().prepare().and_then(|()| program.execute(ranks.as_ref()))
    };
    if !is_lead {
        // Rank 0 says what there is to be said.
        let failure = result.err().map(|error| error.to_string());
        ranks.inspect(|ranks| ranks.finish(failure.as_deref()));
        return ExitCode::SUCCESS;
    }
    let status = cli::finish(P::NAME, result, program.left());
    ranks.inspect(|ranks| ranks.finish(None));
    status
}
