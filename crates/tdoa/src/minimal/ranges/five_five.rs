//! Five receivers and five transmitters in space, ranges with one unknown constant: four constants, and 42 solutions for each.
//!
//! The four rows of the [`Pencil`] depend on each other for a constant of a network, since nodes in space give products of rank
//! three: its determinant, of degree four in the constant, vanishes. For each of these constants the differences are ranges
//! of 5r/5s, which have 42 solutions: 168 in all. Only real constants belong to real networks.

use super::gram::{FiveFive, Gram};
use super::pencil::Pencil;
use crate::clocks::Emissions;
use crate::minimal::engines::Engines;
use crate::minimal::error::MinimalError;
use crate::minimal::normalised::{Normalised, rank};
use crate::minimal::options::MinimalOptions;
use crate::minimal::polish::NetworkPolisher;
use crate::minimal::solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// Every network of real constants, best first; `counts` and `paths` are those of these constants.
pub(super) fn solve(
    engines: &mut Engines<3>,
    measured: &Pseudoranges,
    options: &MinimalOptions,
    monitor: &Monitor,
) -> Result<MinimalSolution<3>, MinimalError> {
    let data = Normalised::new(measured);
    let mut found = MinimalSolution {
        emissions: Emissions::Constant,
        configuration: measured.configuration(),
        solver: "5r/5s",
        paths: PathCounts::default(),
        counts: RootCounts::default(),
        stopped_early: false,
        warnings: Vec::new(),
        candidates: Vec::new(),
    };
    let constants = Pencil::new(&data.matrix, data.transmitters()).real_constants(options.near_real);
    if constants.is_empty() {
        return Ok(found);
    }
    let mut polisher = NetworkPolisher::default();
    let engine = engines.used::<Gram<FiveFive, 3>>();
    for (k, constant) in constants.into_iter().enumerate() {
        // The equations have squares alone.
        let cells = data.matrix.iter().map(|f| (f - constant).abs()).collect();
        let ranges = Pseudoranges::new(5, 5, cells).map_err(|_| MinimalError::NoNetwork)?;
        let ranges = ranges.with_emissions(Emissions::Known);
        let is_physical = data.matrix.iter().all(|f| f - constant >= -options.tolerance);
        // The unit of these ranges is that of the data.
        let first_under = options.first_under.map(|limit| limit / data.size()).filter(|_| is_physical);
        if k > 0 {
            engine.keep();
        }
        let settings = MinimalOptions { emissions: Emissions::Known, first_under, ..options.clone() };
        let solution = engine.solve(&ranges, &settings, monitor)?;
        add(&mut found.paths, &solution.paths);
        found.counts.complex += solution.counts.complex;
        found.counts.real += solution.counts.real;
        found.counts.positive_definite += solution.counts.positive_definite;
        if is_physical {
            found.counts.physical += solution.counts.physical;
        }
        for Candidate { mut network, .. } in solution.candidates {
            network.offsets.fill(constant);
            let mut candidate = data.candidate(network, options, &mut polisher);
            data.restore(&mut candidate.network);
            candidate.residual = candidate.network.rms(measured);
            found.candidates.push(candidate);
        }
        if solution.stopped_early {
            found.stopped_early = true;
            break;
        }
    }
    rank(&mut found.candidates);
    Ok(found)
}

/// Adds the paths to one more constant.
fn add(all: &mut PathCounts, more: &PathCounts) {
    all.tracked += more.tracked;
    all.finite += more.finite;
    all.at_infinity += more.at_infinity;
    all.failed += more.failed;
    all.dropped += more.dropped;
    all.retracked += more.retracked;
}
