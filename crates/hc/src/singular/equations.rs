//! The given equations with exact coefficients, and their values, derivatives and series near a
//! point in numbers of any precision.

use super::multiplicity::Modular;
use super::number::{Number, largest};
use super::prime_field::{PrimeField, Residue};
use super::series::Basis;
use crate::monitor::Monitor;
use crate::tolerances::structure;
use num_complex::Complex64;
use num_traits::Zero;
use poly::{ComplexDd, ComplexMulti, Exact, Polynomial};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Equations as they were given, prepared for evaluation to many digits.
///
/// Where exponents are negative an equation is multiplied by a monomial; its solutions without zero
/// coordinates stay.
#[derive(Clone)]
pub(crate) struct ExactEquations {
    exact: Arc<EquationData>,
    /// Work done so far; the unit is about a product of complex double-doubles.
    spent: Arc<AtomicU64>,
    /// Work after which nothing more is done.
    limit: u64,
    /// Nothing more is done once this is cancelled.
    monitor: Monitor,
    /// By this primes are drawn.
    seed: u64,
}

/// The equations themselves, which clones of [`ExactEquations`] share.
struct EquationData {
    unknowns: usize,
    /// Logarithms to base 2 of the units of the unknowns.
    scale: Vec<i64>,
    equations: Vec<Vec<Term>>,
    /// The exponents of each unknown in terms and in their derivatives, ascending.
    exponents: Vec<Vec<u32>>,
    /// Coefficients to 32, 77, 154 and 308 digits, once they are asked for.
    double_double: OnceLock<Vec<Vec<ComplexDd>>>,
    four: OnceLock<Vec<Vec<ComplexMulti<4>>>>,
    eight: OnceLock<Vec<Vec<ComplexMulti<8>>>>,
    sixteen: OnceLock<Vec<Vec<ComplexMulti<16>>>>,
}

struct Term {
    /// Unknowns with their exponents, those of exponent zero left out.
    powers: Vec<(usize, u32)>,
    /// Places of these exponents among those of the unknown.
    places: Vec<usize>,
    coefficient: Exact,
}

/// A precision in which the equations are available.
pub(crate) trait Precision: Number {
    /// Where the coefficients in this precision are kept.
    fn kept(given: &ExactEquations) -> &OnceLock<Vec<Vec<Self>>>;
}

macro_rules! precisions {
    ($($number:ty: $field:ident),*) => {$(
        impl Precision for $number {
            fn kept(given: &ExactEquations) -> &OnceLock<Vec<Vec<Self>>> {
                &given.exact.$field
            }
        }
    )*};
}

precisions!(ComplexDd: double_double, ComplexMulti<4>: four, ComplexMulti<8>: eight, ComplexMulti<16>: sixteen);

impl ExactEquations {
    /// Takes polynomials in equally many unknowns; points have unknown `j` in units of
    /// `2^scale[j]`.
    pub(crate) fn new(polynomials: &[Polynomial<Exact>], scale: Vec<i64>) -> ExactEquations {
        let unknowns = scale.len();
        let equation = |polynomial: &Polynomial<Exact>| {
            let exponents = || polynomial.terms().iter().map(|(m, _)| m.exponents());
            let lowest: Vec<i64> =
                (0..unknowns).map(|j| exponents().map(|e| i64::from(e[j])).min().unwrap_or(0).min(0)).collect();
            let term = |(monomial, coefficient): &(poly::Monomial, Exact)| {
                let raised = monomial.exponents().iter().zip(&lowest).map(|(&e, low)| (i64::from(e) - low) as u32);
                let powers = raised.enumerate().filter(|&(_, e)| e > 0).collect();
                Term { powers, places: Vec::new(), coefficient: coefficient.clone() }
            };
            polynomial.terms().iter().map(term).collect()
        };
        let mut equations: Vec<Vec<Term>> = polynomials.iter().map(equation).collect();
        let mut exponents: Vec<Vec<u32>> = vec![Vec::new(); unknowns];
        for &(j, e) in equations.iter().flatten().flat_map(|t| &t.powers) {
            exponents[j].extend([e - 1, e]);
        }
        for exponents in &mut exponents {
            exponents.sort_unstable();
            exponents.dedup();
        }
        for term in equations.iter_mut().flatten() {
            let place = |&(j, e): &(usize, u32)| exponents[j].partition_point(|&f| f < e);
            term.places = term.powers.iter().map(place).collect();
        }
        let exact = EquationData {
            unknowns,
            scale,
            equations,
            exponents,
            double_double: OnceLock::new(),
            four: OnceLock::new(),
            eight: OnceLock::new(),
            sixteen: OnceLock::new(),
        };
        ExactEquations {
            exact: Arc::new(exact),
            spent: Arc::default(),
            limit: u64::MAX,
            monitor: Monitor::default(),
            seed: 0,
        }
    }

