//! A delay of every receiver that nobody asked for: as of clocks that were started apart, where errors of some are less likely.

use crate::calibrate::judge::neighbours::{Neighbour, Reason};
use crate::calibrate::options::CalibrateError;
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind, price};
use crate::calibrate::receivers::take_out::Estimated;
use crate::calibrate::search::same_network::merged;
use crate::calibrate::search::truncated_cost::truncated_cost;
use crate::calibrate::state::State;
use crate::network::Network;
use crate::observations::{Observation, Observations};
use crate::refine::{RefinedNetwork, log_density};

/// Networks whose delays are estimated where all receivers have one.
const CANDIDATES: usize = 10;

/// Receivers above which delays of all are not tried unasked: the work grows with their cube.
const MOST_RECEIVERS: usize = 50;

/// Measurements that must be left over for delays of all receivers that nobody asked for.
const LEAST_REDUNDANCY: usize = 10;

impl<const D: usize> State<'_, D> {
    /// Takes these delays of all receivers but the first out, each with the network that they were estimated with, the best
    /// first.
    fn take_delays(&mut self, all: Vec<Estimated<D>>) {
        let receivers = self.measured.receivers();
        // They were apart only for as long as the delays were wrong.
        let all = merged(all, |(_, refined, _)| refined);
        let (mut taken, _, deviation) = all[0].clone();
        let mean = taken.iter().map(|fault| fault.size[0]).sum::<f64>() / receivers as f64;
        taken.insert(0, delay(0, 0.0));
        for fault in &mut taken {
            fault.size[0] -= mean;
        }
        self.observations = Observations::new(&self.corrected(&taken), |_, _| true).with_other_unknowns(receivers - 1);
        self.ranked = all.into_iter().map(|(_, refined, _)| refined).collect();
        for refined in &mut self.ranked {
            for offset in refined.network.offsets.iter_mut() {
                *offset += mean;
            }
        }
        (self.taken, self.deviation) = (taken, deviation);
    }

    /// Takes a delay of every receiver out where that makes the measurements likelier than the errors of some that are
    /// taken out so far, each at its price; where it nearly does, its network is a neighbour. `before` are the networks
    /// without anything taken out.
    pub(crate) fn prefer_delays_of_all(&mut self, before: &[RefinedNetwork<D>]) -> Result<(), CalibrateError<D>> {
        let receivers = self.measured.receivers();
        if self.measured.are_ranges() || self.measured.unknown_clocks().is_some() {
            // The delay of the first receiver is none of the others' then, or they are unknown anyway.
            return Ok(());
        }
        let unknown: Vec<Fault<D>> = (1..receivers).map(|i| delay(i, 0.0)).collect();
        let whole = self.observe(&unknown);
        if !(2..=MOST_RECEIVERS).contains(&receivers) || whole.len() < whole.unknowns() + LEAST_REDUNDANCY {
            return Ok(());
        }
        let (width, of_network) = (before[0].network.size(), whole.unknowns() - unknown.len());
        // What is left out of a receiver that was moved says nothing of its delay.
        let is_used =
            |o: &Observation| self.observations.of_transmitter(o.transmitter).iter().any(|p| p.receiver == o.receiver);
        let density = |observations: &Observations<D>, network: &Network<D>, deviation: f64| {
            let used = observations.all().iter().filter(|o| is_used(o));
            let residuals: Vec<(f64, f64)> = used.map(|o| (o.residual(network), o.precision)).collect();
            log_density(&residuals, of_network, deviation, self.known, width)
        };
        let price = |errors: usize, are_delays_of_all: bool| price(errors, are_delays_of_all, receivers, whole.len());
        let some =
            density(&self.observations, &self.ranked[0].network, self.deviation) - price(self.taken.len(), false);
        let with_delays = |of: &RefinedNetwork<D>| self.estimate(of.clone(), self.deviation, unknown.clone());
        let (faults, refined, deviation) = with_delays(&before[0])?;
        let lead = density(&self.observe(&faults), &refined.network, deviation) - price(faults.len(), true) - some;
        if lead <= 0.0 {
            // Nearly as likely, they are another answer.
            if -lead <= self.options.alternative_margin {
                let reason = Reason::Delays { deviation };
                self.neighbours.extend(Neighbour::new(&refined.network, -lead, reason, &self.ranked[0].network));
            }
            return Ok(());
        }
        let mut all = vec![(faults, refined, deviation)];
        for other in before.iter().take(CANDIDATES).skip(1) {
            all.push(with_delays(other)?);
        }
        self.rank_by_cost(&mut all);
        self.left.clear();
        self.take_delays(all);
        Ok(())
    }

    /// Sorts networks, each with its errors, by the truncated cost with the smallest deviation that
    /// one of them leaves: with deviations of their own the one that fits worst would look best.
    fn rank_by_cost(&self, all: &mut [Estimated<D>]) {
        let least = all.iter().map(|(.., deviation)| *deviation).fold(f64::INFINITY, f64::min);
        let deviation = self.known.unwrap_or(least).max(self.floor);
        for (faults, refined, _) in all.iter_mut() {
            refined.objective = truncated_cost(&self.observe(faults), &refined.network, deviation);
        }
        all.sort_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
    }
}

