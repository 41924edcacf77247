//! Simulated recordings: what is heard in them, and the network that follows.

use std::error::Error;
use std::path::{Path, PathBuf};

use super::calibration::distance_from;
use hc::Monitor;
use sound::{Heard, ListenOptions, Placement, Recorder, RoomOptions, RoomRecording, SampleFormat, Signal, Sound};
use sound::{listen, simulate_room, write_wav};
use tdoa::calibrate::{Calibrated, calibrate_either};
use tdoa::read::{Units, read_csv};
use tdoa::{CalibrateOptions, Network, ReceiverClocks};

/// Times that are further than this from the truth, but for what all channels have in common, are wrong, seconds.
const WRONG: f64 = 30e-6;

/// How far an event may be from the time of a sound to be this one, seconds.
const NEAR: f64 = 0.1;

/// A chirp: frequencies from and to, Hz, and seconds.
const CHIRP: [f64; 3] = [1000.0, 6000.0, 0.2];

/// Recorders that are started apart: the longest time, seconds, and the largest rate, parts in a million, each of which falls evenly
/// from one recorder to the next.
const APART: [f64; 2] = [60.0, 20.0];

/// A room, its sounds, and its recorders.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The name in tables.
    pub name: &'static str,
    /// Seconds in which echoes decay by 60 dB.
    reverberation: f64,
    /// dB.
    signal_to_noise: f64,
    /// Hz.
    sample_rate: u32,
    /// Seconds from one sound to the next.
    interval: f64,
    /// Whether sounds are chirps, which are known.
    are_chirps: bool,
    /// Whether recorders of two channels were started apart.
    are_apart: bool,
}

/// Ten microphones and claps every 1.5 s, at 48 kHz.
const USUAL: Case = Case {
    name: "0.4 s at 20 dB",
    reverberation: 0.4,
    signal_to_noise: 20.0,
    sample_rate: 48_000,
    interval: 1.5,
    are_chirps: false,
    are_apart: false,
};

/// All cases.
pub const CASES: [Case; 8] = [
    Case { name: "0.2 s at 20 dB", reverberation: 0.2, ..USUAL },
    USUAL,
    Case { name: "0.7 s at 20 dB", reverberation: 0.7, ..USUAL },
    Case { name: "0.4 s at 10 dB", signal_to_noise: 10.0, ..USUAL },
    Case { name: "0.4 s at 20 dB and 16 kHz", sample_rate: 16_000, ..USUAL },
    Case { name: "0.4 s at 20 dB with claps every 0.5 s", interval: 0.5, ..USUAL },
    Case { name: "0.4 s at -5 dB with chirps of 0.2 s", signal_to_noise: -5.0, are_chirps: true, ..USUAL },
    Case { name: "0.4 s at 20 dB with recorders of two started apart", are_apart: true, ..USUAL },
];

/// What was heard, and the network, beside the truth.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Sounds that were found.
    pub found: usize,
    /// Events that are none of the sounds.
    pub false_events: usize,
    /// Arrivals of sounds that were found.
    pub arrivals: usize,
    /// Those that are more than 30 us from the truth, but for what the channels have in common.
    pub wrong: usize,
    /// The median of these errors, seconds.
    pub median: f64,
    /// Root mean square distance of the receivers from the truth after the best rigid alignment, metres; `None` without a
    /// calibration in space of all of them.
    pub error: Option<f64>,
    /// Whether the network was called unique.
    pub unique: bool,
}

