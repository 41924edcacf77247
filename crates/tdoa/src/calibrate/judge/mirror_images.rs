//! Mirror images: where the receivers that hear a transmitter lie in one plane, its place on the other side
//! of that plane explains the measurements as well; and so for a receiver and the transmitters it hears.
//!
//! Each node is located anew from its reflection, first with all others held, then together with them: they
//! are bent a little to the place that the node has. What the place costs more is the logarithm of a
//! likelihood ratio, as for other networks; it may be as large as chance makes it where those other nodes lie
//! in the plane within their errors. Every node has its side for itself, relative to all others.
//! Where nothing fixes the frame, a single one off the plane has none: with it the whole network is mirrored.

use hc::Monitor;
use serde::{Deserialize, Serialize};

use crate::align::align;
use crate::calibrate::judge::neighbours::BEYOND;
use crate::calibrate::search::same_network::{agree, fits};
use crate::calibrate::search::truncated_cost::{annealed, refit_annealed, truncated};
use crate::distances::ReceiverDistance;
use crate::flatness::Plane;
use crate::loss::Loss;
use crate::minimal::NodeKind;
use crate::multilateration::{Located, Sight, cost, polish};
use crate::network::Network;
use crate::observations::{Node, Observation, Observations};
use crate::points::{distance, dot};
use crate::refine::{Cancelled, Covariance, check};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A place of a node on the other side of a plane that explains its measurements as well.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[f64; D]: Serialize", deserialize = "[f64; D]: Deserialize<'de>"))]
pub struct MirrorImage<const D: usize = 2> {
    /// The name of the node.
    pub node: String,
    /// Its kind.
    pub kind: NodeKind,
    /// The place on the other side, metres.
    pub position: [f64; D],
    /// How far the node lies from the plane of best fit of the nodes that it was measured with, metres.
    pub distance_from_plane: f64,
    /// How much less likely the measurements are with the node there (natural logarithm); not negative.
    pub log_likelihood_loss: f64,
}

/// A mirror image of the node with this index among the usable ones.
pub(crate) struct Mirrored<const D: usize> {
    pub(crate) kind: NodeKind,
    pub(crate) index: usize,
    pub(crate) position: [f64; D],
    /// 0 for a receiver.
    offset: f64,
    /// Its place mirrored in the plane.
    reflection: [f64; D],
    pub(crate) height: f64,
    pub(crate) loss: f64,
    /// The greatest loss of a place that fits as well.
    margin: f64,
}

/// Whether another network differs from the best one in the choice of mirror images alone.
pub(crate) fn differs_in_sides<const D: usize>(best: &Network<D>, other: &Network<D>, images: &[Mirrored<D>]) -> bool {
    let size = best.size().max(other.size());
    let (receivers, transmitters): ([&[_]; 2], [&[_]; 2]) =
        ([&best.receivers, &other.receivers], [&best.transmitters, &other.transmitters]);
    let by = |kind: NodeKind, fixed: [&[[f64; D]]; 2], free: [&[[f64; D]]; 2]| {
        let image = |k: usize| images.iter().find(|image| image.kind == kind && image.index == k);
        images.iter().any(|image| image.kind == kind)
            && fits(fixed, size)
            && agree(fixed, free, size, |k, _| image(k).map(|image| image.position))
    };
    by(NodeKind::Receivers, transmitters, receivers) || by(NodeKind::Transmitters, receivers, transmitters)
}

/// Residuals count in this share of the network's size at least: exact measurements have no noise.
const LEAST_DEVIATION: f64 = 1e-6;

/// A place that costs so many times the margin with all other nodes held is none together with them either:
/// their errors add about as much to the residuals as noise does.
const HOPELESS: f64 = 20.0;

/// Probability of the quantile of chi-squared up to which a place on the other side is no less likely than by
/// chance.
const QUANTILE: f64 = 1.0 - 1e-4;

/// Measurements that are fitted anew for all nodes together, at most, those of each node all.
const WORK: usize = 200_000;

