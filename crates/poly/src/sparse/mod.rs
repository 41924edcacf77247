//! Systems given by supports, with the coefficients as parameters: the kernel of polyhedral stages.
//!
//! The monomials of an equation are kept as a tree of shared prefixes whose edges are powers of
//! unknowns. One sweep from the leaves to the root gives the value by Horner's rule. It also gives,
//! kept apart by edge, the derivatives by those powers: Speelpenning's trick for the gradient of a
//! product, extended from chains to trees.

mod error;
mod plan;
#[cfg(test)]
mod tests;

pub use error::SupportError;

use crate::evaluate::Evaluate;
use crate::polynomial::{Polynomial, Ring};
use crate::program::generated::TaylorMemory;
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};
use plan::{NONE, Plan, Power, Row, Step};
use std::ops::Range;
use std::sync::Arc;

/// A system of sparse (Laurent) polynomials with fixed supports; its parameters are the
/// coefficients.
///
/// Parameter `k` is the coefficient of term `k`. Terms are numbered equation after equation, in the
/// order of the supports. The system is cheap to clone.
///
/// ```
/// use poly::{Complex64, Evaluate, Isa, SparseSystem};
/// // c0*x^2*y + c1 and c2*x + c3*y^-1
/// let system = SparseSystem::new(2, &[vec![vec![2, 1], vec![0, 0]], vec![vec![1, 0], vec![0, -1]]])?;
/// let real = |x: f64| Complex64::new(x, 0.0);
/// let (x, c) = ([3.0, 0.5].map(real), [2.0, -1.0, 1.0, 4.0].map(real));
/// let mut values = [real(0.0); 2];
/// system.values(&mut system.memory(Isa::detect()), &x, &c, &mut values);
/// assert_eq!(values, [real(8.0), real(11.0)]);
/// # Ok::<(), poly::SupportError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SparseSystem {
    plan: Arc<Plan>,
}

/// Scratch space of a [`SparseSystem`].
#[derive(Clone, Debug)]
pub struct SparseMemory<S> {
    isa: Isa,
    /// Powers of unknowns; the first ones are the unknowns themselves.
    powers: Vec<S>,
    /// Values of prefixes.
    prefixes: Vec<S>,
    /// What each node of a row's tree is multiplied with in the row.
    sums: Vec<S>,
    /// Derivative of a row by each power.
    slopes: Vec<S>,
    taylor: TaylorMemory<S>,
}

impl SparseSystem {
    /// The system with one equation for each support. A support has one exponent vector for each
    /// term.
    ///
    /// # Errors
    /// If an exponent vector has the wrong length or occurs twice in an equation.
    pub fn new(variables: usize, supports: &[Vec<Vec<i32>>]) -> Result<SparseSystem, SupportError> {
        Ok(SparseSystem { plan: Arc::new(Plan::new(variables, supports)?) })
    }

    /// The system with the supports of these polynomials, and their coefficients in the order of
    /// the parameters.
    ///
    /// # Errors
    /// If the polynomials have different numbers of unknowns, or an exponent is -2^31.
    pub fn from_polynomials<R: Ring>(polynomials: &[Polynomial<R>]) -> Result<(SparseSystem, Vec<R>), SupportError> {
        let variables = polynomials.first().map_or(0, Polynomial::variables);
        let supports: Vec<Vec<Vec<i32>>> = polynomials.iter().map(Polynomial::support).collect();
        let terms = polynomials.iter().flat_map(Polynomial::terms);
        let coefficients = terms.map(|(_, c)| c.clone()).collect();
        Ok((SparseSystem::new(variables, &supports)?, coefficients))
    }

    /// The range of the parameters that are the coefficients of an equation.
    ///
    /// # Panics
    /// If there is no such equation.
    pub fn coefficients(&self, equation: usize) -> Range<usize> {
        self.plan.rows[equation].terms.clone()
    }
}

impl Evaluate for SparseSystem {
    type Memory<S: Scalar> = SparseMemory<S>;

    fn equations(&self) -> usize {
        self.plan.rows.len()
    }
    fn variables(&self) -> usize {
        self.plan.variables
    }
    fn parameters(&self) -> usize {
        self.plan.terms
    }

    fn memory<S: Scalar>(&self, isa: Isa) -> SparseMemory<S> {
        let plan = &*self.plan;
        let zeros = |count: usize| vec![S::zero(); count];
        SparseMemory {
            isa,
            powers: zeros(plan.powers.len()),
            prefixes: zeros(plan.nodes.len()),
            sums: zeros(plan.nodes.len()),
            slopes: zeros(plan.powers.len()),
            taylor: plan.taylor.memory(isa, &[]),
        }
    }

    fn values<S: Scalar>(&self, memory: &mut SparseMemory<S>, x: &[S], p: &[S], values: &mut [S]) {
        let plan = &*self.plan;
        let (x, p, values) = (&x[..plan.variables], &p[..plan.terms], &mut values[..plan.rows.len()]);
        memory.isa.run(Values { plan, memory, x, p, values });
    }

