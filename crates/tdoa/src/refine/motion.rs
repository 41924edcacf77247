//! Changes of all nodes and clocks of a network at once.

use crate::bordered::Placed;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::dot;

/// A change of all nodes and clocks.
#[derive(Debug, Clone, Default)]
pub(crate) struct Motion<const D: usize = 2> {
    /// The coordinates of each receiver, one after the other, then the unknowns of clocks, metres.
    pub(crate) reduced: Vec<f64>,
    /// Position and offset of each transmitter, metres.
    pub(crate) transmitters: Vec<Placed<D>>,
}

impl<const D: usize> Motion<D> {
    /// A network of these measurements moved by this share of it.
    pub(crate) fn applied(&self, observations: &Observations<D>, network: &Network<D>, share: f64) -> Network<D> {
        let mut moved = network.clone();
        for (p, by) in moved.receivers.iter_mut().flatten().zip(&self.reduced) {
            *p += share * by;
        }
        for (j, by) in self.transmitters.iter().enumerate() {
            moved.transmitters[j].iter_mut().zip(&by.0).for_each(|(x, by)| *x += share * by);
            moved.offsets[j] += share * by.1;
        }
        observations.clocks().add(&mut moved, &self.reduced[D * observations.receivers..], share);
        moved
    }

    /// The sum of the products of all its lengths with those of another.
    pub(crate) fn product(&self, other: &Motion<D>) -> f64 {
        let reduced: f64 = self.reduced.iter().zip(&other.reduced).map(|(a, b)| a * b).sum();
        let transmitters = self.transmitters.iter().zip(&other.transmitters);
        reduced + transmitters.map(|(a, b)| dot(a.0, b.0) + a.1 * b.1).sum::<f64>()
    }

    /// Takes a share of another off.
    pub(crate) fn take_off(&mut self, share: f64, other: &Motion<D>) {
        self.reduced.iter_mut().zip(&other.reduced).for_each(|(a, b)| *a -= share * b);
        for (a, b) in self.transmitters.iter_mut().zip(&other.transmitters) {
            (0..D).for_each(|k| a.0[k] -= share * b.0[k]);
            a.1 -= share * b.1;
        }
    }
}
