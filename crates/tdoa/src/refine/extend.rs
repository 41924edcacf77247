//! From a part of a network to all of it: nodes are located one after the other from those that are
//! already known.

use super::cancel::{Cancelled, check};
use super::reseed::locate_transmitter;
use crate::loss::Loss;
use crate::multilateration::{self, Sight};
use crate::network::Network;
use crate::observations::{Observation, Observations};
use hc::Monitor;

/// A network in which some nodes are known; begins as [`PartialNetwork::unknown`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartialNetwork<const D: usize = 2> {
    /// Positions of receivers, metres.
    pub receivers: Vec<Option<[f64; D]>>,
    /// Positions of transmitters, metres, with their offsets.
    pub transmitters: Vec<Option<([f64; D], f64)>>,
    /// Per receiver, what its clock adds to measurements, metres: an offset, and a drift over half the recording. Empty where
    /// nothing is known of clocks.
    pub(crate) clocks: Vec<[f64; 2]>,
}

impl<const D: usize> PartialNetwork<D> {
    /// A network with these numbers of receivers and transmitters, none of them known.
    pub fn unknown(receivers: usize, transmitters: usize) -> Self {
        PartialNetwork { receivers: vec![None; receivers], transmitters: vec![None; transmitters], clocks: Vec::new() }
    }

    /// Enters a network for the nodes with these indices.
    pub fn place(&mut self, network: &Network<D>, receivers: &[usize], transmitters: &[usize]) {
        for (&i, &position) in receivers.iter().zip(&network.receivers) {
            self.receivers[i] = Some(position);
        }
        for (k, &j) in transmitters.iter().enumerate() {
            self.transmitters[j] = Some((network.transmitters[k], network.offsets[k]));
        }
    }
}

/// Locates all unknown nodes, best observed ones first: transmitters from at least four known
/// receivers, receivers from at least three known transmitters (one more of each in space; transmitters whose offset is
/// known, or that of all, take one less), and with one less of them when nothing else is left. `None` if some node cannot be located at all.
pub(crate) fn extend<const D: usize>(
    observations: &Observations<D>,
    part: &PartialNetwork<D>,
    loss: &Loss,
    monitor: &Monitor,
) -> Result<Option<Network<D>>, Cancelled> {
    let mut part = part.clone();
    let mut offsets: Vec<f64> = part.transmitters.iter().flatten().map(|(_, offset)| *offset).collect();
    observations.emissions().settle(&mut offsets);
    for ((_, offset), settled) in part.transmitters.iter_mut().flatten().zip(&offsets) {
        *offset = *settled;
    }
    let shared = observations.emissions().shared(offsets.first().copied());
    let fewest = if shared.is_some() { D } else { D + 1 };
    let mut sights = Vec::new();
    for spare in [1, 0] {
        loop {
            let transmitters =
                locate_transmitters(observations, &mut part, shared, fewest + spare, loss, &mut sights, monitor)?;
            let receivers = locate_receivers(observations, &mut part, D + spare, loss, &mut sights, monitor)?;
            if transmitters + receivers == 0 {
                break;
            }
        }
    }
    let located: Option<Vec<_>> = part.transmitters.into_iter().collect();
    let receivers: Option<Vec<_>> = part.receivers.into_iter().collect();
    Ok(located.zip(receivers).map(|(located, receivers)| {
        let (transmitters, offsets) = located.into_iter().unzip();
        Network { receivers, transmitters, offsets, clocks: part.clocks }
    }))
}

fn locate_transmitters<const D: usize>(
    observations: &Observations<D>,
    part: &mut PartialNetwork<D>,
    shared: Option<f64>,
    least: usize,
    loss: &Loss,
    sights: &mut Vec<Sight<D>>,
    monitor: &Monitor,
) -> Result<usize, Cancelled> {
    let mut found = 0;
    for j in 0..observations.transmitters {
        if part.transmitters[j].is_some() {
            continue;
        }
        check(monitor)?;
        let sight = |o: &Observation| {
            let position = part.receivers[o.receiver]?;
            Some(Sight { position, length: o.without_clock(&part.clocks), precision: o.precision })
        };
        sights.clear();
        sights.extend(observations.of_transmitter(j).iter().filter_map(sight));
        if sights.len() >= least
            && let Some(located) = locate_transmitter(observations, sights, shared, loss)
        {
            part.transmitters[j] = Some((located.position, located.offset));
            found += 1;
        }
    }
    Ok(found)
}

fn locate_receivers<const D: usize>(
    observations: &Observations<D>,
    part: &mut PartialNetwork<D>,
    least: usize,
    loss: &Loss,
    sights: &mut Vec<Sight<D>>,
    monitor: &Monitor,
) -> Result<usize, Cancelled> {
    let mut found = 0;
    for i in 0..observations.receivers {
        if part.receivers[i].is_some() {
            continue;
        }
        check(monitor)?;
        let sight = |o: &Observation| {
            let (position, offset) = part.transmitters[o.transmitter]?;
            Some(Sight { position, length: o.without_clock(&part.clocks) - offset, precision: o.precision })
        };
        sights.clear();
        sights.extend(observations.of_receiver(i).filter_map(sight));
        if sights.len() >= least
            && let Some(located) = multilateration::receiver(sights, loss)
        {
            part.receivers[i] = Some(located.position);
            found += 1;
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::align;
    use crate::simulate::{Layout, SimulateOptions, simulate};

    #[test]
    fn six_receivers_and_three_transmitters_carry_the_rest() {
        for seed in 0..50 {
            let mut options = SimulateOptions { receivers: 9, transmitters: 8, seed, ..Default::default() };
            options.layout = Layout::Normal;
            options.missing = 0.1;
            let simulation = simulate(&options).unwrap();
            let truth = &simulation.network;
            let small = Network::new(
                truth.receivers[..6].to_vec(),
                truth.transmitters[..3].to_vec(),
                truth.offsets[..3].to_vec(),
            );
            let mut part = PartialNetwork::unknown(9, 8);
            part.place(&small, &[0, 1, 2, 3, 4, 5], &[0, 1, 2]);
            let observations = Observations::new(&simulation.pseudoranges, |_, _| true);
            let found =
                extend(&observations, &part, &Loss { nu: 2.0, scale: 1e-3 }, &Monitor::default()).unwrap().unwrap();
            let nodes = |n: &Network| [n.receivers.clone(), n.transmitters.clone()].concat();
            // A node seen by as few as determine it may be its mirror image: most, not all, must be
            // right.
            let wrong =
                nodes(&found).iter().zip(nodes(truth)).filter(|(a, b)| crate::points::distance(**a, *b) > 1e-4).count();
            assert!(wrong <= 1, "seed {seed}: {wrong} nodes");
            assert!(wrong > 0 || align(&found.receivers, &truth.receivers, false).unwrap().rms < 1e-4);
        }
    }

    #[test]
    fn nothing_grows_from_nothing() {
        let simulation = simulate(&SimulateOptions::default()).unwrap();
        let observations = Observations::<2>::new(&simulation.pseudoranges, |_, _| true);
        let (none, loss) = (PartialNetwork::unknown(8, 12), Loss { nu: 2.0, scale: 1.0 });
        assert_eq!(extend(&observations, &none, &loss, &Monitor::default()), Ok(None));
    }
}
