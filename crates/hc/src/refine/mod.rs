//! Newton's method with residuals in double-double: a solution to the last bit of double precision.

mod lane_newton;
mod lanes;
mod polished;
mod refined;
mod refiner;
mod sizes;

pub(crate) use lane_newton::LaneNewton;
pub(crate) use lanes::LaneRefiners;
pub use refined::Refined;
pub use refiner::Refiner;
pub(crate) use sizes::size;
