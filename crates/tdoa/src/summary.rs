//! Results in words: what the program prints above its tables, and what Python shows.

mod clocks;

use hc::poly::{counted, one_or};
use std::time::Duration;

use crate::calibrate::{Calibration, SpeedEstimate};
use crate::degeneracy::space;
use crate::minimal::MinimalSolution;
use crate::quantity::{length, number};
pub use clocks::{CLOCK_HEADINGS, clock_model, clock_row};

/// A smaller network makes one ask whether its measurements are times, metres.
const SMALL: f64 = 0.2;

/// What was found, one line for each item, and how long it took, if that is known.
pub fn heading<const D: usize>(calibration: &Calibration<D>, time: Option<Duration>) -> String {
    let (measured, outliers) = (calibration.residuals.len(), calibration.residuals.outliers().count());
    let mut text = format!(
        "{}: {}, {outliers} of them outliers, {}\n",
        calibration.configuration,
        counted(measured, "measurement"),
        deviation(calibration),
    );
    if calibration.with_candidates > 0 {
        text += &format!(
            "candidates: of {} with several, {} another than the first\n",
            counted(calibration.with_candidates, "measurement"),
            match calibration.chosen.len() {
                0 => "none takes".to_string(),
                1 => "one takes".to_string(),
                many => format!("{many} take"),
            }
        );
    }
    if let Some(choice) = choice(calibration) {
        text += &format!("{choice}\n");
    }
    if let Some(extent) = calibration.extent() {
        text += &format!("size: {} across (receivers)\n", length(extent));
    }
    let time = time.map_or_else(String::new, |time| format!(", {:.1} s", time.as_secs_f64()));
    text += &format!("{}{time}; {}\n", agreement(calibration), uniqueness(calibration));
    if let Some(why) = calibration.distrust() {
        text += &format!("NOT TO BE TRUSTED: {why}, see the warnings\n");
    }
    if let Some(errors) = calibration.relevant_systematic() {
        text += &format!(
            "systematic errors of the receivers, standard deviation {}: their positions are {} times as uncertain as by noise alone, \
             which tables and pictures show\n",
            length(errors.deviation),
            number(errors.factor, 2)
        );
    }
    if let Some(speed) = &calibration.speed {
        text += &format!("{}\n", speed_line(speed));
    }
    if let Some(model) = clock_model(calibration) {
        text += &format!("clocks: {model}\n");
    }
    let anchored = calibration.anchored.iter().filter(|&&held| held).count();
    if anchored > 0 {
        text += &format!("held at known positions: {}\n", counted(anchored, "receiver"));
    }
    if !calibration.distances.is_empty() {
        let (all, good) =
            (calibration.distances.len(), calibration.distances.iter().filter(|known| known.inlier).count());
        let agree = one_or(good, "agrees", "agree");
        text += &format!("{} between receivers: {good} {agree} with the network\n", counted(all, "measured distance"));
    }
    if let Some(truth) = &calibration.truth {
        text += &format!(
            "against the truth: {}, {} root mean square, {} with scale {:.4}\n",
            counted(truth.receivers, "receiver"),
            length(truth.receiver_rms),
            length(truth.receiver_rms_scaled),
            truth.scale,
        );
        if let Some(median) = truth.transmitter_median {
            text += &format!("transmitters: median distance {}\n", length(median));
        }
    }
    text
}

/// The [`heading`] and the warnings.
pub fn summary<const D: usize>(calibration: &Calibration<D>) -> String {
    let warnings = calibration.warnings.iter().map(|warning| format!("warning: {warning}\n"));
    heading(calibration, None) + &warnings.collect::<String>()
}

/// What an exact solution has found, one line for each item, and how long it took, if that is known.
pub fn networks<const D: usize>(solution: &MinimalSolution<D>, time: Option<Duration>) -> String {
    let (paths, counts) = (solution.paths, solution.counts);
    let time = time.map_or_else(String::new, |time| format!(" in {:.1} ms", 1e3 * time.as_secs_f64()));
    let mut text = format!(
        "{} by {}{time}: {}\n{}: {} finite, {} at infinity, {} failed, {} tracked again\n\
         {}: {} real, {} with real positions, {} of these physical\n",
        solution.configuration,
        solution.solver,
        counted(solution.candidates.len(), "network"),
        counted(paths.tracked, "path"),
        paths.finite,
        paths.at_infinity,
        paths.failed,
        paths.retracked,
        counted(counts.complex, "complex root"),
        counts.real,
        counts.positive_definite,
        counts.physical,
    );
    if let Some(best) = solution.candidates.first() {
        let size = length(best.network.size());
        text += &format!("size: {size} (receivers from their centroid, root mean square, best network)\n");
    }
    if solution.stopped_early {
        text += "stopped at the first network that fits; others may fit as well\n";
    }
    text
}

