//! Formulas multiplied out, within limits.

use crate::exact::{self, Exact};
use crate::graph::{Id, Node};
use crate::polynomial::{Polynomial, Terms, accumulate};
use crate::system::System;
use num_bigint::BigInt;
use num_traits::One;

/// Limits within which formulas are multiplied out.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExpandLimits {
    /// Most terms of any polynomial, intermediate ones included. Default 200,000.
    pub terms: usize,
    /// Most steps for the whole system. A step multiplies two machine words or makes four
    /// exponents, in about a microsecond. Default 5,000,000.
    pub work: usize,
    /// Most bits of the numerators and denominators of one coefficient. Default 65,536.
    pub bits: u64,
}

impl Default for ExpandLimits {
    fn default() -> ExpandLimits {
        ExpandLimits { terms: 200_000, work: 5_000_000, bits: 1 << 16 }
    }
}

/// Why a formula cannot be multiplied out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpandError {
    /// A formula divides by a sum.
    #[error(
        "equation {equation} divides by a sum that contains unknowns or parameters; multiply it out by the denominator"
    )]
    NotPolynomial {
        /// The equation, from 1.
        equation: usize,
    },
    /// A formula divides by the constant zero.
    #[error("equation {equation} divides by the constant zero")]
    DivisionByZero {
        /// The equation, from 1.
        equation: usize,
    },
    /// A limit of [`ExpandLimits`] was reached.
    #[error("equation {equation} would need {what} beyond the limit of {limit}; keep the formula or raise the limit")]
    TooLarge {
        /// The equation, from 1.
        equation: usize,
        /// What would be too large.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
}

impl System {
    /// The equations as polynomials in the unknowns, followed by the parameters.
    ///
    /// Divisions by constants and by single terms are allowed; a division by a term gives negative
    /// exponents.
    ///
    /// ```
    /// let system = poly::parse::phcpack("1\n (x + y)^2/2 - 1/x;")?;
    /// let polynomials = system.expand(&Default::default())?;
    /// assert_eq!(polynomials[0].display(&["x", "y"]).to_string(), "1/2*x^2 + x*y + 1/2*y^2 - x^(-1)");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If an equation is not polynomial or would grow beyond the limits.
    pub fn expand(&self, limits: &ExpandLimits) -> Result<Vec<Polynomial<Exact>>, ExpandError> {
        let uses = self.arena.graph.uses(&self.equations);
        let mut expansion = Expansion {
            system: self,
            limits,
            shared: uses.iter().map(|&count| count > 1).collect(),
            uses,
            known: vec![None; self.arena.graph.len()],
            width: self.variables().len() + self.parameters().len(),
            work: 0,
        };
        (0..self.len()).map(|k| expansion.equation(k)).collect()
    }
}

/// What went wrong, before it is known in which equation.
enum Fault {
    NotPolynomial,
    DivisionByZero,
    TooLarge(&'static str, u64),
}

struct Expansion<'a> {
    system: &'a System,
    limits: &'a ExpandLimits,
    /// Whether a node is used more than once in all.
    shared: Vec<bool>,
    /// Uses still to come.
    uses: Vec<u32>,
    known: Vec<Option<Polynomial<Exact>>>,
    width: usize,
    work: usize,
}

