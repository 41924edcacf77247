//! Tests of the sampled covariance.

use super::*;
use crate::points::trace;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, RefineOptions, SEARCH, covariance};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const SIGMA: f64 = 0.05;

fn random(rng: &mut Pcg64Mcg, count: usize, size: [f64; 3]) -> Vec<[f64; 3]> {
    (0..count).map(|_| size.map(|x| x * rng.random::<f64>())).collect()
}

/// A network in a room of 10 m x 8 m x 3 m.
fn room(rng: &mut Pcg64Mcg, m: usize, n: usize) -> Network<3> {
    let [receivers, transmitters] = [m, n].map(|count| random(rng, count, [10.0, 8.0, 3.0]));
    Network::new(receivers, transmitters, vec![0.0; n])
}

/// Measurements of a network and the least-squares network.
fn fitted(rng: &mut Pcg64Mcg, truth: &Network<3>) -> (Observations<3>, Network<3>) {
    let noisy = |f: f64| f + SIGMA * rng.sample::<f64, _>(StandardNormal);
    let values = truth.pseudoranges().into_iter().map(noisy).collect();
    let measured = Pseudoranges::new(truth.receivers.len(), truth.transmitters.len(), values).unwrap();
    let observations = Observations::new(&measured, |_, _| true);
    let fit = RefineOptions { scale: Some(1.0), steps: 400, rounds: 0, tolerance: 1e-13, ..SEARCH };
    let mut refiner = NetworkRefiner::new(&observations, f64::INFINITY, &Monitor::default());
    let network = refiner.refine(truth.clone(), &fit).network;
    (observations, network)
}

#[test]
fn derivatives_are_enough_for_many_measurements() {
    let mut rng = rng(1, 1);
    let truth = room(&mut rng, 12, 60);
    let (observations, network) = fitted(&mut rng, &truth);
    let found = sampled_covariance(&observations, &network, 0.1 * SIGMA, 0, &Monitor::default()).unwrap();
    assert!(found.is_none());
}

#[test]
fn samples_of_a_normal_likelihood_have_its_covariance() {
    let mut rng = rng(2, 1);
    let truth = room(&mut rng, 7, 30);
    let (observations, network) = fitted(&mut rng, &truth);
    // So small a deviation that the network is linear in the measurements.
    let sigma = 1e-3 * SIGMA;
    let monitor = Monitor::default();
    let linear = covariance(&observations, &network, sigma, &monitor).unwrap().unwrap();
    let reduced = reduced(&observations, &network, sigma, &monitor).unwrap().unwrap();
    let sampler = Sampler::new(&observations, &network, sigma, &reduced);
    let start = sampler.at(&sampler.start(), vec![0.0; sampler.freedom]).unwrap();
    let mut all = Moments::new(7, 30);
    (0..CHAINS).for_each(|chain| all.add(&sampler.chain(&start, 0, chain, &monitor).unwrap()));
    let sampled = all.mean_squares(7);
    let [sampled, linear] = [&sampled, &linear].map(|c| c.receivers.iter().map(trace).sum::<f64>());
    // The mean square of 480 samples of a few normal variables.
    assert!((sampled / linear - 1.0).abs() < 0.15, "{sampled} {linear}");
}

#[test]
fn ellipsoids_of_a_weak_network_hold_the_truth() {
    let within = ChiSquared::new(3.0).unwrap().inverse_cdf(0.95);
    let (mut held, mut by_derivatives, mut all) = (0, 0, 0);
    for seed in 0..10 {
        let mut rng = rng(seed, 7);
        // Six corners of a room, of which the last two are left out in turn.
        let corner = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { [8.0, 6.0, 2.8][axis] } else { 0.0 });
        let receivers: Vec<[f64; 3]> = (0..6).map(|k| corner((k + seed as usize) % 8)).collect();
        let truth = Network::new(receivers, random(&mut rng, 40, [8.0, 6.0, 2.0]), vec![0.0; 40]);
        let (observations, network) = fitted(&mut rng, &truth);
        let monitor = Monitor::default();
        let linear = covariance(&observations, &network, SIGMA, &monitor).unwrap().unwrap();
        let sampled = sampled_covariance(&observations, &network, SIGMA, seed, &monitor).unwrap();
        let sampled = sampled.as_ref().unwrap_or(&linear);
        let onto = align(&truth.receivers, &network.receivers, false).unwrap().transform;
        for (i, p) in truth.receivers.iter().enumerate() {
            let off = minus(onto.apply(*p), network.receivers[i]);
            let square = |c: &[[f64; 3]; 3]| {
                let factor = Bordered { rows: *c, border: [0.0; 3], corner: 1.0 }.cholesky(1.0, 0.0).unwrap();
                dot(off, factor.solve((off, 0.0)).0)
            };
            held += usize::from(square(&sampled.receivers[i]) < within);
            by_derivatives += usize::from(square(&linear.receivers[i]) < within);
            all += 1;
        }
    }
    // 95 % of sixty; those of one network lie in or out together.
    assert!(held >= 51 && by_derivatives < held, "{held} and {by_derivatives} of {all}");
}
