//! Newton's method for one point after the other.

use super::polished::Polished;
use super::refined::Refined;
use super::sizes::{sizes, weights};
use crate::inverse;
use crate::linalg::{Estimate, Lu};
use crate::random::{Random, Stream};
use crate::tolerances::refinement;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{ComplexDd, Evaluate, Scalar};

/// Refines solutions of `F(x; p) = 0`. It keeps its memory from call to call.
pub struct Refiner<'a, E: Evaluate> {
    system: &'a E,
    memory: E::Memory<Complex64>,
    precise: E::Memory<ComplexDd>,
    precise_x: Vec<ComplexDd>,
    rounded_p: Vec<Complex64>,
    precise_values: Vec<ComplexDd>,
    pub(super) values: Vec<Complex64>,
    pub(super) jacobian: Vec<Complex64>,
    pub(super) lu: Lu<Complex64>,
    /// The parameters in double-double.
    exact_p: Vec<ComplexDd>,
    next: Vec<Complex64>,
    /// Squared sizes of unknowns.
    pub(super) squares: Vec<[f64; 1]>,
    scales: Vec<f64>,
    estimate: Estimate,
    /// The random changes of the parameters, one draw after the other.
    changes: Vec<Complex64>,
    /// A result that callers may use for a while.
    pub(crate) spare: Refined,
}

impl<'a, E: Evaluate> Refiner<'a, E> {
    /// A refiner for a square system.
    pub fn new(system: &'a E) -> Self {
        let (n, m) = (system.variables(), system.parameters());
        let zero = Complex64::new(0.0, 0.0);
        Refiner {
            system,
            memory: system.memory(Isa::Portable),
            precise: system.memory(Isa::detect()),
            precise_x: Vec::with_capacity(n),
            rounded_p: Vec::with_capacity(m),
            precise_values: vec![zero.into(); n],
            values: vec![zero; n],
            jacobian: vec![zero; n * n],
            lu: Lu::new(n, Isa::Portable),
            exact_p: Vec::with_capacity(m),
            next: Vec::with_capacity(n),
            squares: Vec::with_capacity(n),
            scales: Vec::with_capacity(n),
            estimate: Estimate::with_capacity(n),
            changes: Vec::new(),
            spare: Refined { point: Vec::with_capacity(n), ..Refined::default() },
        }
    }

    /// Newton's method from `point` for the parameters `p` until corrections no longer shrink.
    pub fn refine(&mut self, p: &[Complex64], point: &[Complex64]) -> Refined {
        let mut refined = Refined::default();
        self.refine_into(p, point, &mut refined);
        refined
    }

    /// [`refine`](Self::refine), with the memory of an earlier result.
    pub fn refine_into(&mut self, p: &[Complex64], point: &[Complex64], refined: &mut Refined) {
        let exact = self.exact(p);
        refined.point.clear();
        refined.point.extend_from_slice(point);
        let x = &mut refined.point;
        let polished = self.polish(&exact, x);
        self.exact_p = exact;
        let serves = polished.serves();
        let mut judged = self.judge(p, x, serves);
        if serves && !polished.is_unmoved(judged.1) {
            judged = self.judge(p, x, false);
        }
        polished.tell(judged, refined);
    }

    /// Parameters in double-double, in memory to be given back.
    fn exact(&mut self, p: &[Complex64]) -> Vec<ComplexDd> {
        let mut exact = std::mem::take(&mut self.exact_p);
        exact.clear();
        exact.extend(p.iter().map(|&z| ComplexDd::from(z)));
        exact
    }

    /// Refines in place, for parameters in double-double. Returns the relative size of the last
    /// correction, and, if asked for, how far rounding the parameters to double precision would move the
    /// point. This distance is absolute, to first order, for random roundings, and infinite where the
    /// Jacobian is singular.
    pub(crate) fn polish_and_blur(&mut self, p: &[ComplexDd], x: &mut [Complex64], blurs: bool) -> (f64, Vec<f64>) {
        let polished = self.polish(p, x);
        let blur = if blurs { self.blur(p, x, polished.serves()) } else { Vec::new() };
        (polished.accuracy, blur)
    }

