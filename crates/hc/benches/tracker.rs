//! The tracker on the ten solutions of the five-point problem: one path or eight at once, the
//! family interpreted or generated. Divan's items are paths.

#[path = "../examples/five_point/generated.rs"]
#[rustfmt::skip]
mod generated;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use hc::family::track_fibre;
use hc::homotopy::Segment;
use hc::poly::{Complex64, Evaluate, Interpreter, Lane, Lanes8, parse};
use hc::random::Random;
use hc::tracker::{PathSet, Tracker, TrackerOptions};
use hc::{Fibre, FibreOptions, Monitor};

fn main() {
    divan::main();
}

/// Parameters far from the stored ones, where the family has as many solutions.
fn target(fibre: &Fibre) -> Vec<Complex64> {
    Random::new(0, 5).normals(fibre.parameters.len())
}

fn interpreter() -> Interpreter {
    let family = parse::family(include_str!("../../../examples/families/five_point.toml")).expect("a family");
    family.system.compile().expect("a system that compiles")
}

fn measure<L: Lane>(bencher: Bencher<'_, '_>, system: &impl Evaluate) {
    let fibre = generated::fibre();
    let target = target(&fibre);
    let mut tracker = Tracker::<_, L>::new(system, &TrackerOptions::default());
    let mut paths = PathSet::new(system.variables());
    bencher.counter(ItemsCount::new(fibre.len())).bench_local(|| {
        let path = Segment::new(&fibre.parameters, black_box(&target));
        paths.clear(system.variables());
        tracker.track(&path, &fibre.solutions, 0..fibre.len(), &mut paths);
    });
}

#[divan::bench]
fn interpreted_one(bencher: Bencher<'_, '_>) {
    measure::<Complex64>(bencher, &interpreter());
}

#[divan::bench]
fn interpreted_eight(bencher: Bencher<'_, '_>) {
    measure::<Lanes8>(bencher, &interpreter());
}

#[divan::bench]
fn generated_one(bencher: Bencher<'_, '_>) {
    measure::<Complex64>(bencher, &generated::System);
}

#[divan::bench]
fn generated_eight(bencher: Bencher<'_, '_>) {
    measure::<Lanes8>(bencher, &generated::System);
}

/// With the ends judged, and doubtful paths tracked again.
#[divan::bench]
fn whole_fibre(bencher: Bencher<'_, '_>) {
    let fibre = generated::fibre();
    let target = target(&fibre);
    bencher.counter(ItemsCount::new(fibre.len())).bench_local(|| {
        track_fibre(&generated::System, &fibre, black_box(&target), &FibreOptions::default(), &Monitor::default())
    });
}
