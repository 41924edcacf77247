//! Split families against the families themselves, over exact and rounded numbers.

use super::pieces::Pieces;
use super::series::Truncated;
use super::{Split, cut, nested};
use crate::evaluate::Evaluate;
use crate::interval::ComplexInterval;
use crate::program::Interpreter;
use crate::scalar::Scalar;
use crate::simd::Isa;
use crate::system::System;
use crate::{ComplexDd, Rational};
use num_complex::Complex64;

/// Numbers from -1 to 1, the same in every run (constants of Knuth's linear congruential generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn complex(&mut self, size: f64) -> Complex64 {
        Complex64::new(self.next() * size, self.next() * size)
    }
}

/// Families as people write them: expanded, factored, with quotients, powers, constants and equations without
/// parameters or without unknowns in places.
const FAMILIES: [&str; 4] = [
    "['a*b*x^2*y + a*c*x*y - 2*b*c*x^2 + a^2*x*y + 3*c - x*y', 'b^3*x*y^2 - a*b*x + (2 + 3*i)*a*c^2*y - c*y^2 + a*x^3']",
    "['(a - b)*(x*(c + a) - y)^2 + (a*b + c)^3*x', '(1 + x^2)*(a*y - b) + (a - b)^2*c*x*y - (c - a*b)']",
    "['x/(a + b) + y*(a*c - b)/(y + c^2) - 1', 'x^3*a^(-1) - (b + c)*x*y + (a*b*c)^4*y^2']",
    "['x^2 + y^2 - 1', 'x - (a + b)*(b + c)*(c + a)']",
];

fn family(equations: &str) -> System {
    let head = "name = 'f'\nunknowns = ['x', 'y']\nparameters = ['a', 'b', 'c']\nequations = ";
    crate::parse::family(&format!("{head}{equations}")).expect("a family").system
}

fn values<S: Scalar>(program: &Interpreter, x: &[S], p: &[S]) -> (Vec<S>, Vec<S>) {
    let rows = program.equations();
    let (mut values, mut jacobian) = (vec![S::zero(); rows], vec![S::zero(); rows * program.variables()]);
    program.jacobian(&mut program.memory(Isa::Portable), x, p, &mut values, &mut jacobian);
    (values, jacobian)
}

fn splits(system: &System) -> Vec<Split> {
    let pieces: Vec<Pieces> = [cut::cut(system), nested::nested(system)].into_iter().flatten().collect();
    let compiled = |pieces: Pieces| pieces.compiled(2, 3).expect("programs");
    pieces.into_iter().map(compiled).map(|(parts, degrees, system)| Split { parts, degrees, system }).collect()
}

/// Over rational numbers, values and Jacobians are the same exactly.
#[test]
fn splits_are_the_families() {
    let mut numbers = Numbers(3);
    for (number, equations) in FAMILIES.iter().enumerate() {
        let system = family(equations);
        let whole = system.compile().unwrap();
        let splits = splits(&system);
        // The third one divides by a sum, so that it cannot be expanded.
        assert_eq!(splits.len(), if number == 2 { 1 } else { 2 });
        for split in splits {
            assert!(split.degrees().is_sorted_by(|a, b| a >= b) && split.degrees().iter().all(|&d| d > 0 && d <= 8));
            for _ in 0..20 {
                let mut draw = || Rational::from_c64(Complex64::new((9.0 * numbers.next()).round(), 1.0));
                let (x, p) = ([draw(), draw()], [draw(), draw(), draw()]);
                let (q, _) = values(split.parts(), &[], &p);
                assert_eq!(format!("{:?}", values(split.system(), &x, &q)), format!("{:?}", values(&whole, &x, &p)));
            }
        }
    }
}

/// The coefficients along a line give the parts anywhere on it, to the bound that
/// [`Split::along`] states.
#[test]
fn coefficients_are_as_accurate_as_stated() {
    let mut numbers = Numbers(4);
    for equations in FAMILIES {
        for split in splits(&family(equations)) {
            for scale in [1.0, 1e-8] {
                // A target far smaller than the start, too: then nearly everything cancels at the end.
                let target = [0; 3].map(|_| numbers.complex(scale));
                let direction = [0; 3].map(|_| numbers.complex(1.0));
                let mut along = Vec::new();
                split.along(&target, &direction, &mut along);
                let m = split.degrees().len();
                for t in [0.0, 1e-9, 1e-3, 0.3, 1.0] {
                    let p = [0, 1, 2].map(|i| {
                        ComplexDd::mul_add(&direction[i].into(), &Complex64::from(t).into(), &target[i].into())
                    });
                    let (exact, _) = values(split.parts(), &[], &p);
                    let sizes = [0, 1, 2].map(|i| Complex64::from(target[i].norm() + t * direction[i].norm()));
                    for i in 0..m {
                        let degree = split.degrees()[i] as usize;
                        let horner = (0..=degree).rev().fold(Complex64::default(), |sum, k| sum * t + along[k * m + i]);
                        let error = (ComplexDd::sub(&exact[i], &horner.into())).high().norm();
                        let bound = 60.0 * f64::EPSILON * size(&split, i, &sizes);
                        assert!(error <= bound, "{equations}, part {i} at {t}: {error:e} > {bound:e}");
                        assert!((degree + 1..along.len() / m).all(|k| along[k * m + i] == Complex64::default()));
                    }
                }
            }
        }
    }
}

/// Part `i` with absolute values in place of all its terms, at least, for parameters of these sizes: radii of intervals
/// around zero add up and multiply.
fn size(split: &Split, i: usize, sizes: &[Complex64; 3]) -> f64 {
    let p: Vec<ComplexInterval> = sizes.iter().map(|z| ComplexInterval::around(Complex64::default(), z.re)).collect();
    values(split.parts(), &[], &p).0[i].magnitude()
}

#[test]
fn what_is_short_is_not_split() {
    // Nothing is saved where each parameter is used once as it is.
    let system = family("['x^2 - a', 'y*b - c']");
    assert!(Split::new(&system, &system.compile().unwrap()).is_none());
    // Expanded, the first equation has seven terms in five monomials of the unknowns; two coefficients are of degree 2.
    let system = family(FAMILIES[0]);
    let whole = system.compile().unwrap();
    let split = Split::new(&system, &whole).unwrap();
    assert!(split.system().program().value_operations() < whole.program().value_operations());
}

#[test]
fn series_are_cut_off() {
    let real = |c: [f64; 3]| Truncated::<3>(c.map(Complex64::from));
    let (a, b) = (real([1.0, 2.0, 3.0]), real([2.0, -1.0, 4.0]));
    assert_eq!(Truncated::mul(&a, &b), real([2.0, 3.0, 8.0]));
    // (1 + 2 t + 3 t^2) / (2 - t + 4 t^2) = 1/2 + 5/4 t + 9/8 t^2 + ...
    assert_eq!(Truncated::div(&a, &b), real([0.5, 1.25, 1.125]));
    assert_eq!(Truncated::mul_real(&a, &real([2.0, 0.0, 0.0])), real([2.0, 4.0, 6.0]));
}
