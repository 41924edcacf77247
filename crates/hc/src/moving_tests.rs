//! Moving parts against the parts of the parameters, and families with and without them.

use super::MovingTrackers;
use crate::family::{Family, Fibre, FibreOptions, track_fibre};
use crate::homotopy::{ParameterPath, Segment};
use crate::monitor::Monitor;
use crate::random::Random;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{ComplexDd, Evaluate, Lane, Lanes8, Scalar, Singles16, Split};

/// The number of random streams that these tests draw from.
const STREAM: u64 = 5;

/// Two conics whose coefficients are products of up to four parameters.
fn conics() -> Family {
    let equations = [
        "a*b*x^2 + (a*c - b)*x*y + (b*c*d + 1)*y^2 - a*d*x + b^2*y - (c*d + a)*b",
        "(a - d)*c*x^2 + a^2*b*d*x*y - (b + c)*d*y^2 + (a*d - 1)*x - a*c*y + (a + b)*(c + d)",
    ];
    Family::from_formulas(&["x", "y"], &["a", "b", "c", "d"], &equations).expect("a family")
}

fn split(family: &Family) -> Split {
    Split::new(family.system(), family.program()).expect("a split")
}

/// The parts at a point of the segment, in double-double.
fn parts_at(split: &Split, segment: &Segment, t: f64) -> Vec<ComplexDd> {
    let parts = split.parts();
    let (mut p, mut q) = (vec![ComplexDd::zero(); parts.parameters()], vec![ComplexDd::zero(); parts.equations()]);
    segment.extended(&ComplexDd::new(t.into()), &mut p);
    parts.values(&mut parts.memory(Isa::Portable), &[], &p, &mut q);
    q
}

#[test]
fn coefficients_are_those_of_the_parts() {
    let split = split(&conics());
    let mut random = Random::new(1, STREAM);
    let segment = Segment::new(&random.normals(4), &random.normals(4));
    let moving = MovingTrackers::new(&split, segment.target(), &[]).along(segment.clone());
    let m = moving.parameters();
    assert!(!moving.is_straight() && split.degrees()[0] == 4);
    let mut q = vec![Complex64::default(); 4 * m];
    for t in [1.0, 0.7, 0.01, 0.0] {
        moving.coefficients(&[0], &[t], &mut q);
        // The parts are polynomials of degree 4, so that Taylor polynomials of degree 3 are off by the fourth power.
        let step = 1e-3;
        let [here, there] = [t, t + step].map(|t| parts_at(&split, &segment, t));
        for i in 0..m {
            assert!((q[i] - here[i].high()).norm() < 1e-13, "part {i} at {t}");
            let taylor = (0..4).rev().fold(Complex64::default(), |sum, k| sum * step + q[k * m + i]);
            assert!((taylor - there[i].high()).norm() < 1e3 * step.powi(4), "part {i} at {t}");
        }
        let mut extended = vec![ComplexDd::zero(); m];
        moving.extend(0, t, &mut extended);
        assert_eq!(extended, here);
    }
}

#[test]
fn lanes_are_alike() {
    let split = split(&conics());
    let mut random = Random::new(2, STREAM);
    let segment = Segment::new(&random.normals(4), &random.normals(4));
    let moving = MovingTrackers::new(&split, segment.target(), &[]).along(segment);
    let m = moving.parameters();
    let mut eight = vec![Lanes8::zero(); 4 * m];
    let mut sixteen = vec![Singles16::zero(); 4 * m];
    let (mut t, mut wide) = (Lanes8::real(0.0), Singles16::real(0.0));
    (0..8).for_each(|l| t.as_mut()[l] = 1.0 / (l + 1) as f64);
    (0..16).for_each(|l| wide.as_mut()[l] = 1.0 / (l + 1) as f64);
    moving.coefficients(&[0; 8], &t, &mut eight);
    moving.coefficients(&[0; 16], &wide, &mut sixteen);
    for l in 0..8 {
        let mut one = vec![Complex64::default(); 4 * m];
        moving.coefficients(&[0], &[t.as_ref()[l]], &mut one);
        for (k, one) in one.into_iter().enumerate() {
            assert_eq!(eight[k].get(l), one);
            assert!((sixteen[k].get(l) - one).norm() < 1e-5 * (1.0 + one.norm()), "{k}");
        }
    }
}

/// A family tracks with its split, and ends at the same points as its equations do as they are; also where the target
/// is so small that the coefficients of the path nearly vanish there.
#[test]
fn ends_are_those_of_the_equations() {
    let family = conics();
    let mut random = Random::new(3, STREAM);
    let parameters = random.normals(4);
    let found = family.monodromy(&crate::MonodromyOptions::new().roots(4)).expect("four solutions");
    let fibre: Fibre = found.fibre;
    assert_eq!(fibre.len(), 4);
    let small: Vec<Complex64> = parameters.iter().map(|p| p * 1e-3).collect();
    for target in [&parameters, &small] {
        let solutions = &family.track(&fibre, &[target]).run().expect("solutions")[0];
        assert_eq!((solutions.paths.finite, solutions.paths.failed), (4, 0));
        let (ends, counts) =
            track_fibre(family.program(), &fibre, target, &FibreOptions::default(), &Monitor::default());
        assert_eq!(counts.finite, 4);
        for (_, x) in ends.iter() {
            let near = |y: &[Complex64]| x.iter().zip(y).all(|(x, y)| (x - y).norm() < 1e-9 * (1.0 + y.norm()));
            assert_eq!(solutions.iter().filter(|s| near(&s.value)).count(), 1, "{x:?}");
        }
    }
}
