//! The part of a table that is calibrated.

use crate::calibrate::input::middle_delays::without_middle_delays;
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
}

impl<'a> Input<'a> {
    /// The nodes that take part in a calibration, in which all receivers may be `delayed`.
    pub(crate) fn new(table: Cow<'a, Pseudoranges>, usable: Usable, delayed: bool) -> Input<'a> {
        let selected = table.select(&usable.receivers, &usable.transmitters);
        // What is subtracted does not depend on the delays.
        let shifts = match (table.emissions(), delayed) {
            (Emissions::Known, _) => vec![0.0; selected.transmitters()],
            (Emissions::Constant, _) => {
                let middle = median(selected.cells().values().to_vec());
                vec![middle.unwrap_or_default(); selected.transmitters()]
            }
            (Emissions::Unknown, true) => middles(&without_middle_delays(&selected)),
            (Emissions::Unknown, false) => middles(&selected),
        };
        Input { table, usable, shifts }
    }

    /// The measurements that take part, less the shifts.
    pub(crate) fn centred(&self) -> Pseudoranges {
        let selected = self.table.select(&self.usable.receivers, &self.usable.transmitters);
        selected.map(|_, j, value| value - self.shifts[j])
    }

    /// A network of the nodes that take part, as one of all nodes, with the offsets of the table.
    pub(crate) fn whole<const D: usize>(&self, best: Unfinished<D>) -> Unfinished<D> {
        let (m, n) = (self.table.receivers(), self.table.transmitters());
        best.shifted(&self.shifts).among(m, &self.usable.receivers, n, &self.usable.transmitters)
    }
}

/// The median of each column.
fn middles(measured: &Pseudoranges) -> Vec<f64> {
    let column = |j: usize| (0..measured.receivers()).filter_map(|i| measured.get(i, j)).collect();
    (0..measured.transmitters()).map(|j| median(column(j)).unwrap_or(0.0)).collect()
}
