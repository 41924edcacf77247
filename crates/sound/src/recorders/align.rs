//! Recorders are aligned by the onsets that they heard.

use crate::events::{EventOptions, Onset};

use super::adjust::adjust;
use super::alignment::{Alignment, RecorderAlignment, Unaligned, UnalignedReason};
use super::coincidence::LEAST;
use super::cycles::{Contradicted, largest_group, take_out_contradicted};
use super::options::AlignmentOptions;
use super::pair::Pair;
use super::sounds::{sounds, tolerance};

/// Most sounds of a recorder that are compared, and most differences between two sounds of all recorders, unless each has
/// no more than the fewest.
const MOST: usize = 256;
const DIFFERENCES: usize = 1 << 25;
const FEWEST: usize = 32;

/// Aligns recorders, from the onsets of each channel of each in the order of time. `events` says how far microphones are
/// apart.
pub(super) fn align(recorders: &[Vec<Vec<Onset>>], events: &EventOptions, options: &AlignmentOptions) -> Alignment {
    let (tolerance, max_rate) = (tolerance(events), options.max_rate * 1e-6);
    let pairs = recorders.len() * recorders.len().saturating_sub(1) / 2;
    if pairs == 0 {
        let recorders = (0..recorders.len()).map(RecorderAlignment::reference).collect();
        return Alignment { recorders, unaligned: Vec::new() };
    }
    let most = (DIFFERENCES / pairs).isqrt().clamp(FEWEST, MOST);
    let sounds: Vec<Vec<f64>> = recorders.iter().map(|channels| sounds(channels, events, most)).collect();
    let enough: Vec<usize> = (0..sounds.len()).filter(|&k| sounds[k].len() >= LEAST).collect();
    let mut all = Vec::new();
    for (k, &a) in enough.iter().enumerate() {
        for &b in &enough[k + 1..] {
            all.extend(Pair::new([a, b], [&sounds[a], &sounds[b]], tolerance, max_rate));
        }
    }
    let (ambiguous, mut pairs): (Vec<Pair>, Vec<Pair>) = all.into_iter().partition(|pair| pair.rival.is_some());
    let contradicted = take_out_contradicted(&mut pairs, tolerance);
    let mut group = largest_group(&enough, &pairs);
    if group.is_empty() {
        group.push(0);
    }
    pairs.retain(|pair| group.contains(&pair.recorders[0]));
    let clocks = adjust(&group, &pairs, &sounds, max_rate);
    let aligned = group.iter().zip(clocks).map(|(&recorder, clock)| {
        // A clock beside the reference goes the other way from the reference beside it.
        let pace = 1.0 / (1.0 + clock.line.rate);
        RecorderAlignment {
            recorder,
            start: clock.line.at(0.0),
            rate: (pace - 1.0) * 1e6,
            rate_sigma: clock.line.rate_sigma * 1e6,
            matched: clock.matched,
            scatter: clock.line.scatter,
        }
    });
    let others = (0..recorders.len()).filter(|recorder| !group.contains(recorder));
    let unaligned = others.map(|recorder| Unaligned {
        recorder,
        reason: reason(recorder, sounds[recorder].len(), &group, &ambiguous, &contradicted),
    });
    Alignment { recorders: aligned.collect(), unaligned: unaligned.collect() }
}

/// Why a recorder that heard so many sounds is not in the group.
fn reason(
    recorder: usize,
    heard: usize,
    group: &[usize],
    ambiguous: &[Pair],
    contradicted: &[Contradicted],
) -> UnalignedReason {
    if heard < LEAST {
        return UnalignedReason::TooFewSounds { heard, least: LEAST };
    }
    if let Some(Contradicted { recorders, seconds }) = contradicted.iter().find(|it| it.recorders.contains(&recorder)) {
        let mut others = recorders.iter().copied().filter(|&other| other != recorder);
        let others = [(); 2].map(|()| others.next().unwrap_or(recorder));
        return UnalignedReason::Contradiction { others, seconds: *seconds };
    }
    // Rather beside a recorder of the group, and by as many sounds as may be.
    let rank = |pair: &&Pair| (pair.other(recorder).is_some_and(|other| group.contains(&other)), pair.matches.len());
    let best = ambiguous.iter().filter(|pair| pair.other(recorder).is_some()).max_by_key(rank);
    match best.and_then(|pair| Some((pair, pair.rival?, pair.other(recorder)?))) {
        None => UnalignedReason::OtherSounds { heard },
        Some((pair, rival, other)) => UnalignedReason::Ambiguous {
            other,
            start: pair.start(recorder, 0.0),
            matched: pair.matches.len(),
            other_start: pair.start(recorder, rival.later),
            other_matched: rival.matched,
        },
    }
}
