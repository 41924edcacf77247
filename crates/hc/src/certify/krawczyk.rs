//! The test of one point.

use super::{Certificate, CertifyOptions, Obstacle, Reality};
use crate::linalg::Lu;
use num_complex::Complex64;
use poly::interval::Interval;
use poly::{ComplexBall, ComplexDd, ComplexInterval, Evaluate, Interpreter, Isa, Scalar};

/// Newton steps at most: from two digits, each step about doubles them, later ones add what the inverse is good for.
const NEWTON_STEPS: usize = 12;
/// The second correction is at most this share of the first: near a double root it would be one half.
const CONTRACTION: f64 = 0.25;
/// First corrections so small, relative to the weights, are rounding errors, and nothing follows from the second.
const ROUNDING: f64 = 1e-12;
/// What is carried over from other unknowns stays below one part in this many of a box.
const LEVEL: f64 = 16.0;
/// Boxes that are tried, each smaller by [`SHRINK`] at least.
const BOXES: usize = 16;
const SHRINK: f64 = 1.0 / 64.0;
/// A box is at least this many times the correction, so that the correction fits well inside.
const ROOM: f64 = 4.0;

/// What all points have in common.
pub(super) struct Target<'a> {
    pub(super) system: &'a Interpreter,
    pub(super) parameters: &'a [ComplexInterval],
}

/// A proved solution: exactly one in `centre + large box`, and that one in `centre + small`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Proof {
    pub(super) centre: Vec<ComplexDd>,
    /// Half-widths of the large box.
    pub(super) large: Vec<f64>,
    /// The small box, relative to the centre.
    pub(super) small: Vec<ComplexInterval>,
}

/// Scratch space for one point at a time.
pub(super) struct Prover<'a> {
    target: &'a Target<'a>,
    options: &'a CertifyOptions,
    n: usize,
    parameters: Vec<Complex64>,
    ball_parameters: Vec<ComplexBall>,
    plain: <Interpreter as Evaluate>::Memory<Complex64>,
    wide: <Interpreter as Evaluate>::Memory<ComplexInterval>,
    precise: <Interpreter as Evaluate>::Memory<ComplexBall>,
    values: Vec<Complex64>,
    jacobian: Vec<Complex64>,
    lu: Lu<Complex64>,
    /// Column-major approximate inverse of the Jacobian.
    inverse: Vec<Complex64>,
    residuals: Vec<ComplexBall>,
    wide_values: Vec<ComplexInterval>,
    wide_jacobian: Vec<ComplexInterval>,
}

impl<'a> Prover<'a> {
    pub(super) fn new(target: &'a Target<'a>, options: &'a CertifyOptions) -> Self {
        let (system, n) = (target.system, target.system.variables());
        let zero = Complex64::new(0.0, 0.0);
        Prover {
            target,
            options,
            n,
            parameters: target.parameters.iter().map(ComplexInterval::midpoint).collect(),
            ball_parameters: target.parameters.iter().map(ComplexBall::containing).collect(),
            plain: system.memory(Isa::Portable),
            wide: system.memory(Isa::Portable),
            // Fused products are instructions there, not library calls.
            precise: system.memory(Isa::detect()),
            values: vec![zero; n],
            jacobian: vec![zero; n * n],
            lu: Lu::new(n, Isa::Portable),
            inverse: vec![zero; n * n],
            residuals: vec![ComplexBall::zero(); n],
            wide_values: vec![ComplexInterval::zero(); n],
            wide_jacobian: vec![ComplexInterval::zero(); n * n],
        }
    }

    pub(super) fn prove(&mut self, point: &[Complex64]) -> Result<Proof, Obstacle> {
        if !point.iter().all(|z| z.is_finite()) {
            return Err(Obstacle::NotFinite);
        }
        match self.attempt(point, |weights| weights) {
            // Once more with all unknowns of one size: beside zeros, tiny coordinates say nothing of the scale of their unknowns.
            Err(Obstacle::NoContraction) => self.attempt(point, level),
            other => other,
        }
    }

