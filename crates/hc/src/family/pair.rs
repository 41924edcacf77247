//! A first solution of a family: one pair of parameters and unknowns.
//!
//! Newton's method runs in unknowns and parameters together, from a random complex point. The
//! equations are underdetermined, so the correction of least length is taken (Gauss-Newton). Where there are more
//! equations than unknowns, the rows of their Jacobian are dependent at the solutions that are sought, and corrections
//! are damped, by the size of the residual (Levenberg-Marquardt; Fan & Yuan 2005, Computing 74:23).

use super::error::FamilyError;
use super::fibre::Fibre;
use super::still::refined;
use crate::linalg::Lu;
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{Evaluate, Interpreter, System};

/// Random points tried before the search is given up.
pub(super) const TRIES: u64 = 1000;
/// Of these, points tried for a solution that parameters move, if one is known that none moves.
pub(super) const MOVING_TRIES: u64 = 100;
const MAX_ITERATIONS: usize = 60;
/// Damping of corrections, in sizes of residual and Jacobian, and the least one in squares of the latter.
const DAMPING: f64 = 1e-2;
const LEAST_DAMPING: f64 = 1e-14;
/// Other first pairs, and how often each is tried to be found; fewer from points of other sizes than one, and with
/// unknowns that are zero.
const PAIRS: u64 = 48;
const FAR_PAIRS: u64 = 8;
const ZERO_PAIRS: u64 = 8;
const FEW_TRIES: u64 = 20;
/// Sizes of the unknowns where Newton's method begins.
const SIZES: [f64; 5] = [1.0, 32.0, 1024.0, 1.0 / 32.0, 1.0 / 1024.0];
/// With more unknowns than this only single ones and all are set to zero; of the sets so many are used.
const MANY_UNKNOWNS: usize = 10;
const MOST_SETS: usize = 16;

/// Where Newton's method begins.
#[derive(Clone, Debug)]
pub(super) struct Beginning {
    /// The size of the unknowns; that of the parameters is one.
    pub(super) size: f64,
    /// Unknowns that are zero.
    pub(super) zero: Vec<usize>,
}

impl Default for Beginning {
    fn default() -> Self {
        Beginning { size: 1.0, zero: Vec::new() }
    }
}

/// What first pairs are sought with.
pub(super) struct Pairs {
    /// As many equations as unknowns.
    compiled: Interpreter,
    /// All equations, with parameters as further unknowns.
    free: Interpreter,
}

impl Pairs {
    /// For a system, and one with as many equations as unknowns that has all its solutions.
    ///
    /// # Errors
    /// If the formulas cannot be compiled.
    pub(super) fn new(system: &System, square: &System) -> Result<Pairs, FamilyError> {
        let free = System::build(|s| {
            let unknowns: Vec<_> = system.variables().iter().map(|name| s.variable(name)).collect();
            let parameters: Vec<_> = system.parameters().iter().map(|name| s.variable(name)).collect();
            system.instantiate(s, &unknowns, &parameters)
        });
        // The names and constants come from a system that exists already.
        let free = free.map_err(|_| FamilyError::NoPair)?;
        Ok(Pairs { compiled: square.compile()?, free: free.compile()? })
    }

    /// A regular solution for some generic parameters that `accept` is content with, from the random point of a seed
    /// with this number; the same for the same arguments.
    pub(super) fn from(
        &self,
        seed: u64,
        number: u64,
        beginning: &Beginning,
        accept: impl Fn(&[Complex64], &[Complex64]) -> bool,
    ) -> Option<Fibre> {
        let (n, m) = (self.compiled.variables(), self.compiled.parameters());
        let mut z = Random::of(seed, Stream::Member(number)).normals(n + m);
        z[..n].iter_mut().for_each(|x| *x *= beginning.size);
        beginning.zero.iter().for_each(|&j| z[j] = Complex64::default());
        let damping = if self.free.equations() > n { DAMPING } else { 0.0 };
        if !gauss_newton(&self.free, &mut z, damping) {
            return None;
        }
        self.at(&z[n..], &z[..n], accept)
    }

    /// The regular solution at this point for these parameters, if it is one that `accept` is content with.
    pub(super) fn at(
        &self,
        parameters: &[Complex64],
        x: &[Complex64],
        accept: impl Fn(&[Complex64], &[Complex64]) -> bool,
    ) -> Option<Fibre> {
        let mut refiner = Refiner::new(&self.compiled);
        let refined = refined(&mut refiner, parameters, x);
        let regular = refined.accuracy < 1e-12 && refined.condition < 1e8 && refiner.is_regular(parameters, &refined);
        (regular && accept(parameters, &refined.point))
            .then(|| Fibre { is_partial: true, ..Fibre::new(parameters.to_vec(), x.len(), refined.point) })
    }

