//! Nodes exactly in one line, recognised from the measurements alone, and the networks to which
//! they may belong.
//!
//! Each node off the line may be its mirror image, independently of the others. The roots of such
//! networks are singular, and paths seldom reach them. But then
//! `D_ij = q_ij - q_i1 = -2 r_i . (s_j - s_1)`, `q_ij = f_ij (f_ij - 2 p_j)`, has rank one instead
//! of two, for receivers in a line as well as for transmitters. The offsets for which it has rank
//! one follow from linear equations. From these follow the positions along the line and the
//! distances from it.

use super::rank::differences;
use crate::flatness::flatness;
use crate::minimal::linear::LeastSquares;
use crate::minimal::node_kind::NodeKind;
use crate::network::Network;
use smallvec::SmallVec;

/// Rank one to this precision (minors relative to the square of the largest entry) counts as exact.
const RANK_ONE: f64 = 1e-9;
/// How well positions along the line have to fit, relative to the largest entry.
const FITS: f64 = 1e-6;
/// Nodes off the line at most of which all mirror images are listed: 64 networks.
const LISTED: usize = 7;

/// Nodes of one kind in one line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Collinear {
    /// Which nodes lie in one line.
    pub(crate) kind: NodeKind,
    /// The network with all other nodes on one side of the line, which is the first axis; offsets
    /// are `p_j`.
    network: Network,
}

impl Collinear {
    /// The networks with all receivers or all transmitters in one line that fit the data
    /// `f_ij - f_1j` (`i = 2..m`, rows of `width`), if there are any.
    ///
    /// `None` too for matrices so small that some offsets always give rank one: six receivers with
    /// three transmitters, five with four and four with five are the smallest that tell.
    pub(crate) fn find(f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<Collinear> {
        let rows = f.len() / width;
        let p = match (rows, width) {
            (5.., 3..) | (4, 4..) => by_columns(f, width, squares)?,
            (3, 5..) => by_rows(f, width, squares)?,
            _ => return None,
        };
        let (d, q) = differences(f, &p);
        let w = width - 1;
        let largest = d.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let at = d.iter().position(|x| x.abs() == largest)?;
        let (row, column) = (at / w, at % w);
        let minor = |i: usize, j: usize| d[i * w + j] * d[at] - d[i * w + column] * d[row * w + j];
        let rank_one = (0..rows).all(|i| (0..w).all(|j| minor(i, j).abs() <= RANK_ONE * largest * largest));
        // Written so that NaN is no fit.
        if !(rank_one && largest > 0.0) {
            return None;
        }
        let rank_one = RankOne {
            p: &p,
            q: &q,
            across: (0..rows).map(|i| d[i * w + column]).collect(),
            along: std::iter::once(0.0).chain((0..w).map(|j| d[row * w + j] / d[at])).collect(),
        };
        rank_one.receivers(d[at], row, squares).or_else(|| rank_one.transmitters(f, width, squares))
    }

    /// Whether [`networks`](Self::networks) gives all mirror images.
    pub(crate) fn all_listed(&self) -> bool {
        self.others().len() <= LISTED
    }

    /// The networks, each node off the line on the one side or the other, but for the mirror image
    /// of the whole; the first alone where there are too many.
    pub(crate) fn networks(&self) -> impl Iterator<Item = Network> {
        let count = if self.all_listed() { 1usize << self.others().len().saturating_sub(1) } else { 1 };
        (0..count).map(|sides| {
            let mut network = self.network.clone();
            let others = match self.kind {
                NodeKind::Receivers => &mut network.transmitters,
                NodeKind::Transmitters => &mut network.receivers,
            };
            for (k, node) in others.iter_mut().skip(1).enumerate() {
                if sides >> k & 1 == 1 {
                    node[1] = -node[1];
                }
            }
            network
        })
    }

    /// Whether a network, in the same units, is one of these, found in another way.
    pub(crate) fn covers(&self, network: &Network) -> bool {
        let offsets = self.network.offsets.iter().zip(&network.offsets);
        self.all_listed()
            && flatness(self.kind.positions(network)) < 1e-3
            && offsets.into_iter().all(|(a, b)| (a - b).abs() < 1e-5)
    }

    /// The nodes off the line.
    fn others(&self) -> &[[f64; 2]] {
        match self.kind {
            NodeKind::Receivers => NodeKind::Transmitters.positions(&self.network),
            NodeKind::Transmitters => NodeKind::Receivers.positions(&self.network),
        }
    }
}

/// `D` of rank one: `across_i along_j`, receivers from the second, transmitters from the first
/// (`along_1 = 0`), the largest `along` one.
struct RankOne<'a> {
    p: &'a [f64],
    q: &'a [f64],
    across: SmallVec<[f64; 8]>,
    along: SmallVec<[f64; 8]>,
}

