//! Which witness points belong to one irreducible component: monodromy of the hyperplanes, and the
//! trace test.

use super::equations::NamedEquations;
use super::set::WitnessSet;
use crate::distinct::relative_distance;
use crate::family::{Bends, Fibre, FibreOptions, MonodromyOptions, monodromy, move_fibre};
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use crate::tolerances::{families, same, witness};
use num_complex::Complex64;
use poly::{ComplexDd, Evaluate};

/// Most searches with other loops while the trace test says that points are missing.
const SEARCHES: u64 = 4;
/// Most directions in which hyperplanes are moved for a trace test while paths are lost.
const DIRECTIONS: u64 = 4;

/// Witness points of one component, by their indices.
pub(super) struct Orbit {
    pub(super) points: Vec<usize>,
    /// The deviation of the trace from linear motion; `None` where it could not be computed.
    pub(super) trace: Option<f64>,
    /// Points that monodromy found and that are not among the witness points.
    pub(super) further: usize,
}

impl Orbit {
    /// Whether these are shown to be all points of one irreducible component.
    pub(super) fn is_whole(&self) -> bool {
        self.further == 0 && self.trace.is_some_and(|deviation| deviation < families::TRACE_PASSED)
    }
}

/// Groups the points of a witness set by component.
///
/// Loops join points until every group passes the trace test, which no part of a component passes.
pub(super) fn orbits(set: &WitnessSet, equations: &NamedEquations<'_>, seed: u64, monitor: &Monitor) -> Vec<Orbit> {
    let WitnessSet { family, fibre: all, numbers, unknowns, .. } = set;
    let mut left: Vec<usize> = (0..all.len()).collect();
    let mut orbits = Vec::new();
    while let Some(&first) = left.first() {
        let mut fibre = Fibre::new(all.parameters.clone(), all.dimension, all.solution(first).to_vec());
        let (mut deviation, mut searches) = (None, 0);
        // Traces and searches each have hyperplanes of their own.
        for round in 0.. {
            let seed = seed.wrapping_add(round * DIRECTIONS);
            let of_direction = |k| trace(family, &fibre, *unknowns, seed.wrapping_add(k), monitor);
            let found = (0..DIRECTIONS).find_map(of_direction);
            // A single point of a set that hardly bends seems to move straight, which tells nothing.
            let tells = |trace: &Trace| {
                trace.deviation >= families::TRACE_PASSED || fibre.len() > 1 || trace.follows_a_plane(equations)
            };
            deviation = found.as_ref().filter(|&trace| tells(trace)).map(|trace| trace.deviation);
            if deviation.is_some_and(|deviation| deviation < families::TRACE_PASSED) {
                // Loops may have jumped from one component to another that is close to it.
                if let Some((part, of_part)) = found.as_ref().and_then(|trace| trace.part(equations)) {
                    let points = part.iter().flat_map(|&k| fibre.solution(k).to_vec()).collect();
                    fibre = Fibre::new(all.parameters.clone(), all.dimension, points);
                    deviation = Some(of_part);
                }
                break;
            }
            if monitor.is_cancelled() {
                break;
            }
            let known = fibre.len();
            let options = MonodromyOptions::new().seed(seed).roots(left.len().min(known + 1));
            fibre = settled(monodromy(family, &fibre, &options, monitor).fibre);
            searches += u64::from(fibre.len() == known);
            if searches == SEARCHES || known >= left.len() {
                break;
            }
        }
        // Each point of the fibre is one of the witness points, the first one the first, however close others are.
        let mut here = vec![first];
        for x in fibre.iter().skip(1) {
            let distance = |k: usize| relative_distance(x, all.solution(k));
            let others = left.iter().copied().filter(|k| !here.contains(k));
            let nearest = others.min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
            here.extend(nearest.filter(|&k| distance(k) < same::REGULAR));
        }
        here.sort_unstable();
        let further = fibre.len().saturating_sub(here.len());
        left.retain(|k| !here.contains(k));
        orbits.push(Orbit { points: here.iter().map(|&k| numbers[k]).collect(), trace: deviation, further });
    }
    orbits
}

/// A fibre with zeros in place of such coordinates.
fn settled(mut fibre: Fibre) -> Fibre {
    for point in fibre.solutions.chunks_exact_mut(fibre.dimension.max(1)) {
        let largest = point.iter().map(|z| z.norm()).fold(0.0, f64::max);
        point.iter_mut().filter(|z| z.norm() < witness::NOTHING * largest).for_each(|z| *z = Complex64::default());
    }
    fibre
}

/// Points while the hyperplanes move in parallel.
struct Trace {
    /// How far the sum of the points is from moving linearly, relative to how much the points bend. It is
    /// rounding error if they are all points of one or more components. Only given coordinates count: named
    /// sums are polynomials in them, and multipliers rational functions of the hyperplanes.
    deviation: f64,
    /// How each of the points bends.
    bends: Bends,
    /// The first of the points, before and after the first step.
    first: [Vec<Complex64>; 2],
}

