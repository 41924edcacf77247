//! Whether errors are one-sided, where nothing is said of them: a network that fits so, where none does with errors of
//! either sign.

use crate::calibrate::options::{CalibrateOptions, Errors, ReceiverDelays};
use crate::calibrate::report::calibration::Calibration;
use crate::quantity::length;
use hc::Monitor;

/// Deviation of the measurements with one-sided errors, as a share of that with errors of either sign, up to which the
/// former are taken. Of twelve networks of 10r/30s in space, three tenths late by 1.5 m and noise of 1 cm, nine right ones leave
/// 0.02 to 0.03 of it and the others 0.19 and more; eight tables of what is no distance, or mostly noise, leave 0.67 and more.
const NARROW: f64 = 0.1;

/// What this choice asks of a calibration.
pub(crate) struct Verdict {
    /// Whether the measurements fit the network.
    fits: bool,
    /// Whether the network can be trusted.
    is_trusted: bool,
    /// Standard deviation of the measurements, if it was estimated.
    deviation: Option<f64>,
}

/// A calibration in the plane or in space.
pub(crate) trait Decided {
    /// What the choice of errors asks of it.
    fn verdict(&self) -> Verdict;

    /// Its warnings, for a further one.
    fn warnings(&mut self) -> &mut Vec<String>;
}

impl<const D: usize> Decided for Calibration<D> {
    fn verdict(&self) -> Verdict {
        let deviation = Some(self.sigma).filter(|_| self.sigma_estimated);
        Verdict { fits: self.fits, is_trusted: self.distrust().is_none(), deviation }
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }
}

/// What `calibrate` finds with errors of either sign; where that does not fit and nothing is said of errors, what it finds
/// with one-sided ones, if the measurements are much closer to that.
///
/// # Errors
/// Those of `calibrate`; of the second try only if it was stopped.
pub(crate) fn with_errors_chosen<const D: usize, T: Decided, E>(
    options: &CalibrateOptions<D>,
    monitor: &Monitor,
    calibrate: impl Fn(&CalibrateOptions<D>) -> Result<T, E>,
) -> Result<T, E> {
    let found = calibrate(options)?;
    let symmetric = found.verdict();
    if options.errors != Errors::Auto || options.receiver_delays != ReceiverDelays::None || symmetric.fits {
        return Ok(found);
    }
    // A deviation that is given is the same for both.
    let Some(before) = symmetric.deviation else { return Ok(found) };
    let late = CalibrateOptions { errors: Errors::OneSided, ..options.clone() };
    let mut other = match calibrate(&late) {
        Ok(other) => other,
        Err(error) if monitor.is_cancelled() => return Err(error),
        Err(_) => return Ok(found),
    };
    let one_sided = other.verdict();
    let Some(now) = one_sided.deviation.filter(|now| one_sided.is_trusted && *now <= NARROW * before) else {
        return Ok(found);
    };
    other.warnings().push(format!(
        "no network fits measurements that are too long as often as too short: their deviation would be {}. They were taken to be late by \
         detours, which leaves {}; --errors symmetric says that they are not",
        length(before),
        length(now)
    ));
    Ok(other)
}

#[cfg(test)]
mod tests {
    use crate::{CalibrateOptions, Errors, Pseudoranges, SimulateOptions, calibrate, simulate};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn late_measurements_are_taken_as_such_where_nothing_else_fits() {
        for seed in 0..4 {
            let mut made = SimulateOptions { receivers: 12, transmitters: 40, noise: 0.01, seed, ..Default::default() };
            (made.detours, made.detour_size) = (0.5, 0.5);
            let measured = simulate(&made).unwrap().pseudoranges;
            let found = |errors| calibrate(&measured, &CalibrateOptions { errors, ..Default::default() }).unwrap();
            let (chosen, symmetric, late) = (found(Errors::Auto), found(Errors::Symmetric), found(Errors::OneSided));
            assert!(!symmetric.fits && symmetric.errors == Errors::Symmetric, "seed {seed}");
            assert_eq!((chosen.errors, &chosen.receivers), (Errors::OneSided, &late.receivers), "seed {seed}");
            assert!(chosen.warnings.iter().any(|warning| warning.contains("--errors symmetric")), "seed {seed}");
        }
    }

    #[test]
    fn random_numbers_are_neither_late_nor_fit() {
        for seed in 0..2 {
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let values = (0..160).map(|_| 10.0 * rng.random::<f64>()).collect();
            let measured = Pseudoranges::new(8, 20, values).unwrap();
            for sigma in [None, Some(0.01)] {
                let found = calibrate(&measured, &CalibrateOptions { sigma, ..Default::default() }).unwrap();
                assert!(found.errors == Errors::Symmetric && !found.fits, "seed {seed}, {sigma:?}");
            }
        }
    }
}
