//! The entry point for all sizes in space.

use super::dual::{Dual, EightFive, SevenFive, TenFour};
use super::five::{FEWEST, Scaled, five_transmitters};
use super::gram::SixSix;
use super::offsets::{DEGENERATE, offsets};
use super::planes::{are_flat, in_one_plane};
use super::rank::{Found, seven_six, six_eight};
use crate::clocks::Emissions;
use crate::duplicates::rounding;
use crate::minimal::check::check;
use crate::minimal::doubts::{allowed, warnings_in_space};
use crate::minimal::engine::Engine;
use crate::minimal::engines::{Engines, PathSolver};
use crate::minimal::error::MinimalError;
use crate::minimal::formulation::FormulationIn;
use crate::minimal::larger::candidates_of_whole;
use crate::minimal::normalised::{leave_out_copies, rank};
use crate::minimal::options::{MinimalOptions, MinimalStart};
use crate::minimal::proofs::RootProofs;
use crate::minimal::ranges;
use crate::minimal::solution::{MinimalSolution, RootCounts};
use crate::minimal::subset::{Subset, combinations, ranked};
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// Parts of the measurements that a method without paths tries at most.
const TRIED: usize = 4;
/// Receivers from which on equations that are linear show four transmitters in one plane.
const SHOWING: usize = 8;

/// Every network in space that explains the measurements, best first: [`Solver::solve`] with a new solver.
///
/// # Errors
/// Those of [`Solver::solve_watched`].
pub fn solve(measured: &Pseudoranges, options: &MinimalOptions) -> Result<MinimalSolution<3>, MinimalError> {
    Solver::new().solve(measured, options)
}

/// Solver for networks in space. It chooses the method by size, and keeps its memory from call to call.
///
/// Sizes with three measurements or more than unknowns are solved without paths, and a generic network is
/// the only one. From nine receivers on, the five transmitters of which linear equations are conditioned
/// best are solved together with all receivers; otherwise seven receivers and six transmitters, or six and
/// eight, that are far apart. The other nodes follow linearly, and all measurements are refined together.
/// Offsets come first, by the rank of the squared distances, then positions, the stratified approach of
/// Ask, Kuang & Astrom, *A unifying approach to minimal problems in collinear and planar TDOA sensor
/// network self-calibration*.
///
/// Of smaller sizes a part of eight receivers and five transmitters, seven and five, six and six, or ten and
/// four is solved by homotopy continuation from a stored fibre, on the threads of the current rayon pool, and
/// extended in the same way. The equations are those of the paper, one dimension more.
///
/// Ranges ([`MinimalOptions::emissions`]) are solved through 5r/5s, 4r/6s or 6r/4s, with 42 or 38 paths; those with one
/// unknown constant through 5r/5s, with 42 paths for each real one of the four constants that a determinant leaves,
/// or through 4r/7s or 7r/4s, with 388.
///
/// Measurements with more errors than `tolerance` allows make a warning: the network is then not to be
/// relied upon, and need not be that of least squares.
#[derive(Default)]
pub struct Solver {
    engines: Engines<3>,
}

impl Solver {
    /// A solver. Start solutions are unpacked when they are first needed.
    pub fn new() -> Self {
        Self::default()
    }

