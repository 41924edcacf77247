//! Arithmetic modulo a prime, in which exact numbers have images. It proves statements in little
//! time.

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use poly::Exact;

/// A prime modulo which -1 is a square.
pub(super) const PRIME: u64 = 0xFFFF_FFFF_0000_0001;
/// A square root of -1.
const ROOT: u64 = 1 << 48;

/// The product.
pub(super) fn times(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    let (low, high) = (product as u64, (product >> 64) as u64);
    // 2^64 is 2^32 - 1, and 2^96 is -1.
    let (top, middle) = (high >> 32, (high & 0xFFFF_FFFF) * 0xFFFF_FFFF);
    let low = if low >= PRIME { low - PRIME } else { low };
    sum(difference(low, top), middle)
}

/// The difference.
pub(super) fn difference(a: u64, b: u64) -> u64 {
    if a >= b { a - b } else { a.wrapping_sub(b).wrapping_add(PRIME) }
}

/// The inverse of what is not zero.
pub(super) fn inverse(a: u64) -> u64 {
    power(a, PRIME - 2)
}

/// The sum.
pub(super) fn sum(a: u64, b: u64) -> u64 {
    difference(a, difference(0, b))
}

/// The image of an exact number; `None` where the prime divides a denominator.
pub(super) fn image(c: &Exact) -> Option<u64> {
    let integer = |n: &BigInt| {
        let size = (n.magnitude() % PRIME).iter_u64_digits().next().unwrap_or(0);
        if n.sign() == Sign::Minus { difference(0, size) } else { size }
    };
    let rational = |q: &BigRational| {
        let below = integer(q.denom());
        (below != 0).then(|| times(integer(q.numer()), inverse(below)))
    };
    Some(sum(rational(&c.re)?, times(ROOT, rational(&c.im)?)))
}

/// Whether a polynomial, its coefficients by ascending exponents and the last not zero, has no
/// multiple roots.
pub(super) fn is_squarefree(whole: Vec<u64>) -> bool {
    let slope = whole.iter().zip(0..).skip(1).map(|(&c, e)| times(c, e)).collect();
    euclid(whole, slope).0.len() == 1
}

/// The resultant of two polynomials of the same kind.
pub(super) fn resultant(a: Vec<u64>, b: Vec<u64>) -> u64 {
    euclid(a, b).1
}

/// A greatest common divisor, not zero, and the resultant, by Euclid's algorithm.
fn euclid(mut a: Vec<u64>, mut b: Vec<u64>) -> (Vec<u64>, u64) {
    trim(&mut b);
    let mut resultant = 1;
    while let Some(&leading) = b.last() {
        let (before, degree) = (a.len() - 1, b.len() - 1);
        let factor = inverse(leading);
        while a.len() >= b.len() {
            let (place, Some(last)) = (a.len() - b.len(), a.pop()) else { break };
            let factor = times(last, factor);
            for (r, &c) in a[place..].iter_mut().zip(&b) {
                *r = difference(*r, times(factor, c));
            }
        }
        trim(&mut a);
        // res(a, b) = (-1)^(deg a deg b) lead(b)^(deg a - deg r) res(b, r), r the remainder; that of
        // a constant is its power.
        if degree > 0 {
            let lost = before + 1 - a.len().max(1);
            resultant = times(resultant, power(leading, lost as u64));
            if before * degree % 2 == 1 {
                resultant = difference(0, resultant);
            }
        } else {
            resultant = times(resultant, power(leading, before as u64));
        }
        std::mem::swap(&mut a, &mut b);
    }
    if a.len() > 1 {
        resultant = 0;
    }
    (a, resultant)
}

/// A power.
pub(super) fn power(mut base: u64, mut exponent: u64) -> u64 {
    let mut power = 1;
    while exponent > 0 {
        if exponent & 1 == 1 {
            power = times(power, base);
        }
        base = times(base, base);
        exponent >>= 1;
    }
    power
}

/// Drops leading coefficients that are zero.
pub(super) fn trim(a: &mut Vec<u64>) {
    while a.last() == Some(&0) {
        a.pop();
    }
}