impl Case {
    /// Recordings of so many microphones and sounds, listened to and calibrated. Their files are in `folder` for a while.
    ///
    /// # Errors
    /// If a file cannot be written, or sizes are refused.
    pub fn outcome(
        self,
        microphones: usize,
        sounds: usize,
        seed: u64,
        folder: &Path,
    ) -> Result<Outcome, Box<dyn Error>> {
        let made = simulate_room(&self.room(microphones, sounds, seed))?;
        let mut recorders: Vec<Vec<PathBuf>> = Vec::new();
        for (k, channels) in made.recorders.iter().enumerate() {
            let path = folder.join(format!("rec{}.wav", k + 1));
            write_wav(&path, made.sample_rate, &made.channels[channels.clone()], SampleFormat::Int24)?;
            recorders.push(vec![path]);
        }
        let [from, to, seconds] = CHIRP;
        let signal = if self.are_chirps { Signal::Chirp { from, to, seconds } } else { Signal::Unknown };
        let heard = listen(&recorders, &ListenOptions::of(signal))?;
        let (sound_of_event, mut errors) = errors(&heard, &made);
        errors.sort_by(f64::total_cmp);
        let (error, unique) = self.network(&heard, &made, seed)?;
        Ok(Outcome {
            found: sound_of_event.iter().flatten().count(),
            false_events: sound_of_event.iter().filter(|sound| sound.is_none()).count(),
            arrivals: errors.len(),
            wrong: errors.iter().filter(|error| **error > WRONG).count(),
            median: errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN),
            error,
            unique,
        })
    }

    fn room(self, microphones: usize, sounds: usize, seed: u64) -> RoomOptions {
        let mut room = RoomOptions::default();
        (room.microphones, room.sources) = (Placement::Random(microphones), Placement::Random(sounds));
        (room.reverberation, room.signal_to_noise) = (self.reverberation, Some(self.signal_to_noise));
        (room.sample_rate, room.interval, room.seed) = (self.sample_rate, self.interval, seed);
        if self.are_chirps {
            let [from, to, length] = CHIRP;
            room.sound = Sound::Chirp { from, to, length };
        }
        if self.are_apart {
            let count = microphones.div_ceil(2);
            let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
            let recorder = |k: usize| Recorder {
                channels: 2.min(microphones - 2 * k),
                start: -APART[0] * share(k),
                rate: APART[1] * (2.0 * share(k) - 1.0),
            };
            room.recorders = (0..count).map(recorder).collect();
            room.duration =
                Some(APART[0] + 1.0 + sounds as f64 * (self.interval + room.jitter) + self.reverberation + 1.0);
        }
        room
    }

    /// How far the receivers are from the truth, metres, and whether the network is called unique.
    fn network(self, heard: &Heard, made: &RoomRecording, seed: u64) -> Result<(Option<f64>, bool), Box<dyn Error>> {
        if heard.arrivals.is_empty() {
            return Ok((None, false));
        }
        let units = Units::Seconds { speed: RoomOptions::default().speed };
        let measured = read_csv(heard.list().as_bytes(), "what was heard", units)?;
        let mut options = CalibrateOptions::<3>::new();
        options.seed = seed;
        if self.are_apart {
            options.clocks.receivers = ReceiverClocks::Rate;
        }
        let Ok(found) = calibrate_either(&measured, &options, &Monitor::default()) else { return Ok((None, false)) };
        let Calibrated::Space(found) = found else {
            return Ok((None, matches!(found, Calibrated::Plane(flat) if flat.unique)));
        };
        // Channels in the order of the truth.
        let names = heard.names();
        let place = |name: &String| found.receiver_names.iter().position(|found| found == name);
        let receivers: Vec<Option<[f64; 3]>> =
            names.iter().map(|name| place(name).and_then(|place| found.receivers[place])).collect();
        let truth = &made.truth;
        let truth = Network::new(truth.microphones.clone(), truth.sources.clone(), truth.times.clone());
        Ok((distance_from(&receivers, &truth), found.unique))
    }
}

/// The sound that each event is, if it is one, and how far its arrivals are from the truth, but for what they have in common,
/// seconds.
fn errors(heard: &Heard, made: &RoomRecording) -> (Vec<Option<usize>>, Vec<f64>) {
    let mut errors = Vec::new();
    let mut taken = vec![false; made.truth.times.len()];
    let sounds = heard.arrivals.iter().map(|arrivals| {
        let late = |sound: usize| -> Vec<f64> {
            let late =
                |(found, truth): (&Option<sound::Arrival>, &Vec<f64>)| Some(found.as_ref()?.seconds - truth[sound]);
            arrivals.iter().zip(&made.truth.arrivals).filter_map(late).collect()
        };
        let middle = |mut all: Vec<f64>| {
            all.sort_by(f64::total_cmp);
            all.get(all.len() / 2).copied().unwrap_or(f64::INFINITY)
        };
        let nearest = (0..taken.len()).map(|sound| (middle(late(sound)), sound));
        let (off, sound) = nearest.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
        if off.abs() > NEAR || std::mem::replace(&mut taken[sound], true) {
            return None;
        }
        errors.extend(late(sound).into_iter().map(|late| (late - off).abs()));
        Some(sound)
    });
    let sounds = sounds.collect();
    (sounds, errors)
}

#[cfg(test)]
mod tests {
    use super::CASES;

    /// What recordings must give: all claps heard to microseconds, and receivers to millimetres.
    #[test]
    fn a_room_is_heard_and_calibrated() {
        let folder = tempfile::tempdir().unwrap();
        let case = CASES.iter().find(|case| case.name == "0.4 s at 20 dB").unwrap();
        let found = case.outcome(8, 16, 1, folder.path()).unwrap();
        assert_eq!((found.found, found.false_events, found.arrivals), (16, 0, 128), "{found:?}");
        assert!(found.wrong <= 2 && found.median < 2e-6, "{found:?}");
        assert!(found.unique && found.error.unwrap() < 3e-3, "{found:?}");
    }
}
