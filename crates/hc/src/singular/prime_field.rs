//! Arithmetic modulo random primes, in which exact numbers have images.
//!
//! A prime that is known beforehand divides the coefficients of some systems, which then become others. Primes are
//! therefore drawn, and drawn again where one divides a numerator or a denominator. Operators take the prime from the
//! thread, which has one as long as [`PrimeField::run`] lasts; a residue cannot leave its thread.

use crate::random::{Random, Stream};
use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use num_traits::{One, Zero};
use poly::Exact;
use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Bases that show of each number below 3e24 whether it is prime (Sorenson & Webster 2017).
const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// The integers modulo a prime of 61 bits, modulo which -1 is a square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PrimeField {
    prime: u64,
    /// The number that times the prime is -1 modulo 2^64.
    inverse: u64,
    /// 2^64 and 2^128 modulo the prime.
    one: u64,
    square: u64,
    /// A square root of -1, times 2^64.
    root: u64,
}

thread_local! {
    /// The field in which this thread computes: none at first, in which everything is zero.
    static FIELD: Cell<PrimeField> =
        const { Cell::new(PrimeField { prime: 1, inverse: u64::MAX, one: 0, square: 0, root: 0 }) };
}

impl PrimeField {
    /// Two fields, by seed, in which these numbers have images, and none but zero has the image zero.
    pub(crate) fn pair<'a>(seed: u64, numbers: impl Iterator<Item = &'a Exact> + Clone) -> [PrimeField; 2] {
        let mut random = Random::of(seed, Stream::Primes);
        let first = PrimeField::suitable(&mut random, 0, numbers.clone());
        [first, PrimeField::suitable(&mut random, first.prime, numbers)]
    }

    /// A random field in which these numbers keep from zero, of another prime than this. Few primes divide any of
    /// the numbers, so that a search ends.
    fn suitable<'a>(random: &mut Random, other: u64, numbers: impl Iterator<Item = &'a Exact> + Clone) -> PrimeField {
        loop {
            let prime = (1 << 60) + 4 * random.below(1 << 58) + 1;
            if prime == other || !is_prime(prime) {
                continue;
            }
            let field = PrimeField::of(prime);
            let keeps = |c: &Exact| Residue::image(c).is_some_and(|image| image.is_zero() == c.is_zero());
            if field.run(|| numbers.clone().all(keeps)) {
                return field;
            }
        }
    }

    /// The field of a prime that is 1 modulo 4.
    fn of(prime: u64) -> PrimeField {
        // Newton's method; each step doubles the digits, of which an odd number has three.
        let inverse =
            (0..5).fold(prime, |x, _| x.wrapping_mul(2u64.wrapping_sub(prime.wrapping_mul(x)))).wrapping_neg();
        let one = ((1u128 << 64) % u128::from(prime)) as u64;
        let square = product(one, one, prime);
        // That of every number without a square root; half of all have none.
        let roots = BASES.iter().chain(&[41, 43, 47]).map(|&base| power(base, prime >> 2, prime));
        let root = roots.chain((48..prime).map(|base| power(base, prime >> 2, prime)));
        let root = root.into_iter().find(|&root| product(root, root, prime) == prime - 1).unwrap_or(0);
        PrimeField { prime, inverse, one, square, root: product(root, one, prime) }
    }

    /// Computes something in this field, on this thread alone.
    pub(crate) fn run<T>(self, work: impl FnOnce() -> T) -> T {
        /// Puts back what was there, even after a panic.
        struct Before(PrimeField);
        impl Drop for Before {
            fn drop(&mut self) {
                FIELD.set(self.0);
            }
        }
        let _before = Before(FIELD.replace(self));
        work()
    }

    /// Montgomery's product `a b / 2^64` (1985).
    #[inline]
    fn product(self, a: u64, b: u64) -> u64 {
        let whole = u128::from(a) * u128::from(b);
        let multiple = (whole as u64).wrapping_mul(self.inverse);
        // Below twice the prime.
        let reduced = ((whole + u128::from(multiple) * u128::from(self.prime)) >> 64) as u64;
        reduced.min(reduced.wrapping_sub(self.prime))
    }

    #[inline]
    fn sum(self, a: u64, b: u64) -> u64 {
        let sum = a + b;
        sum.min(sum.wrapping_sub(self.prime))
    }

    #[inline]
    fn difference(self, a: u64, b: u64) -> u64 {
        let difference = a.wrapping_sub(b);
        difference.min(difference.wrapping_add(self.prime))
    }
}

/// The product of two numbers modulo another.
fn product(a: u64, b: u64, modulus: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(modulus)) as u64
}

