//! What systematic errors must do, by theory.

use super::{LEAST_REDUNDANCY, Systematic, add_square, shapes, systematic};
use crate::align::align;
use crate::network::Network;
use crate::network::tests::random;
use crate::observations::Observations;
use crate::points::{dot, minus};
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, Projection, RefineOptions, SEARCH, covariance};
use faer::prelude::Solve;
use faer::{Mat, Side};
use hc::Monitor;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const NOISE: f64 = 0.01;

/// Receivers and transmitters in a room of 10 m by 8 m by 3 m, or by 10 m by 8 m.
fn room<const D: usize>(m: usize, n: usize, rng: &mut Pcg64Mcg) -> Network<D> {
    let mut points = |count: usize| -> Vec<[f64; D]> {
        (0..count).map(|_| std::array::from_fn(|k| rng.random_range(0.0..[10.0, 8.0, 3.0][k]))).collect()
    };
    let (receivers, transmitters) = (points(m), points(n));
    Network::new(receivers, transmitters, vec![0.0; n])
}

fn normal(rng: &mut Pcg64Mcg) -> f64 {
    rng.sample(StandardNormal)
}

fn fitted<const D: usize>(truth: &Network<D>, errors: &[f64]) -> (Observations<D>, Network<D>) {
    let (m, n) = (truth.receivers.len(), truth.transmitters.len());
    let values = truth.pseudoranges().iter().zip(errors).map(|(f, e)| f + e).collect();
    let observations = Observations::new(&Pseudoranges::new(m, n, values).unwrap(), |_, _| true);
    let options = RefineOptions { scale: Some(1.0), rounds: 0, steps: 100, tolerance: 0.0, ..SEARCH };
    let network =
        NetworkRefiner::new(&observations, f64::INFINITY, &Monitor::default()).refine(truth.clone(), &options).network;
    (observations, network)
}

fn of<const D: usize>(observations: &Observations<D>, network: &Network<D>) -> Systematic<D> {
    let monitor = Monitor::default();
    let projection = Projection::new(observations, network, &monitor).unwrap().unwrap();
    let redundancy = observations.len() - observations.unknowns();
    systematic(observations, network, redundancy, &projection, &[], &monitor).unwrap().unwrap()
}

/// The error of each receiver by these coefficients.
fn by_shapes<const D: usize>(network: &Network<D>, sizes: &[Vec<f64>]) -> Vec<f64> {
    let one = |i: usize, j: usize| {
        let ray = minus(network.transmitters[j], network.receivers[i]);
        let u = ray.map(|x| x / dot(ray, ray).sqrt());
        shapes(u).iter().zip(&sizes[i]).map(|(h, a)| h * a).sum()
    };
    let n = network.transmitters.len();
    (0..network.receivers.len()).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| one(i, j)).collect()
}

#[test]
fn each_degree_has_a_third_of_the_variance() {
    // Products of the shapes along two directions at an angle t are a third of 1 + cos t + P(t), where
    // P is the polynomial of the second degree that belongs to the circle, or to the sphere.
    fn agrees<const D: usize>(second: fn(f64) -> f64) {
        let network: Network<D> = random(9, 9, 4);
        for (p, q) in network.receivers.iter().zip(&network.transmitters) {
            let [u, v] = [p, q].map(|p| p.map(|x| x / dot(*p, *p).sqrt()));
            let (a, b) = (shapes(u), shapes(v));
            assert_eq!(a.len(), D + D * (D + 1) / 2);
            let product: f64 = a.iter().zip(&b).map(|(x, y)| x * y).sum();
            let cosine = dot(u, v);
            assert!((product - (1.0 + cosine + second(cosine)) / 3.0).abs() < 1e-14, "{product}");
        }
    }
    agrees::<2>(|c| 2.0 * c * c - 1.0);
    agrees::<3>(|c| (3.0 * c * c - 1.0) / 2.0);
}

