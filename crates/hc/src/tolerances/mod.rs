//! The thresholds by which this crate decides, stage by stage.
//!
//! They are no settings: results rest on them together, and the tests hold them. What a user may
//! choose is in [`TrackerOptions`](crate::TrackerOptions), [`EndgameOptions`](crate::EndgameOptions)
//! and [`CertifyOptions`](crate::CertifyOptions). Each field says what its number decides, and from
//! what it follows: a theorem, a paper, or the precision of the arithmetic. Where no source is
//! named, the number was chosen by trial on the systems of the tests. Limits of work and memory
//! stand beside the code that keeps them.

mod families;
mod local;
mod paths;

pub(crate) use families::{FAMILIES, WITNESS};
pub(crate) use local::{CLUSTERS, EQUATIONS, LOCAL};
pub(crate) use paths::{
    ENDGAME, ENDS, LoopTolerances, PROOFS, QUICK, QUICK_ENDS, QuickTolerances, REFINEMENT, SINGLES, TRACKING,
};
