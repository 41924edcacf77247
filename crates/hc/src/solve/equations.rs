//! From polynomials to supports and coefficients: checked, scaled, as many as unknowns, with the
//! terms that start systems need.

use super::conditioned::make_orthogonal;
use super::error::SolveError;
use crate::linalg::Lu;
use crate::random::{Random, Stream};
use crate::tolerances::equations;
use num_complex::Complex64;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use poly::simd::Isa;
use poly::{Exact, Polynomial};
use std::collections::{BTreeMap, BTreeSet};

/// Equations as supports and coefficients.
#[derive(Clone, Debug)]
pub(super) struct ScaledEquations {
    pub(super) unknowns: usize,
    /// Exponent vectors of the terms of each equation.
    pub(super) supports: Vec<Vec<Vec<i32>>>,
    /// Their coefficients.
    pub(super) coefficients: Vec<Vec<Complex64>>,
    /// Unknown `j` is `scale[j]`, a power of two, times that of the scaled equations.
    scale: Vec<f64>,
    /// Whether the coefficients are exactly those of the polynomials.
    pub(super) exact: bool,
    /// How many equations, the last ones, give as many unknowns as [sums](poly::System::with_named_sums).
    named_sums: usize,
}

impl ScaledEquations {
    /// Reads polynomials, and scales equations and unknowns by powers of two.
    pub(super) fn new(
        polynomials: &[Polynomial<Exact>],
        names: &[String],
        named_sums: usize,
    ) -> Result<ScaledEquations, SolveError> {
        let unknowns = names.len();
        let mut supports: Vec<Vec<Vec<i32>>> = Vec::with_capacity(polynomials.len());
        let mut coefficients = Vec::with_capacity(polynomials.len());
        let mut exact = true;
        for (i, polynomial) in polynomials.iter().enumerate() {
            if polynomial.variables() != unknowns {
                return Err(SolveError::Mismatched(i + 1));
            }
            if polynomial.is_empty() {
                return Err(SolveError::Zero(i + 1));
            }
            let support = polynomial.support();
            if support.iter().flatten().all(|&e| e == 0) {
                return Err(SolveError::Constant(i + 1));
            }
            supports.push(support);
            exact &= polynomial.terms().iter().all(|(_, c)| is_double(&c.re) && is_double(&c.im));
            let numbers = polynomial.terms().iter().map(|(_, c)| {
                Some(Complex64::new(c.re.to_f64()?, c.im.to_f64()?)).filter(|z| z.is_finite() && z.norm() > 0.0)
            });
            coefficients.push(numbers.collect::<Option<Vec<Complex64>>>().ok_or(SolveError::Coefficient(i + 1))?);
        }
        if polynomials.len() < unknowns || unknowns == 0 {
            return Err(SolveError::Underdetermined { equations: polynomials.len(), unknowns: names.to_vec() });
        }
        let exponents = unknown_scales(unknowns, &supports, &coefficients);
        for (i, (support, coefficients)) in supports.iter().zip(&mut coefficients).enumerate() {
            *coefficients = scaled(support, coefficients, &exponents);
            let decades = decades(coefficients);
            if coefficients.len() > DENSE && decades > equations::SPREAD {
                let (terms, decades) = (coefficients.len(), decades.min(600.0) as usize);
                return Err(SolveError::Spread { equation: i + 1, terms, decades });
            }
        }
        let scale = exponents.iter().map(|&e| 2f64.powi(e)).collect();
        Ok(ScaledEquations { unknowns, supports, coefficients, scale, exact, named_sums })
    }

    /// As many equations as unknowns, without terms.
    pub(super) fn without_terms(unknowns: usize) -> ScaledEquations {
        let (supports, coefficients) = (vec![Vec::new(); unknowns], vec![Vec::new(); unknowns]);
        ScaledEquations { unknowns, supports, coefficients, scale: vec![1.0; unknowns], exact: false, named_sums: 0 }
    }

    /// Logarithms to base 2 of the units of the scaled unknowns.
    pub(super) fn units(&self) -> Vec<i64> {
        self.scale.iter().map(|s| s.log2().round() as i64).collect()
    }

    pub(super) fn len(&self) -> usize {
        self.supports.len()
    }

    /// The equations of named sums.
    pub(super) fn named_sums(&self) -> std::ops::Range<usize> {
        self.len() - self.named_sums..self.len()
    }

    /// The degree of an equation; with negative exponents, the largest sum of exponents.
    pub(super) fn degree(&self, equation: usize) -> i64 {
        self.supports[equation].iter().map(|p| p.iter().map(|&e| i64::from(e)).sum::<i64>()).max().unwrap_or(0)
    }

