//! `hc.certify` and `hc.mixed_volume`.

use crate::arrays::{array, rows};
use crate::errors::{Failure, guarded};
use crate::system::WrittenSystem;
use crate::work::{Done, WorkOptions, run, whole};
use hc::Run;
use hc::certify::{CertifyOptions, Reality};
use hc::poly::{ExpandLimits, Polynomial};
use hc::start::MixedError;
use num_complex::Complex64;
use numpy::PyReadonlyArrayDyn;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The mixed volume of a system; of an interrupted search a lower bound.
#[pyfunction]
pub(crate) fn mixed_volume(py: Python<'_>, system: WrittenSystem, how: WorkOptions) -> PyResult<Bound<'_, PyAny>> {
    guarded(|| {
        let system = system.system()?;
        let Done { result: found, stopped, .. } = run(py, &how, move |monitor| {
            let polynomials = system.expand(&ExpandLimits::default()).map_err(Failure::input)?;
            let supports: Vec<Vec<Vec<i32>>> = polynomials.iter().map(Polynomial::support).collect();
            match Run::new().watched(monitor).mixed_volume(system.variables().len(), &supports) {
                Ok(found) => Ok(found.volume),
                Err(MixedError::Cancelled) => Ok(monitor.progress().counted),
                Err(error) => Err(Failure::input(error)),
            }
        })?;
        whole(py, found?.into_bound_py_any(py)?, stopped)
    })
}

/// Proofs that points stand for solutions: a dict of arrays, one row a point.
#[pyfunction]
pub(crate) fn certify<'py>(
    py: Python<'py>,
    system: WrittenSystem,
    points: PyReadonlyArrayDyn<'py, Complex64>,
    how: WorkOptions,
) -> PyResult<Bound<'py, PyAny>> {
    guarded(|| {
        let (system, points) = (system.system()?, rows(&points)?);
        let (k, n) = (points.len(), system.variables().len());
        let given = points.clone();
        let Done { result: found, stopped, .. } = run(py, &how, move |monitor| {
            Run::new().watched(monitor).certify(&system, &[], &given, &CertifyOptions::default())
        })?;
        let found = found.map_err(Failure::input)?;
        let nothing = [[[f64::NAN; 2]; 2]].repeat(n);
        let mut boxes: Vec<f64> = Vec::with_capacity(4 * k * n);
        let mut values: Vec<Complex64> = Vec::with_capacity(k * n);
        let (mut real, mut reasons) = (Vec::with_capacity(k), Vec::new());
        for (proof, point) in found.points.iter().zip(&points) {
            match proof {
                Ok(proof) => {
                    values.extend(&proof.value);
                    let bounds = |z: &hc::poly::ComplexInterval| [z.re.low, z.re.high, z.im.low, z.im.high];
                    boxes.extend(proof.enclosure.iter().flat_map(bounds));
                    real.push(match proof.reality {
                        Reality::Real => 1i8,
                        Reality::NotReal => 0,
                        Reality::Undecided => -1,
                    });
                    reasons.push(None);
                }
                Err(obstacle) => {
                    values.extend(point);
                    boxes.extend(nothing.iter().flatten().flatten());
                    real.push(-1);
                    reasons.push(Some(obstacle.to_string()));
                }
            }
        }
        let result = PyDict::new(py);
        result.set_item("points", array(py, values, &[k, n])?)?;
        result.set_item("boxes", array(py, boxes, &[k, n, 2, 2])?)?;
        result.set_item("certified", array(py, found.points.iter().map(Result::is_ok).collect(), &[k])?)?;
        result.set_item("reality", array(py, real, &[k])?)?;
        let of = |earlier: &Option<usize>| earlier.map_or(-1, |earlier| earlier as i64);
        result.set_item("duplicate_of", array(py, found.duplicate_of.iter().map(of).collect(), &[k])?)?;
        result.set_item("reasons", reasons)?;
        let pairs = found.unseparated.iter().flatten().map(|&k| k as i64).collect();
        result.set_item("unseparated", array::<i64>(py, pairs, &[found.unseparated.len(), 2])?)?;
        result.set_item("n_distinct", found.n_distinct())?;
        result.set_item("n_real", found.n_real())?;
        whole(py, result.into_any(), stopped)
    })
}
