//! Calibration of sensor networks in the plane from arrival times alone.
//!
//! Synchronised receivers hear transmitters whose send times are unknown. With all times multiplied by the propagation
//! speed, receiver i measures of transmitter j the pseudorange f_ij = |r_i - s_j| + o_j. This crate finds the positions
//! r_i and s_j and the offsets o_j, up to a rotation, reflection and translation of the plane.

pub mod align;
pub mod calibrate;
pub mod degeneracy;
pub mod experiment;
mod generated;
pub mod html;
pub mod loss;
pub mod minimal;
pub mod multilateration;
pub mod network;
pub mod node_table;
mod observations;
pub mod picture;
pub mod pseudoranges;
pub mod read;
mod refine;
mod restart;
pub mod simulate;

pub use calibrate::{
    Alternative, CalibrateError, CalibrateOptions, Calibration, Control, Hypotheses, KnownDistance, Progress,
    SpeedEstimate, Truth, calibrate, calibrate_with,
};
pub use network::{Candidate, MinimalSolution, Network, PathCounts, RootCounts};
pub use pseudoranges::{PseudorangeError, Pseudoranges};
pub use refine::PartialNetwork;
pub use simulate::{Layout, SimulateError, SimulateOptions, Simulation, simulate};
