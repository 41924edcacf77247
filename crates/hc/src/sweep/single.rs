//! The solutions for single parameter points, with all that [`Family::track`] does.

use super::cell::Cell;
use super::grid::Grid;
use super::judge::judged;
use super::options::SweepOptions;
use crate::family::{Family, FamilyError, Fibre};
use crate::monitor::Monitor;
use crate::run::Run;

/// A family with its fibre, and how it is tracked.
pub(super) struct Single<'a> {
    pub(super) family: &'a Family,
    pub(super) fibre: &'a Fibre,
    options: &'a SweepOptions,
    run: Run,
}

/// A cell, and the paths to it and those that were tracked again.
pub(super) type Solved = (Cell, u64, u64);

impl<'a> Single<'a> {
    /// Work that the monitor stops, but does not watch.
    pub(super) fn new(
        family: &'a Family,
        fibre: &'a Fibre,
        options: &'a SweepOptions,
        monitor: &Monitor,
    ) -> Single<'a> {
        Single { family, fibre, options, run: Run::new().watched(&monitor.quiet()) }
    }

    /// Who may stop the work.
    pub(super) fn monitor(&self) -> &Monitor {
        self.run.monitor()
    }

    /// The cells of these numbers; fewer if the work is stopped. `done` is called after each.
    pub(super) fn cells(
        &self,
        grid: &Grid,
        numbers: &[usize],
        done: impl Fn() + Sync,
    ) -> Result<Vec<Solved>, FamilyError> {
        let targets: Vec<Vec<f64>> = numbers.iter().map(|&k| grid.parameters(k)).collect();
        self.solved(&targets, done)
    }

    /// What a cell for these parameters has; `None` if the work is stopped.
    pub(super) fn cell(&self, parameters: &[f64]) -> Option<Cell> {
        let (cell, _, _) = self.solved(&[parameters], || ()).ok()?.pop()?;
        Some(cell)
    }

    fn solved<T: AsRef<[f64]>>(&self, targets: &[T], done: impl Fn() + Sync) -> Result<Vec<Solved>, FamilyError> {
        let tracking = self.run.track(self.family, self.fibre, targets);
        tracking.options(&self.options.solve).limits(&self.options.limits).transform(|_, found| {
            let (paths, again) = (found.paths.tracked as u64, found.paths.retracked as u64);
            let cell = judged(found, self.fibre.len(), self.options.certify);
            done();
            (cell, paths, again)
        })
    }
}
