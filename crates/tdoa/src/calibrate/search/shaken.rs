//! Starts from parts of a network that was found (iterated local search, Lourenço, Martin and Stützle 2003).
//!
//! Where many measurements are wrong, hardly a start ends in the best network, but many end in one of which some nodes
//! are right. Nodes that are taken out of it find their places anew from the others; where that lowers the objective,
//! the better network is taken. A network that this reaches from starts of its own counts as the end of one start:
//! several such networks agree only if their starts do.

use crate::calibrate::search::hypotheses::generator;
use crate::network::Network;
use crate::refine::{PartialNetwork, RefinedNetwork};
use rand::RngExt;

/// Batches without a better network that end a round.
const IDLE: usize = 2;

/// A network is better if its objective is lower by this (units of log-likelihood).
const GAIN: f64 = 0.1;

/// Shares of the nodes that are left in place, least and most.
const LEFT: [f64; 2] = [0.6, 0.9];

/// Number of the first draw; far above the numbers of other draws.
const DRAWS: usize = 1 << 25;

/// A part of a network that depends on the index and the seed alone: some of the receivers, and some or none of the
/// transmitters.
pub(crate) fn part_of<const D: usize>(network: &Network<D>, index: usize, seed: u64) -> PartialNetwork<D> {
    let mut random = generator(seed, DRAWS + index);
    let left = LEFT[0] + (LEFT[1] - LEFT[0]) * random.random::<f64>();
    let with_transmitters = random.random::<bool>();
    let receivers = network.receivers.iter().map(|&r| (random.random::<f64>() < left).then_some(r)).collect();
    let located = network.transmitters.iter().copied().zip(network.offsets.iter().copied());
    let transmitters = located.map(|s| (with_transmitters && random.random::<f64>() < left).then_some(s)).collect();
    PartialNetwork { receivers, transmitters, clocks: network.clocks.clone() }
}

/// The network of least objective.
pub(crate) fn least<const D: usize>(networks: &[RefinedNetwork<D>]) -> Option<&RefinedNetwork<D>> {
    networks.iter().min_by(|a, b| a.objective.total_cmp(&b.objective))
}

/// Starts of their own, and then starts from parts of the best network in which they ended, as long as there are
/// better ones.
#[derive(Default)]
pub(crate) struct Round<const D: usize> {
    best: Option<RefinedNetwork<D>>,
    /// Starts of their own.
    starts: usize,
    /// Batches from parts of the best network without a better one; `None` before the first.
    idle: Option<usize>,
    /// Whether a part led to the best network.
    is_led_to: bool,
}

impl<const D: usize> Round<D> {
    /// The network of which parts are taken, if it is their turn.
    pub(crate) fn shaken(&self) -> Option<&Network<D>> {
        self.idle.and(self.best.as_ref()).map(|best| &best.network)
    }

    /// Takes what a batch of starts ended in, and adds it to all ends: from parts of a network, as ends of no start.
    pub(crate) fn take(&mut self, ends: &mut Vec<RefinedNetwork<D>>, mut ended: Vec<RefinedNetwork<D>>, starts: usize) {
        let before = self.best.as_ref().map_or(f64::INFINITY, |best| best.objective);
        let better = least(&ended).filter(|new| new.objective < before).cloned();
        match &mut self.idle {
            None => self.starts += starts,
            Some(idle) => {
                let gains = better.as_ref().is_some_and(|new| new.objective < before - GAIN);
                *idle = if gains { 0 } else { *idle + 1 };
                self.is_led_to |= better.is_some();
                ended.iter_mut().for_each(|end| end.starts = 0);
            }
        }
        self.best = better.or(self.best.take());
        ends.append(&mut ended);
    }

