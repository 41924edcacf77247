//! Formulas that are tracked as they were written.
//!
//! Where a formula multiplies many sums, as `(x + y)^20` does, the terms of its expanded form cancel
//! near its roots, and digits are lost. Supports and start systems come from the expanded form all the
//! same.

use crate::random::{Random, Stream};
use crate::tolerances::EQUATIONS;
use num_complex::Complex64;
use poly::{Evaluate, Interpreter, Isa, System};

/// Points at which sizes are measured.
const POINTS: usize = 64;
/// Powers of two beyond these are not used.
const MOST: i64 = 1000;

/// The system, if its formulas should be tracked as they were written.
pub(super) fn worth_tracking(system: &System) -> Option<&System> {
    Some(system).filter(|system| system.sums_multiplied().iter().any(|&count| count >= EQUATIONS.factors))
}

/// The formulas in unknowns in units of `2^units`, each divided by its size and multiplied by one
/// parameter; `None` if they cannot be compiled, or numbers are out of range.
///
/// The size is the geometric mean at points whose scaled unknowns are of modulus one. Coefficients do
/// not tell it: those of `(x + y)^50` reach 1e14, but the mean is 1.
pub(super) fn program(system: &System, units: &[i64], seed: u64) -> Option<Interpreter> {
    let alone = scaled(system, units, None)?;
    let sizes = sizes(&alone, seed)?;
    scaled(system, units, Some(&sizes))
}

/// With sizes, the formulas are divided by `2^sizes` and multiplied by a parameter.
fn scaled(system: &System, units: &[i64], sizes: Option<&[i64]>) -> Option<Interpreter> {
    if units.iter().chain(sizes.into_iter().flatten()).any(|k| k.abs() > MOST) {
        return None;
    }
    let power = |k: i64| 2f64.powi(k as i32);
    let mut name = String::from("s");
    while system.variables().contains(&name) {
        name.push('_');
    }
    let built = System::build(|s| {
        let unknowns = system.variables().iter().zip(units);
        let unknowns: Vec<_> = unknowns.map(|(name, &unit)| s.variable(name) * power(unit)).collect();
        let formulas = system.instantiate(s, &unknowns, &[]);
        match sizes {
            None => formulas,
            Some(sizes) => {
                let share = s.parameter(&name);
                formulas.into_iter().zip(sizes).map(|(formula, &size)| formula * power(-size) * share).collect()
            }
        }
    });
    built.ok()?.compile().ok()
}

/// Logarithms to base 2 of the geometric means of the formulas, rounded.
fn sizes(program: &Interpreter, seed: u64) -> Option<Vec<i64>> {
    let mut random = Random::of(seed, Stream::Sizes);
    let mut memory = program.memory(Isa::Portable);
    let mut values = vec![Complex64::new(0.0, 0.0); program.equations()];
    let mut sums = vec![0.0; program.equations()];
    for _ in 0..POINTS {
        let point: Vec<Complex64> = (0..program.variables()).map(|_| random.unit()).collect();
        program.values(&mut memory, &point, &[], &mut values);
        sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value.norm().log2());
    }
    sums.iter().map(|sum| Some(sum / POINTS as f64).filter(|mean| mean.is_finite()).map(|m| m.round() as i64)).collect()
}

#[cfg(test)]
mod tests {
    use super::{program, scaled, sizes, worth_tracking};
    use poly::parse::phcpack;

    #[test]
    fn sums_of_monomials_are_not_worth_it() {
        for (formulas, worth) in [("x^2+y-1;\nx*y*(x+y)-2", false), ("(x+y)^20-1;\nx-y^2", true)] {
            let system = phcpack(&format!("2\n{formulas};")).unwrap();
            assert_eq!(worth_tracking(&system).is_some(), worth, "{formulas}");
        }
    }

    #[test]
    fn sizes_are_those_of_values() {
        // By Jensen's formula the geometric mean of |x + y| on the unit torus is 1, and that of |x - 3 y| is 3.
        let system = phcpack("2\n4*(x+y)^50;\n(x-3*y)^8;").unwrap();
        let found = sizes(&scaled(&system, &[0, 0], None).unwrap(), 0).unwrap();
        // ln |x + y| has the variance pi^2 / 12, and 50 log2 |x + y| the deviation 65: the mean of 64 is within 25, three of its
        // own. That of 8 log2 |x - 3 y| is 0.35.
        assert!((found[0] - 2).abs() <= 25 && (found[1] as f64 - 8.0 * 3f64.log2()).abs() <= 2.0, "{found:?}");
        // In units of 8 and 2, x - 3y is 8 x - 6 y.
        let found = sizes(&scaled(&system, &[3, 1], None).unwrap(), 0).unwrap();
        assert!((found[1] as f64 - 24.0).abs() <= 3.0, "{found:?}");
        assert!(program(&system, &[3, 1], 0).is_some() && program(&system, &[2000, 1], 0).is_none());
    }
}
