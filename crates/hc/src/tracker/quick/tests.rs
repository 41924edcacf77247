//! Tests of quick steps.

use crate::family::{Fibre, FibreOptions, FibreTracker, OneChart};
use crate::homotopy::{ParameterPath, Segment};
use crate::monitor::Monitor;
use crate::tracker::resume::{Counts, ResumePoint};
use crate::tracker::{PathEnd, PathSet, Tracker, TrackerOptions};
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{Evaluate, Interpreter, Lane, Lanes8, parse};

fn quick() -> TrackerOptions {
    TrackerOptions { quick: true, ..TrackerOptions::fast() }
}

/// The parameters `a` and `b` of the start solutions.
const START: [f64; 2] = [1.0, 0.0];

/// The system `x^12 = a`, `y = x^2 + b`, and all its solutions at the start.
fn roots() -> (Interpreter, Vec<Complex64>) {
    let text =
        "name = 'roots'\nunknowns = ['x', 'y']\nparameters = ['a', 'b']\nequations = ['x^12 - a', 'y - x^2 - b']";
    let system = parse::family(text).expect("a family").system.compile().expect("a program");
    let starts = (0..12)
        .map(|k| Complex64::from_polar(1.0, f64::from(k) * std::f64::consts::TAU / 12.0))
        .flat_map(|x| [x, x * x])
        .collect();
    (system, starts)
}

/// The ends of all its paths from the start to these parameters, in order.
fn ends<S: Lane>(target: [Complex64; 2], options: &TrackerOptions, monitor: &Monitor) -> PathSet {
    let (system, starts) = roots();
    let path = Segment::new(&START.map(Complex64::from), &target);
    let mut out = PathSet::new(system.variables());
    let mut tracker = Tracker::<_, S>::new(&system, options);
    tracker.set_monitor(monitor);
    tracker.track(&path, &starts, 0..12, &mut out);
    out.sort();
    out
}

#[test]
fn all_roots_alone_and_among_others_to_the_same_bits() {
    let (a, b) = (Complex64::new(-3.0, 4.0), Complex64::new(0.5, -2.0));
    let eight = ends::<Lanes8>([a, b], &quick(), &Monitor::default());
    assert_eq!(eight.len(), 12);
    for (result, x) in eight.iter() {
        assert_eq!(result.end, PathEnd::Success, "{result:?}");
        assert!((x[0].powi(12) - a).norm() < 1e-12 && (x[1] - x[0] * x[0] - b).norm() < 1e-14, "{x:?}");
        assert!(result.accuracy < 1e-8 && result.pivot > 1e-3, "{result:?}");
        // Quick steps did it: they take two Jacobians each, two at the start solution, and two where the path
        // goes on in double precision.
        assert_eq!(result.jacobians, 4 + 2 * result.accepted + result.rejected, "{result:?}");
    }
    // Twelve roots, none twice.
    let near = |k: usize, j: usize| (eight.point(k)[0] - eight.point(j)[0]).norm() < 1e-3;
    assert!((0..12).all(|k| (0..k).all(|j| !near(k, j))));
    assert_eq!(eight, ends::<Complex64>([a, b], &quick(), &Monitor::default()));
    // The same ends as with all care.
    let careful = ends::<Lanes8>([a, b], &TrackerOptions::fast(), &Monitor::default());
    for k in 0..12 {
        assert!((eight.point(k)[0] - careful.point(k)[0]).norm() < 1e-6, "path {k}");
    }
}

