//! A delay of every receiver, as of clocks that were started apart, estimated together with the network.

use crate::calibrate::input::middle_delays::middle_delays;
use crate::calibrate::judge::neighbours::{Neighbour, Reason};
use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind, price};
use crate::calibrate::receivers::take_out::{Estimated, STEPS, moved};
use crate::calibrate::search::deviation::{inlier_deviation, spread_of_residuals};
use crate::calibrate::search::same_network::merged;
use crate::calibrate::search::truncated_cost::{annealed, truncated_cost};
use crate::calibrate::state::State;
use crate::loss::CAUCHY;
use crate::network::Network;
use crate::observations::{Observation, Observations};
use crate::refine::{NetworkRefiner, RefineOptions, RefinedNetwork, SEARCH, log_density};

/// Networks whose delays are estimated to the end where all receivers have one.
const CANDIDATES: usize = 10;

/// Deviations, in those that the residuals have, at which such a network is fitted by least squares at first, and
/// where measurements are still given up after that.
const WIDEST: [f64; 2] = [10.0, 100.0];

/// Receivers above which delays of all are not tried unasked: the work grows with their cube.
const MOST_RECEIVERS: usize = 50;

/// Measurements that must be left over for delays of all receivers that nobody asked for.
const LEAST_REDUNDANCY: usize = 10;

/// Steps of bringing a network and the delays of all receivers near their best fit.
const COARSE: usize = 24;

