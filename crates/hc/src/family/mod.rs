//! Parameter families: from all solutions for one generic parameter point to all solutions for any
//! other.
//!
//! [`Family`] is the entry point. Below it are [`track_fibre`], [`move_fibre`], and
//! [`FibreTracker`] with its memory and [`Charts`]; they take your own programs
//! ([`poly::Evaluate`]), such as generated ones.

mod charts;
mod choice;
mod compiled;
mod complete;
mod error;
mod excess;
mod fibre;
mod group;
mod images;
mod joined;
mod member;
mod monodromy;
mod overdetermined;
mod packed;
mod pair;
mod permutations;
mod reach;
mod search;
mod sides;
mod start_file;
mod stated;
mod still;
mod stored;
mod symmetry;
mod target;
mod targets;
mod trace;
mod track;
mod tracking;
mod verdict;

pub use charts::{Charts, OneChart};
pub use choice::{ChoiceOptions, easiest_fibre, real_sample};
pub use compiled::Family;
pub use error::FamilyError;
pub use fibre::{Fibre, FibreOptions, Limit, PathCounts, TargetLimits};
pub use group::{BlockSystem, MonodromyGroup};
pub(crate) use monodromy::monodromy;
pub use packed::{PackedFibreError, pack_fibre, unpack_fibre};
pub use search::{Monodromy, MonodromyOptions, Multiple, Stopped, TraceTest};
pub use start_file::{StartFile, StartFileError};
pub use stated::Stated;
pub use targets::Targets;
pub(crate) use trace::Bends;
pub use track::{FibreTracker, move_fibre, track_fibre};

#[cfg(all(test, feature = "threads"))]
#[path = "recorded_tests.rs"]
mod tests;

#[cfg(all(test, feature = "threads"))]
mod ranks_tests;
