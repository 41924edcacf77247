//! Calibration of sensor networks in the plane and in space from arrival times alone.
//!
//! Synchronised receivers hear transmitters whose send times are unknown. With all times multiplied
//! by the propagation speed, receiver i measures the pseudorange f_ij = |r_i - s_j| + o_j of
//! transmitter j. This crate finds the positions r_i and s_j and the offsets o_j, up to a rotation,
//! reflection and translation.
//!
//! Where to look first:
//!
//! * [`calibrate()`]: any network from real measurements, with outliers, gaps and noise. It returns
//!   positions, uncertainty, other networks that explain the data as well, and what is wrong with
//!   the data.
//! * [`Locator`]: new transmitters in a network that is calibrated, each by itself.
//! * [`minimal`]: every network that explains a small complete matrix exactly, by homotopy
//!   continuation.
//! * [`Pseudoranges`]: the measurements; [`read`] reads them from files.
//! * [`summary`], [`picture`] and [`html`]: the result as text, picture and report.
//! * [`simulate()`] and [`accuracy`]: networks with a known truth, how near an estimate comes to
//!   it, and how near any estimate can come.
//! * In space: `CalibrateOptions::<3>::new()` in place of `CalibrateOptions::default()` makes
//!   [`calibrate()`] look for a network in space, a `Calibration<3>`. [`minimal::spatial::solve()`] is
//!   [`minimal::solve()`] in space, a `MinimalSolution<3>`.
//!
//! All features are on by default: `csv` ([`read`], [`node_table`]), `mat` (compressed MATLAB
//! files), `pictures` ([`picture`], [`html`]) and `threads` (all threads of rayon; results are the
//! same without it). Calibrating and solving arrays needs none of them.
//!
//! ```
//! use tdoa::{CalibrateOptions, Pseudoranges, SimulateOptions, calibrate, simulate};
//!
//! // Eight microphones and twelve claps, times 343 m/s, with 1 cm of noise and one clap that a microphone mistook.
//! let mut options = SimulateOptions::default();
//! options.noise = 0.01;
//! let simulation = simulate(&options)?;
//! let mut table = simulation.pseudoranges.dense();
//! table[17] += 3.0;
//! let measured = Pseudoranges::new(8, 12, table)?;
//!
//! let network = calibrate(&measured, &CalibrateOptions::default())?;
//! assert!(network.unique && !network.is_inlier(1, 5));
//! for (name, position) in network.receiver_names.iter().zip(&network.receivers) {
//!     println!("{name}: {position:?}");
//! }
//!
//! // Six receivers and three transmitters alone have a few exact solutions, best first: some with all distances positive, the others not.
//! let small = measured.select(&[2, 3, 4, 5, 6, 7], &[0, 1, 2]);
//! let exact = tdoa::minimal::solve(&small, &tdoa::minimal::MinimalOptions::default())?;
//! assert!(exact.paths.failed == 0 && exact.candidates[0].physical && exact.candidates[0].residual < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod accuracy;
pub mod align;
mod bordered;
pub mod calibrate;
mod candidates;
mod cells;
mod clocks;
pub mod degeneracy;
mod distances;
mod duplicates;
mod flatness;
mod generated;
#[cfg(feature = "pictures")]
pub mod html;
pub mod locate;
pub mod loss;
mod median;
pub mod minimal;
pub mod multilateration;
pub mod network;
#[cfg(feature = "csv")]
pub mod node_table;
mod observations;
#[cfg(feature = "pictures")]
pub mod picture;
mod points;
pub mod pseudoranges;
pub mod quantity;
#[cfg(feature = "csv")]
pub mod read;
mod refine;
mod restart;
pub mod simulate;
pub mod summary;

pub use calibrate::{
    Alternative, CalibrateError, CalibrateOptions, Calibration, Errors, Hypotheses, KnownDistance, MeasuredDistance,
    MeasuredPosition, MirrorImage, MovedPlace, ReceiverDelays, ReceiverEcho, ReceiverError, ReceiverErrorKind,
    RecorderClock, Residual, Residuals, SearchOptions, SpeedEstimate, SystematicErrors, Truth, Unfinished, calibrate,
    calibrate_with,
};
pub use cells::Cells;
pub use clocks::{Clocks, Emissions, ReceiverClocks};
pub use hc::{Monitor, Progress};
pub use locate::{LocateError, LocatedEvent, Locator, Place};
pub use minimal::{Candidate, MinimalSolution, PathCounts, RootCounts};
pub use network::Network;
pub use observations::Node;
pub use pseudoranges::{PseudorangeError, Pseudoranges};
pub use refine::PartialNetwork;
pub use simulate::{Layout, ReceiverFault, SimulateError, SimulateOptions, Simulation, simulate};
