//! The tracking loop: one path per lane; lanes are refilled as paths end.
//!
//! All lanes share every evaluation, factorisation and vector operation. Decisions are made lane by
//! lane in [`PathProgress`]. A lane that has finished its part of a step is evaluated again at the
//! same point until the other lanes have finished theirs, so that its numbers do not depend on its
//! neighbours. The loop allocates nothing.

use super::kernels::{Coefficients, Distance, Predict, Radius, Take, Weigh};
use super::logarithms::{Exponentials, Logarithms};
use super::options::TrackerOptions;
use super::precise::{Precise, subtract};
use super::progress::{Bounds, PathProgress, StepState, mask};
use super::quick::QuickMemory;
use super::result::{PathEnd, PathResult, PathSet};
use super::resume::{ResumePoint, ResumePoints};
use super::valuation::valuation;
use super::workspace::Workspace;
use crate::homotopy::ParameterPath;
use crate::linalg::RowExchanges;
use crate::monitor::Monitor;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{Evaluate, Lane};

/// Tracks paths of one system, `S::LANES` at a time. It keeps its memory from call to call.
pub struct Tracker<'a, E: Evaluate, S: Lane> {
    pub(super) work: Workspace<'a, E, S>,
    pub(super) bounds: Bounds,
    pub(super) monitor: Monitor,
    pub(super) lanes: Vec<PathProgress>,
    pub(super) predicted: Vec<S>,
    /// The Taylor coefficients for the predictor, where there are coordinates whose logarithms it predicts: in
    /// these lanes.
    pub(super) series: Vec<S>,
    pub(super) masks: Vec<u16>,
    pub(super) logarithmic: u16,
    /// The low parts of the points, of the corrected points, and of those of the last accepted step, for
    /// paths whose points are in double-double; arbitrary for other paths.
    pub(super) point_low: Vec<S>,
    pub(super) corrected_low: Vec<S>,
    pub(super) taylor_low: Vec<S>,
    /// The point from which the closing correction starts.
    pub(super) closing: Vec<S>,
    pub(super) closing_low: Vec<S>,
    /// The correction that residuals of double precision give where better ones are used.
    pub(super) rough: Vec<S>,
    pub(super) precise: Precise<E, S>,
    pub(super) valuations: Vec<f64>,
    /// The rows that quick steps exchange in Jacobians.
    pub(super) exchanges: RowExchanges,
    /// Made when quick steps are first asked for.
    pub(super) quick: Option<Box<QuickMemory<'a, E>>>,
    /// The paths that quick steps leave, and those that cannot go on from there.
    pub(super) left: ResumePoints,
    pub(super) strayed: Vec<usize>,
}

impl<'a, E: Evaluate, S: Lane> Tracker<'a, E, S> {
    /// A tracker for a square system.
    ///
    /// # Panics
    /// If the system does not have as many equations as unknowns.
    pub fn new(system: &'a E, options: &TrackerOptions) -> Self {
        let n = system.variables();
        assert_eq!(system.equations(), n, "paths are tracked for square systems");
        let isa = options.isa.unwrap_or_else(Isa::detect);
        let zeros = || vec![S::zero(); n];
        Tracker {
            work: Workspace::new(system, isa),
            bounds: Bounds::new(options),
            monitor: Monitor::default(),
            lanes: vec![PathProgress::idle(); S::LANES],
            predicted: zeros(),
            series: vec![S::zero(); 4 * n],
            masks: vec![0; n],
            logarithmic: 0,
            point_low: zeros(),
            corrected_low: zeros(),
            taylor_low: zeros(),
            closing: zeros(),
            closing_low: zeros(),
            rough: zeros(),
            precise: Precise::new(system, isa),
            valuations: vec![0.0; n],
            exchanges: RowExchanges::new(),
            quick: None,
            left: ResumePoints::default(),
            strayed: Vec::new(),
        }
    }

