//! All solutions for some parameters: the search, the steps after it, and the ranks that take part.

use super::compiled::{Family, PointsHash};
use super::error::FamilyError;
use super::fibre::Fibre;
use super::monodromy::LoopSearch;
use super::pair::find_pair;
use super::search::{Monodromy, MonodromyOptions, Stopped, TraceTest};
use super::sides::{Searched, Side};
use super::trace::{enlarge, trace_test};
use crate::checkpoint::{Checkpoint, Job, Pieces};
use crate::monitor::Monitor;
use crate::ranks::{Lead, Worker};
use crate::run::{RanksRun, Run};
use num_complex::Complex64;
use serde::Serialize;

/// Other first pairs, and how often each is tried to be found.
const PAIRS: u64 = 48;
const FEW_TRIES: u64 = 20;
/// The parts of the pieces of [`Family::complete`]: the search goes on in the second with solutions
/// for other parameters, and in the last with those alone.
const AGAIN: u32 = 1;
const TRACE: u32 = 2;
const ALONE: u32 = 8;

impl Family {
    /// All solutions for some generic parameters: a first pair, and the solutions that loops in
    /// parameter space find from it. The number of roots that the family states ends the search,
    /// unless the options have a number.
    ///
    /// # Errors
    /// If no first solution is found.
    pub fn monodromy(&self, options: &MonodromyOptions) -> Result<Monodromy, FamilyError> {
        Run::new().monodromy(self, options)
    }

    /// All solutions for the parameters of `first`, which has one or several of them. Where loops
    /// bring nothing new, solutions for other parameters are tracked to these parameters.
    ///
    /// # Errors
    /// If `first` belongs to another family, an option is out of range, a stated symmetry is not
    /// one, or the enlarged family of a requested [trace test](Self::trace_test) does not compile.
    pub fn complete(&self, first: &Fibre, options: &MonodromyOptions) -> Result<Monodromy, FamilyError> {
        Run::new().complete(self, first, options)
    }

    /// The trace test of a fibre: whether the fibre is whole. It takes several times as long as
    /// finding the fibre. The option `patience` applies to the further points that the test needs.
    ///
    /// # Errors
    /// If the fibre belongs to another family, or the enlarged family of the test does not compile.
    pub fn trace_test(&self, fibre: &Fibre, options: &MonodromyOptions) -> Result<TraceTest, FamilyError> {
        Run::new().trace_test(self, fibre, options)
    }

    /// The work at rank 0, or without others.
    fn complete_led(
        &self,
        first: &Fibre,
        options: &MonodromyOptions,
        monitor: &Monitor,
        checkpoint: Option<&Checkpoint>,
        lead: Option<&Lead<'_>>,
    ) -> Result<Monodromy, FamilyError> {
        self.check_search(first, options)?;
        let options = self.stated(options);
        if let Some(checkpoint) = checkpoint {
            checkpoint.begin(self.search_job(first, &options))?;
        }
        let pieces = Pieces::new(checkpoint, monitor, lead);
        let searched = Searched { system: &self.program, enlarged: false };
        let accept = |p: &[Complex64], x: &[Complex64]| self.accepts(p, x);
        let search = LoopSearch { searched: &searched, accept: &accept, symmetry: &self.symmetry, options: &options };
        let mut found = search.fill(first, pieces);
        if found.stopped == Stopped::NoProgress {
            let others = self.other_pairs(options.seed)?;
            if let Some(fibre) = search.joined(&found.fibre, &others, monitor) {
                let (mut loops, mut paths) = (found.loops, found.paths + others.len());
                let mut again = |from: &Fibre, part: u32| {
                    let found = search.fill(from, pieces.part(part));
                    (loops, paths) = (loops + found.loops, paths + found.paths);
                    Monodromy { loops, paths, ..found }
                };
                // The first pair may be degenerate, and not one of the solutions that are counted.
                let alone = options.roots.map(|_| again(&fibre.without_first(found.fibre.len()), ALONE));
                found = match alone.filter(|alone| alone.stopped != Stopped::NoProgress) {
                    Some(alone) => alone,
                    None => again(&fibre, AGAIN),
                };
            }
        }
        if options.trace_test && matches!(found.stopped, Stopped::NoProgress | Stopped::TooMany) {
            let test = trace_test(self.system(), &found.fibre, &options, pieces.part(TRACE))?;
            // What an interrupted test says is no deviation.
            if monitor.is_cancelled() {
                found.stopped = Stopped::Cancelled;
            } else {
                found.trace = Some(test);
                if test.passed(found.fibre.len()) {
                    found.stopped = Stopped::Trace;
                    found.fibre.is_partial = false;
                }
            }
        }
        if let Some(error) = checkpoint.and_then(Checkpoint::failure) {
            return Err(error.into());
        }
        match lead.and_then(Lead::failure) {
            Some(error) => Err(error.into()),
            None => Ok(found),
        }
    }

