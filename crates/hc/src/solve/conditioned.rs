//! Nearly dependent equations, rewritten as equations that are not.

use crate::tolerances::equations;
use num_complex::Complex64;
use num_traits::{ToPrimitive, Zero};
use poly::{Exact, Monomial, Polynomial};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Systems with more coefficients than this, zeros included, are not examined.
const MAX_SIZE: usize = 1 << 20;

/// The polynomials themselves, or, if some nearly depend on others, polynomials that span the same
/// space. Exact multiples of the others are then subtracted from the dependent ones, so that
/// rounding does not destroy their difference.
pub(super) fn conditioned(polynomials: &[Polynomial<Exact>]) -> Cow<'_, [Polynomial<Exact>]> {
    let mut monomials: BTreeMap<&Monomial, usize> = BTreeMap::new();
    for (monomial, _) in polynomials.iter().flat_map(Polynomial::terms) {
        let next = monomials.len();
        monomials.entry(monomial).or_insert(next);
    }
    if polynomials.len().saturating_mul(monomials.len()) > MAX_SIZE {
        return Cow::Borrowed(polynomials);
    }
    let nearly = nearly_dependent(polynomials, &monomials);
    if !nearly.contains(&true) {
        return Cow::Borrowed(polynomials);
    }
    let mut pivots: Vec<(Monomial, Polynomial<Exact>)> = Vec::new();
    let mut result = Vec::with_capacity(polynomials.len());
    for (polynomial, &nearly) in polynomials.iter().zip(&nearly) {
        let mut rest = polynomial.clone();
        for (monomial, pivot) in &pivots {
            if let (Some(a), Some(b)) = (coefficient(&rest, monomial), coefficient(pivot, monomial)) {
                rest = &rest + &pivot.scaled(&-(a / b));
            }
        }
        let size = |c: &Exact| c.re.to_f64().unwrap_or(0.0).hypot(c.im.to_f64().unwrap_or(0.0));
        let largest = rest.terms().iter().max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)));
        // Equations that depend on others exactly stay.
        let Some((monomial, _)) = largest else { return Cow::Borrowed(polynomials) };
        pivots.push((monomial.clone(), rest.clone()));
        result.push(if nearly { rest } else { polynomial.clone() });
    }
    Cow::Owned(result)
}

fn coefficient(polynomial: &Polynomial<Exact>, monomial: &Monomial) -> Option<Exact> {
    polynomial.terms().iter().find(|(m, _)| m == monomial).map(|(_, c)| c.clone()).filter(|c| !c.is_zero())
}

/// Which polynomials are nearly combinations of those before them, by Gram and Schmidt's
/// orthogonalisation.
fn nearly_dependent(polynomials: &[Polynomial<Exact>], monomials: &BTreeMap<&Monomial, usize>) -> Vec<bool> {
    let mut basis: Vec<Vec<Complex64>> = Vec::new();
    let mut nearly = Vec::with_capacity(polynomials.len());
    for polynomial in polynomials {
        let mut row = vec![Complex64::new(0.0, 0.0); monomials.len()];
        for (monomial, c) in polynomial.terms() {
            row[monomials[monomial]] = Complex64::new(c.re.to_f64().unwrap_or(0.0), c.im.to_f64().unwrap_or(0.0));
        }
        normalise(&mut row);
        // Twice, for what rounding leaves.
        for _ in 0..2 {
            make_orthogonal(&mut row, &basis);
        }
        nearly.push(normalise(&mut row) < equations::DEPENDENT);
        basis.push(row);
    }
    nearly
}

/// Subtracts from a row its part along each vector of an orthonormal basis, one after the other.
pub(super) fn make_orthogonal(row: &mut [Complex64], basis: &[Vec<Complex64>]) {
    for known in basis {
        let product: Complex64 = known.iter().zip(&*row).map(|(a, b)| a.conj() * b).sum();
        row.iter_mut().zip(known).for_each(|(z, a)| *z -= product * a);
    }
}

/// Divides a vector by its length, and returns the length.
fn normalise(row: &mut [Complex64]) -> f64 {
    let largest = row.iter().map(|z| z.norm()).fold(0.0, f64::max);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let length = largest * row.iter().map(|z| (z / largest).norm_sqr()).sum::<f64>().sqrt();
    row.iter_mut().for_each(|z| *z /= length);
    length
}

#[cfg(test)]
mod tests {
    use super::conditioned;
    use poly::parse::phcpack;
    use std::borrow::Cow;

    fn of(text: &str) -> Option<Vec<String>> {
        let system = phcpack(text).unwrap();
        let polynomials = system.expand(&Default::default()).unwrap();
        match conditioned(&polynomials) {
            Cow::Borrowed(_) => None,
            Cow::Owned(all) => Some(all.iter().map(|p| p.display(&["x", "y"]).to_string()).collect()),
        }
    }

    #[test]
    fn only_what_nearly_depends_on_others_is_rewritten() {
        assert_eq!(of("2\nx^2+y^2-2;\nx^2-y;"), None);
        assert_eq!(of("2\nx+y;\n2*x+2*y;"), None);
        let found = of("2\nx^2+y-2;\n3*x^2+3*y-6+1E-12*x*y;").unwrap();
        assert_eq!(found, ["x^2 + y - 2", "1/1000000000000*x*y"]);
    }
}