/// A power modulo a number.
fn power(mut base: u64, mut exponent: u64, modulus: u64) -> u64 {
    let mut power = 1;
    while exponent > 0 {
        if exponent & 1 == 1 {
            power = product(power, base, modulus);
        }
        base = product(base, base, modulus);
        exponent >>= 1;
    }
    power
}

/// Whether a number larger than all bases is prime, by the test of Miller and Rabin.
fn is_prime(n: u64) -> bool {
    if n.is_multiple_of(2) || BASES.iter().any(|&base| n.is_multiple_of(base)) {
        return false;
    }
    let twos = (n - 1).trailing_zeros();
    BASES.iter().all(|&base| {
        let mut x = power(base, (n - 1) >> twos, n);
        x == 1
            || (0..twos).any(|_| {
                let before = x;
                x = product(x, x, n);
                before == n - 1
            })
    })
}

/// A residue modulo the prime of the thread: times 2^64, less than the prime.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Residue(u64, PhantomData<*const ()>);

impl Residue {
    #[inline]
    fn raw(value: u64) -> Residue {
        Residue(value, PhantomData)
    }

    /// The field of the thread, which has one.
    #[inline]
    fn field() -> PrimeField {
        let field = FIELD.get();
        debug_assert!(field.prime > 1, "residues are computed within PrimeField::run");
        field
    }

    /// The residue of an integer.
    pub(crate) fn new(value: u64) -> Residue {
        let field = Residue::field();
        Residue::raw(field.product(value % field.prime, field.square))
    }

    /// A random residue.
    pub(crate) fn random(random: &mut Random) -> Residue {
        Residue::raw(random.below(Residue::field().prime))
    }

    pub(crate) fn power(self, mut exponent: u64) -> Residue {
        let (mut base, mut power) = (self, Residue::one());
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
    pub(crate) fn inverse(self) -> Residue {
        self.power(Residue::field().prime - 2)
    }

    /// The image of an exact number; `None` where the prime divides a denominator.
    pub(crate) fn image(c: &Exact) -> Option<Residue> {
        let prime = Residue::field().prime;
        let integer = |n: &BigInt| {
            let size = Residue::new((n.magnitude() % prime).iter_u64_digits().next().unwrap_or(0));
            if n.sign() == Sign::Minus { -size } else { size }
        };
        let rational = |q: &BigRational| {
            let below = integer(q.denom());
            (!below.is_zero()).then(|| integer(q.numer()) * below.inverse())
        };
        Some(rational(&c.re)? + Residue::raw(Residue::field().root) * rational(&c.im)?)
    }

    /// Subtracts a multiple of a row from another, as far as both go.
    pub(crate) fn subtract(row: &mut [Residue], factor: Residue, other: &[Residue]) {
        let field = Residue::field();
        for (a, b) in row.iter_mut().zip(other) {
            a.0 = field.difference(a.0, field.product(factor.0, b.0));
        }
    }
}

impl std::fmt::Debug for Residue {
    /// The least integer that is not negative.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        Residue::field().product(self.0, 1).fmt(f)
    }
}

