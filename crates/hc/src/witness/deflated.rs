//! Equations for which the witness points of multiple components are regular solutions.
//!
//! On a component of multiplicity two or more, the Jacobian has a larger null space than the
//! tangents explain. Coordinates that are zero at general points of a component are zero on all of
//! it: equations say so, which is enough where the component comes from powers of these
//! coordinates, or of [named sums](poly::System::with_named_sums). Otherwise null vectors become
//! further unknowns, the multipliers, with as many linear conditions as make them one vector at
//! each point. In the equations with multipliers the component has a smaller multiplicity. Where
//! it is not yet one, their Jacobian gets multipliers in turn (Leykin, Verschelde & Zhao 2006,
//! Theoretical Computer Science 359:111; for components, Sommese & Wampler 2005, section 13.3).

use super::equations::NamedEquations;
use crate::random::{Random, Stream};
use crate::singular::{Elimination, ExactEquations, Number, PivotLimit};
use crate::tolerances::witness;
use num_complex::Complex64;
use num_traits::Zero;
use poly::{ComplexDd, Exact, Monomial, Polynomial, Scalar, ToExact};
use std::collections::BTreeMap;

/// How often multipliers are added at most; each time doubles the unknowns.
const LEVELS: u64 = 3;
/// Unknowns at most, multipliers included.
const UNKNOWNS: usize = 100;

/// Equations, mostly with multipliers, and points that solve them.
pub(super) struct DeflatedEquations {
    /// The equations that may be combined.
    pub(super) combined: Vec<Polynomial<Exact>>,
    /// Those that stay as they are: of named sums, and linear ones in the multipliers alone.
    pub(super) kept: Vec<Polynomial<Exact>>,
    /// The points by their numbers; the multipliers come after the unknowns.
    pub(super) points: BTreeMap<usize, Vec<Complex64>>,
}

impl DeflatedEquations {
    /// The points as solutions of these equations.
    pub(super) fn new(
        equations: &NamedEquations<'_>,
        points: impl Iterator<Item = (usize, Vec<Complex64>)>,
    ) -> DeflatedEquations {
        let (given, sums) = equations.parts();
        DeflatedEquations { combined: given.to_vec(), kept: sums.to_vec(), points: points.collect() }
    }

    /// The points on components of this dimension, grouped by the equations of which they are regular
    /// solutions. Points that would need too many multipliers are left out.
    pub(super) fn regular(self, dimension: usize, seed: u64) -> Vec<DeflatedEquations> {
        let (mut regular, mut left) = (Vec::new(), Vec::new());
        for (further, group) in self.by_rank(dimension) {
            if further == 0 {
                regular.push(group);
            } else {
                left.extend(group.with_zeros());
            }
        }
        for level in 0..=LEVELS {
            for equations in std::mem::take(&mut left) {
                for (further, group) in equations.by_rank(dimension) {
                    if further == 0 {
                        regular.push(group);
                    } else if level < LEVELS && 2 * group.unknowns() <= UNKNOWNS {
                        left.push(group.with_multipliers(dimension, further, seed.wrapping_add(level)));
                    }
                }
            }
        }
        regular
    }

    /// The equations, and for each coordinate that is zero at points that it is; one group for each set
    /// of such coordinates.
    fn with_zeros(self) -> Vec<DeflatedEquations> {
        let unknowns = self.unknowns();
        let given = ExactEquations::new(&self.all(), vec![0; unknowns]);
        let mut groups: BTreeMap<Vec<usize>, DeflatedEquations> = BTreeMap::new();
        for (k, mut point) in self.points {
            let largest = point.iter().map(|z| z.norm()).fold(0.0, f64::max);
            let small = |j: &usize| point[*j].norm() <= witness::ZERO * largest;
            let mut zeros: Vec<usize> = (0..unknowns).filter(small).collect();
            let exact: Vec<Complex64> =
                (0..unknowns).map(|j| if zeros.contains(&j) { Complex64::default() } else { point[j] }).collect();
            let local = given.near_within::<ComplexDd>(&exact, witness::NOTHING);
            if local.residual(&local.scaled(&exact)).exp2() < witness::ZERO_SOLVED {
                point = exact;
            } else {
                zeros.clear();
            }
            let equation = |&j: &usize| Polynomial::variable(unknowns, j);
            let group = groups.entry(zeros.clone()).or_insert_with(|| DeflatedEquations {
                combined: self.combined.iter().cloned().chain(zeros.iter().map(equation)).collect(),
                kept: self.kept.clone(),
                points: BTreeMap::new(),
            });
            group.points.insert(k, point);
        }
        groups.into_values().collect()
    }

    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.points.values().next().map_or(0, Vec::len)
    }

    /// All equations.
    fn all(&self) -> Vec<Polynomial<Exact>> {
        [&self.combined[..], &self.kept].concat()
    }

    /// The points, grouped by how much larger the null space of the Jacobian is than the dimension.
    fn by_rank(self, dimension: usize) -> BTreeMap<usize, DeflatedEquations> {
        let given = ExactEquations::new(&self.all(), vec![0; self.unknowns()]);
        let mut groups: BTreeMap<usize, DeflatedEquations> = BTreeMap::new();
        for (k, point) in self.points {
            let further = (point.len() - null_space(&given, &point).1.rank()).saturating_sub(dimension);
            let (combined, kept) = (&self.combined, &self.kept);
            let empty =
                || DeflatedEquations { combined: combined.clone(), kept: kept.clone(), points: BTreeMap::new() };
            groups.entry(further).or_insert_with(empty).points.insert(k, point);
        }
        groups
    }

    /// The equations with a vector of the null space of their Jacobian as further unknowns. The null space
    /// is larger than the dimension by `further`.
    fn with_multipliers(self, dimension: usize, further: usize, seed: u64) -> DeflatedEquations {
        let before = self.unknowns();
        let mut random = Random::of(seed, Stream::Multipliers);
        // As many general forms as the dimension vanish on the vector; the others are one, which fixes it.
        let forms: Vec<Vec<Complex64>> =
            (0..dimension + further).map(|_| (0..before).map(|_| random.short_unit()).collect()).collect();
        let side = |form: usize| if form < dimension { 0.0 } else { 1.0 };
        let given = ExactEquations::new(&self.all(), vec![0; before]);
        let extended = |(k, point): (usize, Vec<Complex64>)| {
            let multipliers = multipliers(&given, &point, &forms, side)?;
            Some((k, [point, multipliers].concat()))
        };
        let points = self.points.into_iter().filter_map(extended).collect();
        let unchanged = |p: &Polynomial<Exact>| {
            let terms = p.terms().iter().map(|(m, c)| (wider(m), c.clone()));
            Polynomial::from_terms(2 * before, terms)
        };
        let with = |all: &[Polynomial<Exact>]| -> Vec<Polynomial<Exact>> {
            all.iter().map(unchanged).chain(all.iter().map(tangent)).collect()
        };
        let condition = |(k, form): (usize, &Vec<Complex64>)| {
            let unit = |j: usize| Monomial::new((0..2 * before).map(|i| i32::from(i == before + j)));
            let exact = |z: Complex64| z.to_exact().unwrap_or_else(Exact::zero);
            let terms = form.iter().enumerate().map(|(j, &a)| (unit(j), exact(a)));
            let constant = (Monomial::one(2 * before), exact(Complex64::from(-side(k))));
            Polynomial::from_terms(2 * before, terms.chain([constant]))
        };
        let mut kept = with(&self.kept);
        kept.extend(forms.iter().enumerate().map(condition));
        DeflatedEquations { combined: with(&self.combined), kept, points }
    }
}

