//! What the clocks of transmitters and receivers may do.

use crate::clocks::{Emissions, Recorders};
use crate::pseudoranges::Pseudoranges;
use serde::{Deserialize, Serialize};

/// What the clocks of receivers do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ReceiverClocks {
    /// All receivers share one, or theirs are synchronised.
    #[default]
    Common,
    /// Each [recorder](Pseudoranges::with_recorders) was started by itself: its clock is off by an unknown offset.
    Offset,
    /// Each recorder's clock is off by an unknown offset, and runs fast or slow by an unknown rate. Values are readings of
    /// that clock.
    Rate,
}

/// What is unknown of the clocks of transmitters and receivers.
///
/// A measurement is f_ij = |r_i - s_j| + o_j + a_d + b_d t_ij: o_j is the offset of transmitter j, a_d the offset and b_d
/// the rate of the recorder d of receiver i, and t_ij the time by that recorder.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Clocks {
    /// What is known of the times at which transmitters send. Where times are [given](Pseudoranges::with_emission_times) and
    /// emissions are constant, the receivers' clock has an unknown offset and an unknown rate against them. Default
    /// [`Emissions::Unknown`].
    pub emissions: Emissions,
    /// What the clocks of receivers do. Default [`ReceiverClocks::Common`].
    pub receivers: ReceiverClocks,
    /// Standard deviation of the recorders' offsets about their mean, metres, such as of recorders that were set by hand.
    /// Default `None`: nothing is known of them.
    pub offset_sigma: Option<f64>,
    /// Standard deviation of the recorders' rates about their mean, a share: 2e-5 for common quartz crystals. Default
    /// `None`: nothing is known of them.
    pub rate_sigma: Option<f64>,
}

impl Clocks {
    /// Measurements with these unknowns of clocks.
    pub(crate) fn of(&self, measured: &Pseudoranges) -> Pseudoranges {
        let scheduled = measured.emission_times().is_some() && self.emissions != Emissions::Unknown;
        let recorders = match self.receivers {
            // One for all receivers.
            ReceiverClocks::Common if scheduled && self.emissions == Emissions::Constant => {
                Some(Recorders::with_rates(vec![0; measured.receivers()], measured.cells()))
            }
            ReceiverClocks::Common => None,
            ReceiverClocks::Offset => Some(Recorders::with_offsets(measured.recorders())),
            ReceiverClocks::Rate => Some(Recorders::with_rates(measured.recorders(), measured.cells())),
        };
        let recorders = if scheduled { recorders.map(Recorders::scheduled) } else { recorders };
        let recorders = recorders.map(|recorders| recorders.expecting(self.offset_sigma, self.rate_sigma));
        let emissions = match (self.emissions, self.receivers) {
            // The offset of the first recorder is all transmitters' then.
            (Emissions::Known, ReceiverClocks::Offset | ReceiverClocks::Rate) => Emissions::Constant,
            (emissions, _) => emissions,
        };
        measured.clone().with_emissions(emissions).with_unknown_clocks(recorders)
    }
}
