//! The options --units, --speed, --rate and --variable.

use tdoa::read::{ReadOptions, Units};

use crate::Failure;

/// Unit of the measurements.
#[derive(clap::Args)]
pub(crate) struct UnitArguments {
    /// Unit of the measurements: metres, seconds, milliseconds, microseconds or samples. What is
    /// written is in metres; offsets in this unit too. Metres if not given, but then a table headed
    /// by times is refused.
    #[arg(long, value_enum)]
    units: Option<Choice>,
    /// Propagation speed in metres a second, for all units but metres; sound in air: 343,
    /// radio: 299792458.
    #[arg(long, allow_negative_numbers = true, value_name = "M/S")]
    speed: Option<f64>,
    /// Samples a second, for --units samples.
    #[arg(long, allow_negative_numbers = true, value_name = "HZ")]
    rate: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Choice {
    M,
    S,
    Ms,
    #[value(alias = "µs")]
    Us,
    Samples,
}

/// Stands for the speed where that is estimated anyway: sound in air.
const ASSUMED: f64 = 343.0;

impl UnitArguments {
    /// The unit, if one is given; where the speed is estimated anyway, any speed will do.
    pub(crate) fn units(&self, estimate_speed: bool) -> Result<Option<Units>, Failure> {
        let unusable = |message: String| Err(Failure::Unusable(message));
        let Some(unit) = self.units.filter(|&unit| unit != Choice::M) else {
            return match (self.speed, self.rate) {
                (None, None) => Ok(self.units.map(|_| Units::Metres)),
                (Some(_), _) => unusable("--speed needs --units s, ms, us or samples".to_string()),
                (None, Some(_)) => unusable("--rate needs --units samples and --speed".to_string()),
            };
        };
        let name = match unit {
            Choice::M => "m",
            Choice::S => "s",
            Choice::Ms => "ms",
            Choice::Us => "us",
            Choice::Samples => "samples",
        };
        let Some(speed) = self.speed.or(estimate_speed.then_some(ASSUMED)) else {
            return unusable(format!("--units {name} needs --speed in metres a second, such as 343 for sound in air"));
        };
        if unit != Choice::Samples && self.rate.is_some() {
            return unusable(format!("--rate is for --units samples, not {name}"));
        }
        Ok(Some(match unit {
            Choice::M => Units::Metres,
            Choice::S => Units::Seconds { speed },
            Choice::Ms => Units::Milliseconds { speed },
            Choice::Us => Units::Microseconds { speed },
            Choice::Samples => match self.rate {
                Some(rate) => Units::Samples { speed, rate },
                None => {
                    return unusable("--units samples needs --rate, the samples a second, such as 48000".to_string());
                }
            },
        }))
    }
}

/// A unit other than the metre, and how many metres it stands for.
#[derive(Clone, Copy, serde::Serialize)]
pub(crate) struct Unit {
    pub(crate) name: &'static str,
    metres: f64,
}

impl Unit {
    /// The unit of measurements; `None` for metres.
    pub(crate) fn new(units: Units) -> Option<Unit> {
        units.speed().map(|_| Unit { name: units.name(), metres: units.metres() })
    }

    /// The unit where the propagation speed is this many times as large.
    pub(crate) fn stretched(self, factor: f64) -> Unit {
        Unit { metres: self.metres * factor, ..self }
    }

    /// A length in this unit.
    pub(crate) fn of(self, metres: f64) -> f64 {
        metres / self.metres
    }

    /// Decimals that show as much of a length as these do in metres.
    pub(crate) fn decimals(self, of_metres: usize) -> usize {
        (of_metres as f64 + self.metres.log10()).round().clamp(1.0, 15.0) as usize
    }
}

/// Which numbers of the file are read, and in what unit.
#[derive(clap::Args)]
pub(crate) struct InputArguments {
    #[command(flatten)]
    units: UnitArguments,
    /// The matrix to read of a .mat file, where that is not z.
    #[arg(long, value_name = "NAME")]
    variable: Option<String>,
}

impl InputArguments {
    /// How the file is read; where the speed is estimated anyway, any speed will do.
    pub(crate) fn options(&self, estimate_speed: bool) -> Result<ReadOptions, Failure> {
        let mut options = ReadOptions::default();
        options.units = self.units.units(estimate_speed)?;
        options.variable.clone_from(&self.variable);
        Ok(options)
    }
}