/// The likelihood of the residuals by dense algebra: in an orthonormal basis Q of what no motion
/// makes, they have the covariance Q' (1 + g Z Z') Q up to a factor.
fn is_the_likeliest<const D: usize>(m: usize, n: usize) {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let truth: Network<D> = room(m, n, &mut rng);
    let each = D + D * (D + 1) / 2;
    let sizes: Vec<Vec<f64>> = (0..m).map(|_| (0..each).map(|_| 3.0 * NOISE * normal(&mut rng)).collect()).collect();
    let errors: Vec<f64> = by_shapes(&truth, &sizes).into_iter().map(|e| e + NOISE * normal(&mut rng)).collect();
    let (observations, network) = fitted(&truth, &errors);
    let found = of(&observations, &network);
    let projection = Projection::new(&observations, &network, &Monitor::default()).unwrap().unwrap();
    let count = observations.len();
    let mut off = Mat::<f64>::zeros(count, count);
    for k in 0..count {
        let mut one = vec![0.0; count];
        one[k] = 1.0;
        projection.off(&one).0.iter().enumerate().for_each(|(l, x)| off[(l, k)] = *x);
    }
    let eigen = off.self_adjoint_eigen(Side::Lower).unwrap();
    let left = count - observations.unknowns();
    let basis = eigen.U().subcols(count - left, left);
    let mut z = Mat::<f64>::zeros(count, each * m);
    for (k, o) in observations.all().iter().enumerate() {
        let u = projection.ray(k);
        shapes(u).iter().enumerate().for_each(|(h, x)| z[(k, each * o.receiver + h)] = *x);
    }
    let z = basis.transpose() * z;
    let e = Mat::from_fn(count, 1, |k, _| observations.all()[k].residual(&network));
    let e = basis.transpose() * e;
    // Log-likelihood, and the variance that belongs to the ratio.
    let at = |ratio: f64| -> (f64, f64) {
        let v = Mat::<f64>::identity(left, left) + ratio * (&z * z.transpose());
        let factor = v.llt(Side::Lower).unwrap();
        let logarithm: f64 = (0..left).map(|k| 2.0 * factor.L()[(k, k)].ln()).sum();
        let noise = (e.transpose() * factor.solve(&e))[(0, 0)] / left as f64;
        (-0.5 * (logarithm + left as f64 * noise.ln()), ratio * noise)
    };
    let tried = (0..=400).map(|k| at((-4.0 + 0.03 * k as f64).exp()));
    let best = tried.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert!(found.gain > 0.0 && (found.gain - (best.0 - at(0.0).0)).abs() < 1e-2, "{} {best:?}", found.gain);
    let variance = found.deviation.powi(2);
    assert!((variance / best.1 - 1.0).abs() < 0.03, "{variance} {}", best.1);
}

#[test]
fn the_deviation_is_the_likeliest_one() {
    is_the_likeliest::<2>(7, 12);
    is_the_likeliest::<3>(8, 14);
}

/// The shapes are added to exact data, one after the other, the network is adjusted by least squares
/// and aligned with the truth. The sum of the squares of what this does to the receivers belongs to
/// errors of deviation 1.
fn moves_the_receivers<const D: usize>(m: usize, n: usize) {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let truth: Network<D> = room(m, n, &mut rng);
    let (each, step) = (D + D * (D + 1) / 2, 1e-4);
    let mut expected = vec![[[0.0; D]; D]; m];
    for (i, h) in (0..m).flat_map(|i| (0..each).map(move |h| (i, h))) {
        let moved = [step, -step].map(|by| {
            let mut sizes = vec![vec![0.0; each]; m];
            sizes[i][h] = by;
            let (_, network) = fitted(&truth, &by_shapes(&truth, &sizes));
            let map = align(&network.receivers, &truth.receivers, false).unwrap().transform;
            network.receivers.iter().map(|p| map.apply(*p)).collect::<Vec<_>>()
        });
        for (sum, (p, q)) in expected.iter_mut().zip(moved[0].iter().zip(&moved[1])) {
            add_square(sum, &minus(*p, *q).map(|x| x / (2.0 * step)));
        }
    }
    let sizes: Vec<Vec<f64>> = (0..m).map(|_| (0..each).map(|_| 5.0 * NOISE * normal(&mut rng)).collect()).collect();
    let errors: Vec<f64> = by_shapes(&truth, &sizes).into_iter().map(|e| e + NOISE * normal(&mut rng)).collect();
    let values = truth.pseudoranges().iter().zip(&errors).map(|(f, e)| f + e).collect();
    let observations = Observations::new(&Pseudoranges::new(m, n, values).unwrap(), |_, _| true);
    // At the truth, where the shapes above are.
    let found = of(&observations, &truth);
    assert!(found.deviation > NOISE);
    let variance = found.deviation.powi(2);
    for (c, e) in found.receivers.iter().flatten().flatten().zip(expected.iter().flatten().flatten()) {
        assert!((c / variance - e).abs() < 1e-3 * (1.0 + e.abs()), "{} {e}", c / variance);
    }
}

#[test]
fn the_covariance_is_what_least_squares_makes_of_the_errors() {
    moves_the_receivers::<2>(7, 12);
    moves_the_receivers::<3>(8, 14);
}

