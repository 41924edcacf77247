//! Arithmetic modulo a prime, in which exact numbers have images. It proves statements in little
//! time.

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use num_traits::{One, Zero};
use poly::Exact;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A prime modulo which -1 is a square.
pub(crate) const PRIME: u64 = 0xFFFF_FFFF_0000_0001;
/// A square root of -1.
const ROOT: Residue = Residue(1 << 48);

/// A residue modulo the prime, less than it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Residue(u64);

impl Residue {
    /// The residue of an integer.
    pub(crate) fn new(value: u64) -> Residue {
        Residue(value % PRIME)
    }

    pub(super) fn power(self, mut exponent: u64) -> Residue {
        let (mut base, mut power) = (self, Residue(1));
        while exponent > 0 {
            if exponent & 1 == 1 {
                power *= base;
            }
            base *= base;
            exponent >>= 1;
        }
        power
    }

    /// The inverse; zero for zero.
    pub(super) fn inverse(self) -> Residue {
        self.power(PRIME - 2)
    }

    /// The image of an exact number; `None` where the prime divides a denominator.
    pub(crate) fn image(c: &Exact) -> Option<Residue> {
        let integer = |n: &BigInt| {
            let size = Residue((n.magnitude() % PRIME).iter_u64_digits().next().unwrap_or(0));
            if n.sign() == Sign::Minus { -size } else { size }
        };
        let rational = |q: &BigRational| {
            let below = integer(q.denom());
            (!below.is_zero()).then(|| integer(q.numer()) * below.inverse())
        };
        Some(rational(&c.re)? + ROOT * rational(&c.im)?)
    }
}

fn difference(a: u64, b: u64) -> u64 {
    if a >= b { a - b } else { a.wrapping_sub(b).wrapping_add(PRIME) }
}

fn sum(a: u64, b: u64) -> u64 {
    difference(a, difference(0, b))
}

fn product(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    let (low, high) = (product as u64, (product >> 64) as u64);
    // 2^64 is 2^32 - 1, and 2^96 is -1.
    let (top, middle) = (high >> 32, (high & 0xFFFF_FFFF) * 0xFFFF_FFFF);
    let low = if low >= PRIME { low - PRIME } else { low };
    sum(difference(low, top), middle)
}

/// Operators, and those that assign, of numbers below the prime.
macro_rules! operators {
    ($($operator:ident::$name:ident, $assign:ident::$assign_name:ident: $of:ident;)*) => {$(
        impl $operator for Residue {
            type Output = Residue;

            fn $name(self, other: Residue) -> Residue {
                Residue($of(self.0, other.0))
            }
        }

        impl $assign for Residue {
            fn $assign_name(&mut self, other: Residue) {
                self.0 = $of(self.0, other.0);
            }
        }
    )*};
}

operators! {
    Add::add, AddAssign::add_assign: sum;
    Sub::sub, SubAssign::sub_assign: difference;
    Mul::mul, MulAssign::mul_assign: product;
}

impl Neg for Residue {
    type Output = Residue;

    fn neg(self) -> Residue {
        Residue(difference(0, self.0))
    }
}

impl Zero for Residue {
    fn zero() -> Residue {
        Residue(0)
    }

    fn is_zero(&self) -> bool {
        self.0 == 0
    }
}

impl One for Residue {
    fn one() -> Residue {
        Residue(1)
    }
}

impl From<u32> for Residue {
    fn from(value: u32) -> Residue {
        Residue(u64::from(value))
    }
}

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
        rest[place..].iter_mut().zip(by).for_each(|(r, &c)| *r -= factor * c);
        quotient.push(factor);
    }
    quotient.reverse();
    quotient
}

/// A greatest common divisor, which is not zero, and the resultant, by Euclid's algorithm.
fn euclid(mut a: Vec<Residue>, b: Vec<Residue>) -> (Vec<Residue>, Residue) {
    let mut b = trimmed(b);
    let mut resultant = Residue(1);
    while let Some(&leading) = b.last() {
        let (before, degree) = (a.len() - 1, b.len() - 1);
        let factor = leading.inverse();
        while a.len() >= b.len() {
            let (place, Some(last)) = (a.len() - b.len(), a.pop()) else { break };
            let factor = last * factor;
            for (r, &c) in a[place..].iter_mut().zip(&b) {
                *r -= factor * c;
            }
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
        resultant = Residue(0);
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
        let mut vector = vec![Residue(0); self.width];
        vector[free] = Residue(1);
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
    use super::{Echelon, PRIME, Residue, resultant};
    use num_traits::Zero;
    use proptest::prelude::{Strategy, prop, prop_assert_eq, proptest};

    fn residues() -> impl Strategy<Value = Residue> {
        (0..PRIME).prop_map(Residue)
    }

    fn with_roots(leading: Residue, roots: &[Residue]) -> Vec<Residue> {
        roots.iter().fold(vec![leading], |p, &root| {
            let mut next = vec![Residue(0)];
            next.extend(&p);
            for (n, &c) in next.iter_mut().zip(&p) {
                *n -= root * c;
            }
            next
        })
    }

    proptest! {
        #[test]
        fn products_are_those_of_integers(a in 0..PRIME, b in 0..PRIME) {
            let product = |a: u64, b: u64| u128::from((Residue(a) * Residue(b)).0);
            prop_assert_eq!(product(a, b), u128::from(a) * u128::from(b) % u128::from(PRIME));
            let edge = [0, 1, PRIME - 1, 0xFFFF_FFFF, 1 << 32, b];
            for c in edge {
                prop_assert_eq!(product(PRIME - 1, c), u128::from(PRIME - 1) * u128::from(c) % u128::from(PRIME));
            }
        }

        /// Rows are mapped to zero by as many vectors as the rank leaves.
        #[test]
        fn null_vectors_of_few_rows(rows in prop::collection::vec(prop::collection::vec((0..3u64).prop_map(Residue), 5), 0..7)) {
            let mut echelon = Echelon::new(5);
            rows.iter().for_each(|row| echelon.add(row.clone()));
            let free = echelon.free();
            prop_assert_eq!(free.len() + echelon.rows.len(), 5);
            for &k in &free {
                let vector = echelon.null_vector(k);
                for row in &rows {
                    prop_assert_eq!(row.iter().zip(&vector).fold(Residue::zero(), |s, (&a, &b)| s + a * b), Residue(0));
                }
            }
        }

        /// The product of the differences of all roots.
        #[test]
        fn resultants_are_those_of_the_roots(
            a in prop::collection::vec(residues(), 0..6),
            b in prop::collection::vec(residues(), 1..6),
            leading in (1..PRIME, 1..PRIME),
        ) {
            let leading = (Residue(leading.0), Residue(leading.1));
            let mut want = Residue(1);
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
            prop_assert_eq!(resultant(with_roots(leading.0, &shared), with_roots(leading.1, &b)), Residue(0));
        }
    }
}
