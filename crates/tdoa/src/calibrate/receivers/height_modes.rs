//! Networks with heights, where the marginal likelihood of the measurements is largest.
//!
//! It has many maxima: of a receiver that lies beside the plane of transmitters the measurements hardly tell on which
//! side, so that eight receivers at two heights have 128 networks that fit about as well. Those of the search, which
//! knows no expectation of heights, are only where the way begins: receiver after receiver goes to the other side as
//! long as that is likelier.

use crate::calibrate::options::CalibrateError;
use crate::calibrate::state::State;
use crate::flatness::{level_plane, levelled};
use crate::network::Network;
use crate::observations::Observations;
use crate::points::{centroid, distance};
use crate::refine::{Cancelled, Heights, RefinedNetwork};
use hc::Monitor;
#[cfg(feature = "threads")]
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use std::array::from_fn;

/// The deviation of measurements in the plane that is tried, as a multiple of the one in space: without heights, that which
/// they explain is noise.
const WIDER: [f64; 2] = [1.0, 5.0];

/// Networks of the search from which heights are looked for, the best first: receivers at two heights and transmitters
/// between them explain about what receivers at one height and transmitters above them do.
const NETWORKS: usize = 3;

/// The likeliest networks in which receivers are turned to the other side.
const TURNED: usize = 3;

/// Receivers of which each is turned, at most: of more, each takes as long and the measurements tell more.
const MOST_TURNED: usize = 16;

/// By how much a planar network may be likelier than one in which receivers are turned, natural logarithm.
const BEHIND: f64 = 10.0;

/// Gain of the sum of squares below which turning a receiver is none, in the variance of a measurement.
const GAIN: f64 = 0.1;

/// Standard deviation of a receiver's place as a share of the network's size, above which the measurements do not
/// determine the network.
const LOOSE: f64 = 0.3;

/// Logarithm of the ratio of marginal likelihoods up to which two networks are about as likely, for Laplace's
/// approximation.
const CLOSE: f64 = 5.0;

/// Distance of a transmitter from the middle of the receivers, in median distances, from which it starts nearer: heights
/// that the measurements do not tell are as large as you like.
const FAR: f64 = 2.0;

/// Heights and the logarithm of their marginal likelihood.
pub(crate) type Mode<const D: usize> = (f64, Heights<D>);

impl<const D: usize> State<'_, D> {
    /// Heights near the best networks, the likeliest first, and the logarithm of the marginal likelihood of the likeliest
    /// network without heights.
    pub(crate) fn height_modes(&self) -> Result<(Vec<Mode<D>>, f64), CalibrateError<D>> {
        let search = self.search_of_heights();
        let Modes { observations, known, limit, .. } = search;
        let starts = self.ranked.iter().take(NETWORKS).filter_map(|RefinedNetwork { network, .. }| {
            let kept = search.kept(network);
            let motion = levelled(network).filter(|_| kept.len() > kept.unknowns())?;
            let level = motion.apply_network(network);
            let mut starts = vec![(kept.clone(), one_sided(&level)), (kept.clone(), level.clone())];
            starts.extend(nearer(&level).map(|near| (kept.clone(), one_sided(&near))));
            starts.extend(on_a_table(network).map(|table| (kept, table)));
            Some(starts)
        });
        let starts = self.likeliest_start(starts.flatten().collect())?;
        let mut modes: Vec<Mode<D>> = Vec::new();
        let mut of_plane = f64::NEG_INFINITY;
        for found in each(&starts, |(kept, start)| search.with_plane(kept, start))? {
            let Some((mode, plane)) = found else { continue };
            modes.extend(mode);
            of_plane = of_plane.max(plane);
        }
        modes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let likely = modes.iter().take(TURNED).filter(|(evidence, _)| *evidence > of_plane - BEHIND);
        let likely: Vec<Mode<D>> = likely.cloned().collect();
        modes.extend(each(&likely, |mode| search.turned(mode))?.into_iter().flatten());
        modes.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Of those that are about as likely the one of which most is to be expected by Akaike's criterion too, in which
        // each height counts that the measurements tell.
        let close = modes.partition_point(|(evidence, _)| *evidence >= modes[0].0 - CLOSE);
        let variance = modes.first().map_or(1.0, |(_, heights)| known.unwrap_or(heights.deviation).powi(2));
        let price = |(evidence, heights): &Mode<D>| -> f64 {
            let all = observations.all().iter();
            let squares: f64 = all.map(|o| o.residual(&heights.network).abs().min(limit).powi(2)).sum();
            0.5 * squares / variance + heights.told - evidence
        };
        if let Some(best) = (0..close).min_by(|&a, &b| price(&modes[a]).total_cmp(&price(&modes[b]))) {
            modes[..=best].rotate_right(1);
        }
        Ok((modes, of_plane))
    }

    /// Heights about one level near a network that has two; `None` where it has one.
    pub(super) fn on_one_level(&self, heights: &Heights<D>) -> Result<Option<Heights<D>>, CalibrateError<D>> {
        if heights.apart == 0.0 {
            return Ok(None);
        }
        let search = self.search_of_heights();
        let network = &heights.network;
        Ok(search.heights(&search.kept(network), network, one_level(network))?)
    }

    fn search_of_heights(&self) -> Modes<'_, D> {
        self.search_of_heights_among(&self.observations)
    }

    /// A search of heights among some of the measurements.
    pub(super) fn search_of_heights_among<'o>(&'o self, observations: &'o Observations<D>) -> Modes<'o, D> {
        let State { options, monitor, known, deviation, .. } = *self;
        let sigma = known.unwrap_or(deviation);
        let (limit, width) = (options.inlier_threshold * sigma, self.ranked[0].network.size());
        Modes { observations, known, sigma, limit, width, monitor }
    }
}