/// A delay of a receiver, metres.
fn delay<const D: usize>(receiver: usize, size: f64) -> Fault<D> {
    let mut fault = Fault::new(receiver, ReceiverErrorKind::Delay, 0);
    fault.size[0] = size;
    fault
}

#[cfg(test)]
mod tests {
    use crate::align::align;
    use crate::bordered::Bordered;
    use crate::points::{dot, minus};
    use crate::{
        CalibrateOptions, Calibration, Layout, ReceiverClocks, ReceiverDelays, SimulateOptions, calibrate, simulate,
    };

    /// With errors of receivers taken out, and with an unknown clock of each.
    fn ways() -> [CalibrateOptions<3>; 2] {
        let [mut auto, mut clocks] = [CalibrateOptions::<3>::new(), CalibrateOptions::<3>::new()];
        auto.receiver_delays = ReceiverDelays::Auto;
        clocks.clocks.receivers = ReceiverClocks::Offset;
        [auto, clocks]
    }

    #[test]
    fn delays_of_all_are_told_from_errors_of_some() {
        for seed in 0..4 {
            let mut options = SimulateOptions::<3>::new();
            (options.receivers, options.transmitters, options.noise, options.seed) = (10, 40, 0.01, seed);
            options.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            let run = |delays: f64, way: &CalibrateOptions<3>| {
                let made = simulate(&SimulateOptions { delays, ..options.clone() }).unwrap();
                let found = calibrate(&made.pseudoranges, way).unwrap();
                let receivers: Vec<[f64; 3]> = found.receivers.iter().flatten().copied().collect();
                (found, align(&receivers, &made.network.receivers, false).unwrap().rms)
            };
            let [auto, clocks] = ways();
            let (found, error) = run(0.1, &auto);
            let (_, known) = run(0.1, &clocks);
            assert!(found.receiver_errors.len() == 10 && found.receiver_errors.iter().all(|e| e.taken_out), "{seed}");
            assert!(
                found.warnings.iter().any(|warning| warning.contains("all receivers seem to have delays")),
                "{seed}"
            );
            assert!(error < 1.1 * known, "seed {seed}: {error} {known}");
            assert!(run(0.0, &auto).0.receiver_errors.is_empty(), "seed {seed}");
        }
    }

    /// Delays of five times the noise, most of which the geometry takes up: those of some receivers seem enough.
    #[test]
    fn ellipsoids_reach_the_network_with_delays_of_all_where_these_are_nearly_as_likely() {
        for seed in [1, 11] {
            let mut made = SimulateOptions::<3>::new();
            (made.receivers, made.transmitters, made.noise, made.delays, made.seed) = (10, 30, 0.01, 0.05, seed);
            made.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            let made = simulate(&made).unwrap();
            let [some, all] = ways().map(|options| calibrate(&made.pseudoranges, &options).unwrap());
            let places = |of: &Calibration<3>| of.receivers.iter().flatten().copied().collect::<Vec<_>>();
            assert!(some.receiver_errors.len() < 10, "seed {seed}");
            let (near, far) = (places(&some), places(&all));
            let onto = align(&far, &near, false).unwrap().transform;
            for (i, (p, q)) in near.iter().zip(&far).enumerate() {
                let off = minus(onto.apply(*q), *p);
                let rows = some.trusted_covariances()[0][i].unwrap();
                let factor = Bordered { rows, border: [0.0; 3], corner: 1.0 }.cholesky(1.0, 0.0).unwrap();
                let square = dot(off, factor.solve((off, 0.0)).0);
                // A thousandth for what the two runs differ in the last steps.
                assert!(square.sqrt() < 1.001 * some.ellipse_radius.unwrap(), "seed {seed}, receiver {i}: {square}");
            }
        }
    }
}
