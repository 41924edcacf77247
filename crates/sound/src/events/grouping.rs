//! Onsets of all channels make events.

use super::event::{DropReason, DroppedEvent, Event, Onset};
use super::options::EventOptions;

/// Seconds before the earliest onset, and after the latest possible one, that belong to an event.
const MARGIN: f64 = 0.05;

/// By how much onsets may be wrong, seconds.
const TOLERANCE: f64 = 2e-3;

/// How much louder a sound must be than a channel's earlier ones to be no echo of them where that is in doubt, dB.
const LOUDER: f64 = 6.0;

/// What becomes of onsets.
pub(super) struct Grouped {
    /// In the order of time, without overlap.
    pub(super) events: Vec<Event>,
    /// In the order of time.
    pub(super) dropped: Vec<DroppedEvent>,
    /// Of each channel, how many onsets are direct sounds of events, and how many are their echoes.
    pub(super) uses: Vec<(usize, usize)>,
}

/// Groups the onsets of all channels, each in the order of time.
pub(super) fn group(channels: &[Vec<Onset>], options: &EventOptions) -> Grouped {
    let mut grouping = Grouping {
        left: channels.iter().map(Vec::as_slice).collect(),
        options,
        spread: options.spread() + TOLERANCE,
        strays: None,
        last: Vec::new(),
        grouped: Grouped { events: Vec::new(), dropped: Vec::new(), uses: vec![(0, 0); channels.len()] },
    };
    while let Some(begin) = grouping.earliest() {
        let heard = grouping.heard(begin);
        let better = grouping.better(begin, heard);
        match better {
            Some(begin) => grouping.drop_before(begin),
            None if heard < options.least_channels => grouping.drop_first(begin),
            None => grouping.take(begin),
        }
    }
    grouping.end_strays();
    let mut grouped = grouping.grouped;
    grouped.dropped.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    for dropped in &mut grouped.dropped {
        name_kept(dropped, &grouped.events);
    }
    grouped
}

/// Names the event that is kept in place of another: the nearest, as what took its place may have lost its own.
fn name_kept(dropped: &mut DroppedEvent, events: &[Event]) {
    let DropReason::Overlap { kept } = &mut dropped.reason else { return };
    let after = events.partition_point(|event| event.seconds < dropped.seconds);
    let around = events.get(after.saturating_sub(1)..(after + 1).min(events.len())).unwrap_or(&[]);
    let away = |event: &&Event| (event.seconds - dropped.seconds).abs();
    let nearest = around.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    *kept = nearest.map_or(*kept, |event| event.seconds);
}

struct Grouping<'a> {
    /// Of each channel, the onsets that are not yet dealt with.
    left: Vec<&'a [Onset]>,
    options: &'a EventOptions,
    /// Seconds in which all channels hear an event.
    spread: f64,
    strays: Option<Strays>,
    /// Of each channel, what the last event uses, and its echoes.
    last: Vec<(usize, usize)>,
    grouped: Grouped,
}

/// Onsets that make no event.
struct Strays {
    begin: f64,
    channels: Vec<usize>,
    /// The event that is kept in their place.
    kept: Option<f64>,
}

