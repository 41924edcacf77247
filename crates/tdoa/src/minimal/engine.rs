//! From measurements to all networks that explain them, for any [`Formulation`]: tracks the stored
//! fibre to the data, accounts for every path, and turns real solutions into networks.

use super::error::MinimalError;
use super::formulation::{Formulation, FormulationIn};
use super::linear::LeastSquares;
use super::nearest::Nearest;
use super::normalised::{Normalised, rank};
use super::options::{MinimalOptions, MinimalStart};
use super::polish::NetworkPolisher;
use super::proofs::{RootProofs, prove};
use super::real::real_root;
use super::recharted::Recharted;
use super::scratch;
use super::solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
use crate::clocks::Emissions;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;
use hc::family::{Fibre, FibreTracker};
use hc::refine::{Refined, Refiner};
use hc::tracker::{PathEnd, PathResult, PathSet};
use num_complex::Complex64;

/// Turns of the stored fibre, one after the other where paths stay lost: each gives other paths to
/// the same ends. One more is tried for every two retries that the options allow.
const TURNS: [f64; 3] = [0.0, 0.7, -1.1];

/// More lost paths than this tell of a degenerate network rather than of bad luck.
const BAD_LUCK: usize = 4;

/// Paths tracked at a time where the search stops at the first network that fits: four batches of
/// eight.
const PART: usize = 32;

/// Room for so many candidates is made at once; there are hardly ever more.
const CANDIDATES: usize = 64;

/// A solver of one configuration; keeps its memory from call to call.
pub(crate) struct Engine<F: Formulation, const D: usize = 2> {
    finder: RootFinder<F>,
    roots: RootMemory<F, D>,
    data: Normalised,
    /// The parameters of the last call.
    given: Vec<f64>,
    target: Vec<Complex64>,
    /// Targets and roots of earlier calls that belong to the same measurements.
    kept: Vec<(Vec<Complex64>, Vec<Vec<Complex64>>)>,
}

impl<F: FormulationIn<D>, const D: usize> Engine<F, D> {
    /// A solver with its start solutions.
    pub(crate) fn new() -> Self {
        let stored = F::fibre();
        let start = stored.clone();
        let make = if F::MANY { FibreTracker::on_all_threads } else { FibreTracker::new };
        let finder = RootFinder {
            tracker: make(F::system(), Recharted::default(), &stored),
            nearest: match F::EMISSIONS {
                Emissions::Unknown => Nearest::new(stored, F::RECEIVERS, F::TRANSMITTERS),
                Emissions::Known | Emissions::Constant => Nearest::new(stored, 0, 0),
            },
            start,
            from_scratch: None,
        };
        let roots = RootMemory {
            refiner: Refiner::new(F::system()),
            refined: Refined::default(),
            squares: LeastSquares::default(),
            polisher: NetworkPolisher::default(),
        };
        Engine { finder, roots, data: Normalised::default(), given: Vec::new(), target: Vec::new(), kept: Vec::new() }
    }

    /// Every network that explains a matrix of the formulation's size that has passed the checks,
    /// warnings left to the caller. After the first call memory is allocated for the result alone,
    /// unless all paths have to be tracked again or a root is so ill-conditioned that only
    /// double-double tells it from a singular one.
    pub(crate) fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution<D>, MinimalError> {
        let size = (measured.receivers(), measured.transmitters());
        assert_eq!(size, (F::RECEIVERS, F::TRANSMITTERS), "size of the matrix");
        assert_eq!(measured.emissions(), F::EMISSIONS, "kind of measurements");
        let orders = F::orders(measured).unwrap_or_else(|| self.finder.nearest.orders(measured));
        self.data.take_in_order(measured, &orders);
        self.given.clear();
        F::given(&self.data, &mut self.given);
        self.target.clear();
        self.target.extend(self.given.iter().map(|&f| Complex64::from(f)));
        let (data, given, target, roots) = (&self.data, &self.given[..], &self.target[..], &mut self.roots);
        let candidates = Vec::with_capacity(CANDIDATES);
        let mut found = RootNetworks::<F, D> {
            measured,
            data,
            options,
            given,
            target,
            roots,
            counts: RootCounts::default(),
            candidates,
        };
        self.finder.tracker.set_monitor(monitor);
        self.finder.from_scratch = None;
        let (paths, stopped_early) = match options.start {
            MinimalStart::Stored => self.finder.run(&mut found),
            MinimalStart::Polyhedral => self.finder.run_polyhedral(&mut found, monitor)?,
        };
        let RootNetworks { counts, mut candidates, .. } = found;
        rank(&mut candidates);
        Ok(MinimalSolution {
            emissions: F::EMISSIONS,
            configuration: measured.configuration(),
            solver: F::NAME,
            paths,
            counts,
            stopped_early,
            warnings: Vec::new(),
            candidates,
        })
    }

