//! Receivers that were moved: two places, one up to a transmitter and another from that transmitter
//! on.

use crate::calibrate::judge::weak_nodes::{BY_CHANCE, agree_by_chance};
use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind};
use crate::calibrate::receivers::refits::{Fitting, Refit};
use crate::calibrate::receivers::score_test::{SIDE, tests};
use crate::calibrate::receivers::significance::least_surprise;
use crate::calibrate::search::truncated_cost::{refit, truncated};
use crate::loss::{Loss, SEARCH_NU};
use crate::median::median;
use crate::multilateration::{Sight, receiver as locate};
use crate::network::Network;
use crate::observations::Observation;
use crate::points::{distance, minus};
use hc::Monitor;

/// Transmitters from which on a receiver may stand elsewhere, that are tried.
const TRIED: usize = 24;

/// What a receiver measured, as distances from the transmitters, in their order.
struct Sights<const D: usize> {
    transmitters: Vec<usize>,
    all: Vec<Sight<D>>,
    deviation: f64,
}

/// Two places of a receiver.
struct Split<const D: usize> {
    /// Place in the list of its measurements of the first after the move.
    at: usize,
    places: [[f64; D]; 2],
    cost: f64,
}

impl<const D: usize> Sights<D> {
    /// Where a part of the measurements puts the receiver, and their truncated cost there.
    fn place(&self, part: &[Sight<D>]) -> Option<([f64; D], f64)> {
        let loss = Loss { nu: SEARCH_NU, scale: 3.0 * self.deviation };
        let position = locate(part, &loss)?.position;
        let cost = |s: &Sight<D>| {
            let e = (s.length - distance(s.position, position)) * s.precision;
            truncated(e / self.deviation)
        };
        Some((position, part.iter().map(cost).sum()))
    }

    fn split(&self, at: usize) -> Option<Split<D>> {
        let (before, after) = (self.place(&self.all[..at])?, self.place(&self.all[at..])?);
        Some(Split { at, places: [before.0, after.0], cost: before.1 + after.1 })
    }

    /// The best split: of some evenly spaced ones, and of those around the best of these.
    fn best(&self, monitor: &Monitor) -> Result<Option<Split<D>>, CalibrateError<D>> {
        let (first, last) = (SIDE, (self.all.len() + 1).saturating_sub(SIDE));
        let step = last.saturating_sub(first).div_ceil(TRIED).max(1);
        let coarse = self.best_of((first..last).step_by(step), monitor)?;
        let Some(at) = coarse.as_ref().map(|split| split.at).filter(|_| step > 1) else { return Ok(coarse) };
        self.best_of((at + 1).saturating_sub(step).max(first)..(at + step).min(last), monitor)
    }

    fn best_of(
        &self,
        all: impl Iterator<Item = usize>,
        monitor: &Monitor,
    ) -> Result<Option<Split<D>>, CalibrateError<D>> {
        let mut best: Option<Split<D>> = None;
        for at in all {
            check(monitor)?;
            let split = self.split(at).filter(|split| best.as_ref().is_none_or(|other| split.cost < other.cost));
            best = split.or(best);
        }
        Ok(best)
    }
}

