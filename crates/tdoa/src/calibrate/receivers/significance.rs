//! How improbable it is that noise alone looks this much like an error of a receiver.

/// Probability of a false alarm in data with normal noise, at most.
const FALSE_ALARM: f64 = 5e-3;

/// Probability of a false alarm for errors that are no more than doubts.
const FALSE_DOUBT: f64 = 0.1;

/// Surprise above which the best of so many tests of each of the four kinds is no chance.
pub(crate) fn least_surprise(tests: f64) -> f64 {
    (tests * 4.0 / FALSE_ALARM).ln()
}

/// By how much less surprise is worth a doubt.
pub(crate) fn doubt() -> f64 {
    (FALSE_DOUBT / FALSE_ALARM).ln()
}

/// A gain below which no error of one size has that surprise: the gain it has is below it by less
/// than ln(4 s)/2 for a surprise s.
pub(crate) fn least_gain(tests: f64) -> f64 {
    let least = least_surprise(tests);
    least - 0.5 * (4.0 * least).ln()
}

/// Logarithm of one over the probability that normal noise makes an error gain as much or more, at
/// least. The error has so many columns, one to three; `freedom` is the number of measurements left over
/// beside it.
///
/// The share x that q columns explain of the squares of the residuals follows the distribution of
/// Beta(q/2, f/2), and the gain is -f/2 ln(1 - x). With two columns the probability is
/// (1 - x)^(f/2). With one it is at most (1 - x)^a / (a B(a, 1/2) sqrt(x)) for a = f/2, from
/// (1 - t)^(-1/2) <= x^(-1/2) under the integral, and a B(a, 1/2) >= sqrt(pi (a + 1/4)) (Watson
/// 1959, A note on gamma functions). With three it is larger by 2 a (1 - x)^a sqrt(x) / (a B(a, 1/2)),
/// the recurrence of the incomplete beta function (Abramowitz and Stegun 26.5.16).
pub(crate) fn surprise(gain: f64, freedom: f64, columns: usize) -> f64 {
    if columns == 2 {
        return gain;
    }
    let a = 0.5 * freedom;
    let x = -(-gain / a).exp_m1();
    let scale = std::f64::consts::PI * (a + 0.25);
    if columns == 1 {
        return gain + (0.5 * (scale * x).ln()).max(0.0);
    }
    (gain + 0.5 * (scale * x).ln() - (2.0 * a * x).ln_1p()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::surprise;

    /// Probability that Student's t with `f` degrees of freedom is at least `t` in size, by the
    /// finite series for even f (Abramowitz and Stegun 26.7.4).
    fn student(t: f64, f: u32) -> f64 {
        let angle = (t / f64::from(f).sqrt()).atan();
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..f / 2 {
            let k = f64::from(k);
            term *= (2.0 * k - 1.0) / (2.0 * k) * angle.cos().powi(2);
            sum += term;
        }
        1.0 - angle.sin() * sum
    }

    #[test]
    fn the_probability_of_one_column_is_that_of_students_t() {
        for f in [4, 10, 40, 200] {
            for t in [2.5, 3.5, 5.0] {
                // x = t^2 / (t^2 + f).
                let gain = 0.5 * f64::from(f) * (t * t / f64::from(f)).ln_1p();
                let probability = (-surprise(gain, f64::from(f), 1)).exp();
                let exact = student(t, f);
                // A bound from above that is no more than 40 % off where the test decides.
                assert!(probability >= exact * (1.0 - 1e-9), "{f} {t}: {probability} {exact}");
                assert!(probability <= 1.4 * exact, "{f} {t}: {probability} {exact}");
            }
        }
    }

    #[test]
    fn the_probability_of_three_columns_is_that_of_beta() {
        for f in [4.0, 10.0, 40.0, 200.0f64] {
            for gain in [4.0, 8.0, 14.0] {
                let probability = (-surprise(gain, f, 3)).exp();
                let exact = statrs::function::beta::beta_reg(0.5 * f, 1.5, (-2.0 * gain / f).exp());
                assert!(probability >= exact * (1.0 - 1e-9), "{f} {gain}: {probability} {exact}");
                assert!(probability <= 1.2 * exact, "{f} {gain}: {probability} {exact}");
            }
        }
    }
}
