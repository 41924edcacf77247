//! The entry point for all sizes in space.

use super::five::{FEWEST, Scaled, five_transmitters};
use super::offsets::{DEGENERATE, offsets};
use super::planes::in_one_plane;
use super::rank::{Found, seven_six, six_eight};
use crate::duplicates::rounding;
use crate::minimal::check::check;
use crate::minimal::doubts::{allowed, warnings_in_space};
use crate::minimal::error::MinimalError;
use crate::minimal::larger::candidates_of_whole;
use crate::minimal::normalised::rank;
use crate::minimal::options::MinimalOptions;
use crate::minimal::solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
use crate::minimal::subset::{Subset, combinations, ranked};
use crate::pseudoranges::Pseudoranges;

/// Parts of the measurements that a method tries at most.
const TRIED: usize = 4;
/// Networks whose offsets differ by less than this share of their size are one.
const SAME: f64 = 1e-6;

/// Every network in space that explains the measurements, best first: of nine receivers and five
/// transmitters, seven and six, six and eight, and more of both. A generic network of these sizes is the
/// only one.
///
/// From nine receivers on, the five transmitters of which linear equations are conditioned best are solved
/// together with all receivers; otherwise seven receivers and six transmitters, or six and eight, that are
/// far apart. The other nodes follow linearly, and all measurements are refined together. Any rotation or
/// reflection of the result fits as well.
///
/// Offsets come first, by the rank of the squared distances, then positions, the stratified approach of
/// Ask, Kuang & Astrom, *A unifying approach to minimal problems in collinear and planar TDOA sensor
/// network self-calibration*.
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
    let fits =
        |method: &&Method| measured.receivers() >= method.receivers && measured.transmitters() >= method.transmitters;
    let enough = allowed(measured, options);
    let (mut best, mut failure) = (None::<MinimalSolution<3>>, None);
    for method in METHODS.iter().filter(fits) {
        for part in (method.parts)(measured) {
            let found = match (method.solve)(&measured.select(&part.receivers, &part.transmitters)) {
                Ok(found) => found,
                Err(error) => {
                    failure = failure.or(Some(error));
                    continue;
                }
            };
            let mut candidates = candidates_of_whole(measured, &part, found.networks.iter(), options);
            candidates.sort_by(|a, b| a.residual.total_cmp(&b.residual));
            let explaining = candidates.iter().filter(|candidate| candidate.residual <= enough).count();
            // Of measurements that no network explains, the one that comes nearest.
            candidates.truncate(explaining.max(1));
            leave_out_copies(&mut candidates);
            let Some(first) = candidates.first() else { continue };
            if best.as_ref().is_some_and(|best| best.candidates[0].residual <= first.residual) {
                continue;
            }
            let physical = candidates.iter().filter(|candidate| candidate.physical).count();
            let warnings = warnings_in_space(measured, first, options);
            rank(&mut candidates);
            let solution = MinimalSolution {
                configuration: measured.configuration(),
                solver: method.name,
                paths: PathCounts::default(),
                counts: RootCounts { physical, ..found.counts },
                stopped_early: false,
                warnings,
                candidates,
            };
            if explaining > 0 {
                return Ok(solution);
            }
            best = Some(solution);
        }
        // No part of them does better.
        if plane(measured) == Some(MinimalError::InOnePlane) {
            return Err(MinimalError::InOnePlane);
        }
    }
    if let Some(plane) = plane(measured) {
        return Err(plane);
    }
    match (best, failure) {
        (Some(best), _) => Ok(best),
        (None, Some(failure)) => Err(failure),
        (None, None) if METHODS.iter().any(|method| fits(&method)) => Err(MinimalError::NoNetwork),
        (None, None) => Err(MinimalError::NotSolvedInSpace { configuration: measured.configuration() }),
    }
}

/// How networks of one size and all larger ones are solved.
struct Method {
    name: &'static str,
    receivers: usize,
    transmitters: usize,
    /// Parts of its size that are tried, the most promising first; some take all receivers.
    parts: fn(&Pseudoranges) -> Vec<Subset>,
    solve: fn(&Pseudoranges) -> Result<Found, MinimalError>,
}

/// Linear equations first.
const METHODS: [Method; 3] = [
    Method { name: "9r/5s", receivers: FEWEST, transmitters: 5, parts: fives, solve: five },
    Method { name: "7r/6s", receivers: 7, transmitters: 6, parts: |f| ranked(f, 7, 6, TRIED), solve: seven_six },
    Method { name: "6r/8s", receivers: 6, transmitters: 8, parts: |f| ranked(f, 6, 8, TRIED), solve: six_eight },
];

fn five(measured: &Pseudoranges) -> Result<Found, MinimalError> {
    let counts = RootCounts { complex: 1, real: 1, positive_definite: 1, physical: 0 };
    Ok(Found { networks: vec![five_transmitters(measured)?], counts })
}

/// Leaves out networks that the refinement led to one before.
fn leave_out_copies(candidates: &mut Vec<Candidate<3>>) {
    let mut kept: Vec<Candidate<3>> = Vec::new();
    for candidate in candidates.drain(..) {
        let near = |other: &Candidate<3>| {
            let pairs = other.network.offsets.iter().zip(&candidate.network.offsets);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < SAME * candidate.network.size()
        };
        if !kept.iter().any(near) {
            kept.push(candidate);
        }
    }
    *candidates = kept;
}

/// All receivers with five transmitters each, the best conditioned ones first.
fn fives(measured: &Pseudoranges) -> Vec<Subset> {
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

/// Which nodes lie in one plane, if the best five transmitters tell.
fn plane(measured: &Pseudoranges) -> Option<MinimalError> {
    if measured.receivers() < FEWEST || measured.transmitters() < 5 {
        return None;
    }
    let part = fives(measured).into_iter().next()?;
    cause(&measured.select(&part.receivers, &part.transmitters))
}

/// Which nodes lie in one plane, if that is why five transmitters cannot be solved.
fn cause(five: &Pseudoranges) -> Option<MinimalError> {
    let scaled = Scaled::new(five)?;
    let largest = five.cells().values().iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let precision = DEGENERATE.max(rounding(largest) / scaled.unit);
    in_one_plane(&scaled.values, precision, five.transmitter_names())
}
