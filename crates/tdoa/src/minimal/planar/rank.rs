//! Offsets by rank alone: seven receivers with four transmitters (one root), five with six (five
//! roots); and networks from offsets.
//!
//! With the first receiver's measurements subtracted, `q_ij = f_ij (f_ij - 2 p_j)` is the
//! difference of the squared distances, and `q_ij - q_i1` has rank two in the plane. Where this
//! fixes the offsets, the rest is linear.

use crate::generated::five_six;
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::network::Network;
use hc::Fibre;
use num_complex::Complex64;
use smallvec::{SmallVec, smallvec};

/// Five receivers, six transmitters: 5 paths; the equations are in `families/5r6s.toml`.
pub(crate) struct FiveSix;

impl Formulation for FiveSix {
    type System = five_six::System;
    const NAME: &'static str = "5r/6s";
    const FAMILY: &'static str = include_str!("../../../families/5r6s.toml");
    const RECEIVERS: usize = 5;
    const TRANSMITTERS: usize = 6;
    const WEIGHTS: &'static [i32] = &[0, 0, 2, 0, 0, 2];
    const CHARTS: usize = CHARTS.len();

    fn system() -> &'static Self::System {
        &five_six::System
    }

    fn fibre() -> Fibre {
        five_six::fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        let n = Self::TRANSMITTERS;
        CHARTS[chart].iter().flat_map(|&i| f[i * n..(i + 1) * n].iter().copied()).collect()
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        // In chart 1 receivers 2 and 3 change places, in chart 2 receivers 4 and 5.
        match chart {
            1 => smallvec![x[1], x[0], x[2], x[4], x[3], x[5]],
            2 => smallvec![x[3], x[4], x[5], x[0], x[1], x[2]],
            _ => Point::from_slice(x),
        }
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        Self::enter(chart, x)
    }

    fn offsets(f: &[Complex64], x: &[Complex64]) -> Point {
        let n = Self::TRANSMITTERS;
        (0..n)
            .map(|j| {
                let [a, b, c, g] = [0, 1, 2, 3].map(|i| f[i * n + j]);
                // Both quotients are equal at a root; the one with the larger denominator is the
                // more accurate.
                let first = (x[0] * a * a + x[1] * b * b - c * c + x[2], x[0] * a + x[1] * b - c);
                let second = (x[3] * a * a + x[4] * b * b - g * g + x[5], x[3] * a + x[4] * b - g);
                let (n, d) = if first.1.norm() >= second.1.norm() { first } else { second };
                n / (2.0 * d)
            })
            .collect()
    }
}

impl FormulationIn for FiveSix {
    fn network(f: &[f64], x: &[f64], squares: &mut LeastSquares) -> Option<Network> {
        let complex = |v: &[f64]| v.iter().map(|&v| v.into()).collect::<Parameters>();
        let p: SmallVec<[f64; 8]> = Self::offsets(&complex(f), &complex(x)).iter().map(|z| z.re).collect();
        by_transmitters(f, &p, squares)
    }
}

/// Orders of the receivers after the first.
const CHARTS: [[usize; 4]; 3] = [[0, 1, 2, 3], [1, 0, 2, 3], [0, 1, 3, 2]];

/// `p_j` of four transmitters from six or more receivers besides the first, in rows of four: with
/// `s_4 = w_1 s_1 + w_2 s_2 + w_3 s_3`, `w_1 + w_2 + w_3 = 1`, the equations
/// `sum_j w_j f_ij (f_ij - 2 p_j) = f_i4 (f_i4 - 2 p_4)` are linear in `w` and `w_j p_j`.
pub(crate) fn offsets_of_four(f: &[f64], squares: &mut LeastSquares) -> Option<[f64; 4]> {
    let rows: Vec<[f64; 7]> = f
        .chunks_exact(4)
        .map(|r| {
            let s = [r[0] * r[0], r[1] * r[1], r[2] * r[2], r[3] * r[3]];
            [s[0] - s[2], s[1] - s[2], -2.0 * r[0], -2.0 * r[1], -2.0 * r[2], 2.0 * r[3], s[3] - s[2]]
        })
        .collect();
    let x = squares.fit(rows.len(), 6, |i, c| rows[i][c], |i| rows[i][6])?;
    let p = [x[2] / x[0], x[3] / x[1], x[4] / (1.0 - x[0] - x[1]), x[5]];
    p.iter().all(|p| p.is_finite()).then_some(p)
}

/// `q_ij - q_i1` for the columns `j = 2..n` (rows of `n - 1`), and `q_i1`.
pub(crate) fn differences(f: &[f64], p: &[f64]) -> (SmallVec<[f64; 32]>, SmallVec<[f64; 8]>) {
    let q = |row: &[f64], j: usize| row[j] * (row[j] - 2.0 * p[j]);
    let rows = f.chunks_exact(p.len());
    let d = rows.clone().flat_map(|row| (1..p.len()).map(move |j| q(row, j) - q(row, 0))).collect();
    (d, rows.map(|row| q(row, 0)).collect())
}

/// The network of known `p_j` where there are five or more receivers besides the first: the
/// equations (C) of the paper are linear in `H` and `b`. `None` unless the positions are real.
pub(crate) fn by_receivers(f: &[f64], p: &[f64], squares: &mut LeastSquares) -> Option<Network> {
    let (d, q) = differences(f, p);
    let w = p.len() - 1;
    let row = |i: usize| (d[i * w], d[i * w + 1]);
    let x = squares.fit(
        q.len(),
        5,
        |i, c| {
            let (d1, d2) = row(i);
            [d1 * d1, 2.0 * d1 * d2, d2 * d2, -2.0 * d1, -2.0 * d2][c]
        },
        |i| q[i],
    )?;
    let det = x[0] * x[2] - x[1] * x[1];
    let gram = [x[2] / det, -x[1] / det, x[0] / det];
    let w = [gram[0] * x[3] + gram[1] * x[4], gram[1] * x[3] + gram[2] * x[4]];
    assemble(f, p, &d, gram, w, squares)
}

