//! The damped normal equations of all nodes, reduced to the receivers by the Schur complement over
//! the transmitters.
//!
//! The residual is e = f - o - |r - s|. With u the unit vector from receiver to transmitter and g =
//! (u, 1), its derivatives are u by the receiver and -g by transmitter and offset. Each transmitter
//! j has a 3x3 block C_j = sum w g g^T and couples to its receivers by -w u g^T. Eliminating it
//! therefore subtracts w_i w_k (g_i^T C_j^-1 g_k) u_i u_k^T from block (i, k): with C_j = L L^T,
//! this is the product B^T B of the columns w_i (L^-1 g_i) u_i^T.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::prelude::default;
use faer::{MatMut, MatRef};
use hc::Monitor;
use hc::poly::simd::{Isa, Kernel};

use super::cancel::{Cancelled, apart, check};
use crate::loss::Loss;
use crate::network::Network;
use crate::observations::Observations;

/// A transmitter that at most one in this many receivers hear is eliminated from their blocks alone.
const SPARSE: usize = 4;

/// Coordinates of receivers from which on factoring their equations takes some time.
const LONG: usize = 1000;

/// Transmitters that are eliminated between two looks at the monitor, and how many receivers hear one
/// that is looked at by itself.
const LOOK: usize = 64;

/// Buffers for one problem size; nothing is allocated after `new`, but for very many receivers.
pub(crate) struct Normal {
    receivers: usize,
    /// Per observation: unit vector and weight.
    rays: Vec<([f64; 2], f64)>,
    /// Per receiver: xx, xy, yy of its block, and its gradient.
    receiver_blocks: Vec<([f64; 3], [f64; 2])>,
    /// Per transmitter: lower triangle of its block by rows, and its gradient.
    transmitter_blocks: Vec<([f64; 6], [f64; 3])>,
    /// Inverse Cholesky factors of the damped transmitter blocks, by rows.
    inverse_factors: Vec<Option<[f64; 6]>>,
    schur: Vec<f64>,
    receiver_steps: Vec<f64>,
    transmitter_steps: Vec<[f64; 3]>,
    /// Three rows: what a transmitter couples to the receivers, in the frame in which its block is
    /// the identity.
    coupling: Vec<f64>,
    /// The same for a transmitter that few receivers hear: coordinates in ascending order, and their
    /// columns.
    few: Vec<(usize, [f64; 3])>,
    isa: Isa,
    scratch: MemBuffer,
}

impl Normal {
    pub(crate) fn new(observations: &Observations) -> Self {
        let (m, n) = (observations.receivers, observations.transmitters);
        let factor = llt::factor::cholesky_in_place_scratch::<f64>(2 * m, Par::Seq, default());
        let solve = llt::solve::solve_in_place_scratch::<f64>(2 * m, 1, Par::Seq);
        Normal {
            receivers: m,
            rays: vec![([0.0; 2], 0.0); observations.len()],
            receiver_blocks: vec![([0.0; 3], [0.0; 2]); m],
            transmitter_blocks: vec![([0.0; 6], [0.0; 3]); n],
            inverse_factors: vec![None; n],
            schur: vec![0.0; 4 * m * m],
            receiver_steps: vec![0.0; 2 * m],
            transmitter_steps: vec![[0.0; 3]; n],
            coupling: vec![0.0; 6 * m],
            few: Vec::with_capacity(2 * m / SPARSE),
            isa: Isa::detect(),
            scratch: MemBuffer::new(factor.or(solve)),
        }
    }

    /// Takes the derivatives at `network`; `residuals` are those of `observations.all()`, over
    /// their deviations, and of its pins.
    pub(crate) fn linearise(&mut self, observations: &Observations, network: &Network, residuals: &[f64], loss: &Loss) {
        self.linearise_by(observations, network, residuals, |_, e| (loss.weight(e), e), |e| (loss.weight(e), e));
    }

