//! The tracker and what is built on it, on families whose solutions are known.

use hc::distinct::relative_distance;
use hc::family::{Limit, Stopped, TargetLimits, track_fibre};
use hc::homotopy::Segment;
use hc::poly::{Interpreter, Isa, Lane, Lanes8, parse};
use hc::random::Random;
use hc::refine::Refiner;
use hc::tracker::{PathEnd, PathSet, Tracker, TrackerOptions, track};
use hc::{Family, Fibre, FibreOptions, Monitor, MonodromyOptions, Solutions, SolveOptions, Warning};
use num_complex::Complex64;

fn family(unknowns: &str, parameters: &str, equations: &str) -> (Family, Interpreter) {
    let list = |names: &str, separator: char| {
        names.split(separator).map(|n| format!("{:?}", n.trim())).collect::<Vec<_>>().join(", ")
    };
    let text = format!(
        "name = \"test\"\nunknowns = [{}]\nparameters = [{}]\nequations = [{}]",
        list(unknowns, ' '),
        list(parameters, ' '),
        list(equations, ';')
    );
    let family = Family::new(parse::family(&text).unwrap()).unwrap();
    let system = family.program().clone();
    (family, system)
}

fn reals(values: &[f64]) -> Vec<Complex64> {
    values.iter().map(|&v| v.into()).collect()
}

/// Three distances from three angles at a camera: 8 solutions (Grunert 1841; the eight come in
/// pairs of opposite sign).
fn p3p() -> (Family, Interpreter) {
    family(
        "d1 d2 d3",
        "g12 g13 g23 D12 D13 D23",
        "d1^2 + d2^2 - 2*g12*d1*d2 - D12; d1^2 + d3^2 - 2*g13*d1*d3 - D13; d2^2 + d3^2 - 2*g23*d2*d3 - D23",
    )
}

fn p3p_fibre() -> (Family, Interpreter, Fibre) {
    let (family, system) = p3p();
    let found = family.monodromy(&MonodromyOptions::new().roots(8)).unwrap();
    assert_eq!((found.stopped, found.fibre.len()), (Stopped::RootsReached, 8));
    (family, system, found.fibre)
}

/// `x (x - a) = 0`, `y = x + b`, where `x` must not vanish: one solution.
#[test]
fn an_end_outside_the_family_is_no_solution() {
    let text = "name = 'f'\nunknowns = ['x', 'y']\nparameters = ['a', 'b']\nequations = ['x*(x - a)', 'y - x - b']";
    let family: Family = format!("{text}\nnonzero = ['x']").parse().unwrap();
    let start = reals(&[1.0, 2.0]);
    // The second solution has x = 0.
    let fibre = |solutions: &[f64]| Fibre::new(start.clone(), 2, reals(solutions));
    let targets = [[3.0, -1.0], [1e-11, 1e-11], [-5.0, 4.0]];
    let (own, both) = (fibre(&[1.0, 3.0]), fibre(&[1.0, 3.0, 0.0, 2.0]));
    for (fibre, lost) in [(&own, 0), (&both, 1)] {
        let found = family.track(fibre, &targets).run().unwrap();
        for (found, [a, b]) in found.iter().zip(targets) {
            let [solution] = &found.solutions[..] else { panic!("{found:?}") };
            let expected = reals(&[a, a + b]);
            assert!(relative_distance(&solution.value, &expected) < 1e-12, "{solution:?}");
            assert_eq!((found.paths.finite, found.paths.failed), (1, lost), "{:?}", found.paths);
        }
    }
    // Nothing is known of factors that are not stated.
    let family: Family = text.parse().unwrap();
    let found = family.track(&both, &targets).run().unwrap();
    assert!(found.iter().all(|found| (found.len(), found.paths.failed) == (2, 0)));
}

#[test]
fn one_path_in_few_steps() {
    // From (1, 1) for (a, b) = (1, 0) to (sqrt 2, -sqrt 2) for (2, 4); HomotopyContinuation.jl
    // asserts at most 5 steps.
    let (_, system) = family("x y", "a b", "x^2 - a; x*y - a + b");
    let path = Segment::new(&reals(&[1.0, 0.0]), &reals(&[2.0, 4.0]));
    let ends = track(&system, &path, &reals(&[1.0, 1.0]), &[0], &TrackerOptions::default());
    let (result, point) = (&ends.results()[0], ends.point(0));
    assert_eq!(result.end, PathEnd::Success);
    let root = std::f64::consts::SQRT_2;
    assert!((point[0] - root).norm() < 1e-14 && (point[1] + root).norm() < 1e-14, "{point:?}");
    assert!(result.accepted <= 5, "{result:?}");
}

