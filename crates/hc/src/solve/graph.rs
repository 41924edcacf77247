//! Systems in which all unknowns but one are polynomials in others: a line, a parabola beside an
//! equation in one unknown. They are one equation in one unknown in other words.

use super::classify::{Digits, Tracked, term};
use super::solutions::Solution;
use crate::singular;
use num_traits::One;
use poly::{Exact, Monomial, Polynomial, Scalar};

/// Equations of a higher degree, or more terms, are not made.
const DEGREE: i64 = 150;
const TERMS: f64 = 2000.0;

/// An equation in one unknown, and the others as polynomials in those behind them.
struct Reduced {
    equation: Polynomial<Exact>,
    unknown: usize,
    others: Vec<(usize, Polynomial<Exact>)>,
}

/// All solutions with their multiplicities, if the system is such a one and its roots are all clear.
/// `units` are the logarithms to base 2 of the units of the unknowns.
pub(super) fn solved(polynomials: &[Polynomial<Exact>], units: &[i64], tracked: &Tracked<'_>) -> Option<Vec<Solution>> {
    let Reduced { equation, unknown, others } = reduced(polynomials)?;
    let mut points = Vec::new();
    for (root, multiplicity) in singular::roots_with_multiplicities(&equation, 0)? {
        let mut values = vec![Digits::zero(); units.len()];
        values[unknown] = root.iter().fold(Digits::zero(), |sum, &part| Digits::add(&sum, &Digits::from_c64(part)));
        for (j, polynomial) in others.iter().rev() {
            let terms = polynomial.terms().iter().map(|(monomial, c)| term(monomial, c, &values));
            values[*j] = terms.fold(Digits::zero(), |sum, z| Digits::add(&sum, &z));
        }
        points.push((values, multiplicity));
    }
    let count: usize = points.iter().map(|(_, multiplicity)| multiplicity).sum();
    (i64::try_from(count).ok() == equation.degree()).then(|| tracked.listed(points, units))
}

/// Replaces one unknown after the other by what an equation says of it, that of the lowest degree
/// first.
fn reduced(polynomials: &[Polynomial<Exact>]) -> Option<Reduced> {
    let unknowns = polynomials.first()?.variables();
    let negative = |p: &Polynomial<Exact>| p.terms().iter().any(|(m, _)| m.exponents().iter().any(|&e| e < 0));
    if polynomials.len() != unknowns || polynomials.iter().any(negative) {
        return None;
    }
    let mut equations = polynomials.to_vec();
    let mut left: Vec<usize> = (0..unknowns).collect();
    let mut others = Vec::new();
    while left.len() > 1 {
        let ways = (0..equations.len()).flat_map(|i| left.iter().map(move |&j| (i, j)));
        let ways = ways.filter_map(|(i, j)| Some((i, j, explicit(&equations[i], j)?)));
        let (i, j, value) = ways.min_by_key(|(_, _, value)| (value.degree(), value.len()))?;
        equations.remove(i);
        left.retain(|&k| k != j);
        for equation in &mut equations {
            let powers = equation.terms().iter().map(|(m, _)| i64::from(m.exponents()[j]));
            let degree = equation.degree()? + powers.max()? * value.degree().unwrap_or(0);
            let terms = (1..=left.len()).map(|k| (degree as f64 + k as f64) / k as f64).product::<f64>();
            if degree > DEGREE || terms > TERMS {
                return None;
            }
            *equation = equation.substitute(j, &value)?;
        }
        others.push((j, value));
    }
    let ([equation], &[unknown]) = (&equations[..], &left[..]) else { return None };
    let terms = equation.terms().iter().map(|(m, c)| (Monomial::new([m.exponents()[unknown]]), c.clone()));
    let equation = Polynomial::from_terms(1, terms);
    (equation.degree()? > 0).then_some(Reduced { equation, unknown, others })
}

/// The unknown as a polynomial in the others, if the equation has it in one term and there alone.
fn explicit(equation: &Polynomial<Exact>, unknown: usize) -> Option<Polynomial<Exact>> {
    let (own, others): (Vec<_>, Vec<_>) =
        equation.terms().iter().cloned().partition(|(m, _)| m.exponents()[unknown] != 0);
    let [(monomial, c)] = &own[..] else { return None };
    let alone = monomial.exponents().iter().enumerate().all(|(k, &e)| e == i32::from(k == unknown));
    alone.then(|| Polynomial::from_terms(equation.variables(), others).scaled(&-(Exact::one() / c)))
}

#[cfg(test)]
mod tests {
    use super::reduced;
    use poly::parse::phcpack;

    #[test]
    fn unknowns_that_are_polynomials_in_others() {
        let of = |text: &str| {
            let system = phcpack(text).unwrap();
            reduced(&system.expand(&Default::default()).unwrap()).map(|r| r.equation.display(&["t"]).to_string())
        };
        assert_eq!(of("2\nx^3-2;\ny-x^2+1;").as_deref(), Some("t^3 - 2"));
        assert_eq!(of("2\n(x+y)^2-2;\nx-2*y-1;").as_deref(), Some("9*t^2 + 6*t - 1"));
        assert_eq!(of("3\nx^2-y*z;\ny-z-1;\nz-x^2;").as_deref(), Some("-t^4"));
        assert_eq!(of("2\nx^2+y^2-1;\nx*y-1;"), None);
        assert_eq!(of("2\nx^90+y^90-1;\nx-y^2;"), None);
    }
}
