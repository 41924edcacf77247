//! What code written by [`emit`](super::emit()) builds on.

use super::registers::Layout;
use super::series::Series;
use super::taylor;
use crate::scalar::Scalar;
use crate::simd::Isa;

pub use super::series;

/// Sizes of a generated system.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Number of parameters.
    pub parameters: usize,
    /// Number of unknowns.
    pub variables: usize,
    /// Constants as real part (high, low) and imaginary part (high, low).
    pub constants: &'static [[f64; 4]],
    /// Values that one function hands to the next.
    pub live: usize,
    /// Taylor series kept: constants, parameters, unknowns and results.
    pub series: usize,
}

/// Scratch space of generated code.
#[derive(Clone, Debug)]
pub struct Memory<S> {
    /// The instruction set that kernels run on.
    pub isa: Isa,
    /// Values that one function hands to the next.
    pub live: Vec<S>,
    /// Taylor series that stay between orders.
    pub series: Vec<Series<S>>,
}

impl<S: Scalar> Memory<S> {
    /// Scratch space for a system of this shape.
    pub fn new(isa: Isa, shape: &Shape) -> Memory<S> {
        let constants: Vec<S> = shape.constants.iter().map(|&[a, b, c, d]| S::from_parts([a, b], [c, d])).collect();
        let live = vec![S::zero(); shape.live];
        Memory { isa, live, series: taylor::resident(&constants, shape.series) }
    }

    /// Puts the inputs of a Taylor call of this order in place.
    ///
    /// # Panics
    /// If the order is not 1, 2 or 3 or a slice is too short.
    pub fn load(&mut self, shape: &Shape, order: usize, x: &[S], p: &[S]) {
        let &Shape { parameters, variables, constants, .. } = shape;
        let layout = Layout { constants: constants.len(), parameters, variables };
        taylor::load(&mut self.series, layout, order, x, p);
    }
}
