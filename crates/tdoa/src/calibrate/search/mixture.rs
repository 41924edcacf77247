//! The distribution of errors that only lengthen. A measurement is right up to normal noise, or
//! also late by an exponentially distributed length, or a gross error. Noise together with an
//! exponentially distributed length gives an exponentially modified normal distribution (Grushka
//! 1972). The mixture is fitted by expectation and maximisation (Dempster, Laird and Rubin 1977).

use std::f64::consts::{PI, SQRT_2, TAU};

/// Smallest share of late measurements, and largest one; the same of gross errors.
const LATE: [f64; 2] = [0.005, 0.9];
const GROSS: [f64; 2] = [1e-4, 0.01];

/// Share of late measurements and their mean in deviations, share of gross errors and their reach in
/// deviations, that a fit starts with.
const FIRST_SHARE: f64 = 0.3;
const FIRST_MEAN: f64 = 4.0;
const FIRST_GROSS: f64 = 0.01;
const REACH: f64 = 30.0;

/// Late measurements are late by at least this many deviations in the mean: shorter ones cannot be
/// told from noise.
const LEAST_MEAN: f64 = 2.0;

/// Deviation over mean lateness, at most.
const LARGEST_RATE: f64 = 10.0;

/// The weight of a measurement in the normal equations is at least this share of that of one that
/// is on time, so that no node is free.
pub(crate) const LEAST_WEIGHT: f64 = 0.02;

/// Least weight of what a measurement says beside the others, which may be next to nothing.
const LEAST_SITE: f64 = 0.002;

/// Steps of fitting a mixture to residuals, at most.
const STEPS: usize = 200;

/// Mixture of measurements that are on time, late ones and gross errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mixture {
    /// Share of late measurements.
    pub(crate) share: f64,
    /// How late they are in the mean, in the unit of the residuals.
    pub(crate) mean: f64,
    /// Share of gross errors, which are uniform from minus to plus `reach`.
    pub(crate) gross: f64,
    pub(crate) reach: f64,
    /// Deviation of the noise, in that unit.
    pub(crate) deviation: f64,
}

/// Density of a residual, times the deviation and the root of 2 pi, in parts.
struct Parts {
    on_time: f64,
    late: f64,
    gross: f64,
    /// Derivative of `late` by the residual in deviations.
    late_slope: f64,
    /// How late it is if it is late, in deviations.
    lateness: f64,
}

impl Parts {
    fn all(&self) -> f64 {
        self.on_time + self.late + self.gross
    }
}

/// Sums over residuals, each with its probabilities to be on time, late and gross.
#[derive(Default)]
struct Sums {
    on_time: f64,
    late: f64,
    gross: f64,
    /// Squares of those on time, and lengths by which the late are late.
    square: f64,
    length: f64,
}

impl Sums {
    fn add(&mut self, parts: &Parts, square: f64, deviation: f64) {
        let all = parts.all();
        // Where all parts vanish nothing is known.
        if !(all > 0.0 && square.is_finite()) {
            return;
        }
        self.on_time += parts.on_time / all;
        self.late += parts.late / all;
        self.gross += parts.gross / all;
        self.square += parts.on_time / all * square;
        self.length += parts.late / all * parts.lateness * deviation;
    }
}

impl Mixture {
    /// One to start from, for residuals of about this deviation, late measurements among them.
    pub(crate) fn first(deviation: f64) -> Mixture {
        let (mean, reach) = (FIRST_MEAN * deviation, REACH * deviation);
        Mixture { share: FIRST_SHARE, mean, gross: FIRST_GROSS, reach, deviation }
    }

    /// Deviation over mean lateness.
    fn rate(&self) -> f64 {
        (self.deviation / self.mean).min(LARGEST_RATE)
    }

    fn parts(&self, residual: f64) -> Parts {
        let (u, a) = (residual / self.deviation, self.rate());
        let bell = (-0.5 * u * u).exp();
        // The density of normal noise and an exponentially distributed length.
        let late = a * TAU.sqrt() * exponential_times_normal(a, u);
        // Mean of a normal variable about u - a that is known to be positive.
        let lateness = if late > 0.0 { (u - a + a * bell / late).max(0.0) } else { 0.0 };
        Parts {
            on_time: self.punctual().max(0.0) * bell,
            late: self.share * late,
            gross: self.gross * TAU.sqrt() * self.deviation / (2.0 * self.reach),
            late_slope: self.share * a * (bell - late),
            lateness,
        }
    }

