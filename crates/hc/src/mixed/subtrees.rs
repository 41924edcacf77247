//! Mixed volumes on several ranks, each of which searches some subtrees.

use super::cells::{MixedVolume, Ordered, Total, total};
use super::error::MixedError;
use super::search::{SubtreeRoot, divided, search_in};
use super::space::Space;
use crate::checkpoint::{Hash, Job, System};
use crate::monitor::{Monitor, Stage};
use crate::ranks::{DividedWork, Lead, Shareable, Worker};
use crate::run::RanksRun;
use crate::runner::{Flow, Policy, Round, RunMemory, Work, run};
// One thread needs no trait for `map`.
#[cfg_attr(not(feature = "threads"), allow(unused_imports))]
use crate::threads::{IntoParallelRefIterator, ParallelIterator};

/// Subtrees at least, unless the whole tree is smaller: enough for many ranks, though some are much
/// larger than others.
const SUBTREES: usize = 1 << 10;
/// Number of subtrees in a batch, after which progress is reported.
const BATCH: usize = 1 << 6;
/// A subtree counts for so many paths where portions are made.
const WEIGHT: usize = 1 << 5;

impl RanksRun<'_> {
    /// [`mixed_volume`](fn@crate::mixed_volume) on all ranks. Every rank divides the search into
    /// the same subtrees. Rank 0 hands them out, and adds up what is found.
    ///
    /// # Errors
    /// Those of [`Run::mixed_volume`](crate::Run::mixed_volume); on rank 0 also if another rank
    /// fails or has other supports.
    pub fn mixed_volume(&self, unknowns: usize, supports: &[Vec<Vec<i32>>]) -> Result<Option<MixedVolume>, MixedError> {
        let Some(ranks) = self.ranks else { return self.run.mixed_volume(unknowns, supports).map(Some) };
        let monitor = self.run.monitor();
        self.run.install(|| {
            let fingerprint = job(unknowns, supports).fingerprint();
            if ranks.is_lead() {
                return Lead::at(ranks, &fingerprint, |lead| {
                    // Here, so that the other ranks hear of it.
                    self.run.unrecorded("a mixed volume")?;
                    led(unknowns, supports, monitor, lead).map(Some)
                });
            }
            Worker::at(ranks, &fingerprint, |worker| serve(unknowns, supports, worker).map(|()| None))
        })
    }
}

/// What all ranks do.
fn job(unknowns: usize, supports: &[Vec<Vec<i32>>]) -> Job {
    // Each point with its length, each support with its number of points.
    let numbers = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let parts = supports.iter().flat_map(|points| {
        let count = (points.len() as u64).to_le_bytes().to_vec();
        points.iter().map(|point| numbers(point)).chain([count])
    });
    let system = System { unknowns: Vec::new(), equations: unknowns, hash: Hash::of(parts) };
    Job::new("mixed-volume", system, &())
}

/// The work at rank 0.
fn led(
    unknowns: usize,
    supports: &[Vec<Vec<i32>>],
    monitor: &Monitor,
    lead: &Lead<'_>,
) -> Result<MixedVolume, MixedError> {
    monitor.enter(Stage::MixedCells, 0);
    let Some(ordered) = Ordered::new(unknowns, supports)? else { return Ok(MixedVolume { volume: 0, cells: 0 }) };
    // The others divide the tree meanwhile.
    lead.begin_part(&(), WEIGHT);
    // Cells are told of once their subtree counts.
    let quiet = monitor.quiet();
    let space = Space::new(ordered.supports, None, &quiet);
    let mut first = Total::new(&quiet);
    let tasks = divided(&space, SUBTREES, &mut first)?;
    let count = tasks.len();
    let mut sum = Sum { divided: Divided { space: &space, tasks }, monitor, volume: 0, cells: 0, done: 0, fits: true };
    sum.add(Some(total(vec![first])?));
    let mut work = DividedWork::new(sum, Some(lead), monitor);
    let policy = Policy { retries: 0, charts: 1, again: 0, first: BATCH, batch: BATCH };
    run(&mut work, count, &policy, &mut RunMemory::default(), monitor);
    if let Some(error) = lead.failure() {
        return Err(error.into());
    }
    let Sum { volume, cells, done, fits, .. } = work.into_inner();
    match u64::try_from(volume) {
        Ok(volume) if fits && done == count => Ok(MixedVolume { volume, cells }),
        Ok(_) if fits => Err(MixedError::Cancelled),
        _ => Err(MixedError::TooLarge),
    }
}

