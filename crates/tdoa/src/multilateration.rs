//! One more node from known ones: a transmitter with unknown offset from three or more receivers
//! (time differences of arrival), or a receiver from two or more transmitters with known offsets
//! (times of arrival). In space it takes one more of each.
//!
//! Minimal subsets of the measurements are solved in closed form, each solution is scored over all
//! measurements with the robust loss, and the best are polished by damped Gauss-Newton steps.
//! Outliers therefore do no harm as long as a subset without them is drawn.

mod closed;
mod subsets;

use std::array::from_fn;

use crate::bordered::{Bordered, Placed};
use crate::loss::Loss;
use crate::points::{distance, dot, minus};
use subsets::for_subsets;

/// Most Gauss-Newton steps of a polish.
const STEPS: usize = 12;

/// One measurement of the wanted node: the known node's position and a length in metres. For a
/// wanted transmitter the length is the pseudorange. For a wanted receiver it is the pseudorange
/// minus the known transmitter's offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight<const D: usize = 2> {
    /// Position of the known node.
    pub position: [f64; D],
    /// Pseudorange (wanted transmitter) or distance (wanted receiver), metres.
    pub length: f64,
    /// Factor on the residual before the loss is applied: 1, or one over the measurement's standard
    /// deviation.
    pub precision: f64,
}

/// Largest numbers of starts that are polished, and of places of one node that are returned.
const MOST_STARTS: usize = 24;
const MOST_PLACES: usize = 5;

/// A node found by multilateration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located<const D: usize = 2> {
    /// Its position.
    pub position: [f64; D],
    /// Its offset in metres; 0 for a receiver.
    pub offset: f64,
    /// Sum of the loss over all sights.
    pub cost: f64,
}

/// A transmitter and its offset from sights of at least three receivers, four in space. `None` for
/// fewer, or if all subsets are degenerate (receivers in one line or, in space, in one plane).
///
/// As many receivers give a line of solutions linear in p = o - f_1 and a quadratic for p (Bancroft's
/// equations); both roots with f_1 - o >= 0 are tried.
pub fn transmitter<const D: usize>(sights: &[Sight<D>], loss: &Loss) -> Option<Located<D>> {
    let mut best = BestTwo::default();
    each_transmitter(sights, |position, offset| best.offer(cost(sights, position, offset, loss), position, offset));
    best.polish(sights, true, loss)
}

/// A receiver from sights of at least two transmitters, three in space. With exactly as many, or all
/// in one line (in space: in one plane), its mirror image fits as well; one of the two is returned.
/// `None` for fewer sights or coincident transmitters (in space: for transmitters in one line).
pub fn receiver<const D: usize>(sights: &[Sight<D>], loss: &Loss) -> Option<Located<D>> {
    let mut best = BestTwo::default();
    each_receiver(sights, |position| best.offer(cost(sights, position, 0.0, loss), position, 0.0));
    best.polish(sights, false, loss)
}

/// Places of a transmitter that a few sights agree on, as few as determine it, each polished over all
/// sights: the minima of the loss, cheapest first.
pub(crate) fn transmitters<const D: usize>(sights: &[Sight<D>], loss: &Loss) -> Vec<Located<D>> {
    let mut starts = Vec::new();
    each_transmitter(sights, |position, offset| {
        starts.push(Located { position, offset, cost: cost(sights, position, offset, loss) });
    });
    minima(sights, starts, true, loss)
}

/// Places of a receiver, by distances from transmitters.
pub(crate) fn receivers<const D: usize>(sights: &[Sight<D>], loss: &Loss) -> Vec<Located<D>> {
    let mut starts = Vec::new();
    each_receiver(sights, |position| {
        starts.push(Located { position, offset: 0.0, cost: cost(sights, position, 0.0, loss) });
    });
    minima(sights, starts, false, loss)
}

/// Transmitters and offsets that small subsets of the sights give.
fn each_transmitter<const D: usize>(sights: &[Sight<D>], mut visit: impl FnMut([f64; D], f64)) {
    for_subsets(sights.len(), D + 1, D + 1, |subset| {
        let at = |k: usize| (sights[subset[k]].position, sights[subset[k]].length);
        closed::transmitter(at).into_iter().flatten().for_each(|(position, offset)| visit(position, offset));
    });
}

