//! The one interface through which systems are evaluated, whether interpreted, sparse or generated.

use crate::scalar::Scalar;
use crate::simd::Isa;

/// A system `F(x; p)` of `equations()` formulas in `variables()` unknowns and `parameters()` parameters.
///
/// Implemented by the interpreter of straight-line programs, by the kernel for sparse polynomial systems and by
/// generated code; the tracker is written over this trait alone. No method allocates: scratch space is
/// made once by [`memory`](Evaluate::memory). Slices shorter than stated are a caller's error and panic.
pub trait Evaluate: Send + Sync {
    /// Scratch space for one evaluation at a time.
    type Memory<S: Scalar>: Send;

    /// Number of equations.
    fn equations(&self) -> usize;
    /// Number of unknowns.
    fn variables(&self) -> usize;
    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// Scratch space whose kernels run on `isa` (for scalars without lanes it makes no difference).
    fn memory<S: Scalar>(&self, isa: Isa) -> Self::Memory<S>;

    /// `values[i] = F_i(x; p)`.
    fn values<S: Scalar>(&self, memory: &mut Self::Memory<S>, x: &[S], p: &[S], values: &mut [S]);

    /// Values as in [`values`](Evaluate::values), and `jacobian[j * equations() + i] = dF_i/dx_j`, every entry written,
    /// structural zeros too.
    fn jacobian<S: Scalar>(&self, memory: &mut Self::Memory<S>, x: &[S], p: &[S], values: &mut [S], jacobian: &mut [S]);

    /// Taylor coefficient `order` (1, 2 or 3) of `F(x(t); p(t))`.
    ///
    /// `x` holds coefficients `0 .. order` of the path, one after the other (`x[k * variables() + j]`); its coefficient
    /// `order` is taken as zero, so that `-J^{-1}` of the result is that coefficient. `p` holds the coefficients
    /// `0 ..= order` of the parameters in the same layout, or only those of orders 0 and 1, whatever the order asked
    /// for: then the parameters move on a straight line, which costs less.
    ///
    /// Orders must be asked for in turn, 1 then 2 then 3, at one point: each call may reuse what the one before
    /// left in `memory`, and relies on coefficients already given being unchanged.
    fn taylor<S: Scalar>(&self, memory: &mut Self::Memory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]);
}