    /// A proof with weights of the unknowns that `scale` makes of those that the system gives.
    fn attempt(&mut self, point: &[Complex64], scale: impl Fn(Vec<f64>) -> Vec<f64>) -> Result<Proof, Obstacle> {
        self.invert(point)?;
        let first_weights = scale(self.weights(point));
        let centre = self.refine(point, &first_weights)?;
        let rounded: Vec<Complex64> = centre.iter().map(ComplexDd::high).collect();
        if !within(point, &rounded, self.options.reach) {
            return Err(Obstacle::Away);
        }
        self.invert(&rounded)?;
        // At a solution with coordinates zero, the refined point says nothing of their scale, the point given does.
        let weights: Vec<f64> = self.weights(&rounded).iter().zip(&first_weights).map(|(a, b)| a.max(*b)).collect();
        let weights = scale(self.levelled(weights));
        let newton = self.newton_step(&centre);
        if newton.iter().any(|z| !z.magnitude().is_finite()) {
            return Err(Obstacle::NoContraction);
        }

        self.contract(&centre, &newton, &weights).ok_or(Obstacle::NoContraction)
    }

    /// Tries boxes in the proportions of the weights, from large to small.
    fn contract(&mut self, centre: &[ComplexDd], newton: &[ComplexInterval], weights: &[f64]) -> Option<Proof> {
        // Room for the correction, and for the doubles that bound the published box.
        let least: Vec<f64> =
            newton.iter().zip(centre).map(|(d, c)| (ROOM * d.magnitude()).max(ROOM * spacing(c.high()))).collect();
        let mut share = self.options.largest_box;
        for _ in 0..BOXES {
            let large: Vec<f64> = weights.iter().zip(&least).map(|(w, l)| (w * share).max(*l)).collect();
            let square = |&r: &f64| ComplexInterval { re: symmetric(r), im: symmetric(r) };
            let boxes: Vec<ComplexInterval> = large.iter().map(square).collect();
            let (image, norm) = self.krawczyk(centre, newton, &boxes);
            if norm < 1.0 && boxes.iter().zip(&image).all(|(b, k)| b.contains_in_interior(k)) {
                let small = self.tighten(centre, newton, image);
                return Some(Proof { centre: centre.to_vec(), large, small }).filter(Proof::is_publishable);
            }
            if large.iter().zip(&least).all(|(r, l)| r == l) {
                break;
            }
            // Beyond rounding, the norm is proportional to the size of the box.
            share *= if norm.is_finite() { (0.25 / norm).min(SHRINK) } else { SHRINK * SHRINK };
        }
        None
    }

    /// Newton's method in double-double until corrections no longer shrink.
    fn refine(&mut self, point: &[Complex64], weights: &[f64]) -> Result<Vec<ComplexDd>, Obstacle> {
        let mut centre: Vec<ComplexDd> = point.iter().map(|&z| z.into()).collect();
        let mut last = f64::INFINITY;
        for count in 0..NEWTON_STEPS {
            let rounded: Vec<Complex64> = centre.iter().map(ComplexDd::high).collect();
            self.invert(&rounded)?;
            self.evaluate_residuals(&centre);
            let step: Vec<Complex64> = (0..self.n)
                .map(|i| (0..self.n).map(|k| self.inverse[k * self.n + i] * self.residuals[k].midpoint()).sum())
                .collect();
            let size = step.iter().zip(weights).map(|(d, w)| d.norm() / w).fold(0.0, f64::max);
            if count == 1 && size > CONTRACTION * last && last > ROUNDING {
                return Err(Obstacle::NoContraction);
            }
            if size.is_nan() || size >= last {
                break;
            }
            centre.iter_mut().zip(&step).for_each(|(c, d)| *c = ComplexDd::sub(c, &(*d).into()));
            last = size;
        }
        Ok(centre)
    }

