//! Errors as Python exceptions with the same words, and panics kept this side of the border.

use pyo3::prelude::*;
use std::any::Any;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Why a call fails.
pub(crate) enum Failure {
    /// Unusable input: `hc.InputError`, a `ValueError`.
    Input(String),
    /// Data that cannot determine an answer: `hc.UndeterminedError`.
    Undetermined(String),
    /// A panic, which is a flaw of these libraries: `hc.InternalError`.
    Internal(String),
    /// An exception already.
    Python(PyErr),
}

impl Failure {
    pub(crate) fn input(error: impl Display) -> Failure {
        Failure::Input(error.to_string())
    }

    pub(crate) fn undetermined(error: impl Display) -> Failure {
        Failure::Undetermined(error.to_string())
    }

    /// What a panic has left.
    pub(crate) fn panicked(payload: &(dyn Any + Send)) -> Failure {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
        Failure::Internal(format!("a flaw of this library, please report it with the input: {text}"))
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Failure {
        Failure::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> PyErr {
        let (class, message) = match failure {
            Failure::Input(message) => ("InputError", message),
            Failure::Undetermined(message) => ("UndeterminedError", message),
            Failure::Internal(message) => ("InternalError", message),
            Failure::Python(error) => return error,
        };
        // The classes are written in Python: they have two bases.
        let made = Python::attach(|py| {
            let class = py.import("hc._errors")?.getattr(class)?;
            Ok(PyErr::from_value(class.call1((message,))?))
        });
        made.unwrap_or_else(|error: PyErr| error)
    }
}

/// Runs the body of a function that Python calls: a panic becomes an exception.
pub(crate) fn guarded<R>(body: impl FnOnce() -> Result<R, Failure>) -> PyResult<R> {
    let ended = catch_unwind(AssertUnwindSafe(body));
    Ok(ended.unwrap_or_else(|payload| Err(Failure::panicked(payload.as_ref())))?)
}
