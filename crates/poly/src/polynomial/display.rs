//! Polynomials as text that the parsers read back.

use super::{Polynomial, Ring};
use crate::display::{PRODUCT, write_constant};
use crate::exact::{self, Exact};
use num_bigint::BigInt;
use num_complex::{Complex, Complex64};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use std::fmt::{Display, Formatter, Result};

/// Coefficients that can be written so that the parsers read them back.
pub trait Coefficient: Ring {
    /// The exact value, `None` where it is not finite.
    fn to_exact(&self) -> Option<Exact>;
}

fn real(value: BigRational) -> Exact {
    Complex::new(value, BigRational::zero())
}

impl Coefficient for i64 {
    fn to_exact(&self) -> Option<Exact> {
        Some(exact::from_i64(*self))
    }
}
impl Coefficient for BigInt {
    fn to_exact(&self) -> Option<Exact> {
        Some(real(BigRational::from_integer(self.clone())))
    }
}
impl Coefficient for BigRational {
    fn to_exact(&self) -> Option<Exact> {
        Some(real(self.clone()))
    }
}
impl Coefficient for Exact {
    fn to_exact(&self) -> Option<Exact> {
        Some(self.clone())
    }
}
impl Coefficient for f64 {
    fn to_exact(&self) -> Option<Exact> {
        exact::from_f64(*self)
    }
}
impl Coefficient for Complex64 {
    fn to_exact(&self) -> Option<Exact> {
        Some(Complex::new(BigRational::from_float(self.re)?, BigRational::from_float(self.im)?))
    }
}

/// A polynomial with names for its unknowns.
struct Named<'a, R> {
    polynomial: &'a Polynomial<R>,
    names: &'a [&'a str],
}

impl<R: Coefficient> Polynomial<R> {
    /// The polynomial as text, in descending order of terms; the parsers read it back exactly.
    ///
    /// # Panics
    /// If there are fewer names than unknowns.
    pub fn display<'a>(&'a self, names: &'a [&'a str]) -> impl Display + 'a {
        assert!(names.len() >= self.variables(), "a name for each unknown");
        Named { polynomial: self, names }
    }
}

impl<R: Coefficient> Display for Named<'_, R> {
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
