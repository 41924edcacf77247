//! Robust nonlinear least squares over all nodes.
//!
//! The objective is the negative log-likelihood of the residuals under Student's t
//! ([`crate::loss`]). It is minimised by Levenberg-Marquardt steps on reweighted normal equations.
//! If the scale is not given, it is estimated together with the network from the restricted
//! likelihood, (N - p) ln s instead of N ln s for N measurements and p unknowns. With six receivers
//! the unknowns take more than half of the measurements; plain likelihood would drive as many
//! residuals to zero as there are unknowns, and shrink the scale accordingly. Two things make the
//! minimisation converge from afar: the scale starts large and shrinks with every step (annealing),
//! and nodes that are stuck are multilaterated anew from all others (`reseed`).

mod cancel;
mod clock_block;
mod clock_elimination;
mod covariance;
mod descent;
mod eliminate;
mod extend;
mod gross_errors;
mod height_variances;
mod heights;
mod levels;
mod leverage;
mod motion;
mod normal;
mod predicted;
mod projection;
mod refiner;
mod reseed;
mod rigid;
mod sampled;
mod solver;
mod systematic;
mod way;
mod weighing;

pub(crate) use cancel::{Cancelled, check};
pub(crate) use covariance::{Covariance, covariance};
pub(crate) use descent::residuals;
pub use extend::PartialNetwork;
pub(crate) use extend::extend;
pub(crate) use gross_errors::log_density;
pub(crate) use heights::{Heights, has_many};
pub(crate) use motion::Motion;
pub(crate) use predicted::predicted_variances;
pub(crate) use projection::{Projection, dot, gram};
pub(crate) use refiner::{NetworkRefiner, RefineOptions, RefinedNetwork, SEARCH};
pub(crate) use reseed::{place_transmitters, places_of_receiver, places_of_transmitter};
pub(crate) use sampled::sampled_covariance;
pub(crate) use systematic::{Systematic, can_be_estimated, systematic};
pub(crate) use weighing::{Cost, Weighing};
