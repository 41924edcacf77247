//! One fibre to many targets.

use super::compiled::{Family, PointsHash};
use super::error::FamilyError;
use super::fibre::{Fibre, FibreOptions, TargetLimits};
use super::target::{FamilyTrackers, Orbits, TargetTracking};
use crate::checkpoint::{Checkpoint, Job, Part, Recordable, Recorded};
use crate::endgame::EndgameOptions;
use crate::ranks::{DividedWork, Lead, Shareable, Worker};
use crate::run::{RanksRun, Run};
use crate::runner::{Flow, Policy, Round, RunMemory, Work, run};
use crate::solve::{Solutions, SolveOptions};
// One thread needs no trait for `map`.
#[cfg_attr(not(feature = "threads"), allow(unused_imports))]
use crate::threads::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use num_complex::Complex64;
use serde::Serialize;

/// Targets that are tracked before it is asked whether enough are done: the answer depends on no
/// number of threads.
const BLOCK: usize = 256;
/// Solutions of a fibre times targets of a block that is recorded, at most, unless a target has more.
const RECORDED: usize = 1 << 13;

/// Says of the result for a target whether enough is done.
type Enough<'a> = dyn FnMut(usize, &Solutions) -> bool + Send + 'a;

impl Family {
    /// The solutions for many parameter points, from those of a fibre. [`Targets`] has the options,
    /// and [`Targets::run`] gives the result.
    pub fn track<'a, T, Z>(&'a self, fibre: &'a Fibre, targets: &[T]) -> Targets<'a>
    where
        T: AsRef<[Z]>,
        Z: Copy + Into<Complex64>,
    {
        Run::new().track(self, fibre, targets)
    }
}

impl Run {
    /// [`Family::track`], run in this way. Targets with their solutions are recorded. The family,
    /// the fibre, the targets and all options except [`certify`](SolveOptions::certify),
    /// [`only_real`](Targets::only_real) and [`up_to_symmetry`](Targets::up_to_symmetry) must be those of the run that a checkpoint belongs to.
    pub fn track<'a, T, Z>(&self, family: &'a Family, fibre: &'a Fibre, targets: &[T]) -> Targets<'a>
    where
        T: AsRef<[Z]>,
        Z: Copy + Into<Complex64>,
    {
        self.clone().on_ranks(None).track(family, fibre, targets)
    }
}

impl<'a> RanksRun<'a> {
    /// [`Family::track`] on all ranks. The targets are divided. The other ranks get no results; they
    /// return when they are no longer needed.
    pub fn track<T, Z>(&self, family: &'a Family, fibre: &'a Fibre, targets: &[T]) -> Targets<'a>
    where
        T: AsRef<[Z]>,
        Z: Copy + Into<Complex64>,
    {
        let monitor = self.run.monitor().clone();
        let (options, limits) = (SolveOptions::default(), TargetLimits::default());
        let (only_real, up_to_symmetry) = (false, false);
        let tracking = TargetTracking { family, fibre, options, limits, only_real, up_to_symmetry, monitor };
        let targets = targets.iter().map(|p| p.as_ref().iter().map(|&z| z.into()).collect()).collect();
        Targets { tracking, targets, enough: None, run: self.clone() }
    }
}

/// Many targets of a family, about to be tracked in parallel; made by [`Family::track`].
#[must_use = "nothing is tracked before `run` or `transform`"]
pub struct Targets<'a> {
    tracking: TargetTracking<'a>,
    targets: Vec<Vec<Complex64>>,
    enough: Option<Box<Enough<'a>>>,
    run: RanksRun<'a>,
}

impl<'a> Targets<'a> {
    /// Settings. Start systems are not used here. Default [`SolveOptions::default`].
    pub fn options(self, options: &SolveOptions) -> Self {
        Targets { tracking: TargetTracking { options: options.clone(), ..self.tracking }, ..self }
    }

    /// Limits of the work on each target. Default [`TargetLimits::default`]: as many paths are tracked again as there
    /// are, at most.
    pub fn limits(self, limits: &TargetLimits) -> Self {
        Targets { tracking: TargetTracking { limits: *limits, ..self.tracking }, ..self }
    }

    /// Keeps only the real solutions in each result; counts cover all paths. Default false.
    pub fn only_real(self, only_real: bool) -> Self {
        Targets { tracking: TargetTracking { only_real, ..self.tracking }, ..self }
    }

