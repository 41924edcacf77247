//! Homotopy continuation: all isolated solutions of polynomial systems, and of parameter families,
//! tracked from one generic instance to any other.
//!
//! ```
//! let system: hc::System = "x^2 + y^2 - 5; x*y - 2".parse()?;
//! let found = hc::solve(&system, &hc::SolveOptions::new().seed(1))?;
//! for x in found.real_solutions() { println!("{x:?}"); }
//! # assert_eq!((found.len(), found.real_solutions().count()), (4, 4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`solve`]: all isolated solutions of a [`System`], with multiplicities and with what lies at
//!   infinity. [`Solutions`] can print and [certify](Solutions::certify) themselves.
//! * [`Family`]: a system with parameters. [`Family::monodromy`] finds all solutions for one
//!   parameter point, [`Family::track`] finds those for thousands of other points, and
//!   [`Family::trace_test`] tells whether a solution is missing.
//! * [`certify`](mod@certify): proofs that solutions exist, are distinct, and are real.
//! * [`mixed_volume`](fn@mixed_volume): the number of solutions of a generic system with the same
//!   terms.
//! * [`Run`]: any of these, watched and stopped by a [`Monitor`], on a number of threads, recorded
//!   in a [`checkpoint`] from which it continues after it was killed, on several [`ranks`].
//!
//! [`sweep`] has the real solutions of a family over a grid of parameters, as branches with their folds; [`witness`]
//! decomposes solution sets of positive dimension.
//!
//! The path tracker is in [`tracker`]. Its homotopies, each a system and a path in its parameters,
//! are in [`homotopy`]. [`family`] has the layer below [`Family`], for your own programs; [`start`]
//! has mixed cells; [`refine`], [`distinct`] and [`random`] are used everywhere. With the feature
//! of the same name, `codegen` writes a family and its solutions as Rust source.
//!
//! The feature `threads`, on by default, runs paths, mixed cells and proofs on all threads of
//! rayon. Results are the same without it.
//!
//! Systems come from the crate [`poly`], which is re-exported. Everything that implements
//! [`poly::Evaluate`] can be tracked.
//!
//! ```
//! // The distances of a camera from three points (P3P), given the angles and sides between them.
//! let family: hc::Family = r#"
//!     name = "p3p"
//!     unknowns = ["d1", "d2", "d3"]
//!     parameters = ["g12", "g13", "g23", "D12", "D13", "D23"]
//!     equations = ["d1^2 + d2^2 - 2*g12*d1*d2 - D12",
//!                  "d1^2 + d3^2 - 2*g13*d1*d3 - D13",
//!                  "d2^2 + d3^2 - 2*g23*d2*d3 - D23"]
//!     symmetry = [["-d1", "-d2", "-d3"]]
//! "#.parse()?;
//!
//! // All solutions for some generic parameters: eight, of which four are tracked.
//! let found = family.monodromy(&hc::MonodromyOptions::new())?;
//! assert_eq!(found.stopped, hc::Stopped::Trace, "the orbits are whole, and there are no others");
//! let fibre = found.fibre;
//! assert_eq!((fibre.len(), fibre.representatives.as_ref().map(Vec::len)), (8, Some(4)));
//!
//! // A camera at distances 2, 3 and 4 from the points.
//! let g = [0.5, 0.6, 0.7];
//! let target = [g[0], g[1], g[2], 13.0 - 12.0 * g[0], 20.0 - 16.0 * g[1], 25.0 - 24.0 * g[2]];
//! let found = &family.track(&fibre, &[target]).run()?[0];
//! let camera = |x: Vec<f64>| (0..3).all(|i| (x[i] - (i + 2) as f64).abs() < 1e-9);
//! assert!(found.real_solutions().any(camera));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod certify;
pub mod checkpoint;
#[cfg(feature = "codegen")]
pub mod codegen;
pub mod distinct;
mod endgame;
mod exact;
pub mod family;
pub mod homotopy;
mod inverse;
mod linalg;
mod mixed;
mod monitor;
mod moving;
pub mod random;
pub mod ranks;
pub mod refine;
mod run;
mod runner;
mod setters;
mod singular;
mod solve;
pub mod start;
mod store;
pub mod sweep;
mod threads;
mod tolerances;
pub mod tracker;
pub mod witness;

pub use certify::{Certificates, CertifyOptions, certify};
pub use endgame::EndgameOptions;
pub use family::{Family, FamilyError, Fibre, FibreOptions, Monodromy, MonodromyOptions, PathCounts, Stopped};
pub use monitor::{Monitor, Progress, Stage};
pub use num_complex::Complex64;
pub use poly;
pub use poly::System;
pub use run::{RanksRun, Run, ThreadsError};
pub use solve::{
    Direction, Solution, Solutions, SolveError, SolveOptions, Start, Unresolved, Warning, coordinates, solve,
};
pub use start::mixed_volume;
pub use tracker::{OptionError, TrackerOptions};
