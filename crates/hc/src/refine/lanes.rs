//! Many points for the same parameters, refined eight at a time to the same bits as one by one.

use super::lane_newton::LaneNewton;
use super::polished::Polished;
use super::refined::Refined;
use super::refiner::Refiner;
use super::sizes::sizes;
use crate::tolerances::refinement;
use num_complex::Complex64;
use poly::{Evaluate, Lane, Lanes8, Scalar};
use std::sync::{Mutex, PoisonError};

/// Newton's method in lanes for points near which one Jacobian is enough, as it is at nearly all regular ends. What needs
/// more is for the [`Refiner`].
pub(crate) struct LaneRefiner<'a, E: Evaluate> {
    newton: LaneNewton<'a, E>,
    /// The parameters.
    given: Vec<Complex64>,
}

/// Refiners of one system, as many as threads have asked for. The members of a family may have so few solutions that
/// making a refiner for each would show.
pub(crate) struct LaneRefiners<'a, E: Evaluate> {
    system: &'a E,
    idle: Mutex<Vec<LaneRefiner<'a, E>>>,
}

impl<'a, E: Evaluate> LaneRefiners<'a, E> {
    /// A pool without refiners yet, for a square system.
    pub(crate) fn new(system: &'a E) -> Self {
        LaneRefiners { system, idle: Mutex::new(Vec::new()) }
    }

    /// What `work` returns with a refiner for the parameters `p`.
    pub(crate) fn with<R>(&self, p: &[Complex64], work: impl FnOnce(&mut LaneRefiner<'a, E>) -> R) -> R {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let free = idle().pop();
        let mut refiner = free.unwrap_or_else(|| LaneRefiner::new(self.system));
        refiner.set_parameters(p);
        let result = work(&mut refiner);
        idle().push(refiner);
        result
    }

    /// Gives back the memory of all refiners.
    pub(crate) fn release(&self) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

impl<'a, E: Evaluate> LaneRefiner<'a, E> {
    fn new(system: &'a E) -> Self {
        LaneRefiner { newton: LaneNewton::new(system), given: vec![Complex64::default(); system.parameters()] }
    }

    fn set_parameters(&mut self, p: &[Complex64]) {
        self.given.copy_from_slice(p);
        let LaneNewton { p: lanes, precise, .. } = &mut self.newton;
        for ((&z, p), precise) in p.iter().zip(lanes).zip(&mut precise.p) {
            *p = Lanes8::from_c64(z);
            *precise = Lanes8::extended(p, &Lanes8::zero());
        }
    }

    /// What refines points one by one.
    pub(crate) fn single(&mut self) -> &mut Refiner<'a, E> {
        &mut self.newton.refiner
    }

    /// [`Refiner::refine`] for points, in their order; each result depends on its own point alone.
    pub(crate) fn refine(&mut self, points: &[&[Complex64]]) -> Vec<Refined> {
        let mut refined = Vec::with_capacity(points.len());
        points.chunks(Lanes8::LANES).for_each(|points| refined.extend(self.refine_eight(points)));
        refined
    }

    fn refine_eight(&mut self, points: &[&[Complex64]]) -> Vec<Refined> {
        // Lanes without a point have the last one.
        for l in 0..Lanes8::LANES {
            self.newton.x.iter_mut().zip(points[l.min(points.len() - 1)]).for_each(|(x, z)| x.set(l, *z));
        }
        let polished = self.polish(points.len());
        let LaneNewton { system, memory, x, p, values, .. } = &mut self.newton;
        system.values(memory, x, p, values);
        let judged = |(l, (&point, polished)): (usize, (&&[Complex64], Option<Polished>))| {
            let found = polished.and_then(|polished| self.judge(l, &polished));
            found.unwrap_or_else(|| self.newton.refiner.refine(&self.given, point))
        };
        points.iter().zip(polished).enumerate().map(judged).collect()
    }

    /// Corrects the points in the first lanes, as [`Refiner`] does; `None` where that takes another Jacobian.
    fn polish(&mut self, lanes: usize) -> [Option<Polished>; Lanes8::LANES] {
        self.newton.factor();
        let mut polished = [Polished::BEGUN; Lanes8::LANES];
        let (mut left, mut serves) = ((1u16 << lanes) - 1, false);
        for _ in 0..refinement::ITERATIONS {
            self.newton.evaluate_precisely();
            let squares = self.newton.correct();
            let mut taken = 0u16;
            for (l, polished) in polished.iter_mut().enumerate().filter(|(l, _)| left >> l & 1 == 1) {
                if polished.shrinks(squares.as_ref()[l].sqrt(), serves) {
                    taken |= 1 << l;
                }
            }
            self.newton.take(taken);
            let goes_on = |l: usize| {
                let accuracy = polished[l].accuracy;
                taken >> l & 1 == 1 && accuracy > f64::EPSILON && accuracy <= refinement::NEAR
            };
            left = (0..Lanes8::LANES).filter(|&l| goes_on(l)).fold(0, |left, l| left | 1 << l);
            serves = true;
            if left == 0 {
                break;
            }
        }
        polished.map(|polished| (polished.accuracy <= f64::EPSILON && polished.serves()).then_some(polished))
    }

    /// Judges the polished point in a lane by the values there, with the Jacobian from where it was before; `None` if that
    /// does not serve.
    fn judge(&mut self, l: usize, polished: &Polished) -> Option<Refined> {
        let LaneNewton { refiner: single, x, values, jacobian, lu, .. } = &mut self.newton;
        let point: Vec<Complex64> = x.iter().map(|x| x.get(l)).collect();
        sizes(&point, &mut single.squares);
        single.values.iter_mut().zip(&*values).for_each(|(to, from)| *to = from.get(l));
        single.jacobian.iter_mut().zip(&*jacobian).for_each(|(to, from)| *to = from.get(l));
        single.lu.take_lane(lu, l);
        let judged = single.judge_values();
        let mut refined = Refined { point, ..Refined::default() };
        polished.tell(judged, &mut refined);
        polished.is_unmoved(judged.1).then_some(refined)
    }
}

#[cfg(test)]
mod tests {
    use super::{Lane, LaneRefiner, Refiner};
    use crate::random::Random;
    use num_complex::Complex64;
    use poly::parse;

