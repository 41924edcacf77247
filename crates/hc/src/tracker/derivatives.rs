//! Derivatives of paths by their parameter.

use crate::linalg::Lu;
use poly::{Evaluate, Lane};

/// Completes the Taylor coefficients of paths, `taylor[k * n + j]` for order `k` and unknown `j`, whose orders
/// 0 are given, to order 3. `lu` factors the Jacobian there; `p` holds the coefficients of the parameters, of
/// orders 0 to 3, or of 0 and 1 if they move on a straight line.
pub(super) fn derivatives<E: Evaluate, S: Lane>(
    system: &E,
    memory: &mut E::Memory<S>,
    lu: &Lu<S>,
    p: &[S],
    taylor: &mut [S],
) {
    let (n, m) = (system.variables(), system.parameters());
    for order in 1..=3 {
        let (known, next) = taylor.split_at_mut(order * n);
        system.taylor(memory, order, known, &p[..p.len().min((order + 1) * m)], &mut next[..n]);
        lu.solve_negated(&mut next[..n]);
    }
}