    /// Lets parts be taken after so many `starts`, if they `may`, and begins anew after those.
    pub(crate) fn go_on(&mut self, ends: &mut Vec<RefinedNetwork<D>>, starts: usize, may: bool) {
        match self.idle {
            None if self.starts >= starts && may && self.best.is_some() => self.idle = Some(0),
            Some(IDLE..) => self.end(ends),
            _ => {}
        }
    }

    /// Ends the round: what parts led to is the end of one start.
    pub(crate) fn end(&mut self, ends: &mut Vec<RefinedNetwork<D>>) {
        if let (true, Some(best)) = (self.is_led_to, self.best.take()) {
            ends.push(RefinedNetwork { starts: 1, ..best });
        }
        *self = Round::default();
    }
}

#[cfg(test)]
mod tests {
    use super::{IDLE, Round, part_of};
    use crate::accuracy::cramer_rao;
    use crate::align::align;
    use crate::calibrate::{CalibrateOptions, calibrate};
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::refine::RefinedNetwork;
    use crate::simulate::{Layout, SimulateOptions, simulate};

    fn end(objective: f64) -> RefinedNetwork<2> {
        RefinedNetwork { network: random(6, 4, 1), scale: 1.0, objective, starts: 1 }
    }

    #[test]
    fn parts_have_some_of_the_nodes_where_they_were() {
        let network: Network<3> = random(20, 30, 1);
        let mut with_transmitters = 0;
        for index in 0..40 {
            let part = part_of(&network, index, 7);
            assert_eq!(part, part_of(&network, index, 7));
            assert!(part.receivers.iter().zip(&network.receivers).all(|(a, b)| a.is_none_or(|a| a == *b)));
            let left = part.receivers.iter().flatten().count();
            assert!((6..=20).contains(&left), "{left}");
            with_transmitters += usize::from(part.transmitters.iter().any(Option::is_some));
        }
        assert!((10..=30).contains(&with_transmitters), "{with_transmitters}");
    }

    #[test]
    fn a_round_ends_where_parts_lead_no_further() {
        let mut round = Round::default();
        let mut ends = Vec::new();
        round.take(&mut ends, vec![end(5.0), end(3.0)], 16);
        round.go_on(&mut ends, 32, true);
        assert!(round.shaken().is_none(), "after 32 starts");
        round.take(&mut ends, vec![end(4.0)], 16);
        round.go_on(&mut ends, 32, false);
        assert!(round.shaken().is_none(), "enough starts agree");
        round.go_on(&mut ends, 32, true);
        assert!(round.shaken().is_some());
        for objective in [1.0, 2.0, 3.0] {
            assert!(round.shaken().is_some());
            round.take(&mut ends, vec![end(objective)], 16);
            round.go_on(&mut ends, 32, true);
        }
        assert_eq!(IDLE, 2);
        assert!(round.shaken().is_none());
        // Three starts of their own, three from parts, and what these led to as the end of one.
        let starts: Vec<(f64, usize)> = ends.iter().map(|end| (end.objective, end.starts)).collect();
        assert_eq!(starts, [(5.0, 1), (3.0, 1), (4.0, 1), (1.0, 0), (2.0, 0), (3.0, 0), (1.0, 1)]);
    }

    #[test]
    fn a_network_is_found_among_a_fifth_of_gross_errors() {
        for seed in 0..2 {
            let mut options = SimulateOptions::<3>::new();
            (options.receivers, options.transmitters) = (8, 40);
            (options.noise, options.outliers, options.seed) = (0.01, 0.2, seed);
            options.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            let made = simulate(&options).unwrap();
            let mut options = CalibrateOptions::<3>::new();
            options.sigma = Some(0.01);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let receivers: Vec<[f64; 3]> = found.receivers.iter().map(|r| r.unwrap()).collect();
            let error = align(&receivers, &made.network.receivers, false).unwrap().rms;
            let bound = cramer_rao(&made.pseudoranges, &made.outliers, &made.network, 0.01);
            assert!(error < 3.0 * bound, "seed {seed}: {error} {bound}");
        }
    }
}
