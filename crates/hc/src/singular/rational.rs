//! Ends at points with rational coordinates, examined exactly: whether they are solutions, regular or
//! isolated, and with which multiplicity.

use super::dual::Count;
use super::equations::ExactEquations;
use super::kinds::{LocalStructure, residual};
use super::multiplicity::{Modular, multiplicity};
use super::prime_field::Residue;
use crate::tolerances::structure;
use num_bigint::BigInt;
use num_complex::Complex64;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use poly::Exact;
use std::ops::Add;

/// The local ring of an isolated solution may have this dimension, however few the paths are.
const FEW: usize = 12;
/// Exponents at most: the length of powers of exact numbers grows with them.
const EXPONENT: u32 = 512;

/// The local structure at a rational point near the end of a path, if that point is a solution; at most
/// `most` paths may end at any one point.
///
/// The dual space of the local ring is computed modulo two random primes, which have to agree. Modulo a
/// prime it is at least as large, in every order, as it is with exact numbers. So if it is finite the
/// solution is isolated, and its multiplicity is at most its dimension: less only if both primes divide one
/// of the minors that matter. An isolated solution splits into as many solutions as paths end there. So if
/// the dimension grows beyond the number of paths, the solution lies on a component, unless both primes
/// divide such minors.
pub(super) fn at_rational(
    given: &ExactEquations,
    point: &[Complex64],
    error: f64,
    most: usize,
) -> Option<LocalStructure> {
    let tolerance = (structure::RATIONAL_ERRORS * error).clamp(structure::RATIONAL_LEAST, structure::RATIONAL_MOST);
    let rough = || within(given, point, structure::ROUGH_RATIONAL, structure::ROUGH_DENOMINATOR, most);
    match within(given, point, tolerance, structure::DENOMINATOR, most) {
        Some(structure) => structure,
        None => rough()?.filter(|structure| matches!(structure, LocalStructure::Isolated { .. })),
    }
}

/// [`at_rational`] for a rational point within `tolerance`, with denominators up to `denominator`; `None`
/// if it is no solution. The inner `None` means that its local structure would take too much work.
fn within(
    given: &ExactEquations,
    point: &[Complex64],
    tolerance: f64,
    denominator: f64,
    most: usize,
) -> Option<Option<LocalStructure>> {
    let rational = |(z, &unit): (&Complex64, &i64)| rational(*z, unit, tolerance, denominator);
    let exact: Vec<Exact> = point.iter().zip(given.scales()).map(rational).collect::<Option<_>>()?;
    let [first, second] = given.fields(&exact);
    let images = || exact.iter().map(Residue::image).collect::<Option<Vec<Residue>>>();
    // Few values are computed exactly that are not zero.
    if !first.run(|| Some(vanish(&given.modular(EXPONENT)?, &images()?)))? || !given.vanish_at(&exact) {
        return None;
    }
    let count = || Some(multiplicity(&given.modular(EXPONENT)?, &images()?, most.max(FEW)));
    let multiplicity = first.run(count).filter(|found| second.run(count).as_ref() == Some(found));
    let unscaled = |z: &Exact, unit: i64| {
        let power = 2f64.powi(-unit as i32);
        Some(Complex64::new(z.re.to_f64()? * power, z.im.to_f64()? * power)).filter(|z| z.is_finite())
    };
    let point: Vec<Complex64> =
        exact.iter().zip(given.scales()).map(|(z, &unit)| unscaled(z, unit)).collect::<Option<_>>()?;
    let residual = residual(given, &point);
    Some(match multiplicity.unwrap_or(Count::Unclear) {
        Count::All(1) => Some(LocalStructure::Regular { point, residual }),
        Count::All(multiplicity) => Some(LocalStructure::Isolated { multiplicity, point, residual, is_exact: true }),
        Count::More => Some(LocalStructure::OnComponent { point, is_exact: true }),
        Count::Unfinished | Count::Unclear => None,
    })
}

/// Whether all equations vanish at a point.
fn vanish(equations: &[Modular], point: &[Residue]) -> bool {
    let term = |(powers, c): &(Vec<(usize, u32)>, Residue)| {
        powers.iter().fold(*c, |product, &(j, e)| product * point[j].power(u64::from(e)))
    };
    equations.iter().all(|terms| terms.iter().map(term).fold(Residue::zero(), Residue::add).is_zero())
}

/// The rational with the least denominator near a coordinate in units of `2^unit`.
fn rational(z: Complex64, unit: i64, tolerance: f64, denominator: f64) -> Option<Exact> {
    let power = 2f64.powi(i32::try_from(unit).ok()?);
    let (re, im) = (z.re * power, z.im * power);
    let tolerance = tolerance * re.hypot(im).max(power);
    Some(Exact { re: near(re, tolerance, denominator)?, im: near(im, tolerance, denominator)? })
}

