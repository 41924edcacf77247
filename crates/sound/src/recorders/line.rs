//! How one clock goes beside another, from the times of sounds by both.

use crate::quantile::{MEDIAN, quantile};

/// Rounds in which times that are far from the line get less weight.
const ROUNDS: usize = 10;

/// Deviations beyond which weights fall: P. J. Huber, Robust Statistics, 1981.
const HUBER: f64 = 1.5;

/// Share of the points that are not far from the middle.
const NEAR: f64 = 0.9;

/// Onsets are known to about this, seconds.
const LEAST: f64 = 1e-3;

/// A clock beside another: y = to + (1 + rate) (x - from).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    /// A time by this clock, in the middle of those that are known, and by the other one, seconds.
    pub(super) from: f64,
    pub(super) to: f64,
    /// A share, not in parts per million; and its standard deviation.
    pub(super) rate: f64,
    pub(super) rate_sigma: f64,
    /// Standard deviation of times from the line, seconds.
    pub(super) scatter: f64,
}

impl Line {
    /// A clock that is the other one.
    pub(super) fn same() -> Line {
        Line { from: 0.0, to: 0.0, rate: 0.0, rate_sigma: 0.0, scatter: 0.0 }
    }

    /// The time by the other clock.
    pub(super) fn at(&self, x: f64) -> f64 {
        self.to + (1.0 + self.rate) * (x - self.from)
    }

    /// The time by this clock.
    pub(super) fn inverse(&self, y: f64) -> f64 {
        self.from + (y - self.to) / (1.0 + self.rate)
    }

    /// Standard deviation of what an unknown rate does to a time by this clock, seconds.
    pub(super) fn drift(&self, x: f64) -> f64 {
        self.rate_sigma * (x - self.from).abs()
    }

    /// The line through these times by both clocks, which stray from it. The rate is expected to be about zero with a
    /// standard deviation of `expected`, and no more than twice that: some sounds in a short time do not tell it.
    pub(super) fn fit(points: &[(f64, f64)], expected: f64) -> Option<Line> {
        let alone = leverages(points);
        let mut weights = alone.clone();
        let mut line = None;
        for _ in 0..ROUNDS {
            let scatter = line.map_or(LEAST, |line: Line| line.scatter);
            let next = weighted(points, &weights, expected, scatter)?;
            let off = |&(x, y): &(f64, f64)| (y - next.at(x)).abs();
            let scatter = (quantile(points.iter().map(off).collect(), 0.5)? / MEDIAN).max(LEAST);
            let bounded =
                |(point, alone): (&(f64, f64), &f64)| alone * (HUBER * scatter / off(point).max(1e-9)).min(1.0);
            weights = points.iter().zip(&alone).map(bounded).collect();
            line = Some(Line { scatter, ..next });
        }
        line
    }
}

/// Weights by which few points far from all others do not say more of the rate than others: sounds that match by chance
/// may be anywhere.
fn leverages(points: &[(f64, f64)]) -> Vec<f64> {
    let middle = quantile(points.iter().map(|point| point.0).collect(), 0.5).unwrap_or(0.0);
    let near = quantile(points.iter().map(|point| (point.0 - middle).abs()).collect(), NEAR).unwrap_or(0.0);
    points.iter().map(|point| (near / (point.0 - middle).abs().max(1e-9)).powi(2).min(1.0)).collect()
}

/// The line by weighted least squares, of times with this scatter.
fn weighted(points: &[(f64, f64)], weights: &[f64], expected: f64, scatter: f64) -> Option<Line> {
    let sum =
        |of: &dyn Fn(f64, f64) -> f64| -> f64 { points.iter().zip(weights).map(|(&(x, y), w)| w * of(x, y)).sum() };
    let total = sum(&|_, _| 1.0);
    if total <= 0.0 {
        return None;
    }
    // Differences of the clocks are small beside their times.
    let (from, apart) = (sum(&|x, _| x) / total, sum(&|x, y| y - x) / total);
    let known = scatter * scatter / expected.max(1e-12).powi(2);
    let information = sum(&|x, _| (x - from).powi(2)) + known;
    let rate = sum(&|x, y| (x - from) * (y - x - apart)) / information;
    let rate = rate.clamp(-2.0 * expected, 2.0 * expected);
    Some(Line { from, to: from + apart, rate, rate_sigma: scatter / information.sqrt(), scatter })
}

#[cfg(test)]
mod tests {
    use super::Line;

    #[test]
    fn a_line_is_found_beside_wrong_points() {
        let truth = |x: f64| 312.5 + (1.0 + 40e-6) * x;
        // Points that stray by 10 ms to either side in turn, and every tenth by 80 ms to one side.
        let point = |k: u32| {
            let x = 7.0 * f64::from(k) + 3.0;
            let stray = if k % 10 == 3 { 0.08 } else { 0.01 * f64::from(k % 2) * 2.0 - 0.01 };
            (x, truth(x) + stray)
        };
        let points: Vec<(f64, f64)> = (0..200).map(point).collect();
        let line = Line::fit(&points, 1e-4).unwrap();
        // Least squares without weights would be late by 8 ms. A tenth of the points at 1.5 deviations, which are 15 ms if the
        // median is 10 ms, makes 2.5 ms; and 12.5 ms over 0.6745 and the root of the sum of squares, 5717 s, is 3.2e-6.
        assert!((line.at(line.from) - truth(line.from)).abs() < 3e-3, "{line:?}");
        assert!((line.rate - 40e-6).abs() < 4.0 * line.rate_sigma && line.rate_sigma < 3.5e-6, "{line:?}");
        assert!((line.inverse(line.at(17.0)) - 17.0).abs() < 1e-9);
        assert_eq!(Line::fit(&[], 1e-4), None);
    }

    #[test]
    fn a_short_time_does_not_tell_the_rate() {
        let points = [(1.0, 11.02), (2.0, 11.98), (3.0, 13.02), (4.0, 13.98)];
        let line = Line::fit(&points, 1e-4).unwrap();
        assert!(line.rate.abs() < 1e-5 && line.rate_sigma > 0.9e-4, "{line:?}");
        assert!((line.at(2.5) - 12.5).abs() < 1e-3);
    }
}
