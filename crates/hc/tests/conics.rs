//! Conics tangent to conics: Chasles' numbers by monodromy, from the front door, and certified. All 3264 of Steiner's problem are counted by
//! the example `steiner`.

#[path = "common/conics.rs"]
mod conics;

use conics::{COUNTS, tangent_conics};
use hc::Fibre;
use hc::certify::{CertifyOptions, certify};
use hc::family::{MonodromyOptions, Stop, find_pair, monodromy, solve_member, trace_test};
use hc::poly::{Complex64, ComplexInterval, System};
use hc::random::{Random, Stream};
use hc::{Solutions, SolveOptions, solve};

fn fibre(family: &System, count: usize) -> Fibre {
    let start = find_pair(family, |_, _| true, 0).unwrap().expect("a first conic");
    let mut options = MonodromyOptions::default();
    options.roots = Some(count);
    let found = monodromy(&family.compile().unwrap(), &start, |_, _| true, &options);
    assert_eq!((found.stop, found.fibre.len()), (Stop::RootsReached, count));
    found.fibre
}

/// Number of solutions proved to exist and to be distinct, and of those proved real.
fn proved(family: &System, target: &[Complex64], found: &Solutions) -> (usize, usize) {
    let points: Vec<Vec<Complex64>> = found.nonsingular().map(|s| s.value.clone()).collect();
    let parameters: Vec<ComplexInterval> = target.iter().map(|&p| ComplexInterval::point(p)).collect();
    let certificates = certify(family, &parameters, &points, &CertifyOptions::default()).unwrap();
    assert!(certificates.unseparated.is_empty());
    (certificates.distinct(), certificates.real())
}

#[test]
fn through_points_and_tangent_to_up_to_three_conics() {
    for k in 0..=3 {
        let family = tangent_conics(k);
        let fibre = fibre(&family, COUNTS[k]);
        let options = MonodromyOptions::default();
        assert!(k > 2 || trace_test(&family, &fibre, &options).unwrap().passed(COUNTS[k]), "{k} conics");
        let compiled = family.compile().unwrap();
        for seed in 0..3 {
            let target = Random::new(seed, Stream::Other(9)).normals(fibre.parameters.len());
            let found = solve_member(&family, &compiled, &fibre, &target, &SolveOptions::default());
            assert_eq!((found.solutions.len(), found.paths.failed), (COUNTS[k], 0), "{k} conics, seed {seed}");
            assert_eq!(proved(&family, &target, &found).0, COUNTS[k], "{k} conics, seed {seed}");
        }
    }
}

/// From the front door there are double lines besides, which touch everything and are no regular solutions.
#[test]
fn from_the_front_door() {
    for k in 1..=2 {
        let family = tangent_conics(k);
        let target = Random::new(0, Stream::Other(9)).normals(family.parameters().len());
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
