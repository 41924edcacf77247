//! What was heard in recordings, and its words.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use serde::Serialize;
use sound::{Heard, ListenError, ListenMonitor, ListenOptions, listen_watched};
use tdoa::Pseudoranges;
use tdoa::read::{self, Units};

use crate::{Failure, interrupt};

/// What was heard in recordings.
#[derive(Serialize)]
pub(crate) struct Recordings {
    /// Name of each channel.
    pub(super) names: Vec<String>,
    /// The speed of sound that was taken, metres per second.
    pub(super) speed: f64,
    #[serde(flatten)]
    pub(crate) heard: Heard,
    /// The files of each recorder.
    #[serde(skip)]
    pub(super) files: Vec<Vec<PathBuf>>,
}

impl Recordings {
    /// Listens to the files of each recorder, with a progress bar; an interrupt ends it.
    pub(super) fn listen(
        files: Vec<Vec<PathBuf>>,
        options: &ListenOptions,
        speed: f64,
        threads: Option<usize>,
    ) -> Result<Recordings, Failure> {
        let interrupted = interrupt::watch()?;
        let monitor = ListenMonitor::asking(|_| interrupted.load(Ordering::Relaxed));
        let describe = || {
            let progress = monitor.progress();
            (progress.done, progress.total, "samples are read".to_string())
        };
        let heard = cli::bar::while_shown(threads, describe, || listen_watched(&files, options, &monitor))?;
        let heard = heard.map_err(|error| match error {
            ListenError::Stopped => Failure::Interrupted,
            error => Failure::unusable(error),
        })?;
        Ok(Recordings { names: heard.names(), speed, heard, files })
    }

    /// Says what was heard, and what is wrong with it.
    pub(crate) fn tell(&self) {
        eprintln!("note: {}", self.counts());
        self.warnings().iter().for_each(|warning| eprintln!("note: {warning}"));
    }

    /// Whether there are several recorders, each with a clock of its own.
    pub(crate) fn are_apart(&self) -> bool {
        self.files.len() > 1
    }

    /// The speed of sound, metres per second.
    pub(crate) fn speed(&self) -> f64 {
        self.speed
    }

    /// The arrival times as measurements.
    pub(crate) fn measured(&self) -> Result<Pseudoranges, Failure> {
        if self.heard.arrivals.is_empty() {
            return Err(Failure::Undetermined(format!("no sound was heard by enough channels: {}", self.counts())));
        }
        let options = Units::Seconds { speed: self.speed };
        read::read_csv(self.heard.list().as_bytes(), "what was heard", options).map_err(Failure::unusable)
    }

    /// What is wrong with channels, sounds that were left out, and recorders that cannot be told.
    pub(super) fn warnings(&self) -> Vec<String> {
        self.heard.warnings()
    }

    /// How many sounds were heard, in words.
    pub(super) fn counts(&self) -> String {
        self.heard.counts()
    }

    /// The table of the channels: headings, whether these are of text, and rows.
    pub(super) fn channels(&self) -> ([(&'static str, bool); 8], Vec<Vec<String>>) {
        let headings = ["channel", "seconds", "Hz", "peak", "heard", "used", "echoes", "left out"];
        let rows = self.names.iter().zip(&self.heard.survey).zip(&self.heard.events.channels).map(
            |((name, survey), heard)| {
                let counts = [heard.heard, heard.used, heard.echoes, heard.dropped].map(|count| count.to_string());
                let of_file =
                    [format!("{:.1}", survey.seconds), survey.sample_rate.to_string(), format!("{:.3}", survey.peak)];
                [vec![name.clone()], of_file.to_vec(), counts.to_vec()].concat()
            },
        );
        (headings.map(|heading| (heading, heading == "channel")), rows.collect())
    }

    /// The summary of what was heard.
    pub(crate) fn summary(&self) -> String {
        let (headings, rows) = self.channels();
        let mut text = format!("{}\nspeed of sound {:.1} m/s\n\n", self.counts(), self.speed);
        let wide = rows.iter().map(|row| row[0].chars().count()).max().unwrap_or(0).max(headings[0].0.len());
        let mut line = |cells: &[&str]| {
            text += &format!("{:<wide$}", cells[0]);
            cells[1..].iter().for_each(|cell| text += &format!(" {cell:>9}"));
            text += "\n";
        };
        line(&headings.map(|(heading, _)| heading));
        rows.iter().for_each(|row| line(&row.iter().map(String::as_str).collect::<Vec<_>>()));
        text += &self.recorders();
        for warning in self.warnings() {
            text += &format!("\nwarning: {warning}");
        }
        text + if self.warnings().is_empty() { "" } else { "\n" }
    }

    /// When recorders were started, where there are several.
    pub(super) fn recorders(&self) -> String {
        if !self.are_apart() {
            return String::new();
        }
        let names = self.heard.recorder_names();
        let line = |aligned: &sound::RecorderAlignment| {
            let place = self.heard.recorders.iter().position(|recorder| *recorder == aligned.recorder);
            let name = place.and_then(|place| names.get(place)).map_or("", String::as_str);
            format!("{name} started at {:.3} s and runs {:+.1} ppm fast, about\n", aligned.start, aligned.rate)
        };
        let lines: String = self.heard.alignment.recorders.iter().map(line).collect();
        format!("\n{lines}")
    }
}