/// Operators, and those that assign.
macro_rules! operators {
    ($($operator:ident::$name:ident, $assign:ident::$assign_name:ident: $of:ident;)*) => {$(
        impl $operator for Residue {
            type Output = Residue;

            #[inline]
            fn $name(self, other: Residue) -> Residue {
                Residue::raw(Residue::field().$of(self.0, other.0))
            }
        }

        impl $assign for Residue {
            #[inline]
            fn $assign_name(&mut self, other: Residue) {
                self.0 = Residue::field().$of(self.0, other.0);
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
        Residue::zero() - self
    }
}

impl Zero for Residue {
    fn zero() -> Residue {
        Residue::raw(0)
    }

    fn is_zero(&self) -> bool {
        self.0 == 0
    }
}

impl One for Residue {
    fn one() -> Residue {
        Residue::raw(Residue::field().one)
    }
}

impl From<u32> for Residue {
    fn from(value: u32) -> Residue {
        Residue::new(u64::from(value))
    }
}

#[cfg(test)]
mod tests {
    use super::{BASES, PrimeField, Residue, is_prime};
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::{One, Zero};
    use poly::Exact;
    use proptest::prelude::{any, prop, prop_assert, prop_assert_eq, prop_assert_ne, proptest};
    use std::iter::empty;

    fn exact(re: BigInt, im: BigInt, below: BigInt) -> Exact {
        Exact::new(BigRational::new(re, below.clone()), BigRational::new(im, below))
    }

    /// 2^61 - 1 and 2^61 + 15 are prime (tables of Mersenne primes; Caldwell's list of primes just above powers of
    /// two), and strong pseudoprimes are not: the least to the bases up to 7, 23 and 31 (OEIS A014233).
    #[test]
    fn primes_are_told_from_others() {
        assert!(is_prime((1 << 61) - 1) && is_prime((1 << 61) + 15));
        assert!((1..8).all(|k| !is_prime((1 << 61) + 2 * k - 1)));
        for n in [3_215_031_751, 3_825_123_056_546_413_051, 1_125_899_906_842_597 * 37, 2_147_483_647 * 2_147_483_629] {
            assert!(!is_prime(n), "{n}");
        }
        let by_division = |n: u64| (2..).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d));
        assert!((BASES[11] + 1..3000).all(|n| is_prime(n) == by_division(n)));
    }

    proptest! {
        /// The image is a homomorphism of rings with `i * i = -1`, and fields are as drawn.
        #[test]
        fn images_are_those_of_exact_numbers(seed in any::<u64>(), a in prop::array::uniform3(any::<i128>()), b in prop::array::uniform3(any::<i128>())) {
            let number = |[re, im, below]: [i128; 3]| exact(re.into(), im.into(), BigInt::from(below.max(1)));
            let (a, b) = (number(a), number(b));
            let fields = PrimeField::pair(seed, [&a, &b].into_iter());
            prop_assert_ne!(fields[0].prime, fields[1].prime);
            prop_assert_eq!(fields, PrimeField::pair(seed, [&a, &b].into_iter()));
            for field in fields {
                prop_assert!(field.prime >> 60 == 1 && field.prime % 4 == 1 && is_prime(field.prime));
                field.run(|| {
                    let of = |c: &Exact| Residue::image(c).unwrap();
                    prop_assert_eq!(of(&(&a + &b)), of(&a) + of(&b));
                    prop_assert_eq!(of(&(&a - &b)), of(&a) - of(&b));
                    prop_assert_eq!(of(&(&a * &b)), of(&a) * of(&b));
                    prop_assert_eq!(of(&a) * of(&a).inverse(), if a.is_zero() { Residue::zero() } else { Residue::one() });
                    Ok(())
                })?;
            }
        }

        #[test]
        fn products_are_those_of_integers(seed in any::<u64>(), a in any::<u64>(), b in any::<u64>()) {
            let [field, _] = PrimeField::pair(seed, empty());
            let p = u128::from(field.prime);
            for (a, b) in [(a, b), (field.prime - 1, b), (field.prime - 1, field.prime - 1), (a, 0), (a, 1)] {
                field.run(|| {
                    let product = Residue::new((u128::from(a) * u128::from(b) % p) as u64);
                    prop_assert_eq!(Residue::new(a) * Residue::new(b), product);
                    let mut row = [Residue::new(7)];
                    Residue::subtract(&mut row, Residue::new(a), &[Residue::new(b)]);
                    prop_assert_eq!(row[0], Residue::new(7) - product);
                    Ok(())
                })?;
            }
        }

        /// Whatever a prime divides is seen: multiples of the primes that come first, as numerators, denominators and
        /// norms of complex numbers.
        #[test]
        fn primes_that_divide_a_number_are_drawn_again(seed in any::<u64>(), factor in 1i64..1000, place in 0usize..3) {
            let [first, second] = PrimeField::pair(seed, empty());
            let multiple = BigInt::from(first.prime) * second.prime * factor;
            let zero = BigInt::zero;
            let root = first.run(|| format!("{:?}", Residue::image(&exact(zero(), BigInt::one(), BigInt::one())).unwrap()));
            let number = match place {
                0 => exact(multiple, zero(), BigInt::one()),
                1 => exact(BigInt::one(), zero(), multiple),
                // The image of this number is zero, although neither of its parts has the image zero.
                _ => exact(root.parse().unwrap(), -BigInt::one(), BigInt::one()),
            };
            let drawn = PrimeField::pair(seed, [&number].into_iter());
            prop_assert!(!drawn.contains(&first));
            for field in drawn {
                prop_assert!(field.run(|| Residue::image(&number).is_some_and(|image| !image.is_zero())));
            }
        }
    }

    #[test]
    fn fields_end_with_their_work() {
        let [first, second] = PrimeField::pair(0, empty());
        let largest = |field: PrimeField| field.run(|| format!("{:?}", -Residue::one()));
        let (inner, outer) = first.run(|| (largest(second), format!("{:?}", -Residue::one())));
        assert_eq!((inner, outer), (format!("{}", second.prime - 1), format!("{}", first.prime - 1)));
    }
}
