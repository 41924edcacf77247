//! One entry point for all sizes.

use super::check::check;
use super::doubts::warnings;
use super::engine::Engine;
use super::engines::{Engines, PathSolver};
use super::error::MinimalError;
use super::formulation::FormulationIn;
use super::larger::extend;
use super::linear::LeastSquares;
use super::normalised::{Normalised, rank};
use super::options::MinimalOptions;
use super::planar::collinear::Collinear;
use super::planar::four_five::FourFive;
use super::planar::rank::{FiveSix, by_receivers, offsets_of_four};
use super::planar::three::{FiveFour, SixThree};
use super::polish::NetworkPolisher;
use super::proofs::RootProofs;
use super::ranges;
use super::solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
use super::subset::{self, Subset};
use crate::clocks::Emissions;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;
use hc::tracker::PathResult;

/// Every network that explains the measurements, best first: [`Solver::solve`] with a new solver.
///
/// # Errors
/// If the matrix is too small, a measurement is missing, or two nodes coincide.
pub fn solve(measured: &Pseudoranges, options: &MinimalOptions) -> Result<MinimalSolution, MinimalError> {
    Solver::new().solve(measured, options)
}

/// Solver for small networks. It chooses the method by size, and keeps its memory from call to
/// call.
#[derive(Default)]
pub struct Solver {
    engines: Engines<2>,
    data: Normalised,
    squares: LeastSquares,
    polisher: NetworkPolisher,
}

/// The method for a size.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    SixThree,
    FiveFour,
    FourFive,
    FiveSix,
    SevenFour,
}

impl Method {
    /// Offsets by rank need most measurements and are nearly free; then as few paths as possible.
    fn pick(m: usize, n: usize) -> Self {
        match (m, n) {
            (_, 3) => Method::SixThree,
            (4, _) => Method::FourFive,
            (7.., _) => Method::SevenFour,
            (_, 6..) => Method::FiveSix,
            _ => Method::FiveFour,
        }
    }

    /// What to do where offsets by rank are not determined.
    fn fallback(self) -> Option<Self> {
        matches!(self, Method::SevenFour | Method::FiveSix).then_some(Method::FiveFour)
    }
}

impl Solver {
    /// A solver. Start solutions are unpacked when they are first needed.
    pub fn new() -> Self {
        Self::default()
    }

    /// Every network that explains the measurements, best first.
    ///
    /// Networks whose receivers or transmitters lie exactly in one line are found without paths,
    /// together with all mirror images of the other nodes, and a warning names the nodes.
    /// [`MinimalSolution::counts`] counts roots at the ends of paths.
    ///
    /// The minimal sizes 6r/3s and 4r/5s, 5r/4s, and 5r/6s are solved by homotopy continuation, and
    /// 7r/4s linearly. Larger sizes are solved through the best spread part of one of these sizes:
    /// its candidates are extended to all nodes and refined over all measurements.
    ///
    /// Ranges ([`MinimalOptions::emissions`]) of three receivers and transmitters or more are solved through 3r/3s, those with
    /// one unknown constant through 3r/4s or 4r/3s.
    ///
    /// # Errors
    /// If the matrix is too small or too large, a measurement is missing, two nodes coincide, a
    /// setting of the tracker is out of range, or ranges are negative or those of nodes in one line.
    pub fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
    ) -> Result<MinimalSolution, MinimalError> {
        self.solve_watched(measured, options, &Monitor::default())
    }

    /// [`solve`](Self::solve), watched: a cancelled monitor ends it.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve), and [`MinimalError::Cancelled`] for the polyhedral route.
    pub fn solve_watched(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution, MinimalError> {
        options.paths.validate()?;
        let of_ranges: Option<&[_]> = match options.emissions {
            Emissions::Unknown => None,
            Emissions::Known => Some(&ranges::IN_PLANE),
            Emissions::Constant => Some(&ranges::IN_PLANE_WITH_CONSTANT),
        };
        if let Some(methods) = of_ranges {
            return ranges::solve(&mut self.engines, methods, measured, options, monitor);
        }
        let (m, n) = (measured.receivers(), measured.transmitters());
        check::<2>(measured)?;
        let method = Method::pick(m, n);
        let mut solution = self.solve_by(method, measured, options, monitor)?;
        if let Some(other) = method.fallback()
            && solution.candidates.is_empty()
        {
            solution = self.solve_by(other, measured, options, monitor)?;
        }
        self.data.take(measured);
        let line = Collinear::find(self.data.parameters(), n, &mut self.squares);
        if let Some(line) = &line {
            self.add_mirrored(line, &mut solution.candidates, measured, options);
        }
        solution.warnings = warnings(measured, &solution.paths, &solution.candidates, line.as_ref());
        Ok(solution)
    }

    /// Puts the networks with nodes in one line in the place of those among the candidates.
    fn add_mirrored(
        &mut self,
        line: &Collinear,
        candidates: &mut Vec<Candidate>,
        measured: &Pseudoranges,
        options: &MinimalOptions,
    ) {
        let data = &self.data;
        candidates.retain(|candidate| {
            let mut network = candidate.network.clone();
            data.enter(&mut network);
            !line.covers(&network)
        });
        for network in line.networks() {
            let mut candidate = data.candidate(network, options, &mut self.polisher);
            data.restore(&mut candidate.network);
            candidate.residual = candidate.network.rms(measured);
            candidates.push(candidate);
        }
        rank(candidates);
    }

    /// Proofs, in interval arithmetic, that the complex roots that the last call tracked exist and
    /// are distinct ([`hc::certify()`]). `None` if the last call tracked none. For a larger network
    /// these are the roots of the part that was solved.
    pub fn prove(&self) -> Option<RootProofs> {
        self.prove_watched(&Monitor::default())
    }

    /// [`prove`](Self::prove), watched: `None` once the monitor is cancelled.
    pub fn prove_watched(&self, monitor: &Monitor) -> Option<RootProofs> {
        self.engines.prove(monitor)
    }

    /// The records of the paths of the last call.
    pub fn records(&self) -> &[PathResult] {
        self.engines.records()
    }

    fn solve_by(
        &mut self,
        method: Method,
        measured: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution, MinimalError> {
        let engines = &mut self.engines;
        match method {
            Method::SixThree => through::<SixThree>(engines, measured, options, monitor),
            Method::FiveFour => through::<FiveFour>(engines, measured, options, monitor),
            Method::FourFive => through::<FourFive>(engines, measured, options, monitor),
            Method::FiveSix => through::<FiveSix>(engines, measured, options, monitor),
            Method::SevenFour => {
                engines.none_used();
                Ok(seven_four(measured, options))
            }
        }
    }
}

/// Solves a part of the formulation's size, and the rest from there.
fn through<F: FormulationIn + 'static>(
    engines: &mut Engines<2>,
    measured: &Pseudoranges,
    options: &MinimalOptions,
    monitor: &Monitor,
) -> Result<MinimalSolution, MinimalError>
where
    Engine<F>: PathSolver<2>,
{
    let engine = engines.used::<F>();
    if (measured.receivers(), measured.transmitters()) == (F::RECEIVERS, F::TRANSMITTERS) {
        engine.solve(measured, options, monitor)
    } else {
        let part = subset::best(measured, F::RECEIVERS, F::TRANSMITTERS);
        // Only all measurements together tell which candidate of the part is the network.
        let whole = MinimalOptions { first_under: None, ..options.clone() };
        let solution = engine.solve(&measured.select(&part.receivers, &part.transmitters), &whole, monitor)?;
        Ok(extend(measured, &part, solution, options))
    }
}