    /// Corrects a point until corrections no longer shrink. If it is steady, and if the last correction is
    /// at most `refinement::NEAR`, the Jacobian and its factors are
    /// left, at a point as far from the result as it has moved since.
    fn polish(&mut self, p: &[ComplexDd], x: &mut [Complex64]) -> Polished {
        let mut polished = Polished::BEGUN;
        // Whether the last Jacobian serves for this correction.
        let mut serves = false;
        for _ in 0..refinement::ITERATIONS {
            if !serves {
                weights(x, &mut self.squares);
                self.factor(p, x);
                polished.moved = 0.0;
            }
            self.correction(p, x);
            self.next.clear();
            self.next.extend(x.iter().zip(&self.values).map(|(x, d)| x - d));
            sizes(&self.next, &mut self.squares);
            let relative = self.values.iter().zip(&self.squares).map(|(d, s)| (d.norm_sqr() / s[0]).sqrt());
            // Once NaN, always NaN.
            let size = relative.fold(0.0, |m: f64, d| if d <= m || m.is_nan() { m } else { d });
            if !polished.shrinks(size, serves) {
                if !serves {
                    break;
                }
                serves = false;
                continue;
            }
            x.copy_from_slice(&self.next);
            if polished.accuracy <= f64::EPSILON {
                break;
            }
            serves = polished.accuracy <= refinement::NEAR;
        }
        polished
    }

    /// Whether a refined point is a regular solution: either [clearly](Refined::plain), or by the
    /// test of [`contracts`](Self::contracts).
    pub fn is_regular(&mut self, p: &[Complex64], refined: &Refined) -> bool {
        refined.plain || self.contracts(p, &refined.point)
    }

    /// Whether Newton's method returns to the solution `x` from a point 1e-8 or 1e-6 away
    /// (relative). It does not where the Jacobian is singular. One of the two is enough, because
    /// the first may drown in rounding errors, and the second may meet other solutions.
    pub fn contracts(&mut self, p: &[Complex64], x: &[Complex64]) -> bool {
        let exact = self.exact(p);
        let contracts = refinement::PERTURBATIONS.iter().any(|&perturbation| self.comes_back(&exact, x, perturbation));
        self.exact_p = exact;
        contracts
    }

    fn comes_back(&mut self, p: &[ComplexDd], x: &[Complex64], perturbation: f64) -> bool {
        let mut random = Random::of(0, Stream::Perturbation);
        let mut y = std::mem::take(&mut self.next);
        y.clear();
        sizes(x, &mut self.squares);
        y.extend(x.iter().zip(&self.squares).map(|(x, w)| x + random.unit() * (perturbation * w[0].sqrt())));
        for _ in 0..2 {
            self.factor(p, &y);
            self.correction(p, &y);
            for (y, d) in y.iter_mut().zip(&self.values) {
                *y -= d;
            }
        }
        let mut distances = y.iter().zip(x).zip(&self.squares).map(|((y, x), w)| (y - x).norm() / w[0].sqrt());
        let comes_back = distances.all(|d| d <= refinement::RETURNED * perturbation);
        self.next = y;
        comes_back
    }

