//! Newton's method with residuals in double-double: a solution to the last bit of double precision.

mod lanes;
mod polished;
mod refined;
mod refiner;
mod sizes;

pub(crate) use lanes::LaneRefiners;
pub use refined::Refined;
pub use refiner::Refiner;
pub(crate) use sizes::{measure, size, size_sqr, weight_sqr};
