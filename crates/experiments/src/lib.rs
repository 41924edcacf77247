//! Experiments with the calibration and what is recorded of them. Not published; two programs give
//! entry:
//!
//! * `tdoa experiment` runs [`command`], whose trials are in [`trials`] (feature `trials`).
//! * `cargo xtask experiments | compare | counts` runs [`results`], [`compare`] and [`counts`]
//!   (feature `records`).

#[cfg(feature = "trials")]
pub mod command;
#[cfg(feature = "records")]
pub mod compare;
#[cfg(feature = "records")]
pub mod counts;
#[cfg(any(feature = "trials", feature = "records"))]
mod quantile;
#[cfg(feature = "records")]
pub mod results;
#[cfg(feature = "trials")]
pub mod scale;
#[cfg(feature = "trials")]
pub mod trials;
#[cfg(feature = "records")]
pub mod workspace;
