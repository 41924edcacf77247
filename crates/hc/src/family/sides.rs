//! The fibres that a search tracks from parameters to parameters, on all ranks or on this one
//! alone.

use super::fibre::{Fibre, FibreOptions, PathCounts};
use super::track::{moved, track_fibre_led};
use super::tracking::serve_fibre;
use crate::checkpoint::Pieces;
use crate::ranks::{RanksError, Task, Worker};
use crate::tracker::PathSet;
use num_complex::Complex64;
use poly::Evaluate;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Fewer paths than this are not shared out: they are done before other ranks are ready.
const FEW: usize = 32;

/// A system of a search.
pub(super) struct Searched<'a, E> {
    pub(super) system: &'a E,
    /// Whether it is the system of the trace test, and not that of the family.
    pub(super) enlarged: bool,
}

/// A fibre and where it goes, as rank 0 describes it to the others.
#[derive(Serialize, Deserialize)]
pub(super) struct Side<'a> {
    pub(super) enlarged: bool,
    parameters: Cow<'a, [Complex64]>,
    solutions: Cow<'a, [Complex64]>,
    target: Cow<'a, [Complex64]>,
    options: Cow<'a, FibreOptions>,
}

impl<E: Evaluate> Searched<'_, E> {
    /// The ends of all paths of a fibre to other parameters, as
    /// [`track_fibre`](super::track_fibre) finds them.
    pub(super) fn track(
        &self,
        fibre: &Fibre,
        target: &[Complex64],
        options: &FibreOptions,
        pieces: Pieces<'_>,
    ) -> (PathSet, PathCounts) {
        let lead = pieces.lead.filter(|_| fibre.len() >= FEW);
        if let Some(lead) = lead {
            let side = Side {
                enlarged: self.enlarged,
                parameters: Cow::Borrowed(&fibre.parameters),
                solutions: Cow::Borrowed(&fibre.solutions),
                target: Cow::Borrowed(target),
                options: Cow::Borrowed(options),
            };
            lead.begin_part(&side, 1);
        }
        track_fibre_led(self.system, fibre, target, options, pieces.monitor, lead)
    }

    /// The whole fibre at other parameters, as [`move_fibre`](super::move_fibre) finds it.
    pub(super) fn moved(
        &self,
        fibre: &Fibre,
        target: &[Complex64],
        options: &FibreOptions,
        pieces: Pieces<'_>,
    ) -> Option<Fibre> {
        moved(self.system, fibre, target, &self.track(fibre, target, options, pieces))
    }

    /// Tracks paths for rank 0 as long as it sends any.
    pub(super) fn serve(&self, worker: &Worker<'_>, task: &Task<Side<'_>>) -> Result<(), RanksError> {
        let Side { parameters, solutions, target, options, .. } = &task.content;
        let (n, m) = (self.system.variables(), self.system.parameters());
        if !(solutions.len().is_multiple_of(n.max(1)) && parameters.len() == m && target.len() == m) {
            let reason = "a fibre of another system".to_owned();
            return Err(RanksError::Message { rank: 0, reason });
        }
        let fibre = Fibre::new(parameters.to_vec(), n, solutions.to_vec());
        serve_fibre(worker, task, self.system, &fibre, target, options)
    }
}
