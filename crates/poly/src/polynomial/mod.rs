//! Sparse multivariate polynomials over any commutative ring; exponents may be negative.

mod arithmetic;
mod display;
mod ring;
mod terms;
#[cfg(test)]
mod tests;
mod transform;

pub use ring::Ring;
pub use terms::Polynomial;
pub(crate) use terms::{Terms, accumulate};
