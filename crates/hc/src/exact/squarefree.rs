//! A polynomial in one unknown as a product of powers of others without multiple roots, exactly.
//!
//! Arithmetic modulo a random prime proves in little time that there are no multiple roots. Where there
//! are multiple roots, Yun's algorithm (1976) finds the factors by greatest common divisors of
//! exact polynomials.

use super::subresultants::{self, Gaussian, common_denominator};
use crate::singular::{self, PrimeField, Residue, trimmed};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};
use poly::{Exact, Monomial, Polynomial};

/// Polynomials of a higher degree are not looked at.
const MAX_DEGREE: usize = 3000;
/// Exact divisors are computed up to this work, about a second: the square of the degree times that
/// of the number of words of their coefficients.
const MAX_WORK: f64 = 1e9;

/// Factors without multiple roots and their exponents, whose product is the polynomial up to a
/// constant; `None` for more than one unknown, negative exponents, or too much work. The prime is drawn by the seed.
pub(super) fn squarefree(polynomial: &Polynomial<Exact>, seed: u64) -> Option<Vec<(Polynomial<Exact>, usize)>> {
    let whole = dense(polynomial)?;
    if is_squarefree(&whole, seed) {
        return Some(vec![(polynomial.clone(), 1)]);
    }
    let degree = (whole.len() - 1) as f64;
    let bits = |q: &BigRational| q.numer().bits() + q.denom().bits();
    let largest = whole.iter().map(|c| bits(&c.re) + bits(&c.im)).max()?;
    if (degree * degree * largest as f64 / 32.0).powi(2) > MAX_WORK {
        return None;
    }
    let parts = yun(&whole).into_iter().map(|(part, exponent)| (sparse(&part), exponent));
    Some(parts.collect())
}

/// Coefficients by ascending exponents, the last not zero.
fn dense(polynomial: &Polynomial<Exact>) -> Option<Vec<Exact>> {
    let mut coefficients = Vec::new();
    for (monomial, c) in polynomial.terms() {
        let [exponent] = monomial.exponents()[..] else { return None };
        let place = usize::try_from(exponent).ok().filter(|&e| e <= MAX_DEGREE)?;
        if coefficients.len() <= place {
            coefficients.resize(place + 1, Exact::zero());
        }
        coefficients[place] = c.clone();
    }
    Some(trimmed(coefficients)).filter(|c| c.len() > 1)
}

fn sparse(coefficients: &[Exact]) -> Polynomial<Exact> {
    let terms = coefficients.iter().enumerate().map(|(e, c)| (Monomial::new([e as i32]), c.clone()));
    Polynomial::from_terms(1, terms.filter(|(_, c)| !c.is_zero()))
}

/// Yun's factors with their exponents, constants left out.
fn yun(whole: &[Exact]) -> Vec<(Vec<Exact>, usize)> {
    let slope = derivative(whole);
    let common = divisor(whole, &slope);
    let (mut rest, mut other) = (divided(whole, &common).0, divided(&slope, &common).0);
    let mut parts = Vec::new();
    for exponent in 1..whole.len() {
        let difference = minus(&other, &derivative(&rest));
        let part = divisor(&rest, &difference);
        (rest, other) = (divided(&rest, &part).0, divided(&difference, &part).0);
        if part.len() > 1 {
            parts.push((part, exponent));
        }
        if rest.len() <= 1 {
            break;
        }
    }
    parts
}

fn derivative(a: &[Exact]) -> Vec<Exact> {
    let factor = |e: usize| Exact::new(BigRational::from_integer(BigInt::from(e)), BigRational::zero());
    a.iter().enumerate().skip(1).map(|(e, c)| c * factor(e)).collect()
}

fn minus(a: &[Exact], b: &[Exact]) -> Vec<Exact> {
    let at = |c: &[Exact], k: usize| c.get(k).cloned().unwrap_or_else(Exact::zero);
    trimmed((0..a.len().max(b.len())).map(|k| at(a, k) - at(b, k)).collect())
}

