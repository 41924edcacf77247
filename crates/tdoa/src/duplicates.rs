//! Nodes whose measurements are the same up to a constant: they stand in one place, or one is a
//! copy of the other.
//!
//! What "the same" means depends on the origin of the numbers. Measured data may be printed with
//! few digits. Data that are solved exactly are taken literally: two nodes a micrometre apart are
//! two nodes.

use crate::pseudoranges::Pseudoranges;

/// The constant by which the second of each pair exceeds the first, up to `tolerance`; `None` if it
/// varies or there are fewer than three pairs.
pub(crate) fn constant_difference(pairs: impl Iterator<Item = (f64, f64)>, tolerance: f64) -> Option<f64> {
    let (mut low, mut high, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    for (x, y) in pairs {
        low = low.min(y - x);
        high = high.max(y - x);
        if high - low > tolerance {
            return None;
        }
        count += 1;
    }
    if count >= 3 { Some(0.5 * (low + high)) } else { None }
}

/// The tolerance for printed numbers: a millionth of how much the first of the pairs vary.
pub(crate) fn printed(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut least, mut most, mut size) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
    for (x, y) in pairs {
        least = least.min(x);
        most = most.max(x);
        size = size.max(x.abs()).max(y.abs());
    }
    1e-6 * (most - least) + 1e-14 * size
}

/// The tolerance for exact data: what rounding of numbers up to this size can tell apart.
pub(crate) fn rounding(largest: f64) -> f64 {
    64.0 * f64::EPSILON * largest
}

/// Copies that chance makes are expected less often than this.
const BY_CHANCE: f64 = 1e-6;

/// Numbers of so many different values are not so coarse that two measurements of a silent place agree.
const FINE: f64 = 1e5;

/// About as many differences tell how coarse the numbers are.
const SAMPLE: usize = 4_000;

/// Two transmitters that the same receivers hear, with measurements that differ by a constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Copied {
    pub(crate) first: usize,
    pub(crate) second: usize,
    /// What the second exceeds the first by.
    pub(crate) constant: f64,
    /// Whether one is a copy of the other; else the numbers are so coarse, as of samples, that two events
    /// in one place agree.
    pub(crate) certain: bool,
}

/// The first transmitters that are copies of one another. Coarse numbers that agree by chance are none.
pub(crate) fn copied_transmitters(
    measured: &Pseudoranges,
    receivers: &[usize],
    transmitters: &[usize],
) -> Option<Copied> {
    let column = |&j: &usize| {
        let heard: Vec<usize> = receivers.iter().copied().filter(|&i| measured.get(i, j).is_some()).collect();
        let values: Vec<f64> = heard.iter().filter_map(|&i| measured.get(i, j)).collect();
        (heard, values, j)
    };
    let mut columns: Vec<(Vec<usize>, Vec<f64>, usize)> = transmitters.iter().map(column).collect();
    columns.retain(|(heard, ..)| heard.len() >= 3);
    let lead = |values: &[f64]| values[1] - values[0];
    columns.sort_by(|a, b| a.0.cmp(&b.0).then(lead(&a.1).total_cmp(&lead(&b.1))));
    let mut coarse = None;
    for (k, (heard, values, a)) in columns.iter().enumerate() {
        let tolerance = printed(values.iter().copied().zip(values.iter().copied()));
        let next = columns[k + 1..].iter().take_while(|(other, ..)| other == heard);
        for (_, others, b) in next.take_while(|(_, others, _)| lead(others) - lead(values) <= tolerance) {
            let pairs = values.iter().copied().zip(others.iter().copied());
            let Some(constant) = constant_difference(pairs.clone(), printed(pairs)) else { continue };
            let rivals = 0.5 * (transmitters.len() * transmitters.len()) as f64;
            let coarse = *coarse.get_or_insert_with(|| coarseness(measured, &columns));
            let levels = levels(measured, values).min(coarse);
            let chance = rivals * levels.powi(1 - values.len() as i32);
            if chance < BY_CHANCE {
                let (first, second, constant) = if a < b { (*a, *b, constant) } else { (*b, *a, -constant) };
                return Some(Copied { first, second, constant, certain: levels > FINE });
            }
        }
    }
    None
}

/// Transmitters of which each counts once.
pub(crate) struct Copies {
    pub(crate) kept: Vec<usize>,
    /// Those that are left out, each behind the one that it is a copy of.
    pub(crate) copies: Vec<(usize, usize)>,
    /// Two that may be copies.
    pub(crate) doubtful: Option<Copied>,
}

/// The transmitters without those that are certainly copies of another.
pub(crate) fn counted_once(measured: &Pseudoranges, receivers: &[usize], transmitters: Vec<usize>) -> Copies {
    let mut once = Copies { kept: transmitters, copies: Vec::new(), doubtful: None };
    loop {
        match copied_transmitters(measured, receivers, &once.kept) {
            Some(Copied { first, second, certain: true, .. }) => {
                once.copies.push((first, second));
                once.kept.retain(|&j| j != second);
            }
            doubtful => {
                once.doubtful = doubtful;
                return once;
            }
        }
    }
}

/// How many different numbers there are for some measurements; infinity if these are not multiples
/// of one step.
fn levels(measured: &Pseudoranges, values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    step(measured).map_or(f64::INFINITY, |step| 1.0 + (high - low) / step)
}

