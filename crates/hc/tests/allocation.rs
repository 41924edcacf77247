//! Tracking with a tracker that is used again allocates nothing.

use hc::homotopy::Segment;
use hc::poly::{Lanes8, parse};
use hc::random::Random;
use hc::tracker::{PathEnd, PathSet, Tracker, TrackerOptions};

#[test]
fn a_second_call_allocates_nothing() {
    // x^4 = a, y^3 = x b: twelve paths, more than lanes, so that lanes are refilled too.
    let family = parse::family(
        "name = \"roots\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"a\", \"b\"]\nequations = [\"x^4 - a\", \"y^3 - x*b\"]",
    )
    .unwrap();
    let system = family.system.compile().unwrap();
    let mut starts = Vec::new();
    for k in 0..12 {
        let x = num_complex::Complex64::from_polar(1.0, std::f64::consts::TAU * f64::from(k % 4) / 4.0);
        starts.extend([
            x,
            num_complex::Complex64::from_polar(1.0, (x.arg() + std::f64::consts::TAU * f64::from(k / 4)) / 3.0),
        ]);
    }
    let target = Random::new(0, 0).normals(2);
    let path = Segment::new(&[1.0.into(), 1.0.into()], &target);
    let mut tracker = Tracker::<_, Lanes8>::new(&system, &TrackerOptions::default());
    let mut paths = PathSet::new(2);
    tracker.track(&path, &starts, 0..12, &mut paths);
    assert_eq!(paths.count(PathEnd::Success), 12);
    let counted = allocation_counter::measure(|| {
        paths.clear(2);
        tracker.track(&path, &starts, 0..12, &mut paths);
    });
    assert_eq!(paths.count(PathEnd::Success), 12);
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