#[test]
fn a_coordinate_that_stays_zero_is_no_obstacle() {
    // y (x - y) for the parameter x: the paths y = 0 and y = x (HomotopyContinuation.jl issue 647
    // lost the first).
    let (_, system) = family("y", "x", "y*(x - y)");
    let start = Complex64::new(0.3, -1.2);
    let path = Segment::new(&[start], &reals(&[5.0]));
    let ends = track(&system, &path, &[Complex64::new(0.0, 0.0), start], &[0, 1], &TrackerOptions::default());
    assert_eq!(ends.count(PathEnd::Success), 2);
    assert!(ends.point(0)[0].norm() < 1e-14 && (ends.point(1)[0] - 5.0).norm() < 1e-13);
}

#[test]
fn a_point_that_is_no_solution_is_refused() {
    let (_, system) = family("x y", "a b", "x^2 - a; x*y - a + b");
    let path = Segment::new(&reals(&[1.0, 0.0]), &reals(&[2.0, 4.0]));
    for start in [[100.0, -100.0], [0.0, 0.0], [f64::NAN, 1.0]] {
        let ends = track(&system, &path, &reals(&start), &[0], &TrackerOptions::default());
        assert_eq!(ends.results()[0].end, PathEnd::InvalidStart, "{start:?}");
    }
}

#[test]
fn a_start_without_direction_is_refused() {
    // Two bars in one line, a rigid framework whose Jacobian has rank one: a solution, but no path
    // begins there.
    let (_, system) = family("x y", "a b", "x^2 + y^2 - a; (x - 2)^2 + y^2 - b");
    let path = Segment::new(&reals(&[1.0, 1.0]), &reals(&[2.0, 3.0]));
    let ends = track(&system, &path, &reals(&[1.0, 0.0]), &[0], &TrackerOptions::default());
    assert_eq!(ends.results()[0].end, PathEnd::InvalidStart);
}

#[test]
fn a_singular_component_is_no_end_of_a_fibre() {
    // x = 0 solves both equations whatever y is, twice; the root of the fibre is (p, q). Next to
    // that line every correction is tiny.
    let (_, system) = family("x y", "p q", "x^2*(x - p); x*(y - q)");
    let fibre = Fibre::new(reals(&[1.0, 2.0]), 2, reals(&[1.0, 2.0, 1e-20, 2.0]));
    let (paths, counts) =
        track_fibre(&system, &fibre, &reals(&[3.0, 2.0]), &FibreOptions::default(), &Monitor::default());
    assert_eq!((counts.finite, counts.failed), (1, 1));
    assert!((paths.point(0)[0] - 3.0).norm() < 1e-14 && paths.results()[0].pivot > 0.1, "{paths:?}");
    assert_ne!(paths.results()[1].end, PathEnd::Success);
}

#[test]
fn a_regular_solution_beyond_doubles_is_told_from_a_singular_one() {
    // Linear, with the solution (p - q, q) and a determinant of e: with e = 1e-16 the Jacobian is
    // singular in doubles, the solution is not.
    let (_, system) = family("x y", "p q e", "x + y - p; x + y + e*y - p - e*q");
    let mut refiner = Refiner::new(&system);
    let solution = reals(&[0.5, 1.5]);
    for (e, doubles, twice) in [(1.0, true, true), (1e-16, false, true), (0.0, false, false)] {
        let p = reals(&[2.0, 1.5, e]);
        assert_eq!(
            (refiner.contracts(&p, &solution), refiner.contracts_precisely(&p, &solution)),
            (doubles, twice),
            "{e}"
        );
    }
    // A double solution, and one that is no solution at all.
    let (_, system) = family("x y", "p", "(x - p)^2; x*y - p");
    let mut refiner = Refiner::new(&system);
    for x in [[2.0, 1.0], [2.0 + 1e-9, 1.0], [3.0, 1.0]] {
        assert!(!refiner.contracts_precisely(&reals(&[2.0]), &reals(&x)), "{x:?}");
    }
}