    /// The approximate inverse of the Jacobian at a point, by way of a matrix with rows and columns of equal size.
    fn invert(&mut self, x: &[Complex64]) -> Result<(), Obstacle> {
        let n = self.n;
        let Prover { target, parameters, plain, values, jacobian, lu, inverse, .. } = self;
        target.system.jacobian(plain, x, parameters, values, jacobian);
        let largest = |entries: &mut dyn Iterator<Item = f64>| {
            let largest = entries.fold(0.0, f64::max);
            if largest > 0.0 { largest } else { 1.0 }
        };
        let rows: Vec<f64> = (0..n).map(|k| largest(&mut (0..n).map(|j| jacobian[j * n + k].norm()))).collect();
        let columns: Vec<f64> =
            (0..n).map(|j| largest(&mut (0..n).map(|k| jacobian[j * n + k].norm() / rows[k]))).collect();
        let scaled: Vec<Complex64> =
            (0..n * n).map(|entry| jacobian[entry] / rows[entry % n] / columns[entry / n]).collect();
        lu.factor(&scaled, &vec![[1.0]; n]);
        inverse.fill(Complex64::new(0.0, 0.0));
        for (k, column) in inverse.chunks_mut(n).enumerate() {
            column[k] = Complex64::new(1.0, 0.0);
            lu.solve(column);
            column.iter_mut().zip(&columns).for_each(|(z, size)| *z = *z / rows[k] / size);
        }
        if inverse.iter().all(|z| z.is_finite()) { Ok(()) } else { Err(Obstacle::Singular) }
    }

