//! From recordings to arrival times.

mod error;

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use crate::events::{ChannelSamples, EventChannel, EventOptions, Events, watched_windows};
use crate::monitor::ListenMonitor;
use crate::recorders::{Alignment, AlignmentOptions, FilesApart, Gathered, OwnEvents, RecorderAlignment};
use crate::signal::Signal;
use crate::survey::ChannelSurvey;
use crate::times::{Arrival, TimeOptions, Window, arrival_times};

pub use error::ListenError;

/// Seconds before an onset that tell the noise, and after it, or after the signal, that are looked at.
const BEFORE: f64 = 0.05;
const AFTER: f64 = 0.05;

/// Most recorders: each two are compared, and each three.
const MOST_RECORDERS: usize = 128;

/// Options of [`listen`].
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ListenOptions {
    /// How events are found.
    pub events: EventOptions,
    /// How their arrival times are taken.
    pub times: TimeOptions,
    /// How recorders are aligned that were started apart.
    pub alignment: AlignmentOptions,
    /// Seconds before and after each onset that are kept in [`Heard::samples`], for pictures: at most 0.05, and after it the length
    /// of a known signal more. Default `None`: nothing is kept.
    pub keep: Option<[f64; 2]>,
}

impl ListenOptions {
    /// The defaults for this signal, in events and times.
    pub fn of(signal: Signal) -> ListenOptions {
        let (mut events, mut times) = (EventOptions::default(), TimeOptions::default());
        (events.signal, times.signal) = (signal.clone(), signal);
        ListenOptions { events, times, ..ListenOptions::default() }
    }
}

/// The arrival times of all events in all channels.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Heard {
    /// The events, the channels of all recorders one after the other, and what was dropped. Times are those of the clock of
    /// the reference, the first recorder that is aligned.
    pub events: Events,
    /// Of each event, the arrival in each channel; `None` where the channel did not hear it. Times are those of the clock of
    /// the channel's own recorder, which is not touched: seconds from the first sample of its recordings.
    pub arrivals: Vec<Vec<Option<Arrival>>>,
    /// Of each channel, the number of its recorder among those that were given, from 0.
    pub recorders: Vec<usize>,
    /// When each recorder was started, and which ones cannot be told: their channels have no arrivals.
    pub alignment: Alignment,
    /// What there is in each channel, as [`survey`](crate::survey) says it.
    pub survey: Vec<ChannelSurvey>,
    /// Files of a recorder that seem not to have begun together.
    #[serde(skip)]
    apart: Vec<FilesApart>,
    /// Of each event, the samples of each channel about its onset, by the clock of the channel's own recorder, if
    /// [`ListenOptions::keep`] asks for them.
    #[serde(skip)]
    pub samples: Vec<Vec<Option<ChannelSamples>>>,
}

/// Finds the sounds in recordings, and when each channel hears them. Each recorder has some files, which began together and
/// have one clock: files into which a recording was split are joined before. Recorders may have been started apart, and each
/// clock have its own rate. Where there are several, they are aligned by the sounds that they have in common, to tell which
/// sounds are the same; arrival times are not changed by that. Each file is read twice, block by block; the first reading also
/// gives [`Heard::survey`].
///
/// # Errors
/// If an option is out of range, a recorder has no files, there are more than 128, or a file cannot be read. A recorder that
/// cannot be aligned is no error: [`Heard::alignment`] names it.
///
/// ```
/// let mut options = sound::RoomOptions::default();
/// options.sources = sound::Placement::Random(3);
/// let made = sound::simulate_room(&options)?;
/// # let folder = std::env::temp_dir().join(format!("sound-listen-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("claps.wav");
/// sound::write_wav(&path, made.sample_rate, &made.channels, sound::SampleFormat::Int24)?;
///
/// // One recorder, which has one file.
/// let heard = sound::listen(&[vec![&path]], &sound::ListenOptions::default())?;
/// assert_eq!((heard.arrivals.len(), heard.arrivals[0].len()), (3, 8));
/// // A list that `tdoa calibrate --units s` reads.
/// assert!(heard.list().starts_with("receiver,event,time_s,weight\nclaps:1,1,"));
/// # std::fs::remove_dir_all(folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn listen<P: AsRef<Path>>(recorders: &[Vec<P>], options: &ListenOptions) -> Result<Heard, ListenError> {
    listen_watched(recorders, options, &ListenMonitor::default())
}

