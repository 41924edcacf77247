//! Trackers of fibres that know factors, symmetries and further equations: of interpreted families, and of generated
//! modules.

// Both written by `cargo xtask codegen`.
#[rustfmt::skip]
mod minors;
#[rustfmt::skip]
mod signs;

use hc::family::{FibreOptions, FibreTracker, OneChart, PathCounts};
use hc::poly::Complex64;
use hc::random::Random;
use hc::refine::Refiner;
use hc::tracker::{PathEnd, PathSet};
use hc::{Family, Fibre, MonodromyOptions};

fn numbers(values: &[f64]) -> Vec<Complex64> {
    values.iter().map(|&v| v.into()).collect()
}

/// Regular ends to six decimals, sorted.
fn ends(paths: &PathSet) -> Vec<Vec<i64>> {
    let rounded = |z: &Complex64| [(z.re * 1e6).round() as i64, (z.im * 1e6).round() as i64];
    let regular = paths.iter().filter(|(result, _)| result.end == PathEnd::Success);
    let mut all: Vec<Vec<i64>> = regular.map(|(_, x)| x.iter().flat_map(rounded).collect()).collect();
    all.sort();
    all
}

/// Fifteen of sixty paths are tracked to random targets; their images are where the others end.
#[test]
fn a_generated_solver_tracks_one_path_for_each_orbit() {
    let (fibre, system, options) = (signs::fibre(), signs::System, FibreOptions::default());
    assert_eq!(fibre.len(), 60);
    let mut plain = FibreTracker::new(&system, OneChart, &fibre);
    let mut stating = FibreTracker::new(&system, OneChart, &fibre).stating(signs::stated());
    let mut random = Random::new(0, 71);
    for _ in 0..20 {
        let target = random.normals(8);
        let (all, counts) = (plain.track(&fibre, &target, &options), stating.track(&fibre, &target, &options));
        assert_eq!((all.finite, counts.tracked, counts.finite, counts.failed), (60, 60, 60, 0));
        assert!(stating.paths().results().iter().enumerate().all(|(k, result)| result.path == k));
        assert_eq!(stating.paths().results().iter().filter(|result| result.jacobians > 0).count(), 15);
        assert_eq!(ends(stating.paths()), ends(plain.paths()));
    }
}

/// The family tells its tracker the same as the module.
#[test]
fn an_interpreted_family_tracks_the_same_paths() {
    let family: Family = include_str!("signs.toml").parse().unwrap();
    let (fibre, options) = (signs::fibre(), FibreOptions::default());
    let target = Random::new(1, 71).normals(8);
    let mut interpreted = FibreTracker::new(family.program(), OneChart, &fibre).stating(family.stated());
    let mut generated = FibreTracker::new(&signs::System, OneChart, &fibre).stating(signs::stated());
    let counts = interpreted.track(&fibre, &target, &options);
    assert_eq!(counts, generated.track(&fibre, &target, &options));
    assert_eq!(interpreted.paths(), generated.paths());
}

fn tracked(family: &Family, fibre: &Fibre, target: &[f64]) -> (PathCounts, PathSet) {
    let mut tracker = FibreTracker::new(family.program(), OneChart, fibre).stating(family.stated());
    let counts = tracker.track(fibre, &numbers(target), &FibreOptions::default());
    (counts, tracker.paths().clone())
}

/// Where images meet, or lie at infinity, all paths tell where they end.
#[test]
fn orbits_that_are_smaller_at_a_target_are_tracked_whole() {
    let text = "name = ''\nunknowns = ['x', 'y']\nparameters = ['p', 'q', 'r']\nequations = ['r*x^2 - p', 'y^2 - q']\n\
                symmetry = [['-x', 'y'], ['x', '-y']]";
    let family: Family = text.parse().unwrap();
    let fibre = family.monodromy(&MonodromyOptions::new()).unwrap().fibre;
    let (counts, paths) = tracked(&family, &fibre, &[4.0, 9.0, 1.0]);
    assert_eq!((counts.tracked, counts.finite, counts.retracked), (4, 4, 0));
    assert!((0..4).all(|k| paths.is_real(k)) && paths.results().iter().filter(|r| r.jacobians > 0).count() == 1);
    let (counts, paths) = tracked(&family, &fibre, &[0.0, 9.0, 1.0]);
    assert_eq!((counts.tracked, counts.finite), (4, 0));
    assert!(counts.retracked > 0 && paths.results().iter().all(|r| r.jacobians > 0));
    let (counts, paths) = tracked(&family, &fibre, &[-4.0, 9.0, 1.0]);
    assert!(counts.finite == 4 && (0..4).all(|k| !paths.is_real(k)));
    // A fibre that does not have all images is tracked as it is.
    let part = Fibre::new(fibre.parameters.clone(), 2, fibre.solutions[..6].to_vec());
    let (counts, paths) = tracked(&family, &part, &[4.0, 9.0, 1.0]);
    assert_eq!((counts.finite, paths.results().iter().filter(|r| r.jacobians > 0).count()), (3, 3));
}