impl<const D: usize> Fitting<'_, D> {
    fn sights(&self, receiver: usize, network: &Network<D>) -> Sights<D> {
        let own: Vec<&Observation> = self.observations.of_receiver(receiver).collect();
        let sight = |o: &&Observation| Sight {
            position: network.transmitters[o.transmitter],
            length: o.length(network),
            precision: o.precision,
        };
        Sights {
            transmitters: own.iter().map(|o| o.transmitter).collect(),
            all: own.iter().map(sight).collect(),
            deviation: self.deviation,
        }
    }

    /// Whether two places cost less than one by a share of what is no chance.
    fn pays(&self, sights: &Sights<D>, split: &Split<D>, share: f64) -> bool {
        let least = 0.5 * least_surprise(tests(ReceiverErrorKind::Move, self.observations.receivers, sights.all.len()));
        sights.place(&sights.all).is_none_or(|(_, cost)| cost - split.cost >= share * least)
    }

    /// Whether two places of a receiver among all others, where `network` has them, cost less than one by this share of what
    /// is no chance.
    pub(crate) fn shows_move(
        &self,
        receiver: usize,
        network: &Network<D>,
        share: f64,
    ) -> Result<bool, CalibrateError<D>> {
        let sights = self.sights(receiver, network);
        Ok(sights.best(self.monitor)?.is_some_and(|split| self.pays(&sights, &split, share)))
    }

    /// The move of a receiver that fits best, as two receivers beside the network of all others.
    /// `None` where one of its places may be chance.
    pub(crate) fn moved(&self, receiver: usize, alone: &Network<D>) -> Result<Option<Refit<D>>, CalibrateError<D>> {
        let own: Vec<_> = self.observations.of_receiver(receiver).collect();
        let sights = self.sights(receiver, alone);
        let Some(split) = sights.best(self.monitor)? else { return Ok(None) };
        // Two places have to cost less than one, before all nodes are fitted to them.
        if !self.pays(&sights, &split, 1.0) {
            return Ok(None);
        }
        let from = sights.transmitters[split.at];
        let observations = self.observations.split(receiver, from);
        let mut network = alone.clone();
        network.receivers[receiver] = split.places[0];
        network.receivers.push(split.places[1]);
        network.clocks.extend(alone.clocks.get(receiver));
        let (mut network, _) = refit(&observations, &network, self.deviation, self.monitor)?;
        let rows = [receiver, observations.receivers - 1];
        let unit = median(own.iter().map(|o| 1.0 / o.precision).collect()).unwrap_or(1.0);
        let width = 2.0 * self.limit * self.deviation * unit / network.size().max(f64::MIN_POSITIVE);
        let may_be_chance = |&row: &usize| {
            let part = observations.of_receiver(row);
            let all = part.len();
            let inliers = part.filter(|o| o.residual(&network).abs() <= self.limit * self.deviation).count();
            self.observations.receivers as f64 * agree_by_chance::<D>(all, inliers, width) > BY_CHANCE
        };
        if rows.iter().any(may_be_chance) {
            return Ok(None);
        }
        let Some((gain, freedom)) = self.gain(&observations, &network, &rows, None)? else { return Ok(None) };
        let Some(after) = network.receivers.pop() else { return Ok(None) };
        network.clocks.truncate(self.observations.receivers);
        let before = network.receivers[receiver];
        // The network that the longer part leaves.
        if 2 * split.at < sights.all.len() {
            network.receivers[receiver] = after;
        }
        let size = minus(after, before);
        let fault = Fault { size, gain, ..Fault::new(receiver, ReceiverErrorKind::Move, from) };
        Ok(Some(Refit { fault, network, freedom, lead: 0.0 }))
    }
}

#[cfg(test)]
mod tests {
    use crate::align::align;
    use crate::{
        CalibrateOptions, Calibration, MovedPlace, Pseudoranges, ReceiverDelays, ReceiverErrorKind, ReceiverFault,
        SimulateOptions, Simulation, calibrate, simulate,
    };

    const SIGMA: f64 = 0.01;

    fn simulation(receivers: usize, fault: Option<ReceiverFault>, outliers: f64, seed: u64) -> Simulation {
        let options =
            SimulateOptions { receivers, transmitters: 20, noise: SIGMA, fault, outliers, seed, ..Default::default() };
        simulate(&options).unwrap()
    }

    /// With a clock of the first receiver that jumps half-way.
    fn jumping(receivers: usize, size: f64, seed: u64) -> Simulation {
        let mut simulation = simulation(receivers, None, 0.0, seed);
        let mut values = simulation.pseudoranges.dense();
        values[10..20].iter_mut().for_each(|value| *value += size);
        simulation.pseudoranges = Pseudoranges::new(receivers, 20, values).unwrap();
        simulation
    }

    fn run(simulation: &Simulation, handling: ReceiverDelays, seed: u64) -> Calibration {
        let options = CalibrateOptions { receiver_delays: handling, seed, ..Default::default() };
        calibrate(&simulation.pseudoranges, &options).unwrap()
    }