/// Nodes whose mirror image is nearer than this share of the network's size lie in the plane.
const IN_PLANE: f64 = 1e-3;

/// A network whose nodes may have mirror images.
pub(crate) struct Sides<'a, const D: usize> {
    pub(crate) observations: &'a Observations<D>,
    /// Those that are no outliers.
    pub(crate) kept: &'a Observations<D>,
    pub(crate) network: &'a Network<D>,
    /// Of the measurements.
    pub(crate) deviation: f64,
    /// Covariances of the nodes, as far as they are known.
    pub(crate) uncertainty: &'a Covariance<D>,
    /// By how much less likely another place may be in any case.
    pub(crate) margin: f64,
}

impl<const D: usize> Sides<'_, D> {
    /// The mirror images that explain the measurements as well: receivers first. None in the plane.
    pub(crate) fn mirror_images(&self, monitor: &Monitor) -> Result<Vec<Mirrored<D>>, Cancelled> {
        let mut found: Vec<Mirrored<D>> = Vec::new();
        if D != 3 {
            return Ok(found);
        }
        for kind in [NodeKind::Receivers, NodeKind::Transmitters] {
            let mut off_plane = 0;
            let mut images = Vec::new();
            let count = if kind == NodeKind::Receivers { self.kept.receivers } else { self.kept.transmitters };
            for index in 0..count {
                check(monitor)?;
                let Some((plane, height)) = self.plane_below(kind, index) else { continue };
                off_plane += 1;
                let held = kind == NodeKind::Receivers && self.observations.held()[index];
                images.extend(if held { None } else { self.beside_held(kind, index, &plane, height) });
            }
            // The only one off the plane takes the whole network with it.
            if off_plane > 1 || !self.observations.leave_rigid_motions() {
                found.append(&mut images);
            }
        }
        // The likeliest first, as long as there is time.
        let mut unsure: Vec<usize> = (0..found.len()).filter(|&k| found[k].loss > self.margin).collect();
        unsure.sort_by(|&a, &b| found[a].loss.total_cmp(&found[b].loss));
        unsure.truncate((WORK / self.observations.len().max(1)).max(1));
        if !unsure.is_empty() {
            let least = self.fitted(self.network, annealed(1.0), monitor)?.1;
            for k in unsure {
                self.let_go(&mut found[k], least, monitor)?;
            }
        }
        found.retain(|image| image.loss <= image.margin);
        Ok(found)
    }

    /// The deviation in which residuals count.
    fn deviation(&self) -> f64 {
        self.deviation.max(LEAST_DEVIATION * self.network.size())
    }

    /// Moves a mirror image to where it lies, and to what it costs, once all other nodes may move with it.
    /// `least` is what the network costs.
    fn let_go(&self, image: &mut Mirrored<D>, least: f64, monitor: &Monitor) -> Result<(), Cancelled> {
        let mut network = self.network.clone();
        match image.kind {
            NodeKind::Receivers => network.receivers[image.index] = image.position,
            NodeKind::Transmitters => {
                (network.transmitters[image.index], network.offsets[image.index]) = (image.position, image.offset);
            }
        }
        let (network, cost) = self.fitted(&network, annealed(3.0), monitor)?;
        let (here, there) = (self.other_nodes(self.network, image), self.other_nodes(&network, image));
        let place = match image.kind {
            NodeKind::Receivers => network.receivers[image.index],
            NodeKind::Transmitters => network.transmitters[image.index],
        };
        let free = self.observations.leave_rigid_motions();
        let place =
            if free { align(&there, &here, false).map(|back| back.transform.apply(place)) } else { Some(place) };
        let place = place.filter(|place| distance(*place, image.reflection) < image.height);
        (image.position, image.loss) =
            place.map_or((image.position, f64::INFINITY), |place| (place, (cost - least).max(0.0)));
        Ok(())
    }

    /// The network fitted anew under truncated costs of so many deviations one after the other, and what it
    /// costs, known coordinates included.
    fn fitted(&self, network: &Network<D>, factors: &[f64], monitor: &Monitor) -> Result<(Network<D>, f64), Cancelled> {
        let (network, cost) = refit_annealed(self.observations, network, factors, self.deviation(), monitor)?;
        let pins = self.observations.pins().iter();
        let known: f64 = pins.map(|pin| 0.5 * (pin.residual(&network) / self.deviation()).powi(2)).sum();
        Ok((network, cost + known))
    }

    /// Where all nodes are but the one of an image.
    fn other_nodes(&self, network: &Network<D>, image: &Mirrored<D>) -> Vec<[f64; D]> {
        let but = |kind: NodeKind, all: &[[f64; D]]| -> Vec<[f64; D]> {
            let is_other = |k: &usize| image.kind != kind || *k != image.index;
            (0..all.len()).filter(is_other).map(|k| all[k]).collect()
        };
        let receivers = but(NodeKind::Receivers, &network.receivers);
        [receivers, but(NodeKind::Transmitters, &network.transmitters)].concat()
    }

    /// The plane of the nodes that a node was measured with, and how far the node lies above it; `None` if it
    /// lies in that plane as far as is known, or there is none.
    fn plane_below(&self, kind: NodeKind, index: usize) -> Option<(Plane<D>, f64)> {
        let others: Vec<[f64; D]> = self.sights(kind, index).iter().map(|sight| sight.position).collect();
        let plane = Plane::through(&others)?;
        let height = plane.height(self.position(kind, index));
        // One whose measurements do not determine it has no side.
        let variance = if self.uncertainty.receivers.is_empty() { 0.0 } else { self.variance(kind, index, &plane)? };
        // Nearer ones lie in what the ellipsoid covers, as with other networks.
        let least = (BEYOND * variance.sqrt()).max(IN_PLANE * self.network.size());
        (2.0 * height.abs() > least).then_some((plane, height))
    }

    /// By how much less likely the measurements may be with a node on the other side.
    ///
    /// If the nodes that it was measured with do lie in one plane, both sides are as likely as each other in
    /// the network that has them there. That one costs half of chi-squared more than the best one, with a
    /// degree of freedom for each of these nodes less three for the plane, and so the other side costs no
    /// more. This counts where the height of each is within its error (Bonferroni, as errors of heights are
    /// correlated).
    fn margin_of(&self, kind: NodeKind, index: usize, plane: &Plane<D>) -> f64 {
        let (other, partners) = match kind {
            NodeKind::Receivers => {
                let all: Vec<usize> = self.kept.of_receiver(index).map(|o| o.transmitter).collect();
                (NodeKind::Transmitters, all)
            }
            NodeKind::Transmitters => {
                let all: Vec<usize> = self.kept.of_transmitter(index).iter().map(|o| o.receiver).collect();
                (NodeKind::Receivers, all)
            }
        };
        let freedom = partners.len().saturating_sub(D) as f64;
        let (Ok(chance), Ok(one)) = (ChiSquared::new(freedom), ChiSquared::new(1.0)) else { return self.margin };
        let most_of_one = one.inverse_cdf(1.0 - (1.0 - QUANTILE) / partners.len() as f64);
        let least = LEAST_DEVIATION * self.network.size();
        if self.uncertainty.receivers.is_empty() {
            return self.margin;
        }
        let is_within = |k: usize| {
            let square = plane.height(self.position(other, k)).powi(2);
            self.variance(other, k, plane).is_none_or(|variance| square <= least.powi(2).max(most_of_one * variance))
        };
        let flat = partners.iter().all(|&k| is_within(k));
        if flat { self.margin.max(0.5 * chance.inverse_cdf(QUANTILE)) } else { self.margin }
    }

    fn position(&self, kind: NodeKind, index: usize) -> [f64; D] {
        match kind {
            NodeKind::Receivers => self.network.receivers[index],
            NodeKind::Transmitters => self.network.transmitters[index],
        }
    }

    /// The variance of a node across a plane; `None` where it is not known.
    fn variance(&self, kind: NodeKind, index: usize, plane: &Plane<D>) -> Option<f64> {
        let covariance = match kind {
            NodeKind::Receivers => *self.uncertainty.receivers.get(index)?,
            NodeKind::Transmitters => (*self.uncertainty.transmitters.get(index)?)?.rows,
        };
        Some(dot(plane.normal, covariance.map(|row| dot(row, plane.normal))).max(0.0))
    }

    /// The mirror image of a node where all others stay; `None` if it leads back, or costs far too much.
    fn beside_held(&self, kind: NodeKind, index: usize, plane: &Plane<D>, height: f64) -> Option<Mirrored<D>> {
        let with_offset = kind == NodeKind::Transmitters && !self.observations.are_ranges();
        let position = self.position(kind, index);
        let offset = if kind == NodeKind::Transmitters { self.network.offsets[index] } else { 0.0 };
        let reflection = plane.mirrored(position);
        let sights = self.sights(kind, index);
        let loss = Loss { nu: f64::INFINITY, scale: self.deviation() };
        let pinned = self.observations.pins().iter().any(|pin| pin.node == node(kind, index));
        // Coordinates that were measured are no sights: such a receiver stays at its reflection.
        let located = |position: [f64; D]| {
            let start = Located { position, offset, cost: cost(&sights, position, offset, &loss) };
            if pinned { start } else { polish(&sights, start, with_offset, &loss) }
        };
        let (here, there) = (located(position), located(reflection));
        let loss = (self.cost(kind, index, &there) - self.cost(kind, index, &here)).max(0.0);
        let height = height.abs();
        let is_there = distance(there.position, reflection) < height;
        let (position, offset) = (there.position, there.offset);
        let margin = self.margin_of(kind, index, plane);
        let image = Mirrored { kind, index, position, offset, reflection, height, loss, margin };
        (is_there && loss <= HOPELESS * margin).then_some(image)
    }

    /// Sum of the truncated costs of the measurements of a node at another place.
    fn cost(&self, kind: NodeKind, index: usize, place: &Located<D>) -> f64 {
        let deviation = self.deviation();
        let truncated = |e: f64| truncated(e / deviation);
        let residual = |o: &Observation| {
            let (position, offset) = match kind {
                NodeKind::Receivers => (self.network.transmitters[o.transmitter], self.network.offsets[o.transmitter]),
                NodeKind::Transmitters => (self.network.receivers[o.receiver], place.offset),
            };
            (o.synchronised(self.network) - offset - distance(place.position, position)) * o.precision
        };
        let pins = self.observations.pins().iter().filter(|pin| pin.node == node(kind, index));
        let off = |axis: usize, value: f64| value - place.position[axis];
        let known: f64 = pins.map(|pin| 0.5 * (off(pin.axis, pin.value) * pin.precision / deviation).powi(2)).sum();
        known
            + self.cost_of_distances(kind, index, place.position)
            + match kind {
                NodeKind::Transmitters => {
                    self.observations.of_transmitter(index).iter().map(|o| truncated(residual(o))).sum::<f64>()
                }
                NodeKind::Receivers => self.observations.of_receiver(index).map(|o| truncated(residual(o))).sum(),
            }
    }

    /// What distances from a receiver to others cost where it is elsewhere.
    fn cost_of_distances(&self, kind: NodeKind, index: usize, place: [f64; D]) -> f64 {
        let cost = |known: &ReceiverDistance| -> f64 {
            let other = match known.receivers {
                [a, b] if a == index => b,
                [a, b] if b == index => a,
                _ => return 0.0,
            };
            let off = known.value - distance(place, self.network.receivers[other]);
            ReceiverDistance::cost(off / known.sigma, true)
        };
        let all = if kind == NodeKind::Receivers { self.observations.distances() } else { &[] };
        all.iter().map(cost).sum()
    }

    /// The measurements of a node that are no outliers.
    fn sights(&self, kind: NodeKind, index: usize) -> Vec<Sight<D>> {
        let network = self.network;
        match kind {
            NodeKind::Receivers => {
                let sight = |o: &Observation| Sight {
                    position: network.transmitters[o.transmitter],
                    length: o.length(network),
                    precision: o.precision,
                };
                self.kept.of_receiver(index).map(sight).collect()
            }
            NodeKind::Transmitters => {
                let sight = |o: &Observation| Sight {
                    position: network.receivers[o.receiver],
                    length: o.synchronised(network),
                    precision: o.precision,
                };
                self.kept.of_transmitter(index).iter().map(sight).collect()
            }
        }
    }
}

