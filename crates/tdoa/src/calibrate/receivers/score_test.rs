//! Receivers with errors of their own: a delay, a clock that drifts or jumps, a receiver that was moved.
//!
//! Such an error is a column beside the Jacobian: its contribution to the residuals of one receiver. The part of the
//! column that no motion of the nodes produces is compared with the residuals (a score test). The column that explains
//! most is added to the model, and the test goes on with what remains.

use std::array::from_fn;

use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind};
use crate::calibrate::receivers::significance::{doubt, least_surprise, surprise};
use crate::calibrate::search::deviation::{inlier_deviation, spread_of_receiver, spread_of_residuals};
use crate::calibrate::search::mixture::Mixture;
use crate::multilateration::solve_symmetric;
use crate::network::Network;
use crate::observations::Observations;
use crate::points;
use crate::refine::{Cancelled, Projection, check, dot};
use hc::Monitor;

/// Measurements before and after an event between which a jump or a move is looked for.
pub(crate) const SIDE: usize = 4;

/// Receivers whose columns are projected; in larger networks those with the most telling residuals.
const PROJECTED: usize = 24;

/// Errors that a score test finds.
#[derive(Default)]
pub(crate) struct Suspects<const D: usize> {
    /// Errors of single receivers, most telling first.
    pub(crate) found: Vec<Fault<D>>,
    /// Those beside that are worth a doubt.
    pub(crate) doubted: Vec<Fault<D>>,
}

/// Errors of single receivers that the residuals at a network show. `deviation` is that of the measurements; receivers in `unmoved` are known not to have been moved.
pub(crate) fn find<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    deviation: f64,
    threshold: f64,
    unmoved: &[usize],
    monitor: &Monitor,
) -> Result<Suspects<D>, Cancelled> {
    // An error of one receiver makes residuals larger than the noise: the test takes the deviation
    // that they have.
    let wide = spread_of_residuals(observations, network).max(deviation);
    let wide = inlier_deviation(observations, network, wide, threshold);
    // What the robust loss has given up of a receiver is what tells of its error: all cells near
    // its own spread take part.
    let reach: Vec<f64> = (0..observations.receivers).map(|i| spread_of_receiver(observations, network, i)).collect();
    let kept = observations.subset(|o| o.residual(network).abs() <= threshold * wide.max(reach[o.receiver]));
    let residuals: Vec<f64> = kept.all().iter().map(|o| o.residual(network)).collect();
    told(&kept, network, &residuals, unmoved, monitor)
}

/// Errors of single receivers where errors of measurements are one-sided. The test takes what each measurement says of its length (the
/// scores of the mixture), in which late ones hardly count, in place of residuals.
pub(crate) fn find_one_sided<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    mixture: &Mixture,
    monitor: &Monitor,
) -> Result<Suspects<D>, Cancelled> {
    let step = mixture.deviation / mixture.information();
    let scores: Vec<f64> = observations.all().iter().map(|o| step * mixture.score(o.residual(network))).collect();
    told(observations, network, &scores, &[], monitor)
}

/// Errors that values tell of, one for each measurement.
fn told<const D: usize>(
    kept: &Observations<D>,
    network: &Network<D>,
    values: &[f64],
    unmoved: &[usize],
    monitor: &Monitor,
) -> Result<Suspects<D>, Cancelled> {
    let redundancy = kept.len().saturating_sub(kept.unknowns());
    if redundancy < 4 {
        return Ok(Suspects::default());
    }
    let Some(projection) = Projection::new(kept, network, monitor)? else { return Ok(Suspects::default()) };
    let (rest, _) = projection.off(values);
    Test { kept, projection, rest, taken: Vec::new(), redundancy: redundancy as f64, unmoved, monitor }.run()
}

/// How many errors of a kind are tested among these receivers and measurements.
pub(crate) fn tests(kind: ReceiverErrorKind, receivers: usize, measurements: usize) -> f64 {
    match kind {
        ReceiverErrorKind::Delay | ReceiverErrorKind::Drift => receivers as f64,
        ReceiverErrorKind::Jump | ReceiverErrorKind::Move => measurements as f64,
    }
}

struct Test<'a, const D: usize> {
    kept: &'a Observations<D>,
    projection: Projection<'a, D>,
    /// What neither the network nor the errors found so far explain.
    rest: Vec<f64>,
    /// Orthonormal parts of the columns of these, that no motion makes.
    taken: Vec<Vec<f64>>,
    redundancy: f64,
    unmoved: &'a [usize],
    monitor: &'a Monitor,
}