#[test]
fn points_to_twice_the_digits_tell_paths_apart() {
    // x = 1 + s sqrt(a) and x = 1 - s sqrt(a), y = sqrt(a): the paths are 2 s sqrt(a) apart.
    // Rounding a point to doubles moves y by the rounding error over s, which holds up the steps
    // from there.
    let (_, system) = family("x y", "a s", "(x - 1)^2 - s*s*a; y - (x - 1)/s");
    for (from, to) in [(1e-10, 1e-10), (1e-12, 1e-12), (1e-6, 1e-11), (1e-6, 1e-12), (1e-6, 1e-13), (1e-6, 1e-14)] {
        let path = Segment::new(&reals(&[1.0, from]), &reals(&[4.0, to]));
        let starts = [reals(&[1.0 + from, 1.0]), reals(&[1.0 - from, -1.0])].concat();
        let ends = track(&system, &path, &starts, &[0, 1], &TrackerOptions::default());
        for ((result, point), y) in ends.iter().zip([2.0, -2.0]) {
            assert_eq!(result.end, PathEnd::Success, "{from:e} to {to:e}: {result:?}");
            assert!((point[0] - (1.0 + to * y)).norm() <= f64::EPSILON, "{from:e} to {to:e}: {point:?}");
            assert!((point[1] - y).norm() < 1e-5, "{from:e} to {to:e}: {point:?}");
        }
    }
}

#[test]
fn parameters_to_twice_the_digits_keep_ill_conditioned_paths_smooth() {
    // With d = 3 a all the way the path is x = sqrt(a), y = b; the rounding errors of a and d move
    // y by c times as much, about 1e-3.
    let (_, system) = family("x y", "a b c d", "x^2 - a; c*(3*x^2 - d) + (y - b)");
    let at = |a: f64, b: f64| reals(&[a, b, 1e13, 3.0 * a]);
    let path = Segment::new(&at(1.0, 0.1), &at(2.25, 0.7));
    let ends = track(&system, &path, &reals(&[1.0, 0.1]), &[0], &TrackerOptions::default());
    let (result, point) = (&ends.results()[0], ends.point(0));
    assert_eq!(result.end, PathEnd::Success, "{result:?}");
    assert!((point[0] - 1.5).norm() < 1e-14 && (point[1] - 0.7).norm() < 1e-14, "{point:?}");
    assert!(result.extended && result.accepted < 30, "{result:?}");
}

#[test]
fn paths_to_infinity_and_to_singular_ends_are_told_apart() {
    // a x^2 - 2 x + b, b = 1: as a -> 0 one root goes to 1/2, the other to infinity like 2/a.
    let (_, system) = family("x", "a b", "a*x^2 - 2*x + b");
    let start = reals(&[1.0, -3.0]);
    let path = Segment::new(&start, &reals(&[0.0, 1.0]));
    let ends = track(&system, &path, &reals(&[3.0, -1.0]), &[0, 1], &TrackerOptions::default());
    let mut kinds: Vec<PathEnd> = ends.results().iter().map(|r| r.end).collect();
    kinds.sort_by_key(|k| *k != PathEnd::Success);
    assert_eq!(kinds, [PathEnd::Success, PathEnd::AtInfinity]);
    // To a = b = 1, where both roots meet at x = 1.
    let path = Segment::new(&start, &reals(&[1.0, 1.0]));
    let ends = track(&system, &path, &reals(&[3.0, -1.0]), &[0, 1], &TrackerOptions::default());
    for (result, point) in ends.iter() {
        assert!(!result.end.is_good(), "{result:?}");
        assert!((point[0] - 1.0).norm() < 1e-5, "{point:?}");
    }
}

#[test]
fn alone_and_in_lanes_on_any_instruction_set_the_same_bits() {
    let (_, system, fibre) = p3p_fibre();
    let target = Random::new(5, 0).normals(6);
    let path = Segment::new(&fibre.parameters, &target);
    let run = |options: &TrackerOptions| {
        let mut out = PathSet::new(3);
        Tracker::<_, Lanes8>::new(&system, options).track(&path, &fibre.solutions, 0..8, &mut out);
        sorted(&out)
    };
    let mut options = TrackerOptions::default();
    let widest = run(&options);
    for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512].into_iter().filter(|isa| isa.available()) {
        options.isa = Some(isa);
        assert_eq!(run(&options), widest, "{isa:?}");
    }
    let mut alone = PathSet::new(3);
    Tracker::<_, Complex64>::new(&system, &options).track(&path, &fibre.solutions, 0..8, &mut alone);
    assert_eq!(Complex64::LANES, 1);
    assert_eq!(sorted(&alone), widest);
}

