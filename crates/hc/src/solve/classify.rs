//! From the ends of paths to solutions: multiplicities, and which singular ends are isolated.

use super::excess::Excess;
use super::paths::Ends;
use super::solutions::{Direction, Solution, Solutions, is_real};
use crate::distinct::{CLUSTER, coincidences, groups, relative_distance};
use crate::family::PathCounts;
use crate::linalg::Lu;
use crate::random::{Random, Stream};
use crate::refine::{Refined, Refiner};
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{Evaluate, SparseSystem};

/// Imaginary parts of regular solutions up to this share of the point count as zero.
const REAL: f64 = 1e-10;
/// The same for singular solutions, which are less accurate.
const REAL_SINGULAR: f64 = 1e-7;

/// Condition number from which the Jacobian counts as singular to working precision.
const SINGULAR: f64 = 1e13;

/// Residuals relative to the sizes of the terms from which a singular point does not solve an
/// equation.
const EXCESS_SINGULAR: f64 = 1e-6;

/// What the ends of all paths amount to.
#[derive(Debug, Default)]
pub(super) struct Classified {
    /// Isolated solutions.
    pub(super) solutions: Vec<Solution>,
    /// Points on components of positive dimension.
    pub(super) component_points: Vec<Vec<Complex64>>,
    /// Paths that end there.
    pub(super) on_components: usize,
    /// Paths that end at points that were not asked for.
    pub(super) excess: usize,
    pub(super) infinite: usize,
    pub(super) directions: Vec<Direction>,
    pub(super) lost: usize,
    pub(super) dropped: usize,
}

impl Classified {
    /// Without what is known of the start system; `tracked` paths, of which `retracked` were run
    /// again.
    pub(super) fn solutions(self, tracked: usize, retracked: usize) -> Solutions {
        Solutions {
            paths: self.counts(tracked, retracked),
            on_components: self.on_components,
            component_points: self.component_points,
            excess: self.excess,
            directions: self.directions,
            solutions: self.solutions,
            ..Solutions::default()
        }
    }

    /// How `tracked` paths ended; `retracked` tracks were run again.
    fn counts(&self, tracked: usize, retracked: usize) -> PathCounts {
        PathCounts {
            tracked,
            finite: tracked - self.infinite - self.lost - self.dropped,
            at_infinity: self.infinite,
            failed: self.lost,
            dropped: self.dropped,
            retracked,
        }
    }
}

/// Sorts ends into solutions; `member` is the system with its coefficients. Without it, singular
/// ends are lost.
pub(super) fn classify(
    member: Option<(&SparseSystem, &[Complex64])>,
    all: &Ends,
    excess: &Excess,
    coincidence: f64,
) -> Classified {
    let mut out = Classified::default();
    let regular: Vec<&Refined> = all.regular.values().collect();
    let mut repeated = vec![false; regular.len()];
    for group in coincidences(regular.iter().enumerate().map(|(k, r)| (k, &r.point[..])), coincidence) {
        group[1..].iter().for_each(|&k| repeated[k] = true);
    }
    for (refined, _) in regular.iter().zip(&repeated).filter(|(_, again)| !**again) {
        if excess.contains_regular(&refined.point) {
            out.excess += 1;
        } else {
            out.solutions.push(regular_solution(refined));
        }
    }
    (out.lost, out.dropped) = (all.lost, all.dropped);
    out.infinite = all.directions.iter().map(|(_, _, paths)| paths).sum();
    let directions = all.directions.iter().cloned();
    out.directions =
        directions.map(|(valuations, denominator, paths)| Direction { valuations, denominator, paths }).collect();

    let singular: Vec<(&[Complex64], usize, f64)> =
        all.singular.values().map(|end| (&end.point[..], end.winding, end.error)).collect();
    let Some((system, target)) = member else {
        out.lost += singular.len();
        return out;
    };
    let mut local = Local::new(system, target);
    let mut refiner = Refiner::new(system);
    for group in groups(singular.iter().enumerate().map(|(k, s)| (k, s.0)), CLUSTER) {
        // The most accurate of the ends stands for all.
        let Some(&best) = group.iter().min_by(|&&a, &&b| singular[a].2.total_cmp(&singular[b].2)) else { continue };
        let point = singular[best].0;
        if excess.contains(point, EXCESS_SINGULAR) {
            out.excess += group.len();
            continue;
        }
        let judged = refiner.judged(target, point);
        // At an isolated singular point two paths end at least.
        let lonely = group.len() == 1 && point.len() > 1 && judged.condition > SINGULAR;
        if lonely || local.on_component(point, group.len()) {
            out.on_components += group.len();
            out.component_points.push(point.to_vec());
            continue;
        }
        out.solutions.push(Solution {
            value: point.to_vec(),
            multiplicity: group.len(),
            winding_number: group.iter().map(|&k| singular[k].1).max().unwrap_or(1),
            singular: true,
            real: is_real(point, REAL_SINGULAR),
            residual: local.residual(point, &scale(point)),
            condition: judged.condition,
            certified: None,
        });
    }
    out
}

fn regular_solution(refined: &Refined) -> Solution {
    Solution {
        value: refined.point.clone(),
        multiplicity: 1,
        winding_number: 1,
        singular: false,
        real: is_real(&refined.point, REAL),
        residual: refined.residual,
        condition: refined.condition,
        certified: None,
    }
}

/// Tells whether solutions near a singular one form a component of positive dimension: slices by
/// random linear equations that move away from the point meet such a component in solutions of the
/// system, and an isolated point in none.
struct Local<'a> {
    system: &'a SparseSystem,
    target: &'a [Complex64],
    sizes: Vec<Complex64>,
    memory: <SparseSystem as Evaluate>::Memory<Complex64>,
    values: Vec<Complex64>,
    jacobian: Vec<Complex64>,
    lu: Lu<Complex64>,
}

