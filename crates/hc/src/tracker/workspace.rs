//! The numbers of the paths in the lanes.

use super::kernels::Take;
use crate::linalg::Lu;
use poly::simd::Isa;
use poly::{Evaluate, Lane};

/// A system with memory for its values, Jacobians and derivatives at one point a lane.
pub(super) struct Workspace<'a, E: Evaluate, S: Lane> {
    pub(super) system: &'a E,
    pub(super) isa: Isa,
    pub(super) n: usize,
    /// Index of the path in each lane.
    pub(super) labels: Vec<usize>,
    pub(super) memory: E::Memory<S>,
    /// Taylor coefficients of the paths at their current points, orders 0 to 3.
    pub(super) taylor: Vec<S>,
    /// Taylor coefficients at the point just reached.
    pub(super) taylor_next: Vec<S>,
    pub(super) parameters: Vec<S>,
    /// Where the Jacobian is evaluated.
    pub(super) point: Vec<S>,
    pub(super) corrected: Vec<S>,
    pub(super) values: Vec<S>,
    pub(super) jacobian: Vec<S>,
    pub(super) lu: Lu<S>,
    pub(super) weights_sqr: Vec<S::Real>,
    pub(super) inverse_weights_sqr: Vec<S::Real>,
}

impl<'a, E: Evaluate, S: Lane> Workspace<'a, E, S> {
    /// Memory for a square system.
    pub(super) fn new(system: &'a E, isa: Isa) -> Self {
        let (n, m) = (system.variables(), system.parameters());
        let zeros = |len: usize| vec![S::zero(); len];
        Workspace {
            system,
            isa,
            n,
            labels: vec![0; S::LANES],
            memory: system.memory(isa),
            taylor: zeros(4 * n),
            taylor_next: zeros(4 * n),
            parameters: zeros(4 * m),
            point: zeros(n),
            corrected: zeros(n),
            values: zeros(n),
            jacobian: zeros(n * n),
            lu: Lu::of_jacobian(system, isa),
            weights_sqr: vec![S::real(1.0); n],
            inverse_weights_sqr: vec![S::real(1.0); n],
        }
    }

    /// Completes the Taylor coefficients at the point just reached, which is that of order 0 in `taylor_next`, to order
    /// 3, and makes them those of the current points in the lanes of `accepted`. `lu` factors the Jacobian there;
    /// parameters that move on a straight line have no coefficients of orders 2 and 3.
    pub(super) fn differentiate(&mut self, straight: bool, accepted: u16) {
        let (n, m) = (self.n, self.system.parameters());
        let orders = if straight { 2 } else { 4 };
        for order in 1..=3 {
            let (known, next) = self.taylor_next.split_at_mut(order * n);
            let p = &self.parameters[..orders.min(order + 1) * m];
            self.system.taylor(&mut self.memory, order, known, p, &mut next[..n]);
            self.lu.solve_negated(&mut next[..n]);
        }
        self.isa.run(Take { from: &self.taylor_next, mask: accepted, to: &mut self.taylor });
    }
}
