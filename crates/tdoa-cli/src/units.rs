//! The options --units and --speed.

use tdoa::read::Units;

use crate::Failure;

/// Unit of the measurements.
#[derive(clap::Args)]
pub(crate) struct UnitArguments {
    /// Unit of the measurements.
    #[arg(long, value_parser = ["m", "s"], default_value = "m")]
    units: String,
    /// Propagation speed in metres a second, for --units s; sound in air: 343, radio: 299792458.
    #[arg(long, allow_negative_numbers = true)]
    speed: Option<f64>,
}

impl UnitArguments {
    /// The unit; where the speed is estimated anyway, any will do.
    pub(crate) fn units(&self, estimate_speed: bool) -> Result<Units, Failure> {
        match (self.units.as_str(), self.speed) {
            ("m", None) => Ok(Units::Metres),
            ("m", Some(_)) => Err(Failure::Unusable("--speed needs --units s".to_string())),
            (_, Some(speed)) => Ok(Units::Seconds { speed }),
            (_, None) if estimate_speed => Ok(Units::Seconds { speed: 343.0 }),
            (_, None) => Err(Failure::Unusable(
                "--units s needs --speed in metres a second, such as 343 for sound in air".to_string(),
            )),
        }
    }
}
