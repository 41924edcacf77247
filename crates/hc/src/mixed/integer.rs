//! The sizes of integers in which mixed cells are found.

use std::cmp::Ordering;

/// Integers in which a cell is held.
pub(super) trait Integer: Copy + Ord + Default + Send + Sync {
    /// Half of what the type holds: volumes, and inner products of duals with differences of
    /// points, stay below this.
    const HALF: u128;

    /// The number, `None` if it is not below [`Integer::HALF`] in size.
    fn narrow(value: i128) -> Option<Self>;
    fn wide(self) -> i128;
    /// `sum + a * b`, wrapping; the caller has bounded it.
    fn accumulate(sum: Self, a: Self, b: Self) -> Self;
    fn sum(a: Self, b: Self) -> Self;
    fn difference(a: Self, b: Self) -> Self;
    fn negated(self) -> Self;
    fn size(self) -> Self;
    /// `(a * b + c * d) / divisor` of a quotient known to fit, by wrapping arithmetic.
    fn exact(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>) -> Self;
    /// The quotient of [`exact`](Self::exact), `None` if it does not fit.
    fn checked_exact(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>) -> Option<Self>;
    /// Whether `(a * b + c * d) / divisor` is surely below `limit` and right by [`Integer::exact`];
    /// none is negative.
    fn surely_below(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>, limit: Self) -> bool;
    /// `a * b` against `c * d`, `None` on overflow.
    fn compare(a: Self, b: Self, c: Self, d: Self) -> Option<Ordering>;
    /// Prepares division by a positive number.
    fn divisor(divisor: Self) -> Divisor<Self>;
}

/// A divisor `odd * 2^shift`, with the inverse of its odd part modulo the word size (Jebelean 1993,
/// exact division).
#[derive(Clone, Copy)]
pub(super) struct Divisor<T> {
    value: T,
    inverse: T,
    shift: u32,
}

macro_rules! integer {
    ($type:ident, $steps:expr, $below:expr, $compare:expr) => {
        impl Integer for $type {
            const HALF: u128 = 1 << ($type::BITS - 2);

            fn narrow(value: i128) -> Option<Self> {
                if value.unsigned_abs() < Self::HALF { Some(value as $type) } else { None }
            }

            #[inline(always)]
            fn wide(self) -> i128 {
                i128::from(self)
            }

            #[inline(always)]
            fn accumulate(sum: Self, a: Self, b: Self) -> Self {
                sum.wrapping_add(a.wrapping_mul(b))
            }

            #[inline(always)]
            fn sum(a: Self, b: Self) -> Self {
                a.wrapping_add(b)
            }

            #[inline(always)]
            fn difference(a: Self, b: Self) -> Self {
                a.wrapping_sub(b)
            }

            #[inline(always)]
            fn negated(self) -> Self {
                self.wrapping_neg()
            }

            #[inline(always)]
            fn size(self) -> Self {
                self.wrapping_abs()
            }

            #[inline(always)]
            fn exact(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>) -> Self {
                (a.wrapping_mul(b).wrapping_add(c.wrapping_mul(d))).wrapping_mul(divisor.inverse) >> divisor.shift
            }

            #[inline(always)]
            fn checked_exact(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>) -> Option<Self> {
                let quotient = products(a, b, c, d)? / i128::from(divisor.value);
                Self::narrow(quotient).filter(|q| {
                    // The wrapping form loses the bits of the even part.
                    q.unsigned_abs() < 1 << ($type::BITS - 1 - divisor.shift)
                })
            }

            #[inline(always)]
            fn surely_below(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>, limit: Self) -> bool {
                let limit = limit.min($type::MAX >> divisor.shift);
                $below(a, b, c, d, divisor.value, limit)
            }

            #[inline(always)]
            fn compare(a: Self, b: Self, c: Self, d: Self) -> Option<Ordering> {
                $compare(a, b, c, d)
            }

            fn divisor(divisor: Self) -> Divisor<Self> {
                let shift = divisor.trailing_zeros();
                let odd = divisor >> shift;
                // Right to three bits; each step of Newton's method doubles their number.
                let mut inverse = odd;
                for _ in 0..$steps {
                    inverse = inverse.wrapping_mul((2 as $type).wrapping_sub(odd.wrapping_mul(inverse)));
                }
                Divisor { value: divisor, inverse, shift }
            }
        }
    };
}

/// `a * b + c * d`, `None` on overflow.
#[inline(always)]
fn products<T: Into<i128>>(a: T, b: T, c: T, d: T) -> Option<i128> {
    a.into().checked_mul(b.into())?.checked_add(c.into().checked_mul(d.into())?)
}

