//! Sources of starting networks for the search.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::PartialNetwork;
use crate::restart::Restarts;

/// A source of starting networks for the robust search.
pub trait Hypotheses<const D: usize = 2>: Sync {
    /// Networks to start from, complete or with some of the nodes. The other nodes are located by
    /// multilateration, and the most promising networks are refined. The result must depend only on
    /// the arguments: `index` counts the calls, `seed` is the user's, and calls come from several
    /// threads in any order.
    fn propose(&self, measured: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork<D>>;
}

/// Starts from known positions of the receivers. With the true positions this is the oracle with
/// which a calibration is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownReceivers<const D: usize = 2> {
    /// Names and positions in metres. Receivers that are not among them are located by
    /// multilateration.
    pub positions: Vec<(String, [f64; D])>,
}

impl<const D: usize> Hypotheses<D> for KnownReceivers<D> {
    fn propose(&self, measured: &Pseudoranges, _: usize, _: u64) -> Vec<PartialNetwork<D>> {
        let find =
            |name: &String| self.positions.iter().find(|(other, _)| other == name).map(|(_, position)| *position);
        let receivers = measured.receiver_names().iter().map(find).collect();
        vec![PartialNetwork { receivers, transmitters: vec![None; measured.transmitters()], clocks: Vec::new() }]
    }
}

/// A random number generator for one call.
pub fn generator(seed: u64, index: usize) -> Pcg64Mcg {
    // An odd multiplier keeps different indices of one seed apart.
    Pcg64Mcg::seed_from_u64(seed ^ (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(17))
}

/// Networks from random distances between the receivers; see the module `restart`.
pub(crate) struct RandomRestarts<'a, const D: usize> {
    observations: &'a Observations<D>,
    restarts: Restarts,
}

impl<'a, const D: usize> RandomRestarts<'a, D> {
    pub(crate) fn new(observations: &'a Observations<D>) -> Self {
        RandomRestarts { observations, restarts: Restarts::new(observations) }
    }

    /// A guess of the network's diameter in metres.
    pub(crate) fn diameter(&self) -> f64 {
        self.restarts.diameter
    }
}

impl<const D: usize> Hypotheses<D> for RandomRestarts<'_, D> {
    fn propose(&self, _: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork<D>> {
        // From the plain guess to anything: neither is best on all data.
        let spread = [1.0, 0.3, 1.0, 0.7][index % 4];
        let network = self.restarts.draw(self.observations, spread, &mut generator(seed, index));
        let located = network.transmitters.iter().zip(&network.offsets);
        vec![PartialNetwork {
            receivers: network.receivers.iter().copied().map(Some).collect(),
            transmitters: located.map(|(&position, &offset)| Some((position, offset))).collect(),
            clocks: network.clocks.clone(),
        }]
    }
}
