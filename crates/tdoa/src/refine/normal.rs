//! The damped normal equations of all nodes and clocks, reduced to receivers and clocks by the Schur complement over
//! the transmitters.
//!
//! The residual is e = f - o - |r - s|. With u the unit vector from receiver to transmitter and g =
//! (u, 1), its derivatives are u by the receiver and -g by transmitter and offset. Each transmitter
//! j has a 3x3 block (4x4 in space) C_j = sum w g g^T and couples to its receivers by -w u g^T. Eliminating it
//! therefore subtracts w_i w_k (g_i^T C_j^-1 g_k) u_i u_k^T from block (i, k): with C_j = L L^T,
//! this is the product B^T B of the columns w_i (L^-1 g_i) u_i^T. Unknowns of clocks follow the coordinates of the
//! receivers; the derivative of a residual by them continues u.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::prelude::default;
use faer::{MatMut, MatRef};
use hc::Monitor;
use std::array::from_fn;

use super::cancel::{Cancelled, apart, check};
use super::clock_block::ClockBlock;
use super::eliminate::{Batch, ROOM};
use crate::bordered::{Bordered, Placed};
use crate::distances::ReceiverDistance;
use crate::loss::Loss;
use crate::network::Network;
use crate::observations::{Node, Observations};
use crate::points::{dot, minus};

/// A transmitter that at most one in this many receivers hear is eliminated from their blocks alone.
const SPARSE: usize = 4;

/// Coordinates of receivers from which on factoring their equations takes some time.
const LONG: usize = 1000;

/// Transmitters that are eliminated between two looks at the monitor, and how many receivers hear one
/// that is looked at by itself.
const LOOK: usize = 64;

/// Buffers for one problem size; nothing is allocated after `new`, but for very many receivers.
pub(crate) struct Normal<const D: usize = 2> {
    receivers: usize,
    clocks: ClockBlock,
    /// Per observation: unit vector and weight.
    rays: Vec<([f64; D], f64)>,
    /// Per receiver: the lower triangle of its block by rows, and its gradient.
    receiver_blocks: Vec<([[f64; D]; D], [f64; D])>,
    /// Per distance between receivers: these, the unit vector between them, and its weight.
    between: Vec<([usize; 2], [f64; D], f64)>,
    /// Per transmitter: its block and its gradient.
    transmitter_blocks: Vec<(Bordered<D>, Placed<D>)>,
    /// Inverse Cholesky factors of the damped transmitter blocks.
    inverse_factors: Vec<Option<Bordered<D>>>,
    /// With room beyond its end.
    schur: Vec<f64>,
    /// Of the coordinates of receivers, then of the unknowns of clocks.
    reduced_steps: Vec<f64>,
    transmitter_steps: Vec<Placed<D>>,
    /// What transmitters couple to receivers and clocks.
    batch: Batch<D>,
    /// What a transmitter that few receivers hear couples to them: coordinates in ascending order, and their
    /// columns.
    few: Vec<(usize, Placed<D>)>,
    scratch: MemBuffer,
}

impl<const D: usize> Normal<D> {
    pub(crate) fn new(observations: &Observations<D>) -> Self {
        let (m, n) = (observations.receivers, observations.transmitters);
        let size = observations.reduced();
        let factor = llt::factor::cholesky_in_place_scratch::<f64>(size, Par::Seq, default());
        let solve = llt::solve::solve_in_place_scratch::<f64>(size, 1, Par::Seq);
        Normal {
            receivers: m,
            clocks: ClockBlock::new(observations),
            rays: vec![([0.0; D], 0.0); observations.len()],
            receiver_blocks: vec![([[0.0; D]; D], [0.0; D]); m],
            between: Vec::with_capacity(observations.distances().len()),
            transmitter_blocks: vec![(Bordered::ZERO, ([0.0; D], 0.0)); n],
            inverse_factors: vec![None; n],
            schur: vec![0.0; size * size + ROOM],
            reduced_steps: vec![0.0; size],
            transmitter_steps: vec![([0.0; D], 0.0); n],
            batch: Batch::new(size),
            few: Vec::with_capacity(D * m / SPARSE),
            scratch: MemBuffer::new(factor.or(solve)),
        }
    }

