//! One more node from known ones: a transmitter with unknown offset from three or more receivers
//! (time differences of arrival), or a receiver from two or more transmitters with known offsets
//! (times of arrival).
//!
//! Minimal subsets of the measurements are solved in closed form, each solution is scored over all
//! measurements with the robust loss, and the best are polished by damped Gauss-Newton steps.
//! Outliers therefore do no harm as long as a subset without them is drawn.

use crate::loss::Loss;
use crate::plane::distance;

/// Most subsets that are tried for one node; fewer when there are no more.
const SUBSETS: usize = 32;

/// Most Gauss-Newton steps of a polish.
const STEPS: usize = 12;

/// One measurement of the wanted node: the known node's position and a length in metres. For a
/// wanted transmitter the length is the pseudorange. For a wanted receiver it is the pseudorange
/// minus the known transmitter's offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Position of the known node.
    pub position: [f64; 2],
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
pub struct Located {
    /// Its position.
    pub position: [f64; 2],
    /// Its offset in metres; 0 for a receiver.
    pub offset: f64,
    /// Sum of the loss over all sights.
    pub cost: f64,
}

/// A transmitter and its offset from sights of at least three receivers. `None` for fewer, or if
/// all subsets are degenerate (receivers in one point).
///
/// Three receivers give a line of solutions linear in p = o - f_1 and a quadratic for p (Bancroft's
/// equations in the plane); both roots with f_1 - o >= 0 are tried.
pub fn transmitter(sights: &[Sight], loss: &Loss) -> Option<Located> {
    let mut best = BestTwo::default();
    for_subsets(sights.len(), 3, |s| {
        for (position, offset) in from_three(&sights[s[0]], &sights[s[1]], &sights[s[2]]).into_iter().flatten() {
            best.offer(cost(sights, position, offset, loss), position, offset);
        }
    });
    best.polish(sights, true, loss)
}

/// A receiver from sights of at least two transmitters. With exactly two, or all in one line, its
/// mirror image fits as well; one of the two is returned. `None` for fewer than two sights or
/// coincident transmitters.
pub fn receiver(sights: &[Sight], loss: &Loss) -> Option<Located> {
    let mut best = BestTwo::default();
    for_subsets(sights.len(), 2, |s| {
        for position in from_two(&sights[s[0]], &sights[s[1]]).into_iter().flatten() {
            best.offer(cost(sights, position, 0.0, loss), position, 0.0);
        }
    });
    best.polish(sights, false, loss)
}

/// Places of a transmitter that a few sights of at least three receivers agree on, each polished
/// over all sights: the minima of the loss, cheapest first.
pub(crate) fn transmitters(sights: &[Sight], loss: &Loss) -> Vec<Located> {
    let mut starts = Vec::new();
    for_subsets(sights.len(), 3, |s| {
        let found = from_three(&sights[s[0]], &sights[s[1]], &sights[s[2]]).into_iter().flatten();
        starts.extend(found.map(|(p, offset)| Located { position: p, offset, cost: cost(sights, p, offset, loss) }));
    });
    minima(sights, starts, true, loss)
}

/// As [`transmitters`], places of a receiver from sights of at least two transmitters.
pub(crate) fn receivers(sights: &[Sight], loss: &Loss) -> Vec<Located> {
    let mut starts = Vec::new();
    for_subsets(sights.len(), 2, |s| {
        let found = from_two(&sights[s[0]], &sights[s[1]]).into_iter().flatten();
        starts.extend(found.map(|p| Located { position: p, offset: 0.0, cost: cost(sights, p, 0.0, loss) }));
    });
    minima(sights, starts, false, loss)
}