/// Of the roots `a` and `b` one is 1, where the factor vanishes.
#[test]
fn ends_at_which_a_factor_vanishes_have_failed() {
    let text =
        "name = ''\nunknowns = ['x']\nparameters = ['a', 'b']\nequations = ['(x - a)*(x - b)']\nnonzero = ['x - 1']";
    let family: Family = text.parse().unwrap();
    let fibre = Fibre::new(numbers(&[2.0, 3.0]), 1, numbers(&[2.0, 3.0]));
    let (counts, paths) = tracked(&family, &fibre, &[1.0, 5.0]);
    assert_eq!((counts.tracked, counts.finite, counts.failed), (2, 1, 1));
    assert_eq!([0, 1].map(|k| paths.results()[k].end), [PathEnd::Degenerate, PathEnd::Success]);
    assert!(!paths.is_real(0) && paths.is_real(1));
}

/// The solution for `a = b` alone leads to solutions for such parameters only: combinations of the equations have
/// one for any others.
#[test]
fn ends_that_do_not_solve_all_equations_have_failed() {
    let family = Family::from_formulas(&["x"], &["a", "b"], &["x - a", "x - b"]).unwrap();
    let special = Fibre::new(numbers(&[2.0, 2.0]), 1, numbers(&[2.0]));
    let (counts, paths) = tracked(&family, &special, &[1.0, 3.0]);
    assert_eq!((counts.tracked, counts.finite, counts.failed), (1, 0, 1));
    assert_eq!(paths.results()[0].end, PathEnd::Degenerate);
    let (counts, paths) = tracked(&family, &special, &[5.0, 5.0]);
    assert!(counts.finite == 1 && (paths.point(0)[0] - 5.0).norm() < 1e-12);
}

/// Combinations of the equations are two conics, which meet in four points: one more than all equations have.
#[test]
fn a_generated_solver_checks_all_equations() {
    let (fibre, system, options) = (minors::fibre(), minors::System, FibreOptions::default());
    let mut random = Random::new(2, 71);
    let mut refiner = Refiner::new(&system);
    // Newton's method from anywhere, a few steps at a time.
    let mut end = |start: Vec<Complex64>| {
        let mut found = refiner.refine(&fibre.parameters, &start);
        for _ in 0..20 {
            found = refiner.refine(&fibre.parameters, &found.point);
        }
        found
    };
    let further = (0..200)
        .map(|_| end(random.normals(2)))
        .filter(|found| found.accuracy < 1e-12)
        .find(|found| fibre.iter().all(|x| (x[0] - found.point[0]).norm() > 1e-3))
        .unwrap();
    let all = Fibre::new(fibre.parameters.clone(), 2, [&fibre.solutions[..], &further.point].concat());
    let mut plain = FibreTracker::new(&system, OneChart, &all);
    let mut stating = FibreTracker::new(&system, OneChart, &all).stating(minors::stated());
    for _ in 0..20 {
        let target = random.normals(6);
        let counts = plain.track(&all, &target, &options);
        assert_eq!((counts.tracked, counts.finite, counts.failed), (4, 4, 0));
        let counts = stating.track(&all, &target, &options);
        assert_eq!((counts.tracked, counts.finite, counts.failed), (4, 3, 1));
        let ended: Vec<bool> = stating.paths().results().iter().map(|path| path.end == PathEnd::Success).collect();
        assert_eq!(ended, [true, true, true, false]);
    }
}

/// Each factor is measured by its own derivatives, however large those of another are.
#[test]
fn a_steep_factor_does_not_hide_solutions_from_another() {
    let text = "name = ''\nunknowns = ['x', 'y']\nparameters = ['a', 'b']\nequations = ['x^2 - a', 'y^2 - b']\n\
                nonzero = ['y - 1', '1e14*x']";
    let family: Family = text.parse().unwrap();
    let fibre = family.monodromy(&MonodromyOptions::new()).unwrap().fibre;
    let found = &family.track(&fibre, &[[1.0, 4.0]]).run().unwrap()[0];
    assert_eq!((found.len(), found.paths.failed), (4, 0));
    assert_eq!(tracked(&family, &fibre, &[1.0, 4.0]).0.finite, 4);
}
