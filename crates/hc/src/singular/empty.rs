//! Shows, by linear algebra modulo primes, that a number of general hyperplanes meet no solution.

use super::equations::ExactEquations;
use super::modular::{Echelon, trimmed};
use super::monomials::Monomials;
use super::multiplicity::Modular;
use super::prime_field::Residue;
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use num_traits::Zero;

/// Most monomials up to a degree in the unknowns that the hyperplanes leave.
const MONOMIALS: usize = 4_400;
/// Products modulo the prime at most. The proof that cyclic-9 has nothing of dimension three needs
/// fewer, and takes some seconds.
const WORK: u64 = 4_000_000_000;
/// Largest exponent.
const EXPONENT: u32 = 64;

/// Whether it is shown that the equations have no solution on `dimension` general hyperplanes: then
/// no solution set has that dimension or a higher one.
///
/// The hyperplanes eliminate `dimension` unknowns. Multiples of the equations up to a degree are then
/// combined to the constant one (Lazard 1983; combinations that fall in degree are further equations,
/// Ding et al. 2008). The arithmetic is modulo a random prime of 61 bits, and the hyperplanes are random there; all of
/// it is done twice, by the seed of the equations. A proof modulo a prime is one for general hyperplanes, unless the prime is one
/// of the few that divide certain determinants; the probability that both are is tiny, but not zero.
pub(crate) fn is_missed(given: &ExactEquations, dimension: usize, monitor: &Monitor) -> bool {
    let mut random = Random::of(given.seed(), Stream::Slice(dimension as u64));
    given.fields(&[]).into_iter().all(|field| field.run(|| is_missed_here(given, dimension, &mut random, monitor)))
}

/// [`is_missed`] modulo the prime of the thread.
fn is_missed_here(given: &ExactEquations, dimension: usize, random: &mut Random, monitor: &Monitor) -> bool {
    let Some(equations) = given.modular(EXPONENT) else { return false };
    let Some(affine) = affine(&equations, given.unknowns(), dimension, random) else { return true };
    let left = affine.first().map_or(0, |form| form.len() - 1);
    let count = |degree: usize| (1..=degree).fold(1, |count, k| count * (left + k) / k);
    let highest = (1..=EXPONENT as usize).take_while(|&degree| count(degree) <= MONOMIALS).last();
    highest.is_some_and(|highest| {
        Macaulay::new(&equations, &affine, highest, WORK, monitor).reaches_one().unwrap_or(false)
    })
}

/// The unknowns as affine forms in the unknowns that linear equations and random hyperplanes leave:
/// the coefficients, then the constant. `None` if these equations and hyperplanes have no solution.
pub(super) fn affine(
    equations: &[Modular],
    unknowns: usize,
    dimension: usize,
    random: &mut Random,
) -> Option<Vec<Vec<Residue>>> {
    let mut rows = Echelon::new(unknowns + 1);
    for terms in equations {
        if terms.iter().all(|(powers, _)| powers.iter().map(|&(_, e)| e).sum::<u32>() <= 1) {
            let mut row = vec![Residue::zero(); unknowns + 1];
            for (powers, c) in terms {
                let place = powers.first().map_or(unknowns, |&(j, _)| j);
                row[place] += *c;
            }
            rows.add(row);
        }
    }
    for _ in 0..dimension {
        rows.add((0..=unknowns).map(|_| Residue::random(random)).collect());
    }
    let free = rows.free();
    let (&constant, free) = free.split_last()?;
    if constant != unknowns {
        return None;
    }
    let columns: Vec<Vec<Residue>> = free.iter().chain([&constant]).map(|&k| rows.null_vector(k)).collect();
    Some((0..unknowns).map(|j| columns.iter().map(|column| column[j]).collect()).collect())
}

/// Multiples of equations, reduced by each other.
pub(super) struct Macaulay<'a> {
    pub(super) monomials: Monomials,
    monitor: &'a Monitor,
    pub(super) equations: Vec<Equation>,
    /// Rows by their highest monomials, which have the coefficient one and come last.
    pub(super) rows: Vec<Option<Vec<Residue>>>,
    /// Whether no equation was left out because its degree is too high.
    is_whole: bool,
    /// Products so far, and at most.
    pub(super) work: u64,
    limit: u64,
}