    /// Roots of `x^3 = a`, `x y = b` and a sum of both, from starts as near as tracked ends, as far as Newton's method comes
    /// from, at the singular point, and where no number is.
    #[test]
    fn points_are_those_of_the_refiner_whatever_lies_beside_them() {
        let text = "name = 'f'\nunknowns = ['x', 'y', 'z']\nparameters = ['a', 'b']\n\
                    equations = ['x^3 - a', 'x*y - b', 'z*(x - 2*y) - 1']";
        let system = parse::family(text).unwrap().system.compile().unwrap();
        let mut random = Random::new(7, 1);
        let p = random.normals(2);
        let third = Complex64::from_polar(1.0, std::f64::consts::TAU / 3.0);
        let near = |k: usize| {
            let x = p[0].powf(1.0 / 3.0) * third.powu(k as u32);
            let y = p[1] / x;
            let off = [0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5, 1e-2, 0.3][k % 8];
            vec![x * (1.0 + off), y * (1.0 - 2.0 * off), (1.0 + off) / (x - 2.0 * y)]
        };
        let mut points: Vec<Vec<Complex64>> = (0..29).map(near).collect();
        points[13] = vec![Complex64::from(0.0); 3];
        points[21] = vec![Complex64::from(f64::NAN); 3];
        let mut refiner = Refiner::new(&system);
        let expected: Vec<String> = points.iter().map(|x| format!("{:?}", refiner.refine(&p, x))).collect();
        let mut lanes = LaneRefiner::new(&system);
        lanes.set_parameters(&p);
        for size in [1, 3, 8, 29] {
            let found = points.chunks(size).flat_map(|points| {
                let points: Vec<&[Complex64]> = points.iter().map(Vec::as_slice).collect();
                lanes.refine(&points)
            });
            for (k, (found, expected)) in found.zip(&expected).enumerate() {
                assert_eq!(&format!("{found:?}"), expected, "{size}: {k}");
            }
        }
        let first: Vec<&[Complex64]> = points[..8].iter().map(Vec::as_slice).collect();
        lanes.refine(&first);
        // Lanes take all that is as near as tracked ends are.
        let (n, x) = (8, first.clone());
        for l in 0..n {
            lanes.newton.x.iter_mut().zip(x[l]).for_each(|(to, from)| to.set(l, *from));
        }
        let is_done = lanes.polish(n).map(|polished| polished.is_some());
        assert_eq!(is_done, [true, true, true, true, true, false, false, false]);
    }
}
