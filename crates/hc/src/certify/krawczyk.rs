//! Krawczyk's test at one point, in interval arithmetic of either precision.

use super::proof::{Proof, shifted, symmetric};
use crate::tolerances::proofs;
use num_complex::Complex64;
use poly::Interval;
use poly::{ComplexBall, ComplexDd, ComplexInterval, Evaluate, Interpreter, Isa, Scalar};

/// Sets of complex numbers whose operations contain all exact results.
pub(super) trait Enclosure: Scalar {
    /// A set that contains the ball.
    fn of_ball(ball: &ComplexBall) -> Self;
    /// A set that contains the rectangle.
    fn of_interval(set: &ComplexInterval) -> Self;
    /// A set that contains the number, and nothing else if that is possible.
    fn of_number(z: &ComplexDd) -> Self;
    /// A set that contains `centre + offset`.
    fn shifted(centre: &ComplexDd, offset: &ComplexInterval) -> Self;
    /// A rectangle that contains the set.
    fn interval(&self) -> ComplexInterval;
}

/// Sixteen digits, fast.
impl Enclosure for ComplexInterval {
    fn of_ball(ball: &ComplexBall) -> Self {
        ball.interval()
    }

    fn of_interval(set: &ComplexInterval) -> Self {
        *set
    }

    fn of_number(z: &ComplexDd) -> Self {
        let zero = ComplexInterval::zero();
        if z.low() == Complex64::new(0.0, 0.0) { ComplexInterval::point(z.high()) } else { shifted(z, &zero) }
    }

    fn shifted(centre: &ComplexDd, offset: &ComplexInterval) -> Self {
        shifted(centre, offset)
    }

    fn interval(&self) -> ComplexInterval {
        *self
    }
}

/// Thirty-two digits.
impl Enclosure for ComplexBall {
    fn of_ball(ball: &ComplexBall) -> Self {
        *ball
    }

    fn of_interval(set: &ComplexInterval) -> Self {
        ComplexBall::containing(set)
    }

    fn of_number(z: &ComplexDd) -> Self {
        ComplexBall::point(z)
    }

    fn shifted(centre: &ComplexDd, offset: &ComplexInterval) -> Self {
        Self::add(&ComplexBall::point(centre), &ComplexBall::containing(offset))
    }

    fn interval(&self) -> ComplexInterval {
        ComplexBall::interval(self)
    }
}

/// Where the test is made.
pub(super) struct Place<'a> {
    /// The refined point.
    pub(super) centre: &'a [ComplexDd],
    /// Column-major approximate inverse of the Jacobian there.
    pub(super) inverse: &'a [ComplexDd],
    /// Enclosures of the values there.
    pub(super) residuals: &'a [ComplexBall],
    /// Proportions of the boxes.
    pub(super) weights: &'a [f64],
}

/// Scratch space of the test.
pub(super) struct Krawczyk<'a, S: Enclosure> {
    system: &'a Interpreter,
    n: usize,
    parameters: Vec<S>,
    memory: <Interpreter as Evaluate>::Memory<S>,
    inverse: Vec<S>,
    /// `-C F(c)`
    newton: Vec<S>,
    values: Vec<S>,
    jacobian: Vec<S>,
}

impl<'a, S: Enclosure> Krawczyk<'a, S> {
    pub(super) fn new(system: &'a Interpreter, parameters: &[ComplexInterval], isa: Isa) -> Self {
        let n = system.variables();
        Krawczyk {
            system,
            n,
            parameters: parameters.iter().map(S::of_interval).collect(),
            memory: system.memory(isa),
            inverse: Vec::new(),
            newton: Vec::new(),
            values: vec![S::zero(); n],
            jacobian: vec![S::zero(); n * n],
        }
    }

    /// Tries boxes in the proportions of the weights, from `largest` of them to small ones.
    pub(super) fn contract(&mut self, at: &Place<'_>, largest: f64) -> Option<Proof> {
        let n = self.n;
        self.inverse.clear();
        self.inverse.extend(at.inverse.iter().map(S::of_number));
        let residuals: Vec<S> = at.residuals.iter().map(S::of_ball).collect();
        let product = |i: usize| {
            let terms = residuals.iter().enumerate();
            S::neg(&terms.fold(S::zero(), |sum, (k, r)| S::mul_add(&self.inverse[k * n + i], r, &sum)))
        };
        self.newton = (0..n).map(product).collect();
        let correction = |z: &S| z.interval().magnitude();
        // Room for the correction, and for the doubles that bound the published box.
        let least: Vec<f64> = (self.newton.iter().zip(at.centre))
            .map(|(d, c)| (proofs::ROOM * correction(d)).max(spacing(c.high())))
            .collect();
        if !least.iter().all(|size| size.is_finite()) {
            return None;
        }
        let mut share = largest;
        for _ in 0..proofs::BOXES {
            let large: Vec<f64> = at.weights.iter().zip(&least).map(|(w, l)| (w * share).max(*l)).collect();
            let boxes = squares(&large);
            let (image, norm) = self.image(at.centre, &boxes);
            if norm < 1.0 && within(&image, &boxes) {
                let small = self.tighten(at.centre, image, &least);
                return Some(Proof { centre: at.centre.to_vec(), large, small }).filter(Proof::is_publishable);
            }
            if large.iter().zip(&least).all(|(r, l)| r == l) {
                break;
            }
            // Beyond rounding, the norm is proportional to the size of small boxes; that of large
            // ones grows as a higher power.
            share *= if norm.is_finite() {
                (0.25 / norm).clamp(proofs::SHRINK * proofs::SHRINK, proofs::SHRINK)
            } else {
                proofs::SHRINK * proofs::SHRINK
            };
        }
        None
    }

