//! The thresholds by which this crate decides, stage by stage.
//!
//! They are no settings: results rest on them together, and the tests hold them. What a user may
//! choose is in [`TrackerOptions`](crate::TrackerOptions), [`EndgameOptions`](crate::EndgameOptions)
//! and [`CertifyOptions`](crate::CertifyOptions). Each constant says what it decides, and from
//! what it follows: a theorem, a paper, or the precision of the arithmetic. Where no source is
//! named, the number was chosen by trial on the systems of the tests. Limits of work and memory
//! stand beside the code that keeps them.

mod fibres;
mod paths;
mod singular;

pub(crate) use fibres::{families, sweeps, witness};
pub(crate) use paths::{
    LoopTolerances, QUICK, QuickTolerances, SINGLES, endgame, ends, proofs, quick_ends, refinement, same, tracking,
};
pub(crate) use singular::{clusters, equations, structure};
