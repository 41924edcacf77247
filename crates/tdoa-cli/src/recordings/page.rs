//! What was heard, as parts of a page.

use std::collections::HashSet;

use sound::{Arrival, Heard, Trace, spectrogram, waveforms};
use tdoa::html::Section;

use super::heard::Recordings;
use crate::Failure;

/// Events and recorders that are drawn.
const EVENTS: usize = 24;
const RECORDERS: usize = 8;

/// Where a network expects an arrival.
#[derive(Clone, Copy)]
pub(crate) struct Expected {
    /// By the clock of the channel's recorder, seconds.
    pub(crate) seconds: f64,
    /// Whether the arrival that was found is used.
    pub(crate) is_used: bool,
}

/// Parts of a page that show what was heard, and where a network has arrivals, if that is known: of each event and channel.
pub(crate) fn sections(all: &Recordings, expected: &[Vec<Option<Expected>>]) -> Result<Vec<Section>, Failure> {
    let (headings, rows) = all.channels();
    let mut section = Section::new("Recordings")
        .note(&format!("{}; speed of sound {:.1} m/s.", all.counts(), all.speed))
        .table("channels", &headings, rows);
    for line in all.recorders().lines().filter(|line| !line.is_empty()) {
        section = section.note(line);
    }
    for warning in all.warnings() {
        section = section.warning(&warning);
    }
    for (recorder, files) in all.files.iter().enumerate().take(RECORDERS) {
        let Some(file) = files.first() else { continue };
        let svg = spectrogram(file, &times(&all.heard, recorder)).map_err(Failure::unusable)?;
        section = section.note(&format!("{}, its first channel, with the events", file.display())).picture(&svg);
    }
    Ok(vec![section, events(all, expected)])
}

/// When a recorder's first channel hears events, or another of its channels where that does not, by its clock.
fn times(heard: &Heard, recorder: usize) -> Vec<f64> {
    let of_event = |arrivals: &Vec<Option<Arrival>>| {
        let own = arrivals.iter().zip(&heard.recorders).filter(|(_, owner)| **owner == recorder);
        own.filter_map(|(arrival, _)| Some(arrival.as_ref()?.seconds)).next()
    };
    heard.arrivals.iter().filter_map(of_event).collect()
}

/// The waveforms of the events: of many, those that are expected elsewhere by most.
fn events(all: &Recordings, expected: &[Vec<Option<Expected>>]) -> Section {
    let heard = &all.heard;
    let expects = |j: usize, k: usize| expected.get(j).and_then(|of| of.get(k).copied().flatten());
    let off = |j: usize, k: usize| Some(heard.arrivals[j][k].as_ref()?.seconds - expects(j, k)?.seconds);
    let channels = heard.events.channels.len();
    let worst = |j: usize| (0..channels).filter_map(|k| off(j, k)).fold(0.0, |most: f64, off| most.max(off.abs()));
    let mut order: Vec<usize> = (0..heard.arrivals.len()).collect();
    order.sort_by(|&a, &b| worst(b).total_cmp(&worst(a)));
    let drawn: HashSet<usize> = order.into_iter().take(EVENTS).collect();
    let mut section = Section::new("Events");
    section = section.note(if expected.is_empty() {
        "Each channel is aligned by the arrival that was found (red)."
    } else {
        "Each channel is aligned by when the network has the sound arrive; red is the arrival that was found, yellow one that is not used."
    });
    if drawn.len() < heard.arrivals.len() {
        section = section.note(&format!("The {EVENTS} events with the largest residuals of {}.", heard.arrivals.len()));
    }
    for j in (0..heard.arrivals.len()).filter(|j| drawn.contains(j)) {
        let traces: Vec<Trace<'_>> = (0..channels)
            .filter_map(|k| {
                let arrival = heard.arrivals[j][k].as_ref();
                let expected = expects(j, k);
                let label = match (arrival, off(j, k)) {
                    (None, _) => "not heard".to_string(),
                    (Some(_), Some(off)) => format!("{:+.1} us, {:+.2} cm", 1e6 * off, 100.0 * off * all.speed),
                    (Some(arrival), None) => format!("std {:.1} us", 1e6 * arrival.sigma),
                };
                Some(Trace {
                    name: &all.names[k],
                    samples: heard.samples.get(j)?.get(k)?.as_ref()?,
                    picked: arrival.map(|arrival| arrival.seconds),
                    expected: expected.map(|expected| expected.seconds),
                    is_used: expected.is_none_or(|expected| expected.is_used),
                    label,
                })
            })
            .collect();
        let times = heard.arrivals[j].iter().flatten().count();
        let text = format!("event {} at {:.3} s, heard by {times}", j + 1, heard.events.events[j].seconds);
        section = section.folded_picture(&text, &waveforms(&traces));
    }
    section
}