    /// Lists one solution of each orbit under the family's symmetry, a real one if there is one, and says in
    /// [`Solutions::represents`] for how many of what is asked for it stands. Default false.
    pub fn up_to_symmetry(self, up_to_symmetry: bool) -> Self {
        Targets { tracking: TargetTracking { up_to_symmetry, ..self.tracking }, ..self }
    }

    /// Stops after the first target, in their order, for which `enough` returns true. `enough` gets
    /// the number of the target, from 0, and its result.
    pub fn until(self, enough: impl FnMut(usize, &Solutions) -> bool + Send + 'a) -> Self {
        Targets { enough: Some(Box::new(enough)), ..self }
    }

    /// Tracks, and returns a result for each target, in order; fewer results if the work was
    /// cancelled or stopped early.
    ///
    /// # Errors
    /// If the fibre or a target does not fit the family, a stated symmetry of the family is not
    /// one or one is needed that is not stated, an option is out of range, the checkpoint belongs to another run or cannot be written,
    /// or another rank fails.
    pub fn run(self) -> Result<Vec<Solutions>, FamilyError> {
        self.transform(|_, solutions| solutions)
    }

    /// [`run`](Self::run), with the value that `transform` returns for each result. `transform` is
    /// called on many threads with the number of the target, from 0, and its solutions.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn transform<T: Send>(self, transform: impl Fn(usize, Solutions) -> T + Sync) -> Result<Vec<T>, FamilyError> {
        let run = self.run.clone();
        let transform = &transform;
        run.run.install(|| {
            let Some(ranks) = run.ranks else { return self.led(None, transform) };
            let valid = self.validate();
            let fingerprint =
                if valid.is_ok() { job(&self.tracking, &self.targets).fingerprint() } else { String::new() };
            if ranks.is_lead() {
                return Lead::at(ranks, &fingerprint, |lead| self.led(Some(lead), transform));
            }
            Worker::at(ranks, &fingerprint, |worker| self.serve(worker)).map(|()| Vec::new())
        })
    }

    fn validate(&self) -> Result<(), FamilyError> {
        let Targets { tracking, targets, .. } = self;
        tracking.family.check(tracking.fibre)?;
        tracking.options.validate()?;
        tracking.limits.validate()?;
        let system = tracking.family.system();
        let (equations, unknowns) = (system.len(), system.variables().len());
        if tracking.options.certify && equations > unknowns {
            return Err(FamilyError::Uncertifiable { equations, unknowns });
        }
        if tracking.up_to_symmetry && tracking.family.symmetry.is_trivial() {
            return Err(FamilyError::NoSymmetry);
        }
        let parameters = tracking.fibre.parameters.len();
        let unusable = |target: &Vec<Complex64>| target.len() != parameters || target.iter().any(|z| !z.is_finite());
        match targets.iter().position(unusable) {
            Some(k) => Err(FamilyError::Target { target: k + 1, parameters }),
            None => Ok(()),
        }
    }

    /// The work at rank 0, or without others.
    fn led<T: Send>(
        self,
        lead: Option<&Lead<'_>>,
        transform: impl Fn(usize, Solutions) -> T + Sync,
    ) -> Result<Vec<T>, FamilyError> {
        self.validate()?;
        let Targets { tracking, targets, enough, run: RanksRun { run: circumstances, .. } } = self;
        let checkpoint = circumstances.checkpoint();
        tracking.family.check_solutions(tracking.fibre)?;
        let orbits = Orbits::of(tracking.family, tracking.fibre)?;
        if tracking.up_to_symmetry && orbits.is_none() {
            tracking.family.check_symmetry(tracking.fibre)?;
        }
        if let Some(checkpoint) = checkpoint {
            checkpoint.begin(job(&tracking, &targets))?;
        }
        if let Some(lead) = lead {
            lead.begin_part(&(), tracking.fibre.len());
        }
        let (trackers, count) = (tracking.trackers(), targets.len());
        let (monitor, orbits) = (&tracking.monitor, orbits.as_ref());
        let results = Vec::with_capacity(count);
        let work = TargetWork {
            tracking: &tracking,
            trackers,
            orbits,
            targets: &targets,
            enough,
            transform,
            results,
            solutions: 0,
        };
        let block = match checkpoint {
            Some(_) => (RECORDED / tracking.fibre.len().max(1)).clamp(1, BLOCK),
            None => BLOCK,
        };
        let policy = Policy { retries: 0, charts: 1, again: 0, first: block, batch: block };
        let part = checkpoint.map(|checkpoint| Part { checkpoint, number: 0 });
        let mut work = Recorded::new(DividedWork::new(work, lead, monitor), part, monitor);
        run(&mut work, count, &policy, &mut RunMemory::default(), monitor);
        if let Some(error) = checkpoint.and_then(Checkpoint::failure) {
            return Err(error.into());
        }
        match lead.and_then(Lead::failure) {
            Some(error) => Err(error.into()),
            None => Ok(work.into_inner().into_inner().results),
        }
    }

    /// The work at another rank than the first.
    fn serve(mut self, worker: &Worker<'_>) -> Result<(), FamilyError> {
        self.validate()?;
        let orbits = Orbits::of(self.tracking.family, self.tracking.fibre)?;
        let trackers = self.tracking.trackers();
        while let Some(task) = worker.next::<()>()? {
            self.tracking.monitor = task.monitor.clone();
            let (tracking, targets) = (&self.tracking, &self.targets);
            worker.serve(&task, |numbers, _| tracking.solved(&trackers, orbits.as_ref(), targets, numbers))?;
        }
        Ok(())
    }
}