integer!(
    i32,
    4,
    |a: i32, b: i32, c: i32, d: i32, divisor: i32, limit: i32| {
        i64::from(a) * i64::from(b) + i64::from(c) * i64::from(d) < i64::from(divisor) * i64::from(limit)
    },
    |a: i32, b: i32, c: i32, d: i32| Some((i64::from(a) * i64::from(b)).cmp(&(i64::from(c) * i64::from(d))))
);
integer!(
    i64,
    5,
    |a: i64, b: i64, c: i64, d: i64, divisor: i64, limit: i64| {
        i128::from(a) * i128::from(b) + i128::from(c) * i128::from(d) < i128::from(divisor) * i128::from(limit)
    },
    |a: i64, b: i64, c: i64, d: i64| Some((i128::from(a) * i128::from(b)).cmp(&(i128::from(c) * i128::from(d))))
);
integer!(i128, 6, |_, _, _, _, _, _| false, |a: i128, b: i128, c: i128, d: i128| Some(
    a.checked_mul(b)?.cmp(&c.checked_mul(d)?)
));

#[cfg(test)]
mod tests {
    use super::Integer;
    use proptest::prelude::{prop_assert, prop_assert_eq, proptest};

    fn divides<T: Integer>() {
        let number = |x| T::narrow(x).unwrap();
        for divisor in [1i128, 2, 3, 12, 1 << 20, 999_999_937, 1 << 29] {
            let prepared = T::divisor(number(divisor));
            // The product with the even part of the divisor must fit.
            let top = ((T::HALF as i128) << 1) >> divisor.trailing_zeros();
            for quotient in [0i128, 1, -1, 7, -123_456_789, (1 << 29) - 1].into_iter().filter(|q| q.abs() < top) {
                let q = T::exact(number(divisor), number(quotient), number(0), number(0), &prepared);
                assert_eq!(q.wide(), quotient, "{divisor}");
                let q = T::checked_exact(number(divisor), number(quotient), number(0), number(0), &prepared);
                assert_eq!(q.map(T::wide), Some(quotient), "{divisor}");
            }
        }
    }

    #[test]
    fn division_is_exact() {
        divides::<i32>();
        divides::<i64>();
        divides::<i128>();
    }

    #[test]
    fn quotients_that_do_not_fit_are_refused() {
        let one = i32::divisor(1);
        assert_eq!(i32::checked_exact(1 << 29, 2, 0, 0, &one), None);
        assert_eq!(i32::checked_exact(1 << 29, 1, 1 << 28, 1, &one), Some((1 << 29) + (1 << 28)));
        // 2^20 = 2^28 / 2^8 is fine, but 2^25 = 2^33 / 2^8 has lost its leading bits.
        let even = i32::divisor(1 << 8);
        assert_eq!(i32::checked_exact(1 << 28, 1, 0, 0, &even), Some(1 << 20));
        assert_eq!(i32::checked_exact(1 << 28, 1 << 5, 0, 0, &even), None);
        assert_eq!(i128::checked_exact(1 << 100, 1 << 30, 0, 0, &i128::divisor(1)), None);
        assert_eq!(i128::compare(1 << 100, 1 << 30, 1, 1), None);
    }

    proptest! {
        /// What passes the quick test is right by wrapping arithmetic and below the limit.
        #[test]
        fn the_quick_test_is_safe(
            a in 0i32..1 << 29, b in -(1i32 << 29)..1 << 29, c in -(1i32 << 29)..1 << 29, divisor in 1i32..1 << 29, limit in 1i32..1 << 30,
            small in 0u32..30,
        ) {
            let (b, c, divisor) = (b >> small, c >> (29 - small), (divisor >> (small / 2)).max(1));
            let prepared = i32::divisor(divisor);
            // A product that the divisor divides.
            let d = divisor;
            let b = b / d * d;
            let exact = (i128::from(a) * i128::from(b) + i128::from(c) * i128::from(d)) / i128::from(divisor);
            if i32::surely_below(a, b.abs(), c.abs(), d, &prepared, limit) {
                prop_assert!(exact.abs() < i128::from(limit));
                prop_assert_eq!(i128::from(i32::exact(a, b, c, d, &prepared)), exact);
                prop_assert_eq!(i32::checked_exact(a, b, c, d, &prepared).map(i128::from), Some(exact).filter(|q| q.abs() < 1 << 30));
            }
        }
    }
}
