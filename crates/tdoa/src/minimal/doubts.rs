//! Whether the networks found are complete and can be told apart.

use super::node_kind::NodeKind;
use super::planar::collinear::Collinear;
use super::solution::{Candidate, PathCounts};
use super::warning::MinimalWarning;
use crate::flatness::flatness;
use crate::pseudoranges::Pseudoranges;

/// Physical candidates flatter than this are said to lie in one line; exact data tell no more of
/// them.
const FLAT: f64 = 1e-4;

/// What there is to say of the candidates; `line` is what the data show to lie exactly in one line.
pub(super) fn warnings(
    measured: &Pseudoranges,
    paths: &PathCounts,
    candidates: &[Candidate],
    line: Option<&Collinear>,
) -> Vec<MinimalWarning> {
    let mut warnings = Vec::new();
    if paths.failed > 0 {
        warnings.push(MinimalWarning::PathsLost { lost: paths.failed, tracked: paths.tracked });
    }
    for kind in [NodeKind::Receivers, NodeKind::Transmitters] {
        let flat = |c: &Candidate| c.physical && flatness(kind.positions(&c.network)) < FLAT;
        if let Some(line) = line.filter(|line| line.kind == kind) {
            warnings.push(MinimalWarning::InOneLine { kind, names: kind.names(measured), listed: line.all_listed() });
        } else if candidates.iter().any(flat) {
            warnings.push(MinimalWarning::NearlyInOneLine { kind, names: kind.names(measured) });
        }
    }
    warnings
}