    /// As [`Normal::linearise`] for any loss: `terms`, of the place of a measurement and its
    /// residual, and `pin_terms` give the weight and the residual that has, with that weight, the
    /// derivative of the loss.
    #[inline]
    pub(crate) fn linearise_by(
        &mut self,
        observations: &Observations,
        network: &Network,
        residuals: &[f64],
        terms: impl Fn(usize, f64) -> (f64, f64),
        pin_terms: impl Fn(f64) -> (f64, f64),
    ) {
        self.receiver_blocks.fill(([0.0; 3], [0.0; 2]));
        self.transmitter_blocks.fill(([0.0; 6], [0.0; 3]));
        for (k, ((o, ray), &e)) in observations.all().iter().zip(&mut self.rays).zip(residuals).enumerate() {
            let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
            let (dx, dy) = (s[0] - r[0], s[1] - r[1]);
            let d = (dx * dx + dy * dy).sqrt();
            let u = if d > 0.0 { [dx / d, dy / d] } else { [0.0; 2] };
            let (weight, e) = terms(k, e);
            let we = weight * o.precision;
            let w = we * o.precision;
            *ray = (u, w);
            let (h, g) = &mut self.receiver_blocks[o.receiver];
            let (xx, xy, yy) = (w * u[0] * u[0], w * u[0] * u[1], w * u[1] * u[1]);
            *h = [h[0] + xx, h[1] + xy, h[2] + yy];
            *g = [g[0] - we * e * u[0], g[1] - we * e * u[1]];
            let (h, g) = &mut self.transmitter_blocks[o.transmitter];
            *h = [h[0] + xx, h[1] + xy, h[2] + yy, h[3] + w * u[0], h[4] + w * u[1], h[5] + w];
            *g = [g[0] + we * e * u[0], g[1] + we * e * u[1], g[2] + we * e];
        }
        for (pin, &e) in observations.pins().iter().zip(&residuals[observations.len()..]) {
            let (weight, e) = pin_terms(e);
            let we = weight * pin.precision;
            let (h, g) = &mut self.receiver_blocks[pin.receiver];
            h[2 * pin.axis] += we * pin.precision;
            g[pin.axis] += we * e;
        }
    }

    /// Solves for a step with this damping (a factor on the diagonal); false if the equations are
    /// singular.
    pub(crate) fn solve(
        &mut self,
        observations: &Observations,
        damping: f64,
        monitor: &Monitor,
    ) -> Result<bool, Cancelled> {
        self.reduce(observations, damping, monitor)?;
        if !self.factor(monitor)? {
            return Ok(false);
        }
        let size = 2 * self.receivers;
        let schur = MatRef::from_column_major_slice(&self.schur, size, size);
        let rhs = MatMut::from_column_major_slice_mut(&mut self.receiver_steps, size, 1);
        llt::solve::solve_in_place(schur, rhs, Par::Seq, MemStack::new(&mut self.scratch));
        self.substitute_back(observations);
        Ok(self.receiver_steps.iter().all(|x| x.is_finite()))
    }

    /// Replaces the Schur complement by its Cholesky factor; false if there is none.
    fn factor(&mut self, monitor: &Monitor) -> Result<bool, Cancelled> {
        let size = 2 * self.receivers;
        if size < LONG {
            return Ok(cholesky(&mut self.schur, size, &mut self.scratch));
        }
        let mut schur = std::mem::take(&mut self.schur);
        let factored = apart(monitor, true, move || {
            let mut scratch = MemBuffer::new(llt::factor::cholesky_in_place_scratch::<f64>(size, Par::Seq, default()));
            (cholesky(&mut schur, size, &mut scratch), schur)
        });
        let (is_definite, schur) = match factored {
            Ok((is_definite, schur)) => (Ok(is_definite), schur),
            Err(cancelled) => (Err(cancelled), vec![0.0; size * size]),
        };
        self.schur = schur;
        is_definite
    }

    /// Logarithm of the determinant of the equations of all nodes, as linearised last; of the rigid
    /// motions, that of `damping` times the diagonal counts. `None` if they are singular.
    pub(crate) fn log_determinant(
        &mut self,
        observations: &Observations,
        damping: f64,
        monitor: &Monitor,
    ) -> Result<Option<f64>, Cancelled> {
        if !self.solve(observations, damping, monitor)? {
            return Ok(None);
        }
        let size = 2 * self.receivers;
        let receivers: f64 = (0..size).map(|k| self.schur[k * size + k].ln()).sum();
        let transmitters: f64 =
            self.inverse_factors.iter().flatten().map(|inverse| (inverse[0] * inverse[2] * inverse[5]).ln()).sum();
        Ok(Some(2.0 * (receivers - transmitters)))
    }

