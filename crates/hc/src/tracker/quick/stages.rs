//! The stages of quick steps.

use super::super::batch::Tracker;
use super::super::result::PathSet;
use super::super::resume::{ResumePoint, ResumePoints};
use super::attempts::QuickPath;
use super::lanes::{Paths, QuickLanes, QuickMemory};
use crate::homotopy::ParameterPath;
use crate::tolerances::{QUICK, SINGLES, families, quick_ends};
use num_complex::Complex64;
use poly::{Evaluate, Lane, Singles16};

impl<E: Evaluate, S: Lane> Tracker<'_, E, S> {
    /// Tracks paths as [`track`](Self::track) does, with room for `most` of them. The difficult ones, and those that
    /// have not begun when the monitor is cancelled, go to `left`.
    pub(in super::super) fn track_quickly<P: ParameterPath>(
        &mut self,
        path: &P,
        starts: &[Complex64],
        mut which: impl Iterator<Item = usize>,
        most: usize,
        out: &mut PathSet,
        left: &mut ResumePoints,
    ) {
        let n = self.work.n;
        let (options, monitor) = (&self.bounds.options, &self.monitor);
        let (work, exchanges) = (&mut self.work, &self.exchanges);
        let quick = self.quick.get_or_insert_with(|| Box::new(QuickMemory::new(work, exchanges)));
        let QuickMemory { singles, lanes, stops, again } = &mut **quick;
        stops.clear();
        again.clear();
        stops.reserve(most, n);
        again.reserve(most);

        let first = QuickLanes { work: singles, lanes, options, monitor, tolerances: &SINGLES, polishes: false };
        first.run(path, &mut Begin { n, starts, which: &mut which, stops, path, left });
        // The longest first, so that lanes do not wait for them at the end.
        stops.list.sort_unstable_by(|a, b| b.t.total_cmp(&a.t).then(a.path.cmp(&b.path)));

        let lanes = &mut lanes[..S::LANES];
        let second = QuickLanes { work, lanes, options, monitor, tolerances: &QUICK, polishes: true };
        let (waiting, points) = (stops.list.iter(), &stops.points[..]);
        let mut finish = Finish { n, starts, waiting, points, again, out, left };
        second.run(path, &mut finish);

        let Finish { waiting, again, left, .. } = finish;
        for k in which.chain(waiting.map(|stop| stop.path)).chain(again.drain(..)) {
            left.push(ResumePoint::at_start(k), start(starts, n, k).iter().copied());
        }
    }
}

fn start(starts: &[Complex64], n: usize, path: usize) -> &[Complex64] {
    &starts[path * n..][..n]
}

/// The paths from their starts, as far as single precision takes them.
struct Begin<'q, P, I> {
    n: usize,
    starts: &'q [Complex64],
    which: &'q mut I,
    stops: &'q mut ResumePoints,
    path: &'q P,
    left: &'q mut ResumePoints,
}

impl<P: ParameterPath, I: Iterator<Item = usize>> Paths<Singles16> for Begin<'_, P, I> {
    fn next(&mut self) -> Option<(ResumePoint, &[Complex64])> {
        let path = loop {
            let path = self.which.next()?;
            if self.path.pieces(path) <= 1 {
                break path;
            }
            // Quick steps know nothing of pieces.
            self.left.push(ResumePoint::at_start(path), start(self.starts, self.n, path).iter().copied());
        };
        Some((ResumePoint::at_start(path), start(self.starts, self.n, path)))
    }

    fn end(&mut self, lane: &QuickPath, _: f64, x: &[Singles16], l: usize) {
        let stop = lane.stop();
        if stop.t < 1.0 {
            self.stops.push(stop, x.iter().map(|x| x.get(l)));
        } else {
            // With all digits.
            self.stops.push(stop, start(self.starts, self.n, stop.path).iter().copied());
        }
    }
}

/// The paths from where they stopped, or from their starts, to their ends.
struct Finish<'q> {
    n: usize,
    starts: &'q [Complex64],
    waiting: std::slice::Iter<'q, ResumePoint>,
    points: &'q [Complex64],
    again: &'q mut Vec<usize>,
    out: &'q mut PathSet,
    left: &'q mut ResumePoints,
}

impl<S: Lane> Paths<S> for Finish<'_> {
    fn next(&mut self) -> Option<(ResumePoint, &[Complex64])> {
        if let Some(path) = self.again.pop() {
            return Some((ResumePoint::at_start(path), start(self.starts, self.n, path)));
        }
        let stop = *self.waiting.next()?;
        Some((stop, &self.points[stop.point * self.n..][..self.n]))
    }

    fn end(&mut self, lane: &QuickPath, pivot: f64, x: &[S], l: usize) {
        let stop = lane.stop();
        if lane.has_arrived() && pivot > quick_ends::PIVOT && lane.last < noise(x, l) {
            self.out.push(lane.arrived(pivot), x.iter().map(|x| x.get(l)));
        } else if lane.strayed() {
            self.again.push(stop.path);
        } else if lane.has_arrived() || stop.t == 1.0 {
            self.left.push(ResumePoint::at_start(stop.path), start(self.starts, self.n, stop.path).iter().copied());
        } else {
            self.left.push(stop, x.iter().map(|x| x.get(l)));
        }
    }
}

/// How large the last correction of an end may be.
fn noise<S: Lane>(x: &[S], l: usize) -> f64 {
    let sizes = || x.iter().map(|x| x.get(l).norm_sqr());
    let largest = sizes().fold(0.0, f64::max);
    let vanishes = sizes().any(|size| size <= families::VANISHED_SQR * largest);
    if vanishes { quick_ends::VANISHING_NOISE } else { quick_ends::NOISE }
}