    /// The equations of degree one, if they are independent and not more than the unknowns;
    /// otherwise none.
    pub(super) fn linear(&self) -> Vec<usize> {
        let is_linear = |i: &usize| self.supports[*i].iter().flatten().all(|&e| e >= 0) && self.degree(*i) <= 1;
        let linear: Vec<usize> = (0..self.len()).filter(is_linear).collect();
        let row = |&i: &usize| {
            let mut row = vec![Complex64::new(0.0, 0.0); self.unknowns];
            for (point, c) in self.supports[i].iter().zip(&self.coefficients[i]) {
                if let Some(j) = point.iter().position(|&e| e == 1) {
                    row[j] = *c;
                }
            }
            row
        };
        if are_independent(linear.iter().map(row)) { linear } else { Vec::new() }
    }

    /// As many equations as unknowns: the `fixed` ones unchanged, and those of highest degree among
    /// the others, each with a random combination of the remaining ones added. Bezout's number is
    /// then the product of the highest degrees. They have all solutions of these equations, and
    /// excess ones.
    pub(super) fn squared(&self, seed: u64, fixed: &[usize]) -> ScaledEquations {
        let order = (0..self.len()).filter(|i| !fixed.contains(i)).collect();
        let count = self.unknowns - fixed.len();
        let mut squared = ScaledEquations { supports: Vec::new(), coefficients: Vec::new(), ..self.clone() };
        for combination in combinations(order, |i| self.degree(i), count, seed) {
            let mut sum: BTreeMap<&[i32], Complex64> = BTreeMap::new();
            for (k, factor) in combination {
                for (point, c) in self.supports[k].iter().zip(&self.coefficients[k]) {
                    *sum.entry(point).or_default() += factor * c;
                }
            }
            squared.supports.push(sum.keys().map(|p| p.to_vec()).collect());
            squared.coefficients.push(sum.into_values().collect());
        }
        for &i in fixed {
            squared.supports.push(self.supports[i].clone());
            squared.coefficients.push(self.coefficients[i].clone());
        }
        squared
    }

    /// These equations with `further` more unknowns, which do not occur in them.
    pub(super) fn widened(&self, further: usize) -> ScaledEquations {
        let mut wide = self.clone();
        wide.unknowns += further;
        wide.supports.iter_mut().flatten().for_each(|point| point.resize(wide.unknowns, 0));
        wide.scale.resize(wide.unknowns, 1.0);
        wide
    }

    /// Whether some exponent is negative.
    pub(super) fn is_laurent(&self) -> bool {
        self.supports.iter().flatten().flatten().any(|&e| e < 0)
    }

    /// Adds a term with coefficient zero to an equation that does not have it.
    pub(super) fn add_term(&mut self, equation: usize, point: Vec<i32>) {
        if !self.supports[equation].contains(&point) {
            self.supports[equation].push(point);
            self.coefficients[equation].push(Complex64::new(0.0, 0.0));
        }
    }

    /// Adds terms with coefficient zero to an equation, as far as it does not have them.
    pub(super) fn add_terms(&mut self, equation: usize, points: Vec<Vec<i32>>) {
        let known: BTreeSet<Vec<i32>> = self.supports[equation].iter().cloned().collect();
        for point in points.into_iter().filter(|p| !known.contains(p)) {
            self.supports[equation].push(point);
            self.coefficients[equation].push(Complex64::new(0.0, 0.0));
        }
    }

    /// Coordinates for the given polynomials from those of the scaled equations.
    pub(super) fn unscale(&self, value: &mut [Complex64]) {
        for (z, s) in value.iter_mut().zip(&self.scale) {
            *z *= s;
        }
    }
}

/// How equations are combined to `count` of them: those of highest degree, each with random multiples of all the
/// remaining ones added, as numbers of equations with factors. `order` has the numbers; there are `count` at least.
pub(crate) fn combinations(
    mut order: Vec<usize>,
    degree: impl Fn(usize) -> i64,
    count: usize,
    seed: u64,
) -> Vec<Vec<(usize, Complex64)>> {
    order.sort_by_key(|&i| std::cmp::Reverse(degree(i)));
    let (kept, others) = order.split_at(count);
    let mut random = Random::of(seed, Stream::Combinations);
    let mut combined = |&i: &usize| {
        let added = others.iter().map(|&k| (k, random.unit()));
        [(i, Complex64::new(1.0, 0.0))].into_iter().chain(added).collect()
    };
    kept.iter().map(&mut combined).collect()
}

/// Whether rows are clearly independent, by Gram and Schmidt's orthogonalisation.
fn are_independent(rows: impl Iterator<Item = Vec<Complex64>>) -> bool {
    let mut basis: Vec<Vec<Complex64>> = Vec::new();
    for mut row in rows {
        let size = |row: &[Complex64]| row.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
        let before = size(&row);
        make_orthogonal(&mut row, &basis);
        let left = size(&row);
        let clear = left > equations::INDEPENDENT * before;
        if !clear {
            return false;
        }
        row.iter_mut().for_each(|z| *z /= left);
        basis.push(row);
    }
    true
}

/// Whether a rational is a double exactly.
fn is_double(q: &BigRational) -> bool {
    q.to_f64().and_then(BigRational::from_float).is_some_and(|double| double == *q)
}

