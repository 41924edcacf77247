//! Checkpoints of long runs: their options, and how far a run is.

use cli::{Failure, output};
use hc::checkpoint::{Checkpoint, CheckpointOptions};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(next_help_heading = "Long runs")]
pub(crate) struct Recording {
    /// Record what is finished in this directory, so that the run can go on after it was killed.
    #[arg(long, value_name = "DIR")]
    checkpoint: Option<PathBuf>,
    /// Go on with what the directory of --checkpoint has, of the same input and options
    /// (--threads may be another); start from the beginning where it has nothing. The result is that
    /// of a run without interruption.
    #[arg(long, requires = "checkpoint")]
    resume: bool,
    /// End with exit status 2 when the checkpoint cannot be written (a full disk); otherwise this is
    /// said, and the run goes on.
    #[arg(long, requires = "checkpoint")]
    checkpoint_required: bool,
    /// Print as JSON how far the run is that records its work in this directory, and do nothing else.
    #[arg(long, value_name = "DIR", exclusive = true)]
    status: Option<PathBuf>,
}

impl Recording {
    /// The directory whose status is asked for.
    pub(crate) fn status(&self) -> Option<&Path> {
        self.status.as_deref()
    }

    /// A file that is needed unless the status is asked for.
    pub(crate) fn needed<'a>(file: &'a Option<PathBuf>, what: &str) -> Result<&'a Path, Failure> {
        file.as_deref().ok_or_else(|| Failure::Unusable(format!("give the file of {what}")))
    }

    /// The checkpoint that was asked for, if any. What there is to be said about it is said on
    /// standard error.
    pub(crate) fn open(&self) -> Result<Option<Checkpoint>, Failure> {
        let Some(directory) = &self.checkpoint else { return Ok(None) };
        let options = CheckpointOptions::new().resume(self.resume).required(self.checkpoint_required);
        let checkpoint = Checkpoint::open(directory, &options).map_err(|error| match error {
            hc::checkpoint::CheckpointError::Taken(_) => Failure::Unusable(format!("{error} (--resume)")),
            error => Failure::unusable(error),
        })?;
        let place = directory.clone();
        checkpoint.tell(move |note| eprintln!("{}: {note}", place.display()));
        Ok(Some(checkpoint))
    }

    /// The end of a run that was interrupted.
    pub(crate) fn interrupted(&self) -> Failure {
        match &self.checkpoint {
            Some(_) => Failure::Stopped("the result is partial; the same command with --resume goes on".to_owned()),
            None => Failure::Interrupted,
        }
    }
}

/// Prints how far a run is.
pub(crate) fn status(directory: &Path) -> Result<(), Failure> {
    let status = hc::checkpoint::status(directory).map_err(Failure::unusable)?;
    let json = serde_json::to_string_pretty(&status).map_err(Failure::unusable)?;
    output::print(&format!("{json}\n"))
}
