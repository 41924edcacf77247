//! How near a network comes to the truth, and how near the noise lets any estimate come.

use crate::align::align;
use crate::clocks::Clocks;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::spread;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{Projection, covariance, dot, gram};
use faer::Mat;
use faer::linalg::solvers::Solve;
use hc::Monitor;

/// The Cramer-Rao bound for a network's receivers, in metres: the root mean square over the
/// receivers of the smallest standard deviation that any unbiased estimate can have, after the best
/// rigid alignment.
///
/// `truth` is the true network and `noise` the standard deviation of the measurements in metres.
/// Measurements marked in `outliers` (row-major, one entry per cell) do not count. The bound is
/// infinite if the other measurements do not determine every receiver.
///
/// # Panics
/// If the sizes of network, measurements and outliers differ.
pub fn cramer_rao<const D: usize>(measured: &Pseudoranges, outliers: &[bool], truth: &Network<D>, noise: f64) -> f64 {
    bound(&without(measured, outliers).at_deviation(noise), truth, noise)
}

/// [`cramer_rao`] with what is unknown of the clocks of transmitters and recorders.
///
/// # Panics
/// If the sizes of network, measurements and outliers differ.
pub fn cramer_rao_with_clocks<const D: usize>(
    measured: &Pseudoranges,
    outliers: &[bool],
    truth: &Network<D>,
    noise: f64,
    clocks: &Clocks,
) -> f64 {
    cramer_rao(&clocks.of(measured), outliers, truth, noise)
}

/// [`cramer_rao`] with unknown delays in all measurements of these receivers, in metres.
///
/// `receivers` are rows of the matrix, each once. A delay common to all receivers cannot be told
/// from the offsets, so that at least one receiver has to be left out; the bound is infinite if
/// delays are not determined. The other unknowns are eliminated from the Fisher information (Kay
/// 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, chapter 3).
///
/// # Panics
/// If the sizes of network, measurements and outliers differ.
pub fn cramer_rao_with_delays<const D: usize>(
    measured: &Pseudoranges,
    outliers: &[bool],
    truth: &Network<D>,
    noise: f64,
    receivers: &[usize],
) -> f64 {
    let observations = without(measured, outliers);
    let plain = bound(&observations, truth, noise);
    let Some(projection) = Projection::new(&observations, truth, &Monitor::default()).ok().flatten() else {
        return f64::INFINITY;
    };
    // What no motion makes of the columns tells the delays; motions that do move the receivers with
    // these.
    let column = |receiver: usize| -> Vec<f64> {
        let part = |receives: bool, precision: f64| if receives { precision } else { 0.0 };
        observations.all().iter().map(|o| part(o.receiver == receiver, o.precision)).collect()
    };
    let columns: Vec<_> = receivers.iter().map(|&receiver| column(receiver)).collect();
    let parts: Vec<_> = columns.iter().map(|column| projection.off(column)).collect();
    let size = receivers.len();
    let Some(factor) = gram(&parts, &Monitor::default()).ok().flatten() else { return f64::INFINITY };
    // The square of what is left of a column beside the others is one over the diagonal of the inverse.
    let inverse = factor.solve(&Mat::<f64>::identity(size, size));
    let is_told = |a: usize| 1e-9 * inverse[(a, a)] * dot(&columns[a], &columns[a]) < 1.0;
    if !(0..size).all(is_told) {
        return f64::INFINITY;
    }
    let pairs = (0..size).flat_map(|a| (0..size).map(move |b| (a, b)));
    let coordinates = |a: usize| &parts[a].1.reduced[..D * truth.receivers.len()];
    let of_receivers = |a: usize, b: usize| dot(coordinates(a), coordinates(b));
    let added: f64 = pairs.map(|(a, b)| inverse[(a, b)] * of_receivers(a, b)).sum();
    (plain * plain + noise * noise * added / truth.receivers.len() as f64).sqrt()
}

/// The measurements that are no outliers.
fn without<const D: usize>(measured: &Pseudoranges, outliers: &[bool]) -> Observations<D> {
    let n = measured.transmitters();
    Observations::new(measured, |i, j| !outliers[i * n + j])
}

fn bound<const D: usize>(observations: &Observations<D>, truth: &Network<D>, noise: f64) -> f64 {
    let Some(found) = covariance(observations, truth, noise, &Monitor::default())
        .ok()
        .flatten()
        .filter(|found| found.loose.is_empty())
    else {
        return f64::INFINITY;
    };
    let trace: f64 = found.receivers.iter().map(|c| (0..D).map(|k| c[k][k]).sum::<f64>()).sum();
    (trace / found.receivers.len() as f64).sqrt()
}

/// The relative error `|X^ - X| / |X - mean X|` of the positions X of all nodes, after the best
/// rigid alignment (reflection allowed). Infinite for networks of different sizes.
pub fn position_error<const D: usize>(found: &Network<D>, truth: &Network<D>) -> f64 {
    if found.receivers.len() != truth.receivers.len() {
        return f64::INFINITY;
    }
    let nodes = |n: &Network<D>| n.receivers.iter().chain(&n.transmitters).copied().collect::<Vec<_>>();
    let (found, truth) = (nodes(found), nodes(truth));
    align(&found, &truth, false).map_or(f64::INFINITY, |alignment| alignment.rms / spread(truth.iter()))
}

