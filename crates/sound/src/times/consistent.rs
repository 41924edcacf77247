//! The delays of all channels that agree with those of each pair.

use super::correlation::Peak;

/// Rounds of fitting, and of relaxation in each.
const ROUNDS: usize = 12;
const SWEEPS: usize = 40;

/// Disagreements below this count as it, seconds: weights are bounded.
const LEAST: f64 = 2e-7;

/// Disagreement of a pair that is expected at first, seconds.
const WIDE: f64 = 3e-4;

/// Delays of pairs that are this near point to one place, seconds.
const TOGETHER: f64 = 3e-5;

/// Two channels and the delays at which they agree.
pub(super) struct Pair {
    pub(super) channels: [usize; 2],
    pub(super) peaks: Vec<Peak>,
}

/// What the pairs say of a channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Channel {
    /// Its delay beside its leading edge, seconds; the middle of all is zero.
    pub(super) off: f64,
    /// Standard deviation by the disagreement of its pairs, seconds.
    pub(super) spread: f64,
    /// Other delays to which several of its pairs point.
    pub(super) alternatives: Vec<f64>,
}

/// The delays of this many channels, by least absolute deviations from a peak of each pair: the nearest one, but at first
/// the largest where leading edges are not to be trusted.
pub(super) fn consistent(count: usize, pairs: &[Pair], are_edges_rough: bool) -> Vec<Channel> {
    let mut off = vec![0.0; count];
    for round in 0..ROUNDS {
        let chosen: Vec<([usize; 2], f64, f64)> = pairs
            .iter()
            .filter_map(|pair| {
                let [a, b] = pair.channels;
                let now = off[a] - off[b];
                let nearest = |p: &&Peak, q: &&Peak| (p.delay - now).abs().total_cmp(&(q.delay - now).abs());
                let peak =
                    if round == 0 && are_edges_rough { pair.peaks.first() } else { pair.peaks.iter().min_by(nearest) }?;
                // At first nothing is known of what disagrees.
                let apart = if round == 0 { WIDE } else { (peak.delay - now).abs().max(LEAST) };
                Some((pair.channels, peak.delay, peak.share / apart))
            })
            .collect();
        relax(&mut off, &chosen);
    }
    let middle = median(off.clone());
    off.iter_mut().for_each(|x| *x -= middle);
    (0..count).map(|k| channel(k, &off, pairs)).collect()
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

/// What is left of the pairs of a channel, and other places to which they point.
fn channel(k: usize, off: &[f64], pairs: &[Pair]) -> Channel {
    let (mut apart, mut points) = (Vec::new(), Vec::new());
    for pair in pairs.iter().filter(|pair| pair.channels.contains(&k)) {
        let [a, b] = pair.channels;
        let place = |peak: &Peak| if a == k { off[b] + peak.delay } else { off[a] - peak.delay };
        let places: Vec<f64> = pair.peaks.iter().map(place).collect();
        apart.push(places.iter().map(|x| (x - off[k]).abs()).fold(f64::INFINITY, f64::min));
        points.extend(places);
    }
    let groups = groups(points);
    let count = apart.len();
    let is_other = |group: &&Vec<f64>| (median((*group).clone()) - off[k]).abs() > TOGETHER;
    let mut alternatives: Vec<&Vec<f64>> =
        groups.iter().filter(is_other).filter(|group| 3 * group.len() >= count.max(2)).collect();
    alternatives.sort_by_key(|group| std::cmp::Reverse(group.len()));
    let alternatives = alternatives.into_iter().map(|group| median(group.clone())).collect();
    // Of the disagreement of two channels each has half of the square; the median of a normal one is 0.6745 deviations.
    let spread = if apart.is_empty() { 0.0 } else { median(apart) / 0.6745 / std::f64::consts::SQRT_2 };
    Channel { off: off[k], spread, alternatives }
}

/// Numbers that are together, in ascending order.
fn groups(mut all: Vec<f64>) -> Vec<Vec<f64>> {
    all.sort_by(f64::total_cmp);
    let mut groups: Vec<Vec<f64>> = Vec::new();
    for x in all {
        match groups.last_mut() {
            Some(group) if x - group[group.len() - 1] <= 0.5 * TOGETHER => group.push(x),
            _ => groups.push(vec![x]),
        }
    }
    groups
}

/// The middle of some numbers; 0 of none.
fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
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
        for are_edges_rough in [true, false] {
            let found = consistent(5, &pairs, are_edges_rough);
            // The middle one of the truth is zero.
            for (channel, off) in found.iter().zip(truth) {
                assert!((channel.off - off).abs() < 1e-6 && channel.spread < 1e-6, "{found:?}");
            }
        }
    }
}