/// An equation in the unknowns that are left.
pub(super) struct Equation {
    /// The coefficients, up to that of the highest monomial.
    pub(super) row: Vec<Residue>,
    degree: usize,
    /// The degree of the multiples that are next.
    next: usize,
}

impl<'a> Macaulay<'a> {
    /// The equations in the unknowns that these affine forms leave, for multiples up to a degree.
    pub(super) fn new(
        equations: &[Modular],
        affine: &[Vec<Residue>],
        highest: usize,
        limit: u64,
        monitor: &'a Monitor,
    ) -> Macaulay<'a> {
        let left = affine.first().map_or(0, |form| form.len() - 1);
        let monomials = Monomials::new(left, highest);
        let rows = vec![None; monomials.exponents.len()];
        let mut all = Macaulay { monomials, monitor, equations: Vec::new(), rows, is_whole: true, work: 0, limit };
        for terms in equations {
            let degree = |(powers, _): &(Vec<(usize, u32)>, Residue)| powers.iter().map(|&(_, e)| e as usize).sum();
            if terms.iter().map(degree).max().unwrap_or(0) > highest {
                all.is_whole = false;
                continue;
            }
            let row = all.substituted(terms, affine);
            if let Some(last) = row.len().checked_sub(1) {
                let degree = all.degree(last);
                all.equations.push(Equation { row, degree, next: degree });
            }
        }
        all
    }

    /// An equation in the unknowns that are left.
    fn substituted(&mut self, terms: &Modular, affine: &[Vec<Residue>]) -> Vec<Residue> {
        let mut whole = vec![Residue::zero(); self.monomials.exponents.len()];
        for (powers, c) in terms {
            let (mut product, mut degree) = (vec![*c], 0);
            for form in powers.iter().flat_map(|&(j, e)| std::iter::repeat_n(&affine[j], e as usize)) {
                let Some((&constant, slopes)) = form.split_last() else { continue };
                degree += 1;
                let mut next: Vec<Residue> = product.iter().map(|&c| c * constant).collect();
                next.resize(self.monomials.counts[degree], Residue::zero());
                for (k, &c) in product.iter().enumerate() {
                    for (&place, &slope) in self.monomials.raised[k].iter().zip(slopes) {
                        next[place] += c * slope;
                    }
                }
                self.work += (form.len() * product.len()) as u64;
                product = next;
            }
            whole.iter_mut().zip(&product).for_each(|(w, &c)| *w += c);
        }
        trimmed(whole)
    }

    fn degree(&self, place: usize) -> usize {
        self.monomials.counts.partition_point(|&count| count <= place)
    }

    /// Whether combinations of multiples are one; `None` where that takes too much work.
    fn reaches_one(mut self) -> Option<bool> {
        for degree in 0..self.monomials.counts.len() {
            if self.grow(degree)? {
                return Some(true);
            }
            // If all monomials of a degree are leading ones, so are all higher ones, but the constant one is not.
            if self.is_full(degree) {
                return Some(false);
            }
        }
        Some(false)
    }

    /// Adds multiples up to a degree. Whether combinations of multiples are one; `None` where that takes too much
    /// work.
    pub(super) fn grow(&mut self, degree: usize) -> Option<bool> {
        // Multiples of the least degree come first.
        while let Some(which) = (0..self.equations.len()).min_by_key(|&i| self.equations[i].next) {
            let of = self.equations[which].next;
            if of > degree {
                break;
            }
            self.equations[which].next += 1;
            let by = of - self.equations[which].degree;
            let first = if by == 0 { 0 } else { self.monomials.counts[by - 1] };
            for factor in first..self.monomials.counts[by] {
                let Some(row) = self.reduced(self.multiple(which, factor))? else { continue };
                let place = row.len() - 1;
                if place == 0 {
                    return Some(true);
                }
                // A row that falls in degree is an equation of its own, with multiples of lower degree.
                let degree = self.degree(place);
                if degree < of {
                    self.equations.push(Equation { row: row.clone(), degree, next: degree + 1 });
                }
                self.rows[place] = Some(row);
            }
        }
        Some(false)
    }

    /// Whether all monomials of a degree are leading ones, and no equation has a higher degree.
    pub(super) fn is_full(&self, degree: usize) -> bool {
        let first = if degree == 0 { 0 } else { self.monomials.counts[degree - 1] };
        let full = self.rows[first..self.monomials.counts[degree]].iter().all(Option::is_some);
        full && self.is_whole && self.equations.iter().all(|e| e.degree <= degree)
    }

    /// Counts so many products; `None` where that is too much work.
    pub(super) fn spend(&mut self, products: usize) -> Option<()> {
        self.work = self.work.saturating_add(products as u64);
        (self.work <= self.limit && !self.monitor.is_cancelled()).then_some(())
    }

    /// An equation times a monomial.
    fn multiple(&self, which: usize, factor: usize) -> Vec<Residue> {
        let (row, factor) = (&self.equations[which].row, &self.monomials.exponents[factor]);
        let raised = |place: usize| {
            let steps = factor.iter().enumerate().flat_map(|(i, &e)| std::iter::repeat_n(i, usize::from(e)));
            steps.fold(place, |place, i| self.monomials.raised[place][i])
        };
        let mut multiple = vec![Residue::zero(); self.rows.len()];
        row.iter().enumerate().filter(|(_, c)| !c.is_zero()).for_each(|(k, &c)| multiple[raised(k)] = c);
        multiple
    }

    /// The row, reduced until no row before has its highest monomial. The inner `None` means that nothing
    /// is left of the row, the outer one that the reduction would take too much work.
    fn reduced(&mut self, mut row: Vec<Residue>) -> Option<Option<Vec<Residue>>> {
        loop {
            row = trimmed(row);
            let Some(&leading) = row.last() else { return Some(None) };
            self.work += row.len() as u64;
            let Some(known) = &self.rows[row.len() - 1] else {
                let factor = leading.inverse();
                row.iter_mut().for_each(|c| *c *= factor);
                return Some(Some(row));
            };
            if self.work > self.limit || self.monitor.is_cancelled() {
                return None;
            }
            Residue::subtract(&mut row, leading, known);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{any, prop_assert_eq, proptest};

    fn missed(text: &str, dimension: usize, seed: u64) -> bool {
        let system: poly::System = text.parse().unwrap();
        let given =
            ExactEquations::new(&system.expand(&Default::default()).unwrap(), vec![0; system.variables().len()]);
        is_missed(&given.seeded(seed), dimension, &Monitor::default())
    }

    #[test]
    fn sets_of_each_dimension() {
        // The twisted cubic, a plane with a point, nothing, and a line at infinity.
        for (text, dimension) in [
            ("y - x^2; z - x*y; x*z - y^2", 1),
            ("x*(x - 1); x*(y - 2); x*(z - 3)", 2),
            ("x*y - 1; x*y - 2; z - 1", -1),
            ("x + y - 1; x + y - 2", -1),
            ("(x - y)^2; (x - y)*(x + y - 1)", 1),
        ] {
            for d in 0..3 {
                assert_eq!(missed(text, d, 0), d as i32 > dimension, "{text} {d}");
            }
        }
    }

    proptest! {
        /// A conic, two points and a curve of degree four, with coefficients that are multiples of primes that serve
        /// well: just below 2^61, 2^62, 2^63 and 2^64, and of the form 2^64 - 2^32 + 1.
        #[test]
        fn large_primes_as_coefficients(seed in any::<u64>(), which in 0usize..5, factor in 1u32..1000, below: bool) {
            let prime = [(1u64 << 61) - 1, (1 << 62) - 57, (1 << 63) - 25, u64::MAX - 58, 0xFFFF_FFFF_0000_0001][which];
            let (c, one) = if below { ("1".to_owned(), format!("{factor}/{prime}")) } else { (format!("{factor}*{prime}"), "1".to_owned()) };
            for (text, dimension) in [
                (format!("{c}*x*y - {one}"), 1),
                (format!("{c}*(x - y) - {one}; x^2 + y^2 - 3"), 0),
                (format!("{c}*(x*y + z - x^2) - {one}; x^2 + y^2 + z^2 - 3"), 1),
                (format!("{c}*x*y - {one}; x*y - 2*{one}"), -1),
            ] {
                // Where points are left, and where nothing is: these are told at once.
                for d in usize::try_from(dimension).into_iter().chain([(dimension + 1) as usize]) {
                    prop_assert_eq!(missed(&text, d, seed), d as i32 > dimension, "{} {}", text, d);
                }
            }
        }
    }
}
