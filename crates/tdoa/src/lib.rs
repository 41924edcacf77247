//! Calibration of sensor networks in the plane from arrival times alone.
//!
//! Synchronised receivers hear transmitters whose send times are unknown. With all times multiplied by the propagation
//! speed, receiver i measures of transmitter j the pseudorange f_ij = |r_i - s_j| + o_j. This crate finds the positions
//! r_i and s_j and the offsets o_j, up to a rotation, reflection and translation of the plane.

mod generated;
pub mod minimal;
pub mod network;
pub mod pseudoranges;

pub use network::{Candidate, MinimalSolution, Network, PathCounts, RootCounts};
pub use pseudoranges::{PseudorangeError, Pseudoranges};
