//! The beginning of an event in all channels, one below the other.

use std::fmt::Write;

use super::escape::escape;
use crate::events::ChannelSamples;

/// Seconds that are drawn before the time at which channels are aligned, and after it.
const BEFORE: f64 = 0.002;
const AFTER: f64 = 0.008;

/// Sizes in the unit of the picture: the names, the waveforms, the labels; a row.
const NAMES: f64 = 150.0;
const WIDTH: f64 = 520.0;
const LABELS: f64 = 170.0;
const ROW: f64 = 34.0;

/// Columns of the waveforms, each from the least sample to the largest.
const COLUMNS: usize = 260;

/// What is drawn of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace<'a> {
    /// Name of the channel.
    pub name: &'a str,
    /// Its samples around the event.
    pub samples: &'a ChannelSamples,
    /// When the event was found to arrive, by the clock of the samples, seconds; `None` if it was not.
    pub picked: Option<f64>,
    /// When it arrives by all that is known, seconds: the channels are aligned by it, or by `picked` where it is `None`.
    /// Channels that have neither are drawn from where their samples begin.
    pub expected: Option<f64>,
    /// Whether the arrival is used. One that is not is drawn in another colour.
    pub is_used: bool,
    /// What is said of it at the right.
    pub label: String,
}

/// The waveforms of an event, aligned by when it should arrive, with a line where it was found to. Each channel is drawn at a
/// scale of its own.
///
/// ```
/// let mut room = sound::RoomOptions::default();
/// (room.microphones, room.sources) = (sound::Placement::Random(4), sound::Placement::Random(1));
/// let made = sound::simulate_room(&room)?;
/// # let folder = std::env::temp_dir().join(format!("sound-waveforms-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("claps.wav");
/// sound::write_wav(&path, made.sample_rate, &made.channels, sound::SampleFormat::Int16)?;
/// let found = sound::find_events([&path], &sound::EventOptions::default())?;
/// let samples = sound::event_windows([&path], &found)?.next().unwrap()?;
/// let trace = |(samples, onset): (_, &Option<sound::Onset>)| sound::Trace {
///     name: "microphone",
///     samples,
///     picked: onset.map(|onset| onset.seconds),
///     expected: None,
///     is_used: true,
///     label: String::new(),
/// };
/// let traces: Vec<_> = samples.channels.iter().zip(&found.events[0].onsets).map(trace).collect();
/// assert!(sound::waveforms(&traces).starts_with("<svg"));
/// # std::fs::remove_dir_all(folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn waveforms(traces: &[Trace<'_>]) -> String {
    let (width, height) = (NAMES + WIDTH + LABELS, ROW * traces.len() as f64 + 28.0);
    let x = |seconds: f64| NAMES + WIDTH * (seconds + BEFORE) / (BEFORE + AFTER);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\" \
         class=\"waveforms\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let bottom = height - 28.0;
    // Writing to a string does not fail.
    for milliseconds in (-2..=8).step_by(2) {
        let at = x(1e-3 * f64::from(milliseconds));
        let colour = if milliseconds == 0 { "#888" } else { "#ddd" };
        let _ = writeln!(
            svg,
            "<path d=\"M{at:.1} 0V{bottom}\" stroke=\"{colour}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\" \
             fill=\"#555\">{milliseconds}{}</text>",
            bottom + 16.0,
            if milliseconds == 8 { " ms" } else { "" }
        );
    }
    for (row, trace) in traces.iter().enumerate() {
        let middle = ROW * (row as f64 + 0.5);
        let origin = trace.expected.or(trace.picked).unwrap_or(trace.samples.seconds + BEFORE);
        let colour = if trace.is_used { "#1f5fa8" } else { "#b0b0b0" };
        let path = envelope(trace.samples, origin, middle);
        let _ = writeln!(
            svg,
            "<text x=\"0\" y=\"{y:.1}\">{}</text><path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"1\" fill=\"none\"/>",
            escape(trace.name),
            y = middle + 4.0
        );
        let place = trace.picked.map(|picked| picked - origin).filter(|off| (-BEFORE..=AFTER).contains(off));
        if let Some(off) = place {
            let colour = if trace.is_used { "#c0392b" } else { "#e0a030" };
            let _ = writeln!(
                svg,
                "<path d=\"M{:.2} {:.1}v{:.1}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
                x(off),
                middle - 0.45 * ROW,
                0.9 * ROW
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            NAMES + WIDTH + 8.0,
            middle + 4.0,
            escape(&trace.label)
        );
    }
    svg + "</svg>\n"
}

