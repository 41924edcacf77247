//! Newton's method with residuals in double-double: a solution to the last bit that double precision can hold.

use crate::distinct::relative_distance;
use crate::linalg::Lu;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{ComplexDd, Evaluate};

/// What refinement tells of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The refined point.
    pub point: Vec<Complex64>,
    /// Relative size of the last correction, about the relative error of the point.
    pub accuracy: f64,
    /// Largest residual, each relative to the sum of its row of the Jacobian times the point.
    pub residual: f64,
    /// Condition number of the Jacobian, rows scaled to equal size, unknowns measured by their own size; infinite if singular.
    pub condition: f64,
}

/// Refines solutions of `F(x; p) = 0`; keeps its memory from call to call.
pub struct Refiner<'a, E: Evaluate> {
    system: &'a E,
    memory: E::Memory<Complex64>,
    precise: E::Memory<ComplexDd>,
    values: Vec<Complex64>,
    jacobian: Vec<Complex64>,
    lu: Lu<Complex64>,
}

/// Iterations at most; quadratic convergence from a tracked end point needs two.
const MAX_ITERATIONS: usize = 6;

impl<'a, E: Evaluate> Refiner<'a, E> {
    /// For a square system.
    pub fn new(system: &'a E) -> Self {
        let n = system.variables();
        let zero = Complex64::new(0.0, 0.0);
        Refiner {
            system,
            memory: system.memory(Isa::Portable),
            precise: system.memory(Isa::detect()),
            values: vec![zero; n],
            jacobian: vec![zero; n * n],
            lu: Lu::new(n, Isa::Portable),
        }
    }

    /// Newton's method from `point` for the parameters `p` until corrections no longer shrink.
    pub fn refine(&mut self, p: &[Complex64], point: &[Complex64]) -> Refined {
        let n = self.system.variables();
        let precise_p: Vec<ComplexDd> = p.iter().map(|&z| z.into()).collect();
        let mut precise_values = vec![ComplexDd::from(Complex64::new(0.0, 0.0)); n];
        let mut x = point.to_vec();
        let mut accuracy = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            self.system.jacobian(&mut self.memory, &x, p, &mut self.values, &mut self.jacobian);
            let precise_x: Vec<ComplexDd> = x.iter().map(|&z| z.into()).collect();
            self.system.values(&mut self.precise, &precise_x, &precise_p, &mut precise_values);
            self.values.iter_mut().zip(&precise_values).for_each(|(d, s)| *d = Complex64::from(*s));
            self.lu.factor(&self.jacobian, &weights(&x));
            self.lu.solve(&mut self.values);
            let next: Vec<Complex64> = x.iter().zip(&self.values).map(|(x, d)| x - d).collect();
            let size = relative_distance(&x, &next);
            if size.is_nan() || size >= accuracy {
                break;
            }
            accuracy = size;
            x = next;
            if accuracy <= f64::EPSILON {
                break;
            }
        }
        let (residual, condition) = self.judge(p, &x);
        Refined { point: x, accuracy, residual, condition }
    }

    fn judge(&mut self, p: &[Complex64], x: &[Complex64]) -> (f64, f64) {
        let n = x.len();
        self.system.jacobian(&mut self.memory, x, p, &mut self.values, &mut self.jacobian);
        let residual = (0..n)
            .map(|i| {
                let scale: f64 = (0..n).map(|j| (self.jacobian[j * n + i] * x[j]).norm()).sum();
                self.values[i].norm() / scale.max(f64::MIN_POSITIVE)
            })
            .fold(0.0, f64::max);
        let squares = weights(x);
        self.lu.factor(&self.jacobian, &squares);
        let weights: Vec<f64> = squares.iter().map(|w| w[0].sqrt()).collect();
        (residual, self.lu.condition(&self.jacobian, &weights))
    }
}

/// Squared sizes of the coordinates, none below 1e-4 of the largest.
fn weights(x: &[Complex64]) -> Vec<[f64; 1]> {
    let largest = x.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    let floor = if largest > 0.0 { 1e-8 * largest } else { 1.0 };
    x.iter().map(|z| [z.norm_sqr().max(floor)]).collect()
}