/// Receivers that small subsets of the sights give.
fn each_receiver<const D: usize>(sights: &[Sight<D>], mut visit: impl FnMut([f64; D])) {
    for_subsets(sights.len(), D, D + 1, |subset| {
        let at = |k: usize| (sights[subset[k]].position, sights[subset[k]].length);
        closed::receiver(at).into_iter().flatten().for_each(&mut visit);
    });
}

/// Different places that the cheapest starts lead to.
fn minima<const D: usize>(
    sights: &[Sight<D>],
    mut starts: Vec<Located<D>>,
    with_offset: bool,
    loss: &Loss,
) -> Vec<Located<D>> {
    starts.retain(|start| start.cost.is_finite());
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<Located<D>> = Vec::new();
    for start in starts.into_iter().take(MOST_STARTS) {
        let place = polish(sights, start, with_offset, loss);
        if !kept.iter().any(|k| distance(k.position, place.position) < loss.scale) {
            kept.push(place);
        }
    }
    kept.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    kept.truncate(MOST_PLACES);
    kept
}

/// Sum of the loss over the sights.
pub(crate) fn cost<const D: usize>(sights: &[Sight<D>], position: [f64; D], offset: f64, loss: &Loss) -> f64 {
    loss.total(sights.iter().map(|s| (s.length - offset - distance(s.position, position)) * s.precision))
}

/// The two best solutions so far: an outlier's or a mirror image's basin may look better before the
/// polish.
struct BestTwo<const D: usize>([Option<Located<D>>; 2]);

impl<const D: usize> Default for BestTwo<D> {
    fn default() -> Self {
        BestTwo([None; 2])
    }
}

impl<const D: usize> BestTwo<D> {
    fn offer(&mut self, cost: f64, position: [f64; D], offset: f64) {
        let better = |other: &Option<Located<D>>| other.is_none_or(|o| cost < o.cost);
        if !cost.is_finite() || !better(&self.0[1]) {
            return;
        }
        self.0[1] = Some(Located { position, offset, cost });
        if better(&self.0[0]) {
            self.0.swap(0, 1);
        }
    }

    fn polish(self, sights: &[Sight<D>], with_offset: bool, loss: &Loss) -> Option<Located<D>> {
        let polished = self.0.into_iter().flatten().map(|start| polish(sights, start, with_offset, loss));
        polished.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }
}

/// Damped Gauss-Newton steps with the weights of the loss, for position and (if asked) offset.
pub(crate) fn polish<const D: usize>(
    sights: &[Sight<D>],
    start: Located<D>,
    with_offset: bool,
    loss: &Loss,
) -> Located<D> {
    let mut best = start;
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let (mut h, mut g) = (Bordered::ZERO, ([0.0; D], 0.0));
        for s in sights {
            let delta = minus(best.position, s.position);
            let d = dot(delta, delta).sqrt();
            if d == 0.0 {
                continue;
            }
            let e = (s.length - best.offset - d) * s.precision;
            let row = delta.map(|x| x / d);
            let w = loss.weight(e) * s.precision;
            for a in 0..D {
                g.0[a] += w * row[a] * e;
                for b in 0..D {
                    h.rows[a][b] += w * s.precision * row[a] * row[b];
                }
            }
            if with_offset {
                g.1 += w * e;
                for a in 0..D {
                    h.border[a] += w * s.precision * row[a];
                }
                h.corner += w * s.precision;
            }
        }
        if !with_offset {
            h.corner = 1.0;
        }
        for a in 0..D {
            h.rows[a][a] *= 1.0 + damping;
        }
        h.corner *= 1.0 + damping;
        let Some(step) = solve(&h, g) else { break };
        let position = from_fn(|k| best.position[k] + step.0[k]);
        let offset = best.offset + step.1;
        let next = cost(sights, position, offset, loss);
        if next < best.cost {
            let done = best.cost - next < 1e-9 * best.cost;
            best = Located { position, offset, cost: next };
            damping *= 0.1;
            if done {
                break;
            }
        } else {
            damping = (damping * 10.0).max(1e-6);
            if damping > 1e3 {
                break;
            }
        }
    }
    best
}

