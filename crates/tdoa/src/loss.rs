//! The robust loss: residuals as draws of Student's t distribution.
//!
//! With nu degrees of freedom and scale s, a residual e costs (nu + 1)/2 ln(1 + (e/s)^2/nu), up to
//! the term ln s that matters when s is estimated as well. nu = 1 is the Cauchy loss; an infinite
//! nu is least squares.

/// Student's t loss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Degrees of freedom; infinite for least squares.
    pub nu: f64,
    /// Scale of the residuals in metres (or a factor on the standard deviations, if measurements
    /// carry their own).
    pub scale: f64,
}

impl Loss {
    /// Cost of a residual.
    pub fn cost(&self, residual: f64) -> f64 {
        let u2 = (residual / self.scale).powi(2);
        if self.nu.is_infinite() { 0.5 * u2 } else { 0.5 * (self.nu + 1.0) * (u2 / self.nu).ln_1p() }
    }

    /// Sum of the costs of residuals. The logarithm is taken of products, because it costs more
    /// than everything else. Infinite for absurd residuals.
    pub fn total(&self, residuals: impl Iterator<Item = f64>) -> f64 {
        if self.nu.is_infinite() {
            return residuals.map(|e| self.cost(e)).sum();
        }
        let factor = 1.0 / (self.nu * self.scale * self.scale);
        let (mut sum, mut product) = (0.0, 1.0);
        for e in residuals {
            product *= 1.0 + e * e * factor;
            if product > 1e150 {
                sum += f64::ln(product);
                product = 1.0;
            }
        }
        0.5 * (self.nu + 1.0) * (sum + product.ln())
    }

    /// Weight, among those of residuals, of the derivatives of a negative log-likelihood. Measurements are normal with the
    /// deviation that this scale was chosen for, and where degrees of freedom are infinite with this one.
    pub(crate) fn prior_weight(&self, deviation: f64) -> f64 {
        if self.nu.is_infinite() { deviation.powi(2) } else { self.weight(0.0) * (self.scale / CAUCHY).powi(2) }
    }

    /// Weight of a residual in iteratively reweighted least squares, without the factor 1/scale^2:
    /// cost'(u)/u.
    pub fn weight(&self, residual: f64) -> f64 {
        let u2 = (residual / self.scale).powi(2);
        if self.nu.is_infinite() { 1.0 } else { (self.nu + 1.0) / (self.nu + u2) }
    }
}

/// Scale of the Cauchy loss, in standard deviations, that is 95 % efficient on normal noise
/// (Holland and Welsch 1977).
pub(crate) const CAUCHY: f64 = 2.385;

/// Factor from the scale that maximises the likelihood to the standard deviation, for residuals
/// that are really normal: the tau with E[(nu + 1) z^2/(nu + z^2)] = 1 for normal z with deviation
/// tau.
pub fn normal_deviation(nu: f64) -> f64 {
    if nu.is_infinite() {
        return 1.0;
    }
    let mean = |tau: f64| -> f64 {
        // The trapezoid rule is as good as exact for a smooth integrand that dies out at both ends.
        let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        let term = |z: f64| (nu + 1.0) * (tau * z).powi(2) / (nu + (tau * z).powi(2)) * density(z);
        (-320..=320).map(|k| term(k as f64 / 40.0)).sum::<f64>() / 40.0
    };
    let (mut low, mut high) = (1.0, 4.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if mean(middle) < 1.0 { low = middle } else { high = middle }
    }
    low
}

/// Degrees of freedom of the search.
///
/// The scale is estimated from the restricted likelihood, (N - p) ln s + sum of costs for N
/// measurements and p unknowns. Let q = p/N. The estimate breaks down to scale 0 when more than a
/// share 1 - (1 - q)/(nu + 1) of the residuals can be made zero at once (fitting as many
/// measurements as there are unknowns makes a share q zero). It grows without bound when a share
/// (1 - q)/(nu + 1) are outliers. The Cauchy loss, nu = 1, leaves half of the redundancy on either
/// side.
pub const SEARCH_NU: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_is_the_sum_of_costs() {
        let residuals: Vec<f64> = (0..200).map(|k| (f64::from(k) * 0.7).sin() * 10f64.powi(k % 9 - 3)).collect();
        for nu in [1.0, 3.5, f64::INFINITY] {
            let loss = Loss { nu, scale: 0.3 };
            let sum: f64 = residuals.iter().map(|&e| loss.cost(e)).sum();
            assert!((loss.total(residuals.iter().copied()) - sum).abs() < 1e-12 * sum, "{nu}");
            assert_eq!(loss.total([1e200].into_iter()), f64::INFINITY);
            assert!(loss.total([f64::NAN].into_iter()).is_nan());
        }
    }

    #[test]
    fn weight_is_the_derivative_over_the_residual() {
        for nu in [1.0, 3.5, f64::INFINITY] {
            let loss = Loss { nu, scale: 0.3 };
            for e in [-2.0, 0.1, 0.7] {
                let slope = (loss.cost(e + 1e-6) - loss.cost(e - 1e-6)) / 2e-6;
                assert!((slope - loss.weight(e) * e / loss.scale.powi(2)).abs() < 1e-6 * slope.abs().max(1.0));
            }
        }
    }

    #[test]
    fn normal_deviation_of_the_cauchy_loss() {
        // E[2 z^2/(1 + z^2)] = 1 means E[1/(1 + z^2)] = 1/2; with z = tau x that is sqrt(pi/2)/tau
        // e^(1/(2 tau^2)) erfc(1/(tau sqrt 2)) = 1/2, solved by tau = 1.6335.
        assert!((normal_deviation(1.0) - 1.6335).abs() < 1e-3, "{}", normal_deviation(1.0));
        assert!((normal_deviation(1e6) - 1.0).abs() < 1e-5);
    }
}
