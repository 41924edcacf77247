//! Arrays of NumPy.

use crate::errors::Failure;
use num_complex::Complex64;
use numpy::{Element, IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;

/// An array of this shape from its elements row by row.
pub(crate) fn array<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> Result<Bound<'py, PyArrayDyn<T>>, Failure> {
    Ok(values.into_pyarray(py).reshape(shape.to_vec())?)
}

/// The elements of an array row by row, however they lie in memory, where it has `rank` axes; and
/// its shape.
pub(crate) fn elements<T: Element + Copy>(
    array: &PyReadonlyArrayDyn<'_, T>,
    rank: usize,
) -> Result<(Vec<T>, Vec<usize>), Failure> {
    let view = array.as_array();
    if view.ndim() != rank {
        return Err(Failure::Input(format!("an array of {rank} axes is needed, not of {}", view.ndim())));
    }
    Ok((view.iter().copied().collect(), view.shape().to_vec()))
}

/// The rows of a matrix of complex numbers.
pub(crate) fn rows(array: &PyReadonlyArrayDyn<'_, Complex64>) -> Result<Vec<Vec<Complex64>>, Failure> {
    let (values, shape) = elements(array, 2)?;
    if shape[1] == 0 {
        return Ok(vec![Vec::new(); shape[0]]);
    }
    Ok(values.chunks_exact(shape[1]).map(<[Complex64]>::to_vec).collect())
}
