//! Formulas that are tracked as they were written, because they are too large to be expanded: from a
//! total degree start system, which needs only their degrees.

use super::equations::ScaledEquations;
use super::error::SolveError;
use super::options::{SolveOptions, Start};
use super::start::Starts;
use crate::random::{Random, Stream};
use num_complex::Complex64;
use poly::{Evaluate, ExpandError, Interpreter, Isa, System};

/// Points at which sizes are measured.
const POINTS: usize = 64;
/// Powers of two beyond these are not used.
const MOST: i64 = 1000;

/// The start systems of formulas that cannot be expanded, which `error` says.
///
/// # Errors
/// That error where no total degree start system serves: it was not asked for, or there are not as
/// many equations as unknowns, or degrees are not known; and if there are too many paths.
pub(super) fn starts(system: &System, error: &ExpandError, options: &SolveOptions) -> Result<Starts, SolveError> {
    let n = system.variables().len();
    let serves = matches!(options.start, Start::Auto | Start::TotalDegree) && system.len() == n;
    let degrees = system.degrees_as_written().filter(|degrees| serves && !degrees.contains(&0));
    let program = degrees.as_ref().and_then(|_| program(system, options.seed));
    let (Some(degrees), Some(program)) = (degrees, program) else { return Err(error.clone().into()) };
    Starts::of_program(ScaledEquations::without_terms(n), program, degrees, options)
}

/// The formulas, each divided by its size and multiplied by one parameter; `None` if they cannot be compiled,
/// or numbers are out of range.
///
/// The size is the geometric mean at points whose coordinates are of modulus one. Coefficients do
/// not tell it: those of `(x + y)^50` reach 1e14, but the mean is 1.
fn program(system: &System, seed: u64) -> Option<Interpreter> {
    let sizes = sizes(&system.compile().ok()?, seed)?;
    divided(system, &sizes)
}

/// The formulas, divided by `2^sizes` and multiplied by a parameter.
fn divided(system: &System, sizes: &[i64]) -> Option<Interpreter> {
    if sizes.iter().any(|k| k.abs() > MOST) {
        return None;
    }
    let mut name = String::from("s");
    while system.variables().contains(&name) {
        name.push('_');
    }
    let built = System::build(|s| {
        let unknowns: Vec<_> = system.variables().iter().map(|name| s.variable(name)).collect();
        let formulas = system.instantiate(s, &unknowns, &[]);
        let share = s.parameter(&name);
        formulas.into_iter().zip(sizes).map(|(formula, &size)| formula * 2f64.powi(-size as i32) * share).collect()
    });
    built.ok()?.compile().ok()
}

/// Logarithms to base 2 of the geometric means of the formulas, rounded, where unknowns and parameters are of modulus
/// one; `None` if they are out of range.
pub(crate) fn sizes(program: &Interpreter, seed: u64) -> Option<Vec<i64>> {
    let mut random = Random::of(seed, Stream::Sizes);
    let mut memory = program.memory(Isa::Portable);
    let mut values = vec![Complex64::new(0.0, 0.0); program.equations()];
    let mut sums = vec![0.0; program.equations()];
    for _ in 0..POINTS {
        let point: Vec<Complex64> = (0..program.variables()).map(|_| random.unit()).collect();
        let parameters: Vec<Complex64> = (0..program.parameters()).map(|_| random.unit()).collect();
        program.values(&mut memory, &point, &parameters, &mut values);
        sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value.norm().log2());
    }
    sums.iter().map(|sum| Some(sum / POINTS as f64).filter(|mean| mean.is_finite()).map(|m| m.round() as i64)).collect()
}

#[cfg(test)]
mod tests {
    use super::{divided, sizes};
    use poly::parse::phcpack;

    #[test]
    fn sizes_are_those_of_values() {
        // By Jensen's formula the geometric mean of |x + y| on the unit torus is 1, and that of |x - 3 y| is 3.
        let system = phcpack("2\n4*(x+y)^50;\n(x-3*y)^8;").unwrap();
        let found = sizes(&system.compile().unwrap(), 0).unwrap();
        // ln |x + y| has the variance pi^2 / 12, and 50 log2 |x + y| the deviation 65: the mean of 64 is within 25, three of its
        // own. That of 8 log2 |x - 3 y| is 0.35.
        assert!((found[0] - 2).abs() <= 25 && (found[1] as f64 - 8.0 * 3f64.log2()).abs() <= 2.0, "{found:?}");
        assert!(divided(&system, &found).is_some() && divided(&system, &[2000, 1]).is_none());
    }
}
