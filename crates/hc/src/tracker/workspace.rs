//! The numbers of the paths in the lanes.

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
}