/// Coefficients of an equation for unknowns in units of `2^exponents`, the largest of size one.
fn scaled(support: &[Vec<i32>], coefficients: &[Complex64], exponents: &[i32]) -> Vec<Complex64> {
    let shifts: Vec<f64> =
        support.iter().map(|p| p.iter().zip(exponents).map(|(&a, &e)| f64::from(a) * f64::from(e)).sum()).collect();
    let sizes = coefficients.iter().zip(&shifts).map(|(c, s)| c.norm().log2() + s);
    let largest = sizes.fold(f64::NEG_INFINITY, f64::max).round();
    // Powers of two, so that nothing is rounded; in two steps, since the factor alone may overflow.
    let power = |s: f64| 2f64.powi(s.clamp(-1000.0, 1000.0) as i32);
    let scale = |s: f64| (power((0.5 * s).floor()), power(s - (0.5 * s).floor()));
    coefficients.iter().zip(&shifts).map(|(c, &s)| c * scale(s - largest).0 * scale(s - largest).1).collect()
}

/// Equations with more terms than this are refused if their scaled coefficients differ by more
/// decades than this.
const DENSE: usize = 1000;

/// The decimal logarithm of the quotient of the largest and the smallest size.
fn decades(coefficients: &[Complex64]) -> f64 {
    let sizes = || coefficients.iter().map(|c| c.norm().log10());
    sizes().fold(f64::NEG_INFINITY, f64::max) - sizes().fold(f64::INFINITY, f64::min)
}

/// Powers of two for the unknowns that bring coefficients of each equation near to each other:
/// least squares in their logarithms (Meintjes & Morgan 1987, ACM TOMS 16:143), with a small
/// penalty on the scales so that directions without effect stay at zero.
fn unknown_scales(n: usize, supports: &[Vec<Vec<i32>>], coefficients: &[Vec<Complex64>]) -> Vec<i32> {
    let spread = |logs: &[f64]| {
        logs.iter().copied().fold(f64::NEG_INFINITY, f64::max) - logs.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let logs: Vec<Vec<f64>> = coefficients.iter().map(|c| c.iter().map(|c| c.norm().log2()).collect()).collect();
    if logs.iter().all(|l| spread(l) < equations::MILD) {
        return vec![0; n];
    }
    let mut matrix = vec![Complex64::new(0.0, 0.0); n * n];
    let mut side = vec![Complex64::new(0.0, 0.0); n];
    for (support, logs) in supports.iter().zip(&logs) {
        let count = support.len() as f64;
        let mean = |j: usize| support.iter().map(|p| f64::from(p[j])).sum::<f64>() / count;
        let means: Vec<f64> = (0..n).map(mean).collect();
        let mean_log = logs.iter().sum::<f64>() / count;
        for (point, log) in support.iter().zip(logs) {
            for j in 0..n {
                let a = f64::from(point[j]) - means[j];
                side[j] -= a * (log - mean_log);
                (0..n).for_each(|k| matrix[k * n + j] += a * (f64::from(point[k]) - means[k]));
            }
        }
    }
    let trace: f64 = (0..n).map(|j| matrix[j * n + j].re).sum();
    (0..n).for_each(|j| matrix[j * n + j] += 1e-4 * (trace / n as f64).max(1e-300));
    let mut lu = Lu::new(n, Isa::Portable);
    lu.factor(&matrix, &vec![[1.0]; n]);
    lu.solve(&mut side);
    let exponent = |y: f64| {
        if y.is_finite() { y.clamp(-equations::MOST_EXPONENT, equations::MOST_EXPONENT).round() as i32 } else { 0 }
    };
    side.iter().map(|y| exponent(y.re)).collect()
}

#[cfg(test)]
mod tests {
    use super::{ScaledEquations, SolveError};
    use poly::parse::phcpack;

    /// Coefficients over 18 decades: what counts is that the spread falls to a few.
    #[test]
    fn scales_bring_coefficients_together() {
        let system = phcpack("2\n1.0E-12*x^2 - 1.0E-3*x*y + 1.0E6;\n1.0E-6*x*y^2 - y + 1.0E2;").unwrap();
        let polynomials = system.expand(&Default::default()).unwrap();
        let equations = ScaledEquations::new(&polynomials, system.variables(), 0).unwrap();
        let sizes: Vec<f64> = equations.coefficients.iter().flatten().map(|c| c.norm().log10()).collect();
        let spread = sizes.iter().copied().fold(f64::MIN, f64::max) - sizes.iter().copied().fold(f64::MAX, f64::min);
        assert!(spread < 6.0, "{sizes:?}");
    }

    #[test]
    fn powers_of_sums_are_refused_with_a_remedy() {
        let system = phcpack("2\n(x+y+1)^100-1;\nx-y;").unwrap();
        let polynomials = system.expand(&Default::default()).unwrap();
        let error = ScaledEquations::new(&polynomials, system.variables(), 0).unwrap_err();
        assert!(matches!(error, SolveError::Spread { equation: 1, terms: 5150, .. }), "{error}");
        assert!(error.to_string().contains("new unknown"), "{error}");
    }
}
