//! Measurements in the form that the equations need.

use super::options::MinimalOptions;
use super::orders::{Order, Orders};
use super::polish::NetworkPolisher;
use super::solution::Candidate;
use crate::accuracy::position_error;
use crate::clocks::Emissions;
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use smallvec::SmallVec;

/// Networks whose offsets and positions differ by less than this share of their size are one.
const SAME: f64 = 1e-6;

/// Measurements with the nodes in some order, relative to the first receiver, in units of their own size; ranges as they
/// are, in these units, and those with an unknown constant relative to their mean.
#[derive(Default)]
pub(crate) struct Normalised {
    orders: Orders,
    emissions: Emissions,
    /// `(f_ij - f_1j) / size`, row-major, zeros in the first row; ranges `f_ij / size`, or with the mean `f` of all subtracted
    /// `(f_ij - f) / size`.
    pub(crate) matrix: Vec<f64>,
    /// What is subtracted, for each transmitter.
    subtracted: Vec<f64>,
    size: f64,
}

impl Normalised {
    /// A matrix without missing entries, in the order of the data.
    pub(crate) fn new(measured: &Pseudoranges) -> Self {
        let mut data = Normalised::default();
        data.take(measured);
        data
    }

    /// [`new`](Self::new) with the memory of an earlier matrix.
    pub(crate) fn take(&mut self, measured: &Pseudoranges) {
        self.take_in_order(measured, &Orders::of_data(measured.receivers(), measured.transmitters()));
    }

    /// A matrix without missing entries, its nodes in these orders, with the memory of an earlier matrix.
    pub(crate) fn take_in_order(&mut self, measured: &Pseudoranges, orders: &Orders) {
        let (f, n) = (measured.cells().values(), measured.transmitters());
        self.orders.clone_from(orders);
        self.emissions = measured.emissions();
        let Orders { receivers, transmitters } = orders;
        let cell = |i: usize, j: usize| f[receivers[i] * n + transmitters[j]];
        // A constant of an hour would leave few digits otherwise.
        let mean = f.iter().sum::<f64>() / f.len() as f64;
        self.subtracted.clear();
        self.subtracted.extend((0..n).map(|j| match self.emissions {
            Emissions::Unknown => cell(0, j),
            Emissions::Known => 0.0,
            Emissions::Constant => mean,
        }));
        self.matrix.clear();
        self.matrix.extend((0..f.len()).map(|k| cell(k / n, k % n) - self.subtracted[k % n]));
        let zeros = if self.emissions == Emissions::Unknown { n } else { 0 };
        let count = (f.len() - zeros) as f64;
        let size = (self.matrix.iter().map(|d| d * d).sum::<f64>() / count).sqrt();
        for d in self.matrix.iter_mut() {
            *d /= size;
        }
        self.size = size;
    }

    /// The unit in metres: the root mean square of `f_ij - f_1j`, of ranges, or of what they differ by from their mean.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Number of transmitters.
    pub(crate) fn transmitters(&self) -> usize {
        self.subtracted.len()
    }

    /// `(f_ij - f_1j) / size` for `i = 2..m`, row-major: the parameters of the families.
    pub(crate) fn parameters(&self) -> &[f64] {
        &self.matrix[self.subtracted.len()..]
    }

    /// A network in these units, polished over all measurements and judged.
    pub(crate) fn candidate<const D: usize>(
        &self,
        mut network: Network<D>,
        options: &MinimalOptions,
        polisher: &mut NetworkPolisher<D>,
    ) -> Candidate<D> {
        let condition =
            if options.polish { polisher.polish(&self.matrix, self.emissions, &mut network) } else { f64::NAN };
        let n = self.transmitters();
        let physical = (self.matrix.iter().enumerate()).all(|(k, f)| f - network.offsets[k % n] >= -options.tolerance);
        let residuals =
            self.matrix.iter().enumerate().map(|(k, f)| f - network.offsets[k % n] - network.distance(k / n, k % n));
        let residual = (residuals.map(|r| r * r).sum::<f64>() / self.matrix.len() as f64).sqrt();
        Candidate { network, residual, physical, condition }
    }

    /// Back to metres, to the offsets and to the order of the data, the first receiver in the origin.
    pub(crate) fn restore<const D: usize>(&self, network: &mut Network<D>) {
        for x in network.receivers.iter_mut().chain(&mut network.transmitters).flatten() {
            *x *= self.size;
        }
        for (o, subtracted) in network.offsets.iter_mut().zip(&self.subtracted) {
            *o = *o * self.size + subtracted;
        }
        let Orders { receivers, transmitters } = &self.orders;
        if receivers.is_sorted() && transmitters.is_sorted() {
            return;
        }
        give_back(&mut network.receivers, receivers);
        give_back(&mut network.transmitters, transmitters);
        give_back(&mut network.offsets, transmitters);
        let origin = network.receivers[0];
        for position in network.receivers.iter_mut().chain(&mut network.transmitters) {
            for (x, origin) in position.iter_mut().zip(&origin) {
                *x -= origin;
            }
        }
    }

    /// From metres to these units, where the order is that of the data; the inverse of [`Normalised::restore`].
    pub(crate) fn enter<const D: usize>(&self, network: &mut Network<D>) {
        debug_assert!(self.orders.receivers.is_sorted() && self.orders.transmitters.is_sorted());
        for x in network.receivers.iter_mut().chain(&mut network.transmitters).flatten() {
            *x /= self.size;
        }
        for (o, subtracted) in network.offsets.iter_mut().zip(&self.subtracted) {
            *o = (*o - subtracted) / self.size;
        }
    }
}

/// Gives every node its place in the data back.
fn give_back<T: Copy>(nodes: &mut [T], order: &Order) {
    let ordered: SmallVec<[T; 16]> = SmallVec::from_slice(nodes);
    for (node, &place) in ordered.iter().zip(order) {
        nodes[place] = *node;
    }
}

/// Physical candidates first, then by residual.
pub(crate) fn rank<const D: usize>(candidates: &mut [Candidate<D>]) {
    candidates.sort_unstable_by(|a, b| b.physical.cmp(&a.physical).then(a.residual.total_cmp(&b.residual)));
}

/// Leaves out networks that the refinement led to one before.
pub(crate) fn leave_out_copies<const D: usize>(candidates: &mut Vec<Candidate<D>>) {
    let mut kept: Vec<Candidate<D>> = Vec::new();
    for candidate in candidates.drain(..) {
        let near = |other: &Candidate<D>| {
            let pairs = other.network.offsets.iter().zip(&candidate.network.offsets);
            let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Mirror images of single nodes have the same offsets.
            let places = || position_error(&other.network, &candidate.network);
            apart < SAME * candidate.network.size() && places() < SAME
        };
        if !kept.iter().any(near) {
            kept.push(candidate);
        }
    }
    *candidates = kept;
}
