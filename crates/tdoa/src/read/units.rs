//! The unit of the numbers in a file.

use super::error::ReadError;
use super::role::Role;

/// How the numbers of a file become metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Units {
    /// They are metres. The default.
    #[default]
    Metres,
    /// They are centimetres.
    Centimetres,
    /// They are kilometres.
    Kilometres,
    /// They are seconds.
    Seconds {
        /// Propagation speed in metres a second.
        speed: f64,
    },
    /// They are milliseconds.
    Milliseconds {
        /// Propagation speed in metres a second.
        speed: f64,
    },
    /// They are microseconds.
    Microseconds {
        /// Propagation speed in metres a second.
        speed: f64,
    },
    /// They are nanoseconds.
    Nanoseconds {
        /// Propagation speed in metres a second.
        speed: f64,
    },
    /// They are sampling intervals.
    Samples {
        /// Propagation speed in metres a second.
        speed: f64,
        /// Samples a second.
        rate: f64,
    },
}

impl Units {
    /// The length in metres that one of the unit stands for.
    pub fn metres(self) -> f64 {
        match self {
            Units::Metres => 1.0,
            Units::Centimetres => 0.01,
            Units::Kilometres => 1e3,
            Units::Seconds { speed } => speed,
            Units::Milliseconds { speed } => 1e-3 * speed,
            Units::Microseconds { speed } => 1e-6 * speed,
            Units::Nanoseconds { speed } => 1e-9 * speed,
            Units::Samples { speed, rate } => speed / rate,
        }
    }

    /// The propagation speed in metres a second; `None` for lengths.
    pub fn speed(self) -> Option<f64> {
        match self {
            Units::Metres | Units::Centimetres | Units::Kilometres => None,
            Units::Seconds { speed }
            | Units::Milliseconds { speed }
            | Units::Microseconds { speed }
            | Units::Nanoseconds { speed }
            | Units::Samples { speed, .. } => Some(speed),
        }
    }

    /// The unit's short name: `m`, `cm`, `km`, `s`, `ms`, `us`, `ns` or `samples`.
    pub fn name(self) -> &'static str {
        match self {
            Units::Metres => "m",
            Units::Centimetres => "cm",
            Units::Kilometres => "km",
            Units::Seconds { .. } => "s",
            Units::Milliseconds { .. } => "ms",
            Units::Microseconds { .. } => "us",
            Units::Nanoseconds { .. } => "ns",
            Units::Samples { .. } => "samples",
        }
    }

    /// [`Units::metres`], checked.
    pub(super) fn factor(self) -> Result<f64, ReadError> {
        let good = |value: f64| value > 0.0 && value.is_finite();
        if let Some(speed) = self.speed().filter(|&speed| !good(speed)) {
            return Err(ReadError::Speed(speed));
        }
        match self {
            Units::Samples { rate, .. } if !good(rate) => Err(ReadError::Rate(rate)),
            // The quotient of a tiny speed and a huge rate.
            _ if !good(self.metres()) => Err(ReadError::Speed(self.metres())),
            _ => Ok(self.metres()),
        }
    }
}

/// How a file of measurements is read.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Unit of the numbers. Default `None`: metres, but a file whose first line speaks of times is
    /// refused.
    pub units: Option<Units>,
    /// Name of the matrix in a .mat file. Default `None`: z, or the only matrix that the file has.
    pub variable: Option<String>,
    /// Whether transmitters are the rows and receivers the columns of a matrix. Default: no.
    pub transpose: bool,
    /// What columns hold, by their headings, where these do not say it: of a list of measurements, and of
    /// a matrix the column of the names of its rows, and columns to leave out. Default: what headings say.
    pub columns: Vec<(Role, String)>,
    /// What stands before decimals, a point or a comma; the other may stand between thousands. Default
    /// `None`: as the numbers have it, but where these may be a thousand times as large they are refused.
    pub decimal_mark: Option<char>,
    /// Whether several lines of a list for one receiver and transmitter are candidates, of which a calibration picks
    /// one. Default: no, a pair that is there twice is an error.
    pub candidates: bool,
}

impl ReadOptions {
    /// Refuses the options of tables of text for another file.
    pub(super) fn refuse_text(&self, file: &str) -> Result<(), ReadError> {
        let option = if !self.columns.is_empty() {
            "--columns"
        } else if self.decimal_mark.is_some() {
            "--decimal-mark"
        } else if self.candidates {
            "--candidates"
        } else {
            return Ok(());
        };
        Err(ReadError::TextAlone { file: file.to_string(), option })
    }
}

impl From<Units> for ReadOptions {
    fn from(units: Units) -> ReadOptions {
        ReadOptions { units: Some(units), ..ReadOptions::default() }
    }
}
