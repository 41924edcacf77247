//! Events are found.

use std::path::Path;

use crate::monitor::ListenMonitor;
use crate::recording::{BLOCK, Recording};
use crate::survey::{FileSurvey, Surveys};

use super::error::EventError;
use super::event::{EventChannel, Events, Onset};
use super::file::file_onsets;
use super::grouping::{Grouped, group};
use super::options::EventOptions;

/// Finds sounds in recordings that began together and have one clock, such as the files of one recorder: a pass over each
/// file, block by block. Channels are numbered over all files in their order; sample rates and lengths may differ.
///
/// In each channel a sound begins where, within 5 ms, the level in the band rises over the threshold and to twice what it
/// was in the 50 ms before. Onsets within the time that sound takes over the extent are one event, if enough channels have
/// one. Two sounds must be further apart than the dead time. A sound in the first 50 ms of a recording is not found.
///
/// # Errors
/// If an option is out of its range, there are too few channels, a sample rate is too low for the band, or a file cannot be
/// read.
///
/// ```
/// let mut options = sound::RoomOptions::default();
/// options.sources = sound::Placement::Random(3);
/// let simulated = sound::simulate_room(&options)?;
/// # let folder = std::env::temp_dir().join(format!("sound-events-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("claps.wav");
/// sound::write_wav(&path, 48000, &simulated.channels, sound::SampleFormat::Int24)?;
///
/// let found = sound::find_events([&path], &sound::EventOptions::default())?;
/// assert_eq!(found.events.len(), 3);
/// for samples in sound::event_windows([&path], &found)? {
///     let samples = samples?;
///     let event = &found.events[samples.event];
///     println!("{:.3} s: {} samples", event.seconds, samples.channels[0].samples.len());
/// }
/// for dropped in &found.dropped {
///     eprintln!("{dropped}");
/// }
/// # std::fs::remove_dir_all(folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find_events<P: AsRef<Path>>(
    paths: impl IntoIterator<Item = P>,
    options: &EventOptions,
) -> Result<Events, EventError> {
    let (channels, onsets) = hear(paths, options, &ListenMonitor::default(), None)?;
    Ok(events_of(channels, &onsets, options))
}

/// The channels of all files, and the onsets of each: a pass over each file. The monitor expects as many samples in a
/// second pass. What there is in the files is added to `surveys`, if these are there.
///
/// # Errors
/// Those of [`find_events`], or if the monitor stops the reading.
pub(crate) fn hear<P: AsRef<Path>>(
    paths: impl IntoIterator<Item = P>,
    options: &EventOptions,
    monitor: &ListenMonitor,
    mut surveys: Option<&mut Surveys>,
) -> Result<(Vec<EventChannel>, Vec<Vec<Onset>>), EventError> {
    options.validate()?;
    // All are opened first: what is wrong with the last one is said before the first one is read.
    let mut recordings = Recording::open_all(paths)?;
    let found = recordings.iter().map(Recording::channels).sum();
    if recordings.is_empty() {
        return Err(EventError::NoRecordings);
    }
    if found < options.least_channels {
        return Err(EventError::Channels { found, least: options.least_channels });
    }
    let (mut channels, mut onsets): (Vec<EventChannel>, Vec<Vec<Onset>>) = (Vec::new(), Vec::new());
    monitor.begin(recordings.iter().map(samples_twice).fold(0, u64::saturating_add));
    recordings.iter_mut().for_each(|recording| recording.watch(monitor));
    for mut recording in recordings {
        let (expected, before) = (samples_twice(&recording), monitor.progress().done);
        let mut survey = surveys.is_some().then(|| FileSurvey::new(&recording));
        let look = |block: &[Vec<f32>]| survey.iter_mut().for_each(|survey| survey.add(block));
        let heard = file_onsets(&mut recording, options, BLOCK, look)?;
        if let (Some(surveys), Some(survey)) = (&mut surveys, &survey) {
            surveys.push(&recording, survey);
        }
        // A header may not say how many samples there are, or too many.
        monitor.correct(expected, (monitor.progress().done - before).saturating_mul(2));
        for (of_channel, number) in heard.channels.into_iter().zip(1..) {
            channels.push(EventChannel {
                file: heard.file.clone(),
                channel: number,
                sample_rate: heard.sample_rate,
                heard: of_channel.len(),
                used: 0,
                echoes: 0,
                dropped: 0,
            });
            onsets.push(of_channel);
        }
    }
    Ok((channels, onsets))
}

/// How many samples are read of all channels in two passes, as far as it is known.
fn samples_twice(recording: &Recording) -> u64 {
    recording.frames().unwrap_or(0).saturating_mul(2 * recording.channels() as u64)
}

/// The events of these channels, whose onsets are by one clock.
pub(crate) fn events_of(mut channels: Vec<EventChannel>, onsets: &[Vec<Onset>], options: &EventOptions) -> Events {
    let Grouped { events, dropped, uses } = group(onsets, options);
    for (channel, (used, echoes)) in channels.iter_mut().zip(uses) {
        (channel.used, channel.echoes) = (used, echoes);
        channel.dropped = channel.heard.saturating_sub(used + echoes);
    }
    Events { events, channels, dropped }
}
