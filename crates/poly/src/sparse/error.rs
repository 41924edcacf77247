//! Errors in supports.

use crate::wording::counted;

/// Why supports do not make a system.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SupportError {
    /// An exponent vector of the wrong length.
    #[error("term {term} of equation {equation} has {}, the system has {}", counted(*.found, "exponent"), counted(*.expected, "unknown"))]
    Length {
        /// The equation, from 1.
        equation: usize,
        /// The term, from 1.
        term: usize,
        /// Length of the exponent vector.
        found: usize,
        /// Number of unknowns.
        expected: usize,
    },
    /// An exponent vector that occurs twice in one equation.
    #[error("term {term} of equation {equation} repeats an earlier exponent vector; add their coefficients")]
    Repeated {
        /// The equation, from 1.
        equation: usize,
        /// The term, from 1.
        term: usize,
    },
    /// An exponent that is the least 32-bit integer, whose negative does not fit.
    #[error("term {term} of equation {equation} has an exponent of -2^31")]
    Exponent {
        /// The equation, from 1.
        equation: usize,
        /// The term, from 1.
        term: usize,
    },
}