    /// `|C| |J| |x|`: what relative changes of the terms do to each unknown. Unknowns that it leaves at zero, as at the
    /// origin, count as of size one.
    fn weights(&self, x: &[Complex64]) -> Vec<f64> {
        let n = self.n;
        let product = |x: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let rows: Vec<f64> = (0..n).map(|k| (0..n).map(|j| self.jacobian[j * n + k].norm() * x(j)).sum()).collect();
            (0..n).map(|i| (0..n).map(|k| self.inverse[k * n + i].norm() * rows[k]).sum()).collect()
        };
        let weights = product(&|j| x[j].norm());
        if weights.iter().all(|&w| w > 0.0) {
            return weights;
        }
        let unit = product(&|_| 1.0);
        weights.iter().zip(unit).map(|(&w, u)| if w > 0.0 { w } else { u }).collect()
    }

    /// Weights raised to where the errors of the inverse, `|I - C J|` and the rounding of that, carry those of other unknowns.
    fn levelled(&self, mut weights: Vec<f64>) -> Vec<f64> {
        let n = self.n;
        let error = |i: usize, j: usize| {
            let terms = (0..n).map(|k| self.inverse[k * n + i] * self.jacobian[j * n + k]);
            let (sum, size) = terms.fold((Complex64::new(0.0, 0.0), 0.0), |(sum, size), t| (sum + t, size + t.norm()));
            let one = if i == j { 1.0 } else { 0.0 };
            (one - sum).norm() + f64::EPSILON * size
        };
        let errors: Vec<f64> = (0..n * n).map(|entry| error(entry / n, entry % n)).collect();
        for _ in 0..2 {
            let carried: Vec<f64> =
                errors.chunks(n).map(|row| row.iter().zip(&weights).map(|(e, w)| e * w).sum::<f64>()).collect();
            weights.iter_mut().zip(carried).for_each(|(w, c)| *w = w.max(LEVEL * c));
        }
        weights
    }

    fn evaluate_residuals(&mut self, centre: &[ComplexDd]) {
        let balls: Vec<ComplexBall> = centre.iter().map(ComplexBall::point).collect();
        self.target.system.values(&mut self.precise, &balls, &self.ball_parameters, &mut self.residuals);
    }

    /// An enclosure of `-C F(c)`.
    fn newton_step(&mut self, centre: &[ComplexDd]) -> Vec<ComplexInterval> {
        self.evaluate_residuals(centre);
        let residuals: Vec<ComplexInterval> = self.residuals.iter().map(|r| r.interval()).collect();
        (0..self.n)
            .map(|i| {
                let terms = residuals.iter().enumerate();
                ComplexInterval::neg(&terms.fold(ComplexInterval::zero(), |sum, (k, r)| {
                    let c = ComplexInterval::point(self.inverse[k * self.n + i]);
                    ComplexInterval::mul_add(&c, r, &sum)
                }))
            })
            .collect()
    }

    /// `-C F(c) + (I - C J(c + D)) D`, and a bound of the norm of `I - C J(c + D)` with coordinates weighted by the box.
    fn krawczyk(
        &mut self,
        centre: &[ComplexDd],
        newton: &[ComplexInterval],
        boxes: &[ComplexInterval],
    ) -> (Vec<ComplexInterval>, f64) {
        let n = self.n;
        let x: Vec<ComplexInterval> = centre.iter().zip(boxes).map(|(c, d)| shifted(c, d)).collect();
        let (values, jacobian) = (&mut self.wide_values, &mut self.wide_jacobian);
        self.target.system.jacobian(&mut self.wide, &x, self.target.parameters, values, jacobian);
        // A pole in the box shows in the values.
        if values.iter().any(|v| !v.magnitude().is_finite()) {
            return (newton.to_vec(), f64::INFINITY);
        }
        let sizes: Vec<f64> = boxes.iter().map(ComplexInterval::magnitude).collect();
        let mut image = newton.to_vec();
        let mut norm = 0.0f64;
        for i in 0..n {
            let mut row = 0.0f64;
            for j in 0..n {
                let mut entry = if i == j { ComplexInterval::one() } else { ComplexInterval::zero() };
                for k in 0..n {
                    let c = ComplexInterval::point(self.inverse[k * n + i]);
                    entry = ComplexInterval::sub_mul(&c, &jacobian[j * n + k], &entry);
                }
                image[i] = ComplexInterval::mul_add(&entry, &boxes[j], &image[i]);
                row = (row + (entry.magnitude() * sizes[j]).next_up()).next_up();
            }
            let ratio = (row / sizes[i]).next_up();
            // The larger of the two, and infinite where a bound is not a number.
            norm = if ratio.is_nan() { f64::INFINITY } else { norm.max(ratio) };
        }
        (image, norm)
    }

    /// The image of a box that contains the solution contains it too: as small as that makes it. Boxes are extended to the
    /// centre, from where differences are taken.
    fn tighten(
        &mut self,
        centre: &[ComplexDd],
        newton: &[ComplexInterval],
        mut small: Vec<ComplexInterval>,
    ) -> Vec<ComplexInterval> {
        let total = |boxes: &[ComplexInterval]| boxes.iter().map(ComplexInterval::radius).fold(0.0, f64::max);
        for _ in 0..6 {
            let extended: Vec<ComplexInterval> = small.iter().map(with_zero).collect();
            let (image, _) = self.krawczyk(centre, newton, &extended);
            let next: Vec<ComplexInterval> = small.iter().zip(&image).map(|(a, b)| intersection(a, b)).collect();
            let shrunk = total(&next) < 0.5 * total(&small);
            small = next;
            if !shrunk {
                break;
            }
        }
        small
    }
}

impl Proof {
    /// Whether the published box, whose bounds are doubles, lies in the large one, so that no other solution is in it.
    fn is_publishable(&self) -> bool {
        self.centre.iter().zip(&self.small).zip(&self.large).all(|((c, small), &large)| {
            let published = shifted(c, small);
            let relative =
                |part: Interval, high: f64, low: f64| part.minus(Interval::point(high)).minus(Interval::point(low));
            symmetric(large).contains_in_interior(relative(published.re, c.re.high, c.re.low))
                && symmetric(large).contains_in_interior(relative(published.im, c.im.high, c.im.low))
        })
    }