/// The third equation knows nothing of the second unknown, and at solutions the derivative of the first by the
/// first vanishes, `2 (x - z)`: quick steps need the rows in another order.
#[test]
fn rows_are_put_in_an_order_with_pivots() {
    let text = "name = 'order'\nunknowns = ['x', 'y', 'z']\nparameters = ['a', 'b']\n\
                equations = ['(x - z)^2 + y - b', 'x^12 - a', 'x - z']";
    let program = parse::family(text).expect("a family").system.compile().expect("a program");
    let root = |k: u32| Complex64::from_polar(1.0, f64::from(k) * std::f64::consts::TAU / 12.0);
    let solutions = (0..12).flat_map(|k| [root(k), Complex64::from(0.0), root(k)]).collect();
    let fibre = Fibre::new(START.map(Complex64::from).to_vec(), 3, solutions);
    let options = FibreOptions { tracker: quick(), ..FibreOptions::default() };
    let target = [Complex64::new(-3.0, 4.0), Complex64::new(0.5, -2.0)];
    let mut tracker = FibreTracker::new(&program, OneChart, &fibre);
    let counts = tracker.track(&fibre, &target, &options);
    assert_eq!((counts.finite, counts.retracked), (12, 0));
    for (result, x) in tracker.paths().iter() {
        assert!((x[0].powi(12) - target[0]).norm() < 1e-12 && (x[1] - target[1]).norm() < 1e-12, "{x:?}");
        // As above: quick steps alone.
        assert_eq!(result.jacobians, 4 + 2 * result.accepted + result.rejected, "{result:?}");
    }
}

#[test]
fn what_single_precision_does_not_resolve_goes_on_in_double_precision() {
    // Half way `a` is 5e-8 i, which single precision does not tell from zero, where all roots meet.
    let (system, starts) = roots();
    let path = Segment::new(&START.map(Complex64::from), &[Complex64::new(-1.0, 1e-7), Complex64::from(0.0)]);
    let track = |options: &TrackerOptions| {
        let (mut tracker, mut out) = (Tracker::<_, Lanes8>::new(&system, options), PathSet::new(2));
        tracker.track(&path, &starts, 0..12, &mut out);
        out.sort();
        (out, tracker.quick.map_or_else(Vec::new, |quick| quick.stops.list))
    };
    let ((quick, stops), (careful, _)) = (track(&quick()), track(&TrackerOptions::fast()));
    assert!(stops.len() == 12 && stops.iter().all(|stop| stop.t > 0.4 && stop.t < 1.0), "{stops:?}");
    assert_eq!((quick.len(), quick.count(PathEnd::Success)), (12, 12));
    for ((k, (result, x)), (_, y)) in quick.iter().enumerate().zip(careful.iter()) {
        assert!((x[0] - y[0]).norm() < 1e-8, "path {k}: {x:?} {y:?}");
        assert!(!result.extended, "{result:?}");
    }
}

#[test]
fn what_is_singular_is_left_to_the_careful_tracker() {
    // All roots meet at zero.
    let target = [0.0, 1.0].map(Complex64::from);
    let quick = ends::<Lanes8>(target, &quick(), &Monitor::default());
    assert_eq!((quick.len(), quick.count(PathEnd::Success)), (12, 0));
    // It went on where quick steps stopped, towards x = 0, y = 1.
    for (result, x) in quick.iter() {
        assert!(result.t < 1e-4 && x[0].norm() < 1e-4_f64.powf(1.0 / 12.0), "{result:?} {x:?}");
        assert!((x[0].powi(12) - result.t).norm() < 1e-6 * result.t, "{result:?} {x:?}");
    }
    assert_eq!(quick, ends::<Complex64>(target, &self::quick(), &Monitor::default()));
}

#[test]
fn careful_paths_go_on_from_near_the_path_alone() {
    let text = "name = 'root'\nunknowns = ['x']\nparameters = ['a']\nequations = ['x^2 - a']";
    let system = parse::family(text).expect("a family").system.compile().expect("a program");
    let path = Segment::new(&[Complex64::from(1.0)], &[Complex64::new(2.0, 1.0)]);
    let counts = Counts { accepted: 5, rejected: 1, jacobians: 11 };
    let stops = [(0, 0.5), (1, 0.25)].map(|(k, t)| ResumePoint { path: k, t, point: k, counts });
    // The root at t = 1/2, and a point far from both roots at t = 1/4.
    let points = [Complex64::new(1.5, 0.5).sqrt(), Complex64::new(0.0, 1e3)];
    let mut tracker = Tracker::<_, Lanes8>::new(&system, &TrackerOptions::fast());
    let mut out = PathSet::new(1);
    tracker.track_carefully(&path, &points, stops.into_iter(), &mut out);
    assert_eq!(tracker.strayed, [1]);
    let [result] = out.results() else { panic!("{out:?}") };
    assert_eq!((result.path, result.end), (0, PathEnd::Success));
    assert!((out.point(0)[0] - Complex64::new(2.0, 1.0).sqrt()).norm() < 1e-9);
    assert!(result.accepted > 5 && result.jacobians > 11 && result.rejected == 1, "{result:?}");
}

