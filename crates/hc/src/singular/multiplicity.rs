//! The multiplicity of an isolated solution with rational coordinates, by its dual space modulo a
//! prime, that of the thread.

use super::dual::Count;
use super::modular::Echelon;
use super::monomials::Monomials;
use super::prime_field::Residue;
use num_traits::{One, Zero};
use std::collections::HashMap;

/// An equation modulo the prime: the powers of unknowns and the coefficient of each term.
pub(super) type Modular = Vec<(Vec<(usize, u32)>, Residue)>;

/// Orders up to which functionals are sought: the lower one first, because it needs less preparation.
const LOW_ORDER: usize = 8;
const HIGH_ORDER: usize = 128;
/// Most monomials.
const MONOMIALS: f64 = 20_000.0;
/// Most unknowns of the linear equations for the functionals of an order.
const WIDTH: usize = 3_000;

/// The search ends with this many times the number of functionals that are expected at most.
const BEYOND: usize = 2;

/// Counts the functionals at a point: the dimension of the local ring, modulo the prime. There are more
/// than `most` if they are far more, or grow beyond that in all orders that are looked at; where it would
/// take too much work to tell, the count is unfinished.
///
/// The dual space is found order by order, as in floating point (Dayton & Zeng 2005; Mourrain 1997).
pub(super) fn multiplicity(equations: &[Modular], point: &[Residue], most: usize) -> Count {
    let count = |order: usize| (1..=order).map(|k| (point.len() + k) as f64 / k as f64).product::<f64>();
    let Some(highest) = (1..=HIGH_ORDER).rev().find(|&order| count(order) <= MONOMIALS) else {
        return Count::Unfinished;
    };
    let mut more = false;
    for order in [LOW_ORDER.min(highest), highest] {
        let monomials = Monomials::new(point.len(), order);
        let equations: Vec<Vec<Residue>> = equations.iter().map(|terms| expansion(&monomials, terms, point)).collect();
        let mut dual = Dual::new(&monomials);
        for next in 1..=order {
            let before = dual.functionals.len();
            if before > most.saturating_mul(BEYOND) {
                return Count::More;
            }
            if before * point.len() > WIDTH {
                return if before > most { Count::More } else { Count::Unfinished };
            }
            dual.grow(&equations, next);
            if dual.functionals.len() == before {
                return Count::All(before);
            }
            more = before > most;
        }
    }
    if more { Count::More } else { Count::Unfinished }
}

/// The coefficients of an equation at a point as a polynomial in the differences from it.
fn expansion(monomials: &Monomials, terms: &Modular, point: &[Residue]) -> Vec<Residue> {
    let mut whole = vec![Residue::zero(); monomials.exponents.len()];
    for (powers, c) in terms {
        // One factor after the other.
        let mut partial: Vec<(usize, Residue)> = vec![(0, *c)];
        for &(j, exponent) in powers {
            let factor = binomial(point[j], exponent, monomials.order());
            let mut product: HashMap<usize, Residue> = HashMap::new();
            for &(mut place, c) in &partial {
                for &(e, b) in &factor {
                    let order: usize = monomials.exponents[place].iter().map(|&e| usize::from(e)).sum();
                    let step = e - usize::from(monomials.exponents[place][j]);
                    if order + step > monomials.order() {
                        break;
                    }
                    (0..step).for_each(|_| place = monomials.raised[place][j]);
                    *product.entry(place).or_default() += c * b;
                }
            }
            partial = product.into_iter().collect();
        }
        for (place, c) in partial {
            whole[place] += c;
        }
    }
    whole
}

/// The nonzero terms of `(z + w)^exponent` as a polynomial in `w`, up to an order.
fn binomial(z: Residue, exponent: u32, order: usize) -> Vec<(usize, Residue)> {
    let (mut choices, mut terms) = (Residue::one(), Vec::new());
    for e in 0..=exponent.min(order as u32) {
        if e > 0 {
            // Exponents are less than the prime.
            choices *= Residue::from(exponent - e + 1) * Residue::from(e).inverse();
        }
        let value = choices * z.power(u64::from(exponent - e));
        if !value.is_zero() {
            terms.push((e as usize, value));
        }
    }
    terms
}

/// Functionals found so far.
struct Dual<'a> {
    monomials: &'a Monomials,
    /// Their coefficients at the monomials; the first functional is the value at the point.
    functionals: Vec<Vec<Residue>>,
    /// `lowered[b]`: functional `b` with its exponents of a variable lowered, in terms of the
    /// functionals; that of variable `i` and functional `a` at `i * width + a`, as far as they were
    /// known then.
    lowered: Vec<Vec<Vec<Residue>>>,
}

impl<'a> Dual<'a> {
    fn new(monomials: &'a Monomials) -> Dual<'a> {
        let variables = monomials.exponents[0].len();
        let (zero, one) = (Residue::zero(), Residue::one());
        Dual { monomials, functionals: vec![vec![one]], lowered: vec![vec![vec![zero]; variables]] }
    }

    /// Adds the functionals of an order.
    fn grow(&mut self, equations: &[Vec<Residue>], order: usize) {
        let (n, m) = (self.monomials.exponents[0].len(), self.functionals.len());
        // Unknowns: functional `b` in what lowering variable `i` gives, at `i * m + b`.
        let entry = |b: usize, i: usize, a: usize| self.lowered[b][i].get(a).copied().unwrap_or_default();
        let mut rows = Echelon::new(n * m);
        for i in 0..n {
            for j in i + 1..n {
                // Lowering `i` and then `j` is lowering `j` and then `i`.
                for a in 0..m {
                    let mut row = vec![Residue::zero(); n * m];
                    for b in 0..m {
                        row[i * m + b] = entry(b, j, a);
                        row[j * m + b] = -entry(b, i, a);
                    }
                    rows.add(row);
                }
            }
        }
        let integrals: Vec<Vec<(usize, Residue)>> =
            (0..n * m).map(|k| self.integral(k / m, &self.functionals[k % m])).collect();
        for equation in equations {
            let value = |terms: &Vec<(usize, Residue)>| {
                terms.iter().fold(Residue::zero(), |sum, &(k, c)| sum + c * equation[k])
            };
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
            let mut functional = vec![Residue::zero(); self.monomials.counts[order]];
            for (integral, &c) in integrals.iter().zip(&vector).filter(|(_, c)| !c.is_zero()) {
                for &(k, value) in integral {
                    functional[k] += c * value;
                }
            }
            self.functionals.push(functional);
            self.lowered.push(vector.chunks(m).map(<[Residue]>::to_vec).collect());
        }
    }

    /// The functional that gives this one when its exponents of variable `i` are lowered, as far as
    /// monomials go whose last variable is `i`.
    fn integral(&self, i: usize, functional: &[Residue]) -> Vec<(usize, Residue)> {
        let ends = |k: usize| self.monomials.exponents[k][i + 1..].iter().all(|&e| e == 0);
        let terms = functional.iter().enumerate().filter(|&(k, c)| !c.is_zero() && ends(k));
        terms.map(|(k, &c)| (self.monomials.raised[k][i], c)).collect()
    }
}
