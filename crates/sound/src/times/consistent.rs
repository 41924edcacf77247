//! The delays of all channels that agree with those of each pair.

use super::correlation::Peak;
use crate::quantile::quantile;

/// Rounds of fitting, and of relaxation in each.
const ROUNDS: usize = 12;
const SWEEPS: usize = 40;

/// Disagreements below this count as it, seconds: weights are bounded.
const LEAST: f64 = 2e-7;

/// Disagreement of a pair that is expected at first, seconds.
const WIDE: f64 = 3e-4;

/// Two channels and the delays at which they agree.
pub(super) struct Pair {
    pub(super) channels: [usize; 2],
    pub(super) peaks: Vec<Peak>,
}

/// The delays of this many channels beside their leading edges, seconds, by least absolute deviations from a peak of each
/// pair: at first the largest, as leading edges are rough, and then the nearest one. The middle of all is zero.
pub(super) fn consistent(count: usize, pairs: &[Pair]) -> Vec<f64> {
    let mut off = vec![0.0; count];
    for round in 0..ROUNDS {
        let chosen: Vec<([usize; 2], f64, f64)> = pairs
            .iter()
            .filter_map(|pair| {
                let [a, b] = pair.channels;
                let now = off[a] - off[b];
                let nearest = |p: &&Peak, q: &&Peak| (p.delay - now).abs().total_cmp(&(q.delay - now).abs());
                let peak = if round == 0 { pair.peaks.first() } else { pair.peaks.iter().min_by(nearest) }?;
                // At first nothing is known of what disagrees.
                let apart = if round == 0 { WIDE } else { (peak.delay - now).abs().max(LEAST) };
                Some((pair.channels, peak.delay, peak.share / apart))
            })
            .collect();
        relax(&mut off, &chosen);
    }
    let middle = quantile(off.clone(), 0.5).unwrap_or(0.0);
    off.iter_mut().for_each(|x| *x -= middle);
    off
}

/// Weighted least squares of differences, channel by channel.
fn relax(off: &mut [f64], chosen: &[([usize; 2], f64, f64)]) {
    // Of each channel, the others that it is paired with, by how much it is later, and the weight.
    let mut partners = vec![Vec::new(); off.len()];
    for &([a, b], delay, weight) in chosen {
        partners[a].push((b, delay, weight));
        partners[b].push((a, -delay, weight));
    }
    for _ in 0..SWEEPS {
        for (k, partners) in partners.iter().enumerate() {
            let (mut sum, mut weights) = (0.0, 0.0);
            for &(other, delay, weight) in partners {
                sum += weight * (off[other] + delay);
                weights += weight;
            }
            if weights > 0.0 {
                off[k] = sum / weights;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Pair, consistent};
    use crate::times::correlation::Peak;

    #[test]
    fn pairs_that_contradict_the_others_do_not_count() {
        let truth = [0.0, 1e-4, -2.5e-4, 3e-4, -1e-4];
        let mut pairs = Vec::new();
        for a in 0..5 {
            for b in a + 1..5 {
                let right = Peak { delay: truth[a] - truth[b], share: 1.0 };
                pairs.push(Pair { channels: [a, b], peaks: vec![right] });
            }
        }
        // Of two pairs an echo is stronger, and one has nothing but an echo.
        for k in [0, 5] {
            let right = Peak { share: 0.7, ..pairs[k].peaks[0] };
            pairs[k].peaks = vec![Peak { delay: right.delay + 7e-4, share: 1.0 }, right];
        }
        pairs[9].peaks[0].delay -= 4e-4;
        // The middle one of the truth is zero.
        let found = consistent(5, &pairs);
        assert!(found.iter().zip(truth).all(|(off, truth)| (off - truth).abs() < 1e-6), "{found:?}");
    }
}
