//! `tdoa.solve`, `tdoa.simulate` and `tdoa.cramer_rao`.

use crate::arrays::{array, elements};
use crate::clocks::emissions;
use crate::errors::{Failure, guarded};
use crate::measured::Table;
use crate::work::{Done, WorkOptions, run, whole};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};
use tdoa::accuracy::cramer_rao as bound;
use tdoa::minimal::{MinimalError, MinimalOptions, MinimalStart, RootProofs, Solver, spatial};
use tdoa::{Layout, MinimalSolution, Monitor, Network, Pseudoranges, ReceiverFault, SimulateOptions};

/// Solvers that are not in use; they keep their start solutions and their memory.
static IN_PLANE: Mutex<Vec<Solver>> = Mutex::new(Vec::new());
static IN_SPACE: Mutex<Vec<spatial::Solver>> = Mutex::new(Vec::new());

/// Solvers that are kept at most.
const MOST_SOLVERS: usize = 16;

/// What is asked of a solver.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    tolerance: Option<f64>,
    start: String,
    first_under: Option<f64>,
    dimensions: usize,
    prove: bool,
    emissions: String,
}

/// All networks that explain a table exactly: a dict of arrays.
#[pyfunction]
pub(crate) fn solve_network<'py>(
    py: Python<'py>,
    table: Table<'py>,
    asked: Asked,
    how: WorkOptions,
) -> PyResult<Bound<'py, PyAny>> {
    guarded(|| {
        let mut options = MinimalOptions::default();
        options.tolerance = asked.tolerance.unwrap_or(options.tolerance);
        options.first_under = asked.first_under;
        options.emissions = emissions(&asked.emissions)?;
        options.start = match &*asked.start {
            "stored" => MinimalStart::Stored,
            "polyhedral" => MinimalStart::Polyhedral,
            other => return Err(Failure::Input(format!("start must be stored or polyhedral, not {other:?}"))),
        };
        for (name, value) in [("tolerance", Some(options.tolerance)), ("first_under", asked.first_under)] {
            if value.is_some_and(|value| value.is_nan() || value < 0.0) {
                return Err(Failure::Input(format!("{name} must not be negative")));
            }
        }
        let (measured, prove) = (table.measured()?, asked.prove);
        let names = [measured.receiver_names().to_vec(), measured.transmitter_names().to_vec()];
        match asked.dimensions {
            2 => answer(py, names, &how, move |monitor| {
                by_kept(&IN_PLANE, |solver: &mut Solver| {
                    let solved = solver.solve_watched(&measured, &options, monitor)?;
                    Ok((solved, prove.then(|| solver.prove_watched(monitor)).flatten()))
                })
            }),
            3 => answer(py, names, &how, move |monitor| {
                by_kept(&IN_SPACE, |solver: &mut spatial::Solver| {
                    let solved = solver.solve_watched(&measured, &options, monitor)?;
                    Ok((solved, prove.then(|| solver.prove_watched(monitor)).flatten()))
                })
            }),
            other => Err(Failure::Input(format!("dimensions must be 2 or 3, not {other}"))),
        }
    })
}

/// What a solver that is kept makes.
fn by_kept<S: Default, T>(solvers: &Mutex<Vec<S>>, work: impl FnOnce(&mut S) -> T) -> T {
    let kept = || solvers.lock().unwrap_or_else(PoisonError::into_inner);
    let solver = kept().pop();
    let mut solver = solver.unwrap_or_default();
    let made = work(&mut solver);
    let mut solvers = kept();
    if solvers.len() < MOST_SOLVERS {
        solvers.push(solver);
    }
    made
}

/// Networks, and what is proved of the roots behind them.
type Solved<const D: usize> = (MinimalSolution<D>, Option<RootProofs>);

/// Solves, and makes a dict of what was found.
fn answer<'py, const D: usize>(
    py: Python<'py>,
    [receivers, transmitters]: [Vec<String>; 2],
    how: &WorkOptions,
    solve: impl FnOnce(&Monitor) -> Result<Solved<D>, MinimalError> + Send + 'static,
) -> Result<Bound<'py, PyAny>, Failure> {
    let Done { result: solved, stopped, seconds } = run(py, how, solve)?;
    let (found, proofs) = match solved {
        // What was tracked until then is no list of networks.
        _ if stopped.is_some() => return whole(py, py.None().into_bound(py), stopped),
        Ok(found) => found,
        Err(error @ MinimalError::Option(_)) => return Err(Failure::input(error)),
        Err(error) => return Err(Failure::undetermined(error)),
    };
    let result = solution(py, &found)?;
    let proofs = proofs.map(|RootProofs { roots, proved, real, unseparated }| {
        numbers(py, &[("roots", roots), ("proved", proved), ("real", real), ("unseparated", unseparated)])
    });
    result.set_item("proofs", proofs.transpose()?)?;
    result.set_item("seconds", seconds)?;
    result.set_item("receiver_names", receivers)?;
    result.set_item("transmitter_names", transmitters)?;
    whole(py, result.into_any(), None)
}

