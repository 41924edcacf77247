//! Measured distances between receivers beside those of the network.

use crate::calibrate::state::State;
use crate::degeneracy::list;
use crate::distances::ReceiverDistance;
use crate::quantity::length;
use serde::{Deserialize, Serialize};

/// A distance between two receivers that was measured by itself, and that of the network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MeasuredDistance {
    /// Names of the receivers.
    pub receivers: [String; 2],
    /// What was measured, metres.
    pub measured: f64,
    /// Its standard deviation, metres.
    pub sigma: f64,
    /// The distance in the network, metres.
    pub found: f64,
    /// Whether both agree. A distance that does not agree is a gross error, and says nothing to the network.
    pub inlier: bool,
}

impl<const D: usize> State<'_, D> {
    /// The measured distances beside those of the best network.
    pub(super) fn measured_distances(&self) -> Vec<MeasuredDistance> {
        let places = &self.ranked[0].network.receivers;
        let of = |known: &ReceiverDistance| MeasuredDistance {
            receivers: known.receivers.map(|i| self.measured.receiver_names()[i].clone()),
            measured: known.value,
            sigma: known.sigma,
            found: known.ray(places).1,
            inlier: !ReceiverDistance::is_wrong(known.residual(places)),
        };
        self.observations.distances().iter().map(of).collect()
    }

    /// Whether half of the measured distances or more are wrong: then the measurements may be.
    pub(crate) fn distances_contradict(&self) -> bool {
        let all = self.observations.distances();
        let places = &self.ranked[0].network.receivers;
        let wrong = all.iter().filter(|known| ReceiverDistance::is_wrong(known.residual(places))).count();
        wrong > 0 && 2 * wrong >= all.len()
    }

    /// Names the distances that the measurements contradict, if there are any.
    pub(super) fn warn_of_distances(&self) -> Option<String> {
        let wrong = |known: &MeasuredDistance| {
            let [a, b] = &known.receivers;
            let (measured, found) = (length(known.measured), length(known.found));
            (!known.inlier).then(|| format!("{a}-{b} (measured {measured}, {found} by the other measurements)"))
        };
        let all: Vec<String> = self.measured_distances().iter().filter_map(wrong).collect();
        let contradict = if self.distances_contradict() { "; at least half of them contradict the others" } else { "" };
        (!all.is_empty()).then(|| {
            format!(
                "distances that the measurements contradict, and that were not used: {}; check them, the names and the unit{contradict}",
                list(&all)
            )
        })
    }
}
