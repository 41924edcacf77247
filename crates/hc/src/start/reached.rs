//! The input and output of start systems.

use num_complex::Complex64;

/// Exponent vectors of each equation.
pub(crate) type Supports = [Vec<Vec<i32>>];

/// Solutions of a start system.
#[derive(Default)]
pub(crate) struct StartSolutions {
    /// The numbers of the solutions.
    pub(crate) numbers: Vec<usize>,
    /// The coordinates, one solution after the other.
    pub(crate) points: Vec<Complex64>,
}

impl StartSolutions {
    /// The `k`-th solution.
    pub(crate) fn point(&self, k: usize) -> &[Complex64] {
        let n = self.points.len() / self.numbers.len().max(1);
        &self.points[k * n..(k + 1) * n]
    }
}
