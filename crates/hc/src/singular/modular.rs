//! Polynomials and matrices modulo a prime, by which statements are proved in little time.

use super::prime_field::Residue;
use num_traits::{One, Zero};

/// The coefficients of a polynomial by ascending powers without leading ones that are zero.
pub(crate) fn trimmed<T: Zero>(mut coefficients: Vec<T>) -> Vec<T> {
    while coefficients.last().is_some_and(Zero::is_zero) {
        coefficients.pop();
    }
    coefficients
}

/// The resultant of two polynomials by ascending powers, their last coefficients not zero.
pub(crate) fn resultant(a: Vec<Residue>, b: Vec<Residue>) -> Residue {
    euclid(a, b).1
}

/// Whether a polynomial, its coefficients by ascending exponents and the last not zero, has no
/// multiple roots.
pub(crate) fn is_squarefree(whole: Vec<Residue>) -> bool {
    let slope = slope(&whole);
    euclid(whole, slope).0.len() == 1
}

/// The derivative of a polynomial by ascending powers.
pub(super) fn slope(whole: &[Residue]) -> Vec<Residue> {
    whole.iter().zip(0u32..).skip(1).map(|(&c, e)| c * e.into()).collect()
}

/// A greatest common divisor of two polynomials by ascending powers, not both zero.
pub(super) fn divisor(a: Vec<Residue>, b: Vec<Residue>) -> Vec<Residue> {
    euclid(trimmed(a), b).0
}

/// The quotient of two polynomials by ascending powers, the second of which divides the first.
pub(super) fn divided(a: &[Residue], by: &[Residue]) -> Vec<Residue> {
    let (mut rest, mut quotient) = (trimmed(a.to_vec()), Vec::new());
    let Some(inverse) = by.last().map(|leading| leading.inverse()) else { return quotient };
    while rest.len() >= by.len() {
        let (place, Some(last)) = (rest.len() - by.len(), rest.pop()) else { break };
        let factor = last * inverse;
        Residue::subtract(&mut rest[place..], factor, by);
        quotient.push(factor);
    }
    quotient.reverse();
    quotient
}

/// A greatest common divisor, which is not zero, and the resultant, by Euclid's algorithm.
fn euclid(mut a: Vec<Residue>, b: Vec<Residue>) -> (Vec<Residue>, Residue) {
    let mut b = trimmed(b);
    let mut resultant = Residue::one();
    while let Some(&leading) = b.last() {
        let (before, degree) = (a.len() - 1, b.len() - 1);
        let factor = leading.inverse();
        while a.len() >= b.len() {
            let (place, Some(last)) = (a.len() - b.len(), a.pop()) else { break };
            let factor = last * factor;
            Residue::subtract(&mut a[place..], factor, &b);
        }
        a = trimmed(a);
        // res(a, b) = (-1)^(deg a deg b) lead(b)^(deg a - deg r) res(b, r) with the remainder r; if b is
        // constant, it is b^(deg a).
        if degree > 0 {
            let lost = before + 1 - a.len().max(1);
            resultant *= leading.power(lost as u64);
            if before * degree % 2 == 1 {
                resultant = -resultant;
            }
        } else {
            resultant *= leading.power(before as u64);
        }
        std::mem::swap(&mut a, &mut b);
    }
    if a.len() > 1 {
        resultant = Residue::zero();
    }
    (a, resultant)
}

/// The row echelon form of a matrix that grows by rows: each has a one in a column in which all
/// others have a zero.
pub(super) struct Echelon {
    width: usize,
    /// The rows with their pivots' columns.
    rows: Vec<(usize, Vec<Residue>)>,
}

impl Echelon {
    /// The form without rows.
    pub(super) fn new(width: usize) -> Echelon {
        Echelon { width, rows: Vec::new() }
    }

    /// Adds a row as wide as the matrix.
    pub(super) fn add(&mut self, mut row: Vec<Residue>) {
        for (column, known) in &self.rows {
            reduce(&mut row, *column, known);
        }
        let Some(column) = row.iter().position(|c| !c.is_zero()) else { return };
        let factor = row[column].inverse();
        row.iter_mut().filter(|c| !c.is_zero()).for_each(|c| *c *= factor);
        for (_, known) in &mut self.rows {
            reduce(known, column, &row);
        }
        self.rows.push((column, row));
    }

