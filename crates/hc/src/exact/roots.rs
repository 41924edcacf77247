//! All roots of a polynomial in one unknown, to many digits: those of its square-free factors, by the
//! iteration of Ehrlich and Aberth.
//!
//! Starting points lie on the circles that the Newton polygon of the coefficients gives (Bini
//! 1996). Roots may depend on the last digits of the coefficients; unlike paths, the iteration can
//! take all the digits that it then needs. In the end each root has a disc of its own (Smith 1970):
//! no root is missed, and roots that round to the same double are separated.

use super::squarefree::squarefree;
use crate::singular::Number;
use crate::tolerances::structure;
use num_complex::Complex64;
use poly::{ComplexMulti, Exact, Monomial, Polynomial, Scalar};

/// Numbers of 77 digits, for solutions that paths do not tell.
pub(crate) type Digits = ComplexMulti<4>;

/// Polynomials of a higher degree are left to paths.
const MAX_DEGREE: usize = 3000;
/// Most rounds; near simple roots each cubes the error.
const ROUNDS: usize = 300;

/// The number of all roots, with their multiplicities, of a single polynomial in a single unknown; of
/// negative exponents, those of its product with a power. `None` for any other polynomials.
pub(crate) fn number_of_roots(polynomials: &[Polynomial<Exact>]) -> Option<usize> {
    let [polynomial] = polynomials else { return None };
    let exponents: Vec<i64> = polynomial.terms().iter().flat_map(|(m, _)| m.exponents()).map(|&e| e.into()).collect();
    let (lowest, highest) = (*exponents.iter().min()?, *exponents.iter().max()?);
    if polynomial.variables() == 1 { usize::try_from(highest - lowest.min(0)).ok() } else { None }
}

/// All roots of a polynomial in one unknown to 45 digits, with their multiplicities: those of its
/// square-free factors, which are simple; `None` if they are not all clear. Several may be one double.
pub(super) fn roots_with_multiplicities(polynomial: &Polynomial<Exact>, seed: u64) -> Option<Vec<(Digits, usize)>> {
    let mut all = Vec::new();
    for (part, multiplicity) in squarefree(polynomial, seed)? {
        let has_zero = part.terms().iter().all(|(monomial, _)| monomial.exponents() != [0]);
        let roots = roots(&part)?.into_iter().chain(has_zero.then(Digits::zero));
        all.extend(roots.map(|root| (root, multiplicity)));
    }
    let count: usize = all.iter().map(|(_, multiplicity)| multiplicity).sum();
    (i64::try_from(count).ok() == polynomial.degree()).then_some(all)
}

/// All roots but zero of a polynomial without negative exponents; `None` if the degree is too high, or
/// the roots cannot be told apart because some are multiple.
fn roots(polynomial: &Polynomial<Exact>) -> Option<Vec<Digits>> {
    settled::<ComplexMulti<4>>(polynomial).or_else(|| settled::<ComplexMulti<16>>(polynomial))
}

fn settled<S: Number>(polynomial: &Polynomial<Exact>) -> Option<Vec<Digits>> {
    let term = |(m, c): &(Monomial, Exact)| Some((u32::try_from(*m.exponents().first()?).ok()?, S::from_exact(c)));
    let mut terms: Vec<(u32, S)> = polynomial.terms().iter().map(term).collect::<Option<_>>()?;
    terms.sort_by_key(|&(exponent, _)| exponent);
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
            let mut nearest = z.log2();
            for (j, other) in points.iter().enumerate() {
                let difference = S::sub(&z, other);
                if j != k && !difference.vanishes() {
                    nearest = nearest.min(difference.log2());
                    sum = S::add(&sum, &inverse(&difference));
                }
            }
            let step = S::div(&value, &S::sub_mul(&value, &sum, &slope));
            let size = step.log2() - nearest;
            if size.is_nan() {
                return None;
            }
            points[k] = S::sub(&z, &step);
            settled[k] = size < structure::ROOT_CORRECTION;
        }
        if settled.iter().all(|&s| s) {
            return are_apart(&terms, &points).then(|| points.iter().map(digits).collect());
        }
    }
    None
}

/// The sum of the three doubles that come nearest.
fn digits<S: Number>(z: &S) -> Digits {
    let (mut rest, mut sum) = (*z, Digits::zero());
    for _ in 0..3 {
        let part = rest.to_c64();
        rest = S::sub(&rest, &S::from_c64(part));
        sum = Digits::add(&sum, &Digits::from_c64(part));
    }
    sum
}

/// Whether discs about the points, each of which holds a root if it meets no other, are disjoint:
/// their radii are the degree times what is left of the polynomial there, divided by the distances
/// from the other points and by the leading coefficient (Smith 1970, J. ACM 17, theorem 1).
fn are_apart<S: Number>(terms: &[(u32, S)], points: &[S]) -> bool {
    let Some((_, leading)) = terms.last() else { return false };
    let degree = (points.len() as f64).log2();
    let distance = |j: usize, k: usize| S::sub(&points[j], &points[k]).log2();
    let radius = |k: usize| {
        let z = &points[k];
        let size = terms.iter().map(|(e, c)| c.log2() + f64::from(*e) * z.log2()).fold(f64::NEG_INFINITY, f64::max);
        let value = values(terms, z).0.log2().max(size + structure::ROOT_ERROR - S::BITS);
        let others: f64 = (0..points.len()).filter(|&j| j != k).map(|j| distance(j, k)).sum();
        1.0 + degree + value - leading.log2() - others
    };
    let radii: Vec<f64> = (0..points.len()).map(radius).collect();
    // Written so that NaN is not apart.
    (0..points.len()).all(|k| (0..k).all(|j| distance(j, k) > radii[j].max(radii[k]) + 1.0))
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
    use super::{Digits, roots};
    use num_complex::Complex64;
    use poly::parse::phcpack;

    fn of(text: &str) -> Vec<Complex64> {
        found(text).unwrap()
    }

    fn found(text: &str) -> Option<Vec<Complex64>> {
        let system = phcpack(text).unwrap();
        Some(roots(&system.expand(&Default::default()).unwrap()[0])?.iter().map(Digits::to_c64).collect())
    }

    /// Mignotte's polynomials `x^d - 2 (a x - 1)^2` have two roots at about `a^(-1 - d/2)` from each
    /// other.
    #[test]
    fn roots_that_are_one_double() {
        for (d, a) in [(21, 1000), (15, 10), (31, 1000)] {
            let roots = of(&format!("1\nx^{d}-2*({a}*x-1)^2;"));
            let near = roots.iter().filter(|z| (**z * f64::from(a) - 1.0).norm() < 1e-6).count();
            assert_eq!((roots.len(), near), (d, 2), "{d} {a}");
        }
        assert_eq!(found("1\n(x-1)^2*(x+3);"), None);
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
