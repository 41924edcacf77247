//! The images of points under the maps of a symmetry.

use num_complex::Complex64;
use poly::{Evaluate, Isa};

/// Maps of the unknowns, with memory for the images of a point: the coordinates of all images, one map after the other,
/// are the equations.
pub(super) struct Images<'a, S: Evaluate> {
    maps: &'a S,
    memory: S::Memory<Complex64>,
    all: Vec<Complex64>,
}

impl<'a, S: Evaluate> Images<'a, S> {
    pub(super) fn new(maps: &'a S) -> Self {
        Images { maps, memory: maps.memory(Isa::Portable), all: vec![Complex64::default(); maps.equations()] }
    }

    /// The images of `x` for the parameters `p`, one after the other.
    pub(super) fn of(&mut self, p: &[Complex64], x: &[Complex64]) -> &[Complex64] {
        self.maps.values(&mut self.memory, x, p, &mut self.all);
        &self.all
    }
}
