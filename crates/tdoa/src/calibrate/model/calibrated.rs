//! A calibration of which the dimension was chosen.

use crate::calibrate::model::errors_chosen::{Decided, Verdict};
use crate::calibrate::options::CalibrateError;
use crate::calibrate::report::calibration::Calibration;
use thiserror::Error;

/// A network whose dimension was chosen by its measurements.
#[derive(Debug, Clone, PartialEq)]
pub enum Calibrated {
    /// In the plane.
    Plane(Calibration),
    /// In space.
    Space(Calibration<3>),
}

impl Decided for Calibrated {
    fn verdict(&self) -> Verdict {
        match self {
            Calibrated::Plane(found) => found.verdict(),
            Calibrated::Space(found) => found.verdict(),
        }
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        match self {
            Calibrated::Plane(found) => &mut found.warnings,
            Calibrated::Space(found) => &mut found.warnings,
        }
    }
}

/// Why there is none.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibratedError {
    /// The calibration in the plane failed, or was stopped.
    #[error(transparent)]
    Plane(#[from] CalibrateError),
    /// The one in space did.
    #[error(transparent)]
    Space(#[from] CalibrateError<3>),
}
