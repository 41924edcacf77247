//! What measurements say of clocks: times of sending, and recorders.

#[cfg(feature = "csv")]
use super::origin::TimeOrigin;
use super::{MAX_MAGNITUDE, PseudorangeError, Pseudoranges, check_count};
use crate::clocks::{Emissions, Recorders};
use std::collections::HashMap;

impl Pseudoranges {
    /// This matrix as one of transmitters of whose times of sending this is known.
    pub(crate) fn with_emissions(self, emissions: Emissions) -> Pseudoranges {
        Pseudoranges { emissions, ..self }
    }

    /// What is known of the times at which transmitters send.
    pub(crate) fn emissions(&self) -> Emissions {
        self.emissions
    }

    /// This matrix with the times at which transmitters send, metres: seconds times the propagation speed, by any clock that
    /// they share. They count where [emissions](Emissions) are known, or known but for what the clock of the receivers adds:
    /// a constant, and a rate by which that clock and the transmitters' run apart.
    ///
    /// # Errors
    /// If there are not as many times as transmitters, or one is infinite, NaN or above [`MAX_MAGNITUDE`].
    pub fn with_emission_times(self, times: Vec<f64>) -> Result<Self, PseudorangeError> {
        check_count("emission times", "transmitter", self.transmitters(), times.len())?;
        if let Some((j, value)) = times.iter().enumerate().find(|(_, time)| time.is_nan() || time.abs() > MAX_MAGNITUDE)
        {
            let transmitter = self.transmitter_names[j].clone();
            return Err(PseudorangeError::EmissionTime { transmitter, value: *value });
        }
        Ok(Pseudoranges { emission_times: Some(times), ..self })
    }

    /// When each transmitter sends, metres, if that was given.
    pub fn emission_times(&self) -> Option<&[f64]> {
        self.emission_times.as_deref()
    }

    /// When a transmitter sends, metres; 0 where nothing was given.
    pub(crate) fn emission_time(&self, transmitter: usize) -> f64 {
        self.emission_times.as_ref().map_or(0.0, |times| times[transmitter])
    }

    /// Whether the values are distances, but for what all share: no transmitter has an offset of its own.
    pub(crate) fn are_ranges(&self) -> bool {
        self.emissions != Emissions::Unknown
    }

    /// This matrix with the recorder of each receiver, by name: receivers of one recorder share a clock where recorders have
    /// [clocks of their own](crate::ReceiverClocks). Without, [names](Self::recorder_name) tell.
    ///
    /// # Errors
    /// If there are not as many names as receivers.
    pub fn with_recorders(self, recorders: Vec<String>) -> Result<Self, PseudorangeError> {
        check_count("recorders", "receiver", self.receivers(), recorders.len())?;
        Ok(Pseudoranges { recorders: Some(recorders), ..self })
    }

    /// Name of a receiver's recorder. Where no recorders were given, channels of one have its name before a colon and a
    /// number, such as `rec1:2`, and other receivers are a recorder each, with their own name.
    pub fn recorder_name(&self, receiver: usize) -> &str {
        if let Some(recorders) = &self.recorders {
            return &recorders[receiver];
        }
        let name = &self.receiver_names[receiver];
        let is_channel = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
        name.rsplit_once(':').filter(|(_, channel)| is_channel(channel)).map_or(name, |(recorder, _)| recorder)
    }

    /// The recorder of each receiver, counted from 0 in the order of the receivers.
    pub fn recorders(&self) -> Vec<usize> {
        let mut seen = HashMap::new();
        let mut number = |name| {
            let next = seen.len();
            *seen.entry(name).or_insert(next)
        };
        (0..self.receivers()).map(|i| number(self.recorder_name(i))).collect()
    }

    /// This matrix, of moments that count from here on; `None` for numbers.
    #[cfg(feature = "csv")]
    pub(crate) fn with_origin(self, origin: Option<TimeOrigin>) -> Pseudoranges {
        Pseudoranges { origin, ..self }
    }

    /// From when on measurements count, where they were read as moments.
    #[cfg(feature = "csv")]
    pub(crate) fn origin(&self) -> Option<TimeOrigin> {
        self.origin
    }

    /// This matrix with what is unknown of the recorders' clocks; `None` where all receivers share a clock.
    pub(crate) fn with_unknown_clocks(self, unknown_clocks: Option<Recorders>) -> Pseudoranges {
        Pseudoranges { unknown_clocks, ..self }
    }

    /// What is unknown of the recorders' clocks; `None` where all receivers share a clock.
    pub(crate) fn unknown_clocks(&self) -> Option<&Recorders> {
        self.unknown_clocks.as_ref()
    }
}
