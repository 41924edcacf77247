//! Work on several processes, which MPI calls ranks.
//!
//! All ranks run the same program on the same input and make the same start systems, which follow
//! from the seed. With [`Run::on_ranks`](crate::Run::on_ranks), rank 0 does the same as without
//! other ranks. But it hands out paths in portions to the ranks that ask, tracks some itself, and
//! puts the ends together in the order of their numbers. The result has the same bits on any number
//! of ranks and threads, in whatever order the ends arrive: the end of a path depends only on its
//! number and the round. A [`RanksRun`](crate::RanksRun) divides the paths of a solve and of the
//! loops of monodromy, the targets of a family, and the subtrees of the search for mixed cells.
//! [`compute_on_ranks`] is for any other work in numbered items.
//!
//! An [`Exchange`] carries the messages. [`Local`] is an exchange between threads. The programs
//! `hc` and `tdoa` have one over MPI, behind their feature `mpi`.
//!
//! ```
//! use hc::ranks::{Local, Ranks, RanksOptions};
//! use hc::{Run, SolveOptions, System, solve};
//!
//! let system: System = "x^2 + y^2 - 5; x*y - 2".parse()?;
//! let options = SolveOptions::new().seed(1);
//! let found = std::thread::scope(|scope| {
//!     let each = |exchange: Local| {
//!         let (system, options) = (&system, &options);
//!         scope.spawn(move || {
//!             let ranks = Ranks::new(&exchange, &RanksOptions::new());
//!             let found = Run::new().on_ranks(&ranks).solve(system, options);
//!             ranks.finish(None);
//!             found
//!         })
//!     };
//!     let all: Vec<_> = Local::ranks(2).into_iter().map(each).collect();
//!     all.into_iter().map(|rank| rank.join().unwrap()).collect::<Result<Vec<_>, _>>()
//! })?;
//! // Rank 0 has the result.
//! assert_eq!(found, [Some(solve(&system, &options)?), None]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod desk;
mod error;
mod exchange;
mod items;
mod lead;
mod message;
mod run;
mod shared;
#[cfg(all(test, feature = "threads"))]
pub(crate) mod support;
mod worker;

pub use desk::Desk;
pub use error::RanksError;
pub use exchange::{Exchange, ExchangeError, Local};
pub use items::compute_on_ranks;
pub(crate) use lead::Lead;
pub use message::Portion;
pub use run::{Answered, Ranks, RanksOptions};
pub(crate) use shared::{DividedWork, Shareable};
pub(crate) use worker::{Task, Worker};