    /// Tracks paths for rank 0 as long as it needs any.
    fn serve(&self, worker: &Worker<'_>) -> Result<(), FamilyError> {
        let mut enlarged = None;
        while let Some(task) = worker.next::<Side<'_>>()? {
            if !task.content.enlarged {
                Searched { system: &self.program, enlarged: false }.serve(worker, &task)?;
                continue;
            }
            if enlarged.is_none() {
                enlarged = enlarge(self.system())?;
            }
            if let Some(system) = &enlarged {
                Searched { system, enlarged: true }.serve(worker, &task)?;
            }
        }
        Ok(())
    }

    fn check_search(&self, first: &Fibre, options: &MonodromyOptions) -> Result<(), FamilyError> {
        self.check(first)?;
        options.fibre.validate()?;
        self.check_symmetry(first)
    }

    /// The options, with the number of roots that the family states unless they have one.
    fn stated(&self, options: &MonodromyOptions) -> MonodromyOptions {
        MonodromyOptions { roots: options.roots.or(self.roots()), ..options.clone() }
    }

    /// What a checkpoint of a search is of, and all ranks do.
    fn search_job(&self, first: &Fibre, options: &MonodromyOptions) -> Job {
        self.job("monodromy", &SearchInputs { options, start: PointsHash::of_fibre(first) })
    }

    /// First pairs from other random points. On sheets that nearly part from each other loops of any
    /// common size may keep to one, on which the trace test passes; pairs lie on all.
    fn other_pairs(&self, seed: u64) -> Result<Vec<Fibre>, FamilyError> {
        let pair = |k: u64| find_pair(self.system(), |p, x| self.accepts(p, x), seed.wrapping_add(k), FEW_TRIES);
        Ok((1..=PAIRS).map(pair).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }
}

impl Run {
    /// [`Family::monodromy`], run in this way. Loops and steps of the trace test are recorded.
    ///
    /// # Errors
    /// Those of [`Family::monodromy`] and [`complete`](Self::complete).
    pub fn monodromy(&self, family: &Family, options: &MonodromyOptions) -> Result<Monodromy, FamilyError> {
        self.install(|| self.complete(family, &family.find_pair(options.seed)?, options))
    }

    /// [`Family::complete`], run in this way. A monitor that is cancelled ends the search. Loops and
    /// steps of the trace test are recorded. The family, `first` and all options except
    /// [`trace_test`](MonodromyOptions::trace_test) must be those of the run that a checkpoint
    /// belongs to.
    ///
    /// # Errors
    /// As for [`Family::complete`]; also if the checkpoint belongs to another run, or cannot be
    /// written.
    pub fn complete(
        &self,
        family: &Family,
        first: &Fibre,
        options: &MonodromyOptions,
    ) -> Result<Monodromy, FamilyError> {
        self.install(|| family.complete_led(first, options, self.monitor(), self.checkpoint(), None))
    }

    /// [`Family::trace_test`], run in this way.
    ///
    /// # Errors
    /// As for [`Family::trace_test`]; also if there is a checkpoint, since a trace test alone is not
    /// recorded.
    pub fn trace_test(
        &self,
        family: &Family,
        fibre: &Fibre,
        options: &MonodromyOptions,
    ) -> Result<TraceTest, FamilyError> {
        self.unrecorded("a trace test alone")?;
        family.check(fibre)?;
        self.install(|| Ok(trace_test(family.system(), fibre, options, Pieces::alone(self.monitor()))?))
    }
}

impl RanksRun<'_> {
    /// [`Family::complete`] on all ranks. The paths of loops and of the trace test are divided; the
    /// work on their ends is not.
    ///
    /// # Errors
    /// As for [`Run::complete`]; on rank 0 also if another rank fails or has another job.
    pub fn complete(
        &self,
        family: &Family,
        first: &Fibre,
        options: &MonodromyOptions,
    ) -> Result<Option<Monodromy>, FamilyError> {
        let Some(ranks) = self.ranks else { return self.run.complete(family, first, options).map(Some) };
        self.run.install(|| {
            let fingerprint = family.search_job(first, &family.stated(options)).fingerprint();
            if ranks.is_lead() {
                let (monitor, checkpoint) = (self.run.monitor(), self.run.checkpoint());
                return Lead::at(ranks, &fingerprint, |lead| {
                    family.complete_led(first, options, monitor, checkpoint, Some(lead)).map(Some)
                });
            }
            Worker::at(ranks, &fingerprint, |worker| {
                family.check_search(first, options)?;
                family.serve(worker).map(|()| None)
            })
        })
    }
}

/// What a search for solutions depends on.
#[derive(Serialize)]
struct SearchInputs<'a> {
    #[serde(flatten)]
    options: &'a MonodromyOptions,
    start: PointsHash,
}