    /// The records of the paths of the last call.
    pub(crate) fn records(&self) -> &[PathResult] {
        self.finder.tracker.paths().results()
    }

    /// Forgets the roots that were kept.
    pub(crate) fn forget(&mut self) {
        self.kept.clear();
    }

    /// Keeps the roots of the last call, to be proved with those of the next one.
    pub(crate) fn keep(&mut self) {
        self.kept.push((self.target.clone(), self.last_roots()));
    }

    fn last_roots(&self) -> Vec<Vec<Complex64>> {
        let ends = self.finder.tracker.paths().iter().filter(|(r, _)| r.end == PathEnd::Success);
        match &self.finder.from_scratch {
            Some(fibre) => fibre.iter().map(<[Complex64]>::to_vec).collect(),
            None => ends.map(|(_, x)| x.to_vec()).collect(),
        }
    }

    /// Proofs that the complex roots of the last call, and those kept, exist and are distinct, of one call each; `None` if the
    /// monitor is cancelled.
    pub(crate) fn prove(&self, monitor: &Monitor) -> Option<RootProofs> {
        let mut all = prove::<F>(&self.target, &self.last_roots(), monitor)?;
        for (target, roots) in &self.kept {
            all += prove::<F>(target, roots, monitor)?;
        }
        Some(all)
    }
}

/// What finds the roots: the paths to the data, and where they start.
struct RootFinder<F: Formulation> {
    tracker: FibreTracker<'static, F::System, Recharted<F>>,
    nearest: Nearest,
    /// The stored fibre, turned to the data.
    start: Fibre,
    /// The roots of the last call where no fibre was tracked to them.
    from_scratch: Option<Fibre>,
}

