//! The path runner: rounds of tracking, first of all paths, then of the paths whose ends are
//! doubtful.
//!
//! [`run`] is the one loop of the crate that tracks paths, judges their ends, and tracks doubtful
//! paths again. A [`Work`] says what is tracked, how ends are judged and which ends are doubtful.
//! Its batches are functions of the numbers of paths and a round. Their records are absorbed in any
//! order.

use crate::monitor::Monitor;
use serde::{Deserialize, Serialize};

/// One pass over some of the paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Round {
    /// How strict the steps are: at level 0 as the settings say, at each further level about half
    /// as long.
    pub(crate) level: u32,
    /// The chart in which paths are tracked.
    pub(crate) chart: usize,
}

impl Round {
    /// The first round: all paths, as the settings say.
    pub(crate) const FIRST: Round = Round { level: 0, chart: 0 };

    /// Whether paths are tracked for the first time.
    pub(crate) fn is_first(self) -> bool {
        self == Round::FIRST
    }
}

/// Whether a run goes on after a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    /// The run goes on.
    On,
    /// The run ends: what was sought is found.
    Found,
    /// The run ends: it leads nowhere.
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

    /// Called before a batch with the paths of the round that come after it, if the run goes on.
    fn ahead(&self, _numbers: &[usize]) {}

    /// Tracks the paths with these numbers to their ends. The result depends only on the arguments;
    /// if a round continues from broken ends, it also depends on those ends.
    fn batch(&self, memory: &mut Self::Memory, numbers: &[usize], round: Round, batch: &mut Self::Batch);

    /// Absorbs the records; the order of batches does not matter.
    fn absorb(&mut self, batch: &mut Self::Batch, round: Round) -> Flow;

    /// Finishes what `absorb` left open in a batch, such as endgames.
    fn close(&mut self, _memory: &mut Self::Memory, _batch: &mut Self::Batch, _round: Round) -> Flow {
        Flow::On
    }

    /// Writes the numbers of the paths whose ends are doubtful to `which`, in ascending order; by default none.
    fn doubtful(&mut self, _memory: &mut Self::Memory, which: &mut Vec<usize>) {
        which.clear();
    }

    /// Whether another level is not worthwhile after a level that left `after` of `before` paths
    /// doubtful.
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
    /// Most paths that are tracked again: a round that would exceed this is not begun, and the last.
    pub(crate) again: usize,
    /// Number of paths in the first batch, at least 1.
    pub(crate) first: usize,
    /// Number of paths in a batch, at least 1.
    pub(crate) batch: usize,
}

/// How a run went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outcome {
    /// How often a path was tracked again.
    pub(crate) retracked: usize,
    /// Whether doubtful paths are left because [`Policy::again`] did not allow another round.
    pub(crate) bounded: bool,
    /// Why the run ended, unless nothing was doubtful any more or everything had been tried.
    pub(crate) flow: Flow,
}

/// The memory of a run, which may be used again.
#[derive(Debug, Default)]
pub(crate) struct RunMemory<M, B> {
    pub(crate) memory: M,
    pub(crate) batch: B,
    /// Paths that are tracked, then those that are doubtful. The paths that a run leaves here stay
    /// doubtful.
    pub(crate) which: Vec<usize>,
}

/// Tracks the paths `0 .. count`, and doubtful paths again, until none is left or the policy ends.
pub(crate) fn run<W: Work>(
    work: &mut W,
    count: usize,
    policy: &Policy,
    workspace: &mut RunMemory<W::Memory, W::Batch>,
    monitor: &Monitor,
) -> Outcome {
    workspace.which.clear();
    workspace.which.extend(0..count);
    let mut outcome = Outcome { retracked: 0, bounded: false, flow: pass(work, Round::FIRST, policy, workspace) };
    if outcome.flow != Flow::On {
        return outcome;
    }
    for level in 0..=policy.retries {
        let before = workspace.which.len();
        for chart in usize::from(level == 0)..policy.charts {
            if workspace.which.is_empty() || monitor.is_cancelled() {
                return outcome;
            }
            outcome.bounded = workspace.which.len() > policy.again - outcome.retracked;
            if outcome.bounded {
                return outcome;
            }
            outcome.retracked += workspace.which.len();
            outcome.flow = pass(work, Round { level, chart }, policy, workspace);
            if outcome.flow != Flow::On {
                return outcome;
            }
        }
        if work.is_hopeless(level, before, workspace.which.len()) {
            break;
        }
    }
    outcome
}

/// One round over `workspace.which`, which afterwards holds the doubtful paths.
fn pass<W: Work>(work: &mut W, round: Round, policy: &Policy, workspace: &mut RunMemory<W::Memory, W::Batch>) -> Flow {
    let RunMemory { memory, batch, which } = workspace;
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
