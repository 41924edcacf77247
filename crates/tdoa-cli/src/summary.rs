//! The readable result.

use std::time::Duration;

use tdoa::quantity::{coordinate, decimals, length, number};
use tdoa::{Calibration, SpeedEstimate};

use crate::units::Unit;

/// Nodes of each kind that are listed; the rest is in the JSON.
const LISTED: usize = 40;

/// What the summary says beside the calibration.
pub(crate) struct Context {
    /// How long it took.
    pub(crate) time: Duration,
    /// The unit of the measurements, if not the metre.
    pub(crate) unit: Option<Unit>,
    /// Whether measurements carry standard deviations, so that the calibration's is a factor.
    pub(crate) has_sigmas: bool,
}

/// A calibration in words and two tables.
pub(crate) fn text(calibration: &Calibration, context: &Context) -> String {
    let mut text = heading(calibration, context);
    for warning in &calibration.warnings {
        text += &format!("\nwarning: {warning}\n");
    }
    let extent = calibration.extent().unwrap_or(0.0);
    let digits = decimals(extent);
    text += "\nlengths in metres\nreceiver                 x            y      std x      std y\n";
    let rows = calibration.receiver_names.iter().zip(&calibration.receivers).zip(&calibration.receiver_std);
    for ((name, position), std) in rows.take(LISTED) {
        text += &row(name, *position, *std, digits);
        text += "\n";
    }
    text += &more(calibration.receivers.len());
    let unit = context.unit.map_or_else(String::new, |unit| format!(" {:>14}", format!("offset {}", unit.name)));
    text += &format!("\ntransmitter              x            y      std x      std y       offset{unit}\n");
    let rows = calibration.transmitter_names.iter().zip(&calibration.transmitters);
    let rows = rows.zip(&calibration.transmitter_std).zip(&calibration.offsets);
    for (((name, position), std), offset) in rows.take(LISTED) {
        text += &row(name, *position, *std, digits);
        if let Some(offset) = offset.filter(|_| position.is_some()) {
            text += &format!(" {:>12}", coordinate(offset, digits));
            text += &context.unit.map_or_else(String::new, |unit| {
                format!(" {:>14}", coordinate(unit.of(offset), unit.decimals(digits)))
            });
        }
        text += "\n";
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
    text
}

/// What was found, before the tables.
fn heading(calibration: &Calibration, context: &Context) -> String {
    let measured = calibration.residuals.iter().flatten().flatten().count();
    let inliers = calibration.inliers.iter().flatten().filter(|&&inlier| inlier).count();
    let deviation = || match context.has_sigmas {
        true => format!("standard deviation {} times those given with the measurements", number(calibration.sigma, 3)),
        false => format!("standard deviation {}", length(calibration.sigma)),
    };
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
    if let Some(extent) = calibration.extent() {
        text += &format!("size: {} across (receivers)\n", length(extent));
    }
    text += &format!(
        "{} of {} starts agree, {:.1} s; {}\n",
        calibration.agreeing,
        calibration.starts,
        context.time.as_secs_f64(),
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
            "against the truth: {} receivers, {} root mean square, {} with scale {:.4}\n",
            truth.receivers,
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

fn outliers(calibration: &Calibration) -> Vec<String> {
    let mut all = Vec::new();
    for (i, (residuals, inliers)) in calibration.residuals.iter().zip(&calibration.inliers).enumerate() {
        for (j, (residual, inlier)) in residuals.iter().zip(inliers).enumerate() {
            if let Some(residual) = residual.filter(|_| !inlier) {
                let (receiver, transmitter) = (&calibration.receiver_names[i], &calibration.transmitter_names[j]);
                let sign = if residual > 0.0 { "+" } else { "" };
                all.push(format!("{receiver}-{transmitter} ({sign}{})", length(residual)));
            }
        }
    }
    all
}

/// A node, without the end of its line.
fn row(name: &str, position: Option<[f64; 2]>, std: Option<[f64; 2]>, digits: usize) -> String {
    let Some([x, y]) = position.map(|position| position.map(|value| coordinate(value, digits))) else {
        return format!("{name:<12} not determined");
    };
    let std = std.map_or_else(
        || format!("{:>10} {:>10}", "-", "-"),
        |std| {
            let [sx, sy] = std.map(|value| number(value, 2));
            format!("{sx:>10} {sy:>10}")
        },
    );
    format!("{name:<12} {x:>13}{y:>13} {std}")
}

fn more(count: usize) -> String {
    if count > LISTED { format!("... and {} more, all in --json\n", count - LISTED) } else { String::new() }
}