    /// Negative log-likelihood of a residual, up to that of the deviation.
    pub(crate) fn cost(&self, residual: f64) -> f64 {
        -self.parts(residual).all().ln()
    }

    /// Derivative of the cost by the residual in deviations.
    pub(crate) fn score(&self, residual: f64) -> f64 {
        let p = self.parts(residual);
        (p.on_time * residual / self.deviation - p.late_slope) / p.all()
    }

    /// Second derivative of the cost by the residual in deviations.
    fn curvature(&self, residual: f64) -> f64 {
        let (p, u, a) = (self.parts(residual), residual / self.deviation, self.rate());
        let bell = (-0.5 * u * u).exp();
        let late = -self.share * a * u * bell - a * p.late_slope;
        let slope = (p.on_time * u - p.late_slope) / p.all();
        slope * slope - (p.on_time * (u * u - 1.0) + late) / p.all()
    }

    /// Share of measurements that are on time.
    pub(crate) fn punctual(&self) -> f64 {
        1.0 - self.share - self.gross
    }

    /// Probability that a measurement is on time.
    pub(crate) fn on_time(&self, residual: f64) -> f64 {
        let p = self.parts(residual);
        p.on_time / p.all()
    }

    /// A weight for the normal equations, and the residual that has the derivative of the cost with
    /// that weight.
    pub(crate) fn terms(&self, residual: f64) -> (f64, f64) {
        let weight = self.on_time(residual).max(LEAST_WEIGHT);
        (weight / (self.deviation * self.deviation), self.score(residual) / weight * self.deviation)
    }

    /// Fisher information of one measurement on its length, in that of one that is known to be on
    /// time: the mean square of the score.
    pub(crate) fn information(&self) -> f64 {
        // Beyond, the score is that of late measurements alone, and before, there are none.
        let (from, to, step) = (-8.0, 12.0, 0.02);
        let mut sum = 0.0;
        for k in 0..((to - from) / step) as usize {
            let p = self.parts((from + (k as f64 + 0.5) * step) * self.deviation);
            let u = from + (k as f64 + 0.5) * step;
            let density = p.on_time + p.late;
            sum += step / TAU.sqrt() * (p.on_time * u - p.late_slope).powi(2) / density;
        }
        let a = self.rate();
        sum + a * a * self.share * (-a * to).exp()
    }

    /// A step of expectation and maximisation: the mixture that explains residuals better, of which
    /// `unknowns` were fitted. The deviation is at least `least`.
    pub(crate) fn updated(&self, residuals: &[f64], unknowns: usize, least: f64) -> Mixture {
        let mut sums = Sums::default();
        for &e in residuals {
            sums.add(&self.parts(e), e * e, self.deviation);
        }
        // What was fitted was fitted to those on time.
        let left = (sums.on_time - unknowns as f64).max(0.1 * sums.on_time).max(1.0);
        self.with(&sums, (sums.square / left).sqrt().max(least))
    }

    fn with(&self, sums: &Sums, deviation: f64) -> Mixture {
        let all = (sums.on_time + sums.late + sums.gross).max(1.0);
        let deviation = deviation.max(f64::MIN_POSITIVE);
        let gross = (sums.gross / all).clamp(GROSS[0], GROSS[1]);
        let share = (sums.late / all).clamp(LATE[0], LATE[1]).min(0.99 - gross);
        let mean = (sums.length / sums.late.max(1e-9)).max(LEAST_MEAN * deviation);
        Mixture { share, mean, gross, reach: self.reach, deviation }
    }

    /// The mixture of residuals that are known with this variance, in squares of the deviation.
    fn widened(&self, variance: f64) -> Mixture {
        Mixture { deviation: self.deviation * (1.0 + variance).sqrt(), ..*self }
    }

    /// What a measurement says of its residual, of which the others say that it is `residual` with
    /// this variance (in squares of the deviation): the normal distribution, of a share of the
    /// information of one on time and with a mean, that has the same mean and variance together with
    /// what the others say.
    pub(crate) fn site(&self, residual: f64, variance: f64) -> (f64, f64) {
        let wide = self.widened(variance);
        let scale = 1.0 / (1.0 + variance);
        let slope = wide.score(residual) * scale.sqrt();
        let curvature = wide.curvature(residual) * scale;
        let weight = (curvature / (1.0 - variance * curvature)).clamp(LEAST_SITE, 1.0);
        (weight, residual - slope * (1.0 + weight * variance) / weight * self.deviation)
    }

