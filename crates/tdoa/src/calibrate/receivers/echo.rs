//! What is known of a receiver that hears reflections.

use serde::{Deserialize, Serialize};

use crate::quantity::length;

/// A receiver two of whose places the measurements show, most likely as it hears a reflection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReceiverEcho {
    /// Name of the receiver.
    pub receiver: String,
    /// Names of the transmitters of which it measured the reflection, which are left out; none where the two places are
    /// not told apart.
    pub transmitters: Vec<String>,
    /// Of how many transmitters it has measurements.
    pub measured: usize,
    /// Distance of the reflecting plane from the receiver, metres: half of that of the two places.
    pub wall: f64,
}

/// Two places of a receiver, by indices.
#[derive(Debug, Clone)]
pub(crate) struct Echo {
    pub(crate) receiver: usize,
    /// Transmitters of which it measured the reflection; none where the two places are not told apart.
    pub(crate) reflected: Vec<usize>,
    /// Of how many transmitters it has measurements.
    pub(crate) measured: usize,
    /// Distance of the two places, metres.
    pub(crate) apart: f64,
}

impl ReceiverEcho {
    /// What the user should know; before the propagation speed was estimated, a metre was one of `metre` metres.
    pub(crate) fn warning(&self, metre: f64) -> String {
        let ReceiverEcho { receiver, transmitters, measured, .. } = self;
        let wall = metre * self.wall;
        if transmitters.is_empty() {
            return format!(
                "{receiver} has two places {} apart, and part of its {measured} measurements agrees on each; check whether it was moved, or \
                 which it hears by a reflection",
                length(2.0 * wall)
            );
        }
        format!(
            "{receiver} hears a reflection of {} of its {measured} transmitters ({:.0} %), from a surface {} from it; these measurements were \
             left out",
            transmitters.len(),
            100.0 * transmitters.len() as f64 / *measured as f64,
            length(wall)
        )
    }
}
