//! The thresholds by which this crate decides, stage by stage.
//!
//! They are no settings: results rest on them together, and the tests hold them. What a user may
//! choose is in [`TrackerOptions`](crate::TrackerOptions), [`EndgameOptions`](crate::EndgameOptions)
//! and [`CertifyOptions`](crate::CertifyOptions). Each field says what its number decides, and from
//! what it follows: a theorem, a paper, or the precision of the arithmetic. Where no source is
//! named, the number was chosen by trial on the systems of the tests. Limits of work and memory
//! stand beside the code that keeps them.
//!
//! ```
//! // Imaginary parts below this share of a regular solution count as zero.
//! assert_eq!(hc::tolerances::ENDS.real, 1e-10);
//! ```

mod families;
mod local;
mod paths;

pub use families::{FAMILIES, FamilyTolerances, WITNESS, WitnessTolerances};
pub use local::{CLUSTERS, ClusterTolerances, EQUATIONS, EquationTolerances, LOCAL, LocalTolerances};
pub use paths::{
    ENDGAME, ENDS, EndTolerances, EndgameTolerances, LoopTolerances, PROOFS, ProofTolerances, QUICK, QUICK_ENDS,
    QuickEndTolerances, QuickTolerances, REFINEMENT, RefinementTolerances, SINGLES, TRACKING, TrackingTolerances,
};