/// Different places that the cheapest starts lead to.
fn minima(sights: &[Sight], mut starts: Vec<Located>, with_offset: bool, loss: &Loss) -> Vec<Located> {
    starts.retain(|start| start.cost.is_finite());
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<Located> = Vec::new();
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
pub(crate) fn cost(sights: &[Sight], position: [f64; 2], offset: f64, loss: &Loss) -> f64 {
    loss.total(sights.iter().map(|s| (s.length - offset - distance(s.position, position)) * s.precision))
}

/// The two best solutions so far: an outlier's or a mirror image's basin may look better before the
/// polish.
#[derive(Default)]
struct BestTwo([Option<Located>; 2]);

impl BestTwo {
    fn offer(&mut self, cost: f64, position: [f64; 2], offset: f64) {
        let better = |other: &Option<Located>| other.is_none_or(|o| cost < o.cost);
        if !cost.is_finite() || !better(&self.0[1]) {
            return;
        }
        self.0[1] = Some(Located { position, offset, cost });
        if better(&self.0[0]) {
            self.0.swap(0, 1);
        }
    }

    fn polish(self, sights: &[Sight], with_offset: bool, loss: &Loss) -> Option<Located> {
        let polished = self.0.into_iter().flatten().map(|start| polish(sights, start, with_offset, loss));
        polished.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }
}

/// Calls `visit` with subsets of 0..count: all of them if there are at most [`SUBSETS`], otherwise
/// that many, spread evenly by a fixed rule.
fn for_subsets(count: usize, size: usize, mut visit: impl FnMut(&[usize])) {
    if count < size {
        return;
    }
    let total = if size == 2 { count * (count - 1) / 2 } else { count * (count - 1) * (count - 2) / 6 };
    if total <= SUBSETS {
        for a in 0..count {
            for b in a + 1..count {
                if size == 2 {
                    visit(&[a, b]);
                } else {
                    for c in b + 1..count {
                        visit(&[a, b, c]);
                    }
                }
            }
        }
        return;
    }
    // A linear congruential generator: the same subsets whenever the same node is located.
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % count
    };
    let mut visited = 0;
    while visited < SUBSETS {
        let s = [draw(), draw(), draw()];
        if s[0] != s[1] && (size == 2 || (s[0] != s[2] && s[1] != s[2])) {
            visit(&s[..size]);
            visited += 1;
        }
    }
}

fn from_three(a: &Sight, b: &Sight, c: &Sight) -> [Option<([f64; 2], f64)>; 2] {
    let (u, v) = (minus(b.position, a.position), minus(c.position, a.position));
    let (du, dv) = (b.length - a.length, c.length - a.length);
    let det = u[0] * v[1] - u[1] * v[0];
    // Subsets in line are as good as useless; others of the list will do better.
    if det.abs() <= 1e-9 * (dot(u, u) + dot(v, v)) {
        return [None, None];
    }
    let solve = |x: f64, y: f64| [(x * v[1] - y * u[1]) / det, (u[0] * y - v[0] * x) / det];
    let alpha = solve(0.5 * (dot(u, u) - du * du), 0.5 * (dot(v, v) - dv * dv));
    let beta = solve(du, dv);
    // |alpha + beta p|^2 = p^2 with p = o - f_a = -distance.
    let roots = quadratic(dot(beta, beta) - 1.0, dot(alpha, beta), dot(alpha, alpha));
    roots.map(|root| {
        let p = root.filter(|p| p.is_finite())?;
        let s = [alpha[0] + beta[0] * p, alpha[1] + beta[1] * p];
        Some(([a.position[0] + s[0], a.position[1] + s[1]], a.length + p.min(0.0)))
    })
}

fn from_two(a: &Sight, b: &Sight) -> [Option<[f64; 2]>; 2] {
    let axis = minus(b.position, a.position);
    let base = dot(axis, axis).sqrt();
    if base.is_nan() || base <= 0.0 {
        return [None, None];
    }
    // Along the axis by the law of cosines; circles that do not meet get the point between them.
    let along = ((a.length * a.length - b.length * b.length) / base + base) / 2.0;
    let across = (a.length * a.length - along * along).max(0.0).sqrt();
    let e = [axis[0] / base, axis[1] / base];
    let at = |h: f64| [a.position[0] + e[0] * along - e[1] * h, a.position[1] + e[1] * along + e[0] * h];
    [Some(at(across)), if across > 0.0 { Some(at(-across)) } else { None }]
}