/// How often 95 % ellipses hold the true receiver, by noise alone and with systematic errors; root mean
/// square of the deviation of these; and in how many networks they gain more than noise does in one of a
/// thousand. `errors` are those of the measurements beside noise.
fn coverage<const D: usize>(
    (m, n): (usize, usize),
    networks: u64,
    radius: f64,
    errors: impl Fn(&Network<D>, &mut Pcg64Mcg) -> Vec<f64>,
) -> ([f64; 2], f64, usize) {
    let (mut inside, mut variance, mut significant) = ([0; 2], 0.0, 0);
    for seed in 0..networks {
        let mut rng = Pcg64Mcg::seed_from_u64(100 + seed);
        let truth: Network<D> = room(m, n, &mut rng);
        let errors: Vec<f64> = errors(&truth, &mut rng).into_iter().map(|e| e + NOISE * normal(&mut rng)).collect();
        let (observations, network) = fitted(&truth, &errors);
        let found = of(&observations, &network);
        variance += found.deviation.powi(2) / networks as f64;
        significant += usize::from(found.gain > 4.77);
        let square: f64 = observations.all().iter().map(|o| o.residual(&network).powi(2)).sum();
        let sigma = (square / (observations.len() - observations.unknowns()) as f64).sqrt();
        let usual = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
        let map = align(&truth.receivers, &network.receivers, false).unwrap().transform;
        for i in 0..m {
            let off = minus(map.apply(truth.receivers[i]), network.receivers[i]);
            for (k, added) in [0.0, 1.0].into_iter().enumerate() {
                let c = Mat::from_fn(D, D, |a, b| usual.receivers[i][a][b] + added * found.receivers[i][a][b]);
                let d = Mat::from_fn(D, 1, |a, _| off[a]);
                let z = (d.transpose() * c.llt(Side::Lower).unwrap().solve(&d))[(0, 0)];
                inside[k] += usize::from(z <= radius * radius);
            }
        }
    }
    (inside.map(|count| count as f64 / (networks * m as u64) as f64), variance.sqrt(), significant)
}

/// Radii of 95 % by tables of chi-squared with 2 and 3 degrees of freedom.
const RADIUS: [f64; 2] = [2.448, 2.796];

#[test]
fn noise_alone_is_hardly_taken_for_systematic_errors() {
    let nothing = |truth: &Network<2>, _: &mut Pcg64Mcg| vec![0.0; truth.pseudoranges().len()];
    let ([usual, new], deviation, significant) = coverage((10, 30), 40, RADIUS[0], nothing);
    // Four deviations of the mean of 400 receivers, which are not quite independent.
    assert!((usual - 0.95).abs() < 0.05 && new >= usual && new < 0.995, "{usual} {new}");
    assert!(deviation < 0.5 * NOISE && significant <= 1, "{deviation} {significant}");
    let nothing = |truth: &Network<3>, _: &mut Pcg64Mcg| vec![0.0; truth.pseudoranges().len()];
    let ([usual, new], deviation, significant) = coverage((12, 40), 30, RADIUS[1], nothing);
    assert!((usual - 0.95).abs() < 0.05 && new >= usual && new < 0.995, "{usual} {new}");
    assert!(deviation < 0.5 * NOISE && significant <= 1, "{deviation} {significant}");
}

#[test]
fn ellipses_with_systematic_errors_hold_the_receivers() {
    fn holds<const D: usize>(size: (usize, usize), networks: u64) {
        // The errors of the model: 95 %, less what the estimate of one variance costs.
        let each = D + D * (D + 1) / 2;
        let by_model = |truth: &Network<D>, rng: &mut Pcg64Mcg| {
            let coefficients = |_| (0..each).map(|_| 2.0 * NOISE * normal(rng)).collect();
            let sizes: Vec<Vec<f64>> = (0..truth.receivers.len()).map(coefficients).collect();
            by_shapes(truth, &sizes)
        };
        let ([usual, new], deviation, significant) = coverage(size, networks, RADIUS[D - 2], by_model);
        assert!(usual < 0.6 && (0.88..0.98).contains(&new), "{usual} {new}");
        assert!((deviation / (2.0 * NOISE) - 1.0).abs() < 0.15, "{deviation}");
        assert!(2 * significant > networks as usize, "{significant}");
        // A constant for each receiver.
        let constants = |truth: &Network<D>, rng: &mut Pcg64Mcg| {
            let delays: Vec<f64> = truth.receivers.iter().map(|_| 2.0 * NOISE * normal(rng)).collect();
            delays.iter().flat_map(|d| vec![*d; truth.transmitters.len()]).collect()
        };
        let ([usual, new], _, significant) = coverage(size, networks, RADIUS[D - 2], constants);
        assert!(usual < 0.6 && (0.85..0.99).contains(&new), "{usual} {new}");
        assert!(2 * significant > networks as usize, "{significant}");
    }
    holds::<2>((10, 30), 30);
    holds::<3>((12, 40), 20);
}

#[test]
fn nothing_is_said_of_few_measurements() {
    let truth: Network<2> = room(6, 5, &mut Pcg64Mcg::seed_from_u64(1));
    let (observations, network) = fitted(&truth, &[0.0; 30]);
    let monitor = Monitor::default();
    let projection = Projection::new(&observations, &network, &monitor).unwrap().unwrap();
    let redundancy = observations.len() - observations.unknowns();
    assert!(redundancy < LEAST_REDUNDANCY);
    assert_eq!(systematic(&observations, &network, redundancy, &projection, &[], &monitor).unwrap(), None);
}
