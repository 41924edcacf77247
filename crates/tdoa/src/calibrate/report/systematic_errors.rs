//! What the report says about systematic errors of the receivers.

use crate::calibrate::input::selection::Input;
use crate::calibrate::receivers::take_out::columns;
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::report::systematic::SystematicErrors;
use crate::calibrate::state::State;
use crate::median::median;
use crate::observations::Observations;
use crate::points::trace;
use crate::refine::{Cancelled, Projection, Systematic, can_be_estimated, systematic};
use std::array::from_fn;

/// Gain that noise alone exceeds in one network of a thousand (9 of 7,500 simulated ones): twice the gain is zero in half
/// of them, and otherwise follows chi-squared with one degree of freedom (Self and Liang 1987).
const SIGNIFICANT: f64 = 4.77;

/// Errors below this share of the network's size are rounding.
const ROUNDING: f64 = 1e-9;

/// The sums of covariances at some places.
fn sums<const D: usize>(
    noise: &[Option<[[f64; D]; D]>],
    at: &[usize],
    added: &[[[f64; D]; D]],
) -> Vec<Option<[[f64; D]; D]>> {
    let mut all = noise.to_vec();
    for (&k, by) in at.iter().zip(added) {
        all[k] = all[k].map(|c| from_fn(|a| from_fn(|b| c[a][b] + by[a][b])));
    }
    all
}

impl<const D: usize> State<'_, D> {
    /// Systematic errors of the receivers, for a calibration in the frame of the best network.
    pub(crate) fn systematic(
        &self,
        input: &Input<'_>,
        kept: &Observations<D>,
        calibration: &Calibration<D>,
    ) -> Result<Option<SystematicErrors<D>>, Cancelled> {
        let monitor = self.monitor;
        if !can_be_estimated(kept.receivers, calibration.redundancy) {
            return Ok(None);
        }
        let best = &self.ranked[0].network;
        let Some(projection) = Projection::new(kept, best, monitor)? else { return Ok(None) };
        let taken = columns(kept, &projection, self.unknown_errors(), monitor)?;
        let found = systematic(kept, best, calibration.redundancy, &projection, &taken, monitor)?;
        let Some(Systematic { deviation, gain, receivers, transmitters }) = found else { return Ok(None) };
        let noise = &calibration.receiver_covariance;
        let receiver_covariance = sums(noise, &input.usable.receivers, &receivers);
        let pairs =
            noise.iter().zip(&receiver_covariance).filter_map(|(a, b)| Some((trace(a.as_ref()?), trace(b.as_ref()?))));
        // Held receivers have no error of either kind.
        let factor = median(pairs.map(|(a, b)| (b / a).sqrt()).filter(|ratio| ratio.is_finite()).collect());
        Ok(Some(SystematicErrors {
            deviation,
            gain,
            significant: gain > SIGNIFICANT && deviation > ROUNDING * best.size(),
            factor: factor.unwrap_or(1.0),
            receiver_covariance,
            transmitter_covariance: sums(
                &calibration.transmitter_covariance,
                &input.usable.transmitters,
                &transmitters,
            ),
        }))
    }
}

#[cfg(test)]
mod tests {
    use crate::align::Transform;
    use crate::html::html;
    use crate::node_table::node_table;
    use crate::picture::picture;
    use crate::points::trace;
    use crate::summary::summary;
    use crate::{
        CalibrateOptions, Calibration, Errors, ReceiverClocks, SimulateOptions, SystematicErrors, calibrate, simulate,
    };

    const SIGMA: f64 = 0.01;

    fn run(delays: f64, seed: u64, options: &CalibrateOptions) -> Calibration {
        let made =
            SimulateOptions { receivers: 10, transmitters: 40, noise: SIGMA, delays, seed, ..Default::default() };
        calibrate(&simulate(&made).unwrap().pseudoranges, options).unwrap()
    }

    #[test]
    fn delays_matter_and_noise_does_not() {
        for seed in 0..4 {
            let found = run(0.02, seed, &CalibrateOptions::default());
            let errors = found.systematic.as_ref().unwrap();
            assert!(errors.matter() && errors.deviation > 0.5 * 0.02 && errors.deviation < 2.0 * 0.02, "{errors:?}");
            let text = summary(&found);
            assert!(text.contains("systematic errors of the receivers"), "{text}");
            let found = run(0.0, seed, &CalibrateOptions::default());
            let errors = found.systematic.as_ref().unwrap();
            assert!(!errors.significant && errors.factor >= 1.0 && errors.factor < 1.5, "{errors:?}");
            assert!(!summary(&found).contains("systematic"));
            for (usual, new) in found.receiver_covariance.iter().zip(&errors.receiver_covariance) {
                assert!(trace(&new.unwrap()) >= trace(&usual.unwrap()));
            }
        }
    }

