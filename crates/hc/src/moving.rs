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
            // Lengths that are known when this is compiled need no loop.
            let shifted = match degree {
                1 => shifted(1, &t, coefficient),
                2 => shifted(2, &t, coefficient),
                3 => shifted(3, &t, coefficient),
                degree => shifted(degree as usize, &t, coefficient),
            };
            for (k, shifted) in shifted.into_iter().enumerate() {
                q[k * m + i] = shifted;
            }
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
/// again.
#[inline(always)]
fn shifted<S: Lane>(degree: usize, t: &S, coefficient: impl Fn(usize) -> S) -> [S; 4] {
    let mut b = [S::zero(); 4];
    for step in 0..=degree {
        for j in (1..4).rev().filter(|&j| j <= step) {
            b[j] = if j == step { b[j - 1] } else { S::mul_real_add(&b[j], t, &b[j - 1]) };
        }
        let next = coefficient(degree - step);
        b[0] = if step == 0 { next } else { S::mul_real_add(&b[0], t, &next) };
    }
    b
}

#[cfg(test)]
#[path = "moving_tests.rs"]
mod tests;