    /// Draws primes by this seed, instead of zero.
    pub(crate) fn seeded(self, seed: u64) -> ExactEquations {
        ExactEquations { seed, ..self }
    }

    /// Ends all work on these equations once the monitor is cancelled.
    pub(crate) fn stopped_by(self, monitor: &Monitor) -> ExactEquations {
        ExactEquations { monitor: monitor.quiet(), ..self }
    }

    /// A copy with a work count of its own and this limit.
    pub(crate) fn limited(&self, limit: u64) -> ExactEquations {
        let (exact, monitor) = (self.exact.clone(), self.monitor.clone());
        ExactEquations { exact, spent: Arc::default(), limit, monitor, seed: self.seed }
    }

    /// Whether the limit of the work is reached, or the work is cancelled.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.spent() > self.limit || self.monitor.is_cancelled()
    }

    /// The work that may still be done.
    pub(crate) fn left(&self) -> u64 {
        self.limit.saturating_sub(self.spent())
    }

    /// Number of factors in all terms.
    pub(crate) fn factors(&self) -> usize {
        self.exact.equations.iter().flatten().map(|t| t.powers.len() + 1).sum()
    }

    /// The highest degree of an equation.
    pub(crate) fn degree(&self) -> u64 {
        let degree = |t: &Term| t.powers.iter().map(|&(_, e)| u64::from(e)).sum();
        self.exact.equations.iter().flatten().map(degree).max().unwrap_or(0)
    }

    /// Logarithms to base 2 of the units of the unknowns.
    pub(crate) fn scales(&self) -> &[i64] {
        &self.exact.scale
    }

    /// Two random fields in which the coefficients, and these numbers, have images that do not vanish.
    pub(super) fn fields<'a>(&'a self, further: &'a [Exact]) -> [PrimeField; 2] {
        let coefficients = self.exact.equations.iter().flatten().map(|t| &t.coefficient);
        PrimeField::pair(self.seed, coefficients.chain(further))
    }

    /// By what primes are drawn.
    pub(crate) fn seed(&self) -> u64 {
        self.seed
    }

    /// The equations modulo the prime of the thread, in the unknowns themselves; `None` if exponents are larger than
    /// this or the prime divides a denominator.
    pub(super) fn modular(&self, exponent: u32) -> Option<Vec<Modular>> {
        let term = |t: &Term| {
            let small = t.powers.iter().all(|&(_, e)| e <= exponent);
            small.then(|| Residue::image(&t.coefficient).map(|c| (t.powers.clone(), c))).flatten()
        };
        self.exact.equations.iter().map(|terms| terms.iter().map(term).collect()).collect()
    }

    /// Whether all equations are exactly zero at these values of the unknowns themselves.
    pub(super) fn vanish_at(&self, point: &[Exact]) -> bool {
        let power = |&(j, e): &(usize, u32)| num_traits::pow(point[j].clone(), e as usize);
        let value = |t: &Term| t.powers.iter().map(power).fold(t.coefficient.clone(), |product, z| product * z);
        self.exact.equations.iter().all(|terms| terms.iter().map(value).fold(Exact::zero(), |s, z| s + z).is_zero())
    }

    /// Whether all points at which these unknowns are zero are solutions, whatever the others.
    pub(crate) fn vanish_where(&self, zero: &[bool]) -> bool {
        self.exact.equations.iter().flatten().all(|term| term.powers.iter().any(|&(j, _)| zero[j]))
    }

    pub(crate) fn unknowns(&self) -> usize {
        self.exact.unknowns
    }

    /// The work done so far at all points, in products of complex double-doubles. It does not
    /// depend on the order of the points.
    pub(crate) fn spent(&self) -> u64 {
        self.spent.load(Ordering::Relaxed)
    }

    /// Adds so many products of complex double-doubles to the work.
    pub(crate) fn spend(&self, products: u64) {
        self.spent.fetch_add(products, Ordering::Relaxed);
    }

    pub(crate) fn len(&self) -> usize {
        self.exact.equations.len()
    }

    fn coefficients<S: Precision>(&self) -> &Vec<Vec<S>> {
        S::kept(self).get_or_init(|| {
            let numbers = |terms: &Vec<Term>| terms.iter().map(|t| S::from_exact(&t.coefficient)).collect();
            self.exact.equations.iter().map(numbers).collect()
        })
    }

    /// The equations in unknowns of about unit size near a point.
    pub(crate) fn near<S: Precision>(&self, point: &[Complex64]) -> LocalEquations<'_, S> {
        self.near_within(point, structure::SMALL)
    }

    /// [`near`](ExactEquations::near) a point of which coordinates below this share of the largest, or of one, may
    /// be zero in truth.
    pub(crate) fn near_within<S: Precision>(&self, point: &[Complex64], small: f64) -> LocalEquations<'_, S> {
        let units = units(point, small);
        // By how much coordinates exceed their units, as logarithms to base 2. Half a unit is much in
        // a high power; those that are much smaller than their unit may be zero.
        let excess = |(z, &u): (&Complex64, &i64)| Some(z.norm().log2() - u as f64).filter(|&e| e > -0.75);
        let excess: Vec<f64> = point.iter().zip(&units).map(|both| excess(both).unwrap_or(0.0)).collect();
        let mut coefficients = Vec::with_capacity(self.len());
        for (terms, numbers) in self.exact.equations.iter().zip(self.coefficients::<S>()) {
            let shift =
                |t: &Term| t.powers.iter().map(|&(j, e)| i64::from(e) * (units[j] + self.exact.scale[j])).sum::<i64>();
            let shifts: Vec<i64> = terms.iter().map(shift).collect();
            // Sizes of the terms at the point, small coordinates counted as one.
            let excess = |t: &Term| t.powers.iter().map(|&(j, e)| f64::from(e) * excess[j]).sum::<f64>();
            let sizes = numbers.iter().zip(&shifts).zip(terms);
            let top = sizes.map(|((c, &s), t)| c.log2() + s as f64 + excess(t)).fold(f64::NEG_INFINITY, f64::max);
            let top = if top.is_finite() { top.ceil() as i64 } else { 0 };
            coefficients.push(numbers.iter().zip(&shifts).map(|(c, s)| c.shifted(s - top)).collect());
        }
        LocalEquations { given: self, units, coefficients }
    }
}

