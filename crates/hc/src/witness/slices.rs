//! General hyperplanes, and the family of systems in which they move.

use super::deflated::DeflatedEquations;
use crate::random::{Random, Stream};
use num_complex::Complex64;
use num_traits::Zero;
use poly::{Exact, Monomial, Polynomial, System, ToExact};

/// So many random slopes are drawn for each hyperplane.
const ROWS: usize = 8;

/// How far the nearest two of the slopes, each of size one, are from being equal or opposite.
fn least_angle(slopes: &[Complex64]) -> f64 {
    let pairs = slopes.iter().enumerate().flat_map(|(j, a)| slopes[..j].iter().map(move |b| (a * a - b * b).norm()));
    pairs.fold(f64::INFINITY, f64::min)
}

/// Hyperplanes `a x = b`.
pub(super) struct Slices {
    /// The coefficients `a` of each.
    slopes: Vec<Vec<Complex64>>,
    /// The values `b`.
    offsets: Vec<Complex64>,
}

impl Slices {
    /// So many hyperplanes in general position, and at no small angles to sets like `x = y` and `x = -y`, which
    /// systems often have: they would meet these far away, where digits are lost.
    pub(super) fn new(unknowns: usize, dimension: usize, seed: u64) -> Slices {
        let mut random = Random::of(seed, Stream::Slice(dimension as u64));
        let mut row = || -> Vec<Complex64> { (0..unknowns).map(|_| random.unit()).collect() };
        let mut best = || {
            let rows = (0..ROWS).map(|_| row());
            rows.max_by(|a, b| least_angle(a).total_cmp(&least_angle(b))).unwrap_or_default()
        };
        let slopes = (0..dimension).map(|_| best()).collect();
        Slices { slopes, offsets: (0..dimension).map(|_| random.short_unit()).collect() }
    }

    /// So many hyperplanes through a point, otherwise in general position.
    pub(super) fn through(point: &[Complex64], dimension: usize, seed: u64) -> Slices {
        let mut random = Random::of(seed, Stream::Through);
        let slopes: Vec<Vec<Complex64>> =
            (0..dimension).map(|_| (0..point.len()).map(|_| random.unit()).collect()).collect();
        let offsets = slopes.iter().map(|slopes| slopes.iter().zip(point).map(|(a, x)| a * x).sum()).collect();
        Slices { slopes, offsets }
    }

    /// The number of hyperplanes.
    pub(super) fn dimension(&self) -> usize {
        self.slopes.len()
    }

    /// The hyperplanes as polynomials, exactly.
    pub(super) fn polynomials(&self, unknowns: usize) -> Vec<Polynomial<Exact>> {
        let exact = |z: Complex64| z.to_exact().unwrap_or_else(Exact::zero);
        let plane = |(slopes, offset): (&Vec<Complex64>, &Complex64)| {
            let unit = |j: usize| Monomial::new((0..unknowns).map(|k| i32::from(k == j)));
            let linear = slopes.iter().enumerate().map(|(j, &a)| (unit(j), exact(a)));
            Polynomial::from_terms(unknowns, linear.chain([(Monomial::one(unknowns), exact(-offset))]))
        };
        self.slopes.iter().zip(&self.offsets).map(plane).collect()
    }

    /// The parameters of the [family](Slices::family) at which its hyperplanes are these: slopes
    /// and offset of each.
    pub(super) fn parameters(&self) -> Vec<Complex64> {
        let plane = |(slopes, &offset): (&Vec<Complex64>, &Complex64)| slopes.iter().copied().chain([offset]).collect();
        self.slopes.iter().zip(&self.offsets).flat_map::<Vec<Complex64>, _>(plane).collect()
    }

    /// As many equations as unknowns: those that are kept, combinations of the others, and hyperplanes with
    /// slopes and offsets as parameters. If only offsets moved, they would have to go as far as the branch
    /// points are away. `None` if the equations make no system.
    pub(super) fn family(&self, equations: &DeflatedEquations, seed: u64) -> Option<System> {
        let names: Vec<String> = (0..equations.unknowns()).map(|j| format!("x{j}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let combined = System::from_polynomials(&names, &equations.combined).ok()?;
        let kept = System::from_polynomials(&names, &equations.kept).ok()?;
        let wanted = names.len().checked_sub(self.dimension() + kept.len())?;
        let given = self.slopes.first().map_or(0, Vec::len);
        let mut random = Random::of(seed, Stream::Combinations);
        System::build(|s| {
            let unknowns: Vec<_> = names.iter().map(|name| s.variable(name)).collect();
            let planes: Vec<(Vec<_>, _)> = (0..self.dimension())
                .map(|k| {
                    let slopes = (0..given).map(|j| s.parameter(&format!("a{k}_{j}"))).collect();
                    (slopes, s.parameter(&format!("b{k}")))
                })
                .collect();
            let combined = combined.instantiate(s, &unknowns, &[]);
            let mut equations = if combined.len() == wanted {
                combined
            } else {
                (0..wanted).map(|_| s.sum(combined.iter().map(|&f| s.constant(random.unit()) * f))).collect()
            };
            equations.extend(kept.instantiate(s, &unknowns, &[]));
            for (slopes, offset) in planes {
                equations.push(s.sum(slopes.iter().zip(&unknowns).map(|(&a, &x)| a * x)) - offset);
            }
            equations
        })
        .ok()
    }
}