    /// Forms the Schur complement (lower triangle) and its right-hand side. A transmitter whose
    /// block is singular takes no part: it stays where it is and its measurements hold nothing.
    pub(crate) fn reduce(
        &mut self,
        observations: &Observations,
        damping: f64,
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let size = 2 * self.receivers;
        let grow = 1.0 + damping;
        // A node without usable measurements keeps a regular block and does not move.
        let floor = 1e-12 * self.receiver_blocks.iter().map(|(h, _)| h[0] + h[2]).fold(1e-300, f64::max);
        self.schur.fill(0.0);
        for (i, (h, g)) in self.receiver_blocks.iter().enumerate() {
            let at = 2 * i * size + 2 * i;
            self.schur[at] = h[0] * grow + floor * damping;
            self.schur[at + 1] = h[1];
            self.schur[at + size + 1] = h[2] * grow + floor * damping;
            self.receiver_steps[2 * i] = g[0];
            self.receiver_steps[2 * i + 1] = g[1];
        }
        let mut first = 0;
        for j in 0..observations.transmitters {
            let column = observations.of_transmitter(j);
            if j % LOOK == 0 || column.len() >= LOOK {
                check(monitor)?;
            }
            let rays = &self.rays[first..first + column.len()];
            first += column.len();
            let (h, g) = &self.transmitter_blocks[j];
            self.inverse_factors[j] = inverse_factor(h, grow, floor * damping);
            let Some(inverse) = self.inverse_factors[j] else {
                for (o, (u, w)) in column.iter().zip(rays) {
                    let at = 2 * o.receiver * size + 2 * o.receiver;
                    self.schur[at] -= w * u[0] * u[0];
                    self.schur[at + 1] -= w * u[0] * u[1];
                    self.schur[at + size + 1] -= w * u[1] * u[1];
                }
                continue;
            };
            let z = forward(&inverse, *g);
            let coupled = |(u, w): &([f64; 2], f64)| (forward(&inverse, [w * u[0], w * u[1], *w]), *u);
            if SPARSE * column.len() <= self.receivers {
                // Few receivers: their blocks alone.
                self.few.clear();
                for (o, ray) in column.iter().zip(rays) {
                    let (y, u) = coupled(ray);
                    let at = 2 * o.receiver;
                    self.few.extend((0..2).map(|axis| (at + axis, y.map(|y| y * u[axis]))));
                }
                for (a, &(column, [p, q, r])) in self.few.iter().enumerate() {
                    for (g, z) in [p, q, r].into_iter().zip(z) {
                        self.receiver_steps[column] += g * z;
                    }
                    for &(row, [x, y, z]) in &self.few[a..] {
                        self.schur[column * size + row] -= p * x + q * y + r * z;
                    }
                }
                continue;
            }
            let rows = &mut self.coupling;
            rows.fill(0.0);
            for (o, ray) in column.iter().zip(rays) {
                let (y, u) = coupled(ray);
                let at = 2 * o.receiver;
                for (row, y) in rows.chunks_exact_mut(size).zip(y) {
                    row[at] = y * u[0];
                    row[at + 1] = y * u[1];
                }
            }
            for (row, z) in rows.chunks_exact(size).zip(z) {
                for (g, b) in self.receiver_steps.iter_mut().zip(row) {
                    *g += b * z;
                }
            }
            self.isa.run(Eliminate { schur: &mut self.schur, rows });
        }
        self.hold(observations.held());
        Ok(())
    }

    /// Makes the equations of held receivers say that they do not move.
    fn hold(&mut self, held: &[bool]) {
        let size = 2 * self.receivers;
        for at in (0..size).filter(|&k| held[k / 2]) {
            for column in 0..at {
                self.schur[column * size + at] = 0.0;
            }
            self.schur[at * size + at + 1..(at + 1) * size].fill(0.0);
            self.schur[at * size + at] = 1.0;
            self.receiver_steps[at] = 0.0;
        }
    }

