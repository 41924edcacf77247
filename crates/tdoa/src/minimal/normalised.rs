//! Measurements in the form that the equations need.

use super::options::MinimalOptions;
use super::polish::Polisher;
use super::solution::Candidate;
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;

/// Measurements relative to the first receiver, in units of their own size.
#[derive(Default)]
pub(crate) struct Normalised {
    /// `(f_ij - f_1j) / size`, row-major; zeros in the first row.
    pub(crate) matrix: Vec<f64>,
    first: Vec<f64>,
    size: f64,
}

impl Normalised {
    /// A matrix without missing entries.
    pub(crate) fn new(measured: &Pseudoranges) -> Self {
        let mut data = Normalised::default();
        data.take(measured);
        data
    }

    /// [`new`](Self::new) with the memory of an earlier matrix.
    pub(crate) fn take(&mut self, measured: &Pseudoranges) {
        let (f, n) = (measured.cells().values(), measured.transmitters());
        self.first.clear();
        self.first.extend_from_slice(&f[..n]);
        self.matrix.clear();
        self.matrix.extend((0..f.len()).map(|k| f[k] - f[k % n]));
        let count = (f.len() - n) as f64;
        let size = (self.matrix.iter().map(|d| d * d).sum::<f64>() / count).sqrt();
        for d in self.matrix.iter_mut() {
            *d /= size;
        }
        self.size = size;
    }

    /// The unit in metres: the root mean square of `f_ij - f_1j`.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Number of transmitters.
    pub(crate) fn transmitters(&self) -> usize {
        self.first.len()
    }

    /// `(f_ij - f_1j) / size` for `i = 2..m`, row-major: the parameters of the families.
    pub(crate) fn parameters(&self) -> &[f64] {
        &self.matrix[self.first.len()..]
    }

    /// A network in these units, polished over all measurements and judged.
    pub(crate) fn candidate<const D: usize>(
        &self,
        mut network: Network<D>,
        options: &MinimalOptions,
        polisher: &mut Polisher<D>,
    ) -> Candidate<D> {
        let condition = if options.polish { polisher.polish(&self.matrix, &mut network) } else { f64::NAN };
        let n = self.transmitters();
        let physical = (self.matrix.iter().enumerate()).all(|(k, f)| f - network.offsets[k % n] >= -options.tolerance);
        let residuals =
            self.matrix.iter().enumerate().map(|(k, f)| f - network.offsets[k % n] - network.distance(k / n, k % n));
        let residual = (residuals.map(|r| r * r).sum::<f64>() / self.matrix.len() as f64).sqrt();
        Candidate { network, residual, physical, condition }
    }

    /// Back to metres and to the offsets of the data.
    pub(crate) fn restore<const D: usize>(&self, network: &mut Network<D>) {
        for x in network.receivers.iter_mut().chain(&mut network.transmitters).flatten() {
            *x *= self.size;
        }
        for (o, first) in network.offsets.iter_mut().zip(&self.first) {
            *o = *o * self.size + first;
        }
    }

    /// From metres to these units; the inverse of [`Normalised::restore`].
    pub(crate) fn enter<const D: usize>(&self, network: &mut Network<D>) {
        for x in network.receivers.iter_mut().chain(&mut network.transmitters).flatten() {
            *x /= self.size;
        }
        for (o, first) in network.offsets.iter_mut().zip(&self.first) {
            *o = (*o - first) / self.size;
        }
    }
}

/// Physical candidates first, then by residual.
pub(crate) fn rank<const D: usize>(candidates: &mut [Candidate<D>]) {
    candidates.sort_unstable_by(|a, b| b.physical.cmp(&a.physical).then(a.residual.total_cmp(&b.residual)));
}