/// At the farthest slice an isolated point of multiplicity `m` must leave a residual of about this:
/// its distance to the power of `m`.
const VISIBLE: f64 = 1e-9;
/// The farthest slice is at least at this relative distance, and this is how many lead up to it,
/// each at half the distance of the next.
const FARTHEST: f64 = 1e-4;
const SLICES: i32 = 5;
/// Points from which slices are tried.
const STARTS: u64 = 24;
/// Residuals relative to the sizes of the terms that count as zero.
const ZERO: f64 = 1e-13;
/// Components of higher dimension are not looked for.
const MAX_DIMENSION: usize = 4;

impl<'a> Local<'a> {
    fn new(system: &'a SparseSystem, target: &'a [Complex64]) -> Self {
        let n = system.variables();
        let zero = Complex64::new(0.0, 0.0);
        Local {
            system,
            target,
            sizes: target.iter().map(|c| c.norm().into()).collect(),
            memory: system.memory(Isa::Portable),
            values: vec![zero; n],
            jacobian: vec![zero; n * n],
            lu: Lu::new(n, Isa::Portable),
        }
    }

    /// Whether a point at which `paths` paths end lies on a component of positive dimension.
    fn on_component(&mut self, point: &[Complex64], paths: usize) -> bool {
        if point.len() == 1 {
            return false; // a polynomial in one unknown that is not zero
        }
        let farthest = VISIBLE.powf(1.0 / paths as f64).clamp(FARTHEST, 0.25);
        let dimensions = MAX_DIMENSION.min(point.len());
        (1..=dimensions).any(|dimension| self.meets_slices(point, dimension, farthest, 0))
            || (1..STARTS).any(|start| self.meets_slices(point, 1, farthest, start))
    }

    /// Follows the solution in `dimension` slices `v (x - point) = distance` away from the point.
    ///
    /// Where components cross, Newton's method has no direction at the point itself: all but start
    /// 0 begin beside it.
    fn meets_slices(&mut self, point: &[Complex64], dimension: usize, farthest: f64, start: u64) -> bool {
        let n = point.len();
        let scale = scale(point);
        let mut random = Random::new(dimension as u64, Stream::Slice(start));
        let slopes: Vec<Vec<Complex64>> =
            (0..dimension).map(|_| (0..n).map(|j| random.unit() / scale[j]).collect()).collect();
        let offsets: Vec<Complex64> = (0..dimension).map(|_| random.unit()).collect();
        let mix: Vec<Complex64> = (0..n * dimension).map(|_| random.unit()).collect();
        let nearest = farthest * 0.5f64.powi(SLICES - 1);
        let aside = if start == 0 { 0.0 } else { nearest };
        let mut x: Vec<Complex64> = point.iter().zip(&scale).map(|(p, s)| p + random.unit() * (aside * s)).collect();
        for slice in 0..SLICES {
            let distance = nearest * 2f64.powi(slice);
            let mut last = f64::INFINITY;
            for _ in 0..12 {
                self.system.jacobian(&mut self.memory, &x, self.target, &mut self.values, &mut self.jacobian);
                for (d, slope) in slopes.iter().enumerate() {
                    let moved: Complex64 = (0..n).map(|j| slope[j] * (x[j] - point[j])).sum();
                    for i in 0..n {
                        let factor = mix[d * n + i];
                        self.values[i] += factor * (moved - offsets[d] * distance);
                        (0..n).for_each(|j| self.jacobian[j * n + i] += factor * slope[j]);
                    }
                }
                let weights: Vec<[f64; 1]> = scale.iter().map(|s| [s * s]).collect();
                self.lu.factor(&self.jacobian, &weights);
                self.lu.solve(&mut self.values);
                x.iter_mut().zip(&self.values).for_each(|(x, d)| *x -= d);
                last = self.values.iter().zip(&scale).map(|(d, s)| d.norm() / s).fold(0.0, f64::max);
                if last.is_nan() || last < 1e-13 {
                    break;
                }
            }
            let astray = x.iter().zip(point).zip(&scale).any(|((x, p), s)| (x - p).norm() > 20.0 * distance * s);
            if last.is_nan() || last > 1e-9 || astray || self.residual(&x, &scale) > ZERO {
                return false;
            }
        }
        relative_distance(&x, point) > 1e-3 * farthest
    }

    /// Largest residual relative to the sizes of the terms of its equation, in which coordinates
    /// count for 1 % of `scale` at least.
    fn residual(&mut self, x: &[Complex64], scale: &[f64]) -> f64 {
        self.system.values(&mut self.memory, x, self.target, &mut self.values);
        let residuals: Vec<f64> = self.values.iter().map(|v| v.norm()).collect();
        let absolute: Vec<Complex64> = x.iter().zip(scale).map(|(z, s)| z.norm().max(0.01 * s).into()).collect();
        self.system.values(&mut self.memory, &absolute, &self.sizes, &mut self.values);
        let relative = residuals.iter().zip(&self.values).map(|(r, size)| r / size.norm().max(f64::MIN_POSITIVE));
        relative.fold(0.0, f64::max)
    }
}

/// The scale on which each coordinate of a point is measured: its size, or a tenth of the largest
/// where it is as good as zero.
fn scale(point: &[Complex64]) -> Vec<f64> {
    let largest = point.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let largest = if largest > 0.0 { largest } else { 1.0 };
    point.iter().map(|z| if z.norm() > 1e-6 * largest { z.norm() } else { 0.1 * largest }).collect()
}
