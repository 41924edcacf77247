//! The corrector of the tracking loop: Newton's method in all lanes, and the closing correction.

use super::batch::Tracker;
use super::kernels::{Correct, Distance, Take};
use super::precise::subtract;
use super::progress::{PathProgress, StepState, mask};
use poly::{Evaluate, Lane};

impl<E: Evaluate, S: Lane> Tracker<'_, E, S> {
    /// Runs Newton's method until every lane has converged or is rejected.
    pub(super) fn correct(&mut self) {
        loop {
            let m = self.work.system.parameters();
            let p = &self.work.parameters[..m];
            self.work.system.jacobian(
                &mut self.work.memory,
                &self.work.point,
                p,
                &mut self.work.values,
                &mut self.work.jacobian,
            );
            let x = [&self.work.point[..], &self.point_low];
            let wanted = wanted(&self.lanes, StepState::Iterating);
            self.precise.overwrite(self.work.system, wanted, x, &mut self.work.values);
            self.work.lu.factor(&self.work.jacobian, &self.work.weights_sqr);
            self.work.lu.solve(&mut self.work.values);
            // Lanes that have stopped keep their points in `corrected`.
            let running = mask(&self.lanes, |lane| lane.state == StepState::Iterating);
            let norm = self.subtract_values(running, false);
            for (l, lane) in self.lanes.iter_mut().enumerate() {
                lane.judge(norm.as_ref()[l].sqrt(), &self.bounds);
            }
            let again = mask(&self.lanes, |lane| lane.state == StepState::Iterating);
            if again == 0 {
                return;
            }
            self.take_corrected(again);
        }
    }

    /// Subtracts the corrections in `values` from the points where the Jacobian was taken, or from those of
    /// the closing correction. Returns the squares of the sizes of the corrections.
    fn subtract_values(&mut self, running: u16, closing: bool) -> S::Real {
        let (x, low) = if closing { (&self.closing, &self.closing_low) } else { (&self.work.point, &self.point_low) };
        let (dx, out) = (&self.work.values, &mut self.work.corrected);
        let inverse_weights_sqr = &self.work.inverse_weights_sqr;
        let norm = self.work.isa.run(Correct { x, dx, inverse_weights_sqr, running, out });
        for l in (0..S::LANES).filter(|l| running >> l & 1 == 1 && self.lanes[*l].wide) {
            subtract(l, [x, low], dx, [&mut self.work.corrected, &mut self.corrected_low]);
        }
        norm
    }

    /// Makes the corrected points of these lanes the points at which the Jacobian is evaluated.
    pub(super) fn take_corrected(&mut self, mask: u16) {
        self.work.isa.run(Take { from: &self.work.corrected, mask, to: &mut self.work.point });
        if self.lanes.iter().any(|lane| lane.wide) {
            self.work.isa.run(Take { from: &self.corrected_low, mask, to: &mut self.point_low });
        }
    }

    /// One more correction with the last Jacobian, which makes the points accurate and measures their
    /// accuracy.
    pub(super) fn close(&mut self) {
        if !self.lanes.iter().any(|lane| lane.state == StepState::Converged) {
            return;
        }
        let p = &self.work.parameters[..self.work.system.parameters()];
        self.work.system.values_again(&mut self.work.memory, &self.work.corrected, p, &mut self.work.values);
        let extended = wanted(&self.lanes, StepState::Converged);
        let mut rough = S::real(0.0);
        if extended[0] != 0 {
            self.rough.copy_from_slice(&self.work.values);
            self.work.lu.solve(&mut self.rough);
            let x = [&self.work.corrected[..], &self.corrected_low];
            self.precise.overwrite(self.work.system, extended, x, &mut self.work.values);
        }
        self.work.lu.solve(&mut self.work.values);
        if extended[0] != 0 {
            rough = self.work.isa.run(Distance {
                a: &self.rough,
                b: &self.work.values,
                inverse_weights_sqr: &self.work.inverse_weights_sqr,
            });
        }
        // `point` stays where the Jacobian was taken: lanes that are done are evaluated there again
        // if others go on.
        self.closing.copy_from_slice(&self.work.corrected);
        self.closing_low.copy_from_slice(&self.corrected_low);
        let running = mask(&self.lanes, |lane| lane.state == StepState::Converged);
        let norm = self.subtract_values(running, true);
        for (l, lane) in self.lanes.iter_mut().enumerate() {
            let double = lane.extended.then(|| rough.as_ref()[l].sqrt());
            lane.judge_closing(norm.as_ref()[l].sqrt(), double, &self.bounds);
        }
    }
}

/// The lanes in this state that need residuals in double-double, and those of them whose points are kept so too.
fn wanted(lanes: &[PathProgress], state: StepState) -> [u16; 2] {
    let wanted = mask(lanes, |lane| lane.extended && lane.state == state);
    [wanted, wanted & mask(lanes, |lane| lane.wide)]
}