/// The path of a waveform about this time, in a row with this middle: of each column the least and the largest sample.
fn envelope(samples: &ChannelSamples, origin: f64, middle: f64) -> String {
    let rate = f64::from(samples.sample_rate);
    let first = ((origin - BEFORE - samples.seconds) * rate).max(0.0) as usize;
    let end = ((origin + AFTER - samples.seconds) * rate).max(0.0) as usize;
    let part =
        samples.samples.get(first.min(samples.samples.len())..end.min(samples.samples.len())).unwrap_or_default();
    let largest = part.iter().filter(|sample| sample.is_finite()).fold(0.0f32, |most, sample| most.max(sample.abs()));
    // A silent channel is a line.
    let scale = if largest > 0.0 { 0.45 * ROW / f64::from(largest) } else { 0.0 };
    let mut columns = [None; COLUMNS];
    for (k, sample) in part.iter().enumerate().filter(|(_, sample)| sample.is_finite()) {
        let seconds = samples.seconds + (first + k) as f64 / rate - origin;
        let column = (COLUMNS as f64 * (seconds + BEFORE) / (BEFORE + AFTER)) as usize;
        let Some(range) = columns.get_mut(column) else { continue };
        let y = middle - scale * f64::from(*sample);
        let [least, most] = range.unwrap_or([y, y]);
        *range = Some([f64::min(least, y), f64::max(most, y)]);
    }
    let mut path = String::new();
    for (column, range) in columns.iter().enumerate() {
        let Some([least, most]) = range else { continue };
        let x = NAMES + WIDTH * (column as f64 + 0.5) / COLUMNS as f64;
        let _ = write!(path, "{}{x} {most:.1}", if path.is_empty() { "M" } else { "L" });
        if most - least > 0.1 {
            let _ = write!(path, "V{least:.1}");
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::{Trace, waveforms};
    use crate::events::ChannelSamples;

    #[test]
    fn channels_are_aligned_and_what_is_no_number_is_left_out() {
        // A sample of one among zeros, 21 us after 1.004 s.
        let mut samples = vec![0.0; 960];
        samples[193] = 1.0;
        samples[300] = f32::NAN;
        let channel = ChannelSamples { seconds: 1.0, sample_rate: 48_000, samples };
        let trace = Trace {
            name: "<one>",
            samples: &channel,
            picked: Some(1.0041),
            expected: Some(1.004),
            is_used: true,
            label: "+100 us & more".to_string(),
        };
        let silent = ChannelSamples { seconds: 0.0, sample_rate: 8000, samples: Vec::new() };
        let nothing = Trace {
            name: "none",
            samples: &silent,
            picked: None,
            expected: None,
            is_used: false,
            label: String::new(),
        };
        let svg = waveforms(&[trace, nothing]);
        assert!(svg.contains("&lt;one&gt;") && svg.contains("+100 us &amp; more") && !svg.contains("NaN"));
        // Zero is 2 of 10 ms from the left, at 150 + 104, and the sample is in the column of two units behind it.
        assert!(svg.contains("M254.0 0V68"), "{svg}");
        assert!(svg.contains("L255 1.7") || svg.contains("L255 17.0V1.7"), "{svg}");
        // The pick is 0.1 ms later.
        assert!(svg.contains("M259.20 1.7v30.6"), "{svg}");
    }
}