impl RankOne<'_> {
    /// Receivers `r_i = c x_i e` with the first in the origin, `x_i` in the ratio of the rows and
    /// one in row `row`: `q_i1 = c^2 x_i^2 - 2 c x_i (e . s_1)` has to be a quadratic without
    /// constant. `entry` is that of the row where `along` is one.
    fn receivers(&self, entry: f64, row: usize, squares: &mut LeastSquares) -> Option<Collinear> {
        let x: SmallVec<[f64; 8]> = self.across.iter().map(|d| d / self.across[row]).collect();
        let q = self.q;
        let fit = squares.fit(x.len(), 2, |i, c| if c == 0 { x[i] * x[i] } else { x[i] }, |i| q[i])?;
        let size = q.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let fits = |i: usize| ((fit[0] * x[i] + fit[1]) * x[i] - q[i]).abs() <= FITS * size;
        if !((0..x.len()).all(fits) && fit[0] > 0.0) {
            return None;
        }
        let c = fit[0].sqrt();
        let first = -fit[1] / (2.0 * c);
        let foot = |along: &f64| first - entry * along / (2.0 * c);
        let transmitters =
            self.along.iter().zip(self.p).map(|(along, p)| off_line(foot(along), p * p)).collect::<Option<_>>()?;
        let receivers = std::iter::once(0.0).chain(x).map(|x| [c * x, 0.0]).collect();
        Some(Collinear { kind: NodeKind::Receivers, network: Network::new(receivers, transmitters, self.p.to_vec()) })
    }

    /// Transmitters `s_j = c along_j e`:
    /// `p_j^2 = |r_1 - s_j|^2 = c^2 along_j^2 - 2 c along_j (e . r_1) + |r_1|^2`.
    fn transmitters(&self, f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<Collinear> {
        let (y, p) = (&self.along, self.p);
        let fit = squares.fit(width, 3, |j, c| [y[j] * y[j], y[j], 1.0][c], |j| p[j] * p[j])?;
        let size = p.iter().fold(0.0, |a: f64, b| a.max(b * b));
        let fits = |j: usize| ((fit[0] * y[j] + fit[1]) * y[j] + fit[2] - p[j] * p[j]).abs() <= FITS * size;
        if !((0..width).all(fits) && fit[0] > 0.0) {
            return None;
        }
        let c = fit[0].sqrt();
        let first = -fit[1] / (2.0 * c);
        let rest = self.across.iter().enumerate().map(|(i, d)| {
            // The distance from the first transmitter, in the origin.
            let distance = f[i * width] - p[0];
            off_line(first - d / (2.0 * c), distance * distance)
        });
        let receivers = std::iter::once(off_line(first, fit[2])).chain(rest).collect::<Option<_>>()?;
        let transmitters = y.iter().map(|y| [c * y, 0.0]).collect();
        Some(Collinear { kind: NodeKind::Transmitters, network: Network::new(receivers, transmitters, p.to_vec()) })
    }
}

/// The node with this foot on the line, on one side of it, at a squared distance from the origin;
/// `None` if it is nearer than its foot.
fn off_line(foot: f64, distance_sqr: f64) -> Option<[f64; 2]> {
    let height_sqr = distance_sqr - foot * foot;
    (height_sqr >= -FITS * distance_sqr).then(|| [foot, height_sqr.max(0.0).sqrt()])
}

