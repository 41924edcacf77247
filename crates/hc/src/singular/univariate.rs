//! All roots of a polynomial in one unknown, to many digits: the iteration of Ehrlich and Aberth.
//!
//! Starting points lie on the circles that the Newton polygon of the coefficients gives (Bini
//! 1996). Unlike paths, the iteration can take all the digits it needs where roots depend on the
//! last ones of the coefficients.

use super::equations::{Given, Precision};
use super::number::Number;
use num_complex::Complex64;
use poly::ComplexMulti;

/// Polynomials of a higher degree are left to paths.
const MAX_DEGREE: usize = 3000;
/// Rounds at most; near simple roots the error is cubed in each.
const ROUNDS: usize = 300;
/// Relative corrections that end the iteration for a root, as a logarithm to base 2.
const SMALL: f64 = -50.0;

/// Approximations to all roots but zero, each as often as its multiplicity; `None` for more than
/// one equation or unknown, a degree too high, or if the iteration does not settle.
pub(crate) fn roots(given: &Given) -> Option<Vec<Complex64>> {
    settled::<ComplexMulti<4>>(given).or_else(|| settled::<ComplexMulti<16>>(given))
}

fn settled<S: Precision>(given: &Given) -> Option<Vec<Complex64>> {
    let terms = given.univariate::<S>()?;
    let (lowest, highest) = (terms.first()?.0, terms.last()?.0);
    let degree = usize::try_from(highest - lowest).ok().filter(|&d| d <= MAX_DEGREE)?;
    let terms: Vec<(u32, S)> = terms.into_iter().map(|(e, c)| (e - lowest, c)).collect();
    let mut points = starts::<S>(&terms);
    let mut settled = vec![false; degree];
    for _ in 0..ROUNDS {
        for k in 0..degree {
            if settled[k] {
                continue;
            }
            let z = points[k];
            let (value, slope) = values(&terms, &z);
            if value.vanishes() {
                settled[k] = true;
                continue;
            }
            // p / (p' - p sum 1 / (z - z_j)), in which the sum need not be accurate.
            let mut sum = S::zero();
            for (j, other) in points.iter().enumerate() {
                let difference = S::sub(&z, other);
                if j != k && !difference.vanishes() {
                    sum = S::add(&sum, &inverse(&difference));
                }
            }
            let step = S::div(&value, &S::sub_mul(&value, &sum, &slope));
            let size = step.log2() - z.log2();
            if size.is_nan() {
                return None;
            }
            points[k] = S::sub(&z, &step);
            settled[k] = size < SMALL;
        }
        if settled.iter().all(|&s| s) {
            return Some(points.iter().map(Number::to_c64).collect());
        }
    }
    None
}

/// The reciprocal to the digits of a double.
fn inverse<S: Number>(z: &S) -> S {
    let power = z.log2().round() as i64;
    S::from_c64(z.shifted(-power).to_c64().inv()).shifted(-power)
}

/// Value and derivative of a polynomial, its terms in ascending order.
fn values<S: Number>(terms: &[(u32, S)], z: &S) -> (S, S) {
    let (mut value, mut slope) = (S::zero(), S::zero());
    let mut last = None;
    for &(exponent, c) in terms.iter().rev() {
        for _ in exponent..last.unwrap_or(exponent) {
            slope = S::mul_add(&slope, z, &value);
            value = S::mul(&value, z);
        }
        value = S::add(&value, &c);
        last = Some(exponent);
    }
    (value, slope)
}

/// As many points as roots, on circles of about the sizes of the roots.
fn starts<S: Number>(terms: &[(u32, S)]) -> Vec<S> {
    // The upper hull of the logarithms of the coefficients.
    let mut hull: Vec<(f64, f64)> = Vec::new();
    for (exponent, c) in terms {
        let point = (f64::from(*exponent), c.log2());
        while let [.., a, b] = hull[..] {
            if (b.1 - a.1) * (point.0 - a.0) > (point.1 - a.1) * (b.0 - a.0) {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    let mut points = Vec::new();
    for (side, pair) in hull.windows(2).enumerate() {
        let (a, b) = (pair[0], pair[1]);
        let count = (b.0 - a.0) as usize;
        let radius = (a.1 - b.1) / (b.0 - a.0);
        let whole = radius.floor();
        for k in 0..count {
            let angle = std::f64::consts::TAU * (k as f64 / count as f64 + side as f64 * 0.618) + 0.7;
            points.push(S::from_c64(Complex64::from_polar((radius - whole).exp2(), angle)).shifted(whole as i64));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::roots;
    use crate::singular::equations::Given;
    use num_complex::Complex64;
    use poly::parse::phcpack;

    fn of(text: &str) -> Vec<Complex64> {
        let system = phcpack(text).unwrap();
        roots(&Given::new(&system.expand(&Default::default()).unwrap(), vec![0; system.variables().len()])).unwrap()
    }

    #[test]
    fn wilkinsons_polynomial_and_chebyshevs() {
        let factors: Vec<String> = (1..=20).map(|k| format!("(x-{k})")).collect();
        let mut found = of(&format!("1\n{};", factors.join("*")));
        found.sort_by(|a, b| a.re.total_cmp(&b.re));
        for (k, z) in found.iter().enumerate() {
            assert!((z - (k + 1) as f64).norm() < 1e-13 * (k + 1) as f64, "{found:?}");
        }
        // T_2 (T_3 (T_5)) = T_30.
        let t5 = "(16*x^5-20*x^3+5*x)";
        let t15 = format!("(4*{t5}^3-3*{t5})");
        let mut found = of(&format!("1\n2*{t15}^2-1;"));
        found.sort_by(|a, b| b.re.total_cmp(&a.re));
        assert_eq!(found.len(), 30);
        for (k, z) in found.iter().enumerate() {
            assert!((z - (std::f64::consts::PI * (k as f64 + 0.5) / 30.0).cos()).norm() < 1e-14, "{k}: {z}");
        }
    }

    #[test]
    fn roots_of_all_sizes_and_of_unity() {
        let mut found = of("1\nx^3*(x-1E-200)*(x-1)*(x+1E150);");
        found.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        let want = [1e-200, 1.0, -1e150];
        assert!(found.len() == 3 && found.iter().zip(want).all(|(z, w)| (z - w).norm() < 1e-14 * w.abs()), "{found:?}");
        let found = of("1\nx^150-1;");
        assert!(found.len() == 150 && found.iter().all(|z| (z.powi(150) - 1.0).norm() < 1e-11));
    }
}