impl<const D: usize> Test<'_, D> {
    fn run(mut self) -> Result<Suspects<D>, Cancelled> {
        let (mut found, mut doubted) = (Vec::<Fault<D>>::new(), Vec::new());
        let rows = self.rows();
        while found.len() < self.kept.receivers / 2 {
            let known = |fault: &Fault<D>| {
                found.iter().any(|f| f.receiver == fault.receiver && f.kind == fault.kind)
                    || fault.kind == ReceiverErrorKind::Move && self.unmoved.contains(&fault.receiver)
            };
            let candidates = self.candidates(&rows)?;
            // A candidate of each kind has as many rivals as that kind has tests.
            let least = |kind| least_surprise(tests(kind, self.kept.receivers, self.kept.len()));
            let mut judged = Vec::new();
            for fault in candidates.into_iter().filter(|fault| !known(fault)) {
                check(self.monitor)?;
                let Some((gain, fault, columns)) = self.judge(fault, &rows) else { continue };
                let told = surprise(gain, self.redundancy - columns.len() as f64, columns.len());
                judged.push((told - least(fault.kind), fault, columns));
            }
            judged.sort_by(|a, b| b.0.total_cmp(&a.0));
            doubted = judged.iter().filter(|(lead, ..)| *lead > -doubt()).map(|(_, fault, _)| *fault).collect();
            let Some((_, fault, columns)) = judged.into_iter().next().filter(|(lead, ..)| *lead >= 0.0) else { break };
            found.push(fault);
            if fault.kind == ReceiverErrorKind::Move {
                // A move is large against what a linear model sees of it: what remains may be its
                // own.
                break;
            }
            for column in columns {
                self.take(column);
            }
            self.redundancy -= 1.0;
        }
        doubted.retain(|doubt| found.iter().all(|fault| fault.receiver != doubt.receiver));
        Ok(Suspects { found, doubted })
    }

    /// Places of the measurements of each receiver, in the order of the transmitters.
    fn rows(&self) -> Vec<Vec<usize>> {
        let mut rows = vec![Vec::new(); self.kept.receivers];
        for (k, o) in self.kept.all().iter().enumerate() {
            rows[o.receiver].push(k);
        }
        rows
    }

    /// The most promising error of each kind and receiver, by the residuals alone.
    fn candidates(&self, rows: &[Vec<usize>]) -> Result<Vec<Fault<D>>, Cancelled> {
        let mut all: Vec<(f64, Fault<D>)> = Vec::new();
        for (receiver, row) in rows.iter().enumerate() {
            if row.len() < 3 {
                continue;
            }
            let fault = |kind, from| Fault::new(receiver, kind, from);
            let mut best = [(f64::NEG_INFINITY, 0); 2];
            let before = self.sums(row.iter());
            let mut after = self.sums(row.iter().rev());
            after.reverse();
            for at in SIDE..(row.len() + 1).saturating_sub(SIDE) {
                check(self.monitor)?;
                let from = self.kept.all()[row[at]].transmitter;
                let scores = from_fn(|power| before[at].explained()[power] + after[at].explained()[power]);
                for (best, score) in best.iter_mut().zip::<[f64; 2]>(scores) {
                    if score > best.0 {
                        *best = (score, from);
                    }
                }
            }
            let whole = before[row.len()].explained()[0].max(best[0].0).max(best[1].0);
            all.push((whole, fault(ReceiverErrorKind::Delay, 0)));
            all.push((whole, fault(ReceiverErrorKind::Drift, 0)));
            for (best, kind) in best.into_iter().zip([ReceiverErrorKind::Jump, ReceiverErrorKind::Move]) {
                if best.0.is_finite() {
                    all.push((whole, fault(kind, best.1)));
                }
            }
        }
        // The sort is stable: the kinds of one receiver stay together.
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        all.truncate(4 * PROJECTED);
        Ok(all.into_iter().map(|(_, fault)| fault).collect())
    }

    /// Sums over none of the measurements of a receiver, the first, the first two, and so on to all.
    fn sums<'k>(&self, row: impl Iterator<Item = &'k usize>) -> Vec<Sums<D>> {
        let none = Sums { sum: 0.0, square: 0.0, g: [0.0; D], h: [[0.0; D]; D] };
        let next = |sums: &mut Sums<D>, &k: &usize| {
            let (p, u) = (self.kept.all()[k].precision, self.projection.ray(k));
            *sums = sums.and(self.rest[k] * p, p * p, u);
            Some(*sums)
        };
        std::iter::once(none).chain(row.scan(none, next)).collect()
    }

    /// The gain of taking an error into the model, with its size, and the parts of its columns that
    /// nothing else explains. `None` where it explains nothing.
    fn judge(&self, fault: Fault<D>, rows: &[Vec<usize>]) -> Option<(f64, Fault<D>, Vec<Vec<f64>>)> {
        let n = self.kept.transmitters;
        let is_move = fault.kind == ReceiverErrorKind::Move;
        let column = |axis: usize| -> Vec<f64> {
            let mut column = vec![0.0; self.kept.len()];
            for &k in &rows[fault.receiver] {
                let o = &self.kept.all()[k];
                let along = if is_move { -self.projection.ray(k)[axis] } else { 1.0 };
                column[k] = o.precision * fault.shape(o.transmitter, n) * along;
            }
            let plain: f64 = column.iter().map(|x| x * x).sum();
            let mut left = self.projection.off(&column).0;
            for other in &self.taken {
                let part = dot(&left, other);
                for (x, y) in left.iter_mut().zip(other) {
                    *x -= part * y;
                }
            }
            // What the network or another error absorbs to rounding cannot be told.
            if dot(&left, &left) < 1e-6 * plain { Vec::new() } else { left }
        };
        let columns: Vec<Vec<f64>> = (0..if is_move { D } else { 1 }).map(column).collect();
        if columns.iter().any(Vec::is_empty) {
            return None;
        }
        let solve = |h: &[[f64; D]; D], g: [f64; D]| -> Option<[f64; D]> {
            if is_move { solve_symmetric(h, g) } else { Some(from_fn(|a| if a == 0 { g[0] / h[0][0] } else { 0.0 })) }
        };
        let products = |weight: &dyn Fn(usize) -> f64| -> [[f64; D]; D] {
            let mut h = [[0.0; D]; D];
            for k in 0..self.kept.len() {
                let w = weight(k);
                for (row, x) in h.iter_mut().zip(&columns) {
                    for (entry, y) in row.iter_mut().zip(&columns) {
                        *entry += w * x[k] * y[k];
                    }
                }
            }
            h
        };
        let g = from_fn(|a| columns.get(a).map_or(0.0, |column| dot(column, &self.rest)));
        let size = solve(&products(&|_| 1.0), g)?;
        let explained = points::dot(size, g);
        let total = dot(&self.rest, &self.rest);
        let count = columns.len() as f64;
        // Under normal noise explained / total follows Beta(q/2, (k-q)/2), whose tail for one or two
        // columns is at most (1 - x)^((k - q)/2).
        let tail = |x: f64| -0.5 * (self.redundancy - count) * (-x.min(1.0)).ln_1p();
        // Receivers of uneven noise: with the spread of the residuals that the column meets. The
        // smaller gain counts.
        let left =
            |k: usize| columns.iter().zip(size).fold(self.rest[k], |rest, (column, size)| rest - size * column[k]);
        let correction = self.kept.len() as f64 / (self.redundancy - count).max(1.0);
        let s = solve(&products(&|k| correction * left(k).powi(2)), g)?;
        let squared = points::dot(s, g);
        let uneven = squared / (squared + self.redundancy - count);
        let gain = tail(explained / total).min(tail(uneven));
        Some((gain, Fault { size, gain, ..fault }, columns))
    }

    /// Takes a column into the model.
    fn take(&mut self, mut column: Vec<f64>) {
        let length = dot(&column, &column).sqrt();
        for x in column.iter_mut() {
            *x /= length;
        }
        let part = dot(&self.rest, &column);
        for (x, y) in self.rest.iter_mut().zip(&column) {
            *x -= part * y;
        }
        self.taken.push(column);
    }
}

/// Sums over measurements of a receiver, by which errors of these are fitted to the residuals.
#[derive(Clone, Copy)]
struct Sums<const D: usize> {
    /// Of the residuals.
    sum: f64,
    /// Of the squares of the precisions.
    square: f64,
    /// Gradient and normal equations of a motion of the receiver.
    g: [f64; D],
    h: [[f64; D]; D],
}

impl<const D: usize> Sums<D> {
    /// With one more: the residual times the precision, the square of that, and the unit vector to the transmitter.
    fn and(&self, v: f64, square: f64, u: [f64; D]) -> Self {
        Sums {
            sum: self.sum + v,
            square: self.square + square,
            g: from_fn(|a| self.g[a] + u[a] * v),
            h: from_fn(|a| from_fn(|b| self.h[a][b] + square * u[a] * u[b])),
        }
    }

    /// How much of the squares of the residuals one length explains, and a motion of the receiver.
    fn explained(&self) -> [f64; 2] {
        let motion = solve_symmetric(&self.h, self.g).map_or(0.0, |s| points::dot(s, self.g));
        [self.sum * self.sum / self.square, motion]
    }
}

#[cfg(test)]
mod tests;