    /// What is published of it; `real` says that conjugates of solutions are solutions.
    pub(super) fn certificate(&self, real: bool) -> Certificate {
        let enclosure: Vec<ComplexInterval> = self.centre.iter().zip(&self.small).map(|(c, d)| shifted(c, d)).collect();
        let reality = if enclosure.iter().any(|z| !z.im.contains(0.0)) {
            Reality::NotReal
        } else if real && self.holds_conjugate() {
            Reality::Real
        } else {
            Reality::Undecided
        };
        let value = enclosure.iter().map(ComplexInterval::midpoint).collect();
        Certificate { value, enclosure, reality }
    }

    /// Whether the conjugate of the small box lies in the large one.
    fn holds_conjugate(&self) -> bool {
        let parts = self.centre.iter().zip(&self.small).zip(&self.large);
        parts.into_iter().all(|((c, small), &large)| {
            // Imaginary parts relative to the centre: -(c + d) - c.
            let centre = Interval::point(c.im.high).plus(Interval::point(c.im.low));
            let conjugate = centre.plus(centre).plus(small.im).negated();
            symmetric(large).contains_in_interior(conjugate) && symmetric(large).contains_in_interior(small.re)
        })
    }

    /// The small box of `other` relative to the centre of `self`.
    pub(super) fn relative(&self, other: &Proof) -> impl Iterator<Item = ComplexInterval> {
        self.centre.iter().zip(&other.centre).zip(&other.small).map(|((a, b), small)| {
            let difference = ComplexBall::sub(&ComplexBall::point(b), &ComplexBall::point(a)).interval();
            ComplexInterval::add(&difference, small)
        })
    }

    /// Whether the solution of `other`, in its small box, lies in the large box and so is the same.
    pub(super) fn holds(&self, other: &Proof) -> bool {
        let large = self.large.iter().map(|&r| symmetric(r));
        large.zip(self.relative(other)).all(|(l, z)| l.contains_in_interior(z.re) && l.contains_in_interior(z.im))
    }

    /// Whether the small boxes have a point in common.
    pub(super) fn meets(&self, other: &Proof) -> bool {
        self.small.iter().zip(self.relative(other)).all(|(a, b)| a.meets(&b))
    }
}

/// Whether no coordinate differs by more than a share of its size, which counts as at least 1e-4 of the largest
/// coordinate or of one.
fn within(point: &[Complex64], solution: &[Complex64], share: f64) -> bool {
    let floor = 1e-4 * solution.iter().map(|z| z.norm()).fold(1.0, f64::max);
    point.iter().zip(solution).all(|(a, b)| (a - b).norm() <= share * b.norm().max(floor))
}

/// The largest of all for each.
fn level(weights: Vec<f64>) -> Vec<f64> {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    vec![largest; weights.len()]
}

/// Twice the distance of neighbouring doubles of the size of the larger part.
fn spacing(z: Complex64) -> f64 {
    let size = z.re.abs().max(z.im.abs());
    2.0 * (size.next_up() - size)
}

fn symmetric(r: f64) -> Interval {
    Interval { low: -r, high: r }
}

/// The box `centre + offset`, rounded outward.
fn shifted(centre: &ComplexDd, offset: &ComplexInterval) -> ComplexInterval {
    let part = |high: f64, low: f64, d: Interval| Interval::point(high).plus(Interval::point(low).plus(d));
    ComplexInterval {
        re: part(centre.re.high, centre.re.low, offset.re),
        im: part(centre.im.high, centre.im.low, offset.im),
    }
}

/// The smallest box that contains the box and zero.
fn with_zero(a: &ComplexInterval) -> ComplexInterval {
    let part = |a: Interval| Interval { low: a.low.min(0.0), high: a.high.max(0.0) };
    ComplexInterval { re: part(a.re), im: part(a.im) }
}

/// What both contain; both contain the solution, so there is something.
fn intersection(a: &ComplexInterval, b: &ComplexInterval) -> ComplexInterval {
    let both = |a: Interval, b: Interval| Interval { low: a.low.max(b.low), high: a.high.min(b.high) };
    ComplexInterval { re: both(a.re, b.re), im: both(a.im, b.im) }
}
