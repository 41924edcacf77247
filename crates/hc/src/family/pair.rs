//! A first solution of a family: one pair of parameters and unknowns.
//!
//! Newton's method runs in unknowns and parameters together, from a random complex point. The
//! equations are underdetermined, so the correction of least length is taken (Gauss-Newton).

use super::fibre::Fibre;
use crate::linalg::Lu;
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{CompileError, Evaluate, System};

/// Random points tried before the search is given up.
pub(super) const TRIES: u64 = 1000;
const MAX_ITERATIONS: usize = 60;

/// Finds a regular solution of a square system for some generic parameters, deterministic for a
/// seed.
///
/// `accept` is asked about parameters and solution; `None` if none of the `tries` led to a regular
/// solution that it accepts.
///
/// # Errors
/// If the formulas cannot be compiled.
pub(super) fn find_pair(
    system: &System,
    accept: impl Fn(&[Complex64], &[Complex64]) -> bool,
    seed: u64,
    tries: u64,
) -> Result<Option<Fibre>, CompileError> {
    let (n, m) = (system.variables().len(), system.parameters().len());
    let compiled = system.compile()?;
    let free = System::build(|s| {
        let unknowns: Vec<_> = system.variables().iter().map(|name| s.variable(name)).collect();
        let parameters: Vec<_> = system.parameters().iter().map(|name| s.variable(name)).collect();
        system.instantiate(s, &unknowns, &parameters)
    });
    // The names and constants come from a system that exists already.
    let Ok(free) = free else { return Ok(None) };
    let free = free.compile()?;
    let mut refiner = Refiner::new(&compiled);
    for k in 0..tries {
        let mut z = Random::of(seed, Stream::Member(k)).normals(n + m);
        if !gauss_newton(&free, &mut z) {
            continue;
        }
        let parameters = z[n..].to_vec();
        let refined = refiner.refine(&parameters, &z[..n]);
        if refined.accuracy < 1e-12 && refined.condition < 1e8 && accept(&parameters, &refined.point) {
            return Ok(Some(Fibre { is_partial: true, ..Fibre::new(parameters, n, refined.point) }));
        }
    }
    Ok(None)
}

/// Moves `z` to a zero of fewer equations than unknowns; false if the corrections do not vanish.
fn gauss_newton<E: Evaluate>(system: &E, z: &mut [Complex64]) -> bool {
    let (rows, columns) = (system.equations(), system.variables());
    let zero = Complex64::new(0.0, 0.0);
    let mut memory = system.memory(Isa::Portable);
    let (mut values, mut jacobian) = (vec![zero; rows], vec![zero; rows * columns]);
    let mut gram = vec![zero; rows * rows];
    let mut lu = Lu::new(rows, Isa::Portable);
    let ones = vec![[1.0]; rows];
    for _ in 0..MAX_ITERATIONS {
        system.jacobian(&mut memory, z, &[], &mut values, &mut jacobian);
        // dz = J^H (J J^H)^{-1} F
        for a in 0..rows {
            for b in 0..rows {
                gram[b * rows + a] = (0..columns).map(|j| jacobian[j * rows + a] * jacobian[j * rows + b].conj()).sum();
            }
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