    /// A step of expectation and maximisation for residuals of which the others say what they are, with variances in
    /// squares of the deviation; the deviation is `known` or estimated.
    pub(crate) fn updated_by(&self, cavities: &[(f64, f64)], known: Option<f64>, least: f64) -> Mixture {
        let mut sums = Sums::default();
        for &(e, variance) in cavities {
            let wide = self.widened(variance);
            let (mean, spread) = (e / (1.0 + variance), variance / (1.0 + variance) * self.deviation * self.deviation);
            sums.add(&wide.parts(e), mean * mean + spread, wide.deviation);
        }
        self.with(&sums, known.unwrap_or((sums.square / sums.on_time.max(1.0)).sqrt()).max(least))
    }

    /// The mixture of largest likelihood for residuals, from this one.
    pub(crate) fn fitted(mut self, residuals: &[f64], unknowns: usize, least: f64) -> Mixture {
        for _ in 0..STEPS {
            let next = self.updated(residuals, unknowns, least);
            let calm = (next.deviation - self.deviation).abs() < 1e-6 * self.deviation;
            self = next;
            if calm {
                break;
            }
        }
        self
    }
}

/// exp(a^2/2 - a u) times the normal distribution function at u - a.
fn exponential_times_normal(a: f64, u: f64) -> f64 {
    let z = (a - u) / SQRT_2;
    if z > 20.0 {
        // erfc(z) = exp(-z^2) / (z sqrt pi) (1 - 1/(2 z^2) + ...), and the exponents are -u^2/2.
        return 0.5 * (-0.5 * u * u).exp() / (z * PI.sqrt()) * (1.0 - 0.5 / (z * z));
    }
    0.5 * (0.5 * a * a - a * u).exp() * libm::erfc(z)
}

#[cfg(test)]
mod tests {
    use super::{Mixture, exponential_times_normal};
    use rand::{RngExt, SeedableRng};
    use rand_distr::{Exp1, StandardNormal};
    use rand_pcg::Pcg64Mcg;
    use std::f64::consts::TAU;

    const MIXTURES: [Mixture; 3] = [
        Mixture { share: 0.5, mean: 0.5, gross: 1e-3, reach: 5.0, deviation: 0.01 },
        Mixture { share: 0.1, mean: 0.03, gross: 0.1, reach: 0.2, deviation: 0.01 },
        Mixture { share: 0.3, mean: 40.0, gross: 1e-4, reach: 100.0, deviation: 2.0 },
    ];

    #[test]
    fn the_score_is_the_derivative_of_the_cost() {
        for mixture in MIXTURES {
            for u in [-40.0, -6.0, -2.0, -0.3, 0.0, 0.7, 2.4, 3.0, 5.0, 30.0, 300.0] {
                let (e, h) = (u * mixture.deviation, 1e-5 * mixture.deviation);
                let difference = (mixture.cost(e + h) - mixture.cost(e - h)) / 2e-5;
                let score = mixture.score(e);
                assert!(
                    (difference - score).abs() < 1e-6 * (1.0 + score.abs()),
                    "{mixture:?} {u}: {difference} {score}"
                );
                let difference = (mixture.score(e + h) - mixture.score(e - h)) / 2e-5;
                let curvature = mixture.curvature(e);
                assert!((difference - curvature).abs() < 1e-5 * (1.0 + curvature.abs()), "{difference} {curvature}");
                let (weight, target) = mixture.terms(e);
                assert!((weight * target * mixture.deviation - score).abs() < 1e-9 * (1.0 + score.abs()));
            }
        }
    }

    #[test]
    fn the_density_has_mass_one_and_the_mean_of_the_late() {
        for mixture in MIXTURES {
            let step = 0.01 * mixture.deviation;
            let (mut mass, mut mean) = (0.0, 0.0);
            for k in -1000..(60.0 * mixture.mean / step) as i64 {
                let e = k as f64 * step;
                let p = mixture.parts(e);
                let scale = TAU.sqrt() * mixture.deviation;
                assert!((p.gross / scale - mixture.gross / (2.0 * mixture.reach)).abs() < 1e-12);
                let density = (p.on_time + p.late) / scale;
                mass += step * density;
                mean += step * density * e;
            }
            assert!((mass + mixture.gross - 1.0).abs() < 1e-6, "{mass}");
            let expected = mixture.share * mixture.mean;
            assert!((mean - expected).abs() < 1e-6 * expected.max(mixture.deviation), "{mean} {expected}");
        }
    }

