//! The ends of legs to the last digit of double precision, eight at a time.

use super::legs::{Leg, Legs};
use super::walker::Sample;
use crate::refine::LaneNewton;
use crate::tolerances::refinement;
use num_complex::Complex64;
use poly::{ComplexDd, Evaluate, Lane, Lanes8, Scalar};

/// The end of a leg, or of a piece of it.
#[derive(Clone, Copy)]
pub(super) struct LegEnd<'a> {
    /// The number of the leg among the [`Legs`].
    pub(super) leg: usize,
    /// The time of the leg there.
    pub(super) u: f64,
    pub(super) point: &'a [Complex64],
    /// Lipschitz constant of Newton's method, as the tracker estimated it.
    pub(super) omega: f64,
}

/// So many are polished at a time.
pub(super) const LANES: usize = Lanes8::LANES;

/// Newton's method with one Jacobian, in lanes. What that does not bring to the last digit is for its
/// [refiner](LaneNewton::refiner).
pub(super) struct Polisher<'a, E: Evaluate> {
    newton: LaneNewton<'a, E>,
    /// The parameters of one leg.
    row: Vec<ComplexDd>,
}

impl<'a, E: Evaluate> Polisher<'a, E> {
    /// A polisher for a square system.
    pub(super) fn new(system: &'a E) -> Self {
        Polisher { newton: LaneNewton::new(system), row: vec![ComplexDd::zero(); system.parameters()] }
    }

    /// Polishes one to eight ends; each result depends on its own end alone.
    pub(super) fn polish(&mut self, legs: &Legs<'_>, ends: &[LegEnd<'_>]) -> Vec<Sample> {
        // Lanes without an end have the last one.
        let lanes: [LegEnd<'_>; LANES] = std::array::from_fn(|l| ends[l.min(ends.len() - 1)]);
        let accuracies = self.newton(legs, &lanes);
        let polished = ends.iter().zip(accuracies).enumerate();
        let samples = polished.map(|(l, (&LegEnd { leg, u, point, .. }, accuracy))| {
            let mut point = point.to_vec();
            let blurs = matches!(legs.legs[leg], Leg::Radial(_));
            if accuracy.is_none() || blurs {
                legs.precise(leg, u, &mut self.row);
            }
            let Some(accuracy) = accuracy else {
                let (accuracy, blur) = self.newton.refiner.polish_and_blur(&self.row, &mut point, blurs);
                return Sample { point, accuracy, blur };
            };
            point.iter_mut().zip(&self.newton.x).for_each(|(z, x)| *z = x.get(l));
            let blur = if blurs { self.newton.refiner.blur(&self.row, &point, false) } else { Vec::new() };
            Sample { point, accuracy, blur }
        });
        samples.collect()
    }

    /// Leaves the polished points in `x`, and returns the expected relative sizes of further corrections, those
    /// that are no more than the rounding errors of the points.
    ///
    /// The first correction has residuals in double precision, the second in double-double, both the
    /// Jacobian of the first point. With one Jacobian, Newton's method contracts by the distance from the
    /// first point, times its Lipschitz constant: a third correction would be to the second at most what
    /// twice the second is to the first. Where the second corrects rounding errors of the first, that is too
    /// much, and the tracker's estimate of the constant serves, with a margin.
    fn newton(&mut self, legs: &Legs<'_>, lanes: &[LegEnd<'_>; LANES]) -> [Option<f64>; LANES] {
        let newton = &mut self.newton;
        let mut t = <Lanes8 as Lane>::Extended::zero();
        for (l, &LegEnd { leg, u, point, .. }) in lanes.iter().enumerate() {
            let [re, im] = ComplexDd::new(legs.legs[leg].at(u)).parts();
            Lanes8::set_extended(&mut t, l, re, im);
            newton.x.iter_mut().zip(point).for_each(|(x, z)| x.set(l, *z));
        }
        let precise_p = &mut newton.precise.p;
        legs.segment.extended(&t, precise_p);
        newton.p.iter_mut().zip(precise_p).for_each(|(p, precise)| *p = Lanes8::rounded(precise));
        newton.factor();
        let first = newton.correct();
        newton.take(u16::MAX);
        newton.evaluate_precisely();
        let second = newton.correct();
        newton.take(u16::MAX);
        std::array::from_fn(|l| {
            let (first, second) = (first.as_ref()[l].sqrt(), second.as_ref()[l].sqrt());
            let most = refinement::OMEGA_MARGIN * lanes[l].omega.max(1.0) * first;
            let contraction = (2.0 * second / first.max(f64::MIN_POSITIVE)).min(most);
            let third = second * contraction.max(f64::EPSILON);
            // Written so that NaN is not small.
            (first <= refinement::NEAR && third <= f64::EPSILON).then_some(third)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Leg, LegEnd, Legs, Polisher};
    use crate::homotopy::{ParameterPath, Segment};
    use crate::random::Random;
    use crate::refine::Refiner;
    use num_complex::Complex64;
    use poly::parse;

    /// `x^3 = a` and `x y = b` with cube roots of all sizes: the same ends and accuracies as one by one.
    #[test]
    fn ends_are_those_of_the_refiner_whatever_lies_beside_them() {
        let text = "name = 'f'\nunknowns = ['x', 'y']\nparameters = ['a', 'b']\nequations = ['x^3 - a', 'x*y - b']";
        let system = parse::family(text).unwrap().system.compile().unwrap();
        let mut random = Random::new(7, 1);
        let (start, target) = (random.normals(2), [Complex64::new(0.0, 0.0), random.normals(1)[0]]);
        let segment = Segment::new(&start, &target);
        let legs = Legs { segment: &segment, legs: (0..13).map(|k| Leg::Turn(2.0 * k as f64, 16)).collect() };
        let u = |leg: usize| leg as f64 / 16.0;
        // Off by 1e-8, as the tracker leaves them, but the last: so far off that the Jacobian there will not do.
        let points: Vec<Vec<Complex64>> = (0..legs.legs.len())
            .map(|k| {
                let mut p = [Complex64::new(0.0, 0.0); 8];
                legs.coefficients(&[k], &[u(k)], &mut p);
                let x = p[0].powf(1.0 / 3.0);
                let off = if k < 12 { 1e-8 } else { 0.2 };
                vec![x * (1.0 + off), p[1] / x * (1.0 - 2.0 * off)]
            })
            .collect();
        let ends = points.iter().enumerate().map(|(leg, x)| LegEnd { leg, u: u(leg), point: x, omega: 10.0 });
        let ends: Vec<LegEnd<'_>> = ends.collect();
        let mut polisher = Polisher::new(&system);
        let mut refiner = Refiner::new(&system);
        let first: [LegEnd<'_>; 8] = std::array::from_fn(|l| ends[l + 5]);
        let is_found = polisher.newton(&legs, &first).map(|accuracy| accuracy.is_some());
        assert_eq!(is_found, [true, true, true, true, true, true, true, false]);
        for size in [1, 3, 8] {
            let found: Vec<_> = ends.chunks(size).flat_map(|ends| polisher.polish(&legs, ends)).collect();
            for (k, sample) in found.iter().enumerate() {
                let (mut p, mut x) = (Vec::new(), points[k].clone());
                legs.precise(k, u(k), &mut p);
                let (accuracy, _) = refiner.polish_and_blur(&p, &mut x, false);
                assert!(accuracy <= f64::EPSILON && sample.accuracy <= f64::EPSILON, "{k}: {accuracy:e}");
                assert_eq!(sample.point, x, "{size}: {k}");
                assert!(sample.blur.is_empty());
            }
        }
    }
}
