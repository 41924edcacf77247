//! The interface through which all systems are evaluated: interpreted, sparse and generated ones.

use crate::scalar::Scalar;
use crate::simd::Isa;

/// A system `F(x; p)` of `equations()` formulas in `variables()` unknowns and `parameters()`
/// parameters.
///
/// The interpreter of straight-line programs, the kernel for sparse polynomial systems and
/// generated code implement it. The tracker needs nothing else from a system. No method except
/// [`memory`](Evaluate::memory) allocates. A slice that is shorter than stated is the caller's
/// error and panics.
pub trait Evaluate: Send + Sync {
    /// Scratch space for one evaluation at a time.
    type Memory<S: Scalar>: Send;

    /// Number of equations.
    fn equations(&self) -> usize;
    /// Number of unknowns.
    fn variables(&self) -> usize;
    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// New scratch space. Kernels for scalars with lanes run on the instruction set `isa`.
    fn memory<S: Scalar>(&self, isa: Isa) -> Self::Memory<S>;

    /// The values: `values[i] = F_i(x; p)`.
    fn values<S: Scalar>(&self, memory: &mut Self::Memory<S>, x: &[S], p: &[S], values: &mut [S]);

    /// The values and the Jacobian by columns: `jacobian[j * equations() + i] = dF_i/dx_j`.
    ///
    /// Every entry is written, structural zeros too.
    fn jacobian<S: Scalar>(&self, memory: &mut Self::Memory<S>, x: &[S], p: &[S], values: &mut [S], jacobian: &mut [S]);

    /// [`values`](Evaluate::values) with the parameters of the last call of `values` or [`jacobian`](Evaluate::jacobian) with
    /// this memory, which `p` holds still. Systems that keep parameters in their memory need not take them again.
    fn values_again<S: Scalar>(&self, memory: &mut Self::Memory<S>, x: &[S], p: &[S], values: &mut [S]) {
        self.values(memory, x, p, values);
    }

    /// [`jacobian`](Evaluate::jacobian) with the parameters of the last call, as [`values_again`](Evaluate::values_again).
    fn jacobian_again<S: Scalar>(
        &self,
        memory: &mut Self::Memory<S>,
        x: &[S],
        p: &[S],
        values: &mut [S],
        jacobian: &mut [S],
    ) {
        self.jacobian(memory, x, p, values, jacobian);
    }

    /// Whether `dF_row/dx_column` is zero whatever the input, as far as the system knows. By default nothing
    /// is known.
    fn vanishes(&self, _row: usize, _column: usize) -> bool {
        false
    }

    /// The Taylor coefficient of `F(x(t); p(t))` of order 1, 2 or 3.
    ///
    /// `x` holds the path's coefficients of orders `0 .. order`: the coefficient of order `k` for
    /// unknown `j` is `x[k * variables() + j]`. The unknowns' coefficient of the requested order is
    /// taken as zero, so that `-J^{-1}` times the result is that coefficient. `p` holds the
    /// parameters' coefficients of orders `0 ..= order` in the same layout. If `p` holds only
    /// orders 0 and 1, the parameters move on a straight line, which costs less.
    ///
    /// Orders must be requested in turn at one point: 1, then 2, then 3. Each call may use what the
    /// call before left in `memory`, and expects the coefficients that were given before.
    fn taylor<S: Scalar>(&self, memory: &mut Self::Memory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]);
}