/// How far, in steps of a trace, a plane is followed.
const FAR: [i32; 4] = [6, 18, 36, 54];

impl Trace {
    /// The least part of the points with the first one that moves straight by itself, with its deviation, if that is not
    /// all of them.
    fn part(&self, equations: &NamedEquations<'_>) -> Option<(Vec<usize>, f64)> {
        // A single point of a set that hardly bends seems to move straight.
        self.bends.least_part().filter(|(part, _)| part.len() > 1 || self.follows_a_plane(equations))
    }

    /// Whether the plane in which the first point seems to stay, by its first step, solves the equations
    /// as far out as doubles tell.
    fn follows_a_plane(&self, equations: &NamedEquations<'_>) -> bool {
        let [before, after] = &self.first;
        FAR.iter().all(|&power| {
            let far = 2f64.powi(power);
            let along = before.iter().zip(after).take(equations.unknowns).map(|(a, b)| a + (b - a) * far);
            let point = equations.completed(along.collect());
            let local = equations.all.near_within::<ComplexDd>(&point, witness::FAR_SMALL);
            local.residual(&local.scaled(&point)).exp2() < witness::FAR_SOLVED
        })
    }
}

/// Moves the hyperplanes of a fibre in parallel; `None` if a path was lost.
fn trace<E: Evaluate>(family: &E, fibre: &Fibre, unknowns: usize, seed: u64, monitor: &Monitor) -> Option<Trace> {
    let mut random = Random::of(seed, Stream::Trace);
    // The offsets move; slopes, as many as unknowns before each, stay. Steps and offsets have so few
    // digits that sums are exact.
    let step = |k: usize| if k % (unknowns + 1) == unknowns { random.short_unit() } else { Complex64::default() };
    let direction: Vec<Complex64> = (0..fibre.parameters.len()).map(step).collect();
    let at = |s: f64| fibre.parameters.iter().zip(&direction).map(|(b, v)| b + v * s).collect::<Vec<_>>();
    let options = FibreOptions::default();
    let moved = |fibre: &Fibre, s: f64| move_fibre(family, fibre, &at(s), &options, monitor).map(settled);
    let second = moved(fibre, 1.0)?;
    let third = moved(&second, 2.0)?;
    let bends = Bends::new(family, &[fibre, &second, &third], unknowns);
    Some(Trace { deviation: bends.deviation(), bends, first: [fibre, &second].map(|fibre| fibre.solution(0).to_vec()) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SolveOptions;
    use crate::solve::{SolveContext, solve_polynomials};
    use crate::witness::slices::Slices;

    /// A circle of radius 1e6, on the scale of which the hyperplane hardly moves.
    #[test]
    fn a_missing_point_of_a_large_circle_shows() {
        let system: poly::System = "x^2 + y^2 - 1000000000000".parse().unwrap();
        let given = system.expand(&Default::default()).unwrap();
        let slices = Slices::new(2, 1, 0);
        let sliced = [given.clone(), slices.polynomials(2)].concat();
        let (options, monitor) = (SolveOptions::new(), Monitor::default());
        let found =
            solve_polynomials(&sliced, system.variables(), &options, &monitor, SolveContext::default()).unwrap();
        let points: Vec<Vec<Complex64>> = found.solutions.into_iter().map(|s| s.value).collect();
        assert_eq!(points.len(), 2);
        let [set] = &WitnessSet::all(&NamedEquations::new(&given, 2, 0), &slices, &points, 0)[..] else {
            panic!("one set")
        };
        let deviation = |points: &[Vec<Complex64>]| {
            trace(&set.family, &Fibre::new(slices.parameters(), 2, points.concat()), 2, 0, &Monitor::default())
                .unwrap()
                .deviation
        };
        assert!(deviation(&points) < families::TRACE_PASSED);
        assert!(deviation(&points[..1]) > 0.1);
    }

    /// A line is one component; one point of a parabola as flat as a line to all digits nearby is none.
    #[test]
    fn a_point_of_a_flat_curve_is_no_line() {
        let whole = |text: &str, y: fn(Complex64) -> Complex64| {
            let system: poly::System = text.parse().unwrap();
            let given = system.expand(&Default::default()).unwrap();
            let slices = Slices::new(2, 1, 0);
            let [a, b, c] = slices.parameters()[..] else { panic!("one line") };
            // On the line, as far as the parabola is flat there.
            let x = c / (a + b * y(Complex64::from(1.0)));
            let equations = NamedEquations::new(&given, 2, 0);
            let [set] = &WitnessSet::all(&equations, &slices, &[vec![x, y(x)]], 0)[..] else { panic!("one set") };
            let [orbit] = &orbits(set, &equations, 0, &Monitor::default())[..] else { panic!("one orbit") };
            orbit.is_whole()
        };
        assert!(whole("2*x - y", |x| 2.0 * x));
        assert!(!whole("x^2 - 10000000000000000000000000000*y", |x| x * x * 1e-28));
    }
}