/// [`listen`], watched by a monitor that tells how far it is, and may stop it.
///
/// # Errors
/// Those of [`listen`], or [`ListenError::Stopped`] if the monitor stops it: there is nothing of what was heard by then.
pub fn listen_watched<P: AsRef<Path>>(
    recorders: &[Vec<P>],
    options: &ListenOptions,
    monitor: &ListenMonitor,
) -> Result<Heard, ListenError> {
    options.times.validate()?;
    if let Some(number) = (1..).zip(recorders).find_map(|(number, files)| files.is_empty().then_some(number)) {
        return Err(ListenError::NoFiles { number });
    }
    if recorders.len() > MOST_RECORDERS {
        return Err(ListenError::TooManyRecorders { found: recorders.len(), most: MOST_RECORDERS });
    }
    let gathered = Gathered::new(recorders, &options.events, &options.alignment, monitor)?;
    // Each recorder reads the same events, by its own clock.
    let own: Vec<OwnEvents<'_>> = gathered.own();
    let mut readers = Vec::with_capacity(own.len());
    for own in &own {
        let files = recorders.get(own.clock.recorder).into_iter().flatten();
        readers.push(watched_windows(files, &own.events, monitor)?);
    }
    let (mut arrivals, mut samples) = (Vec::with_capacity(gathered.events.events.len()), Vec::new());
    for j in 0..gathered.events.events.len() {
        if monitor.is_stopped() {
            return Err(ListenError::Stopped);
        }
        let mut parts: Vec<Option<Part<'_>>> = gathered.recorders.iter().map(|_| None).collect();
        for (own, reader) in own.iter().zip(&mut readers) {
            let Some(samples) = reader.next().transpose()? else { continue };
            let onsets = own.events.events.get(j).into_iter().flat_map(|event| &event.onsets);
            for ((&channel, samples), onset) in own.channels.iter().zip(samples.channels).zip(onsets) {
                parts[channel] = onset.map(|onset| Part { clock: own.clock, samples, onset: onset.seconds });
            }
        }
        let signal = &options.times.signal;
        let windows: Vec<Option<Window<'_>>> = parts.iter().map(|part| part.as_ref()?.window(signal)).collect();
        let found = arrival_times(&windows, &options.times)?;
        let arrival = |(arrival, part): (Option<Arrival>, &Option<Part<'_>>)| Some(part.as_ref()?.own(arrival?));
        arrivals.push(found.into_iter().zip(&parts).map(arrival).collect());
        if let Some(keep) = options.keep {
            samples.push(parts.iter().map(|part| part.as_ref()?.kept(keep)).collect());
        }
    }
    monitor.finish();
    let Gathered { events, recorders, alignment, survey, apart } = gathered;
    Ok(Heard { events, arrivals, recorders, alignment, survey, apart, samples })
}

/// The part of a channel in which an event is.
struct Part<'a> {
    clock: &'a RecorderAlignment,
    samples: ChannelSamples,
    /// By the clock of the recorder, seconds.
    onset: f64,
}