    /// Regular solutions from other random points, some of them far out or near zero, and some with
    /// unknowns that are zero: a family may have solutions of its own there.
    pub(super) fn others(&self, seed: u64, accept: impl Fn(&[Complex64], &[Complex64]) -> bool) -> Vec<Fibre> {
        let beginnings = SIZES.map(|size| Beginning { size, zero: Vec::new() }).into_iter();
        let zeros = self.zeros().into_iter().map(|zero| Beginning { size: 1.0, zero });
        let pairs = beginnings.map(|b| (b, PAIRS)).chain(zeros.map(|b| (b, ZERO_PAIRS))).flat_map(|(b, count)| {
            let count = if b.size == 1.0 { count } else { FAR_PAIRS.min(count) };
            (1..=count).map(move |k| (b.clone(), k))
        });
        let found = pairs.filter_map(|(beginning, k)| {
            let seed = seed.wrapping_add(k);
            (0..FEW_TRIES).find_map(|number| self.from(seed, number, &beginning, &accept))
        });
        found.collect()
    }

    /// The sets of unknowns that as many equations as they are lead to be zero: these equations hold
    /// wherever the unknowns of the set are zero, and as many as there are other unknowns do not. If there are more
    /// equations than unknowns, either may be more.
    fn zeros(&self) -> Vec<Vec<usize>> {
        let n = self.compiled.variables();
        let sets: Vec<Vec<usize>> = if n <= MANY_UNKNOWNS {
            (1u32..1 << n).map(|set| (0..n).filter(|j| set >> j & 1 == 1).collect()).collect()
        } else {
            (0..n).map(|j| vec![j]).chain([(0..n).collect()]).collect()
        };
        let mut random = Random::of(0, Stream::Elsewhere);
        let mut z = random.normals(n);
        z.extend(random.normals(self.compiled.parameters()));
        let mut memory = self.free.memory(Isa::Portable);
        let mut values = vec![Complex64::default(); self.free.equations()];
        let mut holds = |set: &Vec<usize>| {
            let mut z = z.clone();
            set.iter().for_each(|&j| z[j] = Complex64::default());
            self.free.values(&mut memory, &z, &[], &mut values);
            let hold = values.iter().filter(|value| value.norm() <= f64::EPSILON).count();
            hold >= set.len() && values.len() - hold >= n - set.len()
        };
        sets.into_iter().filter(|set| holds(set)).take(MOST_SETS).collect()
    }
}

/// Moves `z` to a zero of equations whose zeros are no isolated points; false if the corrections do not vanish.
/// Corrections are damped unless `damping` is zero, which serves where equations are independent.
fn gauss_newton<E: Evaluate>(system: &E, z: &mut [Complex64], damping: f64) -> bool {
    let (rows, columns) = (system.equations(), system.variables());
    let zero = Complex64::new(0.0, 0.0);
    let mut memory = system.memory(Isa::Portable);
    let (mut values, mut jacobian) = (vec![zero; rows], vec![zero; rows * columns]);
    let mut gram = vec![zero; rows * rows];
    let mut lu = Lu::new(rows, Isa::Portable);
    let ones = vec![[1.0]; rows];
    for _ in 0..MAX_ITERATIONS {
        system.jacobian(&mut memory, z, &[], &mut values, &mut jacobian);
        // dz = J^H (J J^H + damping)^{-1} F
        for a in 0..rows {
            for b in 0..rows {
                gram[b * rows + a] = (0..columns).map(|j| jacobian[j * rows + a] * jacobian[j * rows + b].conj()).sum();
            }
        }
        if damping > 0.0 {
            let squared: f64 = (0..rows).map(|a| gram[a * rows + a].re).sum();
            let residual = values.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            let damping = damping * residual * squared.sqrt() + LEAST_DAMPING * squared;
            (0..rows).for_each(|a| gram[a * rows + a] += damping);
        }
        lu.factor(&gram, &ones);
        lu.solve(&mut values);
        let mut change: f64 = 0.0;
        for j in 0..columns {
            let dz: Complex64 = (0..rows).map(|i| jacobian[j * rows + i].conj() * values[i]).sum();
            z[j] -= dz;
            change = change.max(dz.norm());
        }
        if !change.is_finite() || change > 1e6 {
            return false;
        }
        if change < 1e-13 {
            return true;
        }
    }
    false
}
