//! The exponential function, lane by lane.

/// Adding this to a double of less than 2^51 rounds it to an integer, which the lowest bits then hold.
const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
/// ln 2 in two parts: the first has 21 zeros at its end, so that its products with exponents are exact.
const LN_2: [f64; 2] = [f64::from_bits(0x3fe6_2e42_fee0_0000), f64::from_bits(0x3dea_39ef_3579_3c76)];
/// Powers of `e` beyond these are infinite, or too small for all digits of a double.
const RANGE: [f64; 2] = [-708.0, 709.0];
/// Degree of the Taylor polynomial: the next term is below 1e-17 for arguments up to `ln 2 / 2`.
const DEGREE: usize = 13;

/// Replaces every number by its power of `e`, to about one unit in the last place; below -708 zero, above
/// 709 infinity. All machines give the same bits, and loops over lanes become vector instructions.
///
/// ```
/// let mut x = [0.0, 1.0, -1e3];
/// poly::exp(&mut x);
/// assert_eq!([x[0], x[2]], [1.0, 0.0]);
/// assert!((x[1] - std::f64::consts::E).abs() <= 2.0 * f64::EPSILON);
/// ```
#[inline(always)]
pub fn exp(numbers: &mut [f64]) {
    for x in numbers {
        *x = one(*x);
    }
}

/// `2^k e^r` with `x = k ln 2 + r`. Without branches and fused operations.
#[inline(always)]
fn one(x: f64) -> f64 {
    let inside = if x < RANGE[0] { RANGE[0] } else { x };
    let inside = if inside > RANGE[1] { RANGE[1] } else { inside };
    let shifted = inside * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (inside - k * LN_2[0]) - k * LN_2[1];
    let mut sum = INVERSE_FACTORIALS[DEGREE];
    for inverse in INVERSE_FACTORIALS[2..DEGREE].iter().rev() {
        sum = sum * r + inverse;
    }
    // The largest terms last.
    let sum = 1.0 + (r + r * r * sum);
    // k is between -1021 and 1023.
    let power = f64::from_bits((shifted.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(1023)) << 52);
    let value = sum * power;
    let value = if x < RANGE[0] { 0.0 } else { value };
    if x > RANGE[1] { f64::INFINITY } else { value }
}

const INVERSE_FACTORIALS: [f64; DEGREE + 1] = {
    let mut inverses = [1.0; DEGREE + 1];
    let (mut k, mut factorial) = (1, 1.0);
    while k <= DEGREE {
        factorial *= k as f64;
        inverses[k] = 1.0 / factorial;
        k += 1;
    }
    inverses
};

#[cfg(test)]
mod tests {
    use super::exp;
    use crate::simd::{Isa, Kernel};
    use proptest::prelude::*;

    struct Powers<'a>(&'a mut [f64]);

    impl Kernel for Powers<'_> {
        type Output = ();
        const WIDEST: Isa = Isa::Avx512;

        #[inline(always)]
        fn run(self) {
            exp(self.0);
        }
    }

    proptest! {
        #[test]
        fn powers_are_those_of_the_standard_library(x in prop::array::uniform8(-707.0..708.0f64)) {
            let mut powers = x;
            exp(&mut powers);
            for (power, x) in powers.iter().zip(&x) {
                prop_assert!((power - x.exp()).abs() <= 2.0 * f64::EPSILON * x.exp(), "{x}: {power}");
            }
        }

        #[test]
        fn all_instruction_sets_give_the_same_bits(x in prop::array::uniform8(-800.0..800.0f64)) {
            let mut expected = x;
            exp(&mut expected);
            for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
                let mut powers = x;
                isa.run(Powers(&mut powers));
                prop_assert_eq!(powers.map(f64::to_bits), expected.map(f64::to_bits));
            }
        }
    }

    #[test]
    fn limits() {
        let mut x = [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300, -1e300, 1e-300];
        exp(&mut x);
        assert_eq!(x[..4], [1.0, 1.0, f64::INFINITY, 0.0]);
        assert!(x[4].is_nan());
        assert_eq!(x[5..], [f64::INFINITY, 0.0, 1.0]);
    }
}