    fn jacobian<S: Scalar>(
        &self,
        memory: &mut SparseMemory<S>,
        x: &[S],
        p: &[S],
        values: &mut [S],
        jacobian: &mut [S],
    ) {
        let plan = &*self.plan;
        let rows = plan.rows.len();
        let (x, p, values) = (&x[..plan.variables], &p[..plan.terms], &mut values[..rows]);
        let jacobian = &mut jacobian[..rows * plan.variables];
        memory.isa.run(Jacobian { plan, memory, x, p, values, jacobian });
    }

    fn vanishes(&self, row: usize, column: usize) -> bool {
        // Entries are in ascending order.
        self.plan.zeros.binary_search(&((column * self.equations() + row) as u32)).is_ok()
    }

    fn taylor<S: Scalar>(&self, memory: &mut SparseMemory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]) {
        self.plan.taylor.run(memory.isa, &mut memory.taylor, order, x, p, out);
    }
}

/// Fills the table of powers.
#[inline(always)]
fn fill_powers<S: Scalar>(plan: &Plan, powers: &mut [S], x: &[S]) {
    for (k, power) in plan.powers.iter().enumerate() {
        powers[k] = match *power {
            Power::Unknown => x[k].clone(),
            Power::Inverse(a) => S::inv(&powers[a as usize]),
            Power::Square(a) => S::sqr(&powers[a as usize]),
            Power::Product(a, b) => S::mul(&powers[a as usize], &powers[b as usize]),
        };
    }
}

/// What a node of a row's tree is multiplied with: its coefficient, or what its children have
/// summed up.
#[inline(always)]
fn cofactor<'a, S>(step: &Step, sums: &'a [S], p: &'a [S]) -> &'a S {
    if step.coefficient == NONE { &sums[step.node as usize] } else { &p[step.coefficient as usize] }
}

/// Passes a node's cofactor on to its parent, which begins with its own coefficient.
#[inline(always)]
fn pass_up<S: Scalar>(step: &Step, sums: &mut [S], powers: &[S], p: &[S]) {
    let a = cofactor(step, sums, p);
    let power = &powers[step.power as usize];
    let sum = if !step.first {
        S::mul_add(a, power, &sums[step.parent as usize])
    } else if step.parent_coefficient != NONE {
        S::mul_add(a, power, &p[step.parent_coefficient as usize])
    } else {
        S::mul(a, power)
    };
    sums[step.parent as usize] = sum;
}

/// The value of a row after its sweep.
#[inline(always)]
fn row_value<S: Scalar>(row: &Row, sums: &[S], p: &[S]) -> S {
    match (row.steps.is_empty(), row.constant) {
        (false, _) => sums[0].clone(),
        (true, NONE) => S::zero(),
        (true, k) => p[k as usize].clone(),
    }
}

struct Values<'a, S> {
    plan: &'a Plan,
    memory: &'a mut SparseMemory<S>,
    x: &'a [S],
    p: &'a [S],
    values: &'a mut [S],
}

impl<S: Scalar> Kernel for Values<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let Values { plan, memory, x, p, values } = self;
        fill_powers(plan, &mut memory.powers, x);
        for (row, value) in plan.rows.iter().zip(values) {
            for step in &row.steps {
                pass_up(step, &mut memory.sums, &memory.powers, p);
            }
            *value = row_value(row, &memory.sums, p);
        }
    }
}

struct Jacobian<'a, S> {
    plan: &'a Plan,
    memory: &'a mut SparseMemory<S>,
    x: &'a [S],
    p: &'a [S],
    values: &'a mut [S],
    jacobian: &'a mut [S],
}

impl<S: Scalar> Kernel for Jacobian<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let Jacobian { plan, memory, x, p, values, jacobian } = self;
        let SparseMemory { powers, prefixes, sums, slopes, .. } = memory;
        let rows = plan.rows.len();
        fill_powers(plan, powers, x);
        // Node 0 is the root; the value of a prefix of one power is that power.
        for (k, node) in plan.nodes.iter().enumerate().skip(1) {
            prefixes[k] = match node.parent {
                0 => powers[node.power as usize].clone(),
                parent => S::mul(&prefixes[parent as usize], &powers[node.power as usize]),
            };
        }
        for &entry in &plan.zeros {
            jacobian[entry as usize] = S::zero();
        }
        for (i, row) in plan.rows.iter().enumerate() {
            for step in &row.steps {
                let a = cofactor(step, sums, p);
                let slope = match (step.parent, step.first_power) {
                    (0, true) => a.clone(),
                    (0, false) => S::add(&slopes[step.power as usize], a),
                    (parent, true) => S::mul(a, &prefixes[parent as usize]),
                    (parent, false) => S::mul_add(a, &prefixes[parent as usize], &slopes[step.power as usize]),
                };
                slopes[step.power as usize] = slope;
                pass_up(step, sums, powers, p);
            }
            values[i] = row_value(row, sums, p);
            for slope in &row.slopes {
                let by_power = &slopes[slope.power as usize];
                // d(x^e)/dx = e * x^(e-1)
                let term = if slope.exponent == 1 {
                    by_power.clone()
                } else {
                    S::scale(&S::mul(by_power, &powers[slope.lower as usize]), f64::from(slope.exponent))
                };
                let entry = &mut jacobian[slope.unknown as usize * rows + i];
                *entry = if slope.first { term } else { S::add(entry, &term) };
            }
        }
    }
}
