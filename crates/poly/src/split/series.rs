//! Polynomials in one variable, cut off above a degree, as numbers over which a program runs.

use super::pieces::MOST_DEGREE;
use crate::evaluate::Evaluate;
use crate::program::Interpreter;
use crate::scalar::Scalar;
use crate::simd::Isa;
use num_complex::Complex64;

/// The coefficients of orders `0 .. N` of a power series in `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truncated<const N: usize>(pub(super) [Complex64; N]);

impl<const N: usize> Scalar for Truncated<N> {
    fn zero() -> Self {
        Truncated([Complex64::new(0.0, 0.0); N])
    }
    fn one() -> Self {
        Self::from_c64(Complex64::new(1.0, 0.0))
    }
    fn from_c64(z: Complex64) -> Self {
        let mut series = Self::zero();
        series.0[0] = z;
        series
    }
    fn add(a: &Self, b: &Self) -> Self {
        Truncated(std::array::from_fn(|k| a.0[k] + b.0[k]))
    }
    fn sub(a: &Self, b: &Self) -> Self {
        Truncated(std::array::from_fn(|k| a.0[k] - b.0[k]))
    }
    fn mul(a: &Self, b: &Self) -> Self {
        Truncated(std::array::from_fn(|k| (0..=k).map(|j| a.0[j] * b.0[k - j]).sum()))
    }
    fn div(a: &Self, b: &Self) -> Self {
        let mut quotient = Self::zero();
        for k in 0..N {
            let known: Complex64 = (0..k).map(|j| quotient.0[j] * b.0[k - j]).sum();
            quotient.0[k] = (a.0[k] - known) / b.0[0];
        }
        quotient
    }
    fn mul_real(a: &Self, r: &Self) -> Self {
        Truncated(a.0.map(|c| c * r.0[0].re))
    }
}

/// The coefficients, up to `degree`, of the equations of a system without unknowns, whose parameters are
/// `origin + t direction`, order after order.
pub(super) fn coefficients(
    system: &Interpreter,
    degree: u32,
    origin: &[Complex64],
    direction: &[Complex64],
    out: &mut Vec<Complex64>,
) {
    // As few lengths as will do, because each is compiled.
    match degree {
        0 | 1 => run::<2>(system, degree, origin, direction, out),
        2 => run::<3>(system, degree, origin, direction, out),
        3 => run::<4>(system, degree, origin, direction, out),
        4 => run::<5>(system, degree, origin, direction, out),
        _ => run::<{ MOST_DEGREE as usize + 1 }>(system, degree, origin, direction, out),
    }
}

fn run<const N: usize>(
    system: &Interpreter,
    degree: u32,
    origin: &[Complex64],
    direction: &[Complex64],
    out: &mut Vec<Complex64>,
) {
    let line = |(&a, &b): (&Complex64, &Complex64)| {
        let mut series = Truncated::<N>::from_c64(a);
        series.0[1] = b;
        series
    };
    assert_eq!([origin.len(), direction.len()], [system.parameters(); 2], "one number for each parameter");
    let p: Vec<Truncated<N>> = origin.iter().zip(direction).map(line).collect();
    let mut values = vec![Truncated::<N>::zero(); system.equations()];
    system.values(&mut system.memory(Isa::Portable), &[], &p, &mut values);
    out.clear();
    for k in 0..=degree as usize {
        out.extend(values.iter().map(|series| series.0[k]));
    }
}
