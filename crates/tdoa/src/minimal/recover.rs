//! What becomes of paths that fail, jump or take too many steps.
//!
//! They are tracked again in the other charts, where a path near a far transmitter or a degenerate triangle is an easy one, then with
//! shorter and more steps in all of them. By default a path that has broken off goes on in the next chart from where it is; every
//! second round all start again from the beginning, since what a path has come to may be wrong. Degenerate networks have roots that are
//! singular, which no path reaches however short its steps: rounds end once a long one brings back hardly any of many lost paths.

use super::formulation::Formulation;
use super::options::Fallback;
use hc::distinct::Coincidences;
use hc::fibre::{Fibre, FibreOptions, doubtful_into, ends_regularly, settle};
use hc::homotopy::{ParameterPath, Segment};
use hc::poly::{ComplexDd, Lane, Lanes8, Scalar};
use hc::refine::{Refined, Refiner};
use hc::tracker::{PathEnd, PathResult, PathSet, Tracker, TrackerOptions};
use num_complex::Complex64;

/// Accuracy to which the end of a path carried back from another chart must be known.
const CARRIED: f64 = 1e-8;

/// More lost paths than this tell of a degenerate network rather than of bad luck.
pub(super) const BAD_LUCK: usize = 4;

/// Of so many lost paths a round of more than [`LONG`] steps in all brings back one at least, or there is no other round; of fewer it may
/// bring back none.
const WORTHWHILE: usize = 8;
const LONG: usize = 100_000;

/// Scratch space; keeps its memory from call to call.
pub(super) struct Again<F: Formulation> {
    refiner: Refiner<'static, F::System>,
    refined: Refined,
    coincidences: Coincidences,
    lost: Vec<usize>,
    from: Vec<f64>,
    carried: Vec<Complex64>,
    paths: PathSet,
    segment: Segment,
}

impl<F: Formulation> Again<F> {
    /// With room for all paths of a fibre.
    pub(super) fn new(fibre: &Fibre) -> Self {
        let (paths, dimension) = (fibre.len(), fibre.dimension);
        Again {
            refiner: Refiner::new(F::system()),
            refined: Refined { point: Vec::with_capacity(dimension), ..Refined::default() },
            coincidences: Coincidences::with_capacity(paths),
            // A path may be lost and share its end.
            lost: Vec::with_capacity(2 * paths),
            from: Vec::with_capacity(paths),
            carried: Vec::with_capacity(paths * dimension),
            paths: PathSet::with_capacity(dimension, paths),
            segment: Segment::new(&fibre.parameters, &fibre.parameters),
        }
    }
}

/// The rest of a segment, for each path from where it goes on: the tracker's time `1` is `t = from` there.
struct Rests<'a> {
    segment: &'a Segment,
    from: &'a [f64],
}

impl ParameterPath for Rests<'_> {
    fn parameters(&self) -> usize {
        self.segment.parameters()
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]) {
        let mut from = S::real(1.0);
        from.as_mut().iter_mut().zip(paths).for_each(|(from, &path)| *from = self.from[path]);
        let t = S::real_mul(t, &from);
        let (target, direction) = (self.segment.target(), self.segment.direction());
        let m = target.len();
        for i in 0..m {
            let direction = S::from_c64(direction[i]);
            p[i] = S::add(&S::from_c64(target[i]), &direction.scale_by(&t));
            p[m + i] = direction.scale_by(&from);
        }
        p[2 * m..4 * m].fill(S::zero());
    }

    fn extend(&self, path: usize, t: f64, p: &mut [ComplexDd]) {
        let [t, from] = [t, self.from[path]].map(|t| ComplexDd::new(t.into()));
        self.segment.extended(&Scalar::mul(&t, &from), p);
    }

    fn is_straight(&self) -> bool {
        true
    }
}

/// The steps of a round: shorter ones, and so many more that a path gets farther with them.
fn stricter(settings: &TrackerOptions, level: u32) -> TrackerOptions {
    if level == 0 {
        return settings.clone();
    }
    let mut stricter = settings.stricter(level);
    stricter.max_steps = settings.max_steps.saturating_mul(1 << (2 * level).min(20));
    stricter
}

/// Tracks all paths from one fibre to the parameters `target`, each until it is accounted for or everything has been tried.
pub(super) struct Recovery<'a, F: Formulation> {
    pub(super) start: &'a Fibre,
    /// The way from there in the chart of the data.
    pub(super) segment: &'a Segment,
    pub(super) target: &'a [Complex64],
    pub(super) settings: &'a FibreOptions,
    pub(super) fallback: Fallback,
    pub(super) tracker: &'a mut Tracker<'static, F::System, Lanes8>,
    pub(super) paths: &'a mut PathSet,
    pub(super) again: &'a mut Again<F>,
}