/// The standard deviation of the measurements, and where it comes from.
pub fn deviation<const D: usize>(calibration: &Calibration<D>) -> String {
    let sigma = calibration.sigma;
    match (calibration.sigma_estimated, calibration.redundancy) {
        (true, 0) => "as many as unknowns: their standard deviation is not known".to_string(),
        (true, _) if calibration.sigma_is_factor => {
            format!("standard deviation {} at the median weight (estimated)", length(sigma))
        }
        (true, _) => format!("standard deviation {} (estimated)", length(sigma)),
        (false, _) if !calibration.sigma_is_factor => format!("standard deviation {} (given)", length(sigma)),
        (false, _) if sigma == 1.0 => "each with its own standard deviation (given)".to_string(),
        (false, _) => format!("standard deviations {} times those of each (given)", number(sigma, 3)),
    }
}

/// Whether the network is in space, and what the measurements said of it where they chose; `None` for one
/// in the plane of which nothing was asked.
pub(crate) fn choice<const D: usize>(calibration: &Calibration<D>) -> Option<String> {
    let place = space(D);
    let Some(test) = calibration.dimension_test else { return (D > 2).then(|| place.to_string()) };
    Some(match test.evidence {
        Some(evidence) if evidence > 0.0 => {
            format!("{place}: heights make the measurements more likely by {} (natural logarithm)", number(evidence, 3))
        }
        Some(evidence) => {
            format!(
                "{place}: heights make the measurements less likely, by {} (natural logarithm)",
                number(-evidence, 3)
            )
        }
        None => match test.gain.zip(test.needed) {
            Some((gain, needed)) => format!(
                "{place}: the best heights make the measurements more likely by {} (natural logarithm), chance by up to {}",
                number(gain, 3),
                number(needed, 3)
            ),
            None => format!("{place}: too few measurements to look for heights"),
        },
    })
}

/// How many starts agree.
pub(crate) fn agreement<const D: usize>(calibration: &Calibration<D>) -> String {
    let (agreeing, starts) = (calibration.agreeing, calibration.starts);
    if calibration.laid_together {
        format!("{agreeing} of {} of neighbours {}", counted(starts, "small network"), one_or(agreeing, "fits", "fit"))
    } else {
        format!("{agreeing} of {} {}", counted(starts, "start"), one_or(agreeing, "agrees", "agree"))
    }
}

/// Whether the network is the only one, for receivers and transmitters.
pub(crate) fn uniqueness<const D: usize>(calibration: &Calibration<D>) -> &'static str {
    match (calibration.unique, calibration.unique_receivers, calibration.unique_transmitters) {
        (true, ..) => "unique: no other places of receivers or transmitters were found that fit as well",
        (_, true, false) => "the receivers are unique; SOME TRANSMITTERS MAY LIE ELSEWHERE, see the warnings",
        (_, true, true) => "the receivers are unique, and most transmitters; A FEW MAY LIE ELSEWHERE, see the warnings",
        (_, false, true) if !calibration.alternatives.is_empty() => {
            "NOT UNIQUE: the transmitters fit in one way, RECEIVERS MAY LIE ELSEWHERE, see the warnings"
        }
        _ if !calibration.alternatives.is_empty() => {
            "NOT UNIQUE: receivers and transmitters may lie elsewhere, OTHER NETWORKS FIT AS WELL, see the warnings"
        }
        _ if !calibration.mirror_images.is_empty() => {
            "NOT UNIQUE: SOME NODES MAY LIE ON THE OTHER SIDE OF A PLANE, see the warnings"
        }
        _ if !calibration.receiver_errors.is_empty() => {
            "NOT UNIQUE: A RECEIVER HAS ERRORS OF ITS OWN, see the warnings"
        }
        _ if calibration.distrust().is_some() => "NOT UNIQUE",
        _ if calibration.laid_together => "NOT UNIQUE: SOME RECEIVERS ARE TIED TO THE OTHERS WEAKLY, see the warnings",
        _ => "NOT UNIQUE: A BETTER NETWORK MAY HAVE BEEN MISSED, see the warnings",
    }
}

/// A warning about a network so small that its measurements may be times, if nobody has said that
/// they are lengths.
pub fn doubt_of_units<const D: usize>(calibration: &Calibration<D>) -> Option<String> {
    let extent = calibration.extent().filter(|&extent| extent < SMALL)?;
    Some(format!(
        "the network is {} across; if the measurements are times and not metres, give the propagation speed (343 m/s for sound in air: \
         --units s --speed 343, in Python speed=343)",
        length(extent)
    ))
}

