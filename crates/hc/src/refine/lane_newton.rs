//! Newton's method for eight points at a time, with one Jacobian.

use super::refiner::Refiner;
use super::sizes::{measure, size_sqr, weight_sqr};
use crate::linalg::Lu;
use crate::tracker::Precise;
use poly::simd::Isa;
use poly::{Evaluate, Lane, Lanes8, Scalar};

/// Points in lanes with what corrects them, and a [`Refiner`] for those that need more than one Jacobian.
pub(crate) struct LaneNewton<'a, E: Evaluate> {
    pub(crate) system: &'a E,
    pub(crate) refiner: Refiner<'a, E>,
    pub(super) memory: E::Memory<Lanes8>,
    /// What evaluates in double-double, with its parameters.
    pub(crate) precise: Precise<E, Lanes8>,
    pub(super) lu: Lu<Lanes8>,
    pub(crate) x: Vec<Lanes8>,
    pub(crate) p: Vec<Lanes8>,
    /// Values, then corrections.
    pub(super) values: Vec<Lanes8>,
    pub(super) jacobian: Vec<Lanes8>,
    squares: Vec<<Lanes8 as Lane>::Real>,
    next: Vec<Lanes8>,
}

impl<'a, E: Evaluate> LaneNewton<'a, E> {
    /// For a square system.
    pub(crate) fn new(system: &'a E) -> Self {
        let (n, isa) = (system.variables(), Isa::detect());
        let zeros = |count: usize| vec![Lanes8::zero(); count];
        LaneNewton {
            system,
            refiner: Refiner::new(system),
            memory: system.memory(isa),
            precise: Precise::new(system, isa),
            lu: Lu::of_jacobian(system, isa),
            x: zeros(n),
            p: zeros(system.parameters()),
            values: zeros(n),
            jacobian: zeros(n * n),
            squares: vec![Lanes8::real(1.0); n],
            next: zeros(n),
        }
    }

    /// Leaves the values and the factored Jacobian at the points.
    pub(crate) fn factor(&mut self) {
        self.system.jacobian(&mut self.memory, &self.x, &self.p, &mut self.values, &mut self.jacobian);
        measure(&self.x, &mut self.squares, weight_sqr);
        self.lu.factor(&self.jacobian, &self.squares);
    }

    /// Leaves the values at the points, computed in double-double.
    pub(crate) fn evaluate_precisely(&mut self) {
        self.precise.overwrite(self.system, [u16::MAX, 0], [&self.x, &self.x], &mut self.values);
    }

    /// Makes corrections of the values; the squares of their sizes relative to the corrected points, which [`take`](Self::take)
    /// takes.
    pub(crate) fn correct(&mut self) -> <Lanes8 as Lane>::Real {
        self.lu.solve(&mut self.values);
        for ((next, x), dx) in self.next.iter_mut().zip(&self.x).zip(&self.values) {
            *next = Lanes8::sub(x, dx);
        }
        measure(&self.next, &mut self.squares, size_sqr);
        let mut largest = Lanes8::real(0.0);
        for (dx, size) in self.values.iter().zip(&self.squares) {
            for ((largest, dx), size) in largest.as_mut().iter_mut().zip(dx.norm_sqr().as_ref()).zip(size.as_ref()) {
                let relative = dx / size;
                // Once NaN, always NaN.
                *largest = if relative <= *largest || largest.is_nan() { *largest } else { relative };
            }
        }
        largest
    }

    /// Takes the corrected points in these lanes.
    pub(crate) fn take(&mut self, lanes: u16) {
        for (x, next) in self.x.iter_mut().zip(&self.next) {
            *x = Lanes8::select(x, next, lanes);
        }
    }
}