/// A segment in four pieces.
struct Pieces(Segment);

impl ParameterPath for Pieces {
    fn parameters(&self) -> usize {
        self.0.parameters()
    }

    fn pieces(&self, _: usize) -> usize {
        4
    }

    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]) {
        self.0.coefficients(paths, t, p);
    }
}

#[test]
fn paths_are_recorded_at_the_ends_of_their_pieces() {
    let (system, starts) = roots();
    let path = Pieces(Segment::new(&START.map(Complex64::from), &[3.0, 1.0].map(Complex64::from)));
    for options in [TrackerOptions::fast(), quick()] {
        let (mut tracker, mut out) = (Tracker::<_, Lanes8>::new(&system, &options), PathSet::new(2));
        tracker.track(&path, &starts, 0..12, &mut out);
        out.sort();
        assert_eq!((out.len(), out.count(PathEnd::Success)), (48, 48));
        for (k, (result, x)) in out.iter().enumerate() {
            assert_eq!((result.path, result.t), (k / 4, [0.75, 0.5, 0.25, 0.0][k % 4]));
            // `a` is positive everywhere: the root keeps its angle.
            let root = starts[2 * result.path] * (3.0 - 2.0 * result.t).powf(1.0 / 12.0);
            assert!((x[0] - root).norm() < 1e-6, "{result:?} {x:?}");
        }
    }
}

#[test]
fn paths_that_have_not_begun_are_cancelled() {
    let monitor = Monitor::watched();
    monitor.cancel();
    let ends = ends::<Lanes8>([2.0, 1.0].map(Complex64::from), &quick(), &monitor);
    assert_eq!((ends.len(), ends.count(PathEnd::Cancelled)), (12, 12));
}

#[test]
fn a_start_that_is_no_solution_is_found_out() {
    let system = parse::family("name = 'root'\nunknowns = ['x']\nparameters = ['a']\nequations = ['x^2 - a']");
    let system = system.expect("a family").system.compile().expect("a program");
    let path = Segment::new(&[Complex64::from(1.0)], &[Complex64::new(2.0, 1.0)]);
    let mut out = PathSet::new(1);
    Tracker::<_, Lanes8>::new(&system, &quick()).track(&path, &[Complex64::from(1.7)], [0], &mut out);
    assert_eq!(out.results()[0].end, PathEnd::InvalidStart);
}

#[test]
fn the_instruction_set_can_be_changed() {
    let (system, starts) = roots();
    let path = Segment::new(&START.map(Complex64::from), &[Complex64::from(2.0), Complex64::from(1.0)]);
    let mut tracker = Tracker::<_, Lanes8>::new(&system, &quick());
    let mut outs = [Isa::Portable, Isa::Avx2.within_machine(), Isa::detect()].map(|isa| {
        tracker.set_options(&TrackerOptions { isa: Some(isa), ..quick() });
        assert_eq!(tracker.work.isa, isa);
        let mut out = PathSet::new(2);
        tracker.track(&path, &starts, 0..12, &mut out);
        out
    });
    outs.iter_mut().for_each(PathSet::sort);
    let points = |out: &PathSet| (0..12).map(|k| out.point(k).to_vec()).collect::<Vec<_>>();
    assert_eq!(points(&outs[0]), points(&outs[1]));
    assert_eq!(points(&outs[0]), points(&outs[2]));
}
