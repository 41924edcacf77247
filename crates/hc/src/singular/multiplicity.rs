//! The multiplicity of an isolated solution with rational coordinates, by its dual space modulo a
//! prime.

use super::modular::{Echelon, difference, inverse, power, sum, times};
use std::collections::HashMap;

/// An equation modulo the prime: the powers of unknowns and the coefficient of each term.
pub(super) type Modular = Vec<(Vec<(usize, u32)>, u64)>;

/// Orders up to which functionals are sought: first the lower one, for which less is to be prepared.
const LOW_ORDER: usize = 8;
const HIGH_ORDER: usize = 128;
/// Monomials at most.
const MONOMIALS: f64 = 20_000.0;
/// Unknowns of the linear equations for the functionals of an order at most.
const WIDTH: usize = 3_000;

/// Times as many functionals as are expected at most are not looked at.
const BEYOND: usize = 2;

/// The dimension of the local ring at a point, modulo the prime.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Multiplicity {
    Finite(usize),
    /// By far more than was asked for, or more in all orders that are looked at.
    More,
    /// It would take too much work to tell.
    Unknown,
}

/// Finds that dimension, and whether it is more than `most`.
///
/// The dual space is found order by order as numerically (Dayton & Zeng 2005; Mourrain 1997).
pub(super) fn multiplicity(equations: &[Modular], point: &[u64], most: usize) -> Multiplicity {
    let count = |order: usize| (1..=order).map(|k| (point.len() + k) as f64 / k as f64).product::<f64>();
    let Some(highest) = (1..=HIGH_ORDER).rev().find(|&order| count(order) <= MONOMIALS) else {
        return Multiplicity::Unknown;
    };
    let mut more = false;
    for order in [LOW_ORDER.min(highest), highest] {
        let monomials = Monomials::new(point.len(), order);
        let equations: Vec<Vec<u64>> = equations.iter().map(|terms| monomials.expansion(terms, point)).collect();
        let mut dual = Dual::new(&monomials);
        for next in 1..=order {
            let before = dual.functionals.len();
            if before > most.saturating_mul(BEYOND) {
                return Multiplicity::More;
            }
            if before * point.len() > WIDTH {
                return if before > most { Multiplicity::More } else { Multiplicity::Unknown };
            }
            dual.grow(&equations, next);
            if dual.functionals.len() == before {
                return Multiplicity::Finite(before);
            }
            more = before > most;
        }
    }
    if more { Multiplicity::More } else { Multiplicity::Unknown }
}

/// The monomials in some variables up to an order, lower orders first.
pub(super) struct Monomials {
    pub(super) exponents: Vec<Vec<u16>>,
    /// The number of monomials of each order or less.
    pub(super) counts: Vec<usize>,
    /// `raised[k][i]`: the place of monomial `k`, of less than the highest order, times variable `i`.
    pub(super) raised: Vec<Vec<usize>>,
}

impl Monomials {
    pub(super) fn new(variables: usize, order: usize) -> Monomials {
        let mut all = Monomials { exponents: vec![vec![0; variables]], counts: vec![1], raised: Vec::new() };
        let mut places: HashMap<Vec<u16>, usize> = HashMap::new();
        for _ in 0..order {
            let to = all.exponents.len();
            for k in all.raised.len()..to {
                let times = |i: usize| {
                    let mut product = all.exponents[k].clone();
                    product[i] += 1;
                    product
                };
                let products: Vec<Vec<u16>> = (0..variables).map(times).collect();
                let mut place = |product: Vec<u16>| {
                    *places.entry(product).or_insert_with_key(|product| {
                        all.exponents.push(product.clone());
                        all.exponents.len() - 1
                    })
                };
                let row = products.into_iter().map(&mut place).collect();
                all.raised.push(row);
            }
            all.counts.push(all.exponents.len());
        }
        all
    }

    fn order(&self) -> usize {
        self.counts.len() - 1
    }

    /// The coefficients of an equation at a point as a polynomial in the differences from it.
    fn expansion(&self, terms: &Modular, point: &[u64]) -> Vec<u64> {
        let mut whole = vec![0; self.exponents.len()];
        for (powers, c) in terms {
            // One factor after the other.
            let mut partial: Vec<(usize, u64)> = vec![(0, *c)];
            for &(j, exponent) in powers {
                let factor = binomial(point[j], exponent, self.order());
                let mut product: HashMap<usize, u64> = HashMap::new();
                for &(mut place, c) in &partial {
                    for &(e, b) in &factor {
                        let order: usize = self.exponents[place].iter().map(|&e| usize::from(e)).sum();
                        let step = e - usize::from(self.exponents[place][j]);
                        if order + step > self.order() {
                            break;
                        }
                        (0..step).for_each(|_| place = self.raised[place][j]);
                        let sum_there = product.entry(place).or_default();
                        *sum_there = sum(*sum_there, times(c, b));
                    }
                }
                partial = product.into_iter().collect();
            }
            for (place, c) in partial {
                whole[place] = sum(whole[place], c);
            }
        }
        whole
    }
}

