//! All solutions for some parameters: the search, the steps after it, and the ranks that take part.

use super::compiled::{Family, PointsHash};
use super::error::FamilyError;
use super::fibre::{Fibre, FibreOptions};
use super::group::monodromy_group;
use super::member::{Member, most_paths};
use super::monodromy::LoopSearch;
use super::pair::Pairs;
use super::search::{Monodromy, MonodromyOptions, Stopped, TraceTest};
use super::sides::{Searched, Side};
use super::still::{Still, refined};
use super::trace::{enlarge, trace_test};
use super::verdict::Verdict;
use crate::checkpoint::{Checkpoint, Job, Piece, Pieces};
use crate::distinct::Known;
use crate::monitor::Monitor;
use crate::ranks::{Lead, Worker};
use crate::refine::Refiner;
use crate::run::{RanksRun, Run};
use crate::tolerances::families;
use num_complex::Complex64;
use poly::Interpreter;
use serde::Serialize;

/// The parts of the pieces of [`Family::complete`]: the search goes on in the second with solutions
/// from elsewhere, and in the second last with those alone; in the last a start system is solved.
const AGAIN: u32 = 1;
const TRACE: u32 = 2;
const ALONE: u32 = 8;
const MEMBER: u32 = 9;

impl Family {
    /// All solutions for some generic parameters: a first pair, the solutions that loops in
    /// parameter space find from it, and those of other orbits. The number of roots that the family
    /// states ends the search, unless the options have a number.
    ///
    /// # Errors
    /// If no first solution is found.
    pub fn monodromy(&self, options: &MonodromyOptions) -> Result<Monodromy, FamilyError> {
        Run::new().monodromy(self, options)
    }

    /// All solutions for the parameters of `first`, which has one or several of them. Where loops
    /// bring nothing new, a start system for these parameters is solved if that takes no more paths than
    /// the loops took; otherwise solutions for other parameters are tracked to these parameters.
    ///
    /// # Errors
    /// If `first` belongs to another family or is not a regular solution, an option is out of range, a
    /// stated symmetry is not one, or the enlarged family of a requested [trace test](Self::trace_test)
    /// does not compile.
    pub fn complete(&self, first: &Fibre, options: &MonodromyOptions) -> Result<Monodromy, FamilyError> {
        Run::new().complete(self, first, options)
    }

    /// The trace test of a fibre: whether it is a union of whole orbits. It tells nothing about orbits of
    /// which the fibre has no solution. It takes several times as long as finding the fibre. The option
    /// `patience` applies to the further points that the test needs.
    ///
    /// # Errors
    /// If the fibre belongs to another family, or the enlarged family of the test does not compile.
    pub fn trace_test(&self, fibre: &Fibre, options: &MonodromyOptions) -> Result<TraceTest, FamilyError> {
        Run::new().trace_test(self, fibre, options)
    }

