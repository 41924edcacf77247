//! Networks in space.
//!
//! [`solve()`] takes every size that has finitely many networks, but for five receivers.
//!
//! Nine receivers and five transmitters, seven and six, six and eight, and more of both, have three
//! measurements or more than unknowns, and a generic network is the only solution. It needs no paths.
//! Offsets of five transmitters come from one singular value decomposition, those of six or eight, of which
//! there are 5 or 14 sets, from eigenvalues. Positions follow linearly or from polynomials that have but one
//! common root, and other nodes linearly from squared distances.
//!
//! Ten receivers and four transmitters, seven and five, and six and six, have as many measurements as
//! unknowns, and several networks. All of them are found by homotopy continuation from a stored fibre of
//! 6148, 2321 and 3920 solutions, in seconds; a trace test showed each to be whole. Larger ones go through
//! one of these sizes, or from eight receivers and five transmitters on through 256 paths.
//!
//! ```
//! use tdoa::minimal::{MinimalOptions, spatial};
//! use tdoa::{Network, Pseudoranges};
//!
//! let receivers = vec![
//!     [0.0, 0.1, 2.4], [4.0, 0.0, 1.9], [0.2, 5.0, 1.1], [3.8, 4.7, 2.5], [2.1, 0.3, 0.2],
//!     [0.1, 2.6, 0.5], [3.9, 2.2, 0.8], [1.8, 4.9, 2.2], [2.0, 1.0, 1.3],
//! ];
//! let transmitters = vec![[1.0, 1.0, 1.0], [3.0, 1.5, 0.4], [2.5, 4.0, 1.7], [0.5, 3.0, 0.9], [1.7, 2.2, 2.2]];
//! let truth = Network::new(receivers, transmitters, vec![0.0, 7.0, -3.0, 12.0, 0.5]);
//! let measured = Pseudoranges::new(9, 5, truth.pseudoranges())?;
//!
//! let found = spatial::solve(&measured, &MinimalOptions::default())?;
//! let best = &found.candidates[0];
//! assert!(best.physical && best.residual < 1e-9 && found.warnings.is_empty());
//! assert!(tdoa::accuracy::position_error(&best.network, &truth) < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bilinear;
mod dual;
mod five;
mod gram;
mod grassmannian;
mod monomials;
mod offsets;
mod planes;
mod polynomial;
mod rank;
mod solve;
mod stored;
mod symmetric;
mod upgrade;

#[cfg(test)]
pub(super) use dual::{Dual, EightFive, SevenFive, TenFour};
pub(crate) use five::five_transmitters;
#[cfg(test)]
pub(super) use gram::SixSix;
pub use solve::{Solver, solve};

#[cfg(test)]
mod tests;
