//! The polynomial itself: its coefficients and terms, and operations that need no other polynomial.

use crate::monomial::Monomial;
use num_traits::{One, Zero};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::ops::{Neg, Sub};

/// Coefficients of polynomials: elements of a commutative ring.
pub trait Ring: Clone + PartialEq + Zero + One + Sub<Output = Self> + Neg<Output = Self> {}

impl<R: Clone + PartialEq + Zero + One + Sub<Output = R> + Neg<Output = R>> Ring for R {}

/// Deterministic, so that nothing depends on a random seed.
pub(crate) type Terms<R> = HashMap<Monomial, R, BuildHasherDefault<std::hash::DefaultHasher>>;

/// A sparse polynomial: a sum of terms `coefficient * monomial`.
///
/// Terms are in descending order (total degree, then lexicographic) and have no zero coefficients,
/// so that equal polynomials compare equal. Operations on polynomials in different numbers of
/// unknowns panic; so do exponents that leave the range of 32 bits.
///
/// ```
/// use poly::Polynomial;
/// let (x, y) = (Polynomial::<i64>::variable(2, 0), Polynomial::variable(2, 1));
/// let square = (&x + &y).pow(2);
/// assert_eq!(square, &(&(&x * &x) + &(&y * &y)) + &(&x * &y).scaled(&2));
/// assert_eq!(square.evaluate(&[3, 4]), Some(49));
/// assert_eq!(square.display(&["x", "y"]).to_string(), "x^2 + 2*x*y + y^2");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial<R> {
    pub(super) variables: usize,
    pub(super) terms: Vec<(Monomial, R)>,
}

impl<R: Ring> Polynomial<R> {
    /// The zero polynomial in this many unknowns.
    pub fn zero(variables: usize) -> Polynomial<R> {
        Polynomial { variables, terms: Vec::new() }
    }

    /// A constant polynomial.
    pub fn constant(variables: usize, value: R) -> Polynomial<R> {
        Polynomial::term(Monomial::one(variables), value)
    }

    /// The polynomial that consists of one unknown.
    ///
    /// # Panics
    /// If there is no unknown of this index.
    pub fn variable(variables: usize, index: usize) -> Polynomial<R> {
        assert!(index < variables, "unknown {index} of {variables}");
        Polynomial::term(Monomial::new((0..variables).map(|j| i32::from(j == index))), R::one())
    }

    /// The polynomial with one term.
    pub fn term(monomial: Monomial, coefficient: R) -> Polynomial<R> {
        let variables = monomial.exponents().len();
        let terms = if coefficient.is_zero() { Vec::new() } else { vec![(monomial, coefficient)] };
        Polynomial { variables, terms }
    }

    /// A sum of terms in any order; terms with equal monomials are added up.
    ///
    /// # Panics
    /// If a monomial does not have one exponent for each unknown.
    pub fn from_terms(variables: usize, terms: impl IntoIterator<Item = (Monomial, R)>) -> Polynomial<R> {
        let mut sum = Terms::default();
        for (monomial, coefficient) in terms {
            assert_eq!(monomial.exponents().len(), variables, "exponents of a monomial");
            accumulate(&mut sum, monomial, coefficient);
        }
        Polynomial::from_sum(variables, sum)
    }

    pub(crate) fn from_sum(variables: usize, sum: Terms<R>) -> Polynomial<R> {
        let mut terms: Vec<(Monomial, R)> = sum.into_iter().filter(|(_, c)| !c.is_zero()).collect();
        terms.sort_unstable_by(|a, b| b.0.cmp(&a.0));
        Polynomial { variables, terms }
    }

    /// Number of unknowns.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// Terms in descending order.
    pub fn terms(&self) -> &[(Monomial, R)] {
        &self.terms
    }

    /// Number of terms.
    pub fn len(&self) -> usize {
        self.terms.len()
    }

    /// Whether the polynomial is zero.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// The greatest term; `None` for zero.
    pub fn leading_term(&self) -> Option<&(Monomial, R)> {
        self.terms.first()
    }

    /// Greatest total degree; `None` for zero.
    pub fn degree(&self) -> Option<i64> {
        self.terms.first().map(|(monomial, _)| monomial.degree())
    }

    /// Whether some exponent is negative.
    ///
    /// ```
    /// let system: poly::System = "x + 1/y".parse()?;
    /// assert!(system.expand(&Default::default())?[0].is_laurent());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_laurent(&self) -> bool {
        self.terms.iter().any(|(monomial, _)| monomial.exponents().iter().any(|&e| e < 0))
    }

    /// Greatest degree in each group of unknowns; `None` for zero.
    pub fn multidegree(&self, groups: &[Vec<usize>]) -> Option<Vec<i64>> {
        (!self.terms.is_empty()).then(|| groups.iter().map(|group| self.group_degree(group)).collect())
    }

    pub(super) fn group_degree(&self, group: &[usize]) -> i64 {
        self.terms.iter().map(|(monomial, _)| group_degree(monomial, group)).max().unwrap_or(0)
    }

    /// Exponent vectors, one row per term, in the order of [`terms`](Polynomial::terms).
    pub fn support(&self) -> Vec<Vec<i32>> {
        self.terms.iter().map(|(monomial, _)| monomial.exponents().to_vec()).collect()
    }

    /// The polynomial with a function applied to every coefficient.
    pub fn map<Q: Ring>(&self, convert: impl Fn(&R) -> Q) -> Polynomial<Q> {
        let terms = self.terms.iter().map(|(monomial, c)| (monomial.clone(), convert(c)));
        Polynomial { variables: self.variables, terms: terms.filter(|(_, c)| !c.is_zero()).collect() }
    }

    /// `factor * self`
    pub fn scaled(&self, factor: &R) -> Polynomial<R> {
        self.map(|c| c.clone() * factor.clone())
    }

    /// `self^k`
    pub fn pow(&self, k: u32) -> Polynomial<R> {
        let mut power = Polynomial::constant(self.variables, R::one());
        for bit in (0..u32::BITS - k.leading_zeros()).rev() {
            power = &power * &power;
            if k >> bit & 1 == 1 {
                power = &power * self;
            }
        }
        power
    }
}

/// Degree of a monomial in a group of unknowns.
pub(super) fn group_degree(monomial: &Monomial, group: &[usize]) -> i64 {
    group.iter().map(|&j| i64::from(monomial.exponents()[j])).sum()
}

/// Adds a term and returns the new coefficient of its monomial.
pub(crate) fn accumulate<R: Ring>(sum: &mut Terms<R>, monomial: Monomial, coefficient: R) -> &R {
    match sum.entry(monomial) {
        std::collections::hash_map::Entry::Vacant(slot) => slot.insert(coefficient),
        std::collections::hash_map::Entry::Occupied(slot) => {
            let place = slot.into_mut();
            *place = place.clone() + coefficient;
            place
        }
    }
}