/// The work at another rank than the first.
fn serve(unknowns: usize, supports: &[Vec<Vec<i32>>], worker: &Worker<'_>) -> Result<(), MixedError> {
    while let Some(task) = worker.next::<()>()? {
        let Some(ordered) = Ordered::new(unknowns, supports)? else { continue };
        let space = Space::new(ordered.supports, None, &task.monitor);
        let tasks = match divided(&space, SUBTREES, &mut Total::new(&task.monitor)) {
            // Rank 0 needs nothing more.
            Err(MixedError::Cancelled) => continue,
            tasks => tasks?,
        };
        let divided = Divided { space: &space, tasks };
        worker.serve(&task, |numbers, _| divided.searched(numbers))?;
    }
    Ok(())
}

/// The number of a subtree, and its volume and cells; none where volumes are too large.
type SubtreeVolume = (usize, Option<(u128, usize)>);

/// A tree in subtrees, which all ranks number alike.
struct Divided<'a> {
    space: &'a Space,
    tasks: Vec<SubtreeRoot>,
}

impl Divided<'_> {
    /// What is in the subtrees with these numbers, up to the first that was not searched to its end.
    fn searched(&self, numbers: &[usize]) -> Vec<SubtreeVolume> {
        let Divided { space, tasks } = self;
        let searched = |&number: &usize| {
            let task = tasks.get(number)?.clone();
            match search_in(space, task, || Total::new(&space.monitor)).and_then(total) {
                Ok(found) => Some((number, Some(found))),
                Err(MixedError::Cancelled) => None,
                Err(_) => Some((number, None)),
            }
        };
        let found: Vec<Option<SubtreeVolume>> = numbers.par_iter().map(searched).collect();
        found.into_iter().map_while(|found| found).collect()
    }
}

/// The sum over the subtrees.
struct Sum<'a> {
    divided: Divided<'a>,
    monitor: &'a Monitor,
    volume: u128,
    cells: usize,
    /// Subtrees so far.
    done: usize,
    /// Whether no volume was too large.
    fits: bool,
}

impl Sum<'_> {
    fn add(&mut self, found: Option<(u128, usize)>) {
        let sum = found.and_then(|(volume, cells)| Some((self.volume.checked_add(volume)?, cells)));
        self.fits &= sum.is_some();
        if let Some((volume, cells)) = sum {
            let more = u64::try_from(volume - self.volume).unwrap_or(u64::MAX);
            self.volume = volume;
            self.cells += cells;
            self.monitor.add(cells as u64, more);
        }
    }
}

impl Work for Sum<'_> {
    type Batch = Vec<SubtreeVolume>;
    type Memory = ();

    fn batch(&self, (): &mut (), numbers: &[usize], _: Round, batch: &mut Vec<SubtreeVolume>) {
        *batch = self.divided.searched(numbers);
    }

    fn absorb(&mut self, batch: &mut Vec<SubtreeVolume>, _: Round) -> Flow {
        for (_, found) in batch.drain(..) {
            self.add(found);
            self.done += 1;
        }
        if self.fits { Flow::On } else { Flow::Abandoned }
    }
}

impl Shareable for Sum<'_> {
    type End = SubtreeVolume;

    fn ends(&self, numbers: &[usize], _: Round) -> Vec<SubtreeVolume> {
        self.divided.searched(numbers)
    }

    fn is_end(&self, (found, _): &SubtreeVolume, number: usize) -> bool {
        *found == number
    }

    fn gather(&self, ends: Vec<SubtreeVolume>, batch: &mut Vec<SubtreeVolume>) {
        *batch = ends;
    }
}
