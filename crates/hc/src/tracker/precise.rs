//! What ill-conditioned paths need beyond double precision: residuals, parameters and points in
//! double-double. All lanes are evaluated at once, if there is a path in one that needs it.

use super::progress::PathProgress;
use crate::homotopy::ParameterPath;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{ComplexDd, Dd, Evaluate, Lane, Scalar};

/// Residuals in double-double, at points in double or double-double.
pub(crate) struct Precise<E: Evaluate, S: Lane> {
    memory: E::Memory<S::Extended>,
    x: Vec<S::Extended>,
    /// The parameters of all lanes.
    pub(crate) p: Vec<S::Extended>,
    values: Vec<S::Extended>,
    /// The parameters of one lane.
    row: Vec<ComplexDd>,
}

impl<E: Evaluate, S: Lane> Precise<E, S> {
    pub(crate) fn new(system: &E, isa: Isa) -> Self {
        let zeros = |count: usize| vec![S::Extended::zero(); count];
        Precise {
            memory: system.memory(isa),
            x: zeros(system.variables()),
            p: zeros(system.parameters()),
            values: zeros(system.equations()),
            row: vec![ComplexDd::zero(); system.parameters()],
        }
    }

    /// Sets the parameters of lane `l`, which are at `t` of `path`.
    pub(super) fn set_parameters<P: ParameterPath>(&mut self, l: usize, path: &P, lane: &PathProgress, rounded: &[S]) {
        for (d, s) in self.row.iter_mut().zip(rounded) {
            *d = s.get(l).into();
        }
        path.extend(lane.path, lane.t_next, &mut self.row);
        for (p, d) in self.p.iter_mut().zip(&self.row) {
            let [re, im] = d.parts();
            S::set_extended(p, l, re, im);
        }
    }

    /// Overwrites `values` in the first lanes of the mask with residuals at the points `x[0]`, or `x[0] + x[1]` in the
    /// second lanes, those with points in double-double.
    pub(crate) fn overwrite(&mut self, system: &E, [lanes, wide]: [u16; 2], x: [&[S]; 2], values: &mut [S]) {
        if lanes == 0 {
            return;
        }
        for (d, (high, low)) in self.x.iter_mut().zip(x[0].iter().zip(x[1])) {
            *d = S::extended(high, &S::select(&S::zero(), low, wide));
        }
        system.values(&mut self.memory, &self.x, &self.p, &mut self.values);
        for (d, s) in values.iter_mut().zip(&self.values) {
            *d = S::select(d, &S::rounded(s), lanes);
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
