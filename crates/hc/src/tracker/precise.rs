//! What ill-conditioned paths need beyond double precision, one lane at a time: residuals,
//! parameters and points in double-double.

use super::progress::PathProgress;
use crate::homotopy::ParameterPath;
use num_complex::Complex64;
use poly::Dd;
use poly::simd::Isa;
use poly::{ComplexDd, Evaluate, Lane, Scalar};

/// Residuals in double-double for single paths, at points in double or double-double.
pub(super) struct Precise<E: Evaluate> {
    memory: E::Memory<ComplexDd>,
    x: Vec<ComplexDd>,
    /// Parameters of all lanes, one lane after the other.
    p: Vec<ComplexDd>,
    values: Vec<ComplexDd>,
}

impl<E: Evaluate> Precise<E> {
    pub(super) fn new(system: &E, isa: Isa, lanes: usize) -> Self {
        let zero = ComplexDd::from(Complex64::new(0.0, 0.0));
        Precise {
            memory: system.memory(isa),
            x: vec![zero; system.variables()],
            p: vec![zero; lanes * system.parameters()],
            values: vec![zero; system.equations()],
        }
    }

    /// Sets the parameters of lane `l`, which are at `t` of `path`.
    pub(super) fn set_parameters<S: Lane, P: ParameterPath>(
        &mut self,
        l: usize,
        path: &P,
        lane: &PathProgress,
        rounded: &[S],
    ) {
        let m = path.parameters();
        let p = &mut self.p[l * m..(l + 1) * m];
        for (d, s) in p.iter_mut().zip(rounded) {
            *d = s.get(l).into();
        }
        path.extend(lane.path, lane.t_next, p);
    }

    /// Overwrites lane `l` of `values` with residuals at the point `x`, or `x + low` where the lane
    /// is wide.
    pub(super) fn overwrite<S: Lane>(&mut self, system: &E, l: usize, wide: bool, x: [&[S]; 2], values: &mut [S]) {
        let m = system.parameters();
        for (d, (high, low)) in self.x.iter_mut().zip(x[0].iter().zip(x[1])) {
            *d = if wide { joined(high.get(l), low.get(l)) } else { high.get(l).into() };
        }
        system.values(&mut self.memory, &self.x, &self.p[l * m..(l + 1) * m], &mut self.values);
        for (d, s) in values.iter_mut().zip(&self.values) {
            d.set(l, Complex64::from(*s));
        }
    }
}

/// A double-double from a double and its low part.
fn joined(high: Complex64, low: Complex64) -> ComplexDd {
    ComplexDd { re: Dd { high: high.re, low: low.re }, im: Dd { high: high.im, low: low.im } }
}

/// Subtracts the corrections `dx` from the points `x`, which are doubles with low parts, in lane `l`.
pub(super) fn subtract<S: Lane>(l: usize, x: [&[S]; 2], dx: &[S], to: [&mut [S]; 2]) {
    let [high, low] = to;
    for (j, dx) in dx.iter().enumerate() {
        let next = ComplexDd::sub(&joined(x[0][j].get(l), x[1][j].get(l)), &dx.get(l).into());
        high[j].set(l, next.high());
        low[j].set(l, next.low());
    }
}
