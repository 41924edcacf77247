//! Whether the networks found are complete and can be told apart.

use super::node_kind::NodeKind;
use super::normalised::Normalised;
use super::options::MinimalOptions;
use super::planar::collinear::Collinear;
use super::solution::{Candidate, PathCounts};
use super::warning::MinimalWarning;
use crate::duplicates::rounding;
use crate::flatness::flatness;
use crate::pseudoranges::Pseudoranges;

/// Physical candidates flatter than this are said to lie in one line, in space in one plane; exact data
/// tell no more of them.
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

/// What there is to say of the best candidate in space, and of the paths to all.
pub(super) fn warnings_in_space(
    measured: &Pseudoranges,
    paths: &PathCounts,
    best: &Candidate<3>,
    options: &MinimalOptions,
) -> Vec<MinimalWarning> {
    let mut warnings = Vec::new();
    if paths.failed > 0 {
        warnings.push(MinimalWarning::PathsLost { lost: paths.failed, tracked: paths.tracked });
    }
    if paths.at_infinity > 0 {
        warnings.push(MinimalWarning::PathsDiverge { diverged: paths.at_infinity, tracked: paths.tracked });
    }
    let tolerance = allowed(measured, options);
    let explained = best.residual <= tolerance;
    if !explained {
        warnings.push(MinimalWarning::NotExplained { residual: best.residual, tolerance });
    }
    for kind in [NodeKind::Receivers, NodeKind::Transmitters] {
        if flatness(kind.positions(&best.network)) < FLAT {
            warnings.push(MinimalWarning::NearlyInOnePlane { kind, names: kind.names(measured) });
        }
    }
    warnings
}

/// What there is to say of the networks of ranges, and of the paths to them.
pub(super) fn warnings_of_ranges<const D: usize>(
    measured: &Pseudoranges,
    paths: &PathCounts,
    candidates: &[Candidate<D>],
    options: &MinimalOptions,
) -> Vec<MinimalWarning> {
    let mut warnings = Vec::new();
    // No end of a path is at infinity for generic ranges.
    let lost = paths.failed + paths.at_infinity;
    if lost > 0 {
        warnings.push(MinimalWarning::PathsLost { lost, tracked: paths.tracked });
    }
    let tolerance = allowed(measured, options);
    if let Some(best) = candidates.first().filter(|best| best.residual > tolerance) {
        warnings.push(MinimalWarning::NotExplained { residual: best.residual, tolerance });
    }
    for kind in [NodeKind::Receivers, NodeKind::Transmitters] {
        if candidates.iter().any(|c| flatness(kind.positions(&c.network)) < FLAT) {
            let names = kind.names(measured);
            warnings.push(match D {
                2 => MinimalWarning::NearlyInOneLine { kind, names },
                _ => MinimalWarning::NearlyInOnePlane { kind, names },
            });
        }
    }
    warnings
}

/// Residuals up to this, in metres, are the noise that the options allow, or rounding.
pub(super) fn allowed(measured: &Pseudoranges, options: &MinimalOptions) -> f64 {
    let largest = measured.cells().values().iter().fold(0.0f64, |a, v| a.max(v.abs()));
    (options.tolerance * Normalised::new(measured).size()).max(rounding(largest))
}
