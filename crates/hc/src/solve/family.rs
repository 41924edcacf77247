//! The members of a parameter family, from its stored fibre.

use super::classify::{Excess, classify};
use super::paths;
use super::{SolveOptions, Solved};
use crate::fibre::Fibre;
use num_complex::Complex64;
use num_traits::ToPrimitive;
use poly::{Evaluate, Polynomial, SparseSystem, System};

/// Finds the isolated solutions of the member of a family at the parameters `target`, from all solutions at those of `fibre`, with
/// the same care as [`solve`](super::solve): jumped paths are tracked again, ends that are not regular go through the endgame.
///
/// `compiled` evaluates `family`: its interpreter or a generated program. The start system and torus of `options` have no meaning here.
/// Singular ends are told from points on components of positive dimension by the expanded polynomials; where these are too
/// large, or are none, singular ends count as failed.
///
/// ```
/// use hc::fibre::Fibre;
/// use hc::solve::{SolveOptions, solve_member};
/// use num_complex::Complex64;
/// let text = "name = \"roots\"\nunknowns = [\"x\"]\nparameters = [\"a\", \"b\"]\nequations = [\"x^2 + a*x + b\"]";
/// let family = hc::poly::parse::family(text)?.system;
/// let compiled = family.compile()?;
/// // From the roots of x^2 + 3 - 4i to (x - 3)^2.
/// let (zero, root) = (Complex64::new(0.0, 0.0), Complex64::new(1.0, 2.0));
/// let fibre = Fibre { parameters: vec![zero, -root * root], dimension: 1, solutions: vec![root, -root] };
/// let target = [-6.0, 9.0].map(Complex64::from);
/// let found = solve_member(&family, &compiled, &fibre, &target, &SolveOptions::default());
/// assert_eq!((found.solutions.len(), found.solutions[0].multiplicity), (1, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If the system is not square or `target` or the fibre do not fit it.
pub fn solve_member<E: Evaluate>(
    family: &System,
    compiled: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &SolveOptions,
) -> Solved {
    let excess = Excess::none();
    let ends = paths::follow(compiled, fibre, fibre.len(), target, false, &excess, options);
    let member = if !ends.singular.is_empty() { expanded(family, target) } else { None };
    let member = member.as_ref().map(|(system, coefficients)| (system, &coefficients[..]));
    let found = classify(member, &ends, &excess, options.paths.coincidence);
    Solved {
        start: None,
        mixed_volume: None,
        bezout_number: None,
        multihomogeneous_number: None,
        paths: found.counts(fibre.len(), ends.retracked),
        on_components: found.on_components,
        component_points: found.component_points.iter().map(|x| x.iter().map(|z| [z.re, z.im]).collect()).collect(),
        excess: found.excess,
        directions: found.directions,
        start_systems: 1,
        interrupted: options.monitor().is_cancelled() && found.lost > 0,
        solutions: found.solutions,
    }
}

/// The polynomials of a member as supports and coefficients.
fn expanded(family: &System, target: &[Complex64]) -> Option<(SparseSystem, Vec<Complex64>)> {
    let polynomials = family.at(target).ok()?.expand(&Default::default()).ok()?;
    let supports: Vec<Vec<Vec<i32>>> = polynomials.iter().map(Polynomial::support).collect();
    let terms = polynomials.iter().flat_map(|p| p.terms());
    let numbers = terms.map(|(_, c)| Some(Complex64::new(c.re.to_f64()?, c.im.to_f64()?)).filter(|z| z.is_finite()));
    Some((SparseSystem::new(family.variables().len(), &supports).ok()?, numbers.collect::<Option<_>>()?))
}