impl Expansion<'_> {
    fn equation(&mut self, k: usize) -> Result<Polynomial<Exact>, ExpandError> {
        let root = self.system.equations[k];
        let equation = k + 1;
        self.run(root).map_err(|fault| match fault {
            Fault::NotPolynomial => ExpandError::NotPolynomial { equation },
            Fault::DivisionByZero => ExpandError::DivisionByZero { equation },
            Fault::TooLarge(what, limit) => ExpandError::TooLarge { equation, what, limit },
        })?;
        Ok(self.take(root))
    }

    /// Expands everything below a node, operands first.
    fn run(&mut self, root: Id) -> Result<(), Fault> {
        let graph = &self.system.arena.graph;
        let mut stack = vec![(root, false)];
        while let Some((id, ready)) = stack.pop() {
            if self.known[id as usize].is_some() {
                continue;
            }
            let operands = self.operands(id);
            if ready {
                let value = self.node(id, graph.node(id), &operands)?;
                self.known[id as usize] = Some(value);
            } else {
                stack.push((id, true));
                stack.extend(operands.iter().map(|&(operand, _)| (operand, false)));
            }
        }
        Ok(())
    }

    /// Operands with signs; a sum counts the terms of inner sums that nothing else uses as its own,
    /// so that a polynomial of many terms is added up once.
    fn operands(&self, id: Id) -> Vec<(Id, bool)> {
        let graph = &self.system.arena.graph;
        if graph.node(id).is_sum() {
            return graph.terms_of_sum(id, |inner| !self.shared[inner as usize]);
        }
        graph.node(id).operands().map(|operand| (operand, false)).collect()
    }

    /// The value of an operand, moved out at its last use.
    fn take(&mut self, id: Id) -> Polynomial<Exact> {
        let uses = &mut self.uses[id as usize];
        *uses = uses.saturating_sub(1);
        let value = if *uses == 0 { self.known[id as usize].take() } else { self.known[id as usize].clone() };
        value.expect("operands are expanded first")
    }

    fn node(&mut self, id: Id, node: Node, operands: &[(Id, bool)]) -> Result<Polynomial<Exact>, Fault> {
        let graph = &self.system.arena.graph;
        match node {
            Node::Constant(_) => {
                self.spend(self.term_work())?;
                let value = graph.as_constant(id).expect("a constant").clone();
                Ok(Polynomial::constant(self.width, value))
            }
            Node::Variable(k) => {
                self.spend(self.term_work())?;
                Ok(Polynomial::variable(self.width, k as usize))
            }
            Node::Parameter(k) => {
                self.spend(self.term_work())?;
                Ok(Polynomial::variable(self.width, self.system.variables().len() + k as usize))
            }
            Node::Add(..) | Node::Sub(..) | Node::Neg(_) => {
                let mut sum = Terms::default();
                for &(operand, negative) in operands {
                    for (monomial, c) in self.take(operand).terms() {
                        let c = if negative { -c.clone() } else { c.clone() };
                        let total = accumulate(&mut sum, monomial.clone(), c);
                        // Adding rationals takes a greatest common divisor, quadratic in their
                        // length.
                        let words = (exact::bits(total) / 64) as usize;
                        self.spend(self.term_work() + words * words / 256)?;
                    }
                }
                self.check(Polynomial::from_sum(self.width, sum))
            }
            Node::Mul(a, b) => {
                let (a, b) = (self.take(a), self.take(b));
                self.product(&a, &b)
            }
            Node::Div(a, b) => {
                let (a, b) = (self.take(a), self.take(b));
                let inverse = self.power(&b, -1)?;
                self.product(&a, &inverse)
            }
            Node::Pow(a, k) => {
                let a = self.take(a);
                self.power(&a, k)
            }
        }
    }

    /// What a term costs by its exponents alone.
    fn term_work(&self) -> usize {
        1 + self.width / 4
    }

    fn spend(&mut self, work: usize) -> Result<(), Fault> {
        self.work = self.work.saturating_add(work);
        if self.work > self.limits.work {
            return Err(Fault::TooLarge("work", self.limits.work as u64));
        }
        Ok(())
    }

    fn check(&self, value: Polynomial<Exact>) -> Result<Polynomial<Exact>, Fault> {
        if value.len() > self.limits.terms {
            return Err(Fault::TooLarge("terms", self.limits.terms as u64));
        }
        if value.terms().iter().any(|(_, c)| exact::bits(c) > self.limits.bits) {
            return Err(Fault::TooLarge("bits in a coefficient", self.limits.bits));
        }
        Ok(value)
    }

    fn product(&mut self, a: &Polynomial<Exact>, b: &Polynomial<Exact>) -> Result<Polynomial<Exact>, Fault> {
        let words = |p: &Polynomial<Exact>| p.terms().iter().map(|(_, c)| 1 + (exact::bits(c) / 64) as usize).sum();
        let (left, right): (usize, usize) = (words(a), words(b));
        self.spend(left.saturating_mul(right).saturating_mul(self.term_work()))?;
        let exponents = Fault::TooLarge("exponents", i32::MAX as u64);
        if !fits(a, b) {
            return Err(exponents);
        }
        // Integers are multiplied much faster than what may be fractions.
        let product = match (integers(a), integers(b)) {
            (Some(a), Some(b)) => a.checked_mul(&b, self.limits.terms).map(|product| product.map(exact::from_integer)),
            _ => a.checked_mul(b, self.limits.terms),
        };
        self.check(product.ok_or(Fault::TooLarge("terms", self.limits.terms as u64))?)
    }

    fn power(&mut self, a: &Polynomial<Exact>, k: i32) -> Result<Polynomial<Exact>, Fault> {
        let magnitude = k.unsigned_abs();
        match a.terms() {
            [] if k < 0 => Err(Fault::DivisionByZero),
            [] => Ok(Polynomial::zero(self.width)),
            [(monomial, c)] => {
                if !c.is_one() && exact::bits(c).saturating_mul(u64::from(magnitude)) > self.limits.bits {
                    return Err(Fault::TooLarge("bits in a coefficient", self.limits.bits));
                }
                let monomial = monomial.checked_pow(k).ok_or(Fault::TooLarge("exponents", i32::MAX as u64))?;
                let c = exact::pow(c, k);
                Ok(Polynomial::term(monomial, c))
            }
            _ if k < 0 => Err(Fault::NotPolynomial),
            // The k-th power of a sum has more than k terms.
            _ if magnitude as usize >= self.limits.terms => Err(Fault::TooLarge("terms", self.limits.terms as u64)),
            _ => {
                let mut value = a.clone();
                for bit in (0..31 - magnitude.leading_zeros()).rev() {
                    value = self.product(&value, &value)?;
                    if magnitude >> bit & 1 == 1 {
                        value = self.product(&value, a)?;
                    }
                }
                Ok(value)
            }
        }
    }
}

