//! What is looked for.

use super::error::EventError;
use crate::signal::Signal;

/// Longest time that sound may take from one microphone to another, seconds: windows are held in memory.
const MAX_SPREAD: f64 = 10.0;

/// Least dead time unless one is given, seconds.
const DEAD_TIME: f64 = 0.15;

/// Options of [`find_events`](crate::find_events).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EventOptions {
    /// What is known of the sounds. Those of a signal are found in the compressed recording, in which it is a pulse where it
    /// begins, although noise may hide it. Default [`Signal::Unknown`].
    pub signal: Signal,
    /// The frequencies in which sounds are looked for, from and to, Hz: 1 to 10^6 each, at least 100 Hz apart. Of each file
    /// only those up to 0.45 of its sample rate are used. Default 500 to 10,000.
    pub band: [f64; 2],
    /// Over which time the noise floor is taken, seconds: 0.5 to 600. Noise that changes more slowly is followed, sounds that
    /// last for more than three quarters of this time become noise. Default 10.
    pub floor_seconds: f64,
    /// How many times as strong as the noise floor a sound must become, in amplitude: 1.5 to 10^6. Default 4, which is 12 dB.
    /// Of 240 simulated claps 10 dB above even noise, 4 misses 1, and 6 misses 67. Beside speech or music, each syllable and
    /// note may be an event: 6 finds half as many of these.
    pub threshold: f64,
    /// How much weaker than the strongest sound of the event in the same channel the direct sound may be, dB: 0 to 100. The
    /// first onset that is not weaker counts; those before it are taken to be none. Default 15.
    pub weakest_first_db: f64,
    /// Greatest distance of two microphones, metres: 0.01 to 10^5. Default 30.
    pub extent: f64,
    /// Speed of sound, metres per second: 1 to 10^5. Sound must take at most 10 s over the extent. Default 343.
    pub speed: f64,
    /// For how long after its first onset of an event a channel hears nothing but echoes of it, seconds: at least the time
    /// that sound takes over the extent, at most 100. Default `None`: that time, but at least 0.15.
    pub dead_time: Option<f64>,
    /// How many channels must hear an event: 1 or more. Default 4.
    pub least_channels: usize,
}

impl Default for EventOptions {
    fn default() -> EventOptions {
        EventOptions {
            signal: Signal::Unknown,
            band: [500.0, 10_000.0],
            floor_seconds: 10.0,
            threshold: 4.0,
            weakest_first_db: 15.0,
            extent: 30.0,
            speed: 343.0,
            dead_time: None,
            least_channels: 4,
        }
    }
}

impl EventOptions {
    /// Checks the options.
    ///
    /// # Errors
    /// For the first one that is out of its range, or does not fit the others.
    pub fn validate(&self) -> Result<(), EventError> {
        let within = |name, range, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) { Ok(()) } else { Err(EventError::Range { name, range, value }) }
        };
        let [lower, upper] = self.band;
        within("the beginning of the band", "1 to 1e6 Hz", lower, 1.0, 1e6)?;
        within("the end of the band", "1 to 1e6 Hz", upper, 1.0, 1e6)?;
        let width = EventOptions::LEAST_WIDTH;
        self.signal.validate()?;
        within("the width of the band", "100 Hz or more, with its end above its beginning", upper - lower, width, 1e6)?;
        within("the time of the noise floor", "0.5 to 600 s", self.floor_seconds, 0.5, 600.0)?;
        within("the threshold", "1.5 to 1e6", self.threshold, 1.5, 1e6)?;
        within("the weakness of the first onset", "0 to 100 dB", self.weakest_first_db, 0.0, 100.0)?;
        within("the extent", "0.01 to 1e5 m", self.extent, 0.01, 1e5)?;
        within("the speed of sound", "1 to 1e5 m/s", self.speed, 1.0, 1e5)?;
        let (extent, spread) = (self.extent, self.spread());
        if spread > MAX_SPREAD {
            return Err(EventError::Spread { extent, seconds: spread, most: MAX_SPREAD });
        }
        within("the dead time", "0 to 100 s", self.dead_time(), 0.0, 100.0)?;
        if self.dead_time() < spread {
            return Err(EventError::DeadTime { dead_time: self.dead_time(), spread });
        }
        within("the least number of channels", "1 or more", self.least_channels as f64, 1.0, f64::MAX)
    }

    /// Least width of the band, Hz.
    pub(super) const LEAST_WIDTH: f64 = 100.0;

    /// How long sound takes over the extent, seconds.
    pub(crate) fn spread(&self) -> f64 {
        self.extent / self.speed
    }

    /// For how long after its first onset of an event a channel hears nothing but echoes, seconds.
    pub(crate) fn dead_time(&self) -> f64 {
        self.dead_time.unwrap_or(self.spread().max(DEAD_TIME))
    }
}
