//! The air that sound passes.

/// Speed of sound in dry air at 0 degrees Celsius, metres per second, and that temperature in kelvins.
const AT_ZERO: f64 = 331.3;
const ZERO: f64 = 273.15;

/// The speed of sound in dry air of this temperature in degrees Celsius, metres per second: 331.3 sqrt(1 + C / 273.15), as
/// that of an ideal gas goes with the root of the absolute temperature. Humid air is faster by some thousandths. NaN below
/// absolute zero.
///
/// ```
/// assert!((sound::speed_of_sound(20.0) - 343.2).abs() < 0.1);
/// ```
pub fn speed_of_sound(celsius: f64) -> f64 {
    AT_ZERO * (1.0 + celsius / ZERO).sqrt()
}

#[cfg(test)]
mod tests {
    use super::speed_of_sound;

    /// Tables of the speed of sound in dry air.
    #[test]
    fn sound_is_as_fast_as_tables_have_it() {
        for (celsius, expected) in [(0.0, 331.3), (20.0, 343.2), (30.0, 349.0), (-20.0, 318.9)] {
            assert!((speed_of_sound(celsius) - expected).abs() < 0.06, "{celsius}");
        }
    }
}