/// The results of all, in their order.
pub(super) fn each<T: Sync, R: Send>(
    all: &[T],
    of: impl Fn(&T) -> Result<R, Cancelled> + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    #[cfg(feature = "threads")]
    return all.par_iter().map(of).collect();
    #[cfg(not(feature = "threads"))]
    all.iter().map(of).collect()
}

/// Measurements among which heights are looked for.
pub(super) struct Modes<'a, const D: usize> {
    observations: &'a Observations<D>,
    /// Deviation of the measurements if it is given, and one near it.
    known: Option<f64>,
    sigma: f64,
    /// Largest residual of a measurement that is no outlier, metres.
    limit: f64,
    /// Size of the network, metres.
    width: f64,
    monitor: &'a Monitor,
}

impl<const D: usize> Modes<'_, D> {
    /// The measurements that fit a network.
    fn kept(&self, network: &Network<D>) -> Observations<D> {
        self.observations.subset(|o| o.residual(network).abs() <= self.limit)
    }

    /// The heights near a network with level planes, about one level of receivers or two; `None` where the measurements
    /// do not determine it: likelihoods say little then.
    fn heights(
        &self,
        kept: &Observations<D>,
        start: &Network<D>,
        sides: Vec<f64>,
    ) -> Result<Option<Heights<D>>, Cancelled> {
        let found = Heights::of(kept, start, sides, self.known, self.sigma, self.monitor)?;
        Ok(found.filter(|heights| heights.loosest <= LOOSE * self.width))
    }

    /// Heights with their likelihood, if there is one.
    fn mode(&self, heights: Heights<D>) -> Result<Option<Mode<D>>, Cancelled> {
        let evidence = heights.evidence(self.observations, self.known, self.width, self.monitor)?;
        Ok(evidence.map(|evidence| (evidence + heights.log_prior(self.width), heights)))
    }

    /// The heights near a network, and the likelihood of the likeliest planar network near it.
    pub(super) fn with_plane(
        &self,
        kept: &Observations<D>,
        start: &Network<D>,
    ) -> Result<Option<(Option<Mode<D>>, f64)>, Cancelled> {
        let Modes { observations, known, width, monitor, .. } = *self;
        let Some(heights) = self.heights(kept, start, one_level(start))? else { return Ok(None) };
        let mut of_plane = f64::NEG_INFINITY;
        for factor in WIDER {
            let flat = heights.flat(observations, factor * heights.deviation, monitor)?;
            let plane = flat.evidence(observations, known, width, monitor)?;
            of_plane = of_plane.max(plane.unwrap_or(f64::NEG_INFINITY));
        }
        Ok(Some((self.mode(heights)?, of_plane)))
    }

    /// The networks that receivers on other sides of the transmitters' plane lead to, about one level and about two.
    /// (Transmitters take the likelier side by themselves: they are placed by the receivers alone.)
    fn turned(&self, (_, heights): &Mode<D>) -> Result<Vec<Mode<D>>, Cancelled> {
        let receivers = heights.network.receivers.len();
        if receivers > MOST_TURNED {
            return Ok(Vec::new());
        }
        // Both sides of that plane are alike beforehand.
        let mut level = heights.about_transmitters();
        let mut least = None;
        for _ in 0..2 * receivers {
            let kept = self.kept(&level.network);
            if kept.len() <= kept.unknowns() {
                return Ok(Vec::new());
            }
            let mut turned = Vec::new();
            for i in 0..receivers {
                let mut network = level.network.clone();
                let z = &mut network.receivers[i][D - 1];
                *z = -*z;
                turned.push(level.fitted(&kept, network, self.monitor)?);
            }
            let before = match least {
                Some(before) => before,
                None => level.fitted(&kept, level.network.clone(), self.monitor)?.0,
            };
            let Some((squares, network)) = turned.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if squares >= before - GAIN * level.deviation.powi(2) {
                break;
            }
            (least, level.network) = (Some(squares), network);
        }
        let kept = self.kept(&level.network);
        let mut modes = Vec::new();
        let one = least.is_some().then(|| one_level(&level.network));
        for sides in one.into_iter().chain([two_levels(&level.network)]) {
            if let Some(found) = self.heights(&kept, &level.network, sides)? {
                modes.extend(self.mode(found)?);
            }
        }
        Ok(modes)
    }
}

/// No sides: all receivers are on one level.
fn one_level<const D: usize>(network: &Network<D>) -> Vec<f64> {
    vec![0.0; network.receivers.len()]
}

