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

/// Measurements that are good.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Good {
    pub(crate) count: usize,
    /// Sum of the squares of their residuals, each times its precision, and of what else is fitted with them.
    pub(crate) squares: f64,
    /// Sum of the logarithms of their precisions: a precise one is dense in metres, which gross errors are not.
    pub(crate) log_precisions: f64,
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

    /// Logarithm of the density of all measurements per metre of each: of those that are [`Good`] and the others. `fitted`
    /// unknowns are integrated over, each of which takes one normal factor.
    pub(crate) fn log_density(&self, good: &Good, fitted: usize, deviation: f64) -> f64 {
        let (count, left) = (good.count as f64, good.count.saturating_sub(fitted) as f64);
        let normal = count * ((1.0 - self.share).ln() - 0.5 * TAU.ln()) - left * deviation.ln() + good.log_precisions;
        normal - 0.5 * good.squares / deviation.powi(2) + (self.all - count) * (self.share / self.width).ln()
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
        let mut good = Good::default();
        for (e, precision) in residuals.iter().filter(|(e, precision)| e.abs() <= errors.limit(deviation, *precision)) {
            good.count += 1;
            good.squares += e * e;
            good.log_precisions += precision.ln();
        }
        let left = good.count.saturating_sub(unknowns);
        deviation = known.unwrap_or_else(|| errors.deviation(good.squares, left));
        errors.count(good.count);
        density = errors.log_density(&good, unknowns, deviation);
    }
    density
}

#[cfg(test)]
mod tests {
    use super::{Good, GrossErrors, log_density};

    #[test]
    fn densities_meet_at_the_limit() {
        let mut errors = GrossErrors::new(100, 7.0);
        errors.count(90);
        // Measurements of 1 cm, by the common deviation and by their own.
        for (deviation, precision) in [(0.01, 1.0), (1.0, 100.0), (0.1, 10.0)] {
            let limit = errors.limit(deviation, precision);
            // At the limit, a measurement is as likely good as gross.
            let one = Good { count: 91, squares: limit.powi(2), log_precisions: f64::ln(precision) };
            let good = errors.log_density(&one, 0, deviation);
            let gross = errors.log_density(&Good { count: 90, ..Good::default() }, 0, deviation);
            assert!((good - gross).abs() < 1e-9, "{good} {gross}");
            assert!((0.03..0.06).contains(&(limit / precision)), "{limit}");
        }
    }

    /// What is known of each measurement by itself says the same as one deviation for all.
    #[test]
    fn a_density_does_not_depend_on_who_says_the_deviation() {
        let residuals: Vec<f64> = (0..40).map(|k| if k % 8 == 0 { 0.5 } else { 0.01 * f64::from(k % 5 - 2) }).collect();
        let with = |precision: f64| residuals.iter().map(|e| (e * precision, precision)).collect::<Vec<_>>();
        let common = log_density(&with(1.0), 10, 0.01, Some(0.01), 7.0);
        let own = log_density(&with(100.0), 10, 1.0, Some(1.0), 7.0);
        // Each unknown that is fitted takes a factor in the unit of the measurements.
        assert!((common - own - 10.0 * f64::ln(0.01)).abs() < 1e-9, "{common} {own}");
    }
}
