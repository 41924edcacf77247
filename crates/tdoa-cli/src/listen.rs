//! `tdoa listen`.

use std::path::{Path, PathBuf};

use cli::files::Files;
use tdoa::html::page;

use crate::recordings::{RecordingArguments, sections};
use crate::{Failure, output};

/// Finds the claps, chirps or other short sounds in recordings, and when each microphone hears them.
///
/// FILES are WAV (also RF64 and BW64) or FLAC, of one channel or many, with any sample rates. --output writes the arrival times as
/// a list (receiver,event,time_s,weight) that `tdoa calibrate --units s` reads; `tdoa calibrate FILES` does both.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The recordings.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    recording: RecordingArguments,
    /// Speed of sound in metres a second; 343 if neither it nor the temperature is given.
    #[arg(long, allow_negative_numbers = true, value_name = "M/S")]
    speed: Option<f64>,
    /// Writes the arrival times as a list; - for standard output instead of the summary.
    #[arg(long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Writes a page with the waveforms of the events.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Writes all that was heard as JSON, with other candidates for each arrival; - for standard output.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
}

impl Arguments {
    fn outputs(&self) -> [(&'static str, Option<&Path>); 3] {
        [("--output", self.output.as_deref()), ("--html", self.html.as_deref()), ("--json", self.json.as_deref())]
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let further = arguments.recording.further_files();
    let files = arguments.files.iter().chain(&further).fold(Files::new(), |files, file| files.reads(Some(file)));
    arguments.outputs().into_iter().fold(files, |files, (option, path)| files.writes(option, path)).check()?;
    let speed = arguments.recording.speed(arguments.speed)?.metres_per_second;
    let found = arguments.recording.listen(&arguments.files, speed, arguments.html.is_some(), arguments.threads)?;
    if let Some(path) = &arguments.output {
        output::text(path, &found.heard.list())?;
    }
    if let Some(path) = &arguments.html {
        output::text(path, &page("What was heard", &sections(&found, &[])?))?;
    }
    if let Some(path) = &arguments.json {
        output::json(path, &found)?;
    }
    let outputs = arguments.outputs().into_iter().filter_map(|(_, path)| path);
    output::summary(outputs, || found.summary())?;
    // What was written says as much.
    found.measured().map(|_| ())
}
