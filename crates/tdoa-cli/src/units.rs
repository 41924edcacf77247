//! The options --units, --speed, --rate and --variable.

use tdoa::read::{ReadOptions, Units};

use crate::Failure;
use crate::provenance::{named, said};

/// Unit of the measurements.
#[derive(clap::Args)]
pub(crate) struct UnitArguments {
    /// Unit of the measurements: metres, centimetres, kilometres, seconds, milliseconds,
    /// microseconds, nanoseconds or samples. What is written is in metres; offsets in this unit too.
    /// Metres if not given, but then a table headed by times or another unit is refused.
    #[arg(long, value_enum)]
    units: Option<Choice>,
    /// Propagation speed in metres a second, for all units but lengths; sound in air: 343,
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
    Cm,
    Km,
    S,
    Ms,
    #[value(alias = "µs")]
    Us,
    Ns,
    Samples,
}

/// Stands for the speed where that is estimated anyway: sound in air.
const ASSUMED: f64 = 343.0;

impl UnitArguments {
    /// The unit, if one is given; where the speed is estimated anyway, any speed will do.
    pub(crate) fn units(&self, estimate_speed: bool) -> Result<Option<Units>, Failure> {
        let unusable = |message: String| Err(Failure::Unusable(message));
        let Some(unit) = self.units else { return self.refuse_speed().map(|()| None) };
        // Whether these were given is seen to below.
        let (speed, rate) = (self.speed.unwrap_or(ASSUMED), self.rate.unwrap_or(f64::NAN));
        let units = match unit {
            Choice::M => Units::Metres,
            Choice::Cm => Units::Centimetres,
            Choice::Km => Units::Kilometres,
            Choice::S => Units::Seconds { speed },
            Choice::Ms => Units::Milliseconds { speed },
            Choice::Us => Units::Microseconds { speed },
            Choice::Ns => Units::Nanoseconds { speed },
            Choice::Samples => Units::Samples { speed, rate },
        };
        if units.speed().is_none() {
            return self.refuse_speed().map(|()| Some(units));
        }
        let name = units.name();
        if self.speed.is_none() && !estimate_speed {
            return unusable(format!(
                "--units {name} needs --speed in metres a second, such as 343 for sound in air or 299792458 for radio"
            ));
        }
        match (unit, self.rate) {
            (Choice::Samples, None) => {
                unusable("--units samples needs --rate, the samples a second, such as 48000".to_string())
            }
            (Choice::Samples, _) | (_, None) => Ok(Some(units)),
            (_, Some(_)) => unusable(format!("--rate is for --units samples, not {name}")),
        }
    }

    /// Lengths have neither speed nor rate.
    fn refuse_speed(&self) -> Result<(), Failure> {
        match (self.speed, self.rate) {
            (None, None) => Ok(()),
            (Some(_), _) => Err(Failure::unusable("--speed needs --units s, ms, us, ns or samples")),
            (None, Some(_)) => Err(Failure::unusable("--rate needs --units samples and --speed")),
        }
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
        (units != Units::Metres).then(|| Unit { name: units.name(), metres: units.metres() })
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

    /// Names and values of the options that were given.
    pub(crate) fn settings(&self) -> Vec<(String, String)> {
        let units = &self.units;
        [
            named("units", units.units.map(said)),
            named("speed", units.speed),
            named("rate", units.rate),
            named("variable", self.variable.as_ref()),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
