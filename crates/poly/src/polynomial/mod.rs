//! Sparse multivariate polynomials over any commutative ring; exponents may be negative.

mod arithmetic;
mod display;
mod terms;
#[cfg(test)]
mod tests;
mod transform;

pub use terms::{Polynomial, Ring};
pub(crate) use terms::{Terms, accumulate};