/// A polynomial with integer coefficients, if all of them are integers.
fn integers(a: &Polynomial<Exact>) -> Option<Polynomial<BigInt>> {
    let is_integer = |c: &Exact| exact::is_real(c) && c.re.is_integer();
    a.terms().iter().all(|(_, c)| is_integer(c)).then(|| a.map(|c| c.re.numer().clone()))
}

/// Whether the exponents of a product stay in the range of 32 bits.
fn fits(a: &Polynomial<Exact>, b: &Polynomial<Exact>) -> bool {
    let largest = |p: &Polynomial<Exact>| {
        p.terms().iter().flat_map(|(m, _)| m.exponents()).map(|e| i64::from(e.unsigned_abs())).max().unwrap_or(0)
    };
    largest(a) + largest(b) <= i64::from(i32::MAX)
}

#[cfg(test)]
mod tests {
    use crate::{ExpandError, parse};

    fn expand(text: &str) -> Result<String, ExpandError> {
        let system = parse::phcpack(&format!("1\n{text};")).unwrap();
        let names: Vec<&str> = system.variables().iter().map(String::as_str).collect();
        Ok(system.expand(&Default::default())?[0].display(&names).to_string())
    }

    #[test]
    fn multiplies_out() {
        assert_eq!(expand("(x + y)^3 - (x - y)*(x + y)^2").unwrap(), "2*x^2*y + 4*x*y^2 + 2*y^3");
        assert_eq!(expand("(x + 1)^2*(x - 1)^2 - (x^2 - 1)^2").unwrap(), "0");
        assert_eq!(expand("(x - 2*y)/(4*x*y)").unwrap(), "1/4*y^(-1) - 1/2*x^(-1)");
        assert_eq!(expand("x^999999999*x^999999999").unwrap(), "x^1999999998");
        assert_eq!(expand("((1 + 2*i)*x)^2").unwrap(), "(-3 + 4*i)*x^2");
    }

    #[test]
    fn refuses_what_would_explode() {
        for text in [
            "(x + y)^999999999",
            "(1 + x + y + z + u + v)^60*(1 + a + b + c + d)^60",
            "(2*x)^999999999",
            "(((((x+y)^9)^9)^9)^9)^9",
            "3^999999*x*3^999999*3^999999",
            "x^2000000000*x^2000000000*y",
        ] {
            let error = expand(text).unwrap_err();
            assert!(matches!(error, ExpandError::TooLarge { equation: 1, .. }), "{text}: {error}");
        }
        assert_eq!(expand("1/(x + y)").unwrap_err(), ExpandError::NotPolynomial { equation: 1 });
        assert_eq!(expand("1/((x + 1) - x - 1)").unwrap_err(), ExpandError::DivisionByZero { equation: 1 });
    }

    #[test]
    fn many_terms_take_linear_time() {
        let text: String = (0..100_000).map(|k| format!("+ {k}*x^{}*y^{}", k % 300, k / 300)).collect();
        assert_eq!(expand(&text).unwrap().matches('x').count(), 99_999 - 333);
    }
}
