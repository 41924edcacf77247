//! Conics tangent to conics: Chasles' numbers by monodromy, from the front door, and certified. All
//! 3264 of Steiner's problem are counted by the example `steiner`.

use crate::common::conics::{COUNTS, tangent_conics};
use hc::certify::{CertifyOptions, certify};
use hc::family::Stopped;
use hc::poly::{Complex64, ComplexInterval, System};
use hc::random::Random;
use hc::{Family, Fibre, MonodromyOptions, Solutions, SolveOptions, solve};

fn fibre(family: &Family, count: usize) -> Fibre {
    let found = family.monodromy(&MonodromyOptions::new().roots(count)).unwrap();
    assert_eq!((found.stopped, found.fibre.len()), (Stopped::RootsReached, count));
    found.fibre
}

/// Number of solutions proved to exist and to be distinct, and of those proved real.
fn proved(family: &System, target: &[Complex64], found: &Solutions) -> (usize, usize) {
    let points: Vec<Vec<Complex64>> = found.nonsingular().map(|s| s.value.clone()).collect();
    let parameters: Vec<ComplexInterval> = target.iter().map(|&p| ComplexInterval::point(p)).collect();
    let certificates = certify(family, &parameters, &points, &CertifyOptions::default()).unwrap();
    assert!(certificates.unseparated.is_empty());
    (certificates.n_distinct(), certificates.n_real())
}

#[test]
fn through_points_and_tangent_to_up_to_three_conics() {
    for k in 0..=3 {
        let family = Family::new(tangent_conics(k)).unwrap();
        let fibre = fibre(&family, COUNTS[k]);
        let test = || family.trace_test(&fibre, &MonodromyOptions::default()).unwrap();
        assert!(k > 2 || test().passed(COUNTS[k]), "{k} conics");
        for seed in 0..3 {
            let target = Random::new(seed, 149).normals(fibre.parameters.len());
            let found = &family.track(&fibre, &[&target]).run().unwrap()[0];
            assert_eq!((found.solutions.len(), found.paths.failed), (COUNTS[k], 0), "{k} conics, seed {seed}");
            assert_eq!(proved(family.system(), &target, found).0, COUNTS[k], "{k} conics, seed {seed}");
        }
    }
}

/// From the front door there are double lines besides, which touch everything and are no regular
/// solutions.
#[test]
fn from_the_front_door() {
    for k in 1..=2 {
        let family = tangent_conics(k);
        let target = Random::new(0, 149).normals(family.parameters().len());
        let member = System::build(|s| {
            let unknowns: Vec<_> = family.variables().iter().map(|name| s.variable(name)).collect();
            let parameters: Vec<_> = target.iter().map(|&p| s.constant(p)).collect();
            family.instantiate(s, &unknowns, &parameters)
        })
        .unwrap();
        for seed in 0..3 {
            let mut options = SolveOptions::default();
            options.seed = seed;
            let found = solve(&member, &options).unwrap();
            assert_eq!(found.paths.failed, 0, "{k} conics, seed {seed}");
            assert_eq!(proved(&member, &[], &found).0, COUNTS[k], "{k} conics, seed {seed}");
        }
    }
}