/// The sides of two levels of receivers that leave the least squares of heights.
fn two_levels<const D: usize>(network: &Network<D>) -> Vec<f64> {
    let z = |i: usize| network.receivers[i][D - 1];
    let count = network.receivers.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| z(a).total_cmp(&z(b)));
    let mean = |some: &[usize]| some.iter().map(|&i| z(i)).sum::<f64>() / some.len() as f64;
    // What two levels leave is least where what is between them is most.
    let between = |lower: &usize| {
        let (below, above) = order.split_at(*lower);
        below.len() as f64 * above.len() as f64 * (mean(above) - mean(below)).powi(2)
    };
    let split = (1..count).max_by(|a, b| between(a).total_cmp(&between(b))).unwrap_or(0);
    let mut sides = vec![1.0; count];
    order[..split].iter().for_each(|&i| sides[i] = -1.0);
    sides
}

/// The network with all nodes of one kind on one side of the plane of the other, where that is the flatter one: their
/// mirror images in it fit as well.
fn one_sided<const D: usize>(network: &Network<D>) -> Network<D> {
    let z = D - 1;
    let (receivers, transmitters) = (&network.receivers, &network.transmitters);
    let middle = transmitters.iter().map(|p| p[z]).sum::<f64>() / transmitters.len().max(1) as f64;
    let spread = |points: &[[f64; D]], about: f64| {
        points.iter().map(|p| (p[z] - about).powi(2)).sum::<f64>() / points.len().max(1) as f64
    };
    let mut folded = network.clone();
    if spread(receivers, 0.0) < spread(transmitters, middle) {
        folded.transmitters.iter_mut().for_each(|p| p[z] = p[z].abs());
    } else {
        folded.receivers.iter_mut().for_each(|p| p[z] = middle + (p[z] - middle).abs());
    }
    folded
}

/// The network with its receivers in one plane, z = 0, and its transmitters above it.
fn on_a_table<const D: usize>(network: &Network<D>) -> Option<Network<D>> {
    let level = level_plane(&network.receivers)?.apply_network(network);
    let mut table = nearer(&level).unwrap_or(level);
    table.receivers.iter_mut().for_each(|p| p[D - 1] = 0.0);
    table.transmitters.iter_mut().for_each(|p| p[D - 1] = p[D - 1].abs());
    Some(table)
}

/// The network with its far transmitters at the median distance; `None` where none is far.
fn nearer<const D: usize>(network: &Network<D>) -> Option<Network<D>> {
    let middle = centroid(network.receivers.iter());
    let mut distances: Vec<f64> = network.transmitters.iter().map(|p| distance(*p, middle)).collect();
    distances.sort_by(f64::total_cmp);
    let median = *distances.get(distances.len() / 2)?;
    distances.last().filter(|farthest| **farthest > FAR * median)?;
    let mut near = network.clone();
    for p in &mut near.transmitters {
        let d = distance(*p, middle);
        if d > FAR * median {
            *p = from_fn(|k| middle[k] + (p[k] - middle[k]) * median / d);
        }
    }
    Some(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(receivers: &[[f64; 3]], transmitters: &[[f64; 3]]) -> Network<3> {
        let offsets = vec![0.0; transmitters.len()];
        Network::new(receivers.to_vec(), transmitters.to_vec(), offsets)
    }

    #[test]
    fn two_levels_leave_the_least_squares() {
        let heights = |z: &[f64]| two_levels(&at(&z.iter().map(|z| [0.0, 1.0, *z]).collect::<Vec<_>>(), &[]));
        assert_eq!(heights(&[2.0, 0.1, 1.9, 0.0, 0.2]), [1.0, -1.0, 1.0, -1.0, -1.0]);
        // 0 | 1 2 2 leaves 2/3, 0 1 | 2 2 leaves 1/2.
        assert_eq!(heights(&[2.0, 0.0, 1.0, 2.0]), [1.0, -1.0, -1.0, 1.0]);
    }

    #[test]
    fn a_table_is_level_and_its_talkers_above() {
        let table = [[0.0, 0.0, 0.0], [2.0, 0.0, 2.0], [0.0, 3.0, 0.0], [2.0, 3.0, 2.0]];
        // Along the normal (1, 0, -1) of the plane x = z, and one far away.
        let talkers = [[1.5, 1.0, 0.5], [0.5, 1.0, 1.5], [1.5, 2.0, 0.5], [1.0, 1.0, 1.0], [90.0, 1.0, -90.0]];
        let placed = on_a_table(&at(&table, &talkers)).unwrap();
        assert!(placed.receivers.iter().all(|p| p[2] == 0.0));
        let heights: Vec<f64> = placed.transmitters[..4].iter().map(|p| p[2]).collect();
        let height = 0.5f64.sqrt();
        let off = heights.iter().zip([height, height, height, 0.0]).map(|(z, wanted)| (z - wanted).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{heights:?}");
        // As far from the middle as the median one.
        let far = distance(placed.transmitters[4], [0.0; 3]);
        assert!(far < 1.0, "{far}");
        assert!(on_a_table(&at(&[[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]], &talkers)).is_none());
    }
}