/// Quotient and remainder; the divisor is not zero.
fn divided(a: &[Exact], b: &[Exact]) -> (Vec<Exact>, Vec<Exact>) {
    let (mut rest, mut quotient) = (a.to_vec(), Vec::new());
    let Some(leading) = b.last() else { return (quotient, rest) };
    while rest.len() >= b.len() {
        let (place, Some(last)) = (rest.len() - b.len(), rest.pop()) else { break };
        let factor = last / leading;
        if !factor.is_zero() {
            for (r, c) in rest[place..].iter_mut().zip(b) {
                *r = &*r - &factor * c;
            }
        }
        quotient.push(factor);
    }
    quotient.reverse();
    (quotient, trimmed(rest))
}

/// The monic greatest common divisor of two polynomials, not both zero.
fn divisor(a: &[Exact], b: &[Exact]) -> Vec<Exact> {
    let common = subresultants::divisor(&whole_numbers(a), &whole_numbers(b));
    monic(common.into_iter().map(|c| Exact::new(c.re.into(), c.im.into())).collect())
}

/// A polynomial times a common denominator of its coefficients.
fn whole_numbers(a: &[Exact]) -> Vec<Gaussian> {
    let common = common_denominator(a.iter());
    let whole = |q: &BigRational| q.numer() * (&common / q.denom());
    a.iter().map(|c| Gaussian::new(whole(&c.re), whole(&c.im))).collect()
}

fn monic(a: Vec<Exact>) -> Vec<Exact> {
    match a.last().cloned() {
        Some(leading) if !leading.is_one() => a.iter().map(|c| c / &leading).collect(),
        _ => a,
    }
}

/// Whether a polynomial has no multiple roots even modulo a prime. Where the coefficients have an
/// image there and the degree stays, a square factor has one too.
fn is_squarefree(whole: &[Exact], seed: u64) -> bool {
    let [field, _] = PrimeField::pair(seed, whole.iter());
    field.run(|| {
        let image = whole.iter().map(Residue::image).collect::<Option<Vec<Residue>>>();
        image.is_some_and(|image| image.last().is_some_and(|c| !c.is_zero()) && singular::is_squarefree(image))
    })
}

#[cfg(test)]
mod tests {
    use super::squarefree;
    use poly::parse::phcpack;

    fn parts(text: &str) -> Vec<(String, usize)> {
        let system = phcpack(&format!("1\n{text};")).unwrap();
        let polynomials = system.expand(&Default::default()).unwrap();
        let parts = squarefree(&polynomials[0], 0).unwrap();
        parts.iter().map(|(p, k)| (p.display(&["x"]).to_string(), *k)).collect()
    }

    #[test]
    fn factors_by_multiplicity() {
        assert_eq!(parts("x^2-2*x+1-1E-12").len(), 1);
        assert_eq!(parts("x^150-1"), [("x^150 - 1".to_owned(), 1)]);
        let found = parts("4*(x-1)^3*(x-1.0001)^2*(x+1/3)");
        let want = [("x + 1/3", 1), ("x - 10001/10000", 2), ("x - 1", 3)];
        assert_eq!(found, want.map(|(text, k)| (text.to_owned(), k)));
        let found = parts("x^4*(x^2+1)^2*(x-i)");
        assert_eq!(found.iter().map(|(_, k)| *k).collect::<Vec<_>>(), [2, 3, 4], "{found:?}");
        assert_eq!(parts("(x-2)^7"), [("x - 2".to_owned(), 7)]);
        let found = parts("(x-2/3+i/7)^3*(x^2+5*i*x-1/9)^2*(x^3-x+i)");
        assert_eq!(found.iter().map(|(_, k)| *k).collect::<Vec<_>>(), [1, 2, 3], "{found:?}");
    }
}