/// Solves symmetric positive definite equations; `None` if they are singular.
pub(crate) fn solve<const D: usize>(h: &Bordered<D>, (g, last): Placed<D>) -> Option<Placed<D>> {
    if D != 2 {
        return Some(h.cholesky(1.0, 0.0)?.solve((g, last)));
    }
    // Three equations by their cofactors.
    let (rows, [x, y]) = (&h.rows, [h.border[0], h.border[1]]);
    let matrix = [[rows[0][0], rows[0][1], x], [rows[1][0], rows[1][1], y], [x, y, h.corner]];
    let step = solve3(&matrix, &[g[0], g[1], last])?;
    Some((from_fn(|k| step[k]), step[2]))
}

/// Solves symmetric positive definite equations, of which the upper half counts; `None` if they are
/// singular.
pub(crate) fn solve_symmetric<const D: usize>(h: &[[f64; D]; D], g: [f64; D]) -> Option<[f64; D]> {
    if D != 2 {
        let rows = from_fn(|a| from_fn(|b| if a < b { h[a][b] } else { h[b][a] }));
        let matrix = Bordered { rows, border: [0.0; D], corner: 1.0 };
        return Some(matrix.cholesky(1.0, 0.0)?.solve((g, 0.0)).0);
    }
    let solved = solve2([h[0][0], h[0][1], h[1][1]], [g[0], g[1]])?;
    Some(from_fn(|k| solved[k]))
}

/// Solves the symmetric system with the matrix xx, xy, yy; `None` if it is singular.
fn solve2(h: [f64; 3], g: [f64; 2]) -> Option<[f64; 2]> {
    let det = h[0] * h[2] - h[1] * h[1];
    if det > 1e-12 * h[0] * h[2] {
        Some([(h[2] * g[0] - h[1] * g[1]) / det, (h[0] * g[1] - h[1] * g[0]) / det])
    } else {
        None
    }
}

