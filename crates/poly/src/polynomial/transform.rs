//! Substitution and homogenising.

use super::terms::{Polynomial, Ring, group_degree};
use crate::monomial::Monomial;

impl<R: Ring> Polynomial<R> {
    /// The polynomial with unknown `index` replaced by `value`; `None` if that unknown has a
    /// negative exponent somewhere.
    ///
    /// # Panics
    /// If `value` has a different number of unknowns.
    pub fn substitute(&self, index: usize, value: &Polynomial<R>) -> Option<Polynomial<R>> {
        assert_eq!(self.variables(), value.variables(), "polynomials in equally many unknowns");
        // Terms by their power of the unknown, highest first, for Horner's rule.
        let mut by_power: Vec<(u32, Vec<(Monomial, R)>)> = Vec::new();
        for (monomial, c) in self.terms() {
            let mut rest = monomial.clone();
            let exponent = u32::try_from(std::mem::take(&mut rest.exponents_mut()[index])).ok()?;
            match by_power.binary_search_by(|(e, _)| exponent.cmp(e)) {
                Ok(k) => by_power[k].1.push((rest, c.clone())),
                Err(k) => by_power.insert(k, (exponent, vec![(rest, c.clone())])),
            }
        }
        let mut sum = Polynomial::zero(self.variables());
        let mut last = 0;
        for (exponent, terms) in by_power {
            if !sum.is_empty() {
                sum = &sum * &value.pow(last - exponent);
            }
            sum = &sum + &Polynomial::from_terms(self.variables(), terms);
            last = exponent;
        }
        Some(if last > 0 { &sum * &value.pow(last) } else { sum })
    }

    /// The homogeneous polynomial with one new unknown for each group, in the order of the groups
    /// after the old unknowns. In each group together with its new unknown, every term has the same
    /// degree.
    ///
    /// # Panics
    /// If a degree leaves the range of 32 bits.
    pub fn homogenised(&self, groups: &[Vec<usize>]) -> Polynomial<R> {
        let degrees: Vec<i64> = groups.iter().map(|group| self.group_degree(group)).collect();
        let terms = self.terms().iter().map(|(monomial, c)| {
            let missing = groups.iter().zip(&degrees).map(|(group, degree)| degree - group_degree(monomial, group));
            let missing = missing.map(|e| i32::try_from(e).expect("degrees of 32 bits"));
            (Monomial::new(monomial.exponents().iter().copied().chain(missing)), c.clone())
        });
        Polynomial::from_terms(self.variables() + groups.len(), terms)
    }
}