    /// `-C F(c) + (I - C J(c + D)) D`, and a bound of the norm of `I - C J(c + D)` with coordinates
    /// weighted by the box.
    fn image(&mut self, centre: &[ComplexDd], boxes: &[ComplexInterval]) -> (Vec<ComplexInterval>, f64) {
        let n = self.n;
        let Krawczyk { system, parameters, memory, inverse, newton, values, jacobian, .. } = self;
        let x: Vec<S> = centre.iter().zip(boxes).map(|(c, d)| S::shifted(c, d)).collect();
        let offsets: Vec<S> = boxes.iter().map(S::of_interval).collect();
        system.jacobian(memory, &x, parameters, values, jacobian);
        // A pole in the box shows in the values.
        if values.iter().any(|v| !v.interval().magnitude().is_finite()) {
            return (newton.iter().map(S::interval).collect(), f64::INFINITY);
        }
        let sizes: Vec<f64> = boxes.iter().map(ComplexInterval::magnitude).collect();
        let mut image = newton.clone();
        let mut norm = 0.0f64;
        for i in 0..n {
            let mut row = 0.0f64;
            for j in 0..n {
                let mut entry = if i == j { S::one() } else { S::zero() };
                for k in 0..n {
                    entry = S::sub_mul(&inverse[k * n + i], &jacobian[j * n + k], &entry);
                }
                image[i] = S::mul_add(&entry, &offsets[j], &image[i]);
                row = (row + (entry.interval().magnitude() * sizes[j]).next_up()).next_up();
            }
            let ratio = (row / sizes[i]).next_up();
            // The larger of the two, and infinite where a bound is not a number.
            norm = if ratio.is_nan() { f64::INFINITY } else { norm.max(ratio) };
        }
        (image.iter().map(S::interval).collect(), norm)
    }

    /// The image of a box that contains the solution contains it too; the box is made as small as
    /// that allows. Boxes are extended to the centre, from which differences are taken.
    fn tighten(
        &mut self,
        centre: &[ComplexDd],
        mut small: Vec<ComplexInterval>,
        least: &[f64],
    ) -> Vec<ComplexInterval> {
        let total = |boxes: &[ComplexInterval]| boxes.iter().map(ComplexInterval::radius).fold(0.0, f64::max);
        for _ in 0..proofs::TIGHTER {
            let extended: Vec<ComplexInterval> = small.iter().map(with_zero).collect();
            let (image, _) = self.image(centre, &extended);
            let next: Vec<ComplexInterval> = small.iter().zip(&image).map(|(a, b)| intersection(a, b)).collect();
            let shrunk = total(&next) < 0.5 * total(&small);
            small = next;
            if !shrunk {
                break;
            }
        }
        // Where rounding hinders that: the least box, if it holds a solution, which is this one.
        let boxes = squares(least);
        if total(&small) > proofs::WIDE * total(&boxes) {
            let (image, _) = self.image(centre, &boxes);
            if within(&image, &boxes) {
                small = small.iter().zip(&image).map(|(a, b)| intersection(a, b)).collect();
            }
        }
        small
    }
}

/// Squares around zero with these half-widths.
fn squares(half: &[f64]) -> Vec<ComplexInterval> {
    half.iter().map(|&r| ComplexInterval { re: symmetric(r), im: symmetric(r) }).collect()
}

fn within(image: &[ComplexInterval], boxes: &[ComplexInterval]) -> bool {
    boxes.iter().zip(image).all(|(b, k)| b.contains_in_interior(k))
}

/// Twice the distance of neighbouring doubles of the size of the larger part.
fn spacing(z: Complex64) -> f64 {
    let size = z.re.abs().max(z.im.abs());
    2.0 * (size.next_up() - size)
}

/// The smallest box that contains the box and zero.
fn with_zero(a: &ComplexInterval) -> ComplexInterval {
    let part = |a: Interval| Interval { low: a.low.min(0.0), high: a.high.max(0.0) };
    ComplexInterval { re: part(a.re), im: part(a.im) }
}

/// The intersection of two sets; both contain the solution, so it is not empty.
fn intersection(a: &ComplexInterval, b: &ComplexInterval) -> ComplexInterval {
    let both = |a: Interval, b: Interval| Interval { low: a.low.max(b.low), high: a.high.min(b.high) };
    ComplexInterval { re: both(a.re, b.re), im: both(a.im, b.im) }
}
