//! Measurements of which some have gross errors: good ones are normal, and gross errors are anywhere.

use std::f64::consts::TAU;

/// Share of gross errors to begin with.
const FIRST: f64 = 0.05;

/// Most rounds of telling gross errors from good measurements.
const SORTINGS: usize = 12;

/// The deviation of good measurements is at least this share of the width: exact ones have none.
const EXACT: f64 = 1e-6;

/// Normal measurements and gross errors among a number of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GrossErrors {
    all: f64,
    /// Lengths within which gross errors are, metres.
    width: f64,
    /// Their share; not zero, as there may be one that was not met.
    share: f64,
}

impl GrossErrors {
    /// Of so many measurements, anywhere within `width` metres.
    pub(crate) fn new(all: usize, width: f64) -> GrossErrors {
        GrossErrors { all: all as f64, width, share: FIRST }
    }

    /// The largest residual, times its precision, of a measurement that is more likely good, where the good ones have
    /// this deviation.
    pub(crate) fn limit(&self, deviation: f64, precision: f64) -> f64 {
        let odds = (1.0 - self.share) / self.share * self.width * precision / (deviation * TAU.sqrt());
        deviation * (2.0 * odds.ln().max(0.0)).sqrt()
    }

    /// The deviation of good measurements with this sum of squares, of which so many are left over.
    pub(crate) fn deviation(&self, squares: f64, left: usize) -> f64 {
        (squares / left.max(1) as f64).sqrt().max(EXACT * self.width)
    }

    /// Takes the share from the number of good ones.
    pub(crate) fn count(&mut self, good: usize) {
        self.share = (self.all - good as f64).max(0.5) / self.all;
    }

    /// Logarithm of the density of all measurements, of which so many are good, with this sum of squares and
    /// deviation; `fitted` unknowns are integrated over, each of which takes one normal factor.
    pub(crate) fn log_density(&self, good: usize, fitted: usize, squares: f64, deviation: f64) -> f64 {
        let (count, left) = (good as f64, good.saturating_sub(fitted) as f64);
        let normal = count * ((1.0 - self.share).ln() - 0.5 * TAU.ln()) - left * deviation.ln();
        normal - 0.5 * squares / deviation.powi(2) + (self.all - count) * (self.share / self.width).ln()
    }
}

/// Logarithm of the density of residuals, each times its precision and with it, of which some are gross errors anywhere within
/// `width` metres: the deviation of good ones is the given or the likeliest one, from the first on. So many `unknowns`
/// were fitted.
pub(crate) fn log_density(
    residuals: &[(f64, f64)],
    unknowns: usize,
    first: f64,
    known: Option<f64>,
    width: f64,
) -> f64 {
    let mut errors = GrossErrors::new(residuals.len(), width);
    let (mut deviation, mut density) = (first, f64::NEG_INFINITY);
    for _ in 0..SORTINGS {
        let good = residuals.iter().filter(|(e, precision)| e.abs() <= errors.limit(deviation, *precision));
        let (count, squares) = good.fold((0usize, 0.0), |(count, squares), (e, _)| (count + 1, squares + e * e));
        let left = count.saturating_sub(unknowns);
        deviation = known.unwrap_or_else(|| errors.deviation(squares, left));
        errors.count(count);
        density = errors.log_density(count, unknowns, squares, deviation);
    }
    density
}

#[cfg(test)]
mod tests {
    use super::GrossErrors;

    #[test]
    fn densities_meet_at_the_limit() {
        let mut errors = GrossErrors::new(100, 7.0);
        errors.count(90);
        let limit = errors.limit(0.01, 1.0);
        // At the limit, a measurement is as likely good as gross.
        let good = errors.log_density(91, 0, limit.powi(2), 0.01);
        let gross = errors.log_density(90, 0, 0.0, 0.01);
        assert!((good - gross).abs() < 1e-9, "{good} {gross}");
        assert!((0.03..0.06).contains(&limit), "{limit}");
    }
}
