//! `tdoa simulate --sound`: recordings of a room, with the truth.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use sound::{Placement, Recorder, RoomOptions, SampleFormat, Sound, simulate_room, write_wav};

use super::arguments::Arguments;
use super::layout::sides;
use super::tables::positions;
use crate::{Failure, output};

/// Seconds that the first recorder runs before the first sound, and others at least.
const LEAD: f64 = 1.0;

/// Names of the files of positions.
const POSITIONS: [&str; 2] = ["receivers.csv", "transmitters.csv"];

/// Makes the recordings and the files of positions.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = room(arguments)?;
    let made = crate::on_threads(arguments.threads, || simulate_room(&options))?.map_err(Failure::unusable)?;
    let directory = &arguments.output;
    let are_apart = !options.recorders.is_empty();
    let name = |recorder: usize| if are_apart { format!("rec{}", recorder + 1) } else { "recording".to_string() };
    let files: Vec<String> = (0..made.recorders.len()).map(|recorder| format!("{}.wav", name(recorder))).collect();
    let all: Vec<&str> = files.iter().map(String::as_str).chain(POSITIONS).collect();
    cli::files::check_directory(directory, &all, arguments.force)?;
    std::fs::create_dir_all(directory).map_err(|error| {
        Failure::Unusable(format!("{}: cannot be made ({error}); choose another --output", directory.display()))
    })?;
    let mut names = Vec::new();
    for (recorder, (channels, file)) in made.recorders.iter().zip(&files).enumerate() {
        names.extend((1..=channels.len()).map(|channel| format!("{}:{channel}", name(recorder))));
        let path = directory.join(file);
        write_wav(&path, made.sample_rate, &made.channels[channels.clone()], SampleFormat::Int24)
            .map_err(Failure::unusable)?;
        eprintln!("wrote {}", path.display());
    }
    // Events are found in the order of time, and sources sound in theirs.
    let events: Vec<String> = (1..=made.truth.sources.len()).map(|event| event.to_string()).collect();
    let tables = [positions(&names, &made.truth.microphones), positions(&events, &made.truth.sources)];
    for (name, text) in POSITIONS.iter().zip(tables) {
        output::file(&directory.join(name), text.as_bytes())?;
    }
    output::print(&format!(
        "{} channels of {:.1} s, {} sounds, written to {}\n",
        names.len(),
        made.channels.first().map_or(0, Vec::len) as f64 / f64::from(made.sample_rate),
        events.len(),
        directory.display()
    ))
}

/// The room, its sounds and its recorders.
fn room(arguments: &Arguments) -> Result<RoomOptions, Failure> {
    let sound = &arguments.sound;
    let mut options = RoomOptions::default();
    if let Some(text) = &arguments.layout {
        options.extent = sides(text).and_then(|sides| sides.try_into().ok()).ok_or_else(|| {
            Failure::Unusable(format!("--layout must be LENGTHxWIDTHxHEIGHT in metres with --sound, not {text:?}"))
        })?;
    }
    (options.microphones, options.sources) =
        (Placement::Random(arguments.receivers), Placement::Random(arguments.transmitters));
    options.speed = arguments.units.speed().unwrap_or(options.speed);
    (options.reverberation, options.signal_to_noise) = (sound.reverberation, Some(sound.signal_to_noise));
    (options.sample_rate, options.seed) = (sound.sample_rate, arguments.seed);
    match sound.chirp[..] {
        [] => {}
        [from, to, length] => options.sound = Sound::Chirp { from, to, length },
        ref other => {
            let problem = format!("--chirp needs three numbers, FROM,TO,SECONDS, not {}", other.len());
            return Err(Failure::Unusable(problem));
        }
    }
    if arguments.delays != 0.0 || arguments.rate_sigma != 0.0 {
        recorders(arguments, &mut options)?;
    }
    Ok(options)
}

/// Gives each recorder some channels, a start and a rate of its own. All run before the first sound and to the end.
fn recorders(arguments: &Arguments, options: &mut RoomOptions) -> Result<(), Failure> {
    if arguments.channels == 0 {
        return Err(Failure::unusable("--channels must be 1 or more"));
    }
    let mut rng = Pcg64Mcg::seed_from_u64(arguments.seed ^ 0x5eed);
    let mut draw = |deviation: f64| -> f64 { deviation * rng.sample::<f64, _>(StandardNormal) };
    let counts = (0..arguments.receivers).step_by(arguments.channels);
    let mut all: Vec<Recorder> = counts
        .map(|first| Recorder {
            channels: arguments.channels.min(arguments.receivers - first),
            start: draw(arguments.delays / options.speed),
            rate: draw(arguments.rate_sigma),
        })
        .collect();
    let last = all.iter().map(|recorder| recorder.start).fold(f64::NEG_INFINITY, f64::max);
    let first = all.iter().map(|recorder| recorder.start).fold(f64::INFINITY, f64::min);
    // The last one is started before the first sound, and the first one runs on until the end.
    all.iter_mut().for_each(|recorder| recorder.start -= last);
    options.first = LEAD;
    let sounds = arguments.transmitters as f64 * (options.interval + options.jitter);
    options.duration = Some((last - first).max(0.0) + LEAD + sounds + options.reverberation + 1.0);
    options.recorders = all;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn parsed(words: &str) -> Arguments {
        let words = ["simulate", "--sound", "--output", "x"].into_iter().chain(words.split_whitespace());
        Program::try_parse_from(words).unwrap_or_else(|error| panic!("{error}")).arguments
    }

    #[test]
    fn recorders_run_from_before_the_first_sound_to_after_the_last() {
        let arguments = parsed("--receivers 7 --channels 2 --delays 5000 --rate-sigma 20 --transmitters 5");
        assert_eq!(arguments.output, PathBuf::from("x"));
        let options = room(&arguments).unwrap();
        assert_eq!(options.recorders.iter().map(|recorder| recorder.channels).collect::<Vec<_>>(), [2, 2, 2, 1]);
        assert!(options.recorders.iter().all(|recorder| recorder.start <= 0.0 && recorder.rate != 0.0));
        let first = options.recorders.iter().map(|recorder| recorder.start).fold(0.0, f64::min);
        let latest = options.first + 5.0 * (options.interval + options.jitter);
        assert!(first + options.duration.unwrap() > latest && first < -1.0);
        assert!(room(&parsed("--layout 3x4")).is_err() && room(&parsed("--chirp 1,2")).is_err());
        assert!(room(&parsed("--delays 1 --channels 0")).is_err());
    }
}
