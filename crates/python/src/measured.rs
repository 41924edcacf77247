//! Measurements: from arrays, and from files.

use crate::arrays::{array, elements};
use crate::errors::{Failure, guarded};
use numpy::{PyArrayDyn, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyDict;
use tdoa::PseudorangeError;
use tdoa::Pseudoranges;
use tdoa::pseudoranges::MAX_CELLS;
use tdoa::read::{ReadOptions, Role, Units, read as read_file, read_from};

/// A table of pseudoranges as Python gives it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Table<'py> {
    values: PyReadonlyArrayDyn<'py, f64>,
    /// Standard deviations of the cells, metres.
    sigmas: Option<PyReadonlyArrayDyn<'py, f64>>,
    /// Their weights, in any unit.
    weights: Option<PyReadonlyArrayDyn<'py, f64>>,
    /// Further candidates of the cells, a layer for each, NaN where a cell has no more.
    candidates: Option<PyReadonlyArrayDyn<'py, f64>>,
    /// Names of receivers and transmitters.
    receivers: Option<Vec<String>>,
    transmitters: Option<Vec<String>>,
    /// What makes metres of the values.
    factor: Option<f64>,
}

impl Table<'_> {
    pub(crate) fn measured(&self) -> Result<Pseudoranges, Failure> {
        let shape = self.values.as_array().shape().to_vec();
        if let [m, n] = shape[..] {
            fits(m, n)?;
        }
        let (mut values, shape) = elements(&self.values, 2)?;
        if let Some(factor) = self.factor {
            values.iter_mut().for_each(|value| *value *= factor);
        }
        let mut measured = Pseudoranges::new(shape[0], shape[1], values).map_err(Failure::input)?;
        if let Some(names) = &self.receivers {
            measured = measured.with_receiver_names(names.clone()).map_err(Failure::input)?;
        }
        if let Some(names) = &self.transmitters {
            measured = measured.with_transmitter_names(names.clone()).map_err(Failure::input)?;
        }
        if let Some(sigmas) = &self.sigmas {
            measured = measured.with_sigmas(elements(sigmas, 2)?.0).map_err(Failure::input)?;
        }
        if let Some(weights) = &self.weights {
            let (weights, _) = elements(weights, 2)?;
            let weight = |i: usize, j: usize| weights.get(i * shape[1] + j).copied().unwrap_or(f64::NAN);
            measured = measured.with_weight_of(weight).map_err(Failure::input)?;
        }
        if let Some(candidates) = &self.candidates {
            let (all, layers) = elements(candidates, 3)?;
            if layers[..2] != shape[..] {
                return Err(Failure::Input(format!(
                    "candidates must have the rows and columns of the pseudoranges, {shape:?}, not {:?}",
                    &layers[..2]
                )));
            }
            let (n, most, factor) = (shape[1], layers[2], self.factor.unwrap_or(1.0));
            let cell = |(k, value): (usize, f64)| (k / most / n, k / most % n, factor * value);
            measured = measured.with_candidates(all.into_iter().enumerate().map(cell)).map_err(Failure::input)?;
        }
        Ok(measured)
    }
}

/// Refuses what is too large before anything is copied.
fn fits(receivers: usize, transmitters: usize) -> Result<(), Failure> {
    match receivers.checked_mul(transmitters) {
        Some(cells) if cells <= MAX_CELLS => Ok(()),
        _ => Err(Failure::input(PseudorangeError::TooLarge { receivers, transmitters })),
    }
}

/// Refuses tables that are too large.
#[pyfunction]
pub(crate) fn check_size(receivers: usize, transmitters: usize) -> PyResult<()> {
    guarded(|| fits(receivers, transmitters))
}

/// Whether a table with these headings is a list of one measurement a row.
#[pyfunction]
pub(crate) fn heads_list(headings: Vec<String>) -> bool {
    tdoa::read::heads_list(&headings)
}

