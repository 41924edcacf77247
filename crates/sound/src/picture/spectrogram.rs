//! A strip that shows a whole recording, by time and frequency.

use std::fmt::Write;
use std::path::Path;

use realfft::RealFftPlanner;

use super::bitmap::{Palette, address};
use crate::error::ReadError;
use crate::quantile::quantile;
use crate::recording::Recording;

/// Samples of a spectrum; half as many frequencies.
const LENGTH: usize = 512;

/// Pixels: columns at most, and rows.
const COLUMNS: usize = 900;
const ROWS: usize = 64;

/// Levels are dark that are so much below the loudest, or below the middle one, which is mostly noise, dB.
const RANGE: f64 = 70.0;
const NOISE: f64 = -5.0;

/// Colours from quiet to loud, between which others lie: dark blue, violet, orange, light yellow.
const COLOURS: [[f64; 3]; 4] = [[10.0, 12.0, 50.0], [120.0, 30.0, 120.0], [240.0, 130.0, 50.0], [255.0, 250.0, 190.0]];

/// The first channel of a recording by time and frequency, as SVG, with a mark below for each of these `times`, seconds from its
/// first sample. Each point shows the loudest of what it stands for, so that claps are seen in long recordings.
///
/// # Errors
/// If the file cannot be read.
///
/// ```
/// # let folder = std::env::temp_dir().join(format!("sound-spectrogram-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("tone.wav");
/// let tone: Vec<f32> = (0..48_000).map(|k| (0.3 * k as f32).sin()).collect();
/// sound::write_wav(&path, 48_000, &[tone], sound::SampleFormat::Int16)?;
/// assert!(sound::spectrogram(&path, &[0.5])?.starts_with("<svg"));
/// # std::fs::remove_dir_all(folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn spectrogram(path: impl AsRef<Path>, times: &[f64]) -> Result<String, ReadError> {
    let mut recording = Recording::open(path)?;
    let rate = f64::from(recording.sample_rate());
    let (levels, samples) = levels(&mut recording)?;
    let seconds = samples as f64 / rate;
    let image = image(&levels);
    let (width, height) = (COLUMNS as f64, ROWS as f64 * 1.5);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {}\" font-family=\"sans-serif\" font-size=\"12\" \
         class=\"spectrogram\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<image width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         href=\"{image}\"/>\n",
        height + 26.0
    );
    // Writing to a string does not fail.
    for time in times.iter().filter(|time| (0.0..seconds).contains(*time)) {
        let x = width * time / seconds;
        let _ = writeln!(svg, "<path d=\"M{x:.1} {height}v8\" stroke=\"#c0392b\" stroke-width=\"1.5\"/>");
    }
    let _ = writeln!(
        svg,
        "<text x=\"0\" y=\"{y}\" fill=\"#555\">0 s</text><text x=\"{width}\" y=\"{y}\" text-anchor=\"end\" fill=\"#555\">{seconds:.1} s, 0 to \
         {:.1} kHz</text>\n</svg>",
        rate / 2000.0,
        y = height + 22.0
    );
    Ok(svg)
}

/// Of each column the level in each row from low frequencies to high, dB; and the number of samples. Columns are as many as spectra
/// while these are few; then two and two become one, so that no length needs to be known before.
fn levels(recording: &mut Recording) -> Result<(Vec<[f64; ROWS]>, u64), ReadError> {
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(LENGTH);
    let window: Vec<f64> =
        (0..LENGTH).map(|k| 0.5 - 0.5 * (std::f64::consts::TAU * (k as f64 + 0.5) / LENGTH as f64).cos()).collect();
    let (mut input, mut spectrum, mut scratch) =
        (transform.make_input_vec(), transform.make_output_vec(), transform.make_scratch_vec());
    let (mut columns, mut merged, mut current, mut count): (Vec<[f64; ROWS]>, usize, [f64; ROWS], usize) =
        (Vec::new(), 1, [0.0; ROWS], 0);
    let (mut block, mut samples) = (Vec::new(), 0);
    loop {
        let read = recording.read_block(LENGTH, &mut block)?;
        samples += read as u64;
        if read < LENGTH {
            break;
        }
        for ((value, sample), weight) in input.iter_mut().zip(&block[0]).zip(&window) {
            *value = if sample.is_finite() { f64::from(*sample) * weight } else { 0.0 };
        }
        if transform.process_with_scratch(&mut input, &mut spectrum, &mut scratch).is_err() {
            break;
        }
        for (k, value) in spectrum.iter().enumerate().skip(1) {
            let row = &mut current[(k - 1) * ROWS / (LENGTH / 2)];
            *row = f64::max(*row, value.norm_sqr());
        }
        count += 1;
        if count == merged {
            columns.push(current);
            (current, count) = ([0.0; ROWS], 0);
        }
        if columns.len() == 2 * COLUMNS {
            columns = columns.chunks(2).map(|pair| std::array::from_fn(|k| f64::max(pair[0][k], pair[1][k]))).collect();
            merged *= 2;
        }
    }
    let loud = |power: f64| 10.0 * power.max(1e-300).log10();
    columns.iter_mut().flatten().for_each(|level| *level = loud(*level));
    Ok((columns, samples))
}

