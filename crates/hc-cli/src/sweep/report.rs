//! The JSON of a sweep.

use super::swept::Swept;
use hc::sweep::{Break, Cell, RealSolution, Standing, SweepPaths};
use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// What a sweep has found.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    variables: &'a [String],
    axes: Vec<Axis<'a>>,
    /// Parameters that are not on an axis.
    fixed: BTreeMap<&'a str, f64>,
    seed: u64,
    seconds: f64,
    /// Number of solutions for generic parameters.
    fibre: usize,
    branches: usize,
    paths: SweepPaths,
    /// Cells whose number of real solutions is not shown.
    doubtful: usize,
    partial: bool,
    untracked: &'a [usize],
    breaks: &'a [Break],
    cells: Cells<'a>,
}

#[derive(Serialize)]
struct Axis<'a> {
    parameter: &'a str,
    from: f64,
    to: f64,
    count: usize,
}

impl<'a> Report<'a> {
    pub(super) fn new(swept: &'a Swept<'a>, seed: u64, seconds: f64) -> Report<'a> {
        let Swept { family, grid, sweep, untracked } = swept;
        let axis = |axis: &'a hc::sweep::Axis| {
            let hc::sweep::Axis { parameter, from, to, count } = axis;
            Axis { parameter, from: *from, to: *to, count: *count }
        };
        Report {
            variables: family.system().variables(),
            axes: grid.axes().iter().map(axis).collect(),
            fixed: grid.fixed(family).collect(),
            seed,
            seconds,
            fibre: sweep.fibre,
            branches: sweep.branches,
            paths: sweep.paths,
            doubtful: sweep.doubtful(),
            partial: sweep.interrupted,
            untracked,
            breaks: &sweep.breaks,
            cells: Cells(swept),
        }
    }
}

/// The cells, made one by one.
struct Cells<'a>(&'a Swept<'a>);

#[derive(Serialize)]
struct OneCell<'a> {
    parameters: Vec<f64>,
    real: usize,
    positive: usize,
    complex: usize,
    at_infinity: usize,
    standing: &'a Standing,
    /// Why the number is not shown, or `null`.
    doubt: Option<String>,
    solutions: &'a [RealSolution],
}

impl Serialize for Cells<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Swept { grid, sweep, .. } = self.0;
        let mut list = serializer.serialize_seq(Some(sweep.cells.len()))?;
        for (k, cell) in sweep.cells.iter().enumerate() {
            let Cell { standing, solutions, complex, at_infinity, .. } = cell;
            list.serialize_element(&OneCell {
                parameters: grid.parameters(k),
                real: cell.real(),
                positive: cell.positive(),
                complex: *complex,
                at_infinity: *at_infinity,
                standing,
                doubt: standing.doubt().map(ToString::to_string),
                solutions,
            })?;
        }
        list.end()
    }
}
