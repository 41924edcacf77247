//! All solutions of equations, counted by their multiplicities modulo random primes.

use super::empty::{Macaulay, affine};
use super::equations::ExactEquations;
use super::modular::{divided, divisor, slope};
use super::prime_field::Residue;
use super::quotient::Quotient;
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use num_traits::{One, Zero};
use std::collections::BTreeMap;

/// Largest exponent.
const EXPONENT: u32 = 64;
/// Most monomials up to a degree in the unknowns that linear equations leave.
const MONOMIALS: usize = 2_500;

/// How many solutions there are of each multiplicity.
pub(crate) type Census = BTreeMap<usize, usize>;

/// Counts all solutions, if they are finitely many; `None` if they are not, or where `limit` products modulo each
/// of two primes do not tell, or these do not agree.
///
/// The dimension of the quotient of the ring of polynomials by the equations is the number of solutions with their
/// multiplicities. A general linear form acts on it with one eigenvalue at each solution, as often as its
/// multiplicity (Cox, Little & O'Shea, Using Algebraic Geometry, section 4.2). All this holds modulo a prime as it does
/// for the exact coefficients, unless the prime is one of the few that divide certain determinants. Two random primes
/// have to agree.
pub(crate) fn census(given: &ExactEquations, limit: u64, monitor: &Monitor) -> Option<Census> {
    let mut random = Random::of(given.seed(), Stream::Through);
    let mut here = || census_here(given, limit, &mut random, monitor);
    let [first, second] = given.fields(&[]);
    let found = first.run(&mut here)?;
    second.run(here).filter(|other| *other == found)
}

/// [`census`] modulo the prime of the thread.
fn census_here(given: &ExactEquations, limit: u64, random: &mut Random, monitor: &Monitor) -> Option<Census> {
    let equations = given.modular(EXPONENT)?;
    let Some(affine) = affine(&equations, given.unknowns(), 0, random) else { return Some(Census::new()) };
    let left = affine.first().map_or(0, |form| form.len() - 1);
    let count = |degree: usize| (1..=degree).fold(1, |count, k| count * (left + k) / k);
    let highest = (1..=EXPONENT as usize).take_while(|&degree| count(degree) <= MONOMIALS).last()?;
    let mut multiples = Macaulay::new(&equations, &affine, highest, limit, monitor);
    for degree in 0..=highest {
        if multiples.grow(degree)? {
            return Some(Census::new());
        }
        if degree > 0
            && multiples.is_full(degree)
            && let Some(quotient) = Quotient::new(&mut multiples, degree, random)
        {
            let dimension = quotient.dimension();
            multiples.spend(dimension.pow(3).saturating_mul(2))?;
            return Some(multiplicities(characteristic(quotient.random_form(random))));
        }
    }
    None
}

/// The multiplicities of the roots of a polynomial by ascending powers, its last coefficient not zero: how many roots
/// have each (Yun 1976). Its degree is below the prime.
fn multiplicities(whole: Vec<Residue>) -> Census {
    let mut census = Census::new();
    let slope_of_whole = slope(&whole);
    let common = divisor(whole.clone(), slope_of_whole.clone());
    let (mut rest, mut other) = (divided(&whole, &common), divided(&slope_of_whole, &common));
    for multiplicity in 1.. {
        if rest.len() <= 1 {
            break;
        }
        let mut difference = other.clone();
        let own = slope(&rest);
        difference.resize(difference.len().max(own.len()), Residue::zero());
        Residue::subtract(&mut difference, Residue::one(), &own);
        let part = divisor(rest.clone(), difference.clone());
        (rest, other) = (divided(&rest, &part), divided(&difference, &part));
        if part.len() > 1 {
            census.insert(multiplicity, part.len() - 1);
        }
    }
    census
}

