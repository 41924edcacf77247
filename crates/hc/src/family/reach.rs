//! How far the parameters have to move until the solutions leave their tangents. On a smaller scale
//! a family looks linear: loops meet no branch point, and the sum of any points moves straight.

use super::fibre::Fibre;
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use crate::tolerances::families;
use num_complex::Complex64;
use poly::{ComplexDd, Evaluate, Scalar};

/// The number of scales that are tried; sums of numbers further apart do not fit in doubles.
const SCALES: i32 = 9;
/// The number of points of the fibre that are examined.
const POINTS: usize = 8;

/// Sizes in this range count as one.
const UNIT_SIZES: std::ops::RangeInclusive<f64> = 1.0 / 64.0..=64.0;

/// The natural size of numbers of this size, by which random numbers are drawn: one, unless they are much
/// larger or smaller, as lengths in millimetres are.
pub(super) fn natural_size(size: f64) -> f64 {
    if UNIT_SIZES.contains(&size) || !size.is_normal() { 1.0 } else { size }
}

/// Sizes of the parameters and unknowns of a family.
#[derive(Clone, PartialEq)]
pub(super) struct Sizes {
    pub(super) parameters: Vec<f64>,
    pub(super) unknowns: Vec<f64>,
}

impl Sizes {
    /// The natural sizes of the parameters of a fibre, and of its largest solutions.
    fn natural(fibre: &Fibre) -> Sizes {
        Sizes {
            parameters: fibre.parameters.iter().map(|p| natural_size(p.norm())).collect(),
            unknowns: largest(fibre).into_iter().map(natural_size).collect(),
        }
    }
}

/// The size of the largest value of each unknown.
fn largest(fibre: &Fibre) -> Vec<f64> {
    (0..fibre.dimension).map(|j| fibre.iter().map(|x| x[j].norm()).fold(0.0, f64::max)).collect()
}

/// The sizes on which parameters and unknowns vary about the points of a fibre.
pub(super) struct Reach {
    /// The natural sizes of parameters and points.
    pub(super) natural: Sizes,
    /// For each parameter, its natural size, or that size times 8 and a power of 64, such that half
    /// of the points are straight on an eighth of it, and not on eight times that. For each
    /// unknown, the natural size of the largest among the points and their motions.
    pub(super) wide: Sizes,
    /// Whether some coordinate of most points is straight even where all parameters move by their
    /// natural sizes, and not on the wide ones: the family looks simpler than it is there.
    pub(super) hidden: bool,
}

impl Reach {
    /// The reach of the regular points of a fibre.
    pub(super) fn new<E: Evaluate>(system: &E, fibre: &Fibre) -> Reach {
        let mut motion = Motion { refiner: Refiner::new(system), parameters: &fibre.parameters };
        let points: Vec<&[Complex64]> = fibre.iter().step_by(fibre.len().div_ceil(POINTS).max(1)).collect();
        let natural = Sizes::natural(fibre);
        let (mut parameters, mut unknowns) = (natural.parameters.clone(), largest(fibre));
        for (k, size) in parameters.iter_mut().enumerate() {
            let mut scales: Vec<i32> = points.iter().filter_map(|x| motion.scale(k, *size, x)).collect();
            scales.sort_unstable();
            let scale = scales.get(scales.len() / 2).map_or(0, |&scale| scale);
            if scale > 0 {
                let straight = *size * families::REACH_SCALE.powi(scale);
                for x in &points {
                    let steps = motion.steps(&motion.only(k, straight), x);
                    for (unknown, step) in unknowns.iter_mut().zip(steps) {
                        *unknown = unknown.max(families::REACH_MIDDLE * Complex64::from(step[0]).norm());
                    }
                }
                *size = families::REACH_MIDDLE * straight;
            }
        }
        let hidden = parameters != natural.parameters && {
            let change = |sizes: &[f64]| -> Vec<Complex64> {
                let random = Random::of(0, Stream::Trace).normals(sizes.len());
                random.into_iter().zip(sizes).map(|(z, size)| z * (families::REACH_MIDDLE * size)).collect()
            };
            let (near, far) = (change(&natural.parameters), change(&parameters));
            let mut hides = |x: &&[Complex64]| {
                let (near, far) = (motion.straight(&near, x), motion.straight(&far, x));
                near.iter().zip(&far).any(|(&near, &far)| near && !far)
            };
            2 * points.iter().filter(|x| hides(x)).count() > points.len()
        };
        let unknowns = unknowns.into_iter().map(natural_size).collect();
        Reach { natural, wide: Sizes { parameters, unknowns }, hidden }
    }
}