/// Logarithms to base 2 of the units in which coordinates are about one: their sizes, or ten times
/// the share of the largest, or of one, below which they may be zero.
fn units(point: &[Complex64], small: f64) -> Vec<i64> {
    let largest = point.iter().map(|z| z.norm()).fold(1.0, f64::max);
    let unit = |z: &Complex64| if z.norm() > small * largest { z.norm() } else { 10.0 * small * largest };
    point.iter().map(|z| unit(z).log2().round() as i64).collect()
}

/// The given equations in unknowns and terms of about unit size near a point.
pub(crate) struct LocalEquations<'a, S> {
    pub(super) given: &'a ExactEquations,
    units: Vec<i64>,
    coefficients: Vec<Vec<S>>,
}

impl<'a, S: Number> LocalEquations<'a, S> {
    /// These equations in doubles.
    pub(crate) fn rounded(&self) -> LocalEquations<'a, Complex64> {
        let coefficients = self.coefficients.iter().map(|row| row.iter().map(S::to_c64).collect()).collect();
        LocalEquations { given: self.given, units: self.units.clone(), coefficients }
    }

    /// Adds so many products to the work.
    pub(crate) fn spend(&self, products: f64) {
        // As measured, up to 308 digits.
        let weight = (S::BITS / ComplexDd::BITS).powf(1.25);
        self.given.spend((products * weight) as u64);
    }

    /// A point in units of these equations.
    pub(crate) fn scaled(&self, point: &[Complex64]) -> Vec<S> {
        point.iter().zip(&self.units).map(|(z, u)| S::from_c64(*z).shifted(-u)).collect()
    }

    /// A point in the units of the unknowns.
    pub(crate) fn unscaled(&self, point: &[S]) -> Vec<S> {
        point.iter().zip(&self.units).map(|(z, &u)| z.shifted(u)).collect()
    }

    /// Powers of each coordinate that terms or their derivatives have, by places.
    fn powers(&self, x: &[S]) -> Vec<Vec<S>> {
        let of = |(exponents, x): (&Vec<u32>, &S)| {
            let (mut last, mut value) = (0, S::one());
            let mut power = |exponent: u32| {
                value = S::mul(&value, &raised(x, exponent - last));
                last = exponent;
                value
            };
            exponents.iter().map(|&e| power(e)).collect()
        };
        self.given.exact.exponents.iter().zip(x).map(of).collect()
    }

    /// Values of the equations, and their derivatives by rows.
    pub(crate) fn jacobian(&self, x: &[S]) -> (Vec<S>, Vec<Vec<S>>) {
        self.spend(4.0 * self.given.factors() as f64);
        let powers = self.powers(x);
        let (mut values, mut rows) = (Vec::new(), Vec::new());
        let mut before: Vec<S> = Vec::new();
        for (terms, coefficients) in self.given.exact.equations.iter().zip(&self.coefficients) {
            let (mut value, mut row) = (S::zero(), vec![S::zero(); x.len()]);
            for (term, c) in terms.iter().zip(coefficients) {
                // Products of the powers before each, and then with those behind.
                before.clear();
                let mut product = *c;
                for (&(j, _), &place) in term.powers.iter().zip(&term.places) {
                    before.push(product);
                    product = S::mul(&product, &powers[j][place]);
                }
                value = S::add(&value, &product);
                let mut behind = S::one();
                for ((&(j, e), &place), before) in term.powers.iter().zip(&term.places).zip(&before).rev() {
                    let others = S::mul(before, &behind);
                    // The power that is less by one stands before.
                    let slope =
                        if e == 1 { others } else { S::scale(&S::mul(&others, &powers[j][place - 1]), f64::from(e)) };
                    row[j] = S::add(&row[j], &slope);
                    behind = S::mul(&behind, &powers[j][place]);
                }
            }
            values.push(value);
            rows.push(row);
        }
        (values, rows)
    }

    /// Values of the equations.
    pub(crate) fn values(&self, x: &[S]) -> Vec<S> {
        let powers = self.powers(x);
        let product = |(term, c): (&Term, &S)| {
            term.powers.iter().zip(&term.places).fold(*c, |product, (&(j, _), &k)| S::mul(&product, &powers[j][k]))
        };
        let value = |(terms, coefficients): (&Vec<Term>, &Vec<S>)| {
            terms.iter().zip(coefficients).map(product).fold(S::zero(), |sum, z| S::add(&sum, &z))
        };
        self.given.exact.equations.iter().zip(&self.coefficients).map(value).collect()
    }

    /// The largest value of an equation at a point, as a logarithm to base 2: about that of its
    /// size relative to its terms.
    pub(crate) fn residual(&self, x: &[S]) -> f64 {
        largest(&self.values(x))
    }

    /// Equations with series for the unknowns, up to an order.
    pub(crate) fn series(&self, which: &[usize], basis: &Basis, x: &[Vec<S>], order: usize) -> Vec<Vec<S>> {
        self.spend((self.given.factors() * basis.pairs(order)) as f64);
        let mut powers: Vec<BTreeMap<u32, Vec<S>>> = vec![BTreeMap::new(); x.len()];
        for &(j, e) in which.iter().flat_map(|&i| &self.given.exact.equations[i]).flat_map(|t| &t.powers) {
            powers[j].insert(e, Vec::new());
        }
        for (powers, x) in powers.iter_mut().zip(x) {
            let (mut last, mut value) = (0, basis.constant(S::one(), order));
            for (&exponent, power) in powers.iter_mut() {
                value = basis.product(&value, &basis.power(x, exponent - last, order), order);
                (*power, last) = (value.clone(), exponent);
            }
        }
        let equation = |&i: &usize| {
            let mut sum = vec![S::zero(); basis.count(order)];
            for (term, c) in self.given.exact.equations[i].iter().zip(&self.coefficients[i]) {
                let mut product: Option<Vec<S>> = None;
                for (j, e) in &term.powers {
                    let power = &powers[*j][e];
                    product = Some(product.map_or_else(|| power.clone(), |p| basis.product(&p, power, order)));
                }
                match product {
                    None => sum[0] = S::add(&sum[0], c),
                    Some(product) => {
                        for (s, p) in sum.iter_mut().zip(&product) {
                            *s = S::mul_add(c, p, s);
                        }
                    }
                }
            }
            sum
        };
        which.iter().map(equation).collect()
    }
}

/// A power of a number.
fn raised<S: Number>(x: &S, exponent: u32) -> S {
    let mut power = S::one();
    for bit in (0..32 - exponent.leading_zeros()).rev() {
        power = S::sqr(&power);
        if exponent >> bit & 1 == 1 {
            power = S::mul(&power, x);
        }
    }
    power
}