    /// The columns without a pivot.
    pub(super) fn free(&self) -> Vec<usize> {
        let mut taken = vec![false; self.width];
        self.rows.iter().for_each(|(column, _)| taken[*column] = true);
        (0..self.width).filter(|&k| !taken[k]).collect()
    }

    /// The vector that all rows map to zero, with a one in column `free` and zeros in the other columns
    /// without a pivot.
    pub(super) fn null_vector(&self, free: usize) -> Vec<Residue> {
        let mut vector = vec![Residue::zero(); self.width];
        vector[free] = Residue::one();
        for (column, row) in &self.rows {
            vector[*column] = -row[free];
        }
        vector
    }
}

/// Subtracts a multiple of `other`, which has a one in this column, so that the row has a zero there.
fn reduce(row: &mut [Residue], column: usize, other: &[Residue]) {
    let factor = row[column];
    if !factor.is_zero() {
        for (a, &b) in row.iter_mut().zip(other).filter(|(_, b)| !b.is_zero()) {
            *a -= factor * b;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::prime_field::{PrimeField, Residue};
    use super::{Echelon, resultant};
    use num_traits::{One, Zero};
    use proptest::prelude::{any, prop, prop_assert_eq, proptest};

    /// A random field.
    fn field(seed: u64) -> PrimeField {
        PrimeField::pair(seed, std::iter::empty())[0]
    }

    fn with_roots(leading: Residue, roots: &[Residue]) -> Vec<Residue> {
        roots.iter().fold(vec![leading], |p, &root| {
            let mut next = vec![Residue::zero()];
            next.extend(&p);
            for (n, &c) in next.iter_mut().zip(&p) {
                *n -= root * c;
            }
            next
        })
    }

    proptest! {
        /// Rows are mapped to zero by as many vectors as the rank leaves.
        #[test]
        fn null_vectors_of_few_rows(seed in any::<u64>(), rows in prop::collection::vec(prop::collection::vec(0..3u64, 5), 0..7)) {
            field(seed).run(|| {
                let mut echelon = Echelon::new(5);
                let rows: Vec<Vec<Residue>> = rows.iter().map(|row| row.iter().map(|&c| Residue::new(c)).collect()).collect();
                rows.iter().for_each(|row| echelon.add(row.clone()));
                let free = echelon.free();
                prop_assert_eq!(free.len() + echelon.rows.len(), 5);
                for &k in &free {
                    let vector = echelon.null_vector(k);
                    for row in &rows {
                        let sum = row.iter().zip(&vector).fold(Residue::zero(), |s, (&a, &b)| s + a * b);
                        prop_assert_eq!(sum, Residue::zero());
                    }
                }
                Ok(())
            })?;
        }

        /// The product of the differences of all roots.
        #[test]
        fn resultants_are_those_of_the_roots(
            seed in any::<u64>(),
            a in prop::collection::vec(any::<u64>(), 0..6),
            b in prop::collection::vec(any::<u64>(), 1..6),
            leading in (1..1u64 << 60, 1..1u64 << 60),
        ) {
            field(seed).run(|| {
                let [a, b] = [a, b].map(|roots| roots.into_iter().map(Residue::new).collect::<Vec<_>>());
                let leading = (Residue::new(leading.0), Residue::new(leading.1));
                let mut want = Residue::one();
                for &x in &a {
                    for &y in &b {
                        want *= x - y;
                    }
                }
                (0..b.len()).for_each(|_| want *= leading.0);
                (0..a.len()).for_each(|_| want *= leading.1);
                prop_assert_eq!(resultant(with_roots(leading.0, &a), with_roots(leading.1, &b)), want);
                let mut shared = a;
                shared.push(b[0]);
                let zero = resultant(with_roots(leading.0, &shared), with_roots(leading.1, &b));
                prop_assert_eq!(zero, Residue::zero());
                Ok(())
            })?;
        }
    }
}