/// The rational with the least denominator near a real number, by its continued fraction.
fn near(x: f64, tolerance: f64, denominator: f64) -> Option<BigRational> {
    if x.is_nan() || x.abs() > structure::RATIONAL_SIZE {
        return None;
    }
    let (mut rest, mut last, mut this) = (x, (1.0, 0.0), (x.floor(), 1.0));
    while (this.0 / this.1 - x).abs() > tolerance {
        rest = 1.0 / (rest - rest.floor());
        let next = |a: f64, b: f64| rest.floor() * a + b;
        (last, this) = (this, (next(this.0, last.0), next(this.1, last.1)));
        if this.1.is_nan() || this.1 > denominator {
            return None;
        }
    }
    Some(BigRational::new(BigInt::from(this.0 as i64), BigInt::from(this.1 as i64)))
}

#[cfg(test)]
mod tests {
    use super::{at_rational, near};
    use crate::singular::{ExactEquations, LocalStructure};
    use num_complex::Complex64;
    use num_traits::ToPrimitive;
    use proptest::prelude::{prop_assert_eq, proptest};

    proptest! {
        #[test]
        fn fractions_are_found(a in -100_000i32..100_000, b in 1i32..1000, e in -1.0..1.0f64) {
            let x = f64::from(a) / f64::from(b);
            let found = near(x + 1e-8 * e, 1e-8, 1e3).and_then(|q| q.to_f64());
            prop_assert_eq!(found, Some(x));
        }
    }

    fn structure(text: &str, point: &[f64], most: usize) -> Option<LocalStructure> {
        let system = poly::parse::phcpack(text).unwrap();
        let given = ExactEquations::new(&system.expand(&Default::default()).unwrap(), vec![0; point.len()]);
        let point: Vec<Complex64> = point.iter().map(|&x| Complex64::new(x, 0.0)).collect();
        at_rational(&given, &point, 1e-9, most)
    }

    fn is_isolated(found: Option<LocalStructure>, expected: usize) -> bool {
        matches!(found, Some(LocalStructure::Isolated { multiplicity, .. }) if multiplicity == expected)
    }

    /// The first: Dayton & Zeng 2005, multiplicity 131. Quadrics without common points at infinity
    /// of their leading forms: Bezout's number.
    #[test]
    fn multiplicities_at_rational_points() {
        let dz1 = "4\na^4-b*c*d;\nb^4-a*c*d;\nc^4-a*b*d;\nd^4-a*b*c;";
        assert!(is_isolated(structure(dz1, &[0.0, 1e-10, 0.0, 0.0], 131), 131));
        let quadrics = "5\na^2;\nb^2+a*b;\nc^2-3*a*c+b^2;\nd^2-a*b;\ne^2-c*d;";
        assert!(is_isolated(structure(quadrics, &[0.0; 5], 32), 32));
        assert!(is_isolated(structure("2\n(3*x-1)^3;\n(y-2)^2+(3*x-1);", &[1.0 / 3.0, 2.0], 6), 6));
        let gaussian = "2\n(x-y*i)^3;\n(y-2)^2+(x-2*i);";
        let system = poly::parse::phcpack(gaussian).unwrap();
        let given = ExactEquations::new(&system.expand(&Default::default()).unwrap(), vec![0; 2]);
        let found = at_rational(&given, &[Complex64::new(0.0, 2.0), Complex64::new(2.0, 0.0)], 1e-9, 20);
        // With y = 2 + w and x = i y: w^2 + i w, simple.
        assert!(is_isolated(found, 3));
    }

    #[test]
    fn other_points() {
        assert!(matches!(structure("2\nx^2-1;\ny-2*x;", &[1.0, 2.0], 2), Some(LocalStructure::Regular { .. })));
        // No solution, an irrational one, ones on lines.
        assert_eq!(structure("2\nx^2-1;\ny-2*x;", &[1.0, 2.5], 2), None);
        assert_eq!(structure("2\nx^2-2;\ny-2*x;", &[2f64.sqrt(), 8f64.sqrt()], 2), None);
        let is_on =
            |text: &str, point: &[f64]| matches!(structure(text, point, 8), Some(LocalStructure::OnComponent { .. }));
        assert!(is_on("2\nx*y;\nx*(y-1);", &[0.0, 0.5]));
        // A plane and a double line, where they meet, and beside that.
        assert!(is_on("3\nx*y^2;\nx*z;\nx*(x-y);", &[0.0; 3]));
        assert!(is_on("2 3\nx*y^2;\nx*z;", &[3.0, 0.0, 0.0]));
    }
}