    /// Where the first receiver is in the frame of the truth, by the other receivers.
    fn first_receiver(found: &Calibration, truth: &Simulation) -> [f64; 2] {
        let receivers: Vec<[f64; 2]> = found.receivers.iter().map(|p| p.unwrap()).collect();
        align(&receivers[1..], &truth.network.receivers[1..], false).unwrap().transform.apply(receivers[0])
    }

    #[test]
    fn the_stated_place_is_the_one_given() {
        // In networks like that of seed 109 other measurements were given up for the smaller move.
        for (size, seeds) in [(1.0, 0..6), (0.3, 106..112)] {
            for seed in seeds {
                let simulation = simulation(10, Some(ReceiverFault::Move(size)), 0.0, seed);
                let found = run(&simulation, ReceiverDelays::Auto, seed);
                let [error] = &found.receiver_errors[..] else { panic!("seed {seed}: {:?}", found.receiver_errors) };
                assert_eq!((error.receiver.as_str(), error.kind), ("r1", ReceiverErrorKind::Move), "seed {seed}");
                // Each place has an error of about the noise.
                assert!((error.size - size).abs() < 6.0 * SIGMA, "seed {seed}: {}", error.size);
                let mut truth = simulation.network.receivers[0];
                match error.place {
                    Some(MovedPlace::After) => truth[0] += size,
                    place => assert_eq!(place, Some(MovedPlace::Before)),
                }
                let at = first_receiver(&found, &simulation);
                assert!((at[0] - truth[0]).hypot(at[1] - truth[1]) < 6.0 * SIGMA, "seed {seed}: {at:?}, {truth:?}");
                let place = if error.place == Some(MovedPlace::After) { "after" } else { "before" };
                let told = format!("its position here is the one {place} the move");
                assert!(found.warnings.iter().any(|warning| warning.contains(&told)), "{:?}", found.warnings);
                assert!(found.unique);
                let left = run(&simulation, ReceiverDelays::None, seed);
                assert!(!left.unique && left.receiver_errors[0].kind == ReceiverErrorKind::Move, "seed {seed}");
                assert_eq!(left.receiver_errors[0].place, None);
            }
        }
    }

    #[test]
    fn gross_errors_are_no_move() {
        for seed in 108..112 {
            let simulation = simulation(25, None, 0.3, seed);
            let found = run(&simulation, ReceiverDelays::None, seed);
            assert!(found.receiver_errors.is_empty() && found.unique, "seed {seed}: {:?}", found.receiver_errors);
        }
    }

    #[test]
    fn a_jump_has_no_second_error_beside_it() {
        let networks = (0..6).map(|seed| (10, 0.3, seed)).chain([(8, 0.1, 108), (10, 0.1, 1)]);
        for (receivers, size, seed) in networks {
            let simulation = jumping(receivers, size, seed);
            let found = run(&simulation, ReceiverDelays::Auto, seed);
            let [error] = &found.receiver_errors[..] else { panic!("seed {seed}: {:?}", found.receiver_errors) };
            assert_eq!((error.receiver.as_str(), error.kind), ("r1", ReceiverErrorKind::Jump), "seed {seed}");
            assert!((error.size - size).abs() < 6.0 * SIGMA, "seed {seed}: {}", error.size);
        }
    }

    #[test]
    fn deviations_hold_an_error_that_was_left_in() {
        for seed in 100..112 {
            for size in [0.05, 0.1] {
                let simulation = jumping(10, size, seed);
                let found = run(&simulation, ReceiverDelays::None, seed);
                let at = first_receiver(&found, &simulation);
                let truth = simulation.network.receivers[0];
                let std = found.receiver_std[0].unwrap();
                let error = (at[0] - truth[0]).hypot(at[1] - truth[1]);
                // A little more than three deviations of a point: it is seen from the other receivers.
                assert!(error < 4.0 * std[0].hypot(std[1]), "seed {seed}, {size} m: {error} {std:?}");
                assert!(!found.receiver_errors.is_empty() || error < 0.05, "seed {seed}");
            }
        }
    }
}
