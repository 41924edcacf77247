//! The sounds that a recorder heard, from the onsets of its channels.

use crate::events::{EventOptions, Onset};

/// By how much onsets may be wrong, seconds.
const WRONG: f64 = 3e-3;

/// How far apart the times of one sound by two microphones may be, seconds.
pub(super) fn tolerance(events: &EventOptions) -> f64 {
    events.spread() + WRONG
}

/// The strongest sounds, at most this many, in the order of time: onsets of any channels that are no further apart than
/// the dead time, and twice the tolerance, are one, which begins with the first that is not much below the strongest. Sounds
/// are further apart than that: one has at most one partner. Seconds from the first sample.
pub(super) fn sounds(channels: &[Vec<Onset>], events: &EventOptions, most: usize) -> Vec<f64> {
    let (gap, weaker) = ((2.0 * tolerance(events)).max(events.dead_time()), events.weakest_first_db);
    let is_number = |onset: &&Onset| onset.seconds.is_finite() && !onset.strength_db.is_nan();
    let mut onsets: Vec<Onset> = channels.iter().flatten().filter(is_number).copied().collect();
    onsets.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut sounds = Vec::new();
    let mut left = onsets.as_slice();
    while let Some(first) = left.first() {
        let near = &left[..left.partition_point(|onset| onset.seconds <= first.seconds + gap)];
        let strongest = near.iter().map(|onset| onset.strength_db).fold(f64::NEG_INFINITY, f64::max);
        let begin = near.iter().find(|onset| onset.strength_db >= strongest - weaker).unwrap_or(first).seconds;
        sounds.push((begin, strongest));
        left = &left[left.partition_point(|onset| onset.seconds <= begin + gap)..];
    }
    sounds.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    sounds.truncate(most);
    let mut begins: Vec<f64> = sounds.into_iter().map(|(begin, _)| begin).collect();
    begins.sort_by(f64::total_cmp);
    begins
}

#[cfg(test)]
mod tests {
    use super::*;

    fn onsets(all: &[(f64, f64)]) -> Vec<Onset> {
        all.iter().map(|&(seconds, strength_db)| Onset { seconds, strength_db }).collect()
    }

    #[test]
    fn onsets_of_all_channels_make_sounds() {
        // A weak trigger before the first sound; an echo after it; a sound that one channel hears; the weakest last.
        let channels = [
            onsets(&[(0.95, 16.5), (1.00, 32.0), (1.15, 30.0), (3.0, 20.0)]),
            onsets(&[(1.02, 35.0), (2.0, 25.0), (f64::NAN, 90.0)]),
        ];
        // By default sounds are 181 ms apart, and begin no more than 15 dB below the strongest onset.
        let events = EventOptions::default();
        assert_eq!(sounds(&channels, &events, 9), [1.0, 2.0, 3.0]);
        assert_eq!(sounds(&channels, &events, 2), [1.0, 2.0]);
        assert_eq!(sounds(&[], &events, 2), [0.0; 0]);
    }
}
