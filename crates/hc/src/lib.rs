//! Homotopy continuation: all isolated solutions of polynomial systems, and of parameter families, tracked from one generic instance
//! to any other.
//!
//! Where to look first:
//!
//! The front doors:
//!
//! * [`solve`](mod@solve): all solutions of a system: start system, paths, multiplicities, what lies at infinity and on components.
//! * [`certify`](mod@certify): proofs that solutions exist, are distinct, are real.
//!
//! What paths are made of:
//!
//! * [`tracker`]: the path tracker, its options and presets; [`tracker::track`] follows paths on all threads.
//! * [`homotopy`]: homotopies are a system and a path in its parameters.
//! * [`start`]: mixed cells and mixed volumes.
//! * [`endgame`]: the ends of paths that are singular or at infinity.
//!
//! Families:
//!
//! * [`family`](mod@family): a family ready to be tracked, and what it accepts as solutions.
//! * [`fibre`]: all solutions of a family from one parameter point to another, with jumped paths found and tracked again.
//! * [`pair`], [`monodromy`], [`trace`]: a first solution, all others from it, and the test that none is missing.
//! * [`start_file`]: the stored form of a fibre.
//!
//! For all of them: [`monitor`] for progress, and stopping early; [`refine`], [`distinct`] and [`random`], which are used everywhere. The guide
//! (docs/guide in the repository) tells how it works.
//!
//! Systems come from the crate [`poly`], which is re-exported: everything that implements [`poly::Evaluate`] can be tracked.
//!
//! ```
//! use hc::fibre::{FibreOptions, track_fibre};
//! use hc::monodromy::{MonodromyOptions, monodromy};
//! use hc::{pair::find_pair, trace::trace_test};
//!
//! // The distances of a camera from three points (P3P): three equations in the distances d, given the angles and sides.
//! let family = hc::poly::parse::family(r#"
//!     name = "p3p"
//!     unknowns = ["d1", "d2", "d3"]
//!     parameters = ["g12", "g13", "g23", "D12", "D13", "D23"]
//!     equations = ["d1^2 + d2^2 - 2*g12*d1*d2 - D12",
//!                  "d1^2 + d3^2 - 2*g13*d1*d3 - D13",
//!                  "d2^2 + d3^2 - 2*g23*d2*d3 - D23"]
//! "#)?;
//! let system = family.system.compile()?;
//!
//! // One solution for some generic parameters, then all of them, and the proof that they are all.
//! let first = find_pair(&family.system, |_, _| true, 0)?.expect("a regular solution");
//! let options = MonodromyOptions::default();
//! let fibre = monodromy(&system, &first, |_, _| true, &options).fibre;
//! assert_eq!(fibre.len(), 8);
//! assert!(trace_test(&family.system, &fibre, &options)?.passed(8));
//!
//! // A camera at distances 2, 3 and 4 from the points.
//! let g = [0.5, 0.6, 0.7];
//! let target = [g[0], g[1], g[2], 13.0 - 12.0 * g[0], 20.0 - 16.0 * g[1], 25.0 - 24.0 * g[2]].map(Into::into);
//! let (paths, counts) = track_fibre(&system, &fibre, &target, &FibreOptions::default());
//! assert_eq!((counts.finite, counts.failed), (8, 0));
//! let camera = |x: &[num_complex::Complex64]| (0..3).all(|i| (x[i] - (i + 2) as f64).norm() < 1e-9);
//! assert!(paths.iter().any(|(_, x)| camera(x)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod certify;
pub mod distinct;
pub mod endgame;
pub mod family;
pub mod fibre;
pub mod homotopy;
mod inverse;
mod linalg;
pub mod monitor;
pub mod monodromy;
pub mod pair;
pub mod random;
pub mod refine;
pub mod solve;
pub mod start;
pub mod start_file;
mod store;
pub mod trace;
pub mod tracker;

pub use poly;
