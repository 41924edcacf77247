//! Polynomials as text that the parsers read back.

use super::terms::{Polynomial, Ring};
use crate::display::{PRODUCT, write_constant};
use crate::exact::{self, ToExact};
use num_traits::{One, Signed};
use std::fmt::{Display, Formatter, Result};

/// A polynomial with names for its unknowns.
struct Named<'a, R> {
    polynomial: &'a Polynomial<R>,
    names: &'a [&'a str],
}

impl<R: Ring + ToExact> Polynomial<R> {
    /// The polynomial as text, with terms in descending order; the parsers read it back exactly.
    ///
    /// # Panics
    /// If there are fewer names than unknowns.
    pub fn display<'a>(&'a self, names: &'a [&'a str]) -> impl Display + 'a {
        assert!(names.len() >= self.variables(), "a name for each unknown");
        Named { polynomial: self, names }
    }
}

impl<R: Ring + ToExact> Display for Named<'_, R> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if self.polynomial.is_empty() {
            return f.write_str("0");
        }
        for (k, (monomial, c)) in self.polynomial.terms().iter().enumerate() {
            let Some(mut c) = c.to_exact() else { return f.write_str("nan") };
            let negative = exact::is_real(&c) && c.re.is_negative();
            if negative {
                c = -c;
            }
            f.write_str(match (k, negative) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            })?;
            let factors = monomial.exponents().iter().zip(self.names).filter(|(e, _)| **e != 0);
            let mut first = true;
            if !c.is_one() || factors.clone().next().is_none() {
                write_constant(f, &c, PRODUCT)?;
                first = false;
            }
            for (&exponent, name) in factors {
                if !first {
                    f.write_str("*")?;
                }
                first = false;
                match exponent {
                    1 => f.write_str(name)?,
                    e if e < 0 => write!(f, "{name}^({e})")?,
                    e => write!(f, "{name}^{e}")?,
                }
            }
        }
        Ok(())
    }
}
