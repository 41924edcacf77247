//! Polynomials modulo equations and a prime, where they have finitely many solutions: a space whose dimension is the
//! number of solutions, with their multiplicities, and in which unknowns act as matrices.

use super::empty::Macaulay;
use super::prime_field::Residue;
use crate::random::Random;
use num_traits::{One, Zero};

/// Random vectors on which products of matrices are compared.
const VECTORS: usize = 2;

/// The quotient of a ring of polynomials by an ideal, in a basis of monomials.
pub(super) struct Quotient {
    /// The columns of the multiplication by each unknown.
    matrices: Vec<Vec<Vec<Residue>>>,
}

impl Quotient {
    /// The quotient by equations of which multiples up to a degree are known, if all monomials of this degree are
    /// leading ones. `None` if these multiples do not tell, or it is too much work.
    ///
    /// The monomials that are not leading ones span it. They are a basis, and matrices that reduce products of them with
    /// unknowns are the multiplications, if and only if these matrices commute and the equations vanish at them (Mourrain
    /// 1999, A new criterion for normal form algorithms). Both are seen on random vectors.
    pub(super) fn new(multiples: &mut Macaulay<'_>, degree: usize, random: &mut Random) -> Option<Quotient> {
        let count = multiples.monomials.counts[degree];
        let basis: Vec<usize> = (0..count).filter(|&place| multiples.rows[place].is_none()).collect();
        let forms = normal_forms(multiples, &basis, count)?;
        let unknowns = multiples.monomials.exponents[0].len();
        let matrix = |i: usize| basis.iter().map(|&k| forms[multiples.monomials.raised[k][i]].clone()).collect();
        let found = Quotient { matrices: (0..unknowns).map(matrix).collect() };
        let products = basis.len() * basis.len() * (unknowns * unknowns * VECTORS + count);
        multiples.spend(products)?;
        (found.commutes(random) && found.solves(multiples)).then_some(found)
    }

    /// The number of solutions, with their multiplicities.
    pub(super) fn dimension(&self) -> usize {
        self.matrices.first().map_or(1, Vec::len)
    }

    /// The matrix, by columns, of a random linear form in the unknowns.
    pub(super) fn random_form(&self, random: &mut Random) -> Vec<Vec<Residue>> {
        let mut sum = vec![vec![Residue::zero(); self.dimension()]; self.dimension()];
        for matrix in &self.matrices {
            let factor = Residue::random(random);
            for (sum, column) in sum.iter_mut().zip(matrix) {
                Residue::subtract(sum, -factor, column);
            }
        }
        sum
    }

    fn commutes(&self, random: &mut Random) -> bool {
        (0..VECTORS).all(|_| {
            let vector: Vec<Residue> = (0..self.dimension()).map(|_| Residue::random(random)).collect();
            let once: Vec<Vec<Residue>> = self.matrices.iter().map(|matrix| product(matrix, &vector)).collect();
            let pairs = |j: usize| (0..j).map(move |i| (i, j));
            (0..self.matrices.len())
                .flat_map(pairs)
                .all(|(i, j)| product(&self.matrices[i], &once[j]) == product(&self.matrices[j], &once[i]))
        })
    }

    /// Whether the equations vanish at these matrices, by their values applied to one.
    fn solves(&self, multiples: &Macaulay<'_>) -> bool {
        let dimension = self.dimension();
        // One is the first monomial of the basis, unless there are no solutions.
        if dimension == 0 {
            return false;
        }
        let longest = multiples.equations.iter().map(|e| e.row.len()).max().unwrap_or(0);
        let mut values: Vec<Option<Vec<Residue>>> = vec![None; longest.max(1)];
        let mut one = vec![Residue::zero(); dimension];
        one[0] = Residue::one();
        values[0] = Some(one);
        for place in 0..longest {
            let (Some(value), Some(raised)) = (values[place].clone(), multiples.monomials.raised.get(place)) else {
                continue;
            };
            for (&next, matrix) in raised.iter().zip(&self.matrices) {
                if next < longest && values[next].is_none() {
                    values[next] = Some(product(matrix, &value));
                }
            }
        }
        multiples.equations.iter().all(|equation| {
            let mut sum = vec![Residue::zero(); dimension];
            for (&c, value) in equation.row.iter().zip(&values).filter(|(c, _)| !c.is_zero()) {
                let Some(value) = value else { return false };
                Residue::subtract(&mut sum, -c, value);
            }
            sum.iter().all(Zero::is_zero)
        })
    }
}

/// The first monomials in terms of the basis; `None` if that is too much work.
fn normal_forms(multiples: &mut Macaulay<'_>, basis: &[usize], count: usize) -> Option<Vec<Vec<Residue>>> {
    let mut forms: Vec<Vec<Residue>> = Vec::with_capacity(count);
    for place in 0..count {
        let mut form = vec![Residue::zero(); basis.len()];
        let terms = multiples.rows[place].as_ref().map_or(0, |row| row.iter().filter(|c| !c.is_zero()).count());
        multiples.spend(terms * basis.len())?;
        match (&multiples.rows[place], basis.binary_search(&place)) {
            (_, Ok(k)) => form[k] = Residue::one(),
            (Some(row), _) => {
                for (&c, known) in row[..place].iter().zip(&forms).filter(|(c, _)| !c.is_zero()) {
                    Residue::subtract(&mut form, c, known);
                }
            }
            (None, Err(_)) => return None,
        }
        forms.push(form);
    }
    Some(forms)
}

fn product(columns: &[Vec<Residue>], vector: &[Residue]) -> Vec<Residue> {
    let mut sum = vec![Residue::zero(); vector.len()];
    for (column, &factor) in columns.iter().zip(vector).filter(|(_, c)| !c.is_zero()) {
        Residue::subtract(&mut sum, -factor, column);
    }
    sum
}