/// Every target, each solved for itself.
struct TargetWork<'r, 'a, T, F> {
    tracking: &'r TargetTracking<'a>,
    trackers: FamilyTrackers<'r>,
    orbits: Option<&'r Orbits>,
    targets: &'r [Vec<Complex64>],
    enough: Option<Box<Enough<'a>>>,
    transform: F,
    results: Vec<T>,
    /// Solutions of all targets so far.
    solutions: u64,
}

impl<T: Send, F: Fn(usize, Solutions) -> T + Sync> Work for TargetWork<'_, '_, T, F> {
    type Batch = Vec<(usize, Solutions)>;
    type Memory = ();

    fn batch(&self, (): &mut (), numbers: &[usize], _: Round, batch: &mut Self::Batch) {
        *batch = self.ends(numbers, Round::FIRST);
    }

    fn absorb(&mut self, batch: &mut Self::Batch, _: Round) -> Flow {
        self.solutions += batch.iter().map(|(_, found)| found.len() as u64).sum::<u64>();
        let (tracking, targets) = (self.tracking, self.targets);
        let finished = |(k, found): &(usize, Solutions)| (*k, tracking.finished(found.clone(), &targets[*k]));
        let mut done: Vec<(usize, Solutions)> = batch.par_iter().map(finished).collect();
        let last = self.enough.as_mut().and_then(|enough| done.iter().position(|(k, found)| enough(*k, found)));
        done.truncate(last.map_or(done.len(), |last| last + 1));
        let transform = &self.transform;
        self.results.extend(done.into_par_iter().map(|(k, found)| transform(k, found)).collect::<Vec<T>>());
        match last {
            Some(_) => Flow::Found,
            None if self.tracking.monitor.is_cancelled() => Flow::Abandoned,
            None => Flow::On,
        }
    }
}

impl<T: Send, F: Fn(usize, Solutions) -> T + Sync> Recordable for TargetWork<'_, '_, T, F> {
    fn is_of(batch: &Self::Batch, numbers: &[usize]) -> bool {
        batch.iter().map(|(k, _)| k).eq(numbers)
    }

    fn solutions(&self) -> u64 {
        self.solutions
    }
}

impl<T: Send, F: Fn(usize, Solutions) -> T + Sync> Shareable for TargetWork<'_, '_, T, F> {
    type End = (usize, Solutions);

    fn ends(&self, numbers: &[usize], _: Round) -> Vec<Self::End> {
        self.tracking.solved(&self.trackers, self.orbits, self.targets, numbers)
    }

    fn is_end(&self, (target, found): &Self::End, number: usize) -> bool {
        *target == number && found.fits(self.tracking.fibre.dimension)
    }

    fn gather(&self, ends: Vec<Self::End>, batch: &mut Self::Batch) {
        *batch = ends;
    }
}

/// What results depend on.
#[derive(Serialize)]
struct TrackInputs<'a> {
    seed: u64,
    paths: &'a FibreOptions,
    endgame: &'a EndgameOptions,
    known: Option<usize>,
    limits: &'a TargetLimits,
    start: PointsHash,
    targets: PointsHash,
}

/// What a checkpoint of this work is of.
fn job(tracking: &TargetTracking<'_>, targets: &[Vec<Complex64>]) -> Job {
    let SolveOptions { seed, paths, endgame, known, .. } = &tracking.options;
    let start = PointsHash::of_fibre(tracking.fibre);
    let targets = PointsHash::new(targets.iter().map(Vec::as_slice));
    let inputs = TrackInputs { seed: *seed, paths, endgame, known: *known, limits: &tracking.limits, start, targets };
    tracking.family.job("track", &inputs)
}