    /// The trace test of a fibre of this family.
    fn traced(&self, fibre: &Fibre, options: &MonodromyOptions, pieces: Pieces<'_>) -> Result<TraceTest, FamilyError> {
        // What its digits do not tell apart from a solution is not left out of a sum.
        let accept = |p: &[Complex64], x: &[Complex64]| !matches!(self.verdict(p, x), Verdict::Misses(_));
        Ok(trace_test(self.square(), fibre, &accept, options, pieces)?)
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
        let options = self.with_roots(options);
        if let Some(checkpoint) = checkpoint {
            checkpoint.begin(self.search_job(first, &options))?;
        }
        let pieces = Pieces::new(checkpoint, monitor, lead);
        let searched = Searched { system: &self.program, enlarged: false };
        let accept = |p: &[Complex64], x: &[Complex64]| self.accepts(p, x);
        let still = Still::new(&self.program, &first.parameters);
        let (moving, apart) = still.parted(&self.polished(first)?);
        let (is_still, symmetry) = (|x: &[Complex64]| still.is(x), &self.symmetry);
        let search =
            LoopSearch { searched: &searched, accept: &accept, is_still: &is_still, symmetry, options: &options };
        let found = search.fill(&moving, pieces);
        let (mut found, apart, member) = match found.stopped {
            Stopped::NoProgress if !options.only_component => {
                self.with_others(&search, &still, found, apart, pieces)?
            }
            _ => (found, apart, None),
        };
        // Of a known number of solutions, these are not counted.
        if found.stopped != Stopped::RootsReached {
            let (fibre, sizes) = search.with_still(found.fibre, &apart, monitor);
            found.fibre = fibre;
            found.orbits.extend(sizes);
            found.orbits.sort_unstable_by(|a, b| b.cmp(a));
        }
        if options.trace_test && matches!(found.stopped, Stopped::NoProgress | Stopped::TooMany) {
            let test = self.traced(&found.fibre, &options, pieces.part(TRACE))?;
            // What an interrupted test says is no deviation.
            found.trace = Some(test).filter(|_| !monitor.is_cancelled());
        }
        if found.stopped == Stopped::NoProgress && monitor.is_cancelled() {
            found.stopped = Stopped::Cancelled;
        }
        judge(&mut found, member, &options);
        if options.group > 0 && found.stopped != Stopped::Cancelled {
            let (paths, alone) = (FibreOptions::default(), Pieces::alone(monitor));
            let group = monodromy_group(&searched, &found.fibre, options.group, &paths, options.seed, alone);
            found.group = Some(group).filter(|_| !monitor.is_cancelled());
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
                enlarged = enlarge(self.square())?;
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

    /// The options, with the number of roots that the family states unless they have one, or ask for a
    /// single orbit.
    fn with_roots(&self, options: &MonodromyOptions) -> MonodromyOptions {
        let of_family = self.roots().filter(|_| !options.only_component);
        MonodromyOptions { roots: options.roots.or(of_family), ..options.clone() }
    }

    /// What a checkpoint of a search is of, and all ranks do.
    fn search_job(&self, first: &Fibre, options: &MonodromyOptions) -> Job {
        self.job("monodromy", &SearchInputs { options, start: PointsHash::of_fibre(first) })
    }

    /// The search goes on with solutions from elsewhere: those of a start system for the same parameters,
    /// and first pairs for other parameters if the start system is too large or has lost paths. On sheets
    /// that nearly part from each other loops of any common size may keep to one, on which the trace test
    /// passes; and no loop leads from one orbit to another.
    fn with_others(
        &self,
        search: &LoopSearch<'_, Interpreter>,
        still: &Still<'_, Interpreter>,
        mut found: Monodromy,
        apart: Vec<Complex64>,
        pieces: Pieces<'_>,
    ) -> Result<(Monodromy, Vec<Complex64>, Option<Member>), FamilyError> {
        let (options, monitor, parameters) = (search.options, pieces.monitor, &found.fibre.parameters);
        let record = (pieces.part(MEMBER), Piece::Whole(0));
        let member: Option<Member> =
            record.0.take(record.1, |member| fits(member, found.fibre.dimension)).unwrap_or_else(|| {
                let member = self.member(parameters, most_paths(found.paths), options.seed, monitor);
                record.0.record(record.1, found.fibre.len(), &member);
                member
            });
        let mut refiner = Refiner::new(&self.program);
        let mut clean = |x: &[Complex64]| {
            let refined = refined(&mut refiner, parameters, x);
            if refined.accuracy < families::ACCURATE { refined.point } else { x.to_vec() }
        };
        let member = member.map(|member| {
            let regular = member.regular.iter().map(|x| clean(x)).collect();
            Member { regular, ..member }
        });
        let is_whole = member.as_ref().is_some_and(|member| member.whole);
        let others = if is_whole {
            Vec::new()
        } else {
            Pairs::new(self.system(), self.square())?.others(options.seed, search.accept)
        };
        let seeds = || member.iter().flat_map(|member| &member.regular).map(Vec::as_slice);
        // What is one for other parameters is one for these.
        let found_still = seeds().chain(others.iter().map(|pair| pair.solution(0))).filter(|x| still.is(x));
        let apart = apart.into_iter().chain(found_still.flatten().copied()).collect();
        found.paths += member.as_ref().map_or(0, |member| member.paths) + others.len();
        if let Some(fibre) = search.joined(&found.fibre, seeds(), &others, monitor) {
            let (mut loops, mut paths) = (found.loops, found.paths);
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
        Ok((found, apart, member))
    }
}

/// Whether a recorded member has points of so many coordinates.
fn fits(member: &Option<Member>, unknowns: usize) -> bool {
    let points = |member: &Member| {
        member.regular.iter().chain(member.multiple.iter().map(|m| &m.value)).all(|x| x.len() == unknowns)
    };
    member.as_ref().is_none_or(points)
}

/// Says why the search ended, and what is known about other solutions.
fn judge(found: &mut Monodromy, member: Option<Member>, options: &MonodromyOptions) {
    let count = found.fibre.len();
    let passed = found.trace.is_some_and(|test| test.passed(count));
    if matches!(found.stopped, Stopped::NoProgress | Stopped::TooMany) {
        let same = |member: &Member| {
            let known = Known::new(member.regular.iter().map(Vec::as_slice));
            member.regular.len() == count && found.fibre.iter().all(|x| known.has(x, options.fibre.coincidence))
        };
        let agrees = member.as_ref().is_some_and(|member| member.whole && same(member));
        // Special parameters, which random ones are not, may have fewer solutions than generic ones. The trace test,
        // which leaves them, tells.
        let generic = found.fibre.parameters.iter().all(|p| p.im != 0.0);
        // A known number that is not reached contradicts what else is known.
        let contradicts = options.roots.is_some_and(|roots| roots != count);
        found.stopped = match (passed, agrees && !contradicts) {
            (true, true) => Stopped::Trace,
            (true, false) if options.only_component => Stopped::ComponentWhole,
            (true, false) if options.roots == Some(count) => Stopped::RootsReached,
            (true, false) => Stopped::OrbitsWhole,
            (false, true) if generic => Stopped::StartSystem,
            (false, _) => found.stopped,
        };
    }
    found.fibre.is_partial = !found.stopped.is_complete();
    found.multiple = member.map_or_else(Vec::new, |member| member.multiple);
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
        self.install(|| family.traced(fibre, options, Pieces::alone(self.monitor())))
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
            let fingerprint = family.search_job(first, &family.with_roots(options)).fingerprint();
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
