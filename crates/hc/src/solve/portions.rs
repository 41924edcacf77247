//! Paths of the coefficient stage in portions, in which other ranks take part.

use super::paths::{CoefficientStage, Route};
use super::record::Record;
use crate::monitor;
use crate::ranks::{RanksError, Shareable, Task, Worker};
use crate::runner::Round;
use crate::start::Source;
use poly::Evaluate;
use serde::{Deserialize, Serialize};

/// A start system, as rank 0 describes it to the others, which make it themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Announced {
    /// Whether it is that of one stage, on trial.
    pub(super) trial: bool,
    pub(super) attempt: u64,
}

/// Tracks paths of a route for rank 0 as long as it sends any.
pub(super) fn serve<E: Evaluate, S: Source<E>>(
    worker: &Worker<'_>,
    task: &Task<Announced>,
    route: Route<'_, '_, E, S>,
) -> Result<(), RanksError> {
    let stage = CoefficientStage::new(route, task.content.trial);
    worker.serve(task, |numbers, round| stage.ends(numbers, round))
}

impl<E: Evaluate, S: Source<E>> Shareable for CoefficientStage<'_, '_, E, S> {
    /// How far a path gets in one go: up to the endgame, and if it needs that through it.
    type End = (Record, Option<Record>);

    fn ends(&self, numbers: &[usize], round: Round) -> Vec<Self::End> {
        // The progress of a batch is told as a whole.
        let monitor = self.route.monitor.quiet();
        let records = self.tracked(numbers, round, &monitor);
        let (places, open): (Vec<usize>, Vec<Record>) =
            records.iter().enumerate().filter(|(_, record)| record.is_open()).map(|(k, r)| (k, r.clone())).unzip();
        let mut ends: Vec<Self::End> = records.into_iter().map(|record| (record, None)).collect();
        for (k, record) in places.into_iter().zip(self.ended(&open, round, &monitor)) {
            ends[k].1 = Some(record);
        }
        ends
    }

    fn is_end(&self, end: &Self::End, path: usize) -> bool {
        let unknowns = self.route.trackers.system().variables();
        let fits = |record: &Record| record.path == path && record.fits(unknowns);
        let (record, ended) = end;
        fits(record) && ended.as_ref().is_none_or(|ended| record.is_open() && fits(ended) && !ended.is_open())
    }

    fn gather(&self, ends: Vec<Self::End>, batch: &mut Vec<Record>) {
        batch.clear();
        let mut closed = self.closed.borrow_mut();
        closed.clear();
        for (record, ended) in ends {
            closed.extend(ended.map(|record| (record.path, record)));
            batch.push(record);
        }
    }

    fn reached(&self, paths: usize) {
        let (monitor, all) = (self.route.monitor, self.round.all as u64);
        let progress = monitor.progress();
        if (progress.stage, progress.total) != (monitor::Stage::Paths, all) {
            monitor.enter(monitor::Stage::Paths, all);
        }
        monitor.reach((self.round.done + paths) as u64, self.round.regular as u64);
    }
}
