//! The part of a table that is calibrated.

use crate::calibrate::input::first_clocks::first_clocks;
use crate::calibrate::unfinished::Unfinished;
use crate::clocks::Emissions;
use crate::degeneracy::Usable;
use crate::median::median;
use crate::pseudoranges::Pseudoranges;
use std::borrow::Cow;

/// A table and the part of it that is calibrated.
#[derive(Clone)]
pub(crate) struct Input<'a> {
    /// The table without impossible values.
    pub(crate) table: Cow<'a, Pseudoranges>,
    /// The nodes that take part.
    pub(crate) usable: Usable,
    /// What is subtracted from the measurements of each of these transmitters; the offsets take it back at
    /// the end. Large common times cost digits. Nothing is subtracted from distances, the same where all offsets are one.
    pub(crate) shifts: Vec<f64>,
    /// First guesses of the clocks of these receivers, which are subtracted too: offset and drift over half the recording.
    /// Empty where they share a clock.
    pub(crate) clocks: Vec<[f64; 2]>,
}

impl<'a> Input<'a> {
    /// The nodes that take part in a calibration.
    pub(crate) fn new(table: Cow<'a, Pseudoranges>, usable: Usable) -> Input<'a> {
        let selected = table.select(&usable.receivers, &usable.transmitters);
        let clocks = selected.unknown_clocks().map_or_else(Vec::new, |recorders| first_clocks(&selected, recorders));
        let selected = synchronised(selected, &clocks);
        let shifts = match table.emissions() {
            Emissions::Known => (0..selected.transmitters()).map(|j| selected.emission_time(j)).collect(),
            Emissions::Constant => {
                let rest = selected.map(|_, j, value| value - selected.emission_time(j));
                let middle = median(rest.cells().values().to_vec()).unwrap_or_default();
                (0..selected.transmitters()).map(|j| middle + selected.emission_time(j)).collect()
            }
            Emissions::Unknown => middles(&selected),
        };
        Input { table, usable, shifts, clocks }
    }

    /// The measurements that take part, less the shifts.
    pub(crate) fn centred(&self) -> Pseudoranges {
        let selected = self.table.select(&self.usable.receivers, &self.usable.transmitters);
        let centred = synchronised(selected, &self.clocks).map(|_, j, value| value - self.shifts[j]);
        if self.clocks.is_empty() { centred } else { on_a_grid(&centred) }
    }

    /// A network of the nodes that take part, as one of all nodes, with the offsets of the table.
    pub(crate) fn whole<const D: usize>(&self, best: Unfinished<D>) -> Unfinished<D> {
        let (m, n) = (self.table.receivers(), self.table.transmitters());
        best.shifted(&self.shifts).among(m, &self.usable.receivers, n, &self.usable.transmitters)
    }
}

/// Measurements less what these clocks of the receivers add.
pub(crate) fn synchronised(measured: Pseudoranges, clocks: &[[f64; 2]]) -> Pseudoranges {
    let Some(recorders) = measured.unknown_clocks().filter(|_| !clocks.is_empty()) else { return measured };
    let rest = measured.map(|i, j, value| value - recorders.delay(clocks[i], i, j));
    rest.with_unknown_clocks(Some(recorders.clone().taking(clocks)))
}

/// The median of each column.
fn middles(measured: &Pseudoranges) -> Vec<f64> {
    let column = |j: usize| (0..measured.receivers()).filter_map(|i| measured.get(i, j)).collect();
    (0..measured.transmitters()).map(|j| median(column(j)).unwrap_or(0.0)).collect()
}

/// The measurements on a grid far finer than any noise: a search is chaotic, so that mere rounding
/// would make it depend on the size of the delays.
fn on_a_grid(measured: &Pseudoranges) -> Pseudoranges {
    let largest = measured.cells().values().iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let step = (largest.log2().floor() - 30.0).exp2();
    if !step.is_normal() {
        return measured.clone();
    }
    measured.map(|_, _, value| (value / step).round() * step)
}
