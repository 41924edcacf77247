//! What all equations of a family say of a solution of [combinations](super::overdetermined) of them.

use crate::random::{Random, Stream};
use crate::refine::size;
use crate::tolerances::families;
use num_complex::Complex64;
use poly::{ComplexDd, Evaluate, Isa};

/// Random points at which the size of an equation is measured.
const POINTS: usize = 8;

/// What all equations say of a regular solution of combinations of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// It solves them.
    Solves,
    /// It does not solve the one of this number, from 0.
    Misses(usize),
    /// Its digits do not tell whether it solves the one of this number, from 0.
    Unclear(usize),
}

/// What equations say of a point `x` for parameters `p`, from its digits in double-double.
///
/// Values are relative to the sizes of the equations at points with coordinates of the same sizes. Where all
/// equations are solved they fall with the error of the point, to that of double-double.
pub(super) fn verdict<A: Evaluate>(all: &A, precise: &[ComplexDd], p: &[Complex64], x: &[Complex64]) -> Verdict {
    let zero = Complex64::default();
    let count = all.equations();
    let (mut values, mut precise_values) = (vec![zero; count], vec![ComplexDd::from(zero); count]);
    let precise_p: Vec<ComplexDd> = p.iter().map(|&z| z.into()).collect();
    all.values(&mut all.memory(Isa::Portable), precise, &precise_p, &mut precise_values);
    let mut squares = vec![0.0; count];
    let largest = x.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let (mut random, mut memory) = (Random::of(0, Stream::Sizes), all.memory(Isa::Portable));
    for _ in 0..POINTS {
        let beside: Vec<Complex64> = x.iter().map(|z| random.unit() * size(z.norm(), largest)).collect();
        all.values(&mut memory, &beside, p, &mut values);
        squares.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value.norm_sqr() / POINTS as f64);
    }
    let relative = |(value, square): (&ComplexDd, &f64)| {
        let value = Complex64::from(*value).norm();
        if value == 0.0 { 0.0 } else { value / square.sqrt() }
    };
    let worst = precise_values.iter().zip(&squares).map(relative).enumerate();
    // What is no number is worst.
    let larger = |a: (usize, f64), b: (usize, f64)| if b.1 <= a.1 || a.1.is_nan() { a } else { b };
    match worst.fold((0, 0.0), larger) {
        (_, value) if value <= families::SOLVES => Verdict::Solves,
        (equation, value) if value > families::MISSES => Verdict::Misses(equation),
        (equation, _) => Verdict::Unclear(equation),
    }
}