    fn substitute_back(&mut self, observations: &Observations) {
        let mut first = 0;
        for j in 0..observations.transmitters {
            let column = observations.of_transmitter(j);
            let mut rhs = self.transmitter_blocks[j].1;
            for (o, (u, w)) in column.iter().zip(&self.rays[first..]) {
                let i = 2 * o.receiver;
                let along = w * (u[0] * self.receiver_steps[i] + u[1] * self.receiver_steps[i + 1]);
                rhs = [rhs[0] + along * u[0], rhs[1] + along * u[1], rhs[2] + along];
            }
            first += column.len();
            self.transmitter_steps[j] = match &self.inverse_factors[j] {
                Some(inverse) => backward(inverse, forward(inverse, rhs)),
                None => [0.0; 3],
            };
        }
    }

    /// `target` = `network` + step.
    pub(crate) fn step(&self, network: &Network, target: &mut Network) {
        for (k, (to, from)) in target.receivers.iter_mut().zip(&network.receivers).enumerate() {
            *to = [from[0] + self.receiver_steps[2 * k], from[1] + self.receiver_steps[2 * k + 1]];
        }
        for (j, step) in self.transmitter_steps.iter().enumerate() {
            let from = network.transmitters[j];
            target.transmitters[j] = [from[0] + step[0], from[1] + step[1]];
            target.offsets[j] = network.offsets[j] + step[2];
        }
    }

    /// The Schur complement of the last `reduce`, lower triangle, column-major, 2m x 2m.
    pub(crate) fn schur(&self) -> &[f64] {
        &self.schur
    }

    /// Inverse Cholesky factor of a transmitter's block, of the last `reduce`; `None` if the block
    /// is singular.
    pub(crate) fn inverse_factor(&self, j: usize) -> Option<&[f64; 6]> {
        self.inverse_factors[j].as_ref()
    }

    /// Unit vectors and weights of the last `linearise`, in the order of the observations.
    pub(crate) fn rays(&self) -> &[([f64; 2], f64)] {
        &self.rays
    }
}

/// Replaces a column-major matrix, of which the lower triangle counts, by its Cholesky factor; false
/// if it is not positive definite.
fn cholesky(matrix: &mut [f64], size: usize, scratch: &mut MemBuffer) -> bool {
    let matrix = MatMut::from_column_major_slice_mut(matrix, size, size);
    llt::factor::cholesky_in_place(matrix, default(), Par::Seq, MemStack::new(scratch), default()).is_ok()
}

/// Subtracts `B^T B` from the lower triangle of a column-major matrix; `B` has three rows, one
/// after the other.
struct Eliminate<'a> {
    schur: &'a mut [f64],
    rows: &'a [f64],
}

impl Kernel for Eliminate<'_> {
    type Output = ();
    const WIDEST: Isa = Isa::Avx512;

    #[inline(always)]
    fn run(self) {
        let size = self.rows.len() / 3;
        let (first, rest) = self.rows.split_at(size);
        let (second, third) = rest.split_at(size);
        for (k, column) in self.schur.chunks_exact_mut(size).enumerate() {
            let (a, b, c) = (first[k], second[k], third[k]);
            // Receivers that have no measurement.
            if a == 0.0 && b == 0.0 && c == 0.0 {
                continue;
            }
            for (((entry, x), y), z) in column[k..].iter_mut().zip(&first[k..]).zip(&second[k..]).zip(&third[k..]) {
                *entry -= a * x + b * y + c * z;
            }
        }
    }
}