impl Grouping<'_> {
    /// The earliest onset that is left, seconds.
    fn earliest(&self) -> Option<f64> {
        self.left.iter().filter_map(|onsets| onsets.first()).map(|onset| onset.seconds).min_by(f64::total_cmp)
    }

    /// How many channels hear a sound that begins at `begin`. A channel with an onset before that hears nothing but its
    /// echoes, unless they are louder.
    fn heard(&self, begin: f64) -> usize {
        let hears = |onsets: &&&[Onset]| {
            let mut before = f64::NEG_INFINITY;
            for onset in onsets.iter().take_while(|onset| onset.seconds <= begin + self.spread) {
                if onset.seconds < begin {
                    before = before.max(onset.strength_db);
                } else if onset.strength_db > before + LOUDER {
                    return true;
                }
            }
            false
        };
        self.left.iter().filter(hears).count()
    }

    /// The beginning of a sound that more channels hear than the one at `begin`, of those that begin before that one has
    /// passed the whole extent: the first of the best. A stray onset does not take the place of the event behind it.
    fn better(&self, begin: f64, heard: usize) -> Option<f64> {
        // No sound can be heard by more channels than have an onset before the last of these has passed the extent.
        let end = begin + 2.0 * self.spread;
        let most = self.left.iter().filter(|onsets| onsets.first().is_some_and(|onset| onset.seconds <= end)).count();
        let least = heard.max(self.options.least_channels - 1);
        if most <= least {
            return None;
        }
        let candidates = self.left.iter().flat_map(|onsets| {
            let first = onsets.first();
            let louder = first.and_then(|first| {
                let near = onsets.iter().take_while(|onset| onset.seconds <= begin + self.spread);
                near.into_iter().find(|onset| onset.strength_db > first.strength_db + LOUDER)
            });
            first.into_iter().chain(louder).map(|onset| onset.seconds)
        });
        let later = candidates.filter(|&seconds| seconds > begin && seconds <= begin + self.spread);
        let mut best = (least, None);
        for seconds in later {
            let count = self.heard(seconds);
            if count > best.0 || (count == best.0 && best.1.is_some_and(|other| seconds < other)) {
                best = (count, Some(seconds));
            }
        }
        best.1
    }

    /// Drops all onsets before this time, at which an event begins that is kept.
    fn drop_before(&mut self, begin: f64) {
        while let Some(seconds) = self.earliest().filter(|&seconds| seconds < begin) {
            self.drop_first(seconds);
            if let Some(strays) = &mut self.strays {
                strays.kept = Some(begin);
            }
        }
    }

    /// Drops the onset at this time, the earliest.
    fn drop_first(&mut self, seconds: f64) {
        let is_it = |onsets: &&[Onset]| onsets.first().is_some_and(|onset| onset.seconds == seconds);
        let Some(channel) = self.left.iter().position(is_it) else { return };
        self.left[channel] = &self.left[channel][1..];
        if let Some(strays) = &mut self.strays {
            let late = seconds - strays.begin;
            let is_echo = strays.channels.contains(&channel);
            if late <= if is_echo { self.options.dead_time() } else { self.spread } {
                if !is_echo {
                    strays.channels.push(channel);
                }
                return;
            }
        }
        self.end_strays();
        self.strays = Some(Strays { begin: seconds, channels: vec![channel], kept: None });
    }

    /// Says what the strays were.
    fn end_strays(&mut self) {
        let Some(strays) = self.strays.take() else { return };
        let (heard, least) = (strays.channels.len(), self.options.least_channels);
        let reason = match strays.kept {
            Some(kept) if heard >= least => DropReason::Overlap { kept },
            _ => DropReason::TooFewChannels { heard, least },
        };
        self.grouped.dropped.push(DroppedEvent { seconds: strays.begin, reason });
    }

    /// Takes the event that begins here, with all its echoes. Of two whose windows overlap, the one that is heard better is
    /// kept.
    fn take(&mut self, begin: f64) {
        self.end_strays();
        let end = begin + self.spread;
        let direct = |onsets: &&[Onset]| direct(onsets, end, self.options.weakest_first_db);
        let onsets: Vec<Option<Onset>> = self.left.iter().map(direct).collect();
        let seconds = onsets.iter().flatten().map(|onset| onset.seconds).fold(f64::INFINITY, f64::min);
        let mut uses = Vec::with_capacity(onsets.len());
        for (left, onset) in self.left.iter_mut().zip(&onsets) {
            // Echoes are also in channels that have not heard the direct sound.
            let first = left.first().filter(|first| first.seconds <= end).map_or(begin, |first| first.seconds);
            let over = over(left, end, first + self.options.dead_time());
            let used = usize::from(onset.is_some());
            uses.push((used, over.saturating_sub(used)));
            *left = &left[over..];
        }
        let events = &mut self.grouped.events;
        if let Some(other) = events.last().filter(|event| seconds - MARGIN < event.window.end) {
            let (other_seconds, is_better) = (other.seconds, hearing(&onsets) > hearing(&other.onsets));
            let (lost, kept) = if is_better { (other_seconds, seconds) } else { (seconds, other_seconds) };
            self.grouped.dropped.push(DroppedEvent { seconds: lost, reason: DropReason::Overlap { kept } });
            if !is_better {
                return;
            }
            events.pop();
            for (all, last) in self.grouped.uses.iter_mut().zip(&self.last) {
                *all = (all.0 - last.0, all.1 - last.1);
            }
        }
        for (all, uses) in self.grouped.uses.iter_mut().zip(&uses) {
            *all = (all.0 + uses.0, all.1 + uses.1);
        }
        self.last = uses;
        let after = self.options.spread() + self.options.signal.seconds() + MARGIN;
        events.push(Event { seconds, onsets, window: (seconds - MARGIN).max(0.0)..seconds + after });
    }
}

/// How well an event is heard: by how many channels, and how loud it is in all of them, dB.
fn hearing(onsets: &[Option<Onset>]) -> (usize, f64) {
    let heard = || onsets.iter().flatten();
    (heard().count(), heard().map(|onset| onset.strength_db).sum())
}