#[test]
fn any_number_of_threads_the_same_bits() {
    let (_, system, fibre) = p3p_fibre();
    // The same eight start solutions many times, so that there is something to share out.
    let starts: Vec<Complex64> = (0..40).flat_map(|_| fibre.solutions.clone()).collect();
    let which: Vec<usize> = (0..320).collect();
    let path = Segment::new(&fibre.parameters, &Random::new(6, 0).normals(6));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| track(&system, &path, &starts, &which, &TrackerOptions::default()))
    };
    let one = run(1);
    assert!(one.results().iter().map(|r| r.path).eq(0..320));
    assert_eq!(run(2), one);
    assert_eq!(run(5), one);
}

fn sorted(set: &PathSet) -> Vec<(usize, String)> {
    let mut all: Vec<_> = set.iter().map(|(r, x)| (r.path, format!("{r:?} {x:?}"))).collect();
    all.sort();
    all
}

#[test]
fn the_whole_fibre_reaches_a_hundred_targets() {
    let (_, system, fibre) = p3p_fibre();
    for seed in 0..100 {
        let target = Random::new(seed, 1).normals(6);
        let (_, counts) = track_fibre(&system, &fibre, &target, &FibreOptions::default(), &Monitor::default());
        assert_eq!((counts.tracked, counts.finite, counts.failed), (8, 8, 0), "seed {seed}");
    }
}

#[test]
fn jumped_paths_are_found_and_mended() {
    // Steps as long as nothing but Newton's first corrections forbids, over many targets: some
    // paths must land on a neighbour.
    let (_, system, fibre) = p3p_fibre();
    let mut reckless = FibreOptions::default();
    reckless.tracker.beta_omega = 0.1;
    reckless.tracker.beta_tau = 50.0;
    reckless.tracker.beta_tau_last = 50.0;
    reckless.tracker.contraction = 0.9;
    reckless.tracker.corrector_tolerance = 1e-2;
    reckless.retries = 0;
    let mut jumped = 0;
    for seed in 0..200 {
        let target = Random::new(seed, 2).normals(6);
        reckless.retries = 0;
        let (_, counts) = track_fibre(&system, &fibre, &target, &reckless, &Monitor::default());
        if counts.failed > 0 {
            jumped += 1;
            reckless.retries = 12;
            let (_, counts) = track_fibre(&system, &fibre, &target, &reckless, &Monitor::default());
            assert_eq!((counts.finite, counts.failed), (8, 0), "seed {seed}: {counts:?}");
            assert!(counts.retracked > 0);
        }
    }
    assert!(jumped > 0, "the settings are meant to make paths jump");
}

#[test]
fn the_trace_test_tells_a_whole_fibre_from_one_with_a_hole() {
    let (family, _, fibre) = p3p_fibre();
    let options = MonodromyOptions::default();
    let test = family.trace_test(&fibre, &options).unwrap();
    assert!(test.passed(8), "{test:?}");
    // The further points are found from the fibre, and with them the missing one: the count gives
    // it away.
    let mut hole = fibre.clone();
    hole.solutions.truncate(7 * 3);
    let test = family.trace_test(&hole, &options).unwrap();
    assert!(!test.passed(7), "{test:?}");
}

#[test]
fn monodromy_without_a_known_count_says_why_it_stopped() {
    let (family, _) = family("x y", "r a b", "x^2 + y^2 - r; y - a*x - b");
    let start = family.find_pair(3).unwrap();
    let cases = [
        (true, false, Stopped::Trace),
        (false, false, Stopped::StartSystem),
        (true, true, Stopped::ComponentWhole),
        (false, true, Stopped::NoProgress),
    ];
    for (trace_test, only_component, stopped) in cases {
        let options = MonodromyOptions::new().trace_test(trace_test).only_component(only_component);
        let found = family.complete(&start, &options).unwrap();
        assert_eq!((found.stopped, found.fibre.len(), found.trace.is_some()), (stopped, 2, trace_test));
        assert_eq!(found.stopped.is_complete(), !only_component);
        assert_eq!(found.start_file().stopped, stopped.to_string());
    }
}

