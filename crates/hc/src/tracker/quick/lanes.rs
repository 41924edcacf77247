//! Quick steps in lanes: one attempt for all lanes at a time, whatever the others need.
//!
//! An attempt takes the Jacobian at the predicted point and three corrections with it. The first two tell
//! whether the step is accepted and how long the next one is; the third catches what converges to another
//! path. The next step is that for which `omega` times the predictor's error, which grows with the fourth
//! power of the step, is `aim` of the tolerances, within the share of the radius of
//! trust that the options allow. Rows have one order for all, residuals are never extended, and a path that needs
//! more is given up. A lane depends on no other.

use super::super::kernels::{Coefficients, Correct, Predict, Radius, Take, Weigh};
use super::super::options::TrackerOptions;
use super::super::resume::{ResumePoint, ResumePoints};
use super::super::workspace::Workspace;
use super::attempts::{QuickPath, Verdict};
use crate::homotopy::ParameterPath;
use crate::linalg::RowExchanges;
use crate::monitor::Monitor;
use crate::tolerances::QuickTolerances;
use num_complex::Complex64;
use poly::{Evaluate, Lane, Singles16};

/// Memory of quick steps, beside the tracker's own.
pub(in super::super) struct QuickMemory<'a, E: Evaluate> {
    pub(super) singles: Workspace<'a, E, Singles16>,
    pub(super) lanes: Vec<QuickPath>,
    /// Where the paths stopped in single precision.
    pub(super) stops: ResumePoints,
    /// Paths that start again in double precision.
    pub(super) again: Vec<usize>,
}

impl<'a, E: Evaluate> QuickMemory<'a, E> {
    /// For the paths of a square system, with rows exchanged in the workspaces of either precision.
    pub(super) fn new<S: Lane>(doubles: &mut Workspace<'a, E, S>, exchanges: &RowExchanges) -> Self {
        let mut singles = Workspace::new(doubles.system, doubles.isa);
        singles.lu.set_exchanges(exchanges);
        doubles.lu.set_exchanges(exchanges);
        QuickMemory {
            singles,
            lanes: vec![QuickPath::idle(); Singles16::LANES],
            stops: ResumePoints::default(),
            again: Vec::new(),
        }
    }
}

/// The paths that wait for a lane, and what becomes of them.
pub(super) trait Paths<S: Lane> {
    /// The next path, with the point where it goes on.
    fn next(&mut self) -> Option<(ResumePoint, &[Complex64])>;

    /// Takes a path that has arrived, with the smallest pivot of its end, or is given up; lane `l` of `x` is
    /// its last point.
    fn end(&mut self, lane: &QuickPath, pivot: f64, x: &[S], l: usize);
}

/// Quick steps of the paths in lanes.
pub(super) struct QuickLanes<'w, 'a, E: Evaluate, S: Lane> {
    pub(super) work: &'w mut Workspace<'a, E, S>,
    pub(super) lanes: &'w mut [QuickPath],
    pub(super) options: &'w TrackerOptions,
    pub(super) monitor: &'w Monitor,
    pub(super) tolerances: &'static QuickTolerances,
    /// Whether ends are made as accurate as this precision allows.
    pub(super) polishes: bool,
}

impl<E: Evaluate, S: Lane> QuickLanes<'_, '_, E, S> {
    /// Tracks all paths, or those that have begun when the monitor is cancelled.
    pub(super) fn run<P: ParameterPath>(mut self, path: &P, paths: &mut impl Paths<S>) {
        self.lanes.fill(QuickPath::idle());
        // Idle lanes compute too; harmless numbers keep them from slow exceptional arithmetic.
        self.work.taylor.fill(S::zero());
        let mut live = true;
        while live {
            live = false;
            for l in 0..S::LANES {
                if self.lanes[l].path.is_none()
                    && !self.monitor.is_cancelled()
                    && let Some((stop, point)) = paths.next()
                {
                    self.lanes[l] = QuickPath::from(&stop);
                    for (x, z) in self.work.taylor.iter_mut().zip(point) {
                        x.set(l, *z);
                    }
                }
                live |= self.lanes[l].path.is_some();
            }
            if live {
                self.attempt(path);
                self.collect(paths);
            }
        }
    }

