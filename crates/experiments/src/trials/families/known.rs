//! A family with the numbers of its solutions.

use hc::poly::{Family, ParseError};

/// The unknowns, as many as a family has.
pub(super) const UNKNOWNS: [&str; 4] = ["x", "y", "z", "w"];

/// The parameters, as many as a family has.
pub(super) const PARAMETERS: [&str; 3] = ["a", "b", "c"];

/// A family, and what is known of its solutions for generic parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// Number of unknowns, which are named x, y, z, w in this order.
    pub unknowns: usize,
    /// Number of parameters, which are named a, b, c in this order.
    pub parameters: usize,
    /// The equations.
    pub equations: Vec<String>,
    /// Factors that must not vanish.
    pub nonzero: Vec<String>,
    /// Maps that take solutions to solutions, stated.
    pub symmetry: Vec<Vec<String>>,
    /// Number of regular solutions at which none of the factors vanishes.
    pub regular: usize,
    /// Multiplicities of the other solutions, which are isolated: in ascending order.
    pub multiplicities: Vec<usize>,
    /// Whether solutions of positive dimension, which are not sought, are among the others.
    pub has_components: bool,
}

impl Known {
    /// Equations in so many unknowns and parameters with so many solutions, all of them regular.
    pub(super) fn new(unknowns: usize, parameters: usize, equations: Vec<String>, regular: usize) -> Known {
        Known { unknowns, parameters, equations, regular, ..Known::default() }
    }

    /// The names of the unknowns.
    pub fn unknowns(&self) -> &'static [&'static str] {
        &UNKNOWNS[..self.unknowns]
    }

    /// The names of the parameters.
    pub fn parameters(&self) -> &'static [&'static str] {
        &PARAMETERS[..self.parameters]
    }

    /// The family.
    ///
    /// # Errors
    /// None for those of [`Kind::family`](super::Kind::family); those of the parser are passed on.
    pub fn family(&self) -> Result<Family, ParseError> {
        let mut family = Family::from_formulas(self.unknowns(), self.parameters(), &self.equations)?;
        if !self.nonzero.is_empty() {
            family = family.with_nonzero(&self.nonzero)?;
        }
        for map in &self.symmetry {
            family = family.with_symmetry(map)?;
        }
        Ok(family)
    }
}
