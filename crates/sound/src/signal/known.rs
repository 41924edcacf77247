//! What is known of sounds.

use super::error::SignalError;

/// Longest signal, seconds: windows that hold it are in memory.
pub(super) const LONGEST: f64 = 10.0;

/// What is known of the sounds that are looked for. Of a signal, its sign is known too: where a channel has it the other way
/// round, times are off by half of a period.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub enum Signal {
    /// That they begin suddenly, as claps do.
    #[default]
    Unknown,
    /// They are a tone that rises or falls evenly, as that of [`Sound::Chirp`](crate::Sound::Chirp).
    Chirp {
        /// Frequency at its beginning, Hz: 1 to 10^6.
        from: f64,
        /// Frequency at its end, Hz: 1 to 10^6.
        to: f64,
        /// Its length, seconds: 0.0001 to 10.
        seconds: f64,
    },
    /// They are what these samples are, but for their strength. A signal begins with the first sample.
    Template {
        /// Samples, of at most 10 s. One of them is not zero.
        samples: Vec<f32>,
        /// Samples per second, Hz: 100 to 10^7.
        sample_rate: f64,
    },
}

impl Signal {
    /// How long it lasts, seconds; 0 if it is not known.
    pub fn seconds(&self) -> f64 {
        match self {
            Signal::Unknown => 0.0,
            Signal::Chirp { seconds, .. } => *seconds,
            Signal::Template { samples, sample_rate } => samples.len() as f64 / sample_rate,
        }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first one that is out of range.
    pub fn validate(&self) -> Result<(), SignalError> {
        let within = |name, range, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) { Ok(()) } else { Err(SignalError::Range { name, range, value }) }
        };
        match self {
            Signal::Unknown => return Ok(()),
            Signal::Chirp { from, to, .. } => {
                within("the frequency at the beginning of a chirp", "1 to 1e6 Hz", *from, 1.0, 1e6)?;
                within("the frequency at the end of a chirp", "1 to 1e6 Hz", *to, 1.0, 1e6)?;
            }
            Signal::Template { samples, sample_rate } => {
                within("the sample rate of a template", "100 to 1e7 Hz", *sample_rate, 100.0, 1e7)?;
                if let Some(sample) = samples.iter().find(|sample| !sample.is_finite()) {
                    let (name, range) = ("a sample of a template", "finite");
                    return Err(SignalError::Range { name, range, value: f64::from(*sample) });
                }
                if samples.iter().all(|sample| *sample == 0.0) {
                    return Err(SignalError::Silent);
                }
            }
        }
        let seconds = self.seconds();
        if seconds > LONGEST {
            return Err(SignalError::TooLong { seconds, most: LONGEST });
        }
        within("the length of a signal", "0.0001 to 10 s", seconds, 1e-4, LONGEST)
    }
}