    /// Every network in space that explains the measurements, best first:
    /// [`solve_watched`](Self::solve_watched) without a monitor.
    ///
    /// # Errors
    /// Those of [`solve_watched`](Self::solve_watched).
    pub fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
    ) -> Result<MinimalSolution<3>, MinimalError> {
        self.solve_watched(measured, options, &Monitor::default())
    }

    /// Every network in space that explains the measurements, best first; a cancelled monitor ends it. Any
    /// rotation or reflection of the result fits as well.
    ///
    /// # Errors
    /// If the matrix is too small or too large, a measurement is missing, two nodes coincide, nodes are in
    /// special position, no network in space explains the measurements, a setting of the tracker is out of
    /// range, a size that takes paths is asked for from a polyhedral start, or the monitor is cancelled.
    pub fn solve_watched(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution<3>, MinimalError> {
        let engines = &mut self.engines;
        engines.none_used();
        options.paths.validate()?;
        let of_ranges: Option<&[_]> = match options.emissions {
            Emissions::Unknown => None,
            Emissions::Known => Some(&ranges::IN_SPACE),
            Emissions::Constant => Some(&ranges::IN_SPACE_WITH_CONSTANT),
        };
        if let Some(methods) = of_ranges {
            return ranges::solve(engines, methods, measured, options, monitor);
        }
        check::<3>(measured)?;
        let fits = |method: &&Method| {
            measured.receivers() >= method.receivers && measured.transmitters() >= method.transmitters
        };
        if DIRECT.iter().any(|method| fits(&method)) {
            return among(engines, &mut DIRECT.iter().filter(fits), measured, options, monitor);
        }
        let Some(method) = WITH_PATHS.iter().find(fits) else {
            return Err(MinimalError::NotSolvedInSpace { configuration: measured.configuration() });
        };
        if options.start != MinimalStart::Stored {
            return Err(MinimalError::StoredOnly { configuration: measured.configuration() });
        }
        match plane(measured) {
            Some(plane) => Err(plane),
            None => among(engines, &mut std::iter::once(method), measured, options, monitor),
        }
    }

    /// Proofs, in interval arithmetic, that the complex roots that the last call tracked exist and are
    /// distinct ([`hc::certify()`]). `None` if the last call tracked none. For a larger network these are
    /// the roots of the part that was solved.
    pub fn prove(&self) -> Option<RootProofs> {
        self.prove_watched(&Monitor::default())
    }

    /// [`prove`](Self::prove), watched: `None` once the monitor is cancelled.
    pub fn prove_watched(&self, monitor: &Monitor) -> Option<RootProofs> {
        self.engines.prove(monitor)
    }
}

