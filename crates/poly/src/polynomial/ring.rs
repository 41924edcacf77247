//! Coefficients of polynomials.

use num_traits::{One, Zero};
use std::ops::{Neg, Sub};

/// Coefficients of polynomials: elements of a commutative ring.
pub trait Ring: Clone + PartialEq + Zero + One + Sub<Output = Self> + Neg<Output = Self> {}

impl<R: Clone + PartialEq + Zero + One + Sub<Output = R> + Neg<Output = R>> Ring for R {}