/// How many different numbers there seem to be: as many as decimals make where they have few, and as follow
/// from how many differences within columns coincide. Of n numbers drawn from l, n^2 / (2 l) pairs do; samples
/// that were printed with some digits are no multiples of one step any more, but coincide. Those of one
/// receiver do not count, since copies coincide there.
fn coarseness(measured: &Pseudoranges, columns: &[(Vec<usize>, Vec<f64>, usize)]) -> f64 {
    let differences = columns
        .iter()
        .flat_map(|(heard, values, _)| heard[1..].iter().zip(&values[1..]).map(|(&i, value)| (value - values[0], i)));
    let every = 1 + measured.observed() / SAMPLE;
    let mut all: Vec<(f64, usize)> = differences.step_by(every).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let tolerance = printed(all.iter().map(|(d, _)| (*d, *d)));
    let (mut pairs, mut first) = (0, 0);
    for (k, (difference, i)) in all.iter().enumerate() {
        while difference - all[first].0 > tolerance {
            first += 1;
        }
        pairs += all[first..k].iter().filter(|(_, other)| other != i).count();
    }
    let range = all.last().zip(all.first()).map_or(0.0, |(most, least)| most.0 - least.0);
    let is_decimal = |unit: f64| measured.cells().values().iter().all(|v| ((v * unit).round() - v * unit).abs() < 1e-6);
    let decimals = [1.0, 1e1, 1e2, 1e3, 1e4].into_iter().find(|unit| is_decimal(*unit));
    let by_decimals = decimals.map_or(f64::INFINITY, |unit| range * unit);
    by_decimals.min((all.len() * all.len()) as f64 / (2 * pairs) as f64)
}

/// The step of which all differences between measurements are multiples, if there is one that is not
/// smaller than a billionth of what they differ by.
pub(crate) fn step(measured: &Pseudoranges) -> Option<f64> {
    let mut all: Vec<f64> = measured.cells().values().to_vec();
    all.sort_by(f64::total_cmp);
    let range = all.last().zip(all.first()).map_or(0.0, |(most, least)| most - least);
    let gaps = all.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > 1e-9 * range);
    let step = gaps.fold(f64::INFINITY, f64::min);
    let is_multiple = |value: &f64| (((value - all[0]) / step).round() - (value - all[0]) / step).abs() < 1e-3;
    (step.is_finite() && all.iter().all(is_multiple)).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::{Copied, constant_difference, copied_transmitters, printed, rounding};
    use crate::{SimulateOptions, simulate};

    #[test]
    fn copies_of_columns_are_told_from_coarse_ones() {
        let options = SimulateOptions { receivers: 6, transmitters: 8, noise: 0.01, ..Default::default() };
        let measured = simulate(&options).unwrap().pseudoranges;
        let (rows, columns): (Vec<usize>, Vec<usize>) = ((0..6).collect(), (0..8).collect());
        assert_eq!(copied_transmitters(&measured, &rows, &columns), None);
        let copied = |resolution: f64| {
            let mut values: Vec<f64> = measured.dense().iter().map(|f| (f / resolution).round() * resolution).collect();
            let later = (3.0 / resolution).round() * resolution;
            for i in 0..6 {
                values[8 * i + 5] = values[8 * i + 2] + later;
            }
            let measured = crate::Pseudoranges::new(6, 8, values).unwrap();
            copied_transmitters(&measured, &rows, &columns)
        };
        // Two events of a source that stands still may be the same in centimetres.
        for (resolution, expected) in [(1e-12, true), (1e-6, true), (0.01, false)] {
            let Copied { first, second, constant, certain } = copied(resolution).unwrap();
            assert_eq!((first, second, certain), (2, 5, expected), "{resolution}");
            assert!((constant - 3.0).abs() < 0.01, "{constant}");
        }
        // Two events less than a metre apart are often the same in whole metres.
        assert_eq!(copied(1.0), None);
    }

    #[test]
    fn a_source_that_stands_still_is_no_copy_in_printed_samples() {
        // 12 microphones at 96 kHz, and samples of 3.57573 mm printed to a micrometre.
        let mut options = SimulateOptions::<3>::new();
        (options.receivers, options.transmitters, options.noise) = (12, 60, 0.0);
        let mut values = simulate(&options).unwrap().pseudoranges.dense();
        for i in 0..12 {
            values[60 * i + 7] = values[60 * i + 6] + 22.0 * 0.00357573;
        }
        let sampled = values.iter().map(|f| ((f / 0.00357573).round() * 0.00357573 * 1e6).round() * 1e-6).collect();
        let all = |count: usize| (0..count).collect::<Vec<usize>>();
        let told = |values| copied_transmitters(&crate::Pseudoranges::new(12, 60, values).unwrap(), &all(12), &all(60));
        for (values, certain) in [(sampled, false), (values, true)] {
            let copied = told(values).unwrap();
            assert_eq!((copied.first, copied.second, copied.certain), (6, 7, certain));
        }
    }

    #[test]
    fn copies_are_told_from_neighbours() {
        let first = [1.0, 2.0, 4.0];
        let pairs = |by: [f64; 3]| first.into_iter().zip(by).map(|(x, d)| (x, x + d)).collect::<Vec<_>>();
        let is_copy = |pairs: &[(f64, f64)], tolerance| constant_difference(pairs.iter().copied(), tolerance);
        // Six digits printed: a copy for measurements, not for exact data.
        let near = pairs([0.5, 0.5, 0.500001]);
        assert!(is_copy(&near, printed(near.iter().copied())).is_some_and(|c| (c - 0.5).abs() < 1e-6));
        assert_eq!(is_copy(&near, rounding(4.5)), None);
        let exact = pairs([0.5; 3]);
        assert_eq!(is_copy(&exact, rounding(4.5)), Some(0.5));
        // Any two pairs differ by some constant, give or take.
        assert_eq!(is_copy(&exact[..2], rounding(4.5)), None);
    }
}