impl<F: Formulation> RootFinder<F> {
    /// Tracks all paths, again from a turned fibre where some stay lost, keeps the most complete
    /// set and adds its roots to `found`. Returns the counts and whether the search stopped at a
    /// network that fits.
    fn run<const D: usize>(&mut self, found: &mut RootNetworks<'_, F, D>) -> (PathCounts, bool)
    where
        F: FormulationIn<D>,
    {
        let (target, options) = (found.target, found.options);
        let mut retracked = 0;
        let mut best: Option<(PathCounts, PathSet)> = None;
        let attempts = 1 + options.paths.retries as usize / 2;
        for (attempt, turn) in TURNS.into_iter().take(attempts).enumerate() {
            retracked += if attempt > 0 { self.nearest.stored().len() } else { 0 };
            self.nearest.turn(target, turn, F::SCALED, F::WEIGHTS, &mut self.start);
            let in_parts = attempt == 0 && options.first_under.is_some();
            let size = if in_parts { PART } else { self.start.len() };
            let enough = |part: &PathSet| in_parts && found.fits_after(part);
            let (counts, early) = self.tracker.track_until(&self.start, target, &options.paths, size, enough);
            if early {
                return (counts, true);
            }
            retracked += counts.retracked;
            if attempt == 0 && counts.failed == 0 {
                best = None;
                break;
            }
            if best.as_ref().is_none_or(|(fewest, _)| counts.failed < fewest.failed) {
                best = Some((counts, self.tracker.paths().clone()));
            }
            // The roots of a degenerate network no other path reaches either.
            if counts.failed == 0 || counts.failed > BAD_LUCK {
                break;
            }
        }
        let failed = best.as_ref().map_or(0, |(counts, _)| counts.failed);
        if let Some((_, paths)) = best {
            self.tracker.set_paths(paths);
        }
        let counts = PathCounts { retracked, ..self.tracker.counts(failed) };
        found.clear();
        for (_, x) in self.tracker.paths().iter().filter(|(r, _)| r.end == PathEnd::Success) {
            found.add(x);
        }
        found.counts.complex = counts.finite;
        (counts, false)
    }

    /// Candidates from a polyhedral start system: for the data, and where that leaves roots missing
    /// through a random member.
    fn run_polyhedral<const D: usize>(
        &mut self,
        found: &mut RootNetworks<'_, F, D>,
        monitor: &Monitor,
    ) -> Result<(PathCounts, bool), MinimalError>
    where
        F: FormulationIn<D>,
    {
        let direct = scratch::at_data::<F>(found.target, monitor)?;
        let mut spent = direct.paths.retracked;
        if !direct.whole {
            let (member, tracked) = scratch::at_random::<F>(found.target, monitor)?;
            spent += tracked;
            if let Some(member) = member {
                spent += direct.paths.tracked;
                let stored = self.nearest.replace(member);
                let (paths, stopped_early) = self.run(found);
                self.nearest.replace(stored);
                if monitor.is_cancelled() {
                    return Err(MinimalError::Cancelled);
                }
                return Ok((PathCounts { retracked: spent + paths.retracked, ..paths }, stopped_early));
            }
        }
        self.tracker.set_paths(PathSet::new(direct.fibre.dimension));
        for root in direct.fibre.solutions.chunks_exact(direct.fibre.dimension) {
            found.add(root);
        }
        found.counts.complex = direct.fibre.len();
        self.from_scratch = Some(direct.fibre);
        Ok((PathCounts { retracked: spent, ..direct.paths }, false))
    }
}

/// What makes networks of roots; keeps its memory.
struct RootMemory<F: Formulation, const D: usize> {
    refiner: Refiner<'static, F::System>,
    refined: Refined,
    squares: LeastSquares,
    polisher: NetworkPolisher<D>,
}

/// The networks of the real roots found so far.
struct RootNetworks<'a, F: Formulation, const D: usize> {
    measured: &'a Pseudoranges,
    data: &'a Normalised,
    options: &'a MinimalOptions,
    given: &'a [f64],
    target: &'a [Complex64],
    roots: &'a mut RootMemory<F, D>,
    counts: RootCounts,
    candidates: Vec<Candidate<D>>,
}

impl<F: FormulationIn<D>, const D: usize> RootNetworks<'_, F, D> {
    fn clear(&mut self) {
        self.counts = RootCounts::default();
        self.candidates.clear();
    }

    /// Counts a root and, if it is real with real positions, adds its network.
    fn add(&mut self, root: &[Complex64]) {
        let RootMemory { refiner, refined, squares, polisher } = &mut *self.roots;
        let Some((x, real)) = real_root::<F>(refiner, self.target, root, self.options.near_real, refined) else {
            return;
        };
        self.counts.real += usize::from(real);
        let Some(network) = F::network(self.given, &x, squares) else { return };
        self.counts.positive_definite += usize::from(real);
        let mut candidate = self.data.candidate(network, self.options, polisher);
        self.counts.physical += usize::from(real && candidate.physical);
        self.data.restore(&mut candidate.network);
        candidate.residual = candidate.network.rms(self.measured);
        self.candidates.push(candidate);
    }

    /// Adds the roots of a part of the paths. Returns whether a network is good enough to stop at.
    fn fits_after(&mut self, part: &PathSet) -> bool {
        for (_, x) in part.iter().filter(|(r, _)| r.end == PathEnd::Success) {
            self.counts.complex += 1;
            self.add(x);
        }
        self.fits()
    }

    /// Whether a network is good enough to stop at.
    fn fits(&self) -> bool {
        let limit = self.options.first_under.unwrap_or(0.0);
        self.candidates.iter().any(|c| c.physical && c.residual < limit)
    }
}
