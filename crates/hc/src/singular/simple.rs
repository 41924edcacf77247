//! Whether two polynomials in two unknowns have no multiple common roots, proved by their resultant
//! modulo a prime.

use super::modular::{PRIME, difference, image, inverse, is_squarefree, resultant, sum, times, trim};
use crate::random::{Random, Stream};
use poly::{Exact, Polynomial};

/// Systems with more roots are not looked at.
const MAX_ROOTS: usize = 600;

/// A term modulo the prime: exponents and coefficient.
type Term = ([usize; 2], u64);

/// Whether all common roots are isolated and simple; false tells nothing.
///
/// After a random change `x = u - t y` of coordinates the resultant with respect to `y` has the
/// coordinates `u` of all finite roots as roots, with the same multiplicities. If it had a multiple
/// one, so would its image modulo the prime, unless the leading coefficient vanishes there: of all
/// `t`, at most one in 1e13 does that.
pub(crate) fn all_simple(polynomials: &[Polynomial<Exact>]) -> bool {
    eliminated(polynomials).is_some_and(|whole| whole.len() > 1 && is_squarefree(whole))
}

/// The number of all common roots, as often as they count, if they are isolated: the degree of the
/// same resultant.
pub(crate) fn finite_solutions(polynomials: &[Polynomial<Exact>]) -> Option<usize> {
    eliminated(polynomials)?.len().checked_sub(1)
}

/// The resultant of two polynomials of the coordinates `u`, by ascending powers; empty if it is zero.
fn eliminated(polynomials: &[Polynomial<Exact>]) -> Option<Vec<u64>> {
    let [f, g] = polynomials else { return None };
    let (f, g) = (terms(f)?, terms(g)?);
    let degree = |terms: &[Term]| terms.iter().map(|([a, b], _)| a + b).max().unwrap_or(0);
    let roots = degree(&f).checked_mul(degree(&g)).filter(|d| (1..=MAX_ROOTS).contains(d))?;
    let t = Random::new(0, Stream::Combinations).below(PRIME);
    Some(interpolated((0..=roots as u64).map(|u| resultant(line(&f, u, t), line(&g, u, t))).collect()))
}

fn terms(polynomial: &Polynomial<Exact>) -> Option<Vec<Term>> {
    let term = |exponents: &[i32], c: &Exact| {
        let [a, b] = *exponents else { return None };
        Some(([usize::try_from(a).ok()?, usize::try_from(b).ok()?], image(c)?))
    };
    polynomial.terms().iter().map(|(monomial, c)| term(monomial.exponents(), c)).collect()
}

/// A polynomial on the line `x = u - t y`, by ascending powers of `y`.
fn line(terms: &[Term], u: u64, t: u64) -> Vec<u64> {
    let degree = terms.iter().map(|([a, b], _)| a + b).max().unwrap_or(0);
    let highest = terms.iter().map(|([a, _], _)| *a).max().unwrap_or(0);
    // By Horner's rule in x.
    let mut whole = vec![0; degree + 1];
    for a in (0..=highest).rev() {
        for k in (0..=degree).rev() {
            let below = if k > 0 { times(t, whole[k - 1]) } else { 0 };
            whole[k] = difference(times(u, whole[k]), below);
        }
        for ([_, b], c) in terms.iter().filter(|([exponent, _], _)| *exponent == a) {
            whole[*b] = sum(whole[*b], *c);
        }
    }
    trim(&mut whole);
    if whole.is_empty() { vec![0] } else { whole }
}

/// The polynomial with these values at 0, 1, 2 ..., by ascending powers, by Newton's divided
/// differences.
fn interpolated(mut values: Vec<u64>) -> Vec<u64> {
    let n = values.len();
    for order in 1..n {
        let below = inverse(order as u64);
        for k in (order..n).rev() {
            values[k] = times(difference(values[k], values[k - 1]), below);
        }
    }
    let mut whole: Vec<u64> = Vec::with_capacity(n);
    for k in (0..n).rev() {
        // whole * (u - place) + value
        whole.insert(0, 0);
        for j in 1..whole.len() {
            whole[j - 1] = difference(whole[j - 1], times(k as u64, whole[j]));
        }
        whole[0] = sum(whole[0], values[k]);
    }
    trim(&mut whole);
    whole
}

#[cfg(test)]
mod tests {
    use super::{all_simple, finite_solutions};
    use poly::parse::phcpack;

    #[test]
    fn numbers_of_finite_solutions() {
        let count = |text: &str| finite_solutions(&phcpack(text).unwrap().expand(&Default::default()).unwrap());
        assert_eq!(count("2\nx^2+y^2-5;\nx*y-2;"), Some(4));
        // Circles, parallel lines, a double point, a common line.
        assert_eq!(count("2\nx^2+y^2-5;\nx^2+y^2-x;"), Some(2));
        assert_eq!(count("2\nx+y-1;\nx+y-2;"), Some(0));
        assert_eq!(count("2\n(x-y)^3;\n(x+y)^2;"), Some(6));
        assert_eq!(count("2\n(x+y)*x;\n(x+y)*(y-2);"), None);
        assert_eq!(count("3\nx-1;\ny-1;\nz-1;"), None);
    }

    #[test]
    fn simple_and_multiple_roots() {
        let simple = |text: &str| all_simple(&phcpack(text).unwrap().expand(&Default::default()).unwrap());
        assert!(simple("2\nx^2+y^2-5;\nx*y-2;"));
        assert!(simple("2\nx^21-2000000*x^2+4000*x-2;\ny-x^2+1;"));
        assert!(simple("2\n(1e9*(x+y-5)-1)*(1e9*(x+y-5)-2);\nx-2*y-3;"));
        assert!(simple("2\nx*y-1;\nx+y^2;"));
        // Tangent, a double line, a common component, an imaginary double point.
        assert!(!simple("2\nx^2+y^2-1;\nx-1;"));
        assert!(!simple("2\n(x+y)^2;\nx-y-1;"));
        assert!(!simple("2\n(x+y)*x;\n(x+y)*(y-2);"));
        assert!(!simple("2\nx^2+y^2+1;\nx-i;"));
    }
}