    /// Replaces the settings for later paths. For another instruction set all memory is made anew.
    pub fn set_options(&mut self, options: &TrackerOptions) {
        if options.isa.unwrap_or_else(Isa::detect) == self.work.isa {
            self.bounds = Bounds::new(options);
        } else {
            let (monitor, exchanges) = (self.monitor.clone(), std::mem::take(&mut self.exchanges));
            *self = Tracker { monitor, exchanges, ..Tracker::new(self.work.system, options) };
        }
    }

    /// The tracker for paths whose Jacobians have pivots of good size once these rows are exchanged.
    pub(crate) fn exchanging(self, exchanges: RowExchanges) -> Self {
        Tracker { exchanges, ..self }
    }

    /// Sets the monitor that may stop later paths. The default monitor stops nothing.
    pub fn set_monitor(&mut self, monitor: &Monitor) {
        self.monitor.clone_from(monitor);
    }

    /// Tracks the paths with the given indices into `starts` (`n` coordinates per path) along
    /// `path` from `t = 1` to 0, and appends their ends to `out`, in the order in which they end.
    /// Once the monitor is cancelled, paths that have not begun, or wait to go on with more care, are
    /// appended as [`PathEnd::Cancelled`].
    ///
    /// # Panics
    /// If an index lies outside `starts`, or the numbers of parameters of `path` and the system
    /// differ.
    pub fn track<P: ParameterPath>(
        &mut self,
        path: &P,
        starts: &[Complex64],
        which: impl IntoIterator<Item = usize>,
        out: &mut PathSet,
    ) {
        assert_eq!(path.parameters(), self.work.system.parameters(), "parameters of path and system");
        if !self.bounds.options.quick {
            return self.track_carefully(path, starts, which.into_iter().map(ResumePoint::at_start), out);
        }
        let (which, mut left) = (which.into_iter(), std::mem::take(&mut self.left));
        left.clear();
        // Once and for all, so that later calls need no memory.
        let most = which.size_hint().1.unwrap_or(0).min(starts.len() / self.work.n.max(1));
        left.reserve(most, self.work.n);
        self.strayed.reserve(most);
        self.track_quickly(path, starts, which, most, out, &mut left);
        self.track_carefully(path, &left.points, left.list.iter().copied(), out);
        self.left = left;
        let mut strayed = std::mem::take(&mut self.strayed);
        self.track_carefully(path, starts, strayed.drain(..).map(ResumePoint::at_start), out);
        self.strayed = strayed;
    }

    /// Tracks paths from where they go on; `points` has the points there. Those that go on from a point that
    /// is not near the path are left in `strayed`.
    pub(super) fn track_carefully<P: ParameterPath>(
        &mut self,
        path: &P,
        points: &[Complex64],
        mut stops: impl Iterator<Item = ResumePoint>,
        out: &mut PathSet,
    ) {
        let n = self.work.n;
        self.lanes.fill(PathProgress::idle());
        self.logarithmic = 0;
        // Idle lanes compute too; harmless numbers keep them from slow exceptional arithmetic.
        self.work.taylor.fill(S::zero());
        loop {
            for l in 0..S::LANES {
                if !self.lanes[l].is_live() && self.monitor.is_cancelled() {
                    for stop in stops.by_ref() {
                        let record = PathResult { t: stop.t, ..PathResult::cancelled(stop.path) };
                        out.push(record, points[stop.point * n..][..n].iter().copied());
                    }
                } else if !self.lanes[l].is_live()
                    && let Some(stop) = stops.next()
                {
                    self.lanes[l] = PathProgress::from(&stop, path.pieces(stop.path));
                    self.lanes[l].exponential = path.is_exponential(stop.path);
                    for (x, z) in self.work.taylor.iter_mut().zip(&points[stop.point * n..][..n]) {
                        x.set(l, *z);
                    }
                }
            }
            if !self.lanes.iter().any(PathProgress::is_live) {
                return;
            }
            self.step(path, out);
        }
    }

