//! What a microphone hears of an impulse at a source.

use super::images::images;
use super::options::RoomOptions;
use super::placement::distance;
use crate::kernel::{BEFORE, Kernel, TAPS};

/// The way from sources to microphones in a room.
pub(super) struct Response<'a> {
    pub(super) options: &'a RoomOptions,
    /// By which share walls reflect.
    pub(super) reflection: f64,
    pub(super) kernel: &'a Kernel,
}

impl Response<'_> {
    /// Number of samples of a response by a clock that is faster by the factor `pace`.
    pub(super) fn length(&self, pace: f64) -> usize {
        (self.options.echo_time() * f64::from(self.options.sample_rate) * pace).ceil() as usize + TAPS + 2
    }

    /// Samples of the response to an impulse of size 1 at a distance of 1 metre. The direct sound, of which the factor `passed`
    /// passes obstacles, arrives at the sample [`BEFORE`], and by `fraction` of a sample later.
    pub(super) fn samples(
        &self,
        source: [f64; 3],
        microphone: [f64; 3],
        pace: f64,
        fraction: f64,
        passed: f64,
    ) -> Vec<f64> {
        let mut samples = vec![0.0; self.length(pace)];
        let direct = distance(source, microphone);
        let scale = f64::from(self.options.sample_rate) * pace / self.options.speed;
        let begin = BEFORE as f64 + fraction;
        if self.reflection == 0.0 {
            self.kernel.add(&mut samples, begin, passed / direct);
            return samples;
        }
        // A little more, or rounding could take the direct sound.
        let radius = direct * (1.0 + 1e-12) + self.options.speed * self.options.echo_time();
        let order = self.options.max_order.unwrap_or(u32::MAX);
        // The table ends where nothing is heard any more, long before images do.
        let mut powers = vec![1.0];
        images(self.options.extent, source, microphone, radius, order, |distance, reflections| {
            while powers.len() <= reflections as usize {
                powers.push(powers[powers.len() - 1] * self.reflection);
            }
            let passed = if reflections == 0 { passed } else { 1.0 };
            let size = passed * powers[reflections as usize] / distance;
            self.kernel.add(&mut samples, begin + (distance - direct) * scale, size);
        });
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn response(options: &RoomOptions, reflection: f64, source: [f64; 3], microphone: [f64; 3]) -> Vec<f64> {
        let kernel = Kernel::new();
        Response { options, reflection, kernel: &kernel }.samples(source, microphone, 1.0, 0.0, 1.0)
    }

    #[test]
    fn echoes_of_the_first_walls_come_when_and_as_loud_as_they_should() {
        // The source is (3, 0.5, 0.5) m away; its images are at x = -1 and 11, y = -2 and 8, z = -1.2 and 4.8.
        let mut options = RoomOptions { extent: [6.0, 5.0, 3.0], echo_time: Some(0.012), ..RoomOptions::default() };
        (options.max_order, options.sample_rate) = (Some(1), 480_000);
        let samples = response(&options, 0.5, [1.0, 2.0, 1.2], [4.0, 2.5, 0.7]);
        let square = |x: f64, y: f64, z: f64| x * x + y * y + z * z;
        let direct = square(3.0, 0.5, 0.5).sqrt();
        let first = [square(5.0, 0.5, 0.5), square(7.0, 0.5, 0.5), square(3.0, 4.5, 0.5), square(3.0, 5.5, 0.5)];
        let second = [square(3.0, 0.5, 1.9), square(3.0, 0.5, 4.1)];
        let mut found = 0.0;
        for (distance, share) in first.iter().chain(&second).map(|s| (s.sqrt(), 0.5)).chain([(direct, 1.0)]) {
            // Impulses are 64 samples long; the nearest two are 5.5 cm apart, 77 samples. The sum of an impulse is its
            // size.
            let at = BEFORE as f64 + (distance - direct) / 343.0 * 480_000.0;
            let begin = at as usize - BEFORE;
            let size: f64 = samples[begin..begin + TAPS].iter().sum();
            assert!((size * distance / share - 1.0).abs() < 2e-4, "{size} at {distance}");
            let centre = (begin..begin + TAPS).map(|k| k as f64 * samples[k]).sum::<f64>() / size;
            assert!((centre - at).abs() < 1e-2, "{centre}, not {at}");
            found += size;
        }
        // There is nothing else.
        assert!((samples.iter().sum::<f64>() - found).abs() < 1e-12);
    }

    #[test]
    fn obstacles_weaken_the_direct_sound_alone() {
        let (options, kernel) = (RoomOptions::default(), Kernel::new());
        for reflection in [0.0, 0.8] {
            let response = Response { options: &options, reflection, kernel: &kernel };
            let samples = |passed: f64| response.samples([1.0, 2.0, 1.2], [4.0, 2.0, 1.2], 1.0, 0.3, passed);
            let mut direct = vec![0.0; samples(1.0).len()];
            kernel.add(&mut direct, BEFORE as f64 + 0.3, 0.75 / 3.0);
            let lost = samples(1.0).into_iter().zip(samples(0.25)).map(|(whole, left)| whole - left);
            assert!(lost.zip(direct).all(|(lost, direct)| (lost - direct).abs() < 1e-12));
        }
    }

    #[test]
    fn energy_decays_in_the_reverberation_time() {
        for (reverberation, extent) in [(0.3, [5.0, 4.0, 3.0]), (0.6, [7.0, 6.0, 5.0])] {
            let options = RoomOptions { extent, reverberation, ..RoomOptions::default() };
            let reflection = super::super::walls::reflection(&options).unwrap();
            let [x, y, z] = extent;
            let samples =
                response(&options, reflection, [0.31 * x, 0.23 * y, 0.37 * z], [0.72 * x, 0.67 * y, 0.58 * z]);
            // All echoes have one sign. Where they lie close, low frequencies add up, which no microphone hears so: the
            // difference of samples takes these away.
            let samples: Vec<f64> = samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
            // Schroeder (1965): the energy that is still to come. From -5 to -25 dB, times three.
            let mut left = 0.0;
            let mut curve: Vec<f64> = samples
                .iter()
                .rev()
                .map(|sample| {
                    left += sample * sample;
                    left
                })
                .collect();
            curve.reverse();
            let at =
                |decibel: f64| curve.iter().position(|&energy| energy < left * 10.0_f64.powf(-decibel / 10.0)).unwrap();
            let measured = 3.0 * (at(25.0) - at(5.0)) as f64 / 48000.0;
            assert!((measured / reverberation - 1.0).abs() < 0.2, "{measured} s in place of {reverberation} s");
        }
    }
}