    #[test]
    fn without_late_measurements_it_is_the_normal_distribution() {
        let mixture = Mixture { share: 0.0, mean: 0.5, gross: 1e-9, reach: 5.0, deviation: 0.01 };
        for u in [-3.0f64, -1.0, 0.0, 0.5, 2.0, 4.0] {
            // But for gross errors, one in a thousand million.
            assert!((mixture.cost(0.01 * u) - 0.5 * u * u).abs() < 1e-2, "{u}");
            assert!((mixture.score(0.01 * u) - u).abs() < 1e-2, "{u}");
        }
        assert!((mixture.information() - 1.0).abs() < 1e-4, "{}", mixture.information());
        // A gross error costs the same wherever it is: its share and density over those of noise.
        let gross = -(1e-9 * TAU.sqrt() * 0.01 / 10.0).ln();
        assert!([-1e9, -1.0, 1e9].iter().all(|&e| (mixture.cost(e) - gross).abs() < 1e-9));
    }

    #[test]
    fn a_site_has_the_moments_of_the_mixture_beside_the_others() {
        for mixture in MIXTURES {
            for (u, variance) in [(-1.0, 0.3), (0.5, 2.0), (1.0, 0.1), (8.0, 0.5), (30.0, 5.0)] {
                // Mean and variance by sums over the mixture times a normal density, in deviations.
                let mut sums = [0.0; 3];
                for k in -6000..12000 {
                    let x = 0.005 * k as f64;
                    let p = mixture.parts(x * mixture.deviation);
                    let density = p.all() * (-0.5 * (x - u) * (x - u) / variance).exp();
                    sums = [sums[0] + density, sums[1] + density * x, sums[2] + density * x * x];
                }
                let mean = sums[1] / sums[0];
                let spread = sums[2] / sums[0] - mean * mean;
                let (weight, target) = mixture.site(u * mixture.deviation, variance);
                let together = 1.0 / (1.0 / variance + weight);
                let found = together * (u / variance + weight * target / mixture.deviation);
                assert!((found - mean).abs() < 1e-3 * (1.0 + mean.abs()), "{mixture:?} {u} {variance}: {found} {mean}");
                // A site is never wider than nothing nor narrower than a measurement on time.
                if weight > 0.01 && weight < 0.99 {
                    assert!((together / spread - 1.0).abs() < 1e-2, "{mixture:?} {u}: {together} {spread}");
                }
            }
        }
    }

    #[test]
    fn the_tails_meet() {
        for a in [1e-6, 0.02, 0.5] {
            let u = a - 20.0 * 2f64.sqrt();
            let [below, above] = [-1e-9, 1e-9].map(|h| exponential_times_normal(a, u + h));
            assert!((below / above - 1.0).abs() < 1e-5, "{a}: {below} {above}");
        }
    }

    #[test]
    fn a_mixture_is_found_in_its_draws() {
        let truth = Mixture { share: 0.4, mean: 0.5, gross: 0.0, reach: 1.0, deviation: 0.01 };
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let draws: Vec<f64> = (0..40_000)
            .map(|k| {
                let late = if k % 5 < 2 { truth.mean * rng.sample::<f64, _>(Exp1) } else { 0.0 };
                late + truth.deviation * rng.sample::<f64, _>(StandardNormal)
            })
            .collect();
        let start = Mixture::first(0.1);
        let found = start.fitted(&draws, 0, 0.0);
        // Deviations of the estimates from 24,000 draws on time and 16,000 late ones are 0.5 and
        // 0.8 % at least; the share is known to a fortieth of a thousandth by draws that can be told.
        assert!((found.deviation / truth.deviation - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.mean / truth.mean - 1.0).abs() < 0.03, "{found:?}");
        assert!((found.share - truth.share).abs() < 0.005, "{found:?}");
        // The information is the mean square of the score: 40,000 of them, each at most six.
        let mean = draws.iter().map(|&e| truth.score(e).powi(2)).sum::<f64>() / draws.len() as f64;
        assert!((truth.information() - mean).abs() < 0.02, "{} {mean}", truth.information());
    }
}