    /// The test of [`contracts`](Self::contracts) with points and Jacobians in double-double, from
    /// a point 1e-14 or 1e-12 away. It recognises regular solutions whose Jacobians are singular as
    /// far as doubles can tell, for instance where nodes of a network nearly coincide. The
    /// parameters are taken as exact: if rounding them has split a singular solution into two,
    /// these count as regular. Slow, and allocates.
    pub fn contracts_precisely(&mut self, p: &[Complex64], x: &[Complex64]) -> bool {
        let exact = self.exact(p);
        let mut centre: Vec<ComplexDd> = x.iter().map(|&z| z.into()).collect();
        let mut scratch = vec![ComplexDd::zero(); 2 * x.len() * x.len()];
        self.newton_precisely(&exact, &mut centre, &mut scratch);
        sizes(x, &mut self.squares);
        let sizes: Vec<f64> = self.squares.iter().map(|w| w[0].sqrt()).collect();
        let within = |a: &ComplexDd, b: &ComplexDd, limit: f64| ComplexDd::sub(a, b).high().norm() <= limit;
        // Written so that NaN is not near.
        let stays = x.iter().zip(&centre).zip(&sizes).all(|((x, z), w)| within(&(*x).into(), z, refinement::NEAR * w));
        let contracts = stays
            && refinement::PRECISE_PERTURBATIONS.iter().any(|&distance| {
                let mut random = Random::of(0, Stream::Perturbation);
                let away = |(z, w): (&ComplexDd, &f64)| ComplexDd::add(z, &(random.unit() * (distance * w)).into());
                let mut y: Vec<ComplexDd> = centre.iter().zip(&sizes).map(away).collect();
                self.newton_precisely(&exact, &mut y, &mut scratch);
                y.iter().zip(&centre).zip(&sizes).all(|((y, z), w)| within(y, z, refinement::RETURNED * distance * w))
            });
        self.exact_p = exact;
        contracts
    }

    /// Two corrections of a point, with Jacobians in double-double; not finite where they are
    /// singular. `scratch` holds two of them.
    fn newton_precisely(&mut self, p: &[ComplexDd], x: &mut [ComplexDd], scratch: &mut [ComplexDd]) {
        let n = x.len();
        let (jacobian, inverse) = scratch.split_at_mut(n * n);
        for _ in 0..2 {
            self.system.jacobian(&mut self.precise, x, p, &mut self.precise_values, jacobian);
            inverse::invert(n, jacobian, inverse);
            let step = inverse::product(n, inverse, &self.precise_values);
            for (x, d) in x.iter_mut().zip(&step) {
                *x = ComplexDd::sub(x, d);
            }
        }
    }

    /// How far rounding the parameters would move a point; `factored` says that the Jacobian is factored.
    pub(crate) fn blur(&mut self, p: &[ComplexDd], x: &[Complex64], factored: bool) -> Vec<f64> {
        if !factored {
            weights(x, &mut self.squares);
            self.factor(p, x);
        }
        if self.changes.is_empty() {
            let mut random = Random::of(0, Stream::Rounding);
            self.changes
                .extend((0..refinement::BLUR_DRAWS * p.len()).map(|_| 1.0 + refinement::BLUR_STEP * random.unit()));
        }
        let mut blur = vec![0.0; x.len()];
        for changes in self.changes.chunks_exact(p.len().max(1)) {
            for ((r, p), change) in self.rounded_p.iter_mut().zip(p).zip(changes) {
                *r = p.high() * change;
            }
            self.system.values(&mut self.memory, x, &self.rounded_p, &mut self.values);
            self.lu.solve(&mut self.values);
            for (blur, d) in blur.iter_mut().zip(&self.values) {
                let moved = d.norm_sqr().sqrt() * (f64::EPSILON / refinement::BLUR_STEP);
                *blur = if moved.is_nan() { f64::INFINITY } else { moved.max(*blur) };
            }
        }
        blur
    }

    /// Residual and condition of a point, without refining it.
    pub fn judged(&mut self, p: &[Complex64], x: &[Complex64]) -> Refined {
        let (residual, condition, _) = self.judge(p, x, false);
        Refined { point: x.to_vec(), accuracy: f64::INFINITY, plain: false, residual, condition }
    }

