//! The equations of which components are sought.

use crate::singular::ExactEquations;
use num_complex::Complex64;
use num_traits::ToPrimitive;
use poly::{Exact, Polynomial};

/// Equations of which the last ones give the last unknowns as [sums](poly::System::with_named_sums) of others.
///
/// Such an unknown is a polynomial in the given ones. Components therefore keep their dimensions and
/// multiplicities, and their degrees if hyperplanes and traces are in the given unknowns alone.
pub(super) struct NamedEquations<'a> {
    polynomials: &'a [Polynomial<Exact>],
    /// All of them, by which points are judged.
    pub(super) all: ExactEquations,
    /// How many unknowns, the first ones, were given.
    pub(super) unknowns: usize,
}

impl<'a> NamedEquations<'a> {
    /// Equations in all unknowns, of which the first `unknowns` were given, and a seed for primes.
    pub(super) fn new(polynomials: &'a [Polynomial<Exact>], unknowns: usize, seed: u64) -> NamedEquations<'a> {
        let all = polynomials.first().map_or(unknowns, Polynomial::variables);
        NamedEquations { polynomials, all: ExactEquations::new(polynomials, vec![0; all]).seeded(seed), unknowns }
    }

    /// How many unknowns are named sums.
    pub(super) fn named_sums(&self) -> usize {
        self.all.unknowns() - self.unknowns
    }

    /// The equations that were given, and those of the named sums.
    pub(super) fn parts(&self) -> (&'a [Polynomial<Exact>], &'a [Polynomial<Exact>]) {
        self.polynomials.split_at(self.polynomials.len() - self.named_sums())
    }

    /// The given equations, hyperplanes, and then the equations of the named sums.
    pub(super) fn with_planes(&self, planes: &[Polynomial<Exact>]) -> Vec<Polynomial<Exact>> {
        let (given, sums) = self.parts();
        [given, planes, sums].concat()
    }

    /// The values of all unknowns where the given ones have these.
    pub(super) fn completed(&self, mut point: Vec<Complex64>) -> Vec<Complex64> {
        point.resize(self.all.unknowns(), Complex64::default());
        // Each sum has a name of a lower number than those of the sums that contain it.
        for (k, sum) in (self.unknowns..).zip(self.parts().1) {
            let rounded = |c: &Exact| {
                let part = |q: &num_rational::BigRational| q.to_f64().unwrap_or(f64::NAN);
                Complex64::new(part(&c.re), part(&c.im))
            };
            // The equation is the unknown minus its value.
            let value = sum.map(rounded).evaluate(&point);
            point[k] = value.map_or(Complex64::new(f64::NAN, f64::NAN), |value| -value);
        }
        point
    }
}

#[cfg(test)]
mod tests {
    use super::NamedEquations;
    use num_complex::Complex64;

    #[test]
    fn nested_sums_have_their_values() {
        let system: poly::System = "((x + y)^20 + x)^20 = y".parse().unwrap();
        let named = system.with_named_sums(3, 8).unwrap();
        let polynomials = named.expand(&Default::default()).unwrap();
        let equations = NamedEquations::new(&polynomials, 2, 0);
        let point = equations.completed(vec![3.0.into(), Complex64::new(-2.0, 0.0)]);
        let mut sums: Vec<f64> = point[2..].iter().map(|z| z.re).collect();
        sums.sort_by(f64::total_cmp);
        // x + y is 1, and so is its power.
        assert_eq!((equations.named_sums(), &sums[..]), (2, &[1.0, 4.0][..]));
    }
}
