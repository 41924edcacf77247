//! Paths of a family along which only what contains unknowns is evaluated.
//!
//! The [parts](Split) of a family that know no unknowns are polynomials in `t` along a segment of its parameters.
//! Their coefficients are computed once for a target, around `t = 0`, where they are as accurate as the
//! values of the parts at the target. Where double precision is not enough, the parts are evaluated anew from the
//! parameters in double-double; ends are judged by the family itself.

use crate::homotopy::{ParameterPath, Segment};
use crate::linalg::exchanges_at;
use crate::tracker::Trackers;
use num_complex::Complex64;
use poly::program::InterpreterMemory;
use poly::simd::Isa;
use poly::{ComplexDd, Evaluate, Interpreter, Lane, Scalar, Split};
use std::sync::{Mutex, PoisonError};

/// Trackers of a split family.
pub(crate) struct MovingTrackers<'a> {
    split: &'a Split,
    trackers: Trackers<'a, Interpreter>,
}

impl<'a> MovingTrackers<'a> {
    /// Trackers for paths from these solutions (`n` coordinates each) for the parameters `p`.
    pub(crate) fn new(split: &'a Split, p: &[Complex64], solutions: &[Complex64]) -> Self {
        let parts = split.parts();
        let mut q = vec![Complex64::default(); parts.equations()];
        parts.values(&mut parts.memory(Isa::Portable), &[], p, &mut q);
        let exchanges = exchanges_at(split.system(), &q, solutions);
        MovingTrackers { split, trackers: Trackers::exchanging(split.system(), exchanges) }
    }

    pub(crate) fn trackers(&self) -> &Trackers<'a, Interpreter> {
        &self.trackers
    }

    /// The path of the parts along a segment of the parameters.
    pub(crate) fn along(&self, segment: Segment) -> MovingParts<'a> {
        let mut coefficients = Vec::new();
        self.split.along(segment.target(), segment.direction(), &mut coefficients);
        let parts = self.split.parts();
        let p = vec![ComplexDd::zero(); parts.parameters()];
        let precise = Mutex::new((parts.memory(Isa::Portable), p));
        MovingParts { split: self.split, segment, coefficients, precise }
    }
}

/// The parts of a family along a segment of its parameters.
pub(crate) struct MovingParts<'a> {
    split: &'a Split,
    segment: Segment,
    /// Coefficient `k` of part `i` at `k * len + i`.
    coefficients: Vec<Complex64>,
    /// Memory for the parts, and their parameters, in double-double.
    precise: Mutex<(InterpreterMemory<ComplexDd>, Vec<ComplexDd>)>,
}

impl ParameterPath for MovingParts<'_> {
    fn parameters(&self) -> usize {
        self.split.degrees().len()
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, _: &[usize], t: &S::Real, q: &mut [S]) {
        let degrees = self.split.degrees();
        let m = degrees.len();
        let t = S::one().scale_by(t);
        for (i, &degree) in degrees.iter().enumerate() {
            let coefficient = |k: usize| S::from_c64(self.coefficients[k * m + i]);
            let [b0, b1, b2, b3] = shifted(degree as usize, &t, coefficient);
            (q[i], q[m + i], q[2 * m + i], q[3 * m + i]) = (b0, b1, b2, b3);
        }
    }

    fn extend(&self, _: usize, t: f64, q: &mut [ComplexDd]) {
        let (memory, p) = &mut *self.precise.lock().unwrap_or_else(PoisonError::into_inner);
        self.segment.extended(&ComplexDd::new(t.into()), p);
        self.split.parts().values(memory, &[], p, q);
    }

    fn is_straight(&self) -> bool {
        self.split.degrees().iter().all(|&degree| degree <= 1)
    }
}

/// The Taylor coefficients of orders 0 to 3 at the real `t` of a polynomial of this degree: Horner's scheme, again and
/// again. Written out for the first steps, so that low degrees need no loop over places in memory.
#[inline(always)]
fn shifted<S: Lane>(degree: usize, t: &S, coefficient: impl Fn(usize) -> S) -> [S; 4] {
    let zero = S::zero();
    let on = |b: &S, a: &S| S::mul_real_add(b, t, a);
    let b0 = coefficient(degree);
    if degree == 0 {
        return [b0, zero, zero, zero];
    }
    let [b0, b1] = [on(&b0, &coefficient(degree - 1)), b0];
    if degree == 1 {
        return [b0, b1, zero, zero];
    }
    let [b0, b1, b2] = [on(&b0, &coefficient(degree - 2)), on(&b1, &b0), b1];
    if degree == 2 {
        return [b0, b1, b2, zero];
    }
    let [mut b0, mut b1, mut b2, mut b3] = [on(&b0, &coefficient(degree - 3)), on(&b1, &b0), on(&b2, &b1), b2];
    for k in (0..degree - 3).rev() {
        [b0, b1, b2, b3] = [on(&b0, &coefficient(k)), on(&b1, &b0), on(&b2, &b1), on(&b3, &b2)];
    }
    [b0, b1, b2, b3]
}

#[cfg(test)]
#[path = "moving_tests.rs"]
mod tests;
