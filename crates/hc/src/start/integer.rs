//! The two sizes of integers in which mixed cells are found.

/// Integers whose products of two entries below [`Integer::LIMIT`], and sums of two such products, never overflow.
pub(super) trait Integer: Copy + Ord + Default + Send + Sync {
    /// Entries of tables stay below this in size.
    const LIMIT: i128;
    /// The number, which is below the limit.
    fn narrow(value: i128) -> Self;
    fn wide(self) -> i128;
    /// `(a * b + c * d) * inverse >> shift`, wrapping.
    fn exact(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>) -> Self;
    /// `sum + a * b`, wrapping; the caller has bounded it.
    fn accumulate(sum: Self, a: Self, b: Self) -> Self;
    fn size(self) -> Self;
    /// Prepares division by `divisor`, which is not zero.
    fn divisor(divisor: Self) -> Divisor<Self>;
}

/// An exact divisor `odd * 2^shift` as the inverse of its odd part modulo the word size (Jebelean 1993).
#[derive(Clone, Copy)]
pub(super) struct Divisor<T> {
    inverse: T,
    shift: u32,
}

macro_rules! integer {
    ($type:ty, $bits:expr, $newton:expr) => {
        impl Integer for $type {
            const LIMIT: i128 = 1 << $bits;

            fn narrow(value: i128) -> Self {
                value as $type
            }

            fn wide(self) -> i128 {
                i128::from(self)
            }

            #[inline(always)]
            fn exact(a: Self, b: Self, c: Self, d: Self, divisor: &Divisor<Self>) -> Self {
                (a.wrapping_mul(b).wrapping_add(c.wrapping_mul(d))).wrapping_mul(divisor.inverse) >> divisor.shift
            }

            #[inline(always)]
            fn accumulate(sum: Self, a: Self, b: Self) -> Self {
                sum.wrapping_add(a.wrapping_mul(b))
            }

            #[inline(always)]
            fn size(self) -> Self {
                self.wrapping_abs()
            }

            fn divisor(divisor: Self) -> Divisor<Self> {
                let shift = divisor.trailing_zeros();
                let odd = divisor >> shift;
                // Right to three bits; each step of Newton's method doubles their number.
                let mut inverse = odd;
                for _ in 0..$newton {
                    inverse = inverse.wrapping_mul((2 as $type).wrapping_sub(odd.wrapping_mul(inverse)));
                }
                Divisor { inverse, shift }
            }
        }
    };
}

integer!(i64, 30, 5);
integer!(i128, 61, 6);

#[cfg(test)]
mod tests {
    use super::Integer;

    fn divides<T: Integer>() {
        for divisor in [1i128, -1, 2, 3, -12, 1 << 20, 999_999_937, -(1 << 30)] {
            let prepared = T::divisor(T::narrow(divisor));
            for quotient in [0i128, 1, -1, 7, -123_456_789, (1 << 31) - 1] {
                let product = T::exact(T::narrow(divisor), T::narrow(quotient), T::narrow(0), T::narrow(0), &prepared);
                assert_eq!(product.wide(), quotient, "{divisor}");
            }
        }
    }

    #[test]
    fn division_is_exact() {
        divides::<i64>();
        divides::<i128>();
    }
}