/// A node of a kind.
fn node(kind: NodeKind, index: usize) -> Node {
    match kind {
        NodeKind::Receivers => Node::Receiver(index),
        NodeKind::Transmitters => Node::Transmitter(index),
    }
}

#[cfg(test)]
mod tests {
    use super::{Mirrored, Sides};
    use crate::minimal::NodeKind;
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::observations::Observations;
    use crate::points::distance;
    use crate::pseudoranges::Pseudoranges;
    use crate::refine::Covariance;
    use hc::Monitor;

    /// The mirror images of an exact network, some receivers held.
    fn images(network: &Network<3>, held: usize) -> Vec<Mirrored<3>> {
        let (m, n) = (network.receivers.len(), network.transmitters.len());
        let measured = Pseudoranges::new(m, n, network.pseudoranges()).unwrap();
        let held: Vec<bool> = (0..m).map(|i| i < held).collect();
        let observations = Observations::new(&measured, |_, _| true).holding(&held);
        let uncertainty = Covariance::default();
        let (deviation, margin) = (1e-3, 8.0);
        let kept = &observations;
        let sides = Sides { observations: kept, kept, network, deviation, uncertainty: &uncertainty, margin };
        sides.mirror_images(&Monitor::default()).unwrap()
    }

    /// Eight receivers and nine transmitters, some of one kind at these heights and all others at zero.
    fn flat(kind: NodeKind, heights: &[f64], seed: u64) -> Network<3> {
        let mut network: Network<3> = random(8, 9, seed);
        network.receivers.iter_mut().chain(&mut network.transmitters).for_each(|p| p[2] = 0.0);
        let nodes = match kind {
            NodeKind::Receivers => &mut network.receivers,
            NodeKind::Transmitters => &mut network.transmitters,
        };
        nodes.iter_mut().zip(heights).for_each(|(p, z)| p[2] = *z);
        network
    }