    /// One step, accepted or not, of every live path.
    fn step<P: ParameterPath>(&mut self, path: &P, out: &mut PathSet) {
        self.predict();
        let mut t = S::real(1.0);
        for (t, lane) in t.as_mut().iter_mut().zip(&self.lanes) {
            *t = lane.t_next;
        }
        let some = self.lanes.iter().find(|lane| lane.is_live()).map_or(0, |lane| lane.path);
        self.work
            .labels
            .iter_mut()
            .zip(&self.lanes)
            .for_each(|(label, lane)| *label = if lane.is_live() { lane.path } else { some });
        self.work.isa.run(Coefficients { path, labels: &self.work.labels, t: &t, out: &mut self.work.parameters });
        for (l, lane) in self.lanes.iter().enumerate() {
            if lane.is_live() && lane.extended {
                self.precise.set_parameters(l, path, lane, &self.work.parameters[..self.work.system.parameters()]);
            }
        }
        self.work.point.copy_from_slice(&self.predicted);
        for lane in self.lanes.iter_mut() {
            lane.begin_correction(&self.bounds);
        }
        loop {
            self.correct();
            self.close();
            let unfinished = mask(&self.lanes, |lane| lane.state == StepState::Iterating);
            if unfinished == 0 {
                break;
            }
            self.take_corrected(unfinished);
        }

        let mut accepted = 0u16;
        for l in 0..S::LANES {
            accepted |= u16::from(self.lanes[l].state == StepState::Accepted) << l;
            if let Some(end) = self.lanes[l].retreat(&self.bounds) {
                self.finish(l, end, out);
            }
        }
        if accepted != 0 {
            self.move_on(accepted, path.is_straight());
            for l in (0..S::LANES).filter(|l| accepted >> l & 1 == 1) {
                self.watch_valuations(l);
                if self.lanes[l].begins_piece() {
                    self.record(l, PathEnd::Success, out);
                }
                if let Some(end) = self.lanes[l].finished(&self.bounds) {
                    self.finish(l, end, out);
                }
            }
        }
        for l in 0..S::LANES {
            // Paths that only ever reject must come to an end too.
            if matches!(self.lanes[l].state, StepState::Rejected { .. })
                && let Some(end) = self.lanes[l].finished(&self.bounds)
            {
                self.finish(l, end, out);
            }
        }
    }

    fn predict(&mut self) {
        let (mut step, mut radius_sqr) = (S::real(0.0), S::real(0.0));
        let mut fresh = 0u16;
        for (l, lane) in self.lanes.iter_mut().enumerate() {
            if lane.is_live() {
                lane.choose_step(&self.bounds);
                step.as_mut()[l] = lane.t_next - lane.t;
                radius_sqr.as_mut()[l] = lane.radius * lane.radius;
                fresh |= u16::from(lane.fresh) << l;
            }
        }
        let taylor = if self.logarithmic == 0 { &self.work.taylor } else { &self.series };
        self.work.isa.run(Predict { taylor, step, radius_sqr, out: &mut self.predicted });
        if self.logarithmic != 0 {
            let x = &self.work.taylor[..self.work.n];
            self.work.isa.run(Exponentials { x, masks: &self.masks, predicted: &mut self.predicted });
        }
        if fresh != 0 {
            self.work.isa.run(Take { from: &self.work.taylor[..self.work.n], mask: fresh, to: &mut self.predicted });
        }
        if self.lanes.iter().any(|lane| lane.wide) {
            self.predict_precisely(step, radius_sqr);
        }
        self.work.isa.run(Weigh {
            x: &self.predicted,
            fresh,
            least_share_sqr: self.bounds.least_share_sqr,
            weights_sqr: &mut self.work.weights_sqr,
            inverse: &mut self.work.inverse_weights_sqr,
        });
    }