/// Seven or more receivers, four or more transmitters: the offsets of the four best spread
/// transmitters by rank, then everything linearly.
fn seven_four(measured: &Pseudoranges, options: &MinimalOptions) -> MinimalSolution {
    let m = measured.receivers();
    let four = subset::best(measured, m, 4).transmitters;
    let part = Subset { receivers: (0..m).collect(), transmitters: four };
    let selected = measured.select(&part.receivers, &part.transmitters);
    let data = Normalised::new(&selected);
    let mut counts = RootCounts::default();
    let mut candidates = Vec::new();
    let mut squares = LeastSquares::default();
    if let Some(p) = offsets_of_four(data.parameters(), &mut squares) {
        (counts.complex, counts.real) = (1, 1);
        if let Some(network) = by_receivers(data.parameters(), &p, &mut squares) {
            counts.positive_definite = 1;
            let mut candidate = data.candidate(network, options, &mut NetworkPolisher::default());
            counts.physical = usize::from(candidate.physical);
            data.restore(&mut candidate.network);
            candidates.push(candidate);
        }
    }
    let solution = MinimalSolution {
        emissions: Emissions::Unknown,
        configuration: selected.configuration(),
        solver: "7r/4s",
        paths: PathCounts::default(),
        counts,
        stopped_early: false,
        warnings: Vec::new(),
        candidates,
    };
    extend(measured, &part, solution, options)
}

#[cfg(test)]
mod tests {
    use super::Solver;
    use crate::minimal::MinimalSolution;
    use crate::minimal::{MinimalOptions, MinimalStart};
    use crate::simulate::{Layout, SimulateOptions, simulate};

    /// The stored start and a polyhedral one give one set of networks, no more and no fewer; of
    /// 6r/3s one for the data and one for a random member.
    #[test]
    fn the_polyhedral_route_finds_the_same_networks() {
        let mut solver = Solver::new();
        for (receivers, transmitters, seeds) in [(5, 6, 0..12), (6, 3, 0..2)] {
            for seed in seeds {
                let simulation = simulate(&SimulateOptions {
                    receivers,
                    transmitters,
                    layout: Layout::Normal,
                    noise: 0.0,
                    seed,
                    ..SimulateOptions::default()
                })
                .unwrap();
                let mut options = MinimalOptions::default();
                let stored = solver.solve(&simulation.pseudoranges, &options).unwrap();
                options.start = MinimalStart::Polyhedral;
                let scratch = solver.solve(&simulation.pseudoranges, &options).unwrap();
                let proofs = solver.prove().unwrap();
                assert_eq!((proofs.roots, proofs.real), (scratch.counts.complex, scratch.counts.real), "seed {seed}");
                assert_eq!((proofs.proved, proofs.unseparated), (proofs.roots, 0), "seed {seed}");
                assert_eq!((scratch.counts, scratch.paths.failed), (stored.counts, 0), "seed {seed}");
                // In order of the first offset, the candidates agree one by one.
                let offsets = |solution: &MinimalSolution| {
                    let mut all: Vec<_> = solution.candidates.iter().map(|c| c.network.offsets.clone()).collect();
                    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
                    all.concat()
                };
                let (stored, scratch) = (offsets(&stored), offsets(&scratch));
                assert_eq!(stored.len(), scratch.len(), "seed {seed}");
                let near = stored.iter().zip(&scratch).all(|(a, b)| (a - b).abs() < 1e-6 * (1.0 + a.abs()));
                assert!(near, "seed {seed}: {stored:?} {scratch:?}");
            }
        }
    }
}
