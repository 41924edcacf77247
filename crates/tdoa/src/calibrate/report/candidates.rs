//! Which candidates a calibration has chosen.

use crate::calibrate::input::selection::Input;
use crate::calibrate::state::State;
use serde::{Deserialize, Serialize};

/// A measurement of which another candidate than the first was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ChosenCandidate {
    /// Name of the receiver.
    pub receiver: String,
    /// Name of the transmitter.
    pub transmitter: String,
    /// Which of the candidates of this pair it is, from 1 in the order in which they were given; 2 or more.
    pub candidate: usize,
    /// The pseudorange, metres.
    pub value: f64,
}

impl<const D: usize> State<'_, D> {
    /// The measurements of which another candidate than the first was chosen, and how many measurements have
    /// several candidates.
    pub(crate) fn chosen(&self, input: &Input<'_>) -> (Vec<ChosenCandidate>, usize) {
        let table = &input.table;
        let mut doubtful = 0;
        let mut chosen = Vec::new();
        for (a, b, candidates) in self.measured.doubtful() {
            doubtful += 1;
            if candidates.chosen() > 0 {
                let (i, j) = (input.usable.receivers[a], input.usable.transmitters[b]);
                // As it was given, without what was taken off on the way.
                let given = table.candidates(i, j).get(candidates.chosen());
                chosen.push(ChosenCandidate {
                    receiver: table.receiver_names()[i].clone(),
                    transmitter: table.transmitter_names()[j].clone(),
                    candidate: candidates.chosen() + 1,
                    value: given.copied().unwrap_or_else(|| candidates.value()),
                });
            }
        }
        (chosen, doubtful)
    }
}
