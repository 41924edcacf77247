//! Starts of the search in space: at a planar network with heights, and at a network in space.

use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::hypotheses::{Hypotheses, generator};
use crate::pseudoranges::Pseudoranges;
use crate::refine::PartialNetwork;
use rand::RngExt;
use rand_distr::StandardNormal;

/// Heights of a planar network's starts in space, as shares of its size.
pub(super) const LIFTED: [f64; 6] = [0.03, 0.1, 0.3, 0.03, 0.1, 0.3];

/// Starts in space from a planar network.
pub(super) struct Lifted<'a> {
    pub(super) flat: &'a Calibration,
    pub(super) size: f64,
}

impl Hypotheses<3> for Lifted<'_> {
    fn propose(&self, measured: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork<3>> {
        let mut rng = generator(seed ^ 0x2f0b_4c47_91d3_55e9, index);
        let height = LIFTED[index % LIFTED.len()] * self.size;
        let lift = |p: [f64; 2]| [p[0], p[1], height * rng.sample::<f64, _>(StandardNormal)];
        vec![start(measured, self.flat, lift)]
    }
}

/// One start at a network in space.
pub(super) struct Raised(pub(super) Calibration<3>);

impl Hypotheses<3> for Raised {
    fn propose(&self, measured: &Pseudoranges, index: usize, _: u64) -> Vec<PartialNetwork<3>> {
        if index == 0 { vec![start(measured, &self.0, |p| p)] } else { Vec::new() }
    }
}

/// The receivers of a calibration in other places. The search may work on some of the nodes.
fn start<const D: usize>(
    measured: &Pseudoranges,
    from: &Calibration<D>,
    mut to: impl FnMut([f64; D]) -> [f64; 3],
) -> PartialNetwork<3> {
    let place = |name: &String| from.receiver_names.iter().position(|other| other == name);
    let receivers = measured.receiver_names().iter();
    let receivers = receivers.map(|name| from.receivers[place(name)?].map(&mut to)).collect();
    PartialNetwork { receivers, transmitters: vec![None; measured.transmitters()] }
}