    /// Takes the derivatives at `network`; `residuals` are those of `observations.all()`, over
    /// their deviations, and of its pins. Distances between receivers have at least the standard deviation `softest`.
    pub(crate) fn linearise(
        &mut self,
        observations: &Observations<D>,
        network: &Network<D>,
        residuals: &[f64],
        loss: &Loss,
        softest: f64,
    ) {
        self.linearise_by(observations, network, residuals, |_, e| (loss.weight(e), e), |e| (loss.weight(e), e));
        self.expect(observations, network, loss, softest);
    }

    /// [`Normal::add_known`] among residuals of this loss.
    pub(super) fn expect(&mut self, observations: &Observations<D>, network: &Network<D>, loss: &Loss, softest: f64) {
        let weight = loss.prior_weight(observations.deviation());
        self.add_known(observations, network, weight, loss.nu.is_infinite(), softest);
    }

    /// Adds what is known of clocks and distances, whose log-likelihood has this weight, to equations that were linearised
    /// with [`Normal::linearise_by`]. Distances have at least the standard deviation `softest`.
    pub(super) fn add_known(
        &mut self,
        observations: &Observations<D>,
        network: &Network<D>,
        weight: f64,
        is_least_squares: bool,
        softest: f64,
    ) {
        if let Some(prior) = observations.clocks().prior() {
            self.clocks.expect(prior, network, weight);
        }
        for known in observations.distances() {
            let known = known.softened(softest);
            let (u, e) = (known.ray(&network.receivers).0, known.residual(&network.receivers));
            let w = weight * ReceiverDistance::weight(e, is_least_squares) / known.sigma.powi(2);
            for (i, towards) in known.receivers.into_iter().zip([1.0, -1.0]) {
                let (rows, gradient) = &mut self.receiver_blocks[i];
                for a in 0..D {
                    (0..=a).for_each(|b| rows[a][b] += w * u[b] * u[a]);
                    gradient[a] -= towards * w * e * known.sigma * u[a];
                }
            }
            self.between.push((known.receivers, u, w));
        }
    }

    /// Linearises under any loss, but for what is known of clocks and distances: `terms`, of the place of a measurement and its
    /// residual, and `pin_terms` give the weight and the residual that has, with that weight, the
    /// derivative of the loss.
    #[inline]
    pub(crate) fn linearise_by(
        &mut self,
        observations: &Observations<D>,
        network: &Network<D>,
        residuals: &[f64],
        terms: impl Fn(usize, f64) -> (f64, f64),
        pin_terms: impl Fn(f64) -> (f64, f64),
    ) {
        self.receiver_blocks.fill(([[0.0; D]; D], [0.0; D]));
        self.transmitter_blocks.fill((Bordered::ZERO, ([0.0; D], 0.0)));
        self.clocks.clear();
        self.between.clear();
        let (clock_terms, has_clocks) = (observations.clock_terms(), !self.clocks.is_empty());
        for (k, ((o, ray), &e)) in observations.all().iter().zip(&mut self.rays).zip(residuals).enumerate() {
            let between = minus(network.transmitters[o.transmitter], network.receivers[o.receiver]);
            let d = dot(between, between).sqrt();
            let u = if d > 0.0 { between.map(|x| x / d) } else { [0.0; D] };
            let (weight, e) = terms(k, e);
            let we = weight * o.precision;
            let w = we * o.precision;
            *ray = (u, w);
            if has_clocks {
                self.clocks.add(clock_terms.of(k), D * o.receiver, &u, w, we * e);
            }
            let (rows, gradient) = &mut self.receiver_blocks[o.receiver];
            let (block, placed) = &mut self.transmitter_blocks[o.transmitter];
            for a in 0..D {
                for b in 0..=a {
                    let square = w * u[b] * u[a];
                    rows[a][b] += square;
                    block.rows[a][b] += square;
                }
                gradient[a] -= we * e * u[a];
                placed.0[a] += we * e * u[a];
            }
            if observations.are_ranges() {
                // Offsets stay as they are.
                block.corner = 1.0;
                continue;
            }
            for a in 0..D {
                block.border[a] += w * u[a];
            }
            block.corner += w;
            placed.1 += we * e;
        }
        for (pin, &e) in observations.pins().iter().zip(&residuals[observations.len()..]) {
            let (weight, e) = pin_terms(e);
            let we = weight * pin.precision;
            match pin.node {
                Node::Receiver(i) => {
                    let (rows, gradient) = &mut self.receiver_blocks[i];
                    rows[pin.axis][pin.axis] += we * pin.precision;
                    gradient[pin.axis] += we * e;
                }
                Node::Transmitter(j) => {
                    let (block, placed) = &mut self.transmitter_blocks[j];
                    block.rows[pin.axis][pin.axis] += we * pin.precision;
                    placed.0[pin.axis] += we * e;
                }
            }
        }
    }

