//! The noise floor: how loud it is where no sounds are.

/// Least floor, as a share of full scale: what is weaker than -120 dB is silence, such as digital zeros.
const LEAST: f32 = 1e-6;

/// Parts into which the time of the floor is divided.
const PARTS: f64 = 100.0;

/// Follows the noise floor: the lower quartile of the medians of short chunks, over some seconds around each chunk.
/// Sounds that fill less than half of a chunk do not change its median, and those that fill less than three quarters of
/// the chunks do not reach the quartile.
pub(super) struct Floor {
    /// Bins of a chunk.
    chunk: usize,
    /// Chunks on either side that count.
    half: usize,
    /// Levels of the chunk that is not yet over.
    levels: Vec<f32>,
    medians: Vec<f32>,
}

impl Floor {
    /// A floor over this many bins, at least 1 of which are in a chunk, and `least_half` chunks on either side.
    pub(super) fn new(bins: f64, least_half: usize) -> Floor {
        let chunk = ((bins / PARTS).round() as usize).max(1);
        let half = ((bins / 2.0 / chunk as f64).round() as usize).max(least_half).max(1);
        Floor { chunk, half, levels: Vec::with_capacity(chunk), medians: Vec::new() }
    }

    /// Bins of a chunk.
    pub(super) fn chunk(&self) -> usize {
        self.chunk
    }

    /// The next level; whether it ends a chunk.
    pub(super) fn push(&mut self, level: f32) -> bool {
        self.levels.push(level);
        let is_full = self.levels.len() == self.chunk;
        if is_full {
            self.end_chunk();
        }
        is_full
    }

    /// Ends the last chunk, however short.
    pub(super) fn finish(&mut self) {
        if !self.levels.is_empty() {
            self.end_chunk();
        }
    }

    fn end_chunk(&mut self) {
        let middle = self.levels.len() / 2;
        self.medians.push(nth(&mut self.levels, middle));
        self.levels.clear();
    }

    /// Number of chunks whose floor is known while more may come.
    pub(super) fn known(&self) -> usize {
        self.medians.len().saturating_sub(self.half)
    }

    /// The floor in a chunk, by all that is there on either side.
    pub(super) fn at(&self, chunk: usize) -> f32 {
        let end = chunk.saturating_add(self.half + 1).min(self.medians.len());
        let around = self.medians.get(chunk.saturating_sub(self.half)..end).unwrap_or(&[]);
        nth(&mut around.to_vec(), around.len() / 4).max(LEAST)
    }
}

/// The value with this number if they were sorted, from 0; 0 if there is none.
fn nth(values: &mut [f32], number: usize) -> f32 {
    if number < values.len() { *values.select_nth_unstable_by(number, f32::total_cmp).1 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Floors of all chunks, of 10 s at 1000 levels a second.
    fn floors(level: impl Fn(usize) -> f32, count: usize) -> Vec<f32> {
        let mut floor = Floor::new(10_000.0, 1);
        (0..count).for_each(|k| {
            floor.push(level(k));
        });
        floor.finish();
        (0..count.div_ceil(100)).map(|chunk| floor.at(chunk)).collect()
    }

    #[test]
    fn sounds_do_not_raise_it() {
        // Loud for 0.7 s of each second.
        assert!(floors(|k| if k % 1000 < 700 { 1.0 } else { 0.01 }, 30_000).iter().all(|&floor| floor == 0.01));
    }

    #[test]
    fn it_follows_slow_changes() {
        // Tenfold in 60 s: 10 s make 10^(1/6), and the quartile lies a quarter of the window before its middle.
        let level = |k: usize| 0.01 * 10.0_f32.powf(k as f32 / 60_000.0);
        for (chunk, floor) in floors(level, 60_000).into_iter().enumerate().skip(50).take(500) {
            let ratio = floor / level(100 * chunk + 50);
            assert!((ratio / 10.0_f32.powf(-2.5 / 60.0) - 1.0).abs() < 0.01, "{chunk}: {ratio}");
        }
    }

    #[test]
    fn silence_has_the_least_floor() {
        assert_eq!(floors(|_| 0.0, 150), [LEAST; 2]);
        assert_eq!(Floor::new(10.0, 1).at(7), LEAST);
    }
}