/// How many onsets of a channel belong to an event whose direct sounds end at `end`: all until `dead`, but none from one on
/// that is later than direct sounds and louder than all before, as echoes are not.
fn over(onsets: &[Onset], end: f64, dead: f64) -> usize {
    let mut loudest = f64::INFINITY;
    let belongs = |onset: &&Onset| {
        let is_another = onset.seconds > end && onset.strength_db > loudest + LOUDER;
        loudest = if loudest.is_finite() { loudest.max(onset.strength_db) } else { onset.strength_db };
        onset.seconds <= dead && !is_another
    };
    onsets.iter().take_while(belongs).count()
}

/// The direct sound in a channel: the first of its onsets until `end` that is not more than `weaker` dB below the strongest
/// of these.
fn direct(onsets: &[Onset], end: f64, weaker: f64) -> Option<Onset> {
    let onsets = onsets.get(..onsets.partition_point(|onset| onset.seconds <= end))?;
    let strongest = onsets.iter().map(|onset| onset.strength_db).fold(f64::NEG_INFINITY, f64::max);
    onsets.iter().find(|onset| onset.strength_db >= strongest - weaker).copied()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Onsets of some channels: seconds and decibels.
    fn grouped(channels: &[&[(f64, f64)]]) -> Grouped {
        let onset = |&(seconds, strength_db): &(f64, f64)| Onset { seconds, strength_db };
        let channels: Vec<Vec<Onset>> = channels.iter().map(|onsets| onsets.iter().map(onset).collect()).collect();
        group(&channels, &EventOptions::default())
    }

    fn times(grouped: &Grouped, event: usize) -> Vec<Option<f64>> {
        grouped.events[event].onsets.iter().map(|onset| onset.map(|onset| onset.seconds)).collect()
    }

    #[test]
    fn the_first_strong_onset_counts() {
        // The direct sound 10 dB below its echo; a stray trigger 20 dB below; a channel without echoes; one that hears none.
        let grouped = grouped(&[
            &[(1.00, 20.0), (1.02, 30.0), (1.12, 22.0)],
            &[(1.00, 20.0), (1.03, 40.0)],
            &[(1.01, 30.0)],
            &[(1.04, 30.0)],
            &[],
        ]);
        assert_eq!(times(&grouped, 0), [Some(1.0), Some(1.03), Some(1.01), Some(1.04), None]);
        assert_eq!(grouped.uses, [(1, 2), (1, 1), (1, 0), (1, 0), (0, 0)]);
        assert!(grouped.events.len() == 1 && grouped.dropped.is_empty());
        // 30 m at 343 m/s.
        let window = &grouped.events[0].window;
        assert!((window.start - 0.95).abs() < 1e-12 && (window.end - (1.05 + 30.0 / 343.0)).abs() < 1e-12);
    }

    #[test]
    fn what_few_channels_hear_is_dropped_once() {
        let grouped = grouped(&[&[(1.0, 30.0), (1.1, 25.0)], &[(1.01, 30.0), (1.11, 25.0)], &[(1.02, 30.0)], &[], &[]]);
        assert!(grouped.events.is_empty());
        let reason = DropReason::TooFewChannels { heard: 3, least: 4 };
        assert_eq!(grouped.dropped, [DroppedEvent { seconds: 1.0, reason }]);
        assert_eq!(grouped.uses, [(0, 0); 5]);
    }

    #[test]
    fn a_stray_before_an_event_takes_nothing_from_it() {
        // 60 ms before it in another channel; 2 of the channels are more than 30 m from the stray's.
        let event: [&[(f64, f64)]; 5] =
            [&[(0.95, 20.0), (1.03, 30.0)], &[(1.01, 30.0)], &[(1.03, 30.0)], &[(1.05, 30.0)], &[(1.06, 30.0)]];
        let grouped = grouped(&event);
        assert_eq!(times(&grouped, 0), [Some(1.03), Some(1.01), Some(1.03), Some(1.05), Some(1.06)]);
        let reason = DropReason::TooFewChannels { heard: 1, least: 4 };
        assert_eq!(grouped.dropped, [DroppedEvent { seconds: 0.95, reason }]);
    }

    #[test]
    fn an_echo_does_not_take_the_place_of_an_event() {
        // The last channel hears only an echo, 90 ms after the first onset and less after others.
        let grouped = grouped(&[
            &[(1.00, 30.0), (1.03, 28.0)],
            &[(1.01, 30.0), (1.04, 28.0)],
            &[(1.01, 30.0)],
            &[(1.02, 30.0)],
            &[(1.095, 20.0)],
        ]);
        assert_eq!(times(&grouped, 0), [Some(1.0), Some(1.01), Some(1.01), Some(1.02), None]);
        assert_eq!(grouped.uses[4], (0, 1));
    }

    #[test]
    fn of_events_whose_windows_overlap_the_earlier_one_is_kept() {
        let two = |late: f64| {
            let onsets = [(1.0, 30.0), (1.0 + late, 30.0)];
            grouped(&[&onsets, &onsets, &onsets, &onsets])
        };
        // Windows end 0.137 s after the first onset and begin 0.05 s before it.
        let near = two(0.17);
        assert_eq!(near.events.len(), 1);
        assert_eq!(near.dropped, [DroppedEvent { seconds: 1.17, reason: DropReason::Overlap { kept: 1.0 } }]);
        assert_eq!(near.uses, [(1, 0); 4]);
        let far = two(0.19);
        assert_eq!((far.events.len(), far.dropped.len()), (2, 0));
    }

    #[test]
    fn of_events_whose_windows_overlap_the_one_that_more_hear_is_kept() {
        let first: &[(f64, f64)] = &[(1.0, 30.0), (1.01, 28.0), (1.17, 30.0)];
        let second: &[(f64, f64)] = &[(1.18, 20.0)];
        let grouped = grouped(&[first, first, first, first, second, second]);
        assert_eq!((grouped.events.len(), grouped.events[0].seconds), (1, 1.17));
        assert_eq!(grouped.dropped, [DroppedEvent { seconds: 1.0, reason: DropReason::Overlap { kept: 1.17 } }]);
        assert_eq!(grouped.uses, [(1, 0); 6]);
    }

    #[test]
    fn a_clap_in_the_dead_time_of_a_weak_sound_is_no_echo_of_it() {
        let onsets: &[(f64, f64)] = &[(1.0, 15.0), (1.03, 14.0), (1.12, 35.0), (1.14, 30.0)];
        let grouped = grouped(&[onsets; 4]);
        assert_eq!((grouped.events.len(), grouped.events[0].seconds), (1, 1.12));
        assert_eq!(grouped.uses, [(1, 1); 4]);
    }

    #[test]
    fn of_events_at_almost_the_same_time_the_one_that_more_hear_is_kept() {
        let first: &[(f64, f64)] = &[(1.0, 20.0), (1.08, 30.0)];
        let second: &[(f64, f64)] = &[(1.09, 30.0)];
        let grouped = grouped(&[first, first, first, first, second, second]);
        assert_eq!(grouped.events.len(), 1);
        assert_eq!(grouped.events[0].seconds, 1.08);
        assert_eq!(grouped.dropped, [DroppedEvent { seconds: 1.0, reason: DropReason::Overlap { kept: 1.08 } }]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn any_onsets_are_grouped_and_accounted_for(
            channels in prop::collection::vec(prop::collection::vec((0.05..1.5_f64, 16.0..50.0_f64), 0..12), 1..8),
            least in 1..5_usize,
        ) {
            let sorted = |mut onsets: Vec<(f64, f64)>| {
                onsets.sort_by(|a, b| a.0.total_cmp(&b.0));
                onsets.into_iter().map(|(seconds, strength_db)| Onset { seconds, strength_db }).collect::<Vec<Onset>>()
            };
            let channels: Vec<Vec<Onset>> = channels.into_iter().map(sorted).collect();
            let options = EventOptions { least_channels: least, ..EventOptions::default() };
            let Grouped { events, dropped, uses } = group(&channels, &options);
            for ((&(used, echoes), onsets), k) in uses.iter().zip(&channels).zip(0..) {
                prop_assert_eq!(used, events.iter().filter(|event| event.onsets[k].is_some()).count());
                prop_assert!(used + echoes <= onsets.len());
                // What is neither used nor an echo has been said.
                prop_assert!(used + echoes == onsets.len() || !dropped.is_empty());
            }
            for event in &events {
                let heard: Vec<f64> = event.onsets.iter().flatten().map(|onset| onset.seconds).collect();
                prop_assert!(heard.len() >= least && heard.iter().all(|seconds| event.window.contains(seconds)));
                prop_assert_eq!(event.seconds, heard.iter().copied().fold(f64::INFINITY, f64::min));
            }
            prop_assert!(events.windows(2).all(|pair| pair[0].window.end <= pair[1].window.start));
            for dropped in &dropped {
                match dropped.reason {
                    DropReason::TooFewChannels { heard, least: said } => prop_assert!(heard < least && said == least),
                    DropReason::Overlap { kept } => {
                        prop_assert!(events.iter().any(|event| event.seconds == kept));
                    }
                }
            }
        }
    }
}