fn speed_line(speed: &SpeedEstimate) -> String {
    let relative = speed.factor_std.map(|std| std / speed.factor);
    let percent = relative
        .map_or_else(String::new, |relative| format!(" (standard deviation {} %)", number(100.0 * relative, 2)));
    let basis = format!(
        "from {} distance{}, which fit to {}",
        speed.distances,
        if speed.distances == 1 { "" } else { "s" },
        length(speed.residual)
    );
    match speed.metres_per_second {
        Some(value) => format!("propagation speed {} m/s{percent}, {basis}", number(value, 6)),
        None => format!("propagation speed {} times the assumed one{percent}, {basis}", number(speed.factor, 6)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CalibrateOptions, Pseudoranges, SimulateOptions, calibrate, simulate};

    #[test]
    fn times_without_a_speed_are_doubted() {
        let simulation = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        let values: Vec<f64> = simulation.pseudoranges.dense().iter().map(|f| f / 343.0).collect();
        let times = Pseudoranges::new(8, 12, values).unwrap();
        let found = calibrate(&times, &CalibrateOptions::default()).unwrap();
        let doubt = doubt_of_units(&found).unwrap();
        // The room of 10 m is 29 mm across, its diagonal 41.
        let size: f64 = doubt.split(' ').nth(3).unwrap().parse().unwrap();
        assert!(
            (15.0..=41.3).contains(&size) && doubt.contains(" mm across; if the measurements are times"),
            "{doubt}"
        );
        let found = calibrate(&simulation.pseudoranges, &CalibrateOptions::default()).unwrap();
        assert_eq!(doubt_of_units(&found), None);
        let text = summary(&found);
        assert!(!text.contains("in the plane") && !text.contains("in space"), "{text}");
        assert!(text.contains("size: ") && text.contains("unique: no other places"), "{text}");
    }

    /// Receivers alternate between 3 cm and 3 mm of noise.
    #[test]
    fn weights_are_deviations_but_for_a_factor() {
        let made = SimulateOptions { receivers: 9, transmitters: 20, noise: 0.003, ..Default::default() };
        let made = simulate(&made).unwrap();
        let coarse = |i: usize| if i.is_multiple_of(2) { 10.0 } else { 1.0 };
        let (network, measured) = (&made.network, &made.pseudoranges);
        let noisy = |i, j| {
            let exact = network.pseudorange(i, j);
            exact + coarse(i) * (measured.get(i, j).unwrap() - exact)
        };
        let values = (0..180).map(|k| noisy(k / 20, k % 20)).collect();
        let measured = crate::Pseudoranges::new(9, 20, values).unwrap();
        let weighed = measured.clone().with_weight_of(|i, _| 7.0 / coarse(i).powi(2)).unwrap();
        let found = calibrate(&weighed, &CalibrateOptions::default()).unwrap();
        assert!(found.sigma_is_factor && found.sigma_estimated, "{found:?}");
        assert!(summary(&found).contains("at the median weight (estimated)"), "{}", summary(&found));
        // Five of nine receivers have the median weight. 180 measurements less 75 unknowns leave a deviation of the
        // estimate of 7 %.
        assert!((found.sigma / 0.03 - 1.0).abs() < 0.2, "{}", found.sigma);

        // Given the deviation of the median weight, weights are deviations.
        let given = CalibrateOptions { sigma: Some(0.03), ..Default::default() };
        let by_weights = calibrate(&weighed, &given).unwrap();
        let with_sigmas = measured.with_sigma_of(|i, _| 0.003 * coarse(i)).unwrap();
        let by_sigmas = calibrate(&with_sigmas, &CalibrateOptions::default()).unwrap();
        let pairs = by_weights.receivers.iter().flatten().zip(by_sigmas.receivers.iter().flatten());
        assert!(
            pairs.clone().count() == 9 && pairs.flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).all(|d| d.abs() < 1e-6)
        );
    }

    #[test]
    fn deviations_of_each_measurement_are_no_metres() {
        let simulation = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        let measured = simulation.pseudoranges.with_sigmas(vec![0.01; 96]).unwrap();
        let found = calibrate(&measured, &CalibrateOptions::default()).unwrap();
        assert!(found.sigma_is_factor && summary(&found).contains("each with its own standard deviation (given)"));
        let options = CalibrateOptions { sigma: Some(2.0), ..Default::default() };
        let text = summary(&calibrate(&measured, &options).unwrap());
        assert!(text.contains("standard deviations 2 times those of each (given)"), "{text}");
    }
}
