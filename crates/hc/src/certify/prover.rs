//! From a point to a proof: refinement, approximate inverse and weights, in doubles and then in
//! double-double.

use super::certificate::{CertifyOptions, Obstacle};
use super::krawczyk::{Krawczyk, Place};
use super::proof::Proof;
use crate::inverse;
use crate::linalg::Lu;
use crate::tolerances::proofs;
use num_complex::Complex64;
use poly::{ComplexBall, ComplexDd, ComplexInterval, Evaluate, Interpreter, Isa, Scalar};

/// What all points have in common.
pub(super) struct Target<'a> {
    pub(super) system: &'a Interpreter,
    pub(super) parameters: &'a [ComplexInterval],
}

/// The arithmetic of Jacobians and their inverses; points and values are always in double-double.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Arithmetic {
    Double,
    DoubleDouble,
}

impl Arithmetic {
    fn rounding(self) -> f64 {
        match self {
            Arithmetic::Double => f64::EPSILON,
            Arithmetic::DoubleDouble => f64::EPSILON * f64::EPSILON,
        }
    }
}

/// Scratch space for one point at a time.
pub(super) struct Prover<'a> {
    target: &'a Target<'a>,
    options: &'a CertifyOptions,
    n: usize,
    precision: Arithmetic,
    parameters: Vec<Complex64>,
    precise_parameters: Vec<ComplexDd>,
    ball_parameters: Vec<ComplexBall>,
    plain: <Interpreter as Evaluate>::Memory<Complex64>,
    precise: <Interpreter as Evaluate>::Memory<ComplexDd>,
    balls: <Interpreter as Evaluate>::Memory<ComplexBall>,
    fast: Krawczyk<'a, ComplexInterval>,
    exact: Krawczyk<'a, ComplexBall>,
    values: Vec<Complex64>,
    precise_values: Vec<ComplexDd>,
    /// Column-major; the low parts are zero in double precision, here and in the inverse.
    jacobian: Vec<ComplexDd>,
    plain_jacobian: Vec<Complex64>,
    lu: Lu<Complex64>,
    /// Column-major approximate inverse of the Jacobian.
    inverse: Vec<ComplexDd>,
    residuals: Vec<ComplexBall>,
}

impl<'a> Prover<'a> {
    pub(super) fn new(target: &'a Target<'a>, options: &'a CertifyOptions) -> Self {
        let (system, n) = (target.system, target.system.variables());
        let zero = Complex64::new(0.0, 0.0);
        let parameters: Vec<Complex64> = target.parameters.iter().map(ComplexInterval::midpoint).collect();
        Prover {
            target,
            options,
            n,
            precision: Arithmetic::Double,
            precise_parameters: parameters.iter().map(|&p| p.into()).collect(),
            parameters,
            ball_parameters: target.parameters.iter().map(ComplexBall::containing).collect(),
            plain: system.memory(Isa::Portable),
            // Fused products are instructions there, not library calls.
            precise: system.memory(Isa::detect()),
            balls: system.memory(Isa::detect()),
            fast: Krawczyk::new(system, target.parameters, Isa::Portable),
            exact: Krawczyk::new(system, target.parameters, Isa::detect()),
            values: vec![zero; n],
            precise_values: vec![ComplexDd::zero(); n],
            jacobian: vec![ComplexDd::zero(); n * n],
            plain_jacobian: vec![zero; n * n],
            lu: Lu::new(n, Isa::Portable),
            inverse: vec![ComplexDd::zero(); n * n],
            residuals: vec![ComplexBall::zero(); n],
        }
    }

    pub(super) fn prove(&mut self, point: &[Complex64]) -> Result<Proof, Obstacle> {
        if !point.iter().all(|z| z.is_finite()) {
            return Err(Obstacle::NotFinite);
        }
        let mut first = None;
        for precision in [Arithmetic::Double, Arithmetic::DoubleDouble] {
            self.precision = precision;
            // Once more with all unknowns of one size: beside zeros, tiny coordinates say nothing
            // of the scale of their unknowns.
            for scale in [|weights| weights, level] {
                match self.attempt(point, scale) {
                    Ok(proof) => return Ok(proof),
                    Err(obstacle) => first = first.or(Some(obstacle)),
                }
            }
        }
        Err(first.unwrap_or(Obstacle::NoContraction))
    }