/// Solves a symmetric positive definite 3x3 system; `None` if it is singular.
fn solve3(h: &[[f64; 3]; 3], g: &[f64; 3]) -> Option<[f64; 3]> {
    let cross =
        |a: &[f64; 3], b: &[f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let cofactors = [cross(&h[1], &h[2]), cross(&h[2], &h[0]), cross(&h[0], &h[1])];
    let det: f64 = (0..3).map(|k| h[0][k] * cofactors[0][k]).sum();
    if !(det.is_finite() && det > 0.0) {
        return None;
    }
    Some([0, 1, 2].map(|k| (0..3).map(|a| cofactors[a][k] * g[a]).sum::<f64>() / det))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::simulate::{Layout, SimulateOptions, Simulation, simulate};

    const LOSS: Loss = Loss { nu: 2.0, scale: 1e-3 };

    fn simulation(seed: u64, receivers: usize, transmitters: usize) -> Simulation {
        let mut options = SimulateOptions { receivers, transmitters, seed, ..Default::default() };
        options.layout = Layout::Normal;
        simulate(&options).unwrap()
    }

    fn sights<const D: usize>(known: &[[f64; D]], lengths: impl Iterator<Item = f64>) -> Vec<Sight<D>> {
        known.iter().zip(lengths).map(|(&position, length)| Sight { position, length, precision: 1.0 }).collect()
    }

    #[test]
    fn clean_measurements_give_the_node_back() {
        // Fewest measurements that fix the node up to a finite choice plus one.
        for seed in 0..200 {
            let truth = simulation(seed, 4, 3).network;
            let to_transmitter = sights(&truth.receivers, (0..4).map(|i| truth.pseudorange(i, 0)));
            let found = transmitter(&to_transmitter, &LOSS).unwrap();
            assert!(found.cost < 1e-12, "seed {seed}: {found:?}");
            let to_receiver = sights(&truth.transmitters, (0..3).map(|j| truth.distance(0, j)));
            let found = receiver(&to_receiver, &LOSS).unwrap();
            assert!(distance(found.position, truth.receivers[0]) < 1e-6, "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn clean_measurements_give_the_node_back_in_space() {
        for seed in 0..200 {
            let truth: Network<3> = random(5, 4, seed);
            let to_transmitter = sights(&truth.receivers, (0..5).map(|i| truth.pseudorange(i, 0)));
            let found = transmitter(&to_transmitter, &LOSS).unwrap();
            assert!(distance(found.position, truth.transmitters[0]) < 1e-6, "seed {seed}: {found:?}");
            assert!((found.offset - truth.offsets[0]).abs() < 1e-6, "seed {seed}: {found:?}");
            let to_receiver = sights(&truth.transmitters, (0..4).map(|j| truth.distance(0, j)));
            let found = receiver(&to_receiver, &LOSS).unwrap();
            assert!(distance(found.position, truth.receivers[0]) < 1e-6, "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn three_transmitters_leave_a_receiver_and_its_mirror_image_in_space() {
        for seed in 0..50 {
            let truth: Network<3> = random(1, 3, seed);
            let to_receiver = sights(&truth.transmitters, (0..3).map(|j| truth.distance(0, j)));
            let places = receivers(&to_receiver, &LOSS);
            assert!(places.len() <= 2 && places.iter().all(|place| place.cost < 1e-12), "seed {seed}: {places:?}");
            let near = places.iter().any(|place| distance(place.position, truth.receivers[0]) < 1e-5);
            assert!(near, "seed {seed}: {places:?}");
        }
    }

    #[test]
    fn a_quarter_of_outliers_does_no_harm_in_space() {
        for seed in 0..100 {
            let truth: Network<3> = random(12, 12, seed);
            let wrong = |k: usize| if k.is_multiple_of(4) { 1.0 + k as f64 } else { 0.0 };
            let to_transmitter = sights(&truth.receivers, (0..12).map(|i| truth.pseudorange(i, 0) + wrong(i)));
            let found = transmitter(&to_transmitter, &LOSS).unwrap();
            assert!(distance(found.position, truth.transmitters[0]) < 1e-3, "seed {seed}: {found:?}");
            let to_receiver = sights(&truth.transmitters, (0..12).map(|j| truth.distance(0, j) + wrong(j)));
            let found = receiver(&to_receiver, &LOSS).unwrap();
            assert!(distance(found.position, truth.receivers[0]) < 1e-3, "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn a_third_of_outliers_does_no_harm() {
        for seed in 0..100 {
            let truth = simulation(seed, 12, 12).network;
            let wrong = |k: usize| if k.is_multiple_of(3) { 1.0 + k as f64 } else { 0.0 };
            let to_transmitter = sights(&truth.receivers, (0..12).map(|i| truth.pseudorange(i, 0) + wrong(i)));
            let found = transmitter(&to_transmitter, &LOSS).unwrap();
            assert!(distance(found.position, truth.transmitters[0]) < 1e-3, "seed {seed}: {found:?}");
            assert!((found.offset - truth.offsets[0]).abs() < 1e-3);
            let to_receiver = sights(&truth.transmitters, (0..12).map(|j| truth.distance(0, j) + wrong(j)));
            let found = receiver(&to_receiver, &LOSS).unwrap();
            assert!(distance(found.position, truth.receivers[0]) < 1e-3, "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn too_little_gives_nothing() {
        let truth = simulation(0, 4, 4).network;
        let some = sights(&truth.receivers, (0..4).map(|i| truth.pseudorange(i, 0)));
        assert!(transmitter(&some[..2], &LOSS).is_none());
        assert!(receiver(&some[..1], &LOSS).is_none());
        let truth: Network<3> = random(4, 4, 0);
        let known = sights(&truth.receivers, (0..4).map(|i| truth.pseudorange(i, 0)));
        assert!(transmitter(&known[..3], &LOSS).is_none() && receiver(&known[..2], &LOSS).is_none());
        let in_one_line = sights(&[[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]], [1.0, 2.0, 2.5, 1.5].into_iter());
        assert!(transmitter(&in_one_line, &LOSS).is_none() && receiver(&in_one_line, &LOSS).is_none());
        let coincident = vec![some[0]; 4];
        assert!(transmitter(&coincident, &LOSS).is_none());
        assert!(receiver(&coincident, &LOSS).is_none());
    }
}