/// Real roots of a x^2 + 2 b x + c, or the real part of a complex pair: with noise a double root
/// may become one.
fn quadratic(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let disc = (b * b - a * c).max(0.0).sqrt();
    let q = -(b + if b >= 0.0 { disc } else { -disc });
    let first = if a == 0.0 { None } else { Some(q / a) };
    let second = if q == 0.0 { None } else { Some(if disc > 0.0 { c / q } else { q / a }) };
    [first, second]
}

/// Damped Gauss-Newton steps with the weights of the loss, for position and (if asked) offset.
fn polish(sights: &[Sight], start: Located, with_offset: bool, loss: &Loss) -> Located {
    let mut best = start;
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let (mut h, mut g) = ([[0.0; 3]; 3], [0.0; 3]);
        for s in sights {
            let delta = minus(best.position, s.position);
            let d = dot(delta, delta).sqrt();
            if d == 0.0 {
                continue;
            }
            let e = (s.length - best.offset - d) * s.precision;
            let row = [delta[0] / d, delta[1] / d, if with_offset { 1.0 } else { 0.0 }];
            let w = loss.weight(e) * s.precision;
            for a in 0..3 {
                g[a] += w * row[a] * e;
                for b in 0..3 {
                    h[a][b] += w * s.precision * row[a] * row[b];
                }
            }
        }
        if !with_offset {
            h[2][2] = 1.0;
        }
        for a in 0..3 {
            h[a][a] *= 1.0 + damping;
        }
        let Some(step) = solve3(&h, &g) else { break };
        let position = [best.position[0] + step[0], best.position[1] + step[1]];
        let offset = best.offset + step[2];
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

/// Solves the symmetric system with the matrix xx, xy, yy; `None` if it is singular.
pub(crate) fn solve2(h: [f64; 3], g: [f64; 2]) -> Option<[f64; 2]> {
    let det = h[0] * h[2] - h[1] * h[1];
    if det > 1e-12 * h[0] * h[2] {
        Some([(h[2] * g[0] - h[1] * g[1]) / det, (h[0] * g[1] - h[1] * g[0]) / det])
    } else {
        None
    }
}

/// Solves a symmetric positive definite 3x3 system; `None` if it is singular.
pub(crate) fn solve3(h: &[[f64; 3]; 3], g: &[f64; 3]) -> Option<[f64; 3]> {
    let cross =
        |a: &[f64; 3], b: &[f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let cofactors = [cross(&h[1], &h[2]), cross(&h[2], &h[0]), cross(&h[0], &h[1])];
    let det: f64 = (0..3).map(|k| h[0][k] * cofactors[0][k]).sum();
    if !(det.is_finite() && det > 0.0) {
        return None;
    }
    Some([0, 1, 2].map(|k| (0..3).map(|a| cofactors[a][k] * g[a]).sum::<f64>() / det))
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{Layout, SimulateOptions, Simulation, simulate};

    const LOSS: Loss = Loss { nu: 2.0, scale: 1e-3 };

    fn simulation(seed: u64, receivers: usize, transmitters: usize) -> Simulation {
        let mut options = SimulateOptions { receivers, transmitters, seed, ..Default::default() };
        options.layout = Layout::Normal;
        simulate(&options).unwrap()
    }

    fn sights(known: &[[f64; 2]], lengths: impl Iterator<Item = f64>) -> Vec<Sight> {
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
        let coincident = vec![some[0]; 4];
        assert!(transmitter(&coincident, &LOSS).is_none());
        assert!(receiver(&coincident, &LOSS).is_none());
    }
}