/// An image of levels, with time to the right and high frequencies above.
fn image(columns: &[[f64; ROWS]]) -> String {
    let loudest = columns.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = quantile(columns.iter().flatten().copied().collect(), 0.5).unwrap_or(f64::NEG_INFINITY);
    // A tone has nothing but its own level.
    let dark = (loudest - RANGE).max(middle + NOISE).min(loudest - 1.0);
    // What is no number becomes zero.
    let number = |level: f64| (255.0 * ((level - dark) / (loudest - dark)).clamp(0.0, 1.0)) as u8;
    let rows: Vec<Vec<u8>> = (0..ROWS).map(|row| columns.iter().map(|column| number(column[row])).collect()).collect();
    address(&rows, &palette())
}

/// Colours from quiet to loud.
fn palette() -> Palette {
    std::array::from_fn(|number| {
        let share = number as f64 / 255.0 * (COLOURS.len() - 1) as f64;
        let below = (share as usize).min(COLOURS.len() - 2);
        let between = share - below as f64;
        std::array::from_fn(|k| (COLOURS[below][k] + between * (COLOURS[below + 1][k] - COLOURS[below][k])) as u8)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SampleFormat, write_wav};

    /// Levels are where the tones are, in recordings of any length.
    #[test]
    fn tones_are_at_their_times_and_frequencies() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tones.wav");
        // The first half is a tone of 3 kHz of 24, the second of 15.
        for seconds in [1, 60] {
            let count = seconds * 48_000;
            let tone = |k: usize| {
                let frequency = if 2 * k < count { 3e3 } else { 15e3 };
                (std::f64::consts::TAU * frequency * k as f64 / 48e3).sin() as f32
            };
            write_wav(&path, 48_000, &[(0..count).map(tone).collect::<Vec<f32>>()], SampleFormat::Int16).unwrap();
            let (columns, samples) = levels(&mut Recording::open(&path).unwrap()).unwrap();
            assert!(samples == count as u64 && columns.len() <= 2 * COLUMNS);
            let loudest = |column: &[f64; ROWS]| (0..ROWS).max_by(|a, b| column[*a].total_cmp(&column[*b])).unwrap();
            let (early, late) = (loudest(&columns[columns.len() / 4]), loudest(&columns[3 * columns.len() / 4]));
            // Frequencies at the border of two rows may be in either.
            assert!(early.abs_diff(ROWS / 8) <= 1 && late.abs_diff(ROWS * 5 / 8) <= 1, "{early} {late}");
        }
        let svg = spectrogram(&path, &[30.0, f64::NAN, 1e9]).unwrap();
        assert!(svg.contains("M450.0 96v8") && svg.matches("v8").count() == 1 && svg.contains("60.0 s, 0 to 24.0 kHz"));
    }

    #[test]
    fn a_recording_may_be_silent_or_short() {
        let folder = tempfile::tempdir().unwrap();
        for length in [0, 1, 511, 2000] {
            let path = folder.path().join("silent.wav");
            write_wav(&path, 8000, &[vec![0.0; length]], SampleFormat::Int16).unwrap();
            let svg = spectrogram(&path, &[0.0]).unwrap();
            let drawn = svg.split("/>").skip(1).collect::<String>();
            assert!(svg.ends_with("</svg>\n") && !drawn.contains("NaN") && !drawn.contains("inf"), "{length}: {drawn}");
        }
    }
}
