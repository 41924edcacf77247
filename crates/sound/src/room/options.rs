//! What is simulated.

/// Where microphones or sources are.
#[derive(Debug, Clone, PartialEq)]
pub enum Placement {
    /// This many, uniform in the room but for the distances that [`RoomOptions`] wants.
    Random(usize),
    /// At these points, metres from the corner of the room.
    Given(Vec<[f64; 3]>),
}

impl Placement {
    pub(super) fn count(&self) -> usize {
        match self {
            Placement::Random(count) => *count,
            Placement::Given(points) => points.len(),
        }
    }
}

/// By which formula a reverberation time says how much walls absorb.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Decay {
    /// C. F. Eyring, 1930: right for any absorption.
    Eyring,
    /// W. C. Sabine, 1900: for little absorption. Walls cannot absorb enough for very short times.
    Sabine,
}

/// A sound, the same in all directions, which begins at its time of emission.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Sound {
    /// White noise that begins at once and decays, as of hands that clap; another noise each time.
    Clap {
        /// Length, seconds: more than 0, at most 10.
        length: f64,
        /// Time in which its amplitude falls by a factor of e, seconds: more than 0.
        decay: f64,
    },
    /// A tone that rises or falls evenly. It fades in and out over a twentieth of its length each.
    Chirp {
        /// Frequency at its beginning, Hz: more than 0, at most half of the sample rate.
        from: f64,
        /// Frequency at its end, Hz: more than 0, at most half of the sample rate.
        to: f64,
        /// Length, seconds: more than 0, at most 60.
        length: f64,
    },
}

/// A recorder: some microphones with one clock. Its clock reads (1 + rate / 10^6) (t - start) at time t, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recorder {
    /// Number of its microphones.
    pub channels: usize,
    /// When its recording begins, seconds: up to 10^6 of either sign.
    pub start: f64,
    /// How much its clock is fast, parts per million: up to 10^4 of either sign.
    pub rate: f64,
}

/// Something in the direct way of all sounds to a microphone, as a pillar or a person beside it: echoes pass it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// Number of the microphone, from 0.
    pub microphone: usize,
    /// How much weaker it makes the direct sound, dB: 0 to 200. The sound is as late as without it.
    pub attenuation_db: f64,
}

/// Options of [`simulate_room`](crate::simulate_room).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RoomOptions {
    /// Length, width and height of the room, metres: 0.1 to 1000 each. Default 8, 6 and 3.
    pub extent: [f64; 3],
    /// Time in which sound decays by 60 dB, seconds: 0 to 30, where 0 is a room without echoes. Default 0.4.
    pub reverberation: f64,
    /// What that time says of the walls, which are all the same. Default [`Decay::Eyring`].
    pub decay: Decay,
    /// Speed of sound, metres per second: 1 to 10^5. Default 343.
    pub speed: f64,
    /// Samples per second, Hz: 100 to 10^6. Default 48000.
    pub sample_rate: u32,
    /// Most reflections of an echo. Default `None`: any number.
    pub max_order: Option<u32>,
    /// How long after the direct sound echoes may arrive, seconds: 0 to 30. Default `None`: the reverberation time.
    pub echo_time: Option<f64>,
    /// Power of the sounds over that of the noise, dB: -200 to 200. White noise, equally loud everywhere, is in all
    /// microphones; the power is the mean of what comes on the direct way to all of them while it lasts. Default
    /// `Some(30.0)`; `None` for no noise.
    pub signal_to_noise: Option<f64>,
    /// The kind of sound. Default: claps of 8 ms that decay by a factor of e in 1.5 ms.
    pub sound: Sound,
    /// Microphones, 1 to 1000. Default 8 at random.
    pub microphones: Placement,
    /// Sources, 1 to 10,000, each of which sounds once. Default 12 at random.
    pub sources: Placement,
    /// Least distance of random points from walls, metres. Default 0.3.
    pub wall_distance: f64,
    /// Least distance of random points from each other and from given ones, metres: 0.01 or more. Default 0.3.
    pub separation: f64,
    /// Times of emission, seconds, one a source: up to 10^6 of either sign. Default `None`: as the next options say.
    pub times: Option<Vec<f64>>,
    /// Time of the first emission, seconds: up to 10^6 of either sign. Default 1.
    pub first: f64,
    /// Time from one emission to the next, seconds: 0 to 10^4. Default 1.5.
    pub interval: f64,
    /// Emissions are late by times that are uniform up to this, seconds: 0 to 10^4. Default 0.3.
    pub jitter: f64,
    /// Length of the recordings, seconds: more than 0. Default `None`: a second more than the last sound and its echoes
    /// take.
    pub duration: Option<f64>,
    /// The recorders: the first has the first microphones, and so on. Default none: one with all microphones, whose
    /// clock is right.
    pub recorders: Vec<Recorder>,
    /// What is in the way of sounds. Default: nothing. Of several before one microphone, attenuations add up.
    pub obstacles: Vec<Obstacle>,
    /// Greatest amount of a sample without noise: all microphones have one gain that makes it so; more than 0, at most 1.
    /// Default 0.5.
    pub peak: f64,
    /// Seed of the random numbers. Default 0.
    pub seed: u64,
}

impl Default for RoomOptions {
    fn default() -> RoomOptions {
        RoomOptions {
            extent: [8.0, 6.0, 3.0],
            reverberation: 0.4,
            decay: Decay::Eyring,
            speed: 343.0,
            sample_rate: 48000,
            max_order: None,
            echo_time: None,
            signal_to_noise: Some(30.0),
            sound: Sound::Clap { length: 0.008, decay: 0.0015 },
            microphones: Placement::Random(8),
            sources: Placement::Random(12),
            wall_distance: 0.3,
            separation: 0.3,
            times: None,
            first: 1.0,
            interval: 1.5,
            jitter: 0.3,
            duration: None,
            recorders: Vec::new(),
            obstacles: Vec::new(),
            peak: 0.5,
            seed: 0,
        }
    }
}

impl RoomOptions {
    /// How long after the direct sound echoes may arrive, seconds.
    pub(super) fn echo_time(&self) -> f64 {
        self.echo_time.unwrap_or(self.reverberation)
    }

    /// Length of a sound, seconds.
    pub(super) fn sound_length(&self) -> f64 {
        match self.sound {
            Sound::Clap { length, .. } | Sound::Chirp { length, .. } => length,
        }
    }

    /// By which factor the direct sound is weaker at this microphone, from 0.
    pub(super) fn passed(&self, microphone: usize) -> f64 {
        let before = self.obstacles.iter().filter(|obstacle| obstacle.microphone == microphone);
        before.map(|obstacle| 10.0_f64.powf(-obstacle.attenuation_db / 20.0)).product()
    }

    /// The recorders, at least one.
    pub(super) fn all_recorders(&self) -> Vec<Recorder> {
        if self.recorders.is_empty() {
            vec![Recorder { channels: self.microphones.count(), start: 0.0, rate: 0.0 }]
        } else {
            self.recorders.clone()
        }
    }
}
