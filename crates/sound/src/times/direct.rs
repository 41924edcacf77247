//! The direct sound in each channel.
//!
//! What the other channels have in common, at the times at which each is thought to hear it, is the sound without echoes, as
//! these are at other times in each. A channel is taken apart by it (`paths`); the first way that is strong and clear
//! is the direct one, and its time makes the sound clearer for the other channels, time and again.

use super::arrival::{Arrival, PEAKS};
use super::correlation::Delays;
use super::options::{TimeOptions, Window};
use super::paths::{Path, paths};
use super::spectrum::Spectrum;

/// How often channels are taken apart at most, and by how much all times move less in the end, seconds.
const PASSES: usize = 5;
const STEADY: f64 = 1e-5;

/// How many lengths of what is compared are looked through, all of them but one before the leading edge: noise may hide the
/// direct sound of a distant source from it.
const FAR: f64 = 4.0;

/// How strong the direct sound is at least, beside the strongest way: 14 dB weaker.
const STRONG: f64 = 0.2;

/// How large ways are over what is left of the channel: above the first they may be the direct sound, above the second they
/// are taken for it, and above the third they are beyond doubt. Of some hundred independent values of normal noise, one
/// is above 4.5 in some thousand channels; but what is left has echoes too, as the sound is not known exactly, and of
/// first ways between 4.5 and 6.5 in simulated rooms half were none.
const SEEN: f64 = 4.5;
const CLEAR: f64 = 6.5;
const SURE: f64 = 8.0;

/// A channel that has a leading edge.
#[derive(Clone, Copy)]
pub(super) struct Channel<'a> {
    pub(super) window: &'a Window<'a>,
    /// The leading edge, and when it is thought to hear the sound, seconds by the recorder's clock.
    pub(super) edge: f64,
    pub(super) time: f64,
}

/// The arrivals in channels that are thought to hear a sound about their times; the sound is compared over the wider length.
pub(super) fn arrivals(
    mut channels: Vec<Channel<'_>>,
    options: &TimeOptions,
    wide: &TimeOptions,
) -> Vec<Option<Arrival>> {
    let far = TimeOptions { length: FAR * options.length, before: (FAR - 1.0) * options.length, ..options.clone() };
    let (step, delays) = (Spectrum::step(&far), Delays::new(&far));
    if let [Channel { edge, .. }] = channels[..] {
        // There is nothing to compare it with.
        return vec![Some(Arrival { seconds: edge, sigma: options.length, alternatives: Vec::new() })];
    }
    let about = |channel: &Channel<'_>| Spectrum::new(channel.window, channel.edge, &far, step);
    let all: Vec<Spectrum> = channels.iter().map(about).collect();
    // A sound that is not right leaves more of all channels.
    let mut best: Option<(f64, Vec<Option<Arrival>>)> = None;
    for _ in 0..PASSES {
        let sounds: Vec<Spectrum> =
            channels.iter().map(|channel| Spectrum::new(channel.window, channel.time, wide, step)).collect();
        let (mut found, mut clear, mut moved) = (Vec::with_capacity(channels.len()), 0.0, 0.0_f64);
        for (k, channel) in channels.iter().enumerate() {
            // In what it has itself, a channel would find its own echoes.
            let others = sounds.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, spectrum)| spectrum);
            let ways = Spectrum::common(others).map(|sound| paths(&all[k], &sound, options.whitening, &delays));
            let ways = ways.unwrap_or_default();
            clear += ways.first().map_or(0.0, |path| path.clear.ln());
            found.push(arrival(&ways, channel, options.length));
        }
        for (channel, arrival) in channels.iter_mut().zip(&found) {
            let Some(arrival) = arrival else { continue };
            moved = moved.max((arrival.seconds - channel.time).abs());
            channel.time = arrival.seconds;
        }
        if best.as_ref().is_none_or(|(most, _)| clear > *most) {
            best = Some((clear, found));
        }
        if moved < STEADY {
            break;
        }
    }
    best.map_or(Vec::new(), |(_, found)| found)
}

/// The arrival in a channel, by its ways beside its leading edge, the largest first; `None` if none is clear.
fn arrival(ways: &[Path], channel: &Channel<'_>, length: f64) -> Option<Arrival> {
    let mut seen: Vec<&Path> = ways.iter().filter(|path| path.clear >= SEEN).collect();
    seen.sort_by(|a, b| a.delay.total_cmp(&b.delay));
    let is_it = |path: &&Path| path.share >= STRONG && path.clear >= CLEAR;
    let chosen = seen.iter().copied().find(is_it)?;
    let apart = |path: &&Path| (path.delay - chosen.delay).abs();
    // What is earlier may be the direct sound; and if this one is not, it is the next that is beyond doubt, if there is one.
    let earlier = seen.first().map(apart).filter(|_| seen[0].delay < chosen.delay);
    let mut later = seen.iter().filter(|path| path.delay > chosen.delay);
    let doubt = match earlier {
        Some(apart) => apart,
        None if chosen.clear >= SURE => 0.0,
        None => later.clone().find(|path| path.clear >= SURE).or(later.next_back()).map_or(length, apart),
    };
    let others = ways.iter().filter(|path| path.delay != chosen.delay).take(PEAKS - 1);
    Some(Arrival {
        seconds: channel.edge + chosen.delay,
        sigma: chosen.sigma.min(length).max(doubt),
        alternatives: others.map(|path| channel.edge + path.delay).collect(),
    })
}
