//! Systems in one unknown or two, exactly: those that were given as such, and others once unknowns that
//! an equation gives explicitly are eliminated.

use super::plane::{self, term};
use super::roots::{Digits, roots_with_multiplicities};
use super::simple::{all_simple, finite_solutions};
use num_traits::One;
use poly::{Exact, Monomial, Polynomial, Scalar};
use std::cmp::Reverse;

/// Equations of a higher degree, or with more terms, are not made.
const DEGREE: i64 = 150;
const TERMS: usize = 2000;
/// Nor those with more terms before equal ones are added.
const PRODUCTS: f64 = 10_000.0;

/// One equation in one unknown or two in two, and the other unknowns as polynomials in the unknowns
/// after them. For these there are other ways to all solutions than paths.
pub(crate) struct SmallSystem {
    equations: Vec<Polynomial<Exact>>,
    unknowns: Vec<usize>,
    others: Vec<(usize, Polynomial<Exact>)>,
    /// By this primes are drawn.
    seed: u64,
}

impl SmallSystem {
    /// Equations in as many unknowns, of which no more than two are left once explicit ones are
    /// eliminated; `None` for any others. Primes are drawn by the seed.
    pub(crate) fn new(polynomials: &[Polynomial<Exact>], seed: u64) -> Option<SmallSystem> {
        let count = polynomials.first()?.variables();
        if polynomials.len() != count || polynomials.iter().any(Polynomial::is_laurent) {
            return None;
        }
        SmallSystem::eliminated(polynomials, seed).or_else(|| {
            let (unknowns, others) = (vec![0, 1], Vec::new());
            let alone = SmallSystem { equations: polynomials.to_vec(), unknowns, others, seed };
            (count == 2).then_some(alone)
        })
    }

    /// Eliminates unknowns that an equation gives explicitly, the expression of lowest degree first;
    /// `None` if more than two unknowns are left, or equations get too large.
    fn eliminated(polynomials: &[Polynomial<Exact>], seed: u64) -> Option<SmallSystem> {
        let mut equations = polynomials.to_vec();
        let mut unknowns: Vec<usize> = (0..polynomials.len()).collect();
        let mut others = Vec::new();
        while unknowns.len() > 1 {
            let ways = (0..equations.len()).flat_map(|i| unknowns.iter().map(move |&j| (i, j)));
            let ways = ways.filter_map(|(i, j)| Some((i, j, explicit(&equations[i], j)?)));
            // The last unknowns may be names of sums of the others.
            let best = ways.min_by_key(|(_, j, value)| (value.degree(), value.len(), Reverse(*j)));
            let Some((i, j, value)) = best else { break };
            let left: Vec<usize> = unknowns.iter().copied().filter(|&k| k != j).collect();
            let mut replaced = equations.clone();
            replaced.remove(i);
            for equation in &mut replaced {
                let powers = equation.terms().iter().map(|(m, _)| i64::from(m.exponents()[j]));
                let degree = equation.degree()? + powers.max()? * value.degree().unwrap_or(0);
                // As many as monomials, or as products of terms.
                let monomials = binomial(degree as f64, left.len());
                let products =
                    |(m, _): &(Monomial, Exact)| binomial(f64::from(m.exponents()[j]), value.len().saturating_sub(1));
                let products: f64 = equation.terms().iter().map(products).sum();
                if degree > DEGREE || monomials.min(products) > PRODUCTS {
                    return None;
                }
                *equation = equation.substitute(j, &value)?;
                if equation.len() > TERMS {
                    return None;
                }
            }
            (equations, unknowns) = (replaced, left);
            others.push((j, value));
        }
        let alone = |equation: &Polynomial<Exact>| {
            let of = |m: &Monomial| Monomial::new(unknowns.iter().map(|&j| m.exponents()[j]));
            let terms = equation.terms().iter().map(|(m, c)| (of(m), c.clone()));
            let equation = Polynomial::from_terms(unknowns.len(), terms);
            (equation.degree()? > 0).then_some(equation)
        };
        let equations = equations.iter().map(alone).collect::<Option<_>>()?;
        (unknowns.len() <= 2).then_some(SmallSystem { equations, unknowns, others, seed })
    }

    /// The number of solutions, with their multiplicities, if they are isolated and known at once.
    pub(crate) fn count(&self) -> Option<usize> {
        match &self.equations[..] {
            [equation] => usize::try_from(equation.degree()?).ok(),
            equations => finite_solutions(equations, self.seed),
        }
    }

    /// Whether all solutions are isolated and simple; false tells nothing.
    pub(crate) fn are_simple(&self) -> bool {
        all_simple(&self.equations, self.seed)
    }

    /// All solutions with their multiplicities, if they are isolated and all clear.
    pub(crate) fn solutions(&self) -> Option<Vec<(Vec<Digits>, usize)>> {
        let points: Vec<(Vec<Digits>, usize)> = match &self.equations[..] {
            [equation] => {
                let roots = roots_with_multiplicities(equation, self.seed)?;
                roots.into_iter().map(|(root, m)| (vec![root], m)).collect()
            }
            equations => plane::points(equations, self.seed)?,
        };
        let whole = |(left, multiplicity): (Vec<Digits>, usize)| {
            let mut values = vec![Digits::zero(); self.unknowns.len() + self.others.len()];
            self.unknowns.iter().zip(left).for_each(|(&j, value)| values[j] = value);
            for (j, polynomial) in self.others.iter().rev() {
                let terms = polynomial.terms().iter().map(|(monomial, c)| term(monomial, c, &values));
                values[*j] = terms.fold(Digits::zero(), |sum, z| Digits::add(&sum, &z));
            }
            (values, multiplicity)
        };
        Some(points.into_iter().map(whole).collect())
    }
}

/// The number of monomials of at most a degree in so many unknowns.
fn binomial(degree: f64, unknowns: usize) -> f64 {
    (1..=unknowns).map(|k| (degree + k as f64) / k as f64).product()
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
    use super::SmallSystem;
    use poly::parse::phcpack;

    #[test]
    fn unknowns_that_are_polynomials_in_others() {
        let of = |text: &str| {
            let system = phcpack(text).unwrap();
            let small = SmallSystem::new(&system.expand(&Default::default()).unwrap(), 0)?;
            let equations = small.equations.iter().map(|e| e.display(&["t", "s"][..small.unknowns.len()]).to_string());
            Some(equations.collect::<Vec<_>>().join("; "))
        };
        assert_eq!(of("2\nx^3-2;\ny-x^2+1;").as_deref(), Some("t^3 - 2"));
        assert_eq!(of("2\n(x+y)^2-2;\nx-2*y-1;").as_deref(), Some("9/4*t^2 - 3/2*t - 7/4"));
        assert_eq!(of("3\nx^2-y*z;\ny-z-1;\nz-x^2;").as_deref(), Some("-t^4"));
        assert_eq!(of("3\nx^2+y^2-2;\nx*y-z;\nz-1;").as_deref(), Some("t^2 + s^2 - 2; t*s - 1"));
        assert_eq!(of("3\nx^2+y^2-2;\nx*y-z^2;\nz^2-1;"), None);
        // Too large once x is eliminated.
        assert_eq!(of("2\nx^90+y^90-1;\nx-y^2;").as_deref(), Some("t^90 + s^90 - 1; -s^2 + t"));
    }
}