fn solution<'py, const D: usize>(py: Python<'py>, found: &MinimalSolution<D>) -> Result<Bound<'py, PyDict>, Failure> {
    let all = &found.candidates;
    let first = all.first().map(|candidate| &candidate.network);
    let (k, m, n) = (all.len(), first.map_or(0, |f| f.receivers.len()), first.map_or(0, |f| f.transmitters.len()));
    let points = |pick: fn(&Network<D>) -> &Vec<[f64; D]>| {
        all.iter().flat_map(|c| pick(&c.network)).flatten().copied().collect::<Vec<f64>>()
    };
    let result = PyDict::new(py);
    result.set_item("dimensions", D)?;
    result.set_item("receivers", array(py, points(|network| &network.receivers), &[k, m, D])?)?;
    result.set_item("transmitters", array(py, points(|network| &network.transmitters), &[k, n, D])?)?;
    let offsets = all.iter().flat_map(|c| &c.network.offsets).copied().collect();
    result.set_item("offsets", array::<f64>(py, offsets, &[k, n])?)?;
    result.set_item("residuals", array(py, all.iter().map(|c| c.residual).collect(), &[k])?)?;
    result.set_item("physical", array(py, all.iter().map(|c| c.physical).collect(), &[k])?)?;
    result.set_item("conditions", array(py, all.iter().map(|c| c.condition).collect(), &[k])?)?;
    result.set_item("configuration", &found.configuration)?;
    result.set_item("solver", found.solver)?;
    let (paths, counts) = (&found.paths, &found.counts);
    let of_paths = [
        ("tracked", paths.tracked),
        ("finite", paths.finite),
        ("at_infinity", paths.at_infinity),
        ("failed", paths.failed),
        ("dropped", paths.dropped),
        ("retracked", paths.retracked),
    ];
    result.set_item("paths", numbers(py, &of_paths)?)?;
    let of_roots = [
        ("complex", counts.complex),
        ("real", counts.real),
        ("positive_definite", counts.positive_definite),
        ("physical", counts.physical),
    ];
    result.set_item("counts", numbers(py, &of_roots)?)?;
    result.set_item("summary", tdoa::summary::networks(found, None))?;
    result.set_item("stopped_early", found.stopped_early)?;
    result.set_item("warnings", found.warnings.iter().map(ToString::to_string).collect::<Vec<_>>())?;
    Ok(result)
}

/// Counts under their names.
pub(crate) fn numbers<'py>(py: Python<'py>, all: &[(&str, usize)]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    for (name, number) in all {
        result.set_item(name, number)?;
    }
    Ok(result)
}

/// What is simulated, as Python gives it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Wanted {
    receivers: usize,
    transmitters: usize,
    dimensions: usize,
    layout: String,
    size: Option<Vec<f64>>,
    noise: f64,
    outliers: f64,
    outlier_size: f64,
    missing: f64,
    hearing: Option<usize>,
    detours: f64,
    detour_size: f64,
    fault: Option<(String, f64)>,
    delays: f64,
    rates: f64,
    channels: usize,
    duration: Option<f64>,
    emissions: String,
    seed: u64,
}

