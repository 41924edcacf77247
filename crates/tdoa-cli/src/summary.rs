//! The readable result.

use std::time::Duration;

use tdoa::Calibration;

/// Nodes of each kind that are listed; the rest is in the JSON.
const LISTED: usize = 40;

/// A calibration in words and two tables.
pub(crate) fn text(calibration: &Calibration, time: Duration) -> String {
    let measured = calibration.residuals.iter().flatten().flatten().count();
    let inliers = calibration.inliers.iter().flatten().filter(|&&inlier| inlier).count();
    let deviation = || format!("standard deviation {} m", length(calibration.sigma));
    let mut text = format!(
        "{}: {measured} measurements, {} of them outliers, {}\n",
        calibration.configuration,
        measured - inliers,
        match (calibration.sigma_estimated, calibration.redundancy) {
            (true, 0) => "as many as unknowns: their standard deviation is not known".to_owned(),
            (true, _) => deviation() + " (estimated)",
            (false, _) => deviation() + " (given)",
        },
    );
    text += &format!(
        "{} of {} starts agree, {:.1} s; {}\n",
        calibration.agreeing,
        calibration.starts,
        time.as_secs_f64(),
        match (calibration.unique, calibration.alternatives.is_empty()) {
            (true, _) => "no other network found",
            (false, true) if !calibration.receiver_errors.is_empty() =>
                "A RECEIVER HAS ERRORS OF ITS OWN, see the warnings",
            (false, true) => "A BETTER NETWORK MAY HAVE BEEN MISSED, see the warnings",
            (false, false) if calibration.unique_receivers => {
                "no other receivers found; OTHER TRANSMITTERS FIT AS WELL, see `alternatives` in the JSON (--json)"
            }
            (false, false) => "OTHER NETWORKS FIT AS WELL, see `alternatives` in the JSON (--json)",
        },
    );
    if let Some(why) = calibration.distrust() {
        text += &format!("NOT TO BE TRUSTED: {why}, see the warnings\n");
    }
    if let Some(speed) = &calibration.speed {
        text += &format!("{}\n", speed_line(speed));
    }
    let anchored = calibration.anchored.iter().filter(|&&held| held).count();
    if anchored > 0 {
        text += &format!("{anchored} receivers held at their known positions\n");
    }
    if let Some(truth) = &calibration.truth {
        text += &format!(
            "against the truth: {} receivers, {} m root mean square, {} m with scale {:.4}\n",
            truth.receivers,
            length(truth.receiver_rms),
            length(truth.receiver_rms_scaled),
            truth.scale,
        );
        if let Some(median) = truth.transmitter_median {
            text += &format!("transmitters: median distance {} m\n", length(median));
        }
    }
    text += "\nreceiver                 x            y      std x      std y\n";
    let rows = calibration.receiver_names.iter().zip(&calibration.receivers).zip(&calibration.receiver_std);
    for ((name, position), std) in rows.take(LISTED) {
        text += &row(name, *position, *std, None);
    }
    text += &more(calibration.receivers.len());
    text += "\ntransmitter              x            y      std x      std y       offset\n";
    let rows = calibration.transmitter_names.iter().zip(&calibration.transmitters);
    let rows = rows.zip(&calibration.transmitter_std).zip(&calibration.offsets);
    for (((name, position), std), offset) in rows.take(LISTED) {
        text += &row(name, *position, *std, *offset);
    }
    text += &more(calibration.transmitters.len());
    let outliers: Vec<String> = outliers(calibration);
    if !outliers.is_empty() {
        text += &format!(
            "\noutliers: {}{}\n",
            outliers[..outliers.len().min(LISTED)].join(", "),
            if outliers.len() > LISTED { ", ..." } else { "" }
        );
    }
    for warning in &calibration.warnings {
        text += &format!("\nwarning: {warning}\n");
    }
    text
}

fn speed_line(speed: &tdoa::SpeedEstimate) -> String {
    let relative = speed.factor_std.map(|std| std / speed.factor);
    let percent =
        relative.map_or_else(String::new, |relative| format!(" (standard deviation {:.2} %)", 100.0 * relative));
    let basis = format!(
        "from {} distance{}, which fit to {} m",
        speed.distances,
        if speed.distances == 1 { "" } else { "s" },
        length(speed.residual)
    );
    match speed.metres_per_second {
        Some(value) => format!("propagation speed {value:.6e} m/s{percent}, {basis}"),
        None => format!("propagation speed {:.6} times the assumed one{percent}, {basis}", speed.factor),
    }
}

fn outliers(calibration: &Calibration) -> Vec<String> {
    let mut all = Vec::new();
    for (i, (residuals, inliers)) in calibration.residuals.iter().zip(&calibration.inliers).enumerate() {
        for (j, (residual, inlier)) in residuals.iter().zip(inliers).enumerate() {
            if let Some(residual) = residual.filter(|_| !inlier) {
                let (receiver, transmitter) = (&calibration.receiver_names[i], &calibration.transmitter_names[j]);
                all.push(format!("{receiver}-{transmitter} ({residual:+.3} m)"));
            }
        }
    }
    all
}

fn row(name: &str, position: Option<[f64; 2]>, std: Option<[f64; 2]>, offset: Option<f64>) -> String {
    let Some([x, y]) = position else {
        return format!("{name:<12} not determined\n");
    };
    let std = std.map_or_else(
        || format!("{:>10} {:>10}", "-", "-"),
        |[sx, sy]| format!("{:>10} {:>10}", length(sx), length(sy)),
    );
    let offset = offset.map_or_else(String::new, |offset| format!(" {offset:>12.4}"));
    format!("{name:<12} {x:>13.4}{y:>13.4} {std}{offset}\n")
}

fn more(count: usize) -> String {
    if count > LISTED { format!("... and {} more, all in --json\n", count - LISTED) } else { String::new() }
}

/// A length with about three digits.
fn length(value: f64) -> String {
    if value == 0.0 || value.abs() >= 1e-4 { format!("{value:.4}") } else { format!("{value:.1e}") }
}
