//! How the corrections of a point go, and what they tell.

use super::refined::Refined;
use crate::tolerances::refinement;

/// How the corrections of a point went.
#[derive(Clone, Copy)]
pub(super) struct Polished {
    /// The relative size of the last correction.
    pub(super) accuracy: f64,
    /// Whether a correction that was no rounding error led to one a thousand times smaller, or the first
    /// one was tiny: near a solution of multiplicity `k` at a distance `d` it would be `d / k`, and a row of
    /// the Jacobian about `d` or less, which is faint.
    steady: bool,
    /// The relative distance from where the Jacobian was factored.
    pub(super) moved: f64,
}

impl Polished {
    /// Before the first correction.
    pub(super) const BEGUN: Polished = Polished { accuracy: f64::INFINITY, steady: false, moved: 0.0 };

    /// Takes a correction of this size with a Jacobian that `serves` again, or is that of the point. False if corrections
    /// no longer shrink.
    pub(super) fn shrinks(&mut self, size: f64, serves: bool) -> bool {
        let accuracy = self.accuracy;
        if !(size <= f64::EPSILON || size < if serves { refinement::STEADY * accuracy } else { accuracy }) {
            return false;
        }
        let shrunk = accuracy.is_finite() && accuracy > refinement::TINY && size <= refinement::STEADY * accuracy;
        self.steady |= shrunk || (accuracy.is_infinite() && size <= refinement::TINY);
        self.accuracy = size;
        self.moved += size;
        true
    }

    /// Whether the last Jacobian, from where the point was before, serves to judge it.
    pub(super) fn serves(&self) -> bool {
        self.steady && self.accuracy <= refinement::NEAR
    }

    /// Whether the Jacobian has hardly changed since, which has this condition. Near a set of solutions that is no
    /// point, it becomes singular within a step. Written so that NaN is far.
    pub(super) fn is_unmoved(&self, condition: f64) -> bool {
        condition * self.moved <= refinement::UNMOVED
    }

    /// Tells what was found, with residual, condition and smallest row.
    pub(super) fn tell(&self, (residual, condition, smallest_row): (f64, f64, f64), refined: &mut Refined) {
        refined.plain = self.steady
            && self.accuracy <= refinement::TINY
            && condition <= refinement::GOOD_CONDITION
            && smallest_row > refinement::FAINT;
        (refined.accuracy, refined.residual, refined.condition) = (self.accuracy, residual, condition);
    }
}