    /// One attempt at a step, accepted or not, of every path.
    fn attempt<P: ParameterPath>(&mut self, path: &P) {
        let (n, m) = (self.work.n, self.work.system.parameters());
        let some = self.lanes.iter().find_map(|lane| lane.path).unwrap_or(0);
        let (mut t, mut step, mut radius_sqr) = (S::real(1.0), S::real(0.0), S::real(0.0));
        let mut fresh = 0u16;
        for (l, lane) in self.lanes.iter().enumerate() {
            self.work.labels[l] = lane.path.unwrap_or(some);
            t.as_mut()[l] = lane.t_next;
            step.as_mut()[l] = lane.t_next - lane.t;
            radius_sqr.as_mut()[l] = lane.radius * lane.radius;
            fresh |= u16::from(lane.fresh) << l;
        }
        let work = &mut *self.work;
        work.isa.run(Coefficients { path, labels: &work.labels, t: &t, out: &mut work.parameters });
        work.isa.run(Predict { taylor: &work.taylor, step, radius_sqr, out: &mut work.point });
        if fresh != 0 {
            work.isa.run(Take { from: &work.taylor[..n], mask: fresh, to: &mut work.point });
        }
        work.isa.run(Weigh {
            x: &work.point,
            fresh,
            least_share_sqr: self.options.least_share * self.options.least_share,
            weights_sqr: &mut work.weights_sqr,
            inverse: &mut work.inverse_weights_sqr,
        });
        let p = &work.parameters[..m];
        work.system.jacobian(&mut work.memory, &work.point, p, &mut work.values, work.lu.matrix());
        work.lu.factor_in_order();
        let sizes = [0, 1, 2].map(|k| {
            if k > 0 {
                work.system.values_again(&mut work.memory, &work.point, &work.parameters[..m], &mut work.values);
            }
            work.lu.solve(&mut work.values);
            let size = work.isa.run(Correct {
                x: &work.point,
                dx: &work.values,
                inverse_weights_sqr: &work.inverse_weights_sqr,
                running: u16::MAX,
                out: &mut work.corrected,
            });
            std::mem::swap(&mut work.point, &mut work.corrected);
            size
        });
        let (mut accepted, mut nearer) = (0u16, 0u16);
        for (l, lane) in self.lanes.iter_mut().enumerate().filter(|(_, lane)| lane.path.is_some()) {
            let sizes = [0, 1, 2].map(|k: usize| sizes[k].as_ref()[l].sqrt());
            match lane.judge(sizes, self.tolerances) {
                Verdict::Accepted => accepted |= 1 << l,
                Verdict::Nearer => nearer |= 1 << l,
                Verdict::Rejected => lane.retreat(self.tolerances),
            }
        }
        if nearer != 0 {
            work.isa.run(Take { from: &work.point, mask: nearer, to: &mut work.taylor[..n] });
        }
        if accepted != 0 {
            self.go_on(accepted, path.is_straight());
        }
    }

    /// Takes the paths that have arrived or are given up out of their lanes.
    fn collect(&mut self, paths: &mut impl Paths<S>) {
        let work = &*self.work;
        for (l, lane) in self.lanes.iter_mut().enumerate().filter(|(_, lane)| lane.path.is_some()) {
            let arrived = lane.has_arrived();
            if !(arrived || lane.is_difficult(self.options, self.tolerances)) {
                continue;
            }
            let judged = arrived && self.polishes;
            let pivot =
                if judged { work.lu.smallest_pivot_in_order(l, &work.jacobian, &work.weights_sqr) } else { 0.0 };
            paths.end(lane, pivot, &work.taylor[..work.n], l);
            *lane = QuickPath::idle();
        }
    }

    /// One Newton iteration more for the accepted points at `t = 0`, with the Jacobian there, and the rounding
    /// error that is left.
    fn arrive(&mut self, accepted: u16) {
        let mut arriving = 0u16;
        for (l, lane) in self.lanes.iter().enumerate() {
            arriving |= u16::from(accepted >> l & 1 == 1 && lane.t_next == 0.0) << l;
        }
        if arriving == 0 || !self.polishes {
            return;
        }
        let work = &mut *self.work;
        let (n, m) = (work.n, work.system.parameters());
        // As it was before it was factored, for the smallest pivot.
        let p = &work.parameters[..m];
        work.system.jacobian_again(&mut work.memory, &work.point, p, &mut work.values, &mut work.jacobian);
        work.lu.solve(&mut work.values);
        work.isa.run(Correct {
            x: &work.point,
            dx: &work.values,
            inverse_weights_sqr: &work.inverse_weights_sqr,
            running: arriving,
            out: &mut work.corrected,
        });
        // What another correction finds is rounding error.
        work.system.values_again(&mut work.memory, &work.corrected, &work.parameters[..m], &mut work.values);
        work.lu.solve(&mut work.values);
        let size = work.isa.run(Correct {
            x: &work.corrected,
            dx: &work.values,
            inverse_weights_sqr: &work.inverse_weights_sqr,
            running: arriving,
            out: &mut work.point,
        });
        work.isa.run(Take { from: &work.point, mask: arriving, to: &mut work.taylor[..n] });
        for (l, lane) in self.lanes.iter_mut().enumerate().filter(|(l, _)| arriving >> l & 1 == 1) {
            lane.last = size.as_ref()[l].sqrt();
        }
    }

    /// Derivatives at the accepted points, and with them the next steps.
    fn go_on(&mut self, accepted: u16, straight: bool) {
        let work = &mut *self.work;
        let (n, p) = (work.n, &work.parameters[..work.system.parameters()]);
        work.system.jacobian_again(&mut work.memory, &work.point, p, &mut work.values, work.lu.matrix());
        work.lu.factor_in_order();
        work.taylor_next[..n].copy_from_slice(&work.point);
        work.differentiate(straight, accepted);
        self.arrive(accepted);
        let work = &*self.work;
        let mut omega_sqr = S::real(1.0);
        for (omega_sqr, lane) in omega_sqr.as_mut().iter_mut().zip(self.lanes.iter()) {
            *omega_sqr = lane.omega * lane.omega;
        }
        let (taylor, inverse_weights_sqr) = (&work.taylor, &work.inverse_weights_sqr);
        let radius = work.isa.run(Radius { n, taylor, inverse_weights_sqr, omega_sqr: &omega_sqr });
        for (l, lane) in self.lanes.iter_mut().enumerate().filter(|(l, _)| accepted >> l & 1 == 1) {
            lane.advance(radius.as_ref()[l].sqrt(), self.options, self.tolerances);
        }
    }
}
