//! Which witness points belong to one irreducible component: monodromy of the hyperplanes, and the
//! trace test.

use super::slices::Slices;
use crate::distinct::relative_distance;
use crate::family::{Fibre, FibreOptions, MonodromyOptions, PASSED, deviation, monodromy, move_fibre_watched};
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use num_complex::Complex64;
use poly::{Evaluate, Exact, Polynomial};

/// Points whose relative distance is less are one.
const SAME: f64 = 1e-8;
/// Searches with other loops, while the trace test says that points are missing.
const SEARCHES: u64 = 4;
/// Directions in which hyperplanes are moved for a trace test, while paths are lost.
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
        self.further == 0 && self.trace.is_some_and(|deviation| deviation < PASSED)
    }
}

/// Groups regular witness points by component; `None` if the family cannot be tracked.
pub(super) fn orbits(
    given: &[Polynomial<Exact>],
    slices: &Slices,
    points: &[Vec<Complex64>],
    seed: u64,
    monitor: &Monitor,
) -> Option<Vec<Orbit>> {
    let unknowns = points.first()?.len();
    let family = slices.family(given, unknowns, seed)?.compile().ok()?;
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut orbits = Vec::new();
    while let Some(&first) = left.first() {
        let mut fibre = Fibre::new(slices.parameters(), unknowns, points[first].clone());
        let mut deviation = None;
        for search in 0..SEARCHES {
            let options = MonodromyOptions::new().seed(seed.wrapping_add(search)).roots(left.len());
            fibre = settled(monodromy(&family, &fibre, &options, monitor).fibre);
            let of_direction =
                |k| trace(&family, &fibre, unknowns, seed.wrapping_add(search * DIRECTIONS + k), monitor);
            deviation = (0..DIRECTIONS).find_map(of_direction);
            if deviation.is_some_and(|d| d < PASSED) || monitor.is_cancelled() {
                break;
            }
        }
        let found: Vec<&[Complex64]> = (0..fibre.len()).map(|k| fibre.solution(k)).collect();
        let is_found = |k: &usize| found.iter().any(|x| relative_distance(x, &points[*k]) < SAME);
        let (here, others): (Vec<usize>, Vec<usize>) = left.iter().copied().partition(|k| *k == first || is_found(k));
        let further = found.len().saturating_sub(here.len());
        orbits.push(Orbit { points: here, trace: deviation, further });
        left = others;
    }
    Some(orbits)
}

/// Coordinates below this share of the largest are zero: Newton's method leaves ever smaller numbers in
/// their place, and squares of these underflow.
const NOTHING: f64 = 1e-40;

/// A fibre with zeros for what is left of them.
fn settled(mut fibre: Fibre) -> Fibre {
    for point in fibre.solutions.chunks_exact_mut(fibre.dimension.max(1)) {
        let largest = point.iter().map(|z| z.norm()).fold(0.0, f64::max);
        point.iter_mut().filter(|z| z.norm() < NOTHING * largest).for_each(|z| *z = Complex64::default());
    }
    fibre
}

/// How far the sum of the points is from moving linearly while the hyperplanes move in parallel,
/// relative to what the points bend: rounding error if they are all of one or more components.
fn trace<E: Evaluate>(family: &E, fibre: &Fibre, unknowns: usize, seed: u64, monitor: &Monitor) -> Option<f64> {
    let mut random = Random::new(seed, Stream::Trace);
    // The offsets move; slopes, as many as unknowns before each, stay. Steps and offsets have so few
    // digits that sums are exact.
    let step = |k: usize| if k % (unknowns + 1) == unknowns { random.short_unit() } else { Complex64::default() };
    let direction: Vec<Complex64> = (0..fibre.parameters.len()).map(step).collect();
    let at = |s: f64| fibre.parameters.iter().zip(&direction).map(|(b, v)| b + v * s).collect::<Vec<_>>();
    let options = FibreOptions::default();
    let moved = |fibre: &Fibre, s: f64| move_fibre_watched(family, fibre, &at(s), &options, monitor).map(settled);
    let second = moved(fibre, 1.0)?;
    let third = moved(&second, 2.0)?;
    Some(deviation(family, &[fibre, &second, &third]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SolveOptions;
    use crate::solve::solve_polynomials;

    /// A circle of radius 1e6, on the scale of which the hyperplane hardly moves.
    #[test]
    fn a_missing_point_of_a_large_circle_shows() {
        let system: poly::System = "x^2 + y^2 - 1000000000000".parse().unwrap();
        let given = system.expand(&Default::default()).unwrap();
        let slices = Slices::new(2, 1, 0);
        let sliced = [given.clone(), slices.polynomials(2)].concat();
        let found = solve_polynomials(&sliced, system.variables(), &SolveOptions::new(), &Monitor::default()).unwrap();
        let points: Vec<Vec<Complex64>> = found.solutions.into_iter().map(|s| s.value).collect();
        assert_eq!(points.len(), 2);
        let family = slices.family(&given, 2, 0).unwrap().compile().unwrap();
        let deviation = |points: &[Vec<Complex64>]| {
            trace(&family, &Fibre::new(slices.parameters(), 2, points.concat()), 2, 0, &Monitor::default()).unwrap()
        };
        assert!(deviation(&points) < PASSED);
        assert!(deviation(&points[..1]) > 0.1);
    }
}