/// Branch points far from one: a = 16 and -16; a = 2 and -2, where the loops have to part; lengths
/// in millimetres.
#[test]
fn monodromy_finds_branch_points_at_any_scale() {
    let cases = [
        ("x", "a", "x^3 - 12*x - a", 3),
        ("x y", "a", "x^2 + y^2 - a; x*y - 1", 4),
        ("x", "a", "x^2 - 1000000*a", 2),
        ("x y", "a b r", "(x - a)^2 + (y - b)^2 - r^2; x^2 + y^2 - 1000000", 2),
        ("x", "a", "x^2 - a + 1/1000000", 2),
    ];
    for (unknowns, parameters, equations, roots) in cases {
        let (family, _) = family(unknowns, parameters, equations);
        let mut whole = 0;
        for seed in 0..20 {
            let options = MonodromyOptions::new().seed(seed);
            let found = family.complete(&family.find_pair(seed).unwrap(), &options).unwrap();
            // Never more than there are, and never fewer that are said to be all.
            let (count, is_complete) = (found.fibre.len(), found.stopped.is_complete());
            assert!(count == roots || count < roots && !is_complete, "{equations} {seed}: {count} {:?}", found.trace);
            whole += usize::from(count == roots && is_complete);
        }
        assert!(whole >= 18, "{equations}: all found {whole} times");
    }
}

#[test]
fn paths_of_a_part_of_a_fibre_take_no_quick_steps() {
    let (_, system, whole) = p3p_fibre();
    let target = Random::new(0, 1).normals(6);
    let ends = |is_partial: bool, quick: bool| {
        let mut options = FibreOptions::default();
        options.tracker.quick = quick;
        track_fibre(&system, &Fibre { is_partial, ..whole.clone() }, &target, &options, &Monitor::default()).0
    };
    assert_eq!(ends(true, true), ends(true, false));
    assert_ne!(ends(false, true), ends(false, false));
}

#[test]
fn detours_find_what_a_path_has_lost() {
    // So few steps that some paths fail; another way is as short as the first. Quick steps would do, but not
    // for a fibre that may be partial.
    let (family, _, mut fibre) = p3p_fibre();
    assert!(!fibre.is_partial);
    fibre.is_partial = true;
    let targets: Vec<_> = (0..300).map(|seed| Random::new(seed, 1).normals(6)).collect();
    let run = |retries: u32| {
        let mut options = SolveOptions::default();
        options.paths.tracker.max_steps = 25;
        options.paths.retries = retries;
        let mut limits = TargetLimits::default();
        limits.again = 10.0;
        family.track(&fibre, &targets).options(&options).limits(&limits).run().unwrap()
    };
    let lost = |found: &[Solutions]| found.iter().map(|s| s.paths.failed).sum::<usize>();
    let (before, after) = (run(0), run(1));
    assert!(lost(&before) > 0, "the settings are meant to lose paths");
    assert_eq!(lost(&after), 0);
    for (k, found) in after.iter().enumerate() {
        let points: Vec<_> = found.iter().map(|s| &s.value).collect();
        assert!(points.len() == 8 && found.iter().all(|s| !s.singular && s.residual < 1e-14), "target {k}");
        let apart = |i: usize| points[..i].iter().all(|y| relative_distance(points[i], y) > 1e-6);
        assert!((1..8).all(apart), "target {k}");
    }
}

#[test]
fn paths_are_tracked_again_as_often_as_allowed() {
    let (family, _, mut fibre) = p3p_fibre();
    fibre.is_partial = true;
    let targets: Vec<_> = (0..100).map(|seed| Random::new(seed, 1).normals(6)).collect();
    let mut options = SolveOptions::default();
    // Too few steps for most paths, even when they are tracked again.
    options.paths.tracker.max_steps = 12;
    let run = |again: f64| {
        let mut limits = TargetLimits::default();
        limits.again = again;
        family.track(&fibre, &targets).options(&options).limits(&limits).run().unwrap()
    };
    let allowed = [0.0, 0.5, 1.0, 3.5, 100.0].map(|again| (again, run(again)));
    for (again, found) in &allowed {
        for found in found {
            assert!(found.paths.retracked as f64 <= 8.0 * again, "{again}: {:?}", found.paths);
            // With 100 everything is tried, and few paths stay lost.
            let limited = found.paths.failed > 0 && *again < 100.0;
            assert_eq!(found.limited, limited.then_some(Limit::Again), "{again}: {:?}", found.paths);
            let said = found.warnings().contains(&Warning::Limited { paths: found.paths.failed, limit: Limit::Again });
            assert_eq!((said, found.interrupted), (limited, false));
        }
    }
    let lost = |found: &[Solutions]| found.iter().map(|s| s.paths.failed).sum::<usize>();
    let lost = allowed.each_ref().map(|(_, found)| lost(found));
    // Shorter steps need as many more as they are allowed, so that here detours alone find what is lost.
    assert!(lost.is_sorted_by(|more, fewer| more >= fewer) && lost[2] > lost[3] && lost[3] > lost[4], "{lost:?}");
    // The default is 1, and what needs no more is found all the same.
    let default = family.track(&fibre, &targets).options(&options).run().unwrap();
    assert_eq!(default, allowed[2].1);
    for (less, more) in allowed[0].1.iter().zip(&default) {
        assert!(less.paths.failed > 0 || less == more);
    }
    let mut limits = TargetLimits::default();
    limits.again = -1.0;
    let error = family.track(&fibre, &targets).limits(&limits).run().unwrap_err();
    assert_eq!(error.to_string(), "option again must be zero or more, not -1");
}

