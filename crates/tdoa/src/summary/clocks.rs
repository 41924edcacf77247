//! What a calibration says of clocks, in words and numbers.

use crate::calibrate::{Calibration, RecorderClock};
use crate::clocks::Emissions;
use crate::quantity::number;

/// Standard deviations within which a rate may be none.
const BY_CHANCE: f64 = 3.0;

/// Headings of the [numbers](clock_row) of a recorder's clock; those of rates where clocks have them.
pub const CLOCK_HEADINGS: [&str; 5] = ["offset", "std offset", "rate ppm", "std rate ppm", "at"];

/// What was taken to be unknown of clocks, and what measurements cannot tell of them; `None` where each transmitter has an
/// offset and receivers share a clock.
pub fn clock_model<const D: usize>(calibration: &Calibration<D>) -> Option<String> {
    let emissions = calibration.emissions;
    let of_transmitters = match emissions {
        Emissions::Unknown => "each transmitter has an unknown offset",
        Emissions::Constant => "all transmitters have one unknown offset",
        Emissions::Known => "send times are known",
    };
    let Some(first) = calibration.clocks.first() else {
        return (emissions != Emissions::Unknown).then(|| of_transmitters.to_string());
    };
    let (drift, name) = (first.rate.is_some(), &first.recorder);
    // Against send times the first recorder's rate is unknown as well.
    if drift && first.rate_std != Some(0.0) {
        let whose = match emissions {
            Emissions::Constant => "the receivers' clock",
            _ => "each recorder's clock",
        };
        return Some(format!("send times are known, {whose} has an unknown offset and an unknown rate against theirs"));
    }
    let unknown = if drift { "offset and an unknown rate" } else { "offset" };
    let mut told = match (emissions, drift) {
        (Emissions::Known, false) => "offsets are told against the send times".to_string(),
        (Emissions::Known, true) => format!("offsets are told against the send times, rates against {name}"),
        (_, false) => format!("offsets are told against {name}, as one that all have in common is the transmitters'"),
        (_, true) => {
            format!("both are told against {name}, as an offset that all have in common is the transmitters'")
        }
    };
    if drift {
        told += ", and a rate that all have in common cannot be told from the propagation speed";
        let is_told = |clock: &RecorderClock| {
            clock.rate.zip(clock.rate_std).is_some_and(|(rate, deviation)| rate.abs() > BY_CHANCE * deviation)
        };
        if !calibration.clocks.iter().any(is_told) {
            told += "; no rate is told from none, so that unknown offsets alone say as much";
        }
    }
    Some(format!("{of_transmitters}, each recorder's clock an unknown {unknown}; {told}"))
}

/// The numbers of a recorder's clock below [their headings](CLOCK_HEADINGS), metres and parts in a million: as many as there are
/// without rates or with them, empty where the measurements do not determine one.
pub fn clock_row(clock: &RecorderClock, length: impl Fn(f64) -> String) -> Vec<String> {
    let deviation = |value: Option<f64>| value.map_or_else(String::new, |value| number(value, 2));
    let mut row = vec![length(clock.offset), deviation(clock.offset_std)];
    if let Some(rate) = clock.rate {
        let (rate, of_rate) = (1e6 * rate, clock.rate_std.map(|deviation| 1e6 * deviation));
        // A tenth of the deviation.
        let digits =
            of_rate.filter(|of_rate| *of_rate > 0.0).map_or(3, |of_rate| (1.0 - of_rate.log10().floor()) as i32);
        row.extend([format!("{rate:.*}", digits.clamp(0, 9) as usize), deviation(of_rate)]);
        row.push(clock.at.map_or_else(String::new, length));
    }
    row
}

#[cfg(test)]
mod tests {
    use super::{CLOCK_HEADINGS, clock_model, clock_row};
    use crate::html::html;
    use crate::picture::escape;
    use crate::{CalibrateOptions, Emissions, ReceiverClocks, SimulateOptions, calibrate, simulate};

    #[test]
    fn reports_have_the_clocks_and_what_is_told_of_them() {
        let mut made = SimulateOptions { receivers: 8, transmitters: 30, noise: 0.01, seed: 1, ..Default::default() };
        (made.channels, made.delays, made.rates, made.duration) = (2, 50.0, 2e-5, Some(2e5));
        let measured = simulate(&made).unwrap().pseudoranges;
        let mut options = CalibrateOptions::default();
        options.clocks.receivers = ReceiverClocks::Rate;
        let found = calibrate(&measured, &options).unwrap();
        let model = clock_model(&found).unwrap();
        assert!(
            model.contains("cannot be told from the propagation speed") && !model.contains("say as much"),
            "{model}"
        );
        let page = html(&found);
        let table = page.split_once("<table id=\"clocks\">").unwrap().1.split("</table>").next().unwrap();
        // Four recorders below a heading, each with all numbers.
        assert_eq!(table.matches("<tr>").count(), 5);
        assert_eq!(table.matches("<td").count(), 4 * (1 + CLOCK_HEADINGS.len()));
        assert!(page.contains(&format!("<dt>Clocks</dt><dd>{}</dd>", escape(&model))));

        // The first is the reference: its numbers are exact.
        let row = |k: usize| clock_row(&found.clocks[k], |metres| format!("{metres:.2}"));
        assert_eq!(row(0)[..4], ["0.00", "0", "0.000", "0"]);
        let (rate, deviation): (f64, f64) = (row(1)[2].parse().unwrap(), row(1)[3].parse().unwrap());
        assert!((1e-6 * rate - found.clocks[1].rate.unwrap()).abs() <= 1e-7 * deviation, "{rate} {deviation}");

        let of = |emissions: Emissions, receivers: ReceiverClocks| {
            let mut changed = found.clone();
            changed.emissions = emissions;
            match receivers {
                ReceiverClocks::Common => changed.clocks.clear(),
                _ => changed.clocks.iter_mut().for_each(|clock| (clock.rate, clock.rate_std) = (None, None)),
            }
            clock_model(&changed)
        };
        assert_eq!(of(Emissions::Unknown, ReceiverClocks::Common), None);
        assert_eq!(of(Emissions::Known, ReceiverClocks::Common).as_deref(), Some("send times are known"));
        let offsets = of(Emissions::Known, ReceiverClocks::Offset).unwrap();
        assert!(offsets.ends_with("told against the send times"), "{offsets}");
    }
}