    /// Leaves the factors of the Jacobian at `x`, unknowns weighted by `squares`.
    fn factor(&mut self, p: &[ComplexDd], x: &[Complex64]) {
        self.rounded_p.clear();
        self.rounded_p.extend(p.iter().map(ComplexDd::high));
        self.system.jacobian(&mut self.memory, x, &self.rounded_p, &mut self.values, &mut self.jacobian);
        self.lu.factor(&self.jacobian, &self.squares);
    }

    /// Leaves in `values` the correction of Newton's method at `x`, with the Jacobian that is
    /// factored.
    fn correction(&mut self, p: &[ComplexDd], x: &[Complex64]) {
        self.precise_x.clear();
        self.precise_x.extend(x.iter().map(|&z| ComplexDd::from(z)));
        self.system.values(&mut self.precise, &self.precise_x, p, &mut self.precise_values);
        for (d, s) in self.values.iter_mut().zip(&self.precise_values) {
            *d = Complex64::from(*s);
        }
        self.lu.solve(&mut self.values);
    }

    /// A refined point to about 30 digits, for sums in which large coordinates cancel. The point is
    /// corrected in double-double with the Jacobian at its double part.
    pub fn extend(&mut self, p: &[Complex64], point: &[Complex64]) -> Vec<ComplexDd> {
        let n = self.system.variables();
        let precise_p: Vec<ComplexDd> = p.iter().map(|&z| z.into()).collect();
        let mut values = vec![ComplexDd::from(Complex64::new(0.0, 0.0)); n];
        let mut x: Vec<ComplexDd> = point.iter().map(|&z| z.into()).collect();
        self.system.jacobian(&mut self.memory, point, p, &mut self.values, &mut self.jacobian);
        weights(point, &mut self.squares);
        self.lu.factor(&self.jacobian, &self.squares);
        for _ in 0..refinement::EXTENSIONS {
            self.system.values(&mut self.precise, &x, &precise_p, &mut values);
            for (d, s) in self.values.iter_mut().zip(&values) {
                *d = Complex64::from(*s);
            }
            self.lu.solve(&mut self.values);
            for (x, d) in x.iter_mut().zip(&self.values) {
                *x = Scalar::sub(x, &(*d).into());
            }
        }
        x
    }

    /// Residual, condition and smallest row of the Jacobian, relative to the largest or to one, at
    /// `x`; `factored` says that the Jacobian and its factors are those of `x` already.
    fn judge(&mut self, p: &[Complex64], x: &[Complex64], factored: bool) -> (f64, f64, f64) {
        sizes(x, &mut self.squares);
        if factored {
            self.system.values(&mut self.memory, x, p, &mut self.values);
        } else {
            self.system.jacobian(&mut self.memory, x, p, &mut self.values, &mut self.jacobian);
            self.lu.factor(&self.jacobian, &self.squares);
        }
        self.judge_values()
    }

    /// [`judge`](Self::judge) from the values and sizes at a point, and the Jacobian and its factors.
    pub(super) fn judge_values(&mut self) -> (f64, f64, f64) {
        let n = self.squares.len();
        // Sizes of the rows.
        let scales = &mut self.scales;
        scales.clear();
        scales.resize(n, 0.0);
        for (column, w) in self.jacobian.chunks_exact(n.max(1)).zip(&self.squares) {
            for (scale, z) in scales.iter_mut().zip(column) {
                *scale += z.norm_sqr().sqrt() * w[0].sqrt();
            }
        }
        let relative = self
            .values
            .iter()
            .zip(&*scales)
            .map(|(value, scale)| value.norm_sqr().sqrt() / scale.max(f64::MIN_POSITIVE));
        let residual = relative.fold(0.0, f64::max);
        let (least, largest) = scales.iter().fold((f64::INFINITY, 1.0f64), |(l, g), s| (l.min(*s), g.max(*s)));
        (residual, self.lu.condition(&self.jacobian, &self.squares, &mut self.estimate), least / largest)
    }
}