/// Offsets `p_j` that make `D` rank one: three columns of `q` then obey
/// `q_i3 = w q_i1 + (1 - w) q_i2`, which is linear in `w`, `w p_1`, `(1 - w) p_2` and `p_3`; four
/// rows or more.
fn by_columns(f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<SmallVec<[f64; 8]>> {
    let mut p = SmallVec::new();
    for j in 2..width {
        let entry = |i: usize, c: usize| {
            let [a, b, c3] = [f[i * width], f[i * width + 1], f[i * width + j]];
            [a * a - b * b, -2.0 * a, 2.0 * b, 2.0 * c3][c]
        };
        let right = |i: usize| f[i * width + j].powi(2) - f[i * width + 1].powi(2);
        // The third unknown is -(1 - w) p_2.
        let rows = f.len() / width;
        let x = squares.fit(rows, 4, entry, right)?;
        // The first three columns tell most networks already.
        let term = |i: usize, c: usize| entry(i, c) * x[c];
        let size = (0..4 * rows).fold(0.0, |size: f64, k| size.max(term(k / 4, k % 4).abs()));
        let error = |i: usize| ((0..4).map(|c| term(i, c)).sum::<f64>() - right(i)).abs();
        if !(0..rows).all(|i| error(i) <= FITS * size) {
            return None;
        }
        if j == 2 {
            p.extend([x[1] / x[0], -x[2] / (1.0 - x[0])]);
        }
        p.push(x[3]);
    }
    Some(p)
}

/// Candidates from three rows and five columns or more: `q_ij - g_i q_2j = c_i` for `i = 3, 4`.
/// Without the `p_j` these are linear in `g_3`, `g_4`, `c_3`, `c_4` and `g_3 c_4 - g_4 c_3`.
fn by_rows(f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<SmallVec<[f64; 8]>> {
    let at = |i: usize, j: usize| f[i * width + j];
    let entry = |j: usize, c: usize| {
        let [a, b, d] = [at(0, j), at(1, j), at(2, j)];
        [a * d * (a - d), a * b * (b - a), d, -b, a][c]
    };
    let right = |j: usize| {
        let [b, d] = [at(1, j), at(2, j)];
        b * d * (b - d)
    };
    let x = squares.fit(width, 5, entry, right)?;
    let offset = |j: usize| {
        let [a, b, d] = [at(0, j), at(1, j), at(2, j)];
        let (third, fourth) = (x[0] * a - b, x[1] * a - d);
        if third.abs() >= fourth.abs() {
            (x[0] * a * a - b * b + x[2]) / (2.0 * third)
        } else {
            (x[1] * a * a - d * d + x[3]) / (2.0 * fourth)
        }
    };
    Some((0..width).map(offset).collect())
}

#[cfg(test)]
mod tests {
    use super::Collinear;
    use crate::accuracy::position_error;
    use crate::minimal::linear::LeastSquares;
    use crate::minimal::node_kind::NodeKind;
    use crate::minimal::normalised::Normalised;
    use crate::pseudoranges::Pseudoranges;
    use crate::simulate::{Layout, SimulateOptions, simulate};

    /// Networks of many sizes with nodes of both kinds in one line, next to one, and off it: only
    /// the first are noticed, and the truth is one of as many networks as there are sides to lie
    /// on.
    #[test]
    fn nodes_in_one_line_are_noticed_and_the_networks_found() {
        for (receivers, transmitters) in [(6, 3), (5, 4), (4, 5), (7, 3), (6, 5), (4, 6)] {
            for seed in 0..50 {
                let mut options =
                    SimulateOptions { receivers, transmitters, noise: 0.0, seed, ..SimulateOptions::default() };
                options.layout = Layout::Normal;
                let plain = simulate(&options).unwrap().network;
                for distance in [1.0, 1e-3, 0.0] {
                    for kind in [NodeKind::Receivers, NodeKind::Transmitters] {
                        let name = format!("{receivers}r/{transmitters}s, seed {seed}, {kind}, {distance}");
                        let mut network = plain.clone();
                        let (nodes, others) = match kind {
                            NodeKind::Receivers => (&mut network.receivers, transmitters),
                            NodeKind::Transmitters => (&mut network.transmitters, receivers),
                        };
                        for x in nodes.iter_mut() {
                            x[1] *= distance;
                        }
                        let measured = Pseudoranges::new(receivers, transmitters, network.pseudoranges()).unwrap();
                        let data = Normalised::new(&measured);
                        let found = Collinear::find(data.parameters(), transmitters, &mut LeastSquares::default());
                        assert_eq!(found.as_ref().map(|c| c.kind), (distance == 0.0).then_some(kind), "{name}");
                        let Some(found) = found else { continue };
                        let networks: Vec<_> = found.networks().collect();
                        assert_eq!(networks.len(), 1 << (others - 1), "{name}");
                        let errors = networks.into_iter().map(|mut n| {
                            assert!(found.covers(&n), "{name}");
                            data.restore(&mut n);
                            position_error(&n, &network)
                        });
                        assert_eq!(errors.filter(|&e| e < 1e-6).count(), 1, "{name}");
                    }
                }
            }
        }
    }
}