    #[test]
    fn tables_and_pictures_show_the_deviations_to_trust() {
        // The same network with and without the mark that its systematic errors matter.
        let mut with = run(0.02, 0, &CalibrateOptions::default());
        // Far larger than those of noise, and the same for all nodes, so that they are told at sight.
        let errors = with.systematic.as_mut().unwrap();
        errors.receiver_covariance.fill(Some([[0.0625, 0.0], [0.0, 0.25]]));
        errors.transmitter_covariance.fill(Some([[0.0625, 0.0], [0.0, 0.25]]));
        let mut without = with.clone();
        without.systematic.as_mut().unwrap().significant = false;
        assert_eq!(with.trusted_deviations().map(|all| all[3].unwrap()), [[0.25, 0.5]; 2]);
        assert_eq!(without.trusted_deviations(), [with.receiver_std.clone(), with.transmitter_std.clone()]);
        let held = |text: &str, deviations: &str| text.matches(deviations).count();
        // All ten receivers and forty transmitters.
        for (calibration, nodes) in [(&with, 50), (&without, 0)] {
            assert_eq!(held(&node_table(calibration), ",0.25,0.5,0,"), nodes);
            assert_eq!(held(&html(calibration), "<td>0.25</td><td>0.5</td>"), nodes);
            let words = "with systematic errors of the receivers";
            assert_eq!(held(&html(calibration), words) == 2, nodes > 0);
            assert_eq!(held(&picture(calibration), words) == 1, nodes > 0);
        }
        // Their ellipses stand upright, whatever the scale of the picture.
        let upright = |svg: &str| svg.matches("rotate(-90.00)").count();
        assert!(upright(&picture(&with)) > 40 && upright(&picture(&without)) == 0);
    }

    #[test]
    fn clocks_that_are_unknown_are_no_systematic_errors() {
        let mut options = CalibrateOptions::default();
        options.clocks.receivers = ReceiverClocks::Offset;
        for seed in 0..3 {
            let found = run(2.0, seed, &options);
            let errors = found.systematic.unwrap();
            assert!(!errors.significant && errors.deviation < 2.0 * SIGMA, "{errors:?}");
        }
    }

    #[test]
    fn rounding_is_no_systematic_error() {
        for seed in 0..3 {
            let exact =
                simulate(&SimulateOptions { receivers: 10, transmitters: 20, seed, ..Default::default() }).unwrap();
            let found = calibrate(&exact.pseudoranges, &CalibrateOptions::default()).unwrap();
            assert!(!found.systematic.as_ref().is_some_and(|errors| errors.significant), "{:?}", found.systematic);
        }
    }

    #[test]
    fn nothing_is_said_of_one_sided_errors() {
        let options = CalibrateOptions { errors: Errors::OneSided, ..Default::default() };
        assert_eq!(run(0.0, 0, &options).systematic, None);
    }

    #[test]
    fn covariances_turn_and_grow_with_the_network() {
        let found = run(0.02, 0, &CalibrateOptions::default());
        let mut turned = found.clone();
        turned.transform(&Transform { rotation: [[0.0, -1.0], [1.0, 0.0]], scale: 1.0, translation: [3.0, 4.0] });
        turned.rescale(2.0);
        let (before, after) = (found.systematic.unwrap(), turned.systematic.unwrap());
        assert_eq!((after.deviation, after.factor), (2.0 * before.deviation, before.factor));
        let all = |errors: &SystematicErrors| -> Vec<[[f64; 2]; 2]> {
            errors.receiver_covariance.iter().chain(&errors.transmitter_covariance).map(|c| c.unwrap()).collect()
        };
        for (a, b) in all(&before).iter().zip(&all(&after)) {
            let turned = [[4.0 * a[1][1], -4.0 * a[1][0]], [-4.0 * a[0][1], 4.0 * a[0][0]]];
            assert!((0..4).all(|k| (turned[k / 2][k % 2] - b[k / 2][k % 2]).abs() < 1e-12), "{turned:?} {b:?}");
        }
    }

    #[test]
    fn results_are_read_with_and_without_these_errors() {
        let found = run(0.0, 1, &CalibrateOptions::default());
        let text = serde_json::to_string(&found).unwrap();
        assert_eq!(serde_json::from_str::<Calibration>(&text).unwrap(), found);
        let mut old: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(old.as_object_mut().unwrap().remove("systematic").is_some());
        let old: Calibration = serde_json::from_value(old).unwrap();
        assert_eq!(old, Calibration { systematic: None, ..found });
    }
}
