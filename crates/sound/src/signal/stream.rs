//! Long recordings are compressed part by part.

use std::sync::Arc;

use super::compression::Compression;
use super::error::SignalError;
use super::known::Signal;

/// Length of what is transformed at a time, beside that of the signal, and at least, samples.
const LONGER: f64 = 4.0;
const LEAST: usize = 1 << 13;

/// Compresses samples that come one after another, and keeps some transforms' lengths of them. Parts begin at multiples of
/// one length, wherever blocks of samples end, so that their rounding is the same.
pub(crate) struct Stream {
    compression: Arc<Compression>,
    /// Samples from before the next that is to come out.
    samples: Vec<f32>,
    /// Samples that are held before that, for what the filter has of the past.
    before: usize,
    /// How many samples of a part come out.
    part: usize,
}

impl Stream {
    /// A compression for streams of this rate.
    pub(crate) fn compression(
        signal: &Signal,
        band: [f64; 2],
        rate: f64,
    ) -> Result<Option<Arc<Compression>>, SignalError> {
        let length = ((LONGER * signal.seconds() * rate) as usize).max(LEAST);
        Ok(Compression::new(signal, band, rate, length)?.map(Arc::new))
    }

    pub(crate) fn new(compression: Arc<Compression>) -> Stream {
        let length = compression.fourier.length();
        // The filter reaches over the signal that is to come, and little beyond at either end.
        let before = length / 16;
        let part = length.saturating_sub(compression.length + 2 * before).max(1);
        Stream { compression, samples: vec![0.0; before], before, part }
    }

    /// Takes the next samples, and appends what is compressed.
    pub(crate) fn push(&mut self, samples: &[f32], compressed: &mut Vec<f32>) {
        let length = self.compression.fourier.length();
        let mut left = samples;
        while !left.is_empty() {
            let (now, later) = left.split_at(left.len().min(length - self.samples.len()));
            self.samples.extend_from_slice(now);
            left = later;
            if self.samples.len() == length {
                self.compress(compressed, self.part);
            }
        }
    }

    /// Appends what is compressed of the last samples.
    pub(crate) fn finish(mut self, compressed: &mut Vec<f32>) {
        while self.samples.len() > self.before {
            let count = self.part.min(self.samples.len() - self.before);
            self.compress(compressed, count);
        }
    }

    /// Compresses a part, of which this many samples come out.
    fn compress(&mut self, compressed: &mut Vec<f32>, count: usize) {
        let values = self.compression.compressed(&self.samples);
        let signal = self.compression.signal(values.into_iter());
        compressed.extend(
            signal[self.before..self.before + count]
                .iter()
                .map(|sample| sample.clamp(f32::MIN.into(), f32::MAX.into()) as f32),
        );
        self.samples.drain(..count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::chirp;

    #[test]
    fn parts_of_any_length_are_compressed_as_the_whole() {
        let (rate, signal) = (8000.0, Signal::Chirp { from: 1000.0, to: 3000.0, seconds: 0.1 });
        let band = [500.0, 3500.0];
        // Every half second one, across all ends of parts.
        let sample = |k: usize| chirp((k as f64 / rate) % 0.5, 1000.0, 3000.0, 0.1) as f32;
        let samples: Vec<f32> = (0..50_001).map(sample).collect();
        let compressed = |block: usize| {
            let mut stream = Stream::new(Stream::compression(&signal, band, rate).unwrap().unwrap());
            let mut all = Vec::new();
            samples.chunks(block).for_each(|samples| stream.push(samples, &mut all));
            stream.finish(&mut all);
            all
        };
        let all = compressed(samples.len());
        assert!(all.len() == samples.len() && all == compressed(1) && all == compressed(777));
        let whole = Compression::new(&signal, band, rate, samples.len()).unwrap().unwrap();
        let whole = whole.signal(whole.compressed(&samples).into_iter());
        let scale = whole.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let off = all.iter().zip(&whole).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-2 * scale, "{off} of {scale}");
        assert!((0..12).all(|k| f64::from(all[4000 * k]) > 0.9 * scale));
    }

    #[test]
    fn nothing_comes_of_nothing() {
        let signal = Signal::Chirp { from: 1000.0, to: 3000.0, seconds: 0.1 };
        let stream = Stream::new(Stream::compression(&signal, [500.0, 3500.0], 8000.0).unwrap().unwrap());
        let mut all = Vec::new();
        stream.finish(&mut all);
        assert!(all.is_empty());
    }
}
