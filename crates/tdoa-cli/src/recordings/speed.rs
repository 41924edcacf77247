//! The speed of sound.

use sound::speed_of_sound;

use crate::Failure;

/// Speed of sound at 20 degrees, metres per second.
const USUAL: f64 = 343.0;

/// What tells the speed of sound in air.
#[derive(clap::Args)]
pub(super) struct SpeedArguments {
    /// Temperature of the air in degrees Celsius, which tells the speed of sound: 331.3 sqrt(1 + C / 273.15) m/s.
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    temperature: Option<f64>,
}

/// The speed of sound, and whether it was said.
#[derive(Clone, Copy)]
pub(crate) struct Speed {
    pub(crate) metres_per_second: f64,
    pub(crate) is_said: bool,
}

impl SpeedArguments {
    /// Whether the temperature was given.
    pub(super) fn is_given(&self) -> bool {
        self.temperature.is_some()
    }

    /// The temperature, degrees Celsius.
    pub(super) fn temperature(&self) -> Option<f64> {
        self.temperature
    }

    /// The speed that was `given`, or is that of the temperature, or the usual one.
    pub(super) fn speed(&self, given: Option<f64>) -> Result<Speed, Failure> {
        let speed = match (given, self.temperature) {
            (Some(_), Some(_)) => {
                return Err(Failure::unusable("--speed and --temperature both tell the speed of sound: give one"));
            }
            (Some(speed), None) => speed,
            (None, Some(celsius)) if (-80.0..=80.0).contains(&celsius) => speed_of_sound(celsius),
            (None, Some(celsius)) => {
                return Err(Failure::Unusable(format!(
                    "--temperature is {celsius}, but must be from -80 to 80 degrees Celsius"
                )));
            }
            (None, None) => USUAL,
        };
        if !(1.0..=1e5).contains(&speed) {
            return Err(Failure::Unusable(format!("--speed is {speed}, but must be from 1 to 100,000 m/s")));
        }
        Ok(Speed { metres_per_second: speed, is_said: given.is_some() || self.is_given() })
    }
}

#[cfg(test)]
mod tests {
    use super::SpeedArguments;

    #[test]
    fn speeds_are_said_once_and_within_reason() {
        // Tables have 343.2 m/s for dry air.
        let speed = SpeedArguments { temperature: Some(20.0) }.speed(None).unwrap();
        assert!((speed.metres_per_second - 343.2).abs() < 0.06 && speed.is_said);
        assert!(!SpeedArguments { temperature: None }.speed(None).unwrap().is_said);
        assert!(SpeedArguments { temperature: Some(20.0) }.speed(Some(343.0)).is_err());
        for celsius in [f64::NAN, 300.0, -100.0] {
            assert!(SpeedArguments { temperature: Some(celsius) }.speed(None).is_err());
        }
        assert!(SpeedArguments { temperature: None }.speed(Some(-1.0)).is_err());
    }
}
