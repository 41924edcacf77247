//! The path runner: rounds of tracking, first of all paths, then of those whose ends are in doubt.
//!
//! [`run`] is the one loop of the crate that tracks paths, looks at their ends, and tracks doubtful
//! ones again. What is tracked, how ends are judged and which ends are in doubt is the business of
//! a [`Work`]: its batches are functions of numbers of paths and a round, and their records are
//! absorbed in any order.

use crate::monitor::Monitor;

/// One pass over some of the paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Round {
    /// How strict the steps are: 0 as the settings say, each further level about half as long.
    pub(crate) level: u32,
    /// The chart in which paths are tracked.
    pub(crate) chart: usize,
}

impl Round {
    /// The first: all paths, as the settings say.
    pub(crate) const FIRST: Round = Round { level: 0, chart: 0 };

    /// Whether paths are tracked for the first time.
    pub(crate) fn is_first(self) -> bool {
        self == Round::FIRST
    }
}

/// Whether a run goes on after a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    /// It does.
    On,
    /// No: what was sought is found.
    Found,
    /// No: it leads nowhere.
    Abandoned,
}

/// Paths, and how their ends are judged.
pub(crate) trait Work {
    /// Plain records of some paths.
    type Batch;
    /// Scratch space of a batch.
    type Memory;

    /// Called before a round of `count` paths.
    fn begin(&mut self, _round: Round, _count: usize) {}

    /// Told before a batch which paths of the round come after it, as long as it goes on.
    fn ahead(&self, _numbers: &[usize]) {}

    /// Tracks the paths with these numbers to their ends: a function of the arguments alone, or
    /// where a round goes on from broken ends, of these too.
    fn batch(&self, memory: &mut Self::Memory, numbers: &[usize], round: Round, batch: &mut Self::Batch);

    /// Takes the records in; the order of batches does not matter.
    fn absorb(&mut self, batch: &mut Self::Batch, round: Round) -> Flow;

    /// Finishes what `absorb` left open of a batch, such as endgames.
    fn close(&mut self, _memory: &mut Self::Memory, _batch: &mut Self::Batch, _round: Round) -> Flow {
        Flow::On
    }

    /// Writes the numbers of the paths whose ends are in doubt to `which`, ascending.
    fn doubtful(&mut self, memory: &mut Self::Memory, which: &mut Vec<usize>);

    /// Whether another level is not worth its while after one that left `after` of `before` paths
    /// in doubt.
    fn is_hopeless(&mut self, _level: u32, _before: usize, _after: usize) -> bool {
        false
    }
}

/// How often, in how many charts and in which portions paths are tracked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Policy {
    /// Levels of stricter steps.
    pub(crate) retries: u32,
    /// Number of charts.
    pub(crate) charts: usize,
    /// Paths of the first batch, at least 1.
    pub(crate) first: usize,
    /// Paths of a batch, at least 1.
    pub(crate) batch: usize,
}

/// How a run went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outcome {
    /// Tracks that were run a second time or more often.
    pub(crate) retracked: usize,
    /// Why it ended, if not because nothing was in doubt any more or everything had been tried.
    pub(crate) flow: Flow,
}

/// The memory of a run, which may serve again.
#[derive(Debug, Default)]
pub(crate) struct Room<M, B> {
    pub(crate) memory: M,
    pub(crate) batch: B,
    /// Paths that are tracked, then those in doubt: what a run leaves here is in doubt to the end.
    pub(crate) which: Vec<usize>,
}

/// Tracks the paths `0 .. count`, and again those in doubt, until none is or the policy ends.
pub(crate) fn run<W: Work>(
    work: &mut W,
    count: usize,
    policy: &Policy,
    room: &mut Room<W::Memory, W::Batch>,
    monitor: &Monitor,
) -> Outcome {
    room.which.clear();
    room.which.extend(0..count);
    let mut retracked = 0;
    let flow = pass(work, Round::FIRST, policy, room);
    if flow != Flow::On {
        return Outcome { retracked, flow };
    }
    for level in 0..=policy.retries {
        let before = room.which.len();
        for chart in usize::from(level == 0)..policy.charts {
            if room.which.is_empty() || monitor.is_cancelled() {
                return Outcome { retracked, flow };
            }
            retracked += room.which.len();
            let flow = pass(work, Round { level, chart }, policy, room);
            if flow != Flow::On {
                return Outcome { retracked, flow };
            }
        }
        if work.is_hopeless(level, before, room.which.len()) {
            break;
        }
    }
    Outcome { retracked, flow }
}

/// One round over `room.which`, which then holds the paths in doubt.
fn pass<W: Work>(work: &mut W, round: Round, policy: &Policy, room: &mut Room<W::Memory, W::Batch>) -> Flow {
    let Room { memory, batch, which } = room;
    work.begin(round, which.len());
    let (mut done, mut size) = (0, if round.is_first() { policy.first } else { policy.batch });
    while done < which.len() {
        let (numbers, ahead) = which[done..].split_at(size.clamp(1, which.len() - done));
        work.ahead(ahead);
        work.batch(memory, numbers, round, batch);
        let mut flow = work.absorb(batch, round);
        if flow == Flow::On {
            flow = work.close(memory, batch, round);
        }
        if flow != Flow::On {
            return flow;
        }
        done += numbers.len();
        size = policy.batch;
    }
    work.doubtful(memory, which);
    Flow::On
}
