//! Power series in a few variables, cut off at an order.

use super::monomials::Monomials;
use super::number::Number;
use std::collections::HashMap;

/// The monomials by which series are listed, with their products; a series of a lower order is a
/// shorter list of coefficients.
pub(crate) struct Basis {
    monomials: Monomials,
    /// The places of the products of each monomial with those that leave it within the order.
    products: Vec<Vec<u32>>,
}

/// Replacing the variables of series by series takes as many products as there are monomials, and
/// each as many steps as there are pairs of monomials within the order. More steps than this are
/// not taken.
const MAX_STEPS: f64 = 6e5;

impl Basis {
    /// `None` if there would be too many monomials.
    pub(crate) fn new(variables: usize, order: usize) -> Option<Basis> {
        // Pairs of monomials in `v` variables that stay within order `k` are monomials in `2 v`
        // variables.
        let choices = |from: usize| (1..=order).map(|i| (from + i) as f64 / i as f64).product::<f64>();
        if choices(variables) * choices(2 * variables) > MAX_STEPS || order > usize::from(u16::MAX) {
            return None;
        }
        let monomials = Monomials::new(variables, order);
        let Monomials { exponents, counts, .. } = &monomials;
        let places: HashMap<&[u16], u32> = exponents.iter().enumerate().map(|(k, e)| (&e[..], k as u32)).collect();
        let degree = |e: &[u16]| e.iter().map(|&e| usize::from(e)).sum::<usize>();
        let products = exponents.iter().map(|a| {
            let within = &exponents[..counts[order - degree(a)]];
            let sum = |b: &Vec<u16>| a.iter().zip(b).map(|(a, b)| a + b).collect::<Vec<u16>>();
            within.iter().filter_map(|b| places.get(&sum(b)[..]).copied()).collect()
        });
        let products = products.collect();
        Some(Basis { monomials, products })
    }

    pub(crate) fn variables(&self) -> usize {
        self.monomials.exponents[0].len()
    }

    pub(crate) fn order(&self) -> usize {
        self.monomials.order()
    }

    /// Number of monomials of an order or less.
    pub(crate) fn count(&self, order: usize) -> usize {
        self.monomials.counts[order.min(self.order())]
    }

    /// Number of pairs of monomials whose product is of an order or less.
    pub(crate) fn pairs(&self, order: usize) -> usize {
        let mut pairs = 0;
        let mut degree = 0;
        for k in 0..self.count(order) {
            while k >= self.monomials.counts[degree] {
                degree += 1;
            }
            pairs += self.count(order.min(self.order()) - degree);
        }
        pairs
    }

    pub(crate) fn exponents(&self) -> &[Vec<u16>] {
        &self.monomials.exponents
    }

    /// The order of a series, by its length.
    fn order_of<S>(&self, series: &[S]) -> usize {
        self.monomials.counts.iter().position(|&count| count == series.len()).unwrap_or(self.order())
    }

    pub(crate) fn constant<S: Number>(&self, value: S, order: usize) -> Vec<S> {
        let mut series = vec![S::zero(); self.count(order)];
        series[0] = value;
        series
    }

    /// The place of a variable among the monomials.
    pub(crate) fn variable(&self, index: usize) -> usize {
        1 + index
    }

    /// The place of a monomial times a variable; its order must be below that of the basis.
    pub(crate) fn raised(&self, monomial: usize, variable: usize) -> usize {
        self.monomials.raised[monomial][variable]
    }

    /// The product up to an order; factors may be shorter.
    pub(crate) fn product<S: Number>(&self, a: &[S], b: &[S], order: usize) -> Vec<S> {
        let mut product = vec![S::zero(); self.count(order)];
        let mut degree = 0;
        for (i, x) in a.iter().enumerate().take(product.len()) {
            while i >= self.monomials.counts[degree] {
                degree += 1;
            }
            if x.vanishes() {
                continue;
            }
            let within = self.count(order - degree);
            for (y, &place) in b.iter().zip(&self.products[i]).take(within) {
                if !y.vanishes() {
                    let sum = &mut product[place as usize];
                    *sum = S::mul_add(x, y, sum);
                }
            }
        }
        product
    }

    /// A power of a series up to an order.
    pub(crate) fn power<S: Number>(&self, a: &[S], exponent: u32, order: usize) -> Vec<S> {
        let mut power = self.constant(S::one(), order);
        for bit in (0..32 - exponent.leading_zeros()).rev() {
            power = self.product(&power, &power, order);
            if exponent >> bit & 1 == 1 {
                power = self.product(&power, a, order);
            }
        }
        power
    }

    /// The derivative by a variable, of an order less; a constant has none.
    pub(crate) fn derivative<S: Number>(&self, a: &[S], variable: usize) -> Vec<S> {
        let order = self.order_of(a);
        if order == 0 {
            return Vec::new();
        }
        let raised = &self.products[self.variable(variable)];
        let term = |k: usize| {
            let place = raised[k] as usize;
            S::scale(&a[place], f64::from(self.monomials.exponents[place][variable]))
        };
        (0..self.count(order - 1)).map(term).collect()
    }

    /// The place of a monomial without its last variable, which comes earlier, and that variable; `None` for one.
    fn factors(&self, monomial: usize) -> Option<(usize, usize)> {
        let mut lower = self.monomials.exponents[monomial].clone();
        let j = lower.iter().rposition(|&e| e > 0)?;
        lower[j] -= 1;
        Some((self.monomials.exponents[..monomial].iter().rposition(|e| *e == lower)?, j))
    }

    /// The value of a series at a point.
    pub(crate) fn value<S: Number>(&self, a: &[S], point: &[S]) -> S {
        let mut monomials: Vec<S> = Vec::with_capacity(a.len());
        for k in 0..a.len() {
            monomials.push(self.factors(k).map_or(S::one(), |(place, j)| S::mul(&monomials[place], &point[j])));
        }
        a.iter().zip(&monomials).fold(S::zero(), |sum, (a, m)| S::mul_add(a, m, &sum))
    }

    /// Series in the variables of `self` with each variable replaced by a series over `inner`, up
    /// to an order.
    pub(crate) fn composed<S: Number>(
        &self,
        all: &[Vec<S>],
        inner: &Basis,
        map: &[Vec<S>],
        order: usize,
    ) -> Vec<Vec<S>> {
        let length = all.iter().map(Vec::len).max().unwrap_or(0);
        let mut sums = vec![vec![S::zero(); inner.count(order)]; all.len()];
        let mut monomials: Vec<Vec<S>> = Vec::with_capacity(length);
        for k in 0..length {
            let monomial = match self.factors(k) {
                None => inner.constant(S::one(), order),
                Some((place, j)) => inner.product(&monomials[place], &map[j], order),
            };
            for (sum, series) in sums.iter_mut().zip(all) {
                if let Some(c) = series.get(k).filter(|c| !c.vanishes()) {
                    for (s, m) in sum.iter_mut().zip(&monomial) {
                        *s = S::mul_add(c, m, s);
                    }
                }
            }
            monomials.push(monomial);
        }
        sums
    }
}
