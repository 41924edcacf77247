//! How much walls reflect.

use super::error::RoomError;
use super::options::{Decay, RoomOptions};

/// By which share of its amplitude a wall reflects sound, 0 to 1, the same for all walls.
///
/// Energy falls by 60 dB in the time T = 24 ln(10) V / (c S a), with the volume V, the surface S and the speed c, where
/// a is the share that is absorbed (Sabine) or -ln(1 - that share) (Eyring).
///
/// # Errors
/// If walls would absorb more than everything, by Sabine's formula.
pub(super) fn reflection(options: &RoomOptions) -> Result<f64, RoomError> {
    if options.reverberation == 0.0 {
        return Ok(0.0);
    }
    let [x, y, z] = options.extent;
    let (volume, surface) = (x * y * z, 2.0 * (x * y + y * z + z * x));
    let least = 24.0 * std::f64::consts::LN_10 * volume / (options.speed * surface);
    let exponent = least / options.reverberation;
    match options.decay {
        Decay::Eyring => Ok((-exponent / 2.0).exp()),
        Decay::Sabine if exponent >= 1.0 => Err(RoomError::Absorption { least }),
        Decay::Sabine => Ok((1.0 - exponent).sqrt()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_formulas() {
        let mut options = RoomOptions { extent: [10.0, 10.0, 10.0], reverberation: 1.0, ..RoomOptions::default() };
        // 0.161 s/m is 24 ln(10) / c in textbooks, here 0.16111; V / S is 10/6 m.
        let a: f64 = 0.161_11 * 10.0 / 6.0;
        assert!((reflection(&options).unwrap() - (-a / 2.0).exp()).abs() < 1e-5);
        options.decay = Decay::Sabine;
        assert!((reflection(&options).unwrap() - (1.0 - a).sqrt()).abs() < 1e-5);
        options.reverberation = 0.26;
        assert!(matches!(reflection(&options), Err(RoomError::Absorption { .. })));
        options.reverberation = 0.0;
        assert_eq!(reflection(&options), Ok(0.0));
    }
}
