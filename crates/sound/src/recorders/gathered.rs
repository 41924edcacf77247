//! The events of recorders that were started apart.

use std::path::Path;

use crate::events::{Event, EventError, EventOptions, Events, Onset, events_of, hear};
use crate::monitor::ListenMonitor;
use crate::survey::{ChannelSurvey, Surveys};

use super::align::align;
use super::alignment::{Alignment, RecorderAlignment};
use super::options::AlignmentOptions;
use super::together::{File, FilesApart, apart};

/// How many standard deviations of the ways of sounds the times of aligned recorders may be apart beside the spread.
const DEVIATIONS: f64 = 3.0;

/// The events of several recorders.
pub(crate) struct Gathered {
    /// By the clock of the reference. Channels of recorders that are not aligned hear none.
    pub(crate) events: Events,
    /// The recorder of each channel, from 0.
    pub(crate) recorders: Vec<usize>,
    pub(crate) alignment: Alignment,
    /// Of each channel.
    pub(crate) survey: Vec<ChannelSurvey>,
    pub(crate) apart: Vec<FilesApart>,
}

/// The events of all recorders as one of them has them.
pub(crate) struct OwnEvents<'a> {
    pub(crate) clock: &'a RecorderAlignment,
    /// Which of all channels are its own.
    pub(crate) channels: Vec<usize>,
    /// By its clock, with these channels alone.
    pub(crate) events: Events,
}

impl Gathered {
    /// Finds what the files of each recorder heard, aligns the recorders, and finds their events.
    ///
    /// # Errors
    /// Those of [`find_events`](crate::find_events), if the alignment has an option out of range, or if the monitor stops
    /// the reading.
    pub(crate) fn new<P: AsRef<Path>>(
        files: &[Vec<P>],
        options: &EventOptions,
        alignment: &AlignmentOptions,
        monitor: &ListenMonitor,
    ) -> Result<Gathered, EventError> {
        alignment.validate()?;
        let mut surveys = Surveys::default();
        let (channels, onsets) = hear(files.iter().flatten(), options, monitor, Some(&mut surveys))?;
        // Each file has a first channel.
        let mut owners = files.iter().enumerate().flat_map(|(recorder, files)| files.iter().map(move |_| recorder));
        let mut owner = 0;
        let mut recorder = |number: usize| {
            if number == 1 {
                owner = owners.next().unwrap_or(owner);
            }
            owner
        };
        let recorders: Vec<usize> = channels.iter().map(|channel| recorder(channel.channel)).collect();
        let mut heard: Vec<Vec<Vec<Onset>>> = vec![Vec::new(); files.len()];
        for (&recorder, onsets) in recorders.iter().zip(&onsets) {
            heard[recorder].push(onsets.clone());
        }
        let is_last = |k: &usize| channels.get(k + 1).is_none_or(|next| next.channel == 1);
        let mut begin = 0;
        let file = |k: usize| {
            let onsets = &onsets[begin..=k];
            begin = k + 1;
            File { recorder: recorders[k], name: &channels[k].file, seconds: surveys.channels[k].seconds, onsets }
        };
        let all: Vec<File<'_>> = (0..channels.len()).filter(is_last).map(file).collect();
        let apart = apart(&all, options);
        let alignment = align(&heard, options, alignment);
        let common = |(recorder, onsets): (&usize, Vec<Onset>)| match alignment.of(*recorder) {
            Some(clock) => onsets.into_iter().map(|it| Onset { seconds: clock.common(it.seconds), ..it }).collect(),
            None => Vec::new(),
        };
        let onsets: Vec<Vec<Onset>> = recorders.iter().zip(onsets).map(common).collect();
        let events = events_of(channels, &onsets, &wider(options, &alignment));
        Ok(Gathered { events, recorders, alignment, survey: surveys.channels, apart })
    }

    /// The events by the clock of each aligned recorder.
    pub(crate) fn own(&self) -> Vec<OwnEvents<'_>> {
        self.alignment.recorders.iter().map(|clock| self.own_of(clock)).collect()
    }

    fn own_of<'a>(&self, clock: &'a RecorderAlignment) -> OwnEvents<'a> {
        let is_own = |k: &usize| self.recorders[*k] == clock.recorder;
        let own: Vec<usize> = (0..self.recorders.len()).filter(is_own).collect();
        let channels = own.iter().map(|&k| self.events.channels[k].clone()).collect();
        let onset = |onset: Onset| Onset { seconds: clock.own(onset.seconds), ..onset };
        let event = |event: &Event| {
            // What was before the recorder began is an empty window at its beginning.
            let [begin, end] = [event.window.start, event.window.end].map(|time| clock.own(time).max(0.0));
            let onsets = own.iter().map(|&k| event.onsets[k].map(onset)).collect();
            Event { seconds: clock.own(event.seconds), onsets, window: begin..end }
        };
        let events = self.events.events.iter().map(event).collect();
        OwnEvents { clock, channels: own, events: Events { events, channels, dropped: Vec::new() } }
    }
}

/// Options by which clocks may also be off by what the ways of the sounds make uncertain, but no more than sound takes.
fn wider(options: &EventOptions, alignment: &Alignment) -> EventOptions {
    let mut wider = options.clone();
    if alignment.recorders.len() > 1 {
        let scatter = alignment.recorders.iter().map(|recorder| recorder.scatter).fold(0.0, f64::max);
        let spread = options.spread() + (DEVIATIONS * scatter).min(options.spread());
        wider.extent = spread * options.speed;
        wider.dead_time = Some(options.dead_time().max(spread));
    }
    wider
}