impl Part<'_> {
    /// What is compared with other channels, by the clock of the reference.
    fn window(&self, signal: &Signal) -> Option<Window<'_>> {
        let (seconds, samples) = self.about([BEFORE, AFTER + signal.seconds()])?;
        let sample_rate = self.clock.sample_rate(f64::from(self.samples.sample_rate));
        Some(Window { samples, start: self.clock.common(seconds), sample_rate })
    }

    /// What is kept for pictures: the samples from so long before the onset to so long after it.
    fn kept(&self, around: [f64; 2]) -> Option<ChannelSamples> {
        let (seconds, samples) = self.about(around)?;
        Some(ChannelSamples { seconds, sample_rate: self.samples.sample_rate, samples: samples.to_vec() })
    }

    /// The samples from so long before the onset to so long after it, as far as there are any, and when they begin.
    fn about(&self, [before, after]: [f64; 2]) -> Option<(f64, &[f32])> {
        let ChannelSamples { seconds, sample_rate, samples } = &self.samples;
        let (rate, onset) = (f64::from(*sample_rate), self.onset - seconds);
        // Beyond what there is, a cast ends at its bounds.
        let begin = ((onset - before) * rate) as usize;
        let end = (((onset + after) * rate) as usize).min(samples.len());
        Some((seconds + begin as f64 / rate, samples.get(begin..end)?))
    }

    /// The arrival by the recorder's own clock, from one by that of the reference.
    fn own(&self, arrival: Arrival) -> Arrival {
        let own = |seconds: f64| self.clock.own(seconds);
        let alternatives = arrival.alternatives.into_iter().map(own).collect();
        Arrival { seconds: own(arrival.seconds), alternatives, ..arrival }
    }
}

impl Heard {
    /// A name for each channel: that of its file, without the folder and the ending, and the number of the channel.
    /// Files of one name have their place among all files before it.
    pub fn names(&self) -> Vec<String> {
        // Each file has a first channel; one that is given twice is two.
        let is_first = |channel: &&EventChannel| channel.channel == 1;
        let files = told_apart(self.events.channels.iter().filter(is_first).map(|channel| channel.file.as_str()));
        let mut file = 0;
        let name = |channel: &EventChannel| {
            file += usize::from(channel.channel == 1);
            let name = file.checked_sub(1).and_then(|file| files.get(file)).map_or("", String::as_str);
            format!("{name}:{}", channel.channel)
        };
        self.events.channels.iter().map(name).collect()
    }

    /// A name for the recorder of each channel: that of its first file, without the folder and the ending. Recorders of one
    /// name have their number before it.
    pub fn recorder_names(&self) -> Vec<String> {
        let firsts = (0..=self.recorders.iter().copied().max().unwrap_or(0))
            .filter_map(|recorder| self.recorders.iter().position(|&owner| owner == recorder));
        let names = told_apart(firsts.filter_map(|k| Some(self.events.channels.get(k)?.file.as_str())));
        self.recorders.iter().map(|&recorder| names.get(recorder).cloned().unwrap_or_default()).collect()
    }

    /// What may be wrong, in words: with channels, with files of a recorder that seem not to have begun together, with
    /// recorders that cannot be aligned, and sounds that were left out.
    pub fn warnings(&self) -> Vec<String> {
        let of_channel = |(name, channel): (String, &ChannelSurvey)| {
            channel.problems().into_iter().map(move |problem| format!("channel {name} {problem}"))
        };
        let mut all: Vec<String> = self.names().into_iter().zip(&self.survey).flat_map(of_channel).collect();
        all.extend(self.apart.iter().map(ToString::to_string));
        all.extend(self.alignment.unaligned.iter().map(ToString::to_string));
        all.extend(self.events.dropped.iter().map(ToString::to_string));
        all
    }

    /// How many sounds were heard, in words.
    pub fn counts(&self) -> String {
        let onsets: usize = self.events.channels.iter().map(|channel| channel.heard).sum();
        format!(
            "{} channels heard {onsets} sounds; {} events with {} arrivals, {} sounds left out",
            self.events.channels.len(),
            self.arrivals.len(),
            self.arrivals.iter().flatten().flatten().count(),
            self.events.dropped.len()
        )
    }

    /// A table of the arrivals, one a line: `receiver,event,time_s,weight`, with [names](Heard::names) of channels, numbers
    /// of events from 1, and seconds by the clock of the channel's recorder. The weight is one over the square of the standard
    /// deviation in microseconds: that of one arrival beside another is known better than the factor that all have in common,
    /// which a calibration can tell. Of several recorders there is a further column
    /// `recorder` with their [names](Heard::recorder_names).
    pub fn list(&self) -> String {
        let (names, recorders) = (self.names(), self.recorder_names());
        let are_several = self.recorders.iter().any(|&recorder| recorder > 0);
        let mut text = String::from("receiver,event,time_s,weight");
        text += if are_several { ",recorder\n" } else { "\n" };
        for (j, arrivals) in self.arrivals.iter().enumerate() {
            for ((name, recorder), arrival) in names.iter().zip(&recorders).zip(arrivals) {
                if let Some(Arrival { seconds, sigma, .. }) = arrival {
                    // Writing to a string does not fail.
                    let _ = write!(text, "{name},{},{seconds:.9},{:.3e}", j + 1, (1e6 * sigma).powi(-2));
                    let _ = if are_several { writeln!(text, ",{recorder}") } else { writeln!(text) };
                }
            }
        }
        text
    }
}

