//! What a point near which paths end may be.

use super::equations::ExactEquations;
use num_complex::Complex64;
use poly::ComplexDd;

/// What a point near which paths end is by the given equations.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LocalStructure {
    /// A solution at which the Jacobian has full rank, to all digits of a double.
    Regular {
        /// The solution.
        point: Vec<Complex64>,
        /// The largest value of an equation there, relative to the sizes of its terms.
        residual: f64,
    },
    /// An isolated solution at which the Jacobian does not have full rank.
    Isolated {
        /// The dimension of the local ring.
        multiplicity: usize,
        /// The solution.
        point: Vec<Complex64>,
        /// The largest value of an equation there, relative to the sizes of its terms.
        residual: f64,
        /// Whether the solution and its multiplicity were found by exact arithmetic.
        is_exact: bool,
    },
    /// A point on a set of solutions of positive dimension.
    OnComponent {
        /// A solution on it near the end.
        point: Vec<Complex64>,
        /// Whether that was found by exact arithmetic.
        is_exact: bool,
    },
    /// The given equations have no solution nearby.
    NotASolution,
    /// It is not known which of these the point is.
    Unresolved(UnresolvedReason),
}

impl LocalStructure {
    /// Whether digits alone say that the Jacobian does not have full rank.
    pub(crate) fn is_singular_by_digits(&self) -> bool {
        matches!(
            self,
            LocalStructure::Isolated { is_exact: false, .. } | LocalStructure::OnComponent { is_exact: false, .. }
        )
    }
}

/// How much is done to find the local structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    /// To 77 digits, which is enough for nearly all ends.
    Little,
    /// To 308 digits.
    Much,
}

/// What keeps an end from being resolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum UnresolvedReason {
    /// No solution was found near the end, though the equations nearly vanish there.
    #[error("the equations nearly vanish, but no solution was found nearby")]
    NoSolution,
    /// Numbers that are neither zero nor clearly different from zero.
    #[error("ranks are not clear to 300 digits")]
    Unclear,
    /// All solutions were counted exactly, and their multiplicities are others.
    #[error("the solutions, counted exactly, have other multiplicities")]
    Count,
    /// The work that a solve may take for its ends is done.
    #[error("work limit reached; this end was not examined")]
    TooMuch,
    /// The work was cancelled.
    #[error("interrupted")]
    Interrupted,
    /// The local structure needs more orders than are looked at.
    #[error("the local structure is too large to tell whether the solution is isolated")]
    TooLarge,
}

/// The largest value of an equation at a point, relative to the sizes of its terms.
pub(crate) fn residual(given: &ExactEquations, point: &[Complex64]) -> f64 {
    let near = given.near::<ComplexDd>(point);
    near.residual(&near.scaled(point)).exp2()
}