    /// Adds a pull with this weight of all nodes to a point to equations that were linearised with
    /// [`Normal::linearise_by`].
    pub(super) fn pull_together(&mut self, network: &Network<D>, to: [f64; D], weight: f64) {
        let receivers = self.receiver_blocks.iter_mut().map(|(rows, gradient)| (rows, gradient));
        let transmitters = self.transmitter_blocks.iter_mut().map(|(block, placed)| (&mut block.rows, &mut placed.0));
        for ((rows, gradient), at) in
            receivers.chain(transmitters).zip(network.receivers.iter().chain(&network.transmitters))
        {
            for k in 0..D {
                rows[k][k] += weight;
                gradient[k] += weight * (to[k] - at[k]);
            }
        }
    }

    /// Solves for a step with this damping (a factor on the diagonal); false if the equations are
    /// singular.
    pub(crate) fn solve(
        &mut self,
        observations: &Observations<D>,
        damping: f64,
        monitor: &Monitor,
    ) -> Result<bool, Cancelled> {
        self.reduce(observations, damping, monitor)?;
        if !self.factor(monitor)? {
            return Ok(false);
        }
        let size = self.reduced_steps.len();
        let schur = MatRef::from_column_major_slice(&self.schur[..size * size], size, size);
        let rhs = MatMut::from_column_major_slice_mut(&mut self.reduced_steps, size, 1);
        llt::solve::solve_in_place(schur, rhs, Par::Seq, MemStack::new(&mut self.scratch));
        self.substitute_back(observations);
        Ok(self.reduced_steps.iter().all(|x| x.is_finite()))
    }