/// The row echelon form of a matrix that grows by rows: each has a one in a column in which all
/// others have a zero.
pub(super) struct Echelon {
    width: usize,
    /// The rows with their pivots' columns.
    rows: Vec<(usize, Vec<u64>)>,
}

impl Echelon {
    /// Without rows.
    pub(super) fn new(width: usize) -> Echelon {
        Echelon { width, rows: Vec::new() }
    }

    /// Adds a row of that width.
    pub(super) fn add(&mut self, mut row: Vec<u64>) {
        for (column, known) in &self.rows {
            reduce(&mut row, *column, known);
        }
        let Some(column) = row.iter().position(|&c| c != 0) else { return };
        let factor = inverse(row[column]);
        row.iter_mut().filter(|c| **c != 0).for_each(|c| *c = times(*c, factor));
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

    /// The vector that all rows map to zero with a one in this column and zeros in the others
    /// without a pivot.
    pub(super) fn null_vector(&self, free: usize) -> Vec<u64> {
        let mut vector = vec![0; self.width];
        vector[free] = 1;
        for (column, row) in &self.rows {
            vector[*column] = difference(0, row[free]);
        }
        vector
    }
}

/// Takes from a row as much of another, with a one in this column, as leaves a zero there.
fn reduce(row: &mut [u64], column: usize, other: &[u64]) {
    let factor = row[column];
    if factor != 0 {
        for (a, &b) in row.iter_mut().zip(other).filter(|(_, b)| **b != 0) {
            *a = difference(*a, times(factor, b));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Echelon, PRIME, difference, resultant, sum, times};
    use proptest::prelude::{prop, prop_assert_eq, proptest};

    fn with_roots(leading: u64, roots: &[u64]) -> Vec<u64> {
        roots.iter().fold(vec![leading], |p, &root| {
            let mut next = vec![0];
            next.extend(&p);
            for (n, &c) in next.iter_mut().zip(&p) {
                *n = difference(*n, times(root, c));
            }
            next
        })
    }

    proptest! {
        #[test]
        fn products_are_those_of_integers(a in 0..PRIME, b in 0..PRIME) {
            prop_assert_eq!(u128::from(times(a, b)), u128::from(a) * u128::from(b) % u128::from(PRIME));
            let edge = [0, 1, PRIME - 1, 0xFFFF_FFFF, 1 << 32, b];
            for c in edge {
                prop_assert_eq!(u128::from(times(PRIME - 1, c)), u128::from(PRIME - 1) * u128::from(c) % u128::from(PRIME));
            }
        }

        /// Rows are mapped to zero by as many vectors as the rank leaves.
        #[test]
        fn null_vectors_of_few_rows(rows in prop::collection::vec(prop::collection::vec(0..3u64, 5), 0..7)) {
            let mut echelon = Echelon::new(5);
            rows.iter().for_each(|row| echelon.add(row.clone()));
            let free = echelon.free();
            prop_assert_eq!(free.len() + echelon.rows.len(), 5);
            for &k in &free {
                let vector = echelon.null_vector(k);
                for row in &rows {
                    prop_assert_eq!(row.iter().zip(&vector).fold(0, |s, (&a, &b)| sum(s, times(a, b))), 0);
                }
            }
        }

        /// The product of the differences of all roots.
        #[test]
        fn resultants_are_those_of_the_roots(
            a in prop::collection::vec(0..PRIME, 0..6),
            b in prop::collection::vec(0..PRIME, 1..6),
            leading in (1..PRIME, 1..PRIME),
        ) {
            let mut want = 1;
            for &x in &a {
                for &y in &b {
                    want = times(want, difference(x, y));
                }
            }
            (0..b.len()).for_each(|_| want = times(want, leading.0));
            (0..a.len()).for_each(|_| want = times(want, leading.1));
            prop_assert_eq!(resultant(with_roots(leading.0, &a), with_roots(leading.1, &b)), want);
            let mut shared = a;
            shared.push(b[0]);
            prop_assert_eq!(resultant(with_roots(leading.0, &shared), with_roots(leading.1, &b)), 0);
        }
    }
}