impl<F: Formulation> Recovery<'_, F> {
    /// Returns how many paths are lost, and how many were tracked again. `first_pass_done` says that `paths` already holds the first
    /// pass, unsettled.
    pub(super) fn run(mut self, first_pass_done: bool) -> (usize, usize) {
        if !first_pass_done {
            self.tracker.set_options(&self.settings.tracker);
            self.paths.clear(self.start.dimension);
            self.tracker.track(self.segment, &self.start.solutions, 0..self.start.len(), self.paths);
            self.paths.sort();
        }
        settle(&mut self.again.refiner, self.target, self.paths);
        self.find_lost();
        let mut retracked = 0;
        let charts = if self.fallback == Fallback::OneChart { 1 } else { F::CHARTS };
        for level in 0..=self.settings.retries {
            let (before, steps_before) = (self.again.lost.len(), self.steps());
            self.tracker.set_options(&stricter(&self.settings.tracker, level));
            for chart in usize::from(level == 0)..charts {
                if self.again.lost.is_empty() {
                    return (0, retracked);
                }
                retracked += self.again.lost.len();
                let goes_on = self.fallback == Fallback::OtherCharts && chart > 0 && level % 2 == 0;
                self.track_again(chart, goes_on);
                self.find_lost();
            }
            let lost = self.again.lost.len();
            let hopeless = lost > BAD_LUCK && lost > before - before / WORTHWHILE;
            if level > 0 && hopeless && self.steps().saturating_sub(steps_before) > LONG {
                break;
            }
        }
        (self.again.lost.len(), retracked)
    }

    /// Steps of all paths so far.
    fn steps(&self) -> usize {
        self.paths.results().iter().map(|r| r.accepted + r.rejected).sum()
    }

    fn find_lost(&mut self) {
        let Again { coincidences, lost, .. } = &mut *self.again;
        doubtful_into(self.paths, self.settings.coincidence, coincidences, lost);
    }

    /// Tracks the lost paths again in a chart, from the start or, if they go on, from where they broke off.
    fn track_again(&mut self, chart: usize, goes_on: bool) {
        let Again { refiner, refined, lost, from, carried, paths: again, segment, .. } = &mut *self.again;
        segment.join(&F::parameters(chart, &self.start.parameters), &F::parameters(chart, self.target));
        let broken_off = |r: &PathResult| {
            matches!(r.end, PathEnd::MaxSteps | PathEnd::StepTooSmall | PathEnd::AccuracyLimit) && r.t > 0.0
        };
        from.clear();
        from.extend(lost.iter().map(|&k| {
            let result = &self.paths.results()[k];
            if goes_on && broken_off(result) { result.t } else { 1.0 }
        }));
        carried.clear();
        for (&k, &from) in lost.iter().zip(&*from) {
            let point = if from < 1.0 { self.paths.point(k) } else { self.start.solution(k) };
            carried.extend(F::enter(chart, point));
        }
        again.clear(self.start.dimension);
        self.tracker.track(&Rests { segment, from }, carried, 0..lost.len(), again);
        for (result, point) in again.iter() {
            let k = lost[result.path];
            let old = self.paths.results()[k];
            let record = PathResult {
                path: k,
                t: result.t * from[result.path],
                accepted: old.accepted + result.accepted,
                rejected: old.rejected + result.rejected,
                jacobians: old.jacobians + result.jacobians,
                ..*result
            };
            let back = F::leave(chart, point);
            match result.end {
                PathEnd::Success if ends_regularly(refiner, segment.target(), result, point) => {
                    refiner.refine_into(self.target, &back, refined);
                    if refined.accuracy < CARRIED {
                        self.paths.replace(k, record, &refined.point);
                        continue;
                    }
                }
                PathEnd::Dropped => {
                    self.paths.replace(k, record, &back);
                    continue;
                }
                _ if broken_off(&record) && back.iter().all(|z| z.is_finite()) => {
                    self.paths.replace(k, record, &back);
                    continue;
                }
                _ => {}
            }
            // As it was, but for the work.
            let PathResult { accepted, rejected, jacobians, .. } = record;
            self.paths.replace_record(k, PathResult { accepted, rejected, jacobians, ..old });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Rests;
    use hc::homotopy::{ParameterPath, Segment};
    use num_complex::Complex64;

    #[test]
    fn the_rest_of_a_segment_is_on_the_segment() {
        let z = Complex64::new;
        let segment = Segment::new(&[z(1.0, 2.0), z(0.0, 1.0)], &[z(-0.5, 0.3), z(4.0, 0.0)]);
        let rests = Rests { segment: &segment, from: &[1.0, 0.25] };
        let (mut whole, mut rest) = ([z(0.0, 0.0); 8], [z(0.0, 0.0); 8]);
        segment.coefficients::<Complex64>(&[0], &[0.2], &mut whole);
        rests.coefficients::<Complex64>(&[0], &[0.2], &mut rest);
        assert_eq!(whole, rest);
        // Path 1 is at t = 0.2 when four fifths of its way are left.
        rests.coefficients::<Complex64>(&[1], &[0.8], &mut rest);
        for i in 0..2 {
            assert!((whole[i] - rest[i]).norm() < 1e-15);
            assert!((whole[2 + i] * 0.25 - rest[2 + i]).norm() < 1e-15);
        }
        // To twice the digits: the same to a rounding error, and both ways to the same digits, since 0.25 t is exact.
        let mut extended = [[hc::poly::ComplexDd::default(); 2]; 2];
        rests.extend(1, 0.8, &mut extended[0]);
        segment.extend(0, 0.25 * 0.8, &mut extended[1]);
        assert_eq!(extended[0], extended[1]);
        assert!(extended[0].iter().zip(&rest).all(|(e, r)| (e.high() - r).norm() < 1e-15 && e.low().norm() < 1e-15));
    }
}