    /// A proof with weights of the unknowns that `scale` makes from those of the system.
    fn attempt(&mut self, point: &[Complex64], scale: fn(Vec<f64>) -> Vec<f64>) -> Result<Proof, Obstacle> {
        let precise_point: Vec<ComplexDd> = point.iter().map(|&z| z.into()).collect();
        self.invert(&precise_point)?;
        let first_weights = scale(self.weights(point));
        let centre = self.refine(precise_point, &first_weights)?;
        let rounded: Vec<Complex64> = centre.iter().map(ComplexDd::high).collect();
        if !within(point, &rounded, self.options.reach) {
            return Err(Obstacle::Away);
        }
        self.invert(&centre)?;
        // At a solution with coordinates zero, the refined point says nothing of their scale, the
        // point given does.
        let weights: Vec<f64> = self.weights(&rounded).iter().zip(&first_weights).map(|(a, b)| a.max(*b)).collect();
        let weights = scale(self.levelled(weights));
        self.evaluate_residuals(&centre);
        let Prover { fast, exact, inverse, residuals, .. } = self;
        let place = Place { centre: &centre, inverse, residuals, weights: &weights };
        let proof = match self.precision {
            Arithmetic::Double => fast.contract(&place, self.options.largest_box),
            Arithmetic::DoubleDouble => exact.contract(&place, self.options.largest_box),
        };
        proof.ok_or(Obstacle::NoContraction)
    }

    /// Newton's method in double-double until corrections no longer shrink.
    fn refine(&mut self, mut centre: Vec<ComplexDd>, weights: &[f64]) -> Result<Vec<ComplexDd>, Obstacle> {
        let n = self.n;
        let mut last = f64::INFINITY;
        for count in 0..proofs::NEWTON_STEPS {
            self.invert(&centre)?;
            self.evaluate_residuals(&centre);
            let residuals: Vec<ComplexDd> =
                self.residuals.iter().map(|r| ComplexDd { re: r.re.mid, im: r.im.mid }).collect();
            let step = inverse::product(n, &self.inverse, &residuals);
            let size = step.iter().zip(weights).map(|(d, w)| d.high().norm() / w).fold(0.0, f64::max);
            if count == 1 && size > proofs::CONTRACTION * last && last > proofs::ROUNDING {
                return Err(Obstacle::NoContraction);
            }
            if size.is_nan() || size >= last {
                break;
            }
            for (c, d) in centre.iter_mut().zip(&step) {
                *c = ComplexDd::sub(c, d);
            }
            last = size;
        }
        Ok(centre)
    }

    /// The Jacobian at a point and its approximate inverse, through a matrix with rows and columns
    /// of equal size.
    fn invert(&mut self, x: &[ComplexDd]) -> Result<(), Obstacle> {
        let n = self.n;
        let Prover { target, parameters, plain, values, plain_jacobian, jacobian, lu, inverse, .. } = self;
        match self.precision {
            Arithmetic::Double => {
                let rounded: Vec<Complex64> = x.iter().map(ComplexDd::high).collect();
                target.system.jacobian(plain, &rounded, parameters, values, plain_jacobian);
                for (a, &b) in jacobian.iter_mut().zip(plain_jacobian.iter()) {
                    *a = b.into();
                }
                let (rows, columns) = inverse::sizes(n, jacobian);
                let scaled: Vec<Complex64> =
                    (0..n * n).map(|entry| plain_jacobian[entry] / rows[entry % n] / columns[entry / n]).collect();
                lu.factor(&scaled, &vec![[1.0]; n]);
                let mut column = vec![Complex64::new(0.0, 0.0); n];
                for (k, inverse) in inverse.chunks_mut(n).enumerate() {
                    column.fill(Complex64::new(0.0, 0.0));
                    column[k] = Complex64::new(1.0, 0.0);
                    lu.solve(&mut column);
                    let unscaled = column.iter().zip(&columns).map(|(z, size)| *z / rows[k] / size);
                    for (entry, z) in inverse.iter_mut().zip(unscaled) {
                        *entry = z.into();
                    }
                }
            }
            Arithmetic::DoubleDouble => {
                let (memory, values) = (&mut self.precise, &mut self.precise_values);
                target.system.jacobian(memory, x, &self.precise_parameters, values, jacobian);
                inverse::invert(n, jacobian, inverse);
            }
        }
        if inverse.iter().all(|z| z.high().is_finite()) { Ok(()) } else { Err(Obstacle::Singular) }
    }

