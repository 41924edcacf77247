//! The options of how recordings are listened to.

use std::path::{Path, PathBuf};

use sound::{ListenOptions, Signal};

use super::heard::Recordings;
use super::speed::{Speed, SpeedArguments};
use crate::Failure;
use crate::provenance::named;

/// Seconds before and after an onset that are kept for pictures: onsets are told to a millisecond or two.
const KEPT: [f64; 2] = [0.006, 0.012];

/// How recordings are listened to.
#[derive(clap::Args)]
pub(crate) struct RecordingArguments {
    /// Each file is of a recorder of its own, which was started by itself and has a clock of its own. Without, all files began
    /// together and have one clock, as those of one recorder.
    #[arg(long)]
    apart: bool,
    /// The files of a further recorder, which was started by itself; once for each recorder. FILES are then those of the first.
    #[arg(long, value_name = "FILE,FILE,...", conflicts_with = "apart")]
    recorder: Vec<String>,
    /// The sound is that of this recording, such as what a loudspeaker was given; claps and other short sounds if not given.
    #[arg(long, value_name = "FILE.wav", conflicts_with = "chirp")]
    template: Option<PathBuf>,
    /// The sound is a chirp from one frequency to another in this time, Hz and seconds.
    #[arg(long, value_name = "FROM,TO,SECONDS", value_delimiter = ',')]
    chirp: Vec<f64>,
    /// Frequencies that are listened to, Hz.
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',')]
    band: Vec<f64>,
    /// Greatest distance of two microphones, metres.
    #[arg(long, value_name = "METRES", default_value_t = ListenOptions::default().events.extent, allow_negative_numbers = true)]
    extent: f64,
    /// How much a sound must be above the noise, dB of amplitude in the band. Lower finds weaker ones, and more that are none.
    #[arg(long, value_name = "DB", allow_negative_numbers = true)]
    threshold: Option<f64>,
    /// How many channels must hear a sound.
    #[arg(long, value_name = "CHANNELS", default_value_t = ListenOptions::default().events.least_channels)]
    least_channels: usize,
    #[command(flatten)]
    air: SpeedArguments,
}

/// Whether a file is a recording, by its name or by how it begins.
fn is_recording(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let named = ending.is_some_and(|ending| ["wav", "wave", "bwf", "rf64", "flac"].contains(&ending.as_str()));
    named || (path.is_file() && sound::Recording::open(path).is_ok())
}

impl RecordingArguments {
    /// Whether the files are recordings, or one is a table.
    ///
    /// # Errors
    /// If one is a recording and another is not, if there are several tables, or a table with options of recordings.
    pub(crate) fn are_of(&self, files: &[PathBuf]) -> Result<bool, Failure> {
        let (recordings, others): (Vec<&PathBuf>, Vec<&PathBuf>) = files.iter().partition(|file| is_recording(file));
        match (&recordings[..], &others[..]) {
            ([_, ..], []) => Ok(true),
            ([_, ..], [other, ..]) => {
                Err(Failure::in_file(other, "is no recording (WAV or FLAC), as the other files are"))
            }
            ([], [_, second, ..]) => {
                let problem = "a table is taken by itself; several files are for recordings (WAV or FLAC)";
                Err(Failure::in_file(second, problem))
            }
            ([], [table]) if self.are_given() || self.air.is_given() => {
                let problem = "is no recording (WAV or FLAC), and the options for these have no meaning for a table";
                Err(Failure::in_file(table, problem))
            }
            ([], _) => Ok(false),
        }
    }

    /// The speed of sound that was `given`, or is that of the temperature, or the usual one.
    pub(crate) fn speed(&self, given: Option<f64>) -> Result<Speed, Failure> {
        self.air.speed(given)
    }

    /// Listens to the files at this speed of sound, with a progress bar; waveforms are kept if `keep`.
    pub(crate) fn listen(
        &self,
        files: &[PathBuf],
        speed: f64,
        keep: bool,
        threads: Option<usize>,
    ) -> Result<Recordings, Failure> {
        Recordings::listen(self.recorders(files), &self.options(speed, keep)?, speed, threads)
    }

    /// Whether an option was given that is of recordings alone.
    fn are_given(&self) -> bool {
        let defaults = ListenOptions::default().events;
        self.apart
            || self.threshold.is_some()
            || self.template.is_some()
            || [self.recorder.is_empty(), self.chirp.is_empty(), self.band.is_empty()].contains(&false)
            || self.extent != defaults.extent
            || self.least_channels != defaults.least_channels
    }

    /// The files that are read beside these.
    pub(crate) fn further_files(&self) -> Vec<PathBuf> {
        self.recorder
            .iter()
            .flat_map(|files| files.split(',').map(PathBuf::from))
            .chain(self.template.clone())
            .collect()
    }

    /// The files of each recorder.
    fn recorders(&self, files: &[PathBuf]) -> Vec<Vec<PathBuf>> {
        if self.apart {
            return files.iter().map(|file| vec![file.clone()]).collect();
        }
        let further = self.recorder.iter().map(|files| files.split(',').map(PathBuf::from).collect());
        std::iter::once(files.to_vec()).chain(further).collect()
    }

    /// How recordings are listened to, at this speed of sound, and whether waveforms are kept.
    fn options(&self, speed: f64, keep: bool) -> Result<ListenOptions, Failure> {
        let signal = match (&self.template, &self.chirp[..]) {
            (Some(path), _) => Signal::read(path).map_err(Failure::unusable)?,
            (None, []) => Signal::Unknown,
            (None, &[from, to, seconds]) => Signal::Chirp { from, to, seconds },
            (None, other) => {
                let problem = format!("--chirp needs three numbers, FROM,TO,SECONDS, not {}", other.len());
                return Err(Failure::Unusable(problem));
            }
        };
        let mut options = ListenOptions::of(signal);
        options.keep = keep.then_some(KEPT);
        match self.band[..] {
            [] => {}
            [low, high] => (options.events.band, options.times.band) = ([low, high], [low, high]),
            ref other => {
                return Err(Failure::Unusable(format!("--band needs two numbers, LOW,HIGH, not {}", other.len())));
            }
        }
        (options.events.extent, options.events.speed) = (self.extent, speed);
        options.events.least_channels = self.least_channels;
        if let Some(decibels) = self.threshold {
            options.events.threshold = 10f64.powf(decibels / 20.0);
        }
        Ok(options)
    }

    /// Names and values of the options that were given.
    pub(crate) fn settings(&self) -> Vec<(String, String)> {
        let numbers = |all: &[f64]| {
            let text = all.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
            Some(text).filter(|_| !all.is_empty())
        };
        [
            named("apart", self.apart.then_some("yes")),
            named("recorder", Some(self.recorder.join(" ")).filter(|_| !self.recorder.is_empty())),
            named("template", self.template.as_ref().map(|path| path.display().to_string())),
            named("chirp", numbers(&self.chirp)),
            named("band", numbers(&self.band)),
            named("extent", Some(self.extent)),
            named("threshold", self.threshold),
            named("least-channels", Some(self.least_channels)),
            named("temperature", self.air.temperature()),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