/// Inverse of the Cholesky factor of a 3x3 block with its diagonal times `grow` plus `floor`.
fn inverse_factor(h: &[f64; 6], grow: f64, floor: f64) -> Option<[f64; 6]> {
    let a = h[0] * grow + floor;
    let l0 = a.sqrt();
    let l1 = h[1] / l0;
    let b = h[2] * grow + floor - l1 * l1;
    let l2 = b.sqrt();
    let l3 = h[3] / l0;
    let l4 = (h[4] - l1 * l3) / l2;
    let c = h[5] * grow + floor - l3 * l3 - l4 * l4;
    let l5 = c.sqrt();
    if !(a > 0.0 && b > 0.0 && c > 0.0 && (1.0 / (l0 * l2 * l5)).is_finite()) {
        return None;
    }
    let (i0, i2, i5) = (1.0 / l0, 1.0 / l2, 1.0 / l5);
    let i1 = -l1 * i0 * i2;
    let i4 = -l4 * i2 * i5;
    let i3 = -(l3 * i0 + l4 * i1) * i5;
    Some([i0, i1, i2, i3, i4, i5])
}

/// Lower triangular times vector.
pub(crate) fn forward(l: &[f64; 6], x: [f64; 3]) -> [f64; 3] {
    [l[0] * x[0], l[1] * x[0] + l[2] * x[1], l[3] * x[0] + l[4] * x[1] + l[5] * x[2]]
}

/// Its transpose times vector.
pub(crate) fn backward(l: &[f64; 6], x: [f64; 3]) -> [f64; 3] {
    [l[0] * x[0] + l[1] * x[1] + l[3] * x[2], l[2] * x[1] + l[4] * x[2], l[5] * x[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refine::NetworkRefiner;
    use crate::simulate::{SimulateOptions, simulate};

    #[test]
    fn inverse_factor_inverts_the_block() {
        let h = [4.0, 1.0, 3.0, -0.5, 0.7, 2.0];
        let inverse = inverse_factor(&h, 1.0, 0.0).unwrap();
        let x = [0.3, -1.2, 0.8];
        let hx = [
            h[0] * x[0] + h[1] * x[1] + h[3] * x[2],
            h[1] * x[0] + h[2] * x[1] + h[4] * x[2],
            h[3] * x[0] + h[4] * x[1] + h[5] * x[2],
        ];
        let back = backward(&inverse, forward(&inverse, hx));
        for k in 0..3 {
            assert!((back[k] - x[k]).abs() < 1e-14);
        }
        assert!(inverse_factor(&[1.0, 2.0, 1.0, 0.0, 0.0, 1.0], 1.0, 0.0).is_none());
    }

    /// The Schur complement block by block, as the front of this module gives it.
    #[test]
    fn transmitters_that_few_or_many_hear_are_eliminated_as_defined() {
        for hearing in [None, Some(6)] {
            let options = SimulateOptions { receivers: 30, transmitters: 20, hearing, ..Default::default() };
            let simulation = simulate(&options).unwrap();
            let network = &simulation.network;
            let observations = Observations::new(&simulation.pseudoranges, |_, _| true);
            let mut refiner = NetworkRefiner::new(&observations, f64::INFINITY);
            let normal = refiner.normal_at(network, &Loss { nu: f64::INFINITY, scale: 1.0 }).unwrap();
            let size = 60;
            let mut expected = vec![0.0; size * size];
            for j in 0..observations.transmitters {
                let factor = normal.inverse_factor(j).unwrap();
                let rays: Vec<(usize, [f64; 2])> = (observations.of_transmitter(j).iter())
                    .map(|o| {
                        let (r, s) = (network.receivers[o.receiver], network.transmitters[j]);
                        let d = network.distance(o.receiver, j);
                        (2 * o.receiver, [(s[0] - r[0]) / d, (s[1] - r[1]) / d])
                    })
                    .collect();
                for &(i, u) in &rays {
                    for &(k, v) in &rays {
                        let solved = backward(factor, forward(factor, [v[0], v[1], 1.0]));
                        let own = if i == k { 1.0 } else { 0.0 };
                        let between = own - (u[0] * solved[0] + u[1] * solved[1] + solved[2]);
                        for (a, u) in u.iter().enumerate() {
                            for (b, v) in v.iter().enumerate() {
                                expected[(k + b) * size + i + a] += between * u * v;
                            }
                        }
                    }
                }
            }
            for column in 0..size {
                for row in column..size {
                    let at = column * size + row;
                    assert!((normal.schur()[at] - expected[at]).abs() < 1e-10, "{hearing:?} {row} {column}");
                }
            }
        }
    }
}
