//! Starting networks for the refinement, if no minimal solver proposes any.
//!
//! A transmitter's pseudoranges for two receivers differ by at most the distance between the two,
//! and by nearly that much if the transmitter lies near the line through them. The largest
//! difference over all transmitters is therefore an estimate of that distance from below. Classical
//! multidimensional scaling turns these estimates into positions. Starts differ in random factors
//! on the estimates and in a random displacement of the positions. The transmitters are then
//! located by multilateration.

use std::array::from_fn;

use faer::Mat;
use faer::Side;
use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::loss::{Loss, SEARCH_NU};
use crate::median::median;
use crate::network::Network;
use crate::observations::{Observation, Observations};
use crate::refine::place_transmitters;

/// Guessed distances between receivers, from which starts are drawn.
#[derive(Debug, Clone)]
pub(crate) struct Restarts {
    receivers: usize,
    /// Row-major m x m guesses in metres.
    distances: Vec<f64>,
    /// Which of them were measured.
    measured: Vec<bool>,
    /// Share of the pairs of receivers that these are not.
    guessed: f64,
    /// A guess of the network's diameter in metres.
    pub(crate) diameter: f64,
}

impl Restarts {
    pub(crate) fn new<const D: usize>(observations: &Observations<D>) -> Self {
        let m = observations.receivers;
        let mut differences = vec![Vec::new(); m * m];
        for j in 0..observations.transmitters {
            // Of the candidates of two cells, those that differ least bound the distance surely from below.
            let cells: Vec<&[Observation]> =
                observations.of_transmitter(j).chunk_by(|a, b| a.receiver == b.receiver).collect();
            for (k, a) in cells.iter().enumerate() {
                for b in &cells[k + 1..] {
                    let pairs = a.iter().flat_map(|a| b.iter().map(|b| (a.value - b.value).abs()));
                    let least = pairs.fold(f64::INFINITY, f64::min);
                    differences[a[0].receiver * m + b[0].receiver].push(least);
                }
            }
        }
        let mut distances = vec![f64::NAN; m * m];
        for i in 0..m {
            for k in i + 1..m {
                let list = &mut differences[i * m + k];
                list.sort_by(f64::total_cmp);
                // Gross errors sit at the top of the list: leave out its upper tenth.
                if !list.is_empty() {
                    let value = list[(list.len() - 1) * 9 / 10];
                    distances[i * m + k] = value;
                    distances[k * m + i] = value;
                }
            }
            distances[i * m + i] = 0.0;
        }
        let mut known: Vec<f64> = distances.iter().copied().filter(|&d| d > 0.0).collect();
        known.sort_by(f64::total_cmp);
        let diameter = known.get(known.len() * 9 / 10).copied().unwrap_or(1.0);
        let typical = median(known).unwrap_or(1.0);
        for d in distances.iter_mut().filter(|d| d.is_nan()) {
            *d = typical;
        }
        let mut measured = vec![false; m * m];
        for known in observations.distances() {
            let [a, b] = known.receivers;
            for place in [a * m + b, b * m + a] {
                (distances[place], measured[place]) = (known.value, true);
            }
        }
        let pairs = (m * m.saturating_sub(1)).max(1) as f64;
        let guessed = 1.0 - measured.iter().filter(|is_measured| **is_measured).count() as f64 / pairs;
        Restarts { receivers: m, distances, measured, guessed, diameter }
    }

    /// One start; `spread` says how far it may be from the plain guess (0: the guess itself, 1:
    /// anywhere).
    pub(crate) fn draw<const D: usize>(
        &self,
        observations: &Observations<D>,
        spread: f64,
        rng: &mut Pcg64Mcg,
    ) -> Network<D> {
        let mut normal = || -> f64 { rng.sample(StandardNormal) };
        let m = self.receivers;
        let mut squares = Mat::<f64>::zeros(m, m);
        for i in 0..m {
            for k in i + 1..m {
                let factor = (0.5 * spread * normal()).exp();
                let d = self.distances[i * m + k] * if self.measured[i * m + k] { 1.0 } else { factor };
                squares[(i, k)] = d * d;
                squares[(k, i)] = d * d;
            }
        }
        let mut receivers = scaled(&squares).unwrap_or_else(|| vec![[0.0; D]; m]);
        let jitter = 0.3 * spread * self.guessed * self.diameter;
        for r in &mut receivers {
            *r = r.map(|x| x + jitter * normal());
        }
        let n = observations.transmitters;
        let transmitters = (0..n).map(|_| from_fn(|_| self.diameter * normal() / 2.0)).collect();
        let mut network = Network::new(receivers, transmitters, vec![0.0; n]);
        place_transmitters(observations, &mut network, &Loss { nu: SEARCH_NU, scale: 0.1 * self.diameter });
        network
    }
}

/// Classical multidimensional scaling: positions for squared distances.
fn scaled<const D: usize>(squares: &Mat<f64>) -> Option<Vec<[f64; D]>> {
    let m = squares.nrows();
    let mean_of = |i: usize| (0..m).map(|k| squares[(i, k)]).sum::<f64>() / m as f64;
    let means: Vec<f64> = (0..m).map(mean_of).collect();
    let mean = means.iter().sum::<f64>() / m as f64;
    let gram = Mat::from_fn(m, m, |i, k| -0.5 * (squares[(i, k)] - means[i] - means[k] + mean));
    let eigen = gram.self_adjoint_eigen(Side::Lower).ok()?;
    // Eigenvalues ascend.
    let axis = |back: usize, i: usize| {
        let k = m - back;
        eigen.S()[k].max(0.0).sqrt() * eigen.U()[(i, k)]
    };
    if m < D { None } else { Some((0..m).map(|i| from_fn(|k| axis(k + 1, i))).collect()) }
}