    /// Predictions from points in double-double, in the lanes that have them.
    fn predict_precisely(&mut self, step: S::Real, radius_sqr: S::Real) {
        let n = self.work.n;
        self.point_low.fill(S::zero());
        // The change of the point is the prediction from zero with the same derivatives.
        let (derivatives, from_point) = (&mut self.work.taylor_next, &mut self.closing);
        derivatives.copy_from_slice(&self.work.taylor);
        derivatives[..n].fill(S::zero());
        self.work.isa.run(Predict { taylor: derivatives, step, radius_sqr, out: from_point });
        for l in (0..S::LANES).filter(|&l| self.lanes[l].wide && self.lanes[l].kept) {
            for z in from_point.iter_mut() {
                z.set(l, -z.get(l));
            }
            let to = [&mut self.predicted[..], &mut self.point_low];
            subtract(l, [&self.work.taylor[..n], &self.taylor_low], from_point, to);
        }
    }

    /// Derivatives at the accepted points, and with them the radius of trust for the next step.
    fn move_on(&mut self, accepted: u16, straight: bool) {
        let n = self.work.n;
        let distance = self.work.isa.run(Distance {
            a: &self.predicted,
            b: &self.work.corrected,
            inverse_weights_sqr: &self.work.inverse_weights_sqr,
        });
        self.work.taylor_next[..n].copy_from_slice(&self.work.corrected);
        self.work.differentiate(straight, accepted);
        for (l, lane) in self.lanes.iter_mut().enumerate().filter(|(l, lane)| accepted >> l & 1 == 1 && lane.wide) {
            for (to, from) in self.taylor_low.iter_mut().zip(&self.corrected_low) {
                to.set(l, from.get(l));
            }
            lane.kept = true;
        }
        let mut omega_sqr = S::real(1.0);
        for (o, lane) in omega_sqr.as_mut().iter_mut().zip(&self.lanes) {
            *o = lane.omega * lane.omega;
        }
        self.logarithmic = mask(&self.lanes, |lane| lane.is_live() && lane.exponential && !lane.wide);
        let mut taylor = &self.work.taylor;
        if self.logarithmic != 0 {
            let (lanes, series, masks) = (self.logarithmic, &mut self.series, &mut self.masks);
            self.work.isa.run(Logarithms { taylor, lanes, series, masks });
            taylor = &self.series;
        }
        let inverse_weights_sqr = &self.work.inverse_weights_sqr;
        let radius = self.work.isa.run(Radius { n, taylor, inverse_weights_sqr, omega_sqr: &omega_sqr });
        for (l, lane) in self.lanes.iter_mut().enumerate() {
            if accepted >> l & 1 == 1 {
                lane.advance(distance.as_ref()[l].sqrt(), radius.as_ref()[l].sqrt());
            }
        }
    }

    /// Near the target: are some valuations `v_j = d log|x_j| / d log t` negative and settled?
    fn watch_valuations(&mut self, l: usize) {
        let t = self.lanes[l].t;
        if t == 0.0 || t > self.bounds.options.endgame_start {
            return;
        }
        let n = self.work.n;
        let mut settled = false;
        for j in 0..n {
            let c = |k: usize| self.work.taylor[k * n + j].get(l);
            let (v, drift) = valuation(t, [c(0), c(1), c(2), c(3)]);
            self.valuations[j] = v;
            settled |= v + drift < -0.05 && drift < 0.01;
        }
        self.lanes[l].watch(settled);
    }

    fn finish(&mut self, l: usize, end: PathEnd, out: &mut PathSet) {
        if end == PathEnd::InvalidStart && self.lanes[l].t < 1.0 {
            self.strayed.push(self.lanes[l].path);
            self.lanes[l] = PathProgress::idle();
            return;
        }
        self.record(l, end, out);
        self.lanes[l] = PathProgress::idle();
    }

    fn record(&self, l: usize, end: PathEnd, out: &mut PathSet) {
        let result = self.lanes[l].result(end, self.work.lu.smallest_pivot(l, &self.work.weights_sqr));
        out.push(result, self.work.taylor[..self.work.n].iter().map(|x| x.get(l)));
    }
}