/// Moves parameters, and points that follow them.
struct Motion<'a, E: Evaluate> {
    refiner: Refiner<'a, E>,
    parameters: &'a [Complex64],
}

impl<E: Evaluate> Motion<'_, E> {
    /// The largest power of 64 up to which the `k`-th parameter may move, times its size, before the
    /// last of the coordinates that ever leave their tangents has left its tangent; `None` if none
    /// does.
    fn scale(&mut self, k: usize, natural: f64, x: &[Complex64]) -> Option<i32> {
        let mut straight = vec![true; x.len()];
        let mut last = None;
        for scale in 0..SCALES {
            let change = self.only(k, natural * families::REACH_SCALE.powi(scale + 1));
            for (before, now) in straight.iter_mut().zip(self.straight(&change, x)) {
                if *before && !now {
                    *before = false;
                    last = Some(scale);
                }
            }
            if !straight.contains(&true) {
                break;
            }
        }
        last
    }

    /// Which coordinates of the point stay on their tangents while the parameters move by this change.
    fn straight(&mut self, change: &[Complex64], x: &[Complex64]) -> Vec<bool> {
        let steps = self.steps(change, x);
        steps.iter().zip(x).map(|(step, x)| !leaves_its_tangent(step, x.norm())).collect()
    }

    /// A change of the `k`-th parameter alone.
    fn only(&self, k: usize, size: f64) -> Vec<Complex64> {
        (0..self.parameters.len()).map(|j| Complex64::from(if j == k { size } else { 0.0 })).collect()
    }

    /// How far each coordinate moves in two such steps of the parameters.
    fn steps(&mut self, change: &[Complex64], x: &[Complex64]) -> Vec<[ComplexDd; 2]> {
        let [a, b, c] = [0.0, 1.0, 2.0].map(|s| {
            let moved: Vec<Complex64> = self.parameters.iter().zip(change).map(|(p, d)| p + d * s).collect();
            self.refiner.extend(&moved, x)
        });
        let step = |j: usize| [ComplexDd::sub(&b[j], &a[j]), ComplexDd::sub(&c[j], &b[j])];
        (0..x.len()).map(step).collect()
    }
}

/// Whether the second step differs from the first, or leads nowhere.
fn leaves_its_tangent(steps: &[ComplexDd; 2], size: f64) -> bool {
    let bend = Complex64::from(ComplexDd::sub(&steps[1], &steps[0])).norm();
    let step = Complex64::from(steps[0]).norm();
    // Written so that NaN is bent.
    !(step <= families::STILL * size || bend <= families::BENT * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(equation: &str, p: f64, x: f64) -> Vec<f64> {
        let text = format!("name = \"f\"\nunknowns = [\"x\"]\nparameters = [\"a\"]\nequations = [\"{equation}\"]");
        let family: crate::Family = text.parse().unwrap();
        let fibre = Fibre::new(vec![p.into()], 1, vec![Complex64::new(x, 0.0)]);
        Reach::new(family.program(), &fibre).wide.parameters
    }

    /// `x^3 - 12 x` turns at 16.
    #[test]
    fn is_of_the_order_of_the_branch_points() {
        for (factor, digits) in [("1", 0), ("1e2", 2), ("1e4", 4), ("1e7", 7), ("1e12", 12)] {
            let turn = 16.0 * 10f64.powi(digits);
            let found = reach(&format!("x^3 - 12*x - a/{factor}"), 0.0, 0.0)[0];
            assert!(found > turn / 64.0 && found < turn * 64.0, "{found} {turn}");
        }
    }

    #[test]
    fn of_what_is_straight_is_the_natural_size() {
        assert_eq!(reach("3*x - a", 3.0, 1.0), [1.0]);
        assert_eq!(reach("x - a", 5000.0, 5000.0), [5000.0]);
    }
}
