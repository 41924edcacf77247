//! Onsets of sounds in the envelope of a channel.

use std::collections::VecDeque;
use std::ops::Range;

use super::event::Onset;
use super::floor::Floor;

/// Seconds after its onset in which a sound shows how strong it is.
const AHEAD: f64 = 5e-3;

/// Seconds before an onset that must have been quieter.
const BEFORE: f64 = 50e-3;

/// An onset is where the envelope passes this share of the strongest level ahead: 12 dB below, so that a direct sound counts
/// that is 10 dB below an echo close behind it.
const SHARE: f32 = 0.25;

/// A sound begins where the level ahead is this many times the greatest before: echoes that die away, however unevenly,
/// begin no sound.
const RISE: f32 = 2.0;

/// Least level of an onset, over the floor, unless the threshold itself is lower: noise seldom reaches it.
const ABOVE: f32 = 2.0;

/// Finds onsets in levels that come one by one. What it holds does not grow but by 4 bytes for each hundredth of the time
/// of the noise floor.
pub(super) struct Detector {
    /// Length of a bin, seconds.
    bin: f64,
    threshold: f32,
    ahead: usize,
    before: usize,
    floor: Floor,
    levels: VecDeque<f32>,
    /// Number of the first level that is held.
    first: usize,
    /// Chunks that are done.
    done: usize,
    /// Bin and strongest level of the last onset.
    last: Option<(usize, f32)>,
    onsets: Vec<Onset>,
}

impl Detector {
    /// A detector of levels that are averages over `bin` seconds, with a noise floor over `floor_seconds`, of sounds that
    /// are `threshold` times as strong.
    pub(super) fn new(bin: f64, floor_seconds: f64, threshold: f64) -> Detector {
        let bins = |seconds: f64| ((seconds / bin).round() as usize).max(2);
        let (ahead, before) = (bins(AHEAD), bins(BEFORE));
        Detector {
            bin,
            threshold: threshold as f32,
            ahead,
            before: before.max(2 * ahead),
            // As many chunks ahead as there may be bins to look at.
            floor: Floor::new(floor_seconds / bin, ahead),
            levels: VecDeque::new(),
            first: 0,
            done: 0,
            last: None,
            onsets: Vec::new(),
        }
    }

    /// The next level.
    pub(super) fn push(&mut self, level: f32) {
        self.levels.push_back(level);
        if self.floor.push(level) {
            self.search(self.floor.known());
        }
    }

    /// All onsets, after the last level.
    pub(super) fn finish(mut self) -> Vec<Onset> {
        self.floor.finish();
        let bins = self.first + self.levels.len();
        self.search(bins.div_ceil(self.floor.chunk()));
        self.onsets
    }

    /// Searches the chunks before this one, and forgets levels that are not needed any more.
    fn search(&mut self, end: usize) {
        for chunk in self.done..end {
            let (floor, length) = (self.floor.at(chunk), self.floor.chunk());
            let last = self.first + self.levels.len();
            for bin in chunk * length..((chunk + 1) * length).min(last) {
                if let Some(peak) = self.onset(bin, floor) {
                    self.last = Some((bin, peak));
                    let strength_db = 20.0 * (f64::from(peak) / f64::from(floor)).log10();
                    self.onsets.push(Onset { seconds: (bin as f64 + 0.5) * self.bin, strength_db });
                }
            }
            let kept = ((chunk + 1) * length).saturating_sub(self.before);
            self.levels.drain(..kept.saturating_sub(self.first).min(self.levels.len()));
            self.first = self.first.max(kept);
        }
        self.done = self.done.max(end);
    }

    /// The strongest level of the sound that begins in this bin, if one does.
    fn onset(&self, bin: usize, floor: f32) -> Option<f32> {
        // Whether what sounds at the beginning has begun there cannot be told.
        let before = bin.checked_sub(self.before)?;
        let level = *self.levels.get(bin.checked_sub(self.first)?)?;
        let is_over = self.last.is_none_or(|(last, _)| bin > last + self.ahead);
        // The beginning of a sound may fill a part of a bin.
        let least = (self.threshold / 2.0).max(ABOVE.min(self.threshold));
        if !is_over || level < floor * least {
            return None;
        }
        let peak = self.greatest(bin..bin + self.ahead + 1);
        if peak < floor * self.threshold || level < SHARE * peak {
            return None;
        }
        // What comes directly before may be the foot of this sound; the last sound is never left out.
        let last = self.last.filter(|&(last, _)| last >= before).map_or(0.0, |(_, peak)| peak);
        let reference = self.greatest(before..bin - self.ahead).max(last);
        (peak >= RISE * reference).then_some(peak)
    }

    /// The greatest of these levels, as far as they are there.
    fn greatest(&self, bins: Range<usize>) -> f32 {
        let begin = bins.start.saturating_sub(self.first).min(self.levels.len());
        let end = bins.end.saturating_sub(self.first).clamp(begin, self.levels.len());
        self.levels.range(begin..end).copied().fold(0.0, f32::max)
    }
}