/// The characteristic polynomial of a matrix by columns, by ascending powers, from its Hessenberg form (Cohen 1993, A
/// Course in Computational Algebraic Number Theory, algorithm 2.2.9).
fn characteristic(mut matrix: Vec<Vec<Residue>>) -> Vec<Residue> {
    let n = matrix.len();
    for m in 1..n {
        // Below the entry (m, m - 1) zeros are made; `matrix[j][i]` is the entry (i, j).
        let Some(pivot) = (m..n).find(|&i| !matrix[m - 1][i].is_zero()) else { continue };
        matrix.swap(pivot, m);
        matrix.iter_mut().for_each(|column| column.swap(pivot, m));
        let inverse = matrix[m - 1][m].inverse();
        for i in m + 1..n {
            let factor = matrix[m - 1][i] * inverse;
            if factor.is_zero() {
                continue;
            }
            for column in &mut matrix[m - 1..] {
                let c = column[m];
                column[i] -= factor * c;
            }
            let (before, after) = matrix.split_at_mut(i);
            Residue::subtract(&mut before[m], -factor, &after[0]);
        }
    }
    let mut minors: Vec<Vec<Residue>> = vec![vec![Residue::one()]];
    for m in 0..n {
        // (X - h_mm) p_(m-1), less the products that go round by the entries below the diagonal.
        let mut next = vec![Residue::zero()];
        next.extend(&minors[m]);
        let diagonal = matrix[m][m];
        Residue::subtract(&mut next, diagonal, &minors[m]);
        let mut round = Residue::one();
        for i in (0..m).rev() {
            round *= matrix[i][i + 1];
            let factor = round * matrix[m][i];
            Residue::subtract(&mut next, factor, &minors[i]);
        }
        minors.push(next);
    }
    minors.pop().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::{Census, census, characteristic, multiplicities};
    use crate::monitor::Monitor;
    use crate::singular::{ExactEquations, PrimeField, Residue};
    use num_traits::Zero;
    use proptest::prelude::{any, prop, prop_assert_eq, proptest};
    use std::cmp::Ordering;

    fn counted(text: &str) -> Option<Vec<(usize, usize)>> {
        let system: poly::System = text.parse().unwrap();
        let given =
            ExactEquations::new(&system.expand(&Default::default()).unwrap(), vec![0; system.variables().len()]);
        census(&given, 1 << 32, &Monitor::default()).map(|census| census.into_iter().collect())
    }

    /// By the factors of the equations, and by Bezout's theorem where nothing is at infinity.
    #[test]
    fn solutions_of_each_multiplicity() {
        for (text, expected) in [
            ("x^2 - 2; y^2 - 3; z^2 - 5", vec![(1, 8)]),
            (
                "x^2 - 2 + 10^-24*(x^3 + y^3 + 2*z^3); y^2 - 3 + 10^-24*(x^3 - y^3 + z^3); z^2 - 5 + 10^-24*(x^3 + 2*y^3 - z^3)",
                vec![(1, 27)],
            ),
            ("(z - 1)^2 = 10^-46; y*z = 1; x*z = 1", vec![(1, 2)]),
            ("(z^2 - z - 1)^2*(z^2 - z - 1 - 10^-20); y*z = 1; x*z = 1", vec![(1, 2), (2, 2)]),
            ("x^2; y^3; z - x*y", vec![(6, 1)]),
            // A fat point, whose multiplicity no power of a linear form shows, and a simple one.
            ("x^2*(x - 1); x*y; y^2", vec![(1, 1), (3, 1)]),
            ("(x - 1)^2; y^2 - x", vec![(2, 2)]),
            ("x + y - 1; x + y - 2", vec![]),
            ("x*y - 1; x*y - 2; z - 1", vec![]),
            ("x = 2; y = 3; x*y = 6", vec![(1, 1)]),
            ("x = 2; y = 3; x*y = 6 + 10^-14", vec![]),
            ("x + y + z; x*y + y*z + z*x; x*y*z - 1", vec![(1, 6)]),
        ] {
            assert_eq!(counted(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn curves_have_no_census() {
        for text in ["x*y; x*z; y*z - x", "(x - y)*(x + y - 1); (x - y)*(x - 2)", "x^2 - y^2; (x - y)*(x + 1)"] {
            assert_eq!(counted(text), None, "{text}");
        }
    }

    proptest! {
        /// A triangular matrix in other coordinates.
        #[test]
        fn eigenvalues_with_multiplicities(
            seed in any::<u64>(),
            roots in prop::collection::vec(0..5u64, 1..8),
            entries in prop::collection::vec(0..5u64, 128),
        ) {
            let mut expected = Census::new();
            for value in 0..5 {
                let count = roots.iter().filter(|&&root| root == value).count();
                if count > 0 {
                    *expected.entry(count).or_default() += 1;
                }
            }
            let [field, _] = PrimeField::pair(seed, std::iter::empty());
            let found = field.run(|| {
                let [roots, entries] = [roots, entries].map(|all| all.into_iter().map(Residue::new).collect::<Vec<_>>());
                let n = roots.len();
                let entry = |i: usize, j: usize| match i.cmp(&j) {
                    Ordering::Less => entries[8 * i + j],
                    Ordering::Equal => roots[i],
                    Ordering::Greater => Residue::zero(),
                };
                let mut matrix: Vec<Vec<Residue>> = (0..n).map(|j| (0..n).map(|i| entry(i, j)).collect()).collect();
                // Row operations with the inverse column operations.
                for k in 0..n * n {
                    let (a, b, factor) = (k % n, k / n, entries[64 + k]);
                    if a != b {
                        let from = matrix[a].clone();
                        Residue::subtract(&mut matrix[b], -factor, &from);
                        for column in &mut matrix {
                            let c = column[b];
                            column[a] -= factor * c;
                        }
                    }
                }
                multiplicities(characteristic(matrix))
            });
            prop_assert_eq!(found, expected);
        }
    }
}
