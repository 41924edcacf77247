//! Heights of made networks.

use super::*;
use crate::pseudoranges::Pseudoranges;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const SIGMA: f64 = 0.01;

/// A network of 12 receivers and 30 transmitters in 10 m by 8 m whose nodes have normal heights of these deviations,
/// the measurements, and a start at the truth.
fn found(receivers: f64, transmitters: f64, seed: u64, known: Option<f64>) -> (Heights<3>, f64) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut points = |count: usize, height: f64| -> Vec<[f64; 3]> {
        let point = |rng: &mut Pcg64Mcg| {
            let z: f64 = rng.sample(StandardNormal);
            [10.0 * rng.random::<f64>(), 8.0 * rng.random::<f64>(), height * z]
        };
        (0..count).map(|_| point(&mut rng)).collect()
    };
    let (receivers, transmitters) = (points(12, receivers), points(30, transmitters));
    let network = Network::new(receivers, transmitters, vec![0.0; 30]);
    let noisy = network.pseudoranges().into_iter().map(|f| f + SIGMA * rng.sample::<f64, _>(StandardNormal));
    let measured = Pseudoranges::new(12, 30, noisy.collect()).unwrap();
    let observations = Observations::<3>::new(&measured, |_, _| true);
    let monitor = Monitor::default();
    let mut start = network.clone();
    // Heights of 30 cm at least, from which smaller ones are found.
    start.receivers.iter_mut().chain(&mut start.transmitters).for_each(|p| p[2] += 0.3 * p[2].signum());
    let heights = Heights::of(&observations, &start, vec![0.0; 12], known, SIGMA, &monitor).unwrap().unwrap();
    let flat = heights.flat(&observations, heights.deviation, &monitor).unwrap();
    let evidence = |heights: &Heights<3>| heights.evidence(&observations, known, 10.0, &monitor).unwrap().unwrap();
    let gain = evidence(&heights) + heights.log_prior(10.0) - evidence(&flat);
    (heights, gain)
}

#[test]
fn deviations_of_heights_are_found() {
    for seed in 0..4 {
        for known in [None, Some(SIGMA)] {
            let (heights, gain) = found(1.0, 0.6, seed, known);
            // The deviation of a deviation from k values is 1 in sqrt(2k): 0.2 and 0.13 of it.
            assert!((heights.receivers / 1.0).ln().abs() < 0.7, "seed {seed}: {}", heights.receivers);
            assert!((heights.transmitters / 0.6).ln().abs() < 0.45, "seed {seed}: {}", heights.transmitters);
            assert!(gain > 10.0, "seed {seed}: {gain}");
            assert!((heights.deviation / SIGMA).ln().abs() < 0.3, "seed {seed}: {}", heights.deviation);
        }
    }
}

/// Anchors 1 m above and below the middle, 5 cm off these levels, transmitters between them.
#[test]
fn two_levels_are_likelier_than_one_and_found() {
    for seed in 0..4 {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut points = |count: usize, height: fn(usize) -> f64, off: f64| -> Vec<[f64; 3]> {
            let point = |(k, rng): (usize, &mut Pcg64Mcg)| {
                let z: f64 = rng.sample(StandardNormal);
                [10.0 * rng.random::<f64>(), 8.0 * rng.random::<f64>(), height(k) + off * z]
            };
            (0..count).map(|k| point((k, &mut rng))).collect()
        };
        let side = |k: usize| if k.is_multiple_of(3) { 1.0 } else { -1.0 };
        let (receivers, transmitters) = (points(12, side, 0.05), points(30, |_| 0.2, 0.3));
        let network = Network::new(receivers, transmitters, vec![0.0; 30]);
        let noisy = network.pseudoranges().into_iter().map(|f| f + SIGMA * rng.sample::<f64, _>(StandardNormal));
        let measured = Pseudoranges::new(12, 30, noisy.collect()).unwrap();
        let observations = Observations::<3>::new(&measured, |_, _| true);
        let monitor = Monitor::default();
        let of = |sides: Vec<f64>| {
            let found = Heights::of(&observations, &network, sides, None, SIGMA, &monitor).unwrap().unwrap();
            let evidence = found.evidence(&observations, None, 10.0, &monitor).unwrap().unwrap();
            (evidence + found.log_prior(10.0), found)
        };
        let (one, two) = (of(vec![0.0; 12]), of((0..12).map(side).collect()));
        // One level has deviation 1 in place of 0.05, over twelve heights, for twelve sides and a distance.
        assert!(two.0 > one.0 + 5.0, "seed {seed}: {} {}", two.0, one.0);
        assert!(one.1.apart == 0.0 && (two.1.apart - 1.0).abs() < 0.1, "seed {seed}: {}", two.1.apart);
        assert!(two.1.receivers < 0.2 && (one.1.receivers / 0.94).ln().abs() < 0.3, "seed {seed}: {:?}", one.1);
    }
}

#[test]
fn a_plane_is_likelier_than_heights() {
    for seed in 0..6 {
        for known in [None, Some(SIGMA)] {
            let (heights, gain) = found(0.0, 0.0, seed, known);
            assert!(gain < 0.0, "seed {seed}: {gain}");
            // What the noise allows: a height z changes a distance d by z^2 / 2d.
            assert!(heights.receivers.max(heights.transmitters) < 0.5, "seed {seed}: {heights:?}");
        }
    }
}
