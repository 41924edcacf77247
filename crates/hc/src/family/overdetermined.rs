//! Families with more equations than unknowns.
//!
//! As in [`solve`](crate::solve()), random combinations of the equations are tracked, as many as unknowns. They have
//! all solutions of the equations, and others. Solutions for generic parameters stay solutions of all equations while
//! parameters move: loops join them with each other alone, the orbits of the combinations are orbits of the family or
//! have none of its solutions, and the trace test of such orbits needs no change. A path that ends at a point that
//! solves the combinations alone has jumped, or began at a solution for special parameters.

use super::error::FamilyError;
use crate::random::{Random, Stream};
use crate::refine::{Refiner, size};
use crate::solve::{combinations, sizes};
use crate::tolerances::families;
use num_complex::Complex64;
use poly::{ComplexDd, Evaluate, Interpreter, Isa, System};

/// Random points at which the size of an equation is measured.
const POINTS: usize = 8;
/// Powers of two beyond these are not used.
const MOST: i64 = 1000;

/// More equations than unknowns.
#[derive(Debug)]
pub(super) struct Overdetermined {
    /// Random combinations of them, as many as unknowns.
    pub(super) square: System,
    /// All of them.
    all: Interpreter,
}

/// What all equations say of a regular solution of combinations of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// It solves them.
    Solves,
    /// It does not solve the one of this number, from 0.
    Misses(usize),
    /// Its digits do not tell whether it solves the one of this number, from 0.
    Unclear(usize),
}

impl Overdetermined {
    /// The equations of a system; `None` if they are not more than the unknowns.
    ///
    /// # Errors
    /// If a formula does not compile.
    pub(super) fn new(system: &System) -> Result<Option<Overdetermined>, FamilyError> {
        let (equations, unknowns) = (system.len(), system.variables().len());
        if equations <= unknowns {
            return Ok(None);
        }
        let all = system.compile()?;
        let usable = |sizes: &Vec<i64>| sizes.iter().all(|size| size.abs() <= MOST);
        let sizes = sizes(&all, 0).filter(usable).unwrap_or_else(|| vec![0; equations]);
        let degrees = system.degrees_as_written().unwrap_or_else(|| vec![1; equations]);
        let degree = |i: usize| i64::try_from(degrees[i]).unwrap_or(i64::MAX);
        let combined = combinations((0..equations).collect(), degree, unknowns, 0);
        let square = System::build(|s| {
            let unknowns: Vec<_> = system.variables().iter().map(|name| s.variable(name)).collect();
            let parameters: Vec<_> = system.parameters().iter().map(|name| s.parameter(name)).collect();
            let formulas = system.instantiate(s, &unknowns, &parameters);
            let share = |&(i, factor): &(usize, Complex64)| formulas[i] * (factor * 2f64.powi(-sizes[i] as i32));
            combined.iter().map(|combination| s.sum(combination.iter().map(share))).collect()
        });
        // The names and constants come from a system that exists already.
        let square = square.map_err(|_| FamilyError::NoPair)?;
        Ok(Some(Overdetermined { square, all }))
    }

    /// What the equations say of a regular solution of the combinations, whose program this is, for parameters `p`.
    ///
    /// Values are relative to the sizes of the equations at points with coordinates of the same sizes. Where all
    /// equations are solved they fall with the error of the point, to that of double-double.
    pub(super) fn verdict(&self, combined: &Interpreter, p: &[Complex64], x: &[Complex64]) -> Verdict {
        let zero = Complex64::default();
        let count = self.all.equations();
        let (mut values, mut precise_values) = (vec![zero; count], vec![ComplexDd::from(zero); count]);
        let precise = Refiner::new(combined).extend(p, x);
        let precise_p: Vec<ComplexDd> = p.iter().map(|&z| z.into()).collect();
        self.all.values(&mut self.all.memory(Isa::Portable), &precise, &precise_p, &mut precise_values);
        let mut squares = vec![0.0; count];
        let largest = x.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let (mut random, mut memory) = (Random::of(0, Stream::Sizes), self.all.memory(Isa::Portable));
        for _ in 0..POINTS {
            let beside: Vec<Complex64> = x.iter().map(|z| random.unit() * size(z.norm(), largest)).collect();
            self.all.values(&mut memory, &beside, p, &mut values);
            squares.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value.norm_sqr() / POINTS as f64);
        }
        let relative = |(value, square): (&ComplexDd, &f64)| {
            let value = Complex64::from(*value).norm();
            if value == 0.0 { 0.0 } else { value / square.sqrt() }
        };
        let worst = precise_values.iter().zip(&squares).map(relative).enumerate();
        // What is no number is worst.
        let larger = |a: (usize, f64), b: (usize, f64)| if b.1 <= a.1 || a.1.is_nan() { a } else { b };
        match worst.fold((0, 0.0), larger) {
            (_, value) if value <= families::SOLVES => Verdict::Solves,
            (equation, value) if value > families::MISSES => Verdict::Misses(equation),
            (equation, _) => Verdict::Unclear(equation),
        }
    }
}