/// Names of files without the folder and the ending; where two are the same, with their place, from 1, before them.
fn told_apart<'a>(files: impl Iterator<Item = &'a str>) -> Vec<String> {
    let stem = |file: &str| Path::new(file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into());
    let stems: Vec<String> = files.map(|file| stem(file).replace([',', '"', '\n'], " ")).collect();
    let are_told = stems.iter().collect::<HashSet<_>>().len() == stems.len();
    let name = |(place, stem): (usize, String)| if are_told { stem } else { format!("{place} {stem}") };
    (1..).zip(stems).map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::{ListenOptions, listen};
    use crate::{Placement, RoomOptions, SampleFormat, Signal, Sound, simulate_room, write_wav};

    #[test]
    fn claps_are_heard_to_microseconds() {
        let folder = tempfile::tempdir().unwrap();
        let mut options = RoomOptions::default();
        (options.microphones, options.sources) = (Placement::Random(10), Placement::Random(8));
        (options.signal_to_noise, options.seed) = (Some(20.0), 5);
        let made = simulate_room(&options).unwrap();
        // Two files of five channels each.
        let paths = ["left.wav", "right.wav"].map(|name| folder.path().join(name));
        for (path, channels) in paths.iter().zip(made.channels.chunks(5)) {
            write_wav(path, made.sample_rate, channels, SampleFormat::Int16).unwrap();
        }
        let options = ListenOptions { keep: Some([0.002, 0.008]), ..ListenOptions::default() };
        let heard = listen(&[paths.to_vec()], &options).unwrap();
        assert_eq!((heard.arrivals.len(), heard.events.dropped.len()), (8, 0));
        let kept = heard.samples[3][9].as_ref().unwrap();
        let onset = heard.events.events[3].onsets[9].unwrap().seconds;
        assert!(kept.samples.len().abs_diff(480) <= 1 && (kept.seconds - onset + 0.002).abs() < 3e-5);
        assert_eq!(heard.names()[4..6], ["left:5", "right:1"]);
        let mut twice = heard.clone();
        twice.events.channels[5..]
            .iter_mut()
            .for_each(|channel| channel.file.clone_from(&heard.events.channels[0].file));
        assert_eq!(twice.names()[4..6], ["1 left:5", "2 left:1"]);
        let mut errors = Vec::new();
        for (j, arrivals) in heard.arrivals.iter().enumerate() {
            let late = arrivals.iter().zip(&made.truth.arrivals);
            let late: Vec<f64> = late.map(|(found, truth)| found.as_ref().unwrap().seconds - truth[j]).collect();
            let mut sorted = late.clone();
            sorted.sort_by(f64::total_cmp);
            errors.extend(late.into_iter().map(|late| (late - sorted[5]).abs()));
        }
        errors.sort_by(f64::total_cmp);
        // What brings a network to millimetres: 98 % within 30 us, half within 2.
        assert!(errors[78] < 30e-6 && errors[40] < 2e-6, "{} {}", errors[78], errors[40]);
        assert_eq!(heard.list().lines().count(), 81);
        assert_eq!(heard.counts(), "10 channels heard 80 sounds; 8 events with 80 arrivals, 0 sounds left out");
        assert_eq!(heard.survey, crate::survey(&paths).unwrap());
        assert!(heard.warnings().is_empty());
        let mut heard = heard;
        (heard.survey[3].is_constant, heard.survey[7].clipped) = (true, 0.02);
        let warnings = heard.warnings();
        assert!(
            warnings[0].starts_with("channel left:4 is silent") && warnings[1].contains("right:3 is clipped in 2.0 %")
        );
        let json = serde_json::to_value(&heard).unwrap();
        assert_eq!(json["arrivals"].as_array().unwrap().len(), 8);
        let arrival = &json["arrivals"][7][9];
        assert!(arrival["seconds"].is_f64() && arrival["sigma"].is_f64() && arrival["alternatives"].is_array());
    }

    /// Another room for each condition, of ten microphones and eight chirps; the truth is that of the beginning, not only of
    /// differences.
    #[test]
    fn chirps_in_noise_are_heard_to_microseconds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chirps.wav");
        let template = folder.path().join("played.wav");
        let samples: Vec<f32> =
            (0..4410).map(|k| crate::signal::chirp(f64::from(k) / 44_100.0, 1000.0, 6000.0, 0.1) as f32).collect();
        write_wav(&template, 44_100, &[samples], SampleFormat::Int16).unwrap();
        for (seed, length, signal_to_noise) in [(0, 0.05, 0.0), (1, 0.2, -5.0), (2, 0.5, -5.0), (3, 0.1, 0.0)] {
            let (from, to) = (1000.0, 6000.0);
            let mut options = RoomOptions { sound: Sound::Chirp { from, to, length }, seed, ..RoomOptions::default() };
            (options.microphones, options.sources) = (Placement::Random(10), Placement::Random(8));
            options.signal_to_noise = Some(signal_to_noise);
            let made = simulate_room(&options).unwrap();
            write_wav(&path, made.sample_rate, &made.channels, SampleFormat::Int16).unwrap();
            let signal = match seed {
                3 => Signal::read(&template).unwrap(),
                _ => Signal::Chirp { from, to, seconds: length },
            };
            let heard = listen(&[vec![&path]], &ListenOptions::of(signal)).unwrap();
            assert_eq!((heard.arrivals.len(), heard.events.dropped.len()), (8, 0));
            let found = heard.arrivals.iter().enumerate();
            let found = found.flat_map(|(j, all)| all.iter().zip(&made.truth.arrivals).map(move |(a, t)| (a, t[j])));
            let mut errors: Vec<f64> =
                found.filter_map(|(found, truth)| Some((found.as_ref()?.seconds - truth).abs())).collect();
            errors.sort_by(f64::total_cmp);
            let (count, near) = (errors.len(), errors.iter().filter(|error| **error < 30e-6).count());
            let said = format!("{length} s: {near} of {count}, median {:e}", errors[count / 2]);
            assert!(count >= 72 && near * 100 >= 98 * count && errors[count / 2] < 5e-6, "{said}");
        }
    }

    /// A loudspeaker is carried through the room, and chirps once a second.
    #[test]
    fn chirps_of_a_moving_source_are_heard_to_microseconds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chirps.wav");
        let (from, to, length) = (1000.0, 6000.0, 0.2);
        let mut options = RoomOptions { sound: Sound::Chirp { from, to, length }, seed: 80, ..RoomOptions::default() };
        let on_line = |k: u8| [1.0 + 0.6 * f64::from(k), 1.0 + 0.4 * f64::from(k), 1.5];
        options.microphones = Placement::Random(10);
        options.sources = Placement::Given((0..10).map(on_line).collect());
        (options.interval, options.jitter, options.signal_to_noise) = (1.0, 0.0, Some(0.0));
        let made = simulate_room(&options).unwrap();
        write_wav(&path, made.sample_rate, &made.channels, SampleFormat::Int16).unwrap();
        let heard = listen(&[vec![&path]], &ListenOptions::of(Signal::Chirp { from, to, seconds: length })).unwrap();
        assert_eq!((heard.arrivals.len(), heard.events.dropped.len()), (10, 0));
        let near = |(j, k): &(usize, usize)| {
            let found = heard.arrivals[*j][*k].as_ref();
            found.is_some_and(|found| (found.seconds - made.truth.arrivals[*k][*j]).abs() < 30e-6)
        };
        let count = (0..10).flat_map(|j| (0..10).map(move |k| (j, k))).filter(near).count();
        assert!(count >= 98, "{count} of 100");
    }
}
