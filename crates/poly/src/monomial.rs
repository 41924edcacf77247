//! Monomials: exponent vectors, negative exponents allowed.

use smallvec::SmallVec;
use std::cmp::Ordering;

/// A product of powers of unknowns, ordered by total degree, then lexicographically.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Monomial {
    exponents: SmallVec<[i32; 8]>,
}

impl Monomial {
    /// The monomial with these exponents, one for each unknown.
    pub fn new(exponents: impl IntoIterator<Item = i32>) -> Monomial {
        Monomial { exponents: exponents.into_iter().collect() }
    }

    /// The empty product in this many unknowns.
    pub fn one(variables: usize) -> Monomial {
        Monomial { exponents: SmallVec::from_elem(0, variables) }
    }

    /// Exponents in the order of the unknowns.
    pub fn exponents(&self) -> &[i32] {
        &self.exponents
    }

    /// Sum of the exponents.
    pub fn degree(&self) -> i64 {
        self.exponents.iter().map(|&e| i64::from(e)).sum()
    }

    /// The product; `None` if an exponent would not fit in 32 bits.
    pub fn checked_mul(&self, other: &Monomial) -> Option<Monomial> {
        let pairs = self.exponents.iter().zip(&other.exponents);
        let exponents = pairs.map(|(a, b)| a.checked_add(*b)).collect::<Option<_>>()?;
        Some(Monomial { exponents })
    }

    /// The power; `None` if an exponent would not fit in 32 bits.
    pub fn checked_pow(&self, k: i32) -> Option<Monomial> {
        let exponents = self.exponents.iter().map(|e| e.checked_mul(k)).collect::<Option<_>>()?;
        Some(Monomial { exponents })
    }

    /// The exponents, to be changed in place.
    pub(crate) fn exponents_mut(&mut self) -> &mut SmallVec<[i32; 8]> {
        &mut self.exponents
    }
}

impl Ord for Monomial {
    fn cmp(&self, other: &Self) -> Ordering {
        self.degree().cmp(&other.degree()).then_with(|| self.exponents.cmp(&other.exponents))
    }
}

impl PartialOrd for Monomial {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
