//! Systems of equations in named unknowns and parameters.

use crate::arena::Arena;
use crate::display;
use crate::exact::{self, ToExact};
use crate::expression::{Expr, Expressions};
use crate::graph::Id;
use crate::parse::{begins_name, continues_name};
use crate::polynomial::{Polynomial, Ring};
use std::collections::HashSet;

/// A system of equations `F(x; p) = 0` in named unknowns and parameters, as formulas that are not
/// expanded.
///
/// ```
/// use poly::System;
/// let system = System::build(|s| {
///     let (x, y, r) = (s.variable("x"), s.variable("y"), s.parameter("r"));
///     vec![x * x + y * y - r * r, x - y]
/// })?;
/// assert_eq!(system.variables(), ["x", "y"]);
/// assert_eq!(system.parameters(), ["r"]);
/// assert_eq!(system.len(), 2);
/// # Ok::<(), poly::SystemError>(())
/// ```
#[derive(Clone, Debug)]
pub struct System {
    pub(crate) arena: Arena,
    pub(crate) equations: Vec<Id>,
}

/// Why formulas do not make a system.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SystemError {
    /// A name that the parsers would not read.
    #[error(
        "`{0}` cannot be a name: names are letters, digits and underscores, do not begin with a digit, and `i` and `I` mean the imaginary unit"
    )]
    Name(String),
    /// A name that is used for two things.
    #[error("the name `{0}` stands for two things; rename one of them")]
    Duplicate(String),
    /// A constant that is infinite or not a number.
    #[error("a constant in the formulas is not finite")]
    NonFinite,
    /// A name in an equation that is neither an unknown nor a parameter.
    #[error("equation {equation}: `{name}` is neither an unknown nor a parameter; declare it or correct the name")]
    Undeclared {
        /// The equation, from 1.
        equation: usize,
        /// The name.
        name: String,
    },
}

impl System {
    /// The system of the formulas that a closure builds.
    ///
    /// Unknowns and parameters are ordered by first mention.
    ///
    /// # Errors
    /// If a name is used twice or could not be parsed back, or if a constant is not finite.
    pub fn build<F>(formulas: F) -> Result<System, SystemError>
    where
        F: for<'a> FnOnce(&'a Expressions) -> Vec<Expr<'a>>,
    {
        let expressions = Expressions::new();
        let mut equations = Vec::new();
        for formula in formulas(&expressions) {
            assert!(std::ptr::eq(formula.arena(), &expressions), "every equation must be built in the closure's arena");
            equations.push(formula.id());
        }
        System::from_arena(expressions.into_arena(), equations)
    }

    /// The system of these polynomials, with names for its unknowns.
    ///
    /// # Errors
    /// If a name is used twice or could not be parsed back, or if a coefficient is not finite.
    ///
    /// # Panics
    /// If the number of unknowns of a polynomial differs from the number of names.
    pub fn from_polynomials<R: Ring + ToExact>(
        names: &[&str],
        polynomials: &[Polynomial<R>],
    ) -> Result<System, SystemError> {
        let mut arena = Arena::default();
        let unknowns: Vec<Id> = names.iter().map(|name| arena.variable(name)).collect();
        if let Some(k) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
            return Err(SystemError::Duplicate(names[k].to_owned()));
        }
        let mut equations = Vec::with_capacity(polynomials.len());
        for polynomial in polynomials {
            assert_eq!(polynomial.variables(), names.len(), "a name for each unknown");
            let graph = &mut arena.graph;
            let mut sum = graph.integer(0);
            for (monomial, coefficient) in polynomial.terms() {
                let mut term = graph.constant(coefficient.to_exact().ok_or(SystemError::NonFinite)?);
                for (&unknown, &exponent) in unknowns.iter().zip(monomial.exponents()) {
                    let power = graph.pow(unknown, exponent);
                    term = graph.mul(term, power);
                }
                sum = graph.add(sum, term);
            }
            equations.push(sum);
        }
        System::from_arena(arena, equations)
    }

    pub(crate) fn from_arena(arena: Arena, equations: Vec<Id>) -> Result<System, SystemError> {
        let mut seen = HashSet::new();
        for name in arena.variables.iter().chain(&arena.parameters) {
            if !is_name(name) {
                return Err(SystemError::Name(name.clone()));
            }
            if !seen.insert(name) {
                return Err(SystemError::Duplicate(name.clone()));
            }
        }
        if arena.non_finite {
            return Err(SystemError::NonFinite);
        }
        Ok(System { arena, equations })
    }

    /// Names of the unknowns, in order.
    pub fn variables(&self) -> &[String] {
        &self.arena.variables
    }

    /// Names of the parameters, in order.
    pub fn parameters(&self) -> &[String] {
        &self.arena.parameters
    }

    /// Number of equations.
    pub fn len(&self) -> usize {
        self.equations.len()
    }

    /// Whether there are no equations.
    pub fn is_empty(&self) -> bool {
        self.equations.is_empty()
    }

    /// Whether all constants are real, so that real points have real values.
    pub fn is_real(&self) -> bool {
        let graph = &self.arena.graph;
        let used = graph.reachable(self.equations.iter().copied());
        (0..graph.len()).filter(|&id| used[id]).all(|id| graph.as_constant(id as Id).is_none_or(exact::is_real))
    }
}

/// Whether the parsers would read this as one name.
pub(crate) fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    chars.next().is_some_and(begins_name) && chars.all(continues_name) && name != "i" && name != "I"
}

impl std::fmt::Display for System {
    /// The system in plain text, which parses to a system with the same values: a line with the
    /// unknowns, a line with the parameters if there are some, and one equation per line, each
    /// ended by `;`. A formula of more than 100,000 symbols is cut short by `...`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (word, names) in [("variables", self.variables()), ("parameters", self.parameters())] {
            if !names.is_empty() {
                writeln!(f, "{word}: {}", names.join(" "))?;
            }
        }
        for &equation in &self.equations {
            display::write_node(f, &self.arena, equation)?;
            f.write_str(";\n")?;
        }
        Ok(())
    }
}