/// What the first method finds that explains the measurements, or the one that comes nearest.
fn among(
    engines: &mut Engines<3>,
    methods: &mut dyn Iterator<Item = &Method>,
    measured: &Pseudoranges,
    options: &MinimalOptions,
    monitor: &Monitor,
) -> Result<MinimalSolution<3>, MinimalError> {
    let enough = allowed(measured, options);
    let (mut best, mut failure) = (None::<MinimalSolution<3>>, None);
    for method in methods {
        for part in (method.parts)(measured) {
            let selected = measured.select(&part.receivers, &part.transmitters);
            // Only all measurements together tell which candidate of a part is the network.
            let is_whole = selected.cells().values().len() == measured.cells().values().len();
            let first_under = options.first_under.filter(|_| is_whole);
            let settings = MinimalOptions { first_under, ..options.clone() };
            let found = match (method.solve)(engines, &selected, &settings, monitor) {
                Ok(found) => found,
                Err(error) => {
                    failure = failure.or(Some(error));
                    continue;
                }
            };
            if monitor.is_cancelled() {
                return Err(MinimalError::Cancelled);
            }
            let mut candidates = candidates_of_whole(measured, &part, found.networks.iter(), options);
            candidates.sort_by(|a, b| a.residual.total_cmp(&b.residual));
            let explaining = candidates.iter().filter(|candidate| candidate.residual <= enough).count();
            // Of measurements that no network explains, the one that comes nearest.
            candidates.truncate(explaining.max(1));
            leave_out_copies(&mut candidates);
            let Some(first) = candidates.first() else {
                // Solutions that generic data have are missing, perhaps the network among them.
                let special = found.paths.failed + found.paths.at_infinity > 0;
                failure = failure.or(special.then_some(MinimalError::SpecialPosition));
                continue;
            };
            if best.as_ref().is_some_and(|best| best.candidates[0].residual <= first.residual) {
                continue;
            }
            let physical = candidates.iter().filter(|candidate| candidate.physical).count();
            let warnings = warnings_in_space(measured, &found.paths, first, options);
            rank(&mut candidates);
            let solution = MinimalSolution {
                emissions: Emissions::Unknown,
                configuration: measured.configuration(),
                solver: method.name,
                paths: found.paths,
                counts: RootCounts { physical, ..found.counts },
                stopped_early: found.stopped_early,
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
    match (plane(measured), best, failure) {
        (Some(plane), ..) => Err(plane),
        (None, Some(best), _) => Ok(best),
        (None, None, failure) => Err(failure.unwrap_or(MinimalError::NoNetwork)),
    }
}

/// How networks of one size and all larger ones are solved.
struct Method {
    name: &'static str,
    receivers: usize,
    transmitters: usize,
    /// Parts of its size that are tried, the most promising first; some take all receivers.
    parts: fn(&Pseudoranges) -> Vec<Subset>,
    solve: fn(&mut Engines<3>, &Pseudoranges, &MinimalOptions, &Monitor) -> Result<Found, MinimalError>,
}

/// Methods without paths, linear equations first.
const DIRECT: [Method; 3] = [
    Method { name: "9r/5s", receivers: FEWEST, transmitters: 5, parts: fives, solve: five },
    Method {
        name: "7r/6s",
        receivers: 7,
        transmitters: 6,
        parts: |f| ranked(f, 7, 6, TRIED),
        solve: |_, f, _, _| seven_six(f),
    },
    Method {
        name: "6r/8s",
        receivers: 6,
        transmitters: 8,
        parts: |f| ranked(f, 6, 8, TRIED),
        solve: |_, f, _, _| six_eight(f),
    },
];

/// Methods with paths, those with few first.
const WITH_PATHS: [Method; 4] =
    [tracked::<Dual<EightFive>>(), tracked::<Dual<SevenFive>>(), tracked::<SixSix>(), tracked::<Dual<TenFour>>()];

/// The method of a formulation, for the part whose nodes are farthest apart.
const fn tracked<F: FormulationIn<3> + 'static>() -> Method
where
    Engine<F, 3>: PathSolver<3>,
{
    Method {
        name: F::NAME,
        receivers: F::RECEIVERS,
        transmitters: F::TRANSMITTERS,
        parts: |f| ranked(f, F::RECEIVERS, F::TRANSMITTERS, 1),
        solve: by_paths::<F>,
    }
}

fn five(_: &mut Engines<3>, measured: &Pseudoranges, _: &MinimalOptions, _: &Monitor) -> Result<Found, MinimalError> {
    let counts = RootCounts { complex: 1, real: 1, positive_definite: 1, physical: 0 };
    Ok(Found::directly(vec![five_transmitters(measured)?], counts))
}

fn by_paths<F: FormulationIn<3> + 'static>(
    engines: &mut Engines<3>,
    measured: &Pseudoranges,
    options: &MinimalOptions,
    monitor: &Monitor,
) -> Result<Found, MinimalError>
where
    Engine<F, 3>: PathSolver<3>,
{
    let solution = engines.used::<F>().solve(measured, options, monitor)?;
    Ok(Found {
        networks: solution.candidates.into_iter().map(|candidate| candidate.network).collect(),
        paths: solution.paths,
        counts: solution.counts,
        stopped_early: solution.stopped_early,
    })
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
    let (m, n) = (measured.receivers(), measured.transmitters());
    if n == 4 && m >= SHOWING {
        let scaled = Scaled::<4>::new(measured)?;
        return are_flat(&scaled.values, precision(measured, scaled.unit)).then_some(MinimalError::InOnePlane);
    }
    // Fives of eight receivers are not ranked.
    if n < 5 || m < SHOWING || (n > 5 && m < FEWEST) {
        return None;
    }
    let part = fives(measured).into_iter().next()?;
    cause(&measured.select(&part.receivers, &part.transmitters))
}

/// Which nodes lie in one plane, if that is why five transmitters cannot be solved.
fn cause(five: &Pseudoranges) -> Option<MinimalError> {
    let scaled = Scaled::new(five)?;
    in_one_plane(&scaled.values, precision(five, scaled.unit), five.transmitter_names())
}

/// How well measurements are known in units of this many metres.
fn precision(measured: &Pseudoranges, unit: f64) -> f64 {
    let largest = measured.cells().values().iter().fold(0.0f64, |a, v| a.max(v.abs()));
    DEGENERATE.max(rounding(largest) / unit)
}
