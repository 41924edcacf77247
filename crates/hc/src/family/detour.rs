//! Detours: fibres for other parameters, from which paths reach the target by another way.
//!
//! A path that struggles passes close to a branch point. Paths from another fibre keep their
//! distance from that point, and take as few steps as usual.

use super::fibre::Fibre;
use crate::random::{Random, Stream};
use num_complex::Complex64;

/// The number of detours that are tried before paths get more steps.
pub(super) const DETOURS: u64 = 2;

/// Parameters about as far from a fibre and a target as these are from each other; parameters that
/// stay on the straight way stay on the detour.
pub(super) fn corner(fibre: &Fibre, target: &[Complex64], number: u64) -> Vec<Complex64> {
    let start = &fibre.parameters;
    let normals = Random::of(0, Stream::Detour(number)).normals(start.len());
    let corner = |((a, b), z): ((&Complex64, &Complex64), Complex64)| (a + b) / 2.0 + z * (b - a).norm();
    start.iter().zip(target).zip(normals).map(corner).collect()
}