/// The network of known `p_j` where there are six or more transmitters: with
/// `s_j = s_1 - L c_j / 2` the differences of the norms `p_j^2 - p_1^2 = c_j' G c_j / 4 - w' c_j`
/// are linear in `G` and `w = G b`. `None` unless the positions are real.
fn by_transmitters(f: &[f64], p: &[f64], squares: &mut LeastSquares) -> Option<Network> {
    let (d, _) = differences(f, p);
    let c = affine(&d, p.len() - 1, squares)?;
    let x = squares.fit(
        c.len(),
        5,
        |j, k| {
            let [y, z] = c[j];
            [y * y / 4.0, y * z / 2.0, z * z / 4.0, -y, -z][k]
        },
        |j| p[j + 1] * p[j + 1] - p[0] * p[0],
    )?;
    assemble(f, p, &d, [x[0], x[1], x[2]], [x[3], x[4]], squares)
}

/// `c_j` of the transmitters `j = 2..n`: the columns of `d` in terms of its first two.
fn affine(d: &[f64], width: usize, squares: &mut LeastSquares) -> Option<SmallVec<[[f64; 2]; 8]>> {
    let rows = d.len() / width;
    (0..width)
        .map(|j| match j {
            0 => Some([1.0, 0.0]),
            1 => Some([0.0, 1.0]),
            _ => squares.fit(rows, 2, |i, c| d[i * width + c], |i| d[i * width + j]).map(|x| [x[0], x[1]]),
        })
        .collect()
}

/// Positions from `G = L'L` (entries 11, 12, 22) and `w = G b`: `r_i = L^{-T} D_i'`,
/// `s_1 = L^{-T} w`, `s_j = s_1 - L c_j / 2`.
fn assemble(
    f: &[f64],
    p: &[f64],
    d: &[f64],
    [g11, g12, g22]: [f64; 3],
    w: [f64; 2],
    squares: &mut LeastSquares,
) -> Option<Network> {
    let width = p.len() - 1;
    let l11 = g11.sqrt();
    let l12 = g12 / l11;
    let l22 = (g22 - l12 * l12).sqrt();
    if !(l11 > 0.0 && l22 > 0.0) {
        return None;
    }
    let back = |v: [f64; 2]| {
        let x = v[0] / l11;
        [x, (v[1] - l12 * x) / l22]
    };
    let mut receivers = Vec::with_capacity(f.len() / p.len() + 1);
    receivers.push([0.0, 0.0]);
    receivers.extend((0..f.len() / p.len()).map(|i| back([d[i * width], d[i * width + 1]])));
    let first = back(w);
    let mut transmitters = Vec::with_capacity(p.len());
    transmitters.push(first);
    transmitters.extend(
        affine(d, width, squares)?
            .iter()
            .map(|[y, z]| [first[0] - 0.5 * (l11 * y + l12 * z), first[1] - 0.5 * l22 * z]),
    );
    let network = Network::new(receivers, transmitters, p.to_vec());
    network.is_finite().then_some(network)
}

#[cfg(test)]
mod tests {
    use super::{by_receivers, by_transmitters, offsets_of_four};
    use crate::minimal::MinimalOptions;
    use crate::minimal::linear::LeastSquares;
    use crate::minimal::normalised::Normalised;
    use crate::minimal::polish::NetworkPolisher;
    use crate::simulate::{Layout, SimulateOptions, simulate};

    fn data(receivers: usize, transmitters: usize, seed: u64) -> (Vec<f64>, Normalised) {
        let options = SimulateOptions {
            receivers,
            transmitters,
            layout: Layout::Normal,
            noise: 0.0,
            seed,
            ..SimulateOptions::default()
        };
        let simulation = simulate(&options).unwrap();
        let data = Normalised::new(&simulation.pseudoranges);
        let mut network = simulation.network;
        data.enter(&mut network);
        (network.offsets, data)
    }

    fn error(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn offsets_of_four_are_those_of_the_network() {
        let mut good = 0;
        let mut squares = LeastSquares::default();
        for seed in 0..50 {
            let (truth, data) = data(7, 4, seed);
            let found = offsets_of_four(data.parameters(), &mut squares).unwrap();
            good += usize::from(error(&found, &truth) < 1e-6);
            let network = by_receivers(data.parameters(), &truth, &mut squares).unwrap();
            let candidate = data.candidate(network, &MinimalOptions::default(), &mut NetworkPolisher::default());
            assert!(candidate.residual < 1e-12, "seed {seed}: {}", candidate.residual);
        }
        // Some of fifty networks are near to a degenerate one.
        assert!(good >= 45, "{good}");
    }

    #[test]
    fn networks_from_offsets_of_six_transmitters() {
        let mut squares = LeastSquares::default();
        for seed in 0..50 {
            let (truth, data) = data(5, 6, seed);
            let network = by_transmitters(data.parameters(), &truth, &mut squares).unwrap();
            let candidate = data.candidate(network, &MinimalOptions::default(), &mut NetworkPolisher::default());
            assert!(candidate.residual < 1e-12, "seed {seed}: {}", candidate.residual);
        }
    }
}