/// The point in units of the equations near it, and the Jacobian there after elimination.
fn null_space(given: &ExactEquations, point: &[Complex64]) -> (Vec<f64>, Elimination<ComplexDd>) {
    let local = given.near::<ComplexDd>(point);
    let (_, jacobian) = local.jacobian(&local.scaled(point));
    let units = local.unscaled(&vec![ComplexDd::one(); point.len()]);
    (
        units.iter().map(|unit| unit.to_c64().re).collect(),
        Elimination::new(jacobian, point.len(), PivotLimit::Below(witness::ZERO_PIVOT)),
    )
}

/// The vector of the null space at a point on which the forms have the values of `side`; `None` if
/// there is none or more than one.
fn multipliers(
    given: &ExactEquations,
    point: &[Complex64],
    forms: &[Vec<Complex64>],
    side: impl Fn(usize) -> f64,
) -> Option<Vec<Complex64>> {
    let (units, pivots) = null_space(given, point);
    let vectors = pivots.null_space();
    let vectors: Vec<Vec<ComplexDd>> = vectors
        .into_iter()
        .map(|vector| vector.into_iter().zip(&units).map(|(z, &unit)| ComplexDd::scale(&z, unit)).collect())
        .collect();
    let dot = |form: &[Complex64], vector: &[ComplexDd]| {
        form.iter()
            .zip(vector)
            .fold(ComplexDd::zero(), |sum, (&a, z)| ComplexDd::mul_add(&ComplexDd::from_c64(a), z, &sum))
    };
    let matrix: Vec<Vec<ComplexDd>> = forms.iter().map(|f| vectors.iter().map(|v| dot(f, v)).collect()).collect();
    let solver = Elimination::new(matrix, vectors.len(), PivotLimit::Below(f64::NEG_INFINITY));
    if vectors.len() != forms.len() || solver.rank() < forms.len() {
        return None;
    }
    let sides: Vec<ComplexDd> = (0..forms.len()).map(|k| ComplexDd::from_c64(side(k).into())).collect();
    let mut sum = vec![ComplexDd::zero(); point.len()];
    for (&column, factor) in solver.columns.iter().zip(solver.solve(&sides)) {
        for (sum, z) in sum.iter_mut().zip(&vectors[column]) {
            *sum = ComplexDd::mul_add(&factor, z, sum);
        }
    }
    Some(sum.iter().map(Number::to_c64).collect())
}

/// A monomial among twice as many unknowns.
fn wider(monomial: &Monomial) -> Monomial {
    let exponents = monomial.exponents();
    Monomial::new(exponents.iter().copied().chain(exponents.iter().map(|_| 0)))
}

/// The derivative of a polynomial in the direction of the multipliers.
fn tangent(polynomial: &Polynomial<Exact>) -> Polynomial<Exact> {
    let unknowns = polynomial.variables();
    let along = |(j, slope): (usize, Polynomial<Exact>)| {
        let times = move |m: &Monomial| {
            let exponents = m.exponents().iter().copied();
            Monomial::new(exponents.chain((0..unknowns).map(|k| i32::from(k == j))))
        };
        slope.terms().iter().map(|(m, c)| (times(m), c.clone())).collect::<Vec<_>>()
    };
    let slopes = (0..unknowns).map(|j| (j, polynomial.derivative(j)));
    Polynomial::from_terms(2 * unknowns, slopes.flat_map(along))
}