/// The relative error `|o^ - o| / |o|` of the offsets o. Infinite for networks of different sizes.
pub fn offset_error<const D: usize>(found: &Network<D>, truth: &Network<D>) -> f64 {
    if found.offsets.len() != truth.offsets.len() {
        return f64::INFINITY;
    }
    let difference: f64 = found.offsets.iter().zip(&truth.offsets).map(|(a, b)| (a - b).powi(2)).sum();
    (difference / truth.offsets.iter().map(|o| o * o).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{cramer_rao, cramer_rao_with_clocks, cramer_rao_with_delays, offset_error, position_error};
    use crate::align::align;
    use crate::clocks::{Clocks, ReceiverClocks};
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::observations::Observations;
    use crate::points::distance;
    use crate::pseudoranges::Pseudoranges;
    use crate::refine::{NetworkRefiner, RefineOptions, SEARCH};
    use crate::simulate::{SimulateOptions, simulate};

    #[test]
    fn the_bound_grows_with_the_noise_and_with_what_is_left_out() {
        let options = SimulateOptions { receivers: 8, transmitters: 12, seed: 3, ..SimulateOptions::default() };
        let simulation = simulate(&options).unwrap();
        let bound =
            |outliers: &[bool], noise: f64| cramer_rao(&simulation.pseudoranges, outliers, &simulation.network, noise);
        let all = vec![false; 96];
        // The covariance is proportional to the variance of the noise.
        assert!((bound(&all, 0.02) / bound(&all, 0.01) - 2.0).abs() < 1e-9);
        let mut fewer = all.clone();
        fewer[..6].fill(true);
        assert!(bound(&fewer, 0.01) > bound(&all, 0.01) && bound(&fewer, 0.01).is_finite());
        // A receiver that hears nothing may be anywhere.
        fewer[..12].fill(true);
        assert_eq!(bound(&fewer, 0.01), f64::INFINITY);
    }

    /// Deviations of exact data's own estimate: each measurement is changed by a little, the network
    /// adjusted by least squares and aligned with the truth. The bound is the square root of the sum of
    /// squares of what all these changes do to the receivers, per receiver.
    fn is_what_least_squares_makes_of_noise<const D: usize>(m: usize, n: usize) {
        let truth: Network<D> = random(m, n, 11);
        let step = 1e-4;
        let options = RefineOptions { scale: Some(1.0), rounds: 0, steps: 100, tolerance: 0.0, ..SEARCH };
        let mut sum = 0.0;
        for k in 0..m * n {
            let [above, below] = [step, -step].map(|by| {
                let mut values = truth.pseudoranges();
                values[k] += by;
                let observations = Observations::new(&Pseudoranges::new(m, n, values).unwrap(), |_, _| true);
                let mut refiner = NetworkRefiner::new(&observations, f64::INFINITY, &hc::Monitor::default());
                let found = refiner.refine(truth.clone(), &options).network.receivers;
                let map = align(&found, &truth.receivers, false).unwrap().transform;
                found.into_iter().map(|p| map.apply(p)).collect::<Vec<_>>()
            });
            sum += above.iter().zip(&below).map(|(p, q)| (distance(*p, *q) / (2.0 * step)).powi(2)).sum::<f64>();
        }
        let measured = Pseudoranges::new(m, n, truth.pseudoranges()).unwrap();
        let bound = cramer_rao(&measured, &vec![false; m * n], &truth, 0.01);
        let expected = 0.01 * (sum / m as f64).sqrt();
        assert!((bound / expected - 1.0).abs() < 1e-3, "{bound} {expected}");
    }

    #[test]
    fn the_bound_is_what_least_squares_makes_of_noise() {
        is_what_least_squares_makes_of_noise::<2>(7, 8);
        is_what_least_squares_makes_of_noise::<3>(9, 10);
    }

    #[test]
    fn delays_cost_certainty_in_space() {
        let truth: Network<3> = random(9, 10, 11);
        let measured = Pseudoranges::new(9, 10, truth.pseudoranges()).unwrap();
        let outliers = vec![false; 90];
        let plain = cramer_rao(&measured, &outliers, &truth, 0.01);
        let with = |receivers: &[usize]| cramer_rao_with_delays(&measured, &outliers, &truth, 0.01, receivers);
        assert!(with(&[0]) > plain && with(&[0, 4]) > with(&[0]) && with(&[0, 4]).is_finite());
        let but = |one: usize| -> Vec<usize> { (0..9).filter(|&i| i != one).collect() };
        assert!((with(&but(0)) / with(&but(5)) - 1.0).abs() < 1e-6);
    }

    /// Clocks of all receivers that were started apart are delays of all but one.
    #[test]
    fn offsets_of_recorders_are_delays() {
        fn agree<const D: usize>(m: usize, n: usize) {
            let truth: Network<D> = random(m, n, 11);
            let measured = Pseudoranges::new(m, n, truth.pseudoranges()).unwrap();
            let outliers: Vec<bool> = (0..m * n).map(|k| k % 17 == 3).collect();
            let clocks = Clocks { receivers: ReceiverClocks::Offset, ..Clocks::default() };
            let with_clocks = cramer_rao_with_clocks(&measured, &outliers, &truth, 0.01, &clocks);
            let others: Vec<usize> = (1..m).collect();
            let with_delays = cramer_rao_with_delays(&measured, &outliers, &truth, 0.01, &others);
            assert!((with_clocks / with_delays - 1.0).abs() < 1e-6, "{with_clocks} {with_delays}");
            // Two receivers a recorder, and all of them on one.
            let names = |channels: usize| (0..m).map(|i| format!("rec{}", i / channels)).collect();
            let shared = |channels: usize| {
                let measured = measured.clone().with_recorders(names(channels)).unwrap();
                cramer_rao_with_clocks(&measured, &outliers, &truth, 0.01, &clocks)
            };
            let plain = cramer_rao(&measured, &outliers, &truth, 0.01);
            assert!(plain < shared(2) && shared(2) < with_clocks && (shared(m) / plain - 1.0).abs() < 1e-9);
            // Rates cost more.
            let rates = Clocks { receivers: ReceiverClocks::Rate, ..Clocks::default() };
            let bound = |measured: &Pseudoranges| cramer_rao_with_clocks(measured, &outliers, &truth, 0.01, &rates);
            let late = measured.map(|_, j, f| f + 1e4 * (j as f64).sin());
            assert!(bound(&late) > with_clocks && bound(&late).is_finite());
            // What is expected of clocks leads from one model to the other.
            let expecting = |offset_sigma: f64, rate_sigma: f64| {
                let (offset_sigma, rate_sigma) = (Some(offset_sigma), Some(rate_sigma));
                let clocks = Clocks { offset_sigma, rate_sigma, ..rates };
                cramer_rao_with_clocks(&late, &outliers, &truth, 0.01, &clocks)
            };
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-3;
            let least = cramer_rao(&late, &outliers, &truth, 0.01);
            assert!(close(expecting(1e4, 1.0), bound(&late)) && close(expecting(1e-6, 1e-12), least));
            assert!(close(expecting(1e4, 1e-12), with_clocks));
            let between = expecting(0.01, 1e-6);
            assert!(between > 1.001 * least && between < 0.999 * bound(&late), "{least} {between} {}", bound(&late));
        }
        agree::<2>(8, 12);
        agree::<3>(11, 16);
    }

    #[test]
    fn an_unknown_delay_costs_certainty() {
        let options = SimulateOptions { receivers: 8, transmitters: 12, seed: 3, ..SimulateOptions::default() };
        let simulation = simulate(&options).unwrap();
        let (measured, truth) = (&simulation.pseudoranges, &simulation.network);
        let mut outliers = vec![false; 96];
        let plain = cramer_rao(measured, &outliers, truth, 0.01);
        for receiver in 0..8 {
            let with =
                |noise: f64, receivers: &[usize]| cramer_rao_with_delays(measured, &outliers, truth, noise, receivers);
            let one = with(0.01, &[receiver]);
            assert!(one > plain && one.is_finite());
            assert!((with(0.02, &[receiver]) / one - 2.0).abs() < 1e-9);
            let two = with(0.01, &[receiver, (receiver + 3) % 8]);
            assert!(two > one && (with(0.01, &[(receiver + 3) % 8, receiver]) / two - 1.0).abs() < 1e-9);
        }
        // Delays of all receivers are told relative to one of them, whichever that is.
        let but = |one: usize| -> Vec<usize> { (0..8).filter(|&i| i != one).collect() };
        let all = [0, 5].map(|one| cramer_rao_with_delays(measured, &outliers, truth, 0.01, &but(one)));
        assert!((all[0] / all[1] - 1.0).abs() < 1e-6, "{all:?}");
        // Two measurements place a receiver, of which nothing is left over for a delay.
        outliers[..10].fill(true);
        assert!(cramer_rao(measured, &outliers, truth, 0.01).is_finite());
        assert_eq!(cramer_rao_with_delays(measured, &outliers, truth, 0.01, &[0]), f64::INFINITY);
    }

    #[test]
    fn errors_do_not_see_the_frame() {
        let truth = simulate(&SimulateOptions::default()).unwrap().network;
        let mut found = truth.clone();
        for p in found.receivers.iter_mut().chain(&mut found.transmitters) {
            *p = [3.0 - p[1], p[0] - 7.0];
        }
        for offset in &mut found.offsets {
            *offset *= 1.5;
        }
        assert!(position_error(&found, &truth) < 1e-14);
        assert!((offset_error(&found, &truth) - 0.5).abs() < 1e-14);
        found.receivers.pop();
        found.offsets.pop();
        assert_eq!((position_error(&found, &truth), offset_error(&found, &truth)), (f64::INFINITY, f64::INFINITY));
    }
}
