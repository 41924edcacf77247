//! The readable result.

use std::time::Duration;

use tdoa::Calibration;
use tdoa::quantity::{coordinate, decimals, length, number};
use tdoa::summary::{CLOCK_HEADINGS, clock_row, heading};

use crate::units::Unit;

/// Nodes of each kind that are listed; the rest is in the JSON.
const LISTED: usize = 40;

/// What the summary says beside the calibration.
pub(crate) struct Context {
    /// How long it took.
    pub(crate) time: Duration,
    /// The unit of the measurements, if not the metre.
    pub(crate) unit: Option<Unit>,
}

/// A calibration in words and two tables.
pub(crate) fn text<const D: usize>(calibration: &Calibration<D>, context: &Context) -> String {
    let mut text = heading(calibration, Some(context.time));
    for warning in &calibration.warnings {
        text += &format!("\nwarning: {warning}\n");
    }
    let extent = calibration.extent().unwrap_or(0.0);
    let digits = decimals(extent);
    text += &format!("\nlengths in metres\n{:<12} {}\n", "receiver", axes::<D>());
    let [of_receivers, of_transmitters] = calibration.trusted_deviations();
    let rows = calibration.receiver_names.iter().zip(&calibration.receivers).zip(&of_receivers);
    for ((name, position), std) in rows.take(LISTED) {
        text += &row(name, *position, *std, digits);
        text += "\n";
    }
    text += &more(calibration.receivers.len());
    let unit = context.unit.map_or_else(String::new, |unit| format!(" {:>14}", format!("offset {}", unit.name)));
    text += &format!("\n{:<12} {} {:>12}{unit}\n", "transmitter", axes::<D>(), "offset");
    let rows = calibration.transmitter_names.iter().zip(&calibration.transmitters);
    let rows = rows.zip(&of_transmitters).zip(&calibration.offsets);
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
    text += &clocks(calibration, digits);
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

/// The table of the recorders' clocks, if they have some of their own.
fn clocks<const D: usize>(calibration: &Calibration<D>, digits: usize) -> String {
    let rows = calibration.clocks.iter().map(|clock| (&clock.recorder, clock_row(clock, |x| coordinate(x, digits))));
    let rows: Vec<_> = rows.take(LISTED).collect();
    let Some((_, first)) = rows.first() else { return String::new() };
    let line = |name: &str, cells: &mut dyn Iterator<Item = &str>| {
        format!(
            "{name:<12} {}\n",
            cells.map(|cell| format!("{:>14}", if cell.is_empty() { "-" } else { cell })).collect::<String>()
        )
    };
    let mut text = "\n".to_string() + &line("recorder", &mut CLOCK_HEADINGS.into_iter().take(first.len()));
    for (name, cells) in &rows {
        text += &line(name, &mut cells.iter().map(String::as_str));
    }
    text + &more(calibration.clocks.len())
}

fn outliers<const D: usize>(calibration: &Calibration<D>) -> Vec<String> {
    let name = |(i, j, residual): (usize, usize, f64)| {
        let (receiver, transmitter) = (&calibration.receiver_names[i], &calibration.transmitter_names[j]);
        let sign = if residual > 0.0 { "+" } else { "" };
        format!("{receiver}-{transmitter} ({sign}{})", length(residual))
    };
    calibration.residuals.outliers().map(name).collect()
}

/// The headings of a position and its standard deviations.
fn axes<const D: usize>() -> String {
    let names = ["x", "y", "z"];
    let positions = names.iter().take(D).map(|name| format!("{name:>13}"));
    positions.chain(names.iter().take(D).map(|name| format!(" {:>10}", format!("std {name}")))).collect()
}

/// A node, without the end of its line.
fn row<const D: usize>(name: &str, position: Option<[f64; D]>, std: Option<[f64; D]>, digits: usize) -> String {
    let Some(position) = position else { return format!("{name:<12} not determined") };
    let position = position.map(|value| format!("{:>13}", coordinate(value, digits)));
    let std: Vec<String> = (0..D).map(|k| std.map_or_else(|| "-".to_string(), |std| number(std[k], 2))).collect();
    let std: String = std.iter().map(|std| format!(" {std:>10}")).collect();
    format!("{name:<12} {}{std}", position.concat())
}

fn more(count: usize) -> String {
    if count > LISTED { format!("... and {} more, all in --json\n", count - LISTED) } else { String::new() }
}
