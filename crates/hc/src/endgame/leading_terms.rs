//! Whether the leading terms of the equations cancel on paths that seem to go to infinity.

use super::walker::Walker;
use crate::homotopy::Segment;
use crate::tolerances::endgame;
use num_complex::Complex64;
use poly::Evaluate;
use poly::simd::Isa;

/// Evaluates equations on paths to infinity.
pub(super) struct LeadingTerms<'a, E: Evaluate> {
    system: &'a E,
    memory: E::Memory<Complex64>,
    parameters: Vec<Complex64>,
    values: Vec<Complex64>,
    jacobian: Vec<Complex64>,
}

impl<'a, E: Evaluate> LeadingTerms<'a, E> {
    /// For a square system.
    pub(super) fn new(system: &'a E) -> LeadingTerms<'a, E> {
        let (n, zero) = (system.variables(), Complex64::default());
        LeadingTerms {
            system,
            memory: system.memory(Isa::Portable),
            parameters: Vec::with_capacity(system.parameters()),
            values: vec![zero; n],
            jacobian: vec![zero; n * n],
        }
    }

    /// Tells paths that have come round a clear loop to infinity whether leading terms cancel there.
    pub(super) fn judge(&mut self, segment: &Segment, walkers: &mut [Walker]) {
        for walker in walkers {
            let Some((s, point)) = walker.claim() else { continue };
            let cancels = self.cancel(segment, (-s).exp(), point);
            walker.judge(cancels);
        }
    }

    /// Whether leading terms cancel at the point of a path at this `t`.
    ///
    /// Parameters are those of the target, but for those that vanish there: in these what is left at `t` leads. On a
    /// path to infinity that hardly changes the values of the equations, relative to their terms; where a parameter is
    /// small but not zero, `t` is still larger, and the path seems to go to infinity without doing so.
    fn cancel(&mut self, segment: &Segment, t: f64, x: &[Complex64]) -> bool {
        let LeadingTerms { system, memory, parameters, values, jacobian } = self;
        let zero = Complex64::default();
        parameters.clear();
        let at = |(&target, direction): (&Complex64, &Complex64)| if target == zero { direction * t } else { target };
        parameters.extend(segment.target().iter().zip(segment.direction()).map(at));
        system.jacobian(memory, x, parameters, values, jacobian);
        let n = x.len();
        let terms = |i: usize| (0..n).map(|j| (jacobian[j * n + i] * x[j]).norm()).sum::<f64>();
        values.iter().enumerate().all(|(i, value)| value.norm() <= endgame::CANCELS * terms(i))
    }
}
