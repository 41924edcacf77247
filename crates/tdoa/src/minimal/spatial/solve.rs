//! The entry point for all sizes in space.

use super::five::{FEWEST, Scaled, five_transmitters};
use super::offsets::{DEGENERATE, offsets};
use super::planes::in_one_plane;
use crate::duplicates::rounding;
use crate::minimal::check::check;
use crate::minimal::doubts::{allowed, warnings_in_space};
use crate::minimal::error::MinimalError;
use crate::minimal::larger::candidates_of_whole;
use crate::minimal::options::MinimalOptions;
use crate::minimal::solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
use crate::minimal::subset::{Subset, combinations};
use crate::pseudoranges::Pseudoranges;

/// Sets of five transmitters that are solved at most, those farthest from degenerate ones.
const TRIED: usize = 4;

/// Every network in space that explains the measurements, best first: of nine receivers or more and
/// five transmitters or more, of which a generic network is the only one.
///
/// The five transmitters of which linear equations are conditioned best are solved together with all
/// receivers; the other transmitters follow linearly, and all measurements are refined together. The
/// first receiver of the result is near the origin; any rotation or reflection fits as well.
///
/// Of the options, `tolerance` and `polish` matter. Measurements with more errors than `tolerance`
/// allows make a warning: the network is then not to be relied upon, and need not be that of least
/// squares.
///
/// # Errors
/// If the matrix is too small or too large, a measurement is missing, two nodes coincide, nodes are in
/// special position, no network in space explains the measurements, or a setting of the tracker is out
/// of range.
pub fn solve(measured: &Pseudoranges, options: &MinimalOptions) -> Result<MinimalSolution<3>, MinimalError> {
    options.paths.validate()?;
    check::<3>(measured)?;
    if measured.receivers() < FEWEST || measured.transmitters() < 5 {
        return Err(MinimalError::NotSolvedInSpace { configuration: measured.configuration() });
    }
    let candidate = candidate(measured, options)?;
    let physical = usize::from(candidate.physical);
    Ok(MinimalSolution {
        configuration: measured.configuration(),
        solver: "9r/5s",
        paths: PathCounts::default(),
        counts: RootCounts { complex: 1, real: 1, positive_definite: 1, physical },
        stopped_early: false,
        warnings: warnings_in_space(measured, &candidate, options),
        candidates: vec![candidate],
    })
}

/// The network with the smallest residuals of those that sets of five transmitters lead to; the first
/// one whose residuals are allowed.
fn candidate(measured: &Pseudoranges, options: &MinimalOptions) -> Result<Candidate<3>, MinimalError> {
    let enough = allowed(measured, options);
    let (mut best, mut failure) = (None::<Candidate<3>>, None);
    let parts = parts(measured);
    for part in &parts {
        let found = five_transmitters(&measured.select(&part.receivers, &part.transmitters));
        let candidates = candidates_of_whole(measured, part, found.iter(), options);
        failure = failure.or(found.err());
        best = best.into_iter().chain(candidates).min_by(|a, b| a.residual.total_cmp(&b.residual));
        if let Some(best) = best.take_if(|best| best.residual <= enough) {
            return Ok(best);
        }
    }
    let plane = parts.first().and_then(|part| cause(&measured.select(&part.receivers, &part.transmitters)));
    match plane {
        Some(plane) => Err(plane),
        None => best.ok_or_else(|| failure.unwrap_or(MinimalError::SpecialPosition)),
    }
}

/// All receivers with five transmitters each, the best conditioned ones first.
fn parts(measured: &Pseudoranges) -> Vec<Subset> {
    let receivers: Vec<usize> = (0..measured.receivers()).collect();
    let mut fives = combinations(measured.transmitters(), 5);
    if fives.len() > 1 {
        let margin = |five: &Vec<usize>| {
            let scaled = Scaled::new(&measured.select(&receivers, five));
            scaled.and_then(|scaled| offsets(&scaled.values)).map_or(0.0, |offsets| offsets.margin)
        };
        fives.sort_by_cached_key(|five| std::cmp::Reverse(margin(five).to_bits()));
        fives.truncate(TRIED);
    }
    fives.into_iter().map(|transmitters| Subset { receivers: receivers.clone(), transmitters }).collect()
}

/// Which nodes lie in one plane, if that is why five transmitters cannot be solved.
fn cause(five: &Pseudoranges) -> Option<MinimalError> {
    let scaled = Scaled::new(five)?;
    let largest = five.cells().values().iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let precision = DEGENERATE.max(rounding(largest) / scaled.unit);
    in_one_plane(&scaled.values, precision, five.transmitter_names())
}