    /// Replaces the Schur complement by its Cholesky factor; false if there is none.
    fn factor(&mut self, monitor: &Monitor) -> Result<bool, Cancelled> {
        let size = self.reduced_steps.len();
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
            Err(cancelled) => (Err(cancelled), vec![0.0; size * size + ROOM]),
        };
        self.schur = schur;
        is_definite
    }

    /// Logarithm of the determinant of the equations of all nodes, as linearised last; of the rigid
    /// motions, that of `damping` times the diagonal counts. `None` if they are singular.
    pub(crate) fn log_determinant(
        &mut self,
        observations: &Observations<D>,
        damping: f64,
        monitor: &Monitor,
    ) -> Result<Option<f64>, Cancelled> {
        if !self.solve(observations, damping, monitor)? {
            return Ok(None);
        }
        let size = self.reduced_steps.len();
        let reduced: f64 = (0..size).map(|k| self.schur[k * size + k].ln()).sum();
        let transmitters: f64 = self.inverse_factors.iter().flatten().map(|inverse| inverse.determinant().ln()).sum();
        Ok(Some(2.0 * (reduced - transmitters)))
    }

    /// Forms the Schur complement (lower triangle) and its right-hand side. A transmitter whose
    /// block is singular takes no part: it stays where it is and its measurements hold nothing.
    pub(crate) fn reduce(
        &mut self,
        observations: &Observations<D>,
        damping: f64,
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let size = self.reduced_steps.len();
        let grow = 1.0 + damping;
        // A node without usable measurements keeps a regular block and does not move.
        let trace = |rows: &[[f64; D]; D]| (0..D).map(|k| rows[k][k]).sum::<f64>();
        let floor = 1e-12 * self.receiver_blocks.iter().map(|(rows, _)| trace(rows)).fold(1e-300, f64::max);
        self.schur.fill(0.0);
        self.batch.clear();
        for (i, (rows, gradient)) in self.receiver_blocks.iter().enumerate() {
            let at = D * i;
            for a in 0..D {
                for b in 0..a {
                    self.schur[(at + b) * size + at + a] = rows[a][b];
                }
                self.schur[(at + a) * size + at + a] = rows[a][a] * grow + floor * damping;
                self.reduced_steps[at + a] = gradient[a];
            }
        }
        for ([a, b], u, w) in &self.between {
            let (row, column) = (D * a.max(b), D * a.min(b));
            for (k, x) in u.iter().enumerate() {
                for (l, y) in u.iter().enumerate() {
                    self.schur[(column + k) * size + row + l] -= w * x * y;
                }
            }
        }
        self.clocks.write(&mut self.schur, &mut self.reduced_steps, grow, floor * damping);
        let (mut first, terms) = (0, observations.clock_terms());
        for j in 0..observations.transmitters {
            let column = observations.of_transmitter(j);
            if j % LOOK == 0 || column.len() >= LOOK {
                check(monitor)?;
            }
            let places = first..first + column.len();
            first = places.end;
            let rays = &self.rays[places.clone()];
            let (block, gradient) = &self.transmitter_blocks[j];
            self.inverse_factors[j] = block.inverse_cholesky(grow, floor * damping);
            let Some(inverse) = self.inverse_factors[j] else {
                self.batch.take_off(&mut self.schur);
                for ((k, o), (u, w)) in places.zip(column).zip(rays) {
                    let at = D * o.receiver;
                    for a in 0..D {
                        for b in 0..=a {
                            self.schur[(at + b) * size + at + a] -= w * u[b] * u[a];
                        }
                    }
                    self.clocks.take_off(&mut self.schur, terms.of(k), at, u, *w);
                }
                continue;
            };
            let z = inverse.forward(*gradient);
            let coupled =
                |(u, w): &([f64; D], f64)| (inverse.forward((u.map(|u| w * u), observations.of_offset(*w))), *u);
            if SPARSE * column.len() <= self.receivers && self.clocks.is_empty() {
                // Few receivers: their blocks alone.
                self.batch.take_off(&mut self.schur);
                self.few.clear();
                for (o, ray) in column.iter().zip(rays) {
                    let ((y, last), u) = coupled(ray);
                    let at = D * o.receiver;
                    let place = |axis: usize| (at + axis, (y.map(|y| y * u[axis]), last * u[axis]));
                    // Candidates of one cell stand side by side, and add up.
                    let same = self.few.len().checked_sub(D).filter(|&first| self.few[first].0 == at);
                    match same {
                        None => self.few.extend((0..D).map(place)),
                        Some(first) => {
                            for (axis, (_, (p, end))) in self.few[first..].iter_mut().enumerate() {
                                let (_, (more, more_end)) = place(axis);
                                (0..D).for_each(|k| p[k] += more[k]);
                                *end += more_end;
                            }
                        }
                    }
                }
                for (a, &(column, (p, last))) in self.few.iter().enumerate() {
                    for (g, z) in p.into_iter().chain([last]).zip(z.0.into_iter().chain([z.1])) {
                        self.reduced_steps[column] += g * z;
                    }
                    for &(row, (x, end)) in &self.few[a..] {
                        self.schur[column * size + row] -= dot(p, x) + last * end;
                    }
                }
                continue;
            }
            let rows = self.batch.next(&mut self.schur);
            for ((k, o), ray) in places.zip(column).zip(rays) {
                let ((y, last), u) = coupled(ray);
                let (at, terms) = (D * o.receiver, terms.of(k));
                for (row, y) in rows.chunks_exact_mut(size + ROOM).zip(y.into_iter().chain([last])) {
                    // Candidates of one cell add up.
                    row[at..at + D].iter_mut().zip(u).for_each(|(entry, u)| *entry += y * u);
                    terms.iter().for_each(|&(at, x)| row[at] += y * x);
                }
            }
            for (row, z) in rows.chunks_exact(size + ROOM).zip(z.0.into_iter().chain([z.1])) {
                for (g, b) in self.reduced_steps.iter_mut().zip(row) {
                    *g += b * z;
                }
            }
        }
        self.batch.take_off(&mut self.schur);
        self.hold(observations.held());
        Ok(())
    }

    /// Makes the equations of held receivers say that they do not move.
    fn hold(&mut self, held: &[bool]) {
        let size = self.reduced_steps.len();
        for at in (0..D * self.receivers).filter(|&k| held[k / D]) {
            for column in 0..at {
                self.schur[column * size + at] = 0.0;
            }
            self.schur[at * size + at + 1..(at + 1) * size].fill(0.0);
            self.schur[at * size + at] = 1.0;
            self.reduced_steps[at] = 0.0;
        }
    }

    fn substitute_back(&mut self, observations: &Observations<D>) {
        let (mut first, terms) = (0, observations.clock_terms());
        for j in 0..observations.transmitters {
            let column = observations.of_transmitter(j);
            let (mut rhs, mut last) = self.transmitter_blocks[j].1;
            for ((k, o), (u, w)) in (first..).zip(column).zip(&self.rays[first..]) {
                let at = D * o.receiver;
                let mut along = w * (0..D).map(|k| u[k] * self.reduced_steps[at + k]).sum::<f64>();
                terms.of(k).iter().for_each(|&(at, x)| along += w * x * self.reduced_steps[at]);
                rhs = from_fn(|k| rhs[k] + along * u[k]);
                last += observations.of_offset(along);
            }
            first += column.len();
            self.transmitter_steps[j] = match &self.inverse_factors[j] {
                Some(inverse) => inverse.invert((rhs, last)),
                None => ([0.0; D], 0.0),
            };
        }
    }

    /// `target` = `network` + step.
    pub(crate) fn step(&self, observations: &Observations<D>, network: &Network<D>, target: &mut Network<D>) {
        for (i, (to, from)) in target.receivers.iter_mut().zip(&network.receivers).enumerate() {
            *to = from_fn(|k| from[k] + self.reduced_steps[D * i + k]);
        }
        for (j, (position, offset)) in self.transmitter_steps.iter().enumerate() {
            let from = network.transmitters[j];
            target.transmitters[j] = from_fn(|k| from[k] + position[k]);
            target.offsets[j] = network.offsets[j] + offset;
        }
        target.clocks.clone_from(&network.clocks);
        observations.clocks().add(target, &self.reduced_steps[D * self.receivers..], 1.0);
    }

    /// The Schur complement of the last `reduce`, lower triangle, column-major: as many rows as there are reduced
    /// unknowns.
    pub(crate) fn schur(&self) -> &[f64] {
        let size = self.reduced_steps.len();
        &self.schur[..size * size]
    }

    /// Inverse Cholesky factor of a transmitter's block, of the last `reduce`; `None` if the block
    /// is singular.
    pub(crate) fn inverse_factor(&self, j: usize) -> Option<&Bordered<D>> {
        self.inverse_factors[j].as_ref()
    }

    /// How a transmitter and its offset follow a way of a receiver along each of its rays, or what a clock adds to a residual,
    /// of the last `reduce`; none where its block is singular.
    pub(crate) fn gains(&self, observations: &Observations<D>, j: usize) -> Vec<Placed<D>> {
        let Some(factor) = self.inverse_factor(j) else { return Vec::new() };
        let rays = &self.rays[observations.places(j)];
        rays.iter().map(|(u, w)| factor.invert((u.map(|u| w * u), observations.of_offset(*w)))).collect()
    }

    /// Unit vectors and weights of the last `linearise`, in the order of the observations.
    pub(crate) fn rays(&self) -> &[([f64; D], f64)] {
        &self.rays
    }
}

/// Replaces a column-major matrix, of which the lower triangle counts, by its Cholesky factor; false
/// if it is not positive definite.
fn cholesky(matrix: &mut [f64], size: usize, scratch: &mut MemBuffer) -> bool {
    let matrix = MatMut::from_column_major_slice_mut(&mut matrix[..size * size], size, size);
    llt::factor::cholesky_in_place(matrix, default(), Par::Seq, MemStack::new(scratch), default()).is_ok()
}

#[cfg(test)]
mod tests;