/// Measurements from a file, or from `data` as if they were in a file of that name: a dict of
/// values, sigmas, weights and names. Columns are pairs of a role and a heading.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    path: std::path::PathBuf,
    data: Option<PyBackedBytes>,
    units: Option<&str>,
    speed: Option<f64>,
    rate: Option<f64>,
    variable: Option<String>,
    transpose: bool,
    columns: Vec<(String, String)>,
    decimal_mark: Option<char>,
    candidates: bool,
) -> PyResult<Bound<'py, PyDict>> {
    guarded(|| {
        let mut options = ReadOptions::default();
        options.transpose = transpose;
        options.decimal_mark = decimal_mark;
        options.candidates = candidates;
        for (role, heading) in columns {
            let role = role.parse::<Role>().map_err(|error| Failure::Input(format!("columns: {error}")))?;
            options.columns.push((role, heading));
        }
        options.units = units.map(|units| unit(units, speed, rate)).transpose()?;
        options.variable = variable;
        let measured = py.detach(|| match &data {
            None => read_file(&path, options),
            Some(data) => read_from(&data[..], &path, options),
        });
        let measured = measured.map_err(Failure::input)?;
        let (m, n) = (measured.receivers(), measured.transmitters());
        let sigma = |k: usize| measured.sigma(k / n, k % n).unwrap_or(f64::NAN);
        let weight = |k: usize| measured.weight(k / n, k % n).unwrap_or(f64::NAN);
        let found = PyDict::new(py);
        found.set_item("values", array(py, measured.dense(), &[m, n])?)?;
        let knows = measured.knows_sigmas();
        let sigmas = knows.then(|| array(py, (0..m * n).map(sigma).collect(), &[m, n])).transpose()?;
        found.set_item("sigmas", sigmas)?;
        let weighed = measured.has_sigmas() && !knows;
        let weights = weighed.then(|| array(py, (0..m * n).map(weight).collect(), &[m, n])).transpose()?;
        found.set_item("weights", weights)?;
        found.set_item("candidates", further(py, &measured)?)?;
        found.set_item("receiver_names", measured.receivers_named().then(|| measured.receiver_names()))?;
        found.set_item("transmitter_names", measured.transmitter_names())?;
        Ok(found)
    })
}

/// Further candidates as an array with a layer for each, NaN where a cell has no more; `None` where none has any.
fn further<'py>(py: Python<'py>, measured: &Pseudoranges) -> Result<Option<Bound<'py, PyArrayDyn<f64>>>, Failure> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let most = measured.cells().iter().map(|(i, j, _)| measured.candidates(i, j).len()).max().unwrap_or(1);
    if most < 2 {
        return Ok(None);
    }
    // One cell with many candidates must not fill the memory.
    if m.saturating_mul(n).saturating_mul(most - 1) > MAX_CELLS {
        return Err(Failure::Input(format!(
            "{most} candidates of one cell of {m} x {n} are too many for an array; leave out the least likely ones"
        )));
    }
    let mut all = vec![f64::NAN; m * n * (most - 1)];
    for (i, j, _) in measured.cells().iter() {
        let row = (i * n + j) * (most - 1);
        measured.candidates(i, j).iter().skip(1).enumerate().for_each(|(k, value)| all[row + k] = *value);
    }
    Ok(Some(array(py, all, &[m, n, most - 1])?))
}

fn unit(name: &str, speed: Option<f64>, rate: Option<f64>) -> Result<Units, Failure> {
    let needs = |what: &str| Failure::Input(format!("units={name:?} needs {what}"));
    let speed =
        || speed.ok_or_else(|| needs("speed in metres a second, such as 343 for sound in air or 299792458 for radio"));
    Ok(match name {
        "m" => Units::Metres,
        "cm" => Units::Centimetres,
        "km" => Units::Kilometres,
        "s" => Units::Seconds { speed: speed()? },
        "ms" => Units::Milliseconds { speed: speed()? },
        "us" => Units::Microseconds { speed: speed()? },
        "ns" => Units::Nanoseconds { speed: speed()? },
        "samples" => {
            let rate = rate.ok_or_else(|| needs("rate, the samples a second, such as 48000"))?;
            Units::Samples { speed: speed()?, rate }
        }
        _ => return Err(Failure::Input(format!("units must be m, cm, km, s, ms, us, ns or samples, not {name:?}"))),
    })
}
