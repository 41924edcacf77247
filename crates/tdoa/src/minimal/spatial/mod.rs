//! Networks in space.
//!
//! [`solve()`] takes nine receivers and five transmitters, seven and six, six and eight, and more of both.
//! Such a network has three measurements or more than unknowns, and a generic one is the only solution. It
//! needs no paths. Offsets of five transmitters come from one singular value decomposition, those of six
//! or eight, of which there are 5 or 14 sets, from eigenvalues. Positions follow linearly or from polynomials
//! that have but one common root, and other nodes linearly from squared distances.
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
//! let truth = Network { receivers, transmitters, offsets: vec![0.0, 7.0, -3.0, 12.0, 0.5] };
//! let measured = Pseudoranges::new(9, 5, truth.pseudoranges())?;
//!
//! let found = spatial::solve(&measured, &MinimalOptions::default())?;
//! let best = &found.candidates[0];
//! assert!(best.physical && best.residual < 1e-9 && found.warnings.is_empty());
//! assert!(tdoa::accuracy::position_error(&best.network, &truth) < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bilinear;
mod five;
mod grassmannian;
mod monomials;
mod offsets;
mod planes;
mod polynomial;
mod rank;
mod solve;
mod upgrade;

pub(crate) use five::five_transmitters;
pub use solve::solve;

#[cfg(test)]
mod tests;