/// A random network and its measurements: a dict of arrays.
#[pyfunction]
pub(crate) fn simulate(py: Python<'_>, wanted: Wanted) -> PyResult<Bound<'_, PyDict>> {
    guarded(|| match wanted.dimensions {
        2 => made::<2>(py, &wanted),
        3 => made::<3>(py, &wanted),
        other => Err(Failure::Input(format!("dimensions must be 2 or 3, not {other}"))),
    })
}

fn made<'py, const D: usize>(py: Python<'py>, wanted: &Wanted) -> Result<Bound<'py, PyDict>, Failure> {
    let mut options = SimulateOptions::<D>::new();
    let extent = match &wanted.size {
        None => options.layout.extent(),
        Some(size) => <[f64; D]>::try_from(size.as_slice())
            .map_err(|_| Failure::Input(format!("size must be {D} lengths, not {}", size.len())))?,
    };
    options.layout = match wanted.layout.as_str() {
        "room" => Layout::Room { extent },
        "chain" => Layout::Chain { extent },
        "grid" => Layout::Grid { extent },
        "normal" => Layout::Normal,
        other => return Err(Failure::Input(format!("layout must be room, chain, grid or normal, not {other:?}"))),
    };
    options.fault = match &wanted.fault {
        None => None,
        Some((kind, size)) => Some(match kind.as_str() {
            "delay" => ReceiverFault::Delay(*size),
            "drift" => ReceiverFault::Drift(*size),
            "move" => ReceiverFault::Move(*size),
            other => return Err(Failure::Input(format!("fault must be delay, drift or move, not {other:?}"))),
        }),
    };
    (options.receivers, options.transmitters, options.seed) = (wanted.receivers, wanted.transmitters, wanted.seed);
    (options.noise, options.missing, options.hearing) = (wanted.noise, wanted.missing, wanted.hearing);
    (options.outliers, options.outlier_size) = (wanted.outliers, wanted.outlier_size);
    (options.detours, options.detour_size, options.delays) = (wanted.detours, wanted.detour_size, wanted.delays);
    (options.rates, options.channels, options.duration) = (wanted.rates, wanted.channels, wanted.duration);
    options.emissions = emissions(&wanted.emissions)?;
    let made = py.detach(|| tdoa::simulate(&options)).map_err(Failure::input)?;
    let (m, n) = (options.receivers, options.transmitters);
    let result = PyDict::new(py);
    let flat = |points: &[[f64; D]]| points.iter().flatten().copied().collect();
    result.set_item("pseudoranges", array(py, made.pseudoranges.dense(), &[m, n])?)?;
    result.set_item("receivers", array(py, flat(&made.network.receivers), &[m, D])?)?;
    result.set_item("transmitters", array(py, flat(&made.network.transmitters), &[n, D])?)?;
    result.set_item("offsets", array(py, made.network.offsets, &[n])?)?;
    result.set_item("outliers", array(py, made.outliers, &[m, n])?)?;
    result.set_item("clocks", array(py, made.clocks.into_iter().flatten().collect(), &[m, 2])?)?;
    Ok(result)
}

/// The Cramer-Rao bound of the receivers, metres: positions of shape (m, 2) and (n, 2), used
/// measurements (m, n).
#[pyfunction]
pub(crate) fn cramer_rao(
    py: Python<'_>,
    receivers: PyReadonlyArrayDyn<'_, f64>,
    transmitters: PyReadonlyArrayDyn<'_, f64>,
    used: PyReadonlyArrayDyn<'_, bool>,
    sigma: f64,
) -> PyResult<f64> {
    guarded(|| {
        let points = |array: &PyReadonlyArrayDyn<'_, f64>| {
            let (values, shape) = elements(array, 2)?;
            if shape[1] != 2 {
                let (rows, columns) = (shape[0], shape[1]);
                let message = format!("positions must be of shape (number, 2), not ({rows}, {columns})");
                return Err(Failure::Input(message));
            }
            if values.iter().any(|x| !x.is_finite()) {
                return Err(Failure::Input("positions must be finite".to_owned()));
            }
            Ok(values.chunks_exact(2).map(|p| [p[0], p[1]]).collect::<Vec<_>>())
        };
        let (receivers, transmitters) = (points(&receivers)?, points(&transmitters)?);
        let (used, shape) = elements(&used, 2)?;
        let (m, n) = (receivers.len(), transmitters.len());
        if shape != [m, n] {
            return Err(Failure::Input(format!("used must have shape ({m}, {n}), not ({}, {})", shape[0], shape[1])));
        }
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(Failure::Input(format!("sigma must be positive and finite, not {sigma}")));
        }
        let truth = Network::new(receivers, transmitters, vec![0.0; n]);
        let values = truth.pseudoranges().into_iter().zip(&used).map(|(f, &used)| if used { f } else { f64::NAN });
        let measured = Pseudoranges::new(m, n, values.collect()).map_err(Failure::input)?;
        Ok(py.detach(|| bound(&measured, &vec![false; m * n], &truth, sigma)))
    })
}
