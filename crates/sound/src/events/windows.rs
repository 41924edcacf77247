//! The samples of each event, by a second reading of the recordings.

use std::ops::Range;
use std::path::Path;
use std::slice;

use crate::error::ReadError;
use crate::monitor::ListenMonitor;
use crate::recording::{BLOCK, Recording};

use super::error::EventError;
use super::event::{Event, EventChannel, Events};

/// The samples around an event.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EventSamples {
    /// Number of the event among [`Events::events`], from 0.
    pub event: usize,
    /// The channels of all files, as in [`Events::channels`].
    pub channels: Vec<ChannelSamples>,
}

/// The samples of a channel around an event.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ChannelSamples {
    /// When the first of the samples is taken, seconds from the first sample of the recording.
    pub seconds: f64,
    /// Samples per second, Hz.
    pub sample_rate: u32,
    /// All samples in the window of the event; fewer, or none, where the file has ended.
    pub samples: Vec<f32>,
}

/// Reads recordings a second time, and gives the samples of one event after the other, in their windows. `paths` are those
/// in which the events were found. No more than one event and one block of each file are held.
///
/// # Errors
/// If a file cannot be read, or is not the one in which the events were found. Each item may be an error too: if a file is
/// damaged, or the events are not in their order. After an error there are no more items.
pub fn event_windows<P: AsRef<Path>>(
    paths: impl IntoIterator<Item = P>,
    events: &Events,
) -> Result<EventWindows<'_>, EventError> {
    watched_windows(paths, events, &ListenMonitor::default())
}

/// [`event_windows`], watched.
///
/// # Errors
/// Those of [`event_windows`]. An item is an error also if the monitor stops the reading.
pub(crate) fn watched_windows<'a, P: AsRef<Path>>(
    paths: impl IntoIterator<Item = P>,
    events: &'a Events,
    monitor: &ListenMonitor,
) -> Result<EventWindows<'a>, EventError> {
    let mut files = Recording::open_all(paths)?;
    files.iter_mut().for_each(|recording| recording.watch(monitor));
    same_files(&files, &events.channels)?;
    let files = files.into_iter().map(|recording| File { recording, place: 0, block: Vec::new() }).collect();
    Ok(EventWindows { files, events: events.events.iter(), event: 0, end: f64::NEG_INFINITY })
}

/// Checks that channels and sample rates of the files are what they were.
fn same_files(files: &[Recording], channels: &[EventChannel]) -> Result<(), EventError> {
    let name = |file: &Recording| (file.file().to_owned(), file.sample_rate());
    let found = files.iter().flat_map(|file| (1..=file.channels()).map(move |number| (file, number)));
    let mut expected = channels.iter();
    for ((file, number), channel) in found.zip(1..) {
        let same = |other: &EventChannel| other.sample_rate == file.sample_rate() && other.channel == number;
        if !expected.next().is_some_and(same) {
            let (file, sample_rate) = name(file);
            return Err(EventError::OtherFiles { file, channel, sample_rate });
        }
    }
    match expected.next() {
        None => Ok(()),
        Some(missing) => {
            let channel = channels.len() - expected.len();
            Err(EventError::OtherFiles {
                file: "the end of the list".into(),
                channel,
                sample_rate: missing.sample_rate,
            })
        }
    }
}

/// The samples of one event after the other; made by [`event_windows`].
pub struct EventWindows<'a> {
    files: Vec<File>,
    events: slice::Iter<'a, Event>,
    /// Number of the next event.
    event: usize,
    /// Where the last window has ended, seconds.
    end: f64,
}

impl Iterator for EventWindows<'_> {
    type Item = Result<EventSamples, EventError>;

    fn next(&mut self) -> Option<Self::Item> {
        let window = self.events.next()?.window.clone();
        let event = self.event;
        self.event += 1;
        let samples = self.read(event, window);
        if samples.is_err() {
            self.events = [].iter();
        }
        Some(samples)
    }
}

impl EventWindows<'_> {
    fn read(&mut self, event: usize, window: Range<f64>) -> Result<EventSamples, EventError> {
        let Range { start: begin, end } = window;
        // Written so that numbers that are none are refused.
        if !(begin >= self.end.max(0.0) && end >= begin && end.is_finite()) {
            return Err(EventError::Order { event: event + 1, begin, end });
        }
        self.end = end;
        let mut channels = Vec::new();
        for file in &mut self.files {
            file.read(begin, end, &mut channels)?;
        }
        Ok(EventSamples { event, channels })
    }
}

/// A file that is being read.
struct File {
    recording: Recording,
    /// Number of the next sample.
    place: u64,
    block: Vec<Vec<f32>>,
}

impl File {
    /// Adds the samples of each channel from `begin` to before `end`, seconds, none of which have been read.
    fn read(&mut self, begin: f64, end: f64, channels: &mut Vec<ChannelSamples>) -> Result<(), ReadError> {
        let sample_rate = self.recording.sample_rate();
        let number = |seconds: f64| (seconds * f64::from(sample_rate)).ceil() as u64;
        let (first, last) = (number(begin), number(end));
        while self.place < first && self.block(first)? > 0 {}
        let mut samples = vec![Vec::new(); self.recording.channels()];
        while self.place < last && self.block(last)? > 0 {
            for (all, block) in samples.iter_mut().zip(&self.block) {
                all.extend_from_slice(block);
            }
        }
        let seconds = first as f64 / f64::from(sample_rate);
        channels.extend(samples.into_iter().map(|samples| ChannelSamples { seconds, sample_rate, samples }));
        Ok(())
    }

    /// Reads the next block, up to before this sample, and says how many samples it has.
    fn block(&mut self, end: u64) -> Result<usize, ReadError> {
        let left = usize::try_from(end - self.place).unwrap_or(BLOCK).min(BLOCK);
        let count = self.recording.read_block(left, &mut self.block)?;
        self.place += count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::events::{EventOptions, find_events};
    use crate::room::{Placement, RoomOptions, simulate_room};
    use crate::write::{SampleFormat, write_wav};

    #[test]
    fn a_monitor_stops_the_second_reading() {
        let room = RoomOptions { sources: Placement::Random(3), ..RoomOptions::default() };
        let made = simulate_room(&room).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("claps.wav");
        write_wav(&path, made.sample_rate, &made.channels, SampleFormat::Int16).unwrap();
        let events = find_events([&path], &EventOptions::default()).unwrap();
        let monitor = ListenMonitor::default();
        let mut windows = watched_windows([&path], &events, &monitor).unwrap();
        assert!(windows.next().is_some_and(|samples| samples.is_ok()));
        // Up to the end of the first window, of all channels.
        let frames = (events.events[0].window.end * 48_000.0).ceil() as u64;
        assert_eq!(monitor.progress().done, frames * made.channels.len() as u64);
        monitor.stop();
        let stopped = |item| matches!(item, Some(Err(EventError::Read(ReadError::Stopped))));
        assert!(stopped(windows.next()) && windows.next().is_none());
    }
}