/// The terms up to an order of `(z + w)^exponent` as a polynomial in `w` that are not zero.
fn binomial(z: u64, exponent: u32, order: usize) -> Vec<(usize, u64)> {
    let (mut choices, mut terms) = (1, Vec::new());
    for e in 0..=exponent.min(order as u32) {
        if e > 0 {
            // Exponents are less than the prime.
            choices = times(times(choices, u64::from(exponent - e + 1)), inverse(u64::from(e)));
        }
        let value = times(choices, power(z, u64::from(exponent - e)));
        if value != 0 {
            terms.push((e as usize, value));
        }
    }
    terms
}

/// Functionals found so far.
struct Dual<'a> {
    monomials: &'a Monomials,
    /// By their coefficients at the monomials; the first is the value at the point.
    functionals: Vec<Vec<u64>>,
    /// `lowered[b]`: functional `b` with its exponents of a variable lowered, in terms of the
    /// functionals; that of variable `i` and functional `a` at `i * width + a`, as far as they were
    /// known then.
    lowered: Vec<Vec<Vec<u64>>>,
}

impl<'a> Dual<'a> {
    fn new(monomials: &'a Monomials) -> Dual<'a> {
        let variables = monomials.exponents[0].len();
        Dual { monomials, functionals: vec![vec![1]], lowered: vec![vec![vec![0]; variables]] }
    }

    /// Adds the functionals of an order.
    fn grow(&mut self, equations: &[Vec<u64>], order: usize) {
        let (n, m) = (self.monomials.exponents[0].len(), self.functionals.len());
        // Unknowns: functional `b` in what lowering variable `i` gives, at `i * m + b`.
        let entry = |b: usize, i: usize, a: usize| self.lowered[b][i].get(a).copied().unwrap_or(0);
        let mut rows = Echelon::new(n * m);
        for i in 0..n {
            for j in i + 1..n {
                // Lowering `i` and then `j` is lowering `j` and then `i`.
                for a in 0..m {
                    let mut row = vec![0; n * m];
                    for b in 0..m {
                        row[i * m + b] = entry(b, j, a);
                        row[j * m + b] = difference(0, entry(b, i, a));
                    }
                    rows.add(row);
                }
            }
        }
        let integrals: Vec<Vec<(usize, u64)>> =
            (0..n * m).map(|k| self.integral(k / m, &self.functionals[k % m])).collect();
        for equation in equations {
            let value = |terms: &Vec<(usize, u64)>| terms.iter().fold(0, |s, &(k, c)| sum(s, times(c, equation[k])));
            rows.add(integrals.iter().map(value).collect());
        }
        // Solutions are free in the columns without a pivot; what is known already fixes as many of
        // these as there are functionals of an order of one at least.
        let free = rows.free();
        let mut known = Echelon::new(free.len());
        for b in 1..m {
            known.add(free.iter().map(|&k| entry(b, k / m, k % m)).collect());
        }
        for column in known.free() {
            let vector = rows.null_vector(free[column]);
            let mut functional = vec![0; self.monomials.counts[order]];
            for (integral, &c) in integrals.iter().zip(&vector).filter(|(_, c)| **c != 0) {
                for &(k, value) in integral {
                    functional[k] = sum(functional[k], times(c, value));
                }
            }
            self.functionals.push(functional);
            self.lowered.push(vector.chunks(m).map(<[u64]>::to_vec).collect());
        }
    }

    /// What is lowered in variable `i` gives the functional, as far as monomials go whose last
    /// variable is that one.
    fn integral(&self, i: usize, functional: &[u64]) -> Vec<(usize, u64)> {
        let ends = |k: usize| self.monomials.exponents[k][i + 1..].iter().all(|&e| e == 0);
        let terms = functional.iter().enumerate().filter(|&(k, &c)| c != 0 && ends(k));
        terms.map(|(k, &c)| (self.monomials.raised[k][i], c)).collect()
    }
}