    /// `|C| |J| |x|`: the effect of relative changes of the terms on each unknown. Unknowns for
    /// which this is zero, as at the origin, count as of size one.
    fn weights(&self, x: &[Complex64]) -> Vec<f64> {
        let n = self.n;
        let (jacobian, inverse) =
            (|entry: usize| self.jacobian[entry].high().norm(), |entry: usize| self.inverse[entry].high().norm());
        let product = |x: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let rows: Vec<f64> = (0..n).map(|k| (0..n).map(|j| jacobian(j * n + k) * x(j)).sum()).collect();
            (0..n).map(|i| (0..n).map(|k| inverse(k * n + i) * rows[k]).sum()).collect()
        };
        let weights = product(&|j| x[j].norm());
        if weights.iter().all(|&w| w > 0.0) {
            return weights;
        }
        let unit = product(&|_| 1.0);
        weights.iter().zip(unit).map(|(&w, u)| if w > 0.0 { w } else { u }).collect()
    }

    /// Weights, raised so far that they cover what the errors of the inverse, `|I - C J|` and the
    /// rounding of that, carry over from other unknowns.
    fn levelled(&self, mut weights: Vec<f64>) -> Vec<f64> {
        let n = self.n;
        let error = |i: usize, j: usize| {
            let one = if i == j { ComplexDd::one() } else { ComplexDd::zero() };
            let factors = (0..n).map(|k| (&self.inverse[k * n + i], &self.jacobian[j * n + k]));
            let (rest, size) = factors.fold((one, 0.0), |(rest, size), (c, a)| {
                (ComplexDd::sub_mul(c, a, &rest), size + c.high().norm() * a.high().norm())
            });
            rest.high().norm() + self.precision.rounding() * size
        };
        let errors: Vec<f64> = (0..n * n).map(|entry| error(entry / n, entry % n)).collect();
        for _ in 0..2 {
            let carried: Vec<f64> =
                errors.chunks(n).map(|row| row.iter().zip(&weights).map(|(e, w)| e * w).sum::<f64>()).collect();
            for (w, c) in weights.iter_mut().zip(carried) {
                *w = w.max(proofs::LEVEL * c);
            }
        }
        weights
    }

    fn evaluate_residuals(&mut self, centre: &[ComplexDd]) {
        let balls: Vec<ComplexBall> = centre.iter().map(ComplexBall::point).collect();
        self.target.system.values(&mut self.balls, &balls, &self.ball_parameters, &mut self.residuals);
    }
}

/// Whether no coordinate differs by more than a share of its size. The size counts as at least 1e-4
/// of the largest coordinate or of one.
fn within(point: &[Complex64], solution: &[Complex64], share: f64) -> bool {
    let floor = 1e-4 * solution.iter().map(|z| z.norm()).fold(1.0, f64::max);
    point.iter().zip(solution).all(|(a, b)| (a - b).norm() <= share * b.norm().max(floor))
}

/// The largest of all weights, for each unknown.
fn level(weights: Vec<f64>) -> Vec<f64> {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    vec![largest; weights.len()]
}