#[test]
fn a_target_ends_at_its_time_limit() {
    let (family, _, fibre) = p3p_fibre();
    let targets: Vec<_> = (0..3).map(|seed| Random::new(seed, 1).normals(6)).collect();
    let run = |seconds: f64| {
        let mut limits = TargetLimits::default();
        limits.seconds = Some(seconds);
        family.track(&fibre, &targets).limits(&limits).run().unwrap()
    };
    for found in run(0.0) {
        assert_eq!((found.paths.failed, found.limited, found.interrupted), (8, Some(Limit::Time), false));
        assert!(found.to_string().contains("8 paths left: the time limit was reached"), "{found}");
    }
    assert_eq!(run(1e5), family.track(&fibre, &targets).run().unwrap());
}

#[test]
fn a_tracker_heeds_its_monitor() {
    let (_, system) = family("x", "a", "x^2 - a");
    let path = Segment::new(&reals(&[1.0]), &reals(&[2.0]));
    let monitor = Monitor::watched();
    let mut tracker = Tracker::<_, Lanes8>::new(&system, &TrackerOptions::default());
    tracker.set_monitor(&monitor);
    let mut paths = PathSet::new(1);
    tracker.track(&path, &reals(&[1.0, -1.0]), 0..2, &mut paths);
    assert_eq!(paths.count(PathEnd::Success), 2);
    monitor.cancel();
    tracker.track(&path, &reals(&[1.0, -1.0]), 0..2, &mut paths);
    assert_eq!((paths.len(), paths.count(PathEnd::Cancelled)), (4, 2));
}

/// Where all coordinates are zero and even derivatives vanish, the size of the point says nothing of the scale of its
/// path.
#[test]
fn a_path_leaves_zero() {
    let family = Family::from_formulas(&["x"], &["a"], &["x^3 - 3*x + a"]).unwrap();
    let real = |x: f64| [Complex64::new(x, 0.0)];
    let ends =
        track(family.program(), &Segment::new(&real(0.0), &real(1.0)), &real(0.0), &[0], &TrackerOptions::default());
    // x = 2 cos(4 pi / 9) solves x^3 - 3 x = 2 cos(4 pi / 3).
    let expected = 2.0 * (4.0 * std::f64::consts::PI / 9.0).cos();
    assert_eq!(ends.results()[0].end, PathEnd::Success);
    assert!((ends.point(0)[0] - expected).norm() < 1e-10 && ends.results()[0].accepted < 10);
}

/// Paths that jump are tracked again in one unknown too: there is no start system from which they could be sought anew.
#[test]
fn all_roots_of_cubics_are_reached() {
    let family = Family::from_formulas(&["x"], &["a", "b"], &["x^3 + a*x + b"]).unwrap();
    let fibre = family.monodromy(&MonodromyOptions::new()).unwrap().fibre;
    assert_eq!(fibre.len(), 3);
    let targets: Vec<[f64; 2]> =
        (0..3000).map(|k| [-2.0 + f64::from(k % 60) * 0.0507, -1.51 + f64::from(k / 60) * 0.0607]).collect();
    for (found, [a, b]) in family.track(&fibre, &targets).run().unwrap().iter().zip(&targets) {
        assert_eq!((found.paths.failed, found.len()), (0, 3), "{a} {b}");
        let real = if 4.0 * a.powi(3) + 27.0 * b * b < 0.0 { 3 } else { 1 };
        assert_eq!(found.n_real(), real, "{a} {b}");
    }
}