impl<const D: usize> State<'_, D> {
    /// Takes a delay of every receiver out, relative to their mean, for each of the best networks on its own.
    pub(crate) fn take_out_all(&mut self) -> Result<(), CalibrateError<D>> {
        let receivers = self.measured.receivers();
        let middle = middle_delays(&self.measured);
        // The mean of all delays cannot be told from the offsets.
        let unknown: Vec<Fault<D>> = (1..receivers).map(|i| delay(i, middle[i] - middle[0])).collect();
        // The search took the first receiver's too: what it says of offsets lacks that.
        let networks = std::mem::take(&mut self.ranked).into_iter().map(|mut refined| {
            refined.network.offsets.iter_mut().for_each(|offset| *offset += middle[0]);
            refined
        });
        let (measurements, unknowns) = (self.observations.len(), self.observations.unknowns() + unknown.len());
        if measurements < unknowns {
            return Err(CalibrateError::Delays { measurements, unknowns, receivers });
        }
        let mut near = Vec::new();
        for candidate in networks {
            near.push(self.approach(candidate, unknown.clone())?);
        }
        self.rank_by_cost(&mut near);
        let mut all = Vec::new();
        for candidate in near.into_iter().take(CANDIDATES) {
            let (faults, refined, deviation) = self.relaxed(candidate)?;
            all.push(self.estimate(refined, deviation, faults)?);
        }
        // One that has run away fits what few measurements it has left.
        let (sound, lost): (Vec<_>, Vec<_>) = all.into_iter().partition(|estimated| self.is_left_over(estimated));
        let mut all = if sound.is_empty() { lost } else { sound };
        self.rank_by_cost(&mut all);
        self.take_delays(all);
        Ok(())
    }

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
        if self.measured.are_ranges() {
            // The delay of the first receiver is none of the others' then.
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

    /// Sizes of errors and a network brought near their best fit, with the deviation that is left:
    /// the loss is as wide as the residuals, which are those of wrong sizes at first.
    fn approach(
        &self,
        mut best: RefinedNetwork<D>,
        mut faults: Vec<Fault<D>>,
    ) -> Result<Estimated<D>, CalibrateError<D>> {
        let least = self.known.unwrap_or(self.floor);
        let mut deviation = least;
        for _ in 0..COARSE {
            check(self.monitor)?;
            let observations = self.observe(&faults);
            deviation = spread_of_residuals(&observations, &best.network).max(least);
            let refine = RefineOptions { scale: Some(CAUCHY * deviation), steps: 8, rounds: 1, ..SEARCH };
            let refined = NetworkRefiner::new(&observations, 1.0, self.monitor).refine(best.network, &refine);
            best = RefinedNetwork { starts: best.starts, ..refined };
            let wide = inlier_deviation(&observations, &best.network, deviation, self.options.inlier_threshold);
            let Some(steps) = self.step(&observations, &best.network, wide, &faults)? else { break };
            if moved(&mut faults, steps) < 1e-2 * deviation {
                break;
            }
        }
        Ok((faults, best, deviation))
    }

    /// Errors and network fitted by least squares, at first over measurements that were given up too: a network may
    /// have bent itself to a wrong delay. What it was, where that costs less.
    fn relaxed(&self, near: Estimated<D>) -> Result<Estimated<D>, CalibrateError<D>> {
        let deviation = near.2;
        let cost =
            |(faults, refined, _): &Estimated<D>| truncated_cost(&self.observe(faults), &refined.network, deviation);
        let gives_up = |(faults, refined, _): &Estimated<D>| {
            let reach = self.options.inlier_threshold * deviation;
            self.observe(faults).all().iter().any(|o| o.residual(&refined.network).abs() > reach)
        };
        let mut best = near.clone();
        for widest in WIDEST {
            let next = self.narrowed(near.clone(), annealed(widest))?.filter(|next| cost(next) < cost(&best));
            best = next.unwrap_or(best);
            if !gives_up(&best) {
                break;
            }
        }
        Ok(best)
    }

    /// Least squares over the inliers of so many deviations one after the other; `None` where the
    /// errors are not determined.
    fn narrowed(&self, from: Estimated<D>, factors: &[f64]) -> Result<Option<Estimated<D>>, CalibrateError<D>> {
        let (mut faults, mut refined, deviation) = from;
        for factor in factors {
            for _ in 0..STEPS {
                check(self.monitor)?;
                let observations = self.observe(&faults);
                let wide = factor * deviation;
                let reach = self.options.inlier_threshold * wide;
                let inliers = observations.subset(|o| o.residual(&refined.network).abs() <= reach);
                let refine = RefineOptions { scale: Some(wide), steps: 8, rounds: 0, ..SEARCH };
                let mut refiner = NetworkRefiner::new(&inliers, f64::INFINITY, self.monitor);
                refined.network = refiner.refine(refined.network, &refine).network;
                let Some(steps) = self.step(&observations, &refined.network, wide, &faults)? else { return Ok(None) };
                if moved(&mut faults, steps) < 1e-2 * deviation {
                    break;
                }
            }
        }
        Ok(Some((faults, refined, deviation)))
    }

    /// Whether a network has more inliers than unknowns.
    fn is_left_over(&self, (faults, refined, deviation): &Estimated<D>) -> bool {
        let observations = self.observe(faults);
        let reach = self.options.inlier_threshold * deviation;
        let inliers = observations.all().iter().filter(|o| o.residual(&refined.network).abs() <= reach).count();
        refined.network.is_finite() && inliers > observations.unknowns()
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
    use super::{Fault, ReceiverErrorKind, State};
    use crate::align::align;
    use crate::bordered::Bordered;
    use crate::points::{dot, minus};
    use crate::refine::RefinedNetwork;
    use crate::{CalibrateOptions, Calibration, Layout, ReceiverDelays, SimulateOptions, calibrate, simulate};
    use hc::Monitor;

    /// Whether exact measurements of seven receivers are more than the unknowns, with a delay of each receiver but
    /// one beside the network.
    fn is_left_over<const D: usize>(transmitters: usize) -> bool {
        let mut made = SimulateOptions::<D>::new();
        (made.receivers, made.transmitters) = (7, transmitters);
        let made = simulate(&made).unwrap();
        let options = CalibrateOptions::<D>::new();
        let monitor = Monitor::default();
        let state = State::new(made.pseudoranges, None, &options, &monitor);
        let faults: Vec<Fault<D>> = (1..7).map(|i| Fault::new(i, ReceiverErrorKind::Delay, 0)).collect();
        assert_eq!(state.observations.unknowns(), D * 7 + (D + 1) * transmitters - D * (D + 1) / 2);
        let refined = RefinedNetwork { network: made.network, scale: 1.0, objective: 0.0, starts: 1 };
        state.is_left_over(&(faults, refined, 1e-3))
    }

    #[test]
    fn unknowns_are_those_of_the_dimension() {
        // 7r/n in the plane: 7 n measurements for 17 + 3 n unknowns. In space: for 21 + 4 n.
        assert_eq!([4, 5].map(is_left_over::<2>), [false, true]);
        assert_eq!([5, 6, 7, 8].map(is_left_over::<3>), [false, false, false, true]);
    }

    #[test]
    fn delays_of_all_are_told_from_errors_of_some() {
        for seed in 0..4 {
            let mut options = SimulateOptions::<3>::new();
            (options.receivers, options.transmitters, options.noise, options.seed) = (10, 40, 0.01, seed);
            options.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            let run = |delays: f64, receiver_delays: ReceiverDelays| {
                let made = simulate(&SimulateOptions { delays, ..options.clone() }).unwrap();
                let options = CalibrateOptions { receiver_delays, ..CalibrateOptions::<3>::new() };
                let found = calibrate(&made.pseudoranges, &options).unwrap();
                let receivers: Vec<[f64; 3]> = found.receivers.iter().flatten().copied().collect();
                (found, align(&receivers, &made.network.receivers, false).unwrap().rms)
            };
            let (found, error) = run(0.1, ReceiverDelays::Auto);
            let (_, known) = run(0.1, ReceiverDelays::All);
            assert!(found.receiver_errors.len() == 10 && found.receiver_errors.iter().all(|e| e.taken_out), "{seed}");
            assert!(
                found.warnings.iter().any(|warning| warning.contains("all receivers seem to have delays")),
                "{seed}"
            );
            assert!(error < 1.1 * known, "seed {seed}: {error} {known}");
            assert!(run(0.0, ReceiverDelays::Auto).0.receiver_errors.is_empty(), "seed {seed}");
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
            let found = |receiver_delays| {
                let options = CalibrateOptions { receiver_delays, ..CalibrateOptions::<3>::new() };
                calibrate(&made.pseudoranges, &options).unwrap()
            };
            let places = |of: &Calibration<3>| of.receivers.iter().flatten().copied().collect::<Vec<_>>();
            let (some, all) = (found(ReceiverDelays::Auto), found(ReceiverDelays::All));
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