    #[test]
    fn nodes_off_the_plane_have_their_exact_reflections() {
        for seed in 0..10 {
            for kind in [NodeKind::Receivers, NodeKind::Transmitters] {
                let network = flat(kind, &[1.0, -2.0, 0.0, 0.5], seed);
                let found = images(&network, 0);
                let indices: Vec<(NodeKind, usize)> = found.iter().map(|image| (image.kind, image.index)).collect();
                assert_eq!(indices, [(kind, 0), (kind, 1), (kind, 3)], "seed {seed}");
                for image in &found {
                    let [x, y, z] = match kind {
                        NodeKind::Receivers => network.receivers[image.index],
                        NodeKind::Transmitters => network.transmitters[image.index],
                    };
                    assert!(distance(image.position, [x, y, -z]) < 1e-6 && (image.height - z.abs()).abs() < 1e-9);
                    assert!(image.loss < 1e-6, "seed {seed}: {}", image.loss);
                }
            }
            assert!(images(&random(8, 9, seed), 0).is_empty(), "seed {seed}");
        }
    }

    #[test]
    fn the_only_node_off_the_plane_has_a_side_in_a_fixed_frame_alone() {
        for seed in 0..10 {
            let network = flat(NodeKind::Transmitters, &[0.0, 0.0, 1.0], seed);
            assert!(images(&network, 0).is_empty(), "seed {seed}");
            assert_eq!(images(&network, 3).iter().map(|image| image.index).collect::<Vec<_>>(), [2], "seed {seed}");
            // Receivers that are held stay.
            let network = flat(NodeKind::Receivers, &[1.0, -1.0, 2.0, 0.5], seed);
            assert_eq!(images(&network, 3).iter().map(|image| image.index).collect::<Vec<_>>(), [3], "seed {seed}");
        }
    }
}
