//! Formulas by operator precedence, straight into the hash-consed graph; lists of equations, each a
//! text of its own.

use super::error::ParseError;
use super::token::{Token, Tokens};
use crate::arena::Arena;
use crate::exact::Exact;
use crate::graph::Id;
use crate::system::{System, is_name};
use num_complex::Complex;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use std::collections::HashMap;

/// Deepest nesting of parentheses.
const DEPTH_LIMIT: usize = 256;

/// What names mean.
#[derive(Default)]
pub(super) struct Names {
    /// Nodes of the names.
    pub(super) known: HashMap<String, Id>,
    /// Whether any other name is an error. It is a new unknown if not.
    pub(super) closed: bool,
}

impl Names {
    /// Declares an unknown or a parameter; says what is wrong with the name where it cannot be one.
    pub(super) fn declare(&mut self, arena: &mut Arena, name: &str, role: Role) -> Result<(), String> {
        if !is_name(name) {
            return Err(format!("`{name}` cannot be a name (letters, digits, `_`; `i` is the imaginary unit)"));
        }
        if self.known.contains_key(name) {
            return Err(format!("`{name}` is declared twice"));
        }
        let id = match role {
            Role::Unknown => arena.variable(name),
            Role::Parameter => arena.parameter(name),
        };
        self.known.insert(name.to_owned(), id);
        Ok(())
    }
}

/// What a declared name is.
#[derive(Clone, Copy)]
pub(super) enum Role {
    Unknown,
    Parameter,
}

/// Parses formulas into one arena.
pub(super) struct FormulaParser<'a> {
    pub(super) arena: &'a mut Arena,
    pub(super) names: &'a mut Names,
    depth: usize,
}

impl<'a> FormulaParser<'a> {
    pub(super) fn new(arena: &'a mut Arena, names: &'a mut Names) -> FormulaParser<'a> {
        FormulaParser { arena, names, depth: 0 }
    }

    /// A sum, or the difference of two sums with `=` between them; stops at the first token that
    /// cannot continue it.
    pub(super) fn equation(&mut self, tokens: &mut Tokens<'_>) -> Result<Id, ParseError> {
        let left = self.sum(tokens)?;
        if *tokens.current() != Token::Equals {
            return Ok(left);
        }
        tokens.advance()?;
        let right = self.sum(tokens)?;
        if *tokens.current() == Token::Equals {
            return Err(tokens.error("a second `=` in one equation"));
        }
        Ok(self.arena.graph.sub(left, right))
    }

    /// A sum of terms; stops at the first token that cannot continue it.
    pub(super) fn sum(&mut self, tokens: &mut Tokens<'_>) -> Result<Id, ParseError> {
        let mut value = self.term(tokens)?;
        loop {
            let subtract = match tokens.current() {
                Token::Plus => false,
                Token::Minus => true,
                _ => return Ok(value),
            };
            tokens.advance()?;
            let term = self.term(tokens)?;
            let graph = &mut self.arena.graph;
            value = if subtract { graph.sub(value, term) } else { graph.add(value, term) };
        }
    }

    /// Products and quotients, after any number of signs.
    fn term(&mut self, tokens: &mut Tokens<'_>) -> Result<Id, ParseError> {
        let negative = signs(tokens)?;
        let mut value = self.power(tokens)?;
        loop {
            let divide = match tokens.current() {
                Token::Times => false,
                Token::Over => true,
                _ => break,
            };
            tokens.advance()?;
            let place = tokens.offset();
            let negative = signs(tokens)?;
            let factor = self.power(tokens)?;
            let graph = &mut self.arena.graph;
            if divide && graph.is_zero(factor) {
                return Err(tokens.error_at(place, "division by zero"));
            }
            value = if divide { graph.div(value, factor) } else { graph.mul(value, factor) };
            if negative {
                value = graph.neg(value);
            }
        }
        Ok(if negative { self.arena.graph.neg(value) } else { value })
    }

    fn power(&mut self, tokens: &mut Tokens<'_>) -> Result<Id, ParseError> {
        let place = tokens.offset();
        let base = self.atom(tokens)?;
        let exponent = match *tokens.current() {
            Token::Power => {
                tokens.advance()?;
                exponent(tokens)?
            }
            Token::Superscript(exponent) => {
                let bounded = i32::try_from(exponent).ok().filter(|k| k.unsigned_abs() < i32::MAX.unsigned_abs());
                let exponent = bounded.ok_or_else(|| tokens.error("an exponent beyond 2^31"))?;
                tokens.advance()?;
                exponent
            }
            _ => return Ok(base),
        };
        if matches!(tokens.current(), Token::Power | Token::Superscript(_)) {
            return Err(tokens.error("a power of a power needs parentheses"));
        }
        if exponent < 0 && self.arena.graph.is_zero(base) {
            return Err(tokens.error_at(place, "zero to a negative power"));
        }
        Ok(self.arena.graph.pow(base, exponent))
    }

    fn atom(&mut self, tokens: &mut Tokens<'_>) -> Result<Id, ParseError> {
        let id = match tokens.current().clone() {
            Token::Number(value) => self.arena.graph.constant(value),
            Token::Name(name) => self.name(name, tokens)?,
            Token::Open => {
                if self.depth == DEPTH_LIMIT {
                    return Err(tokens.error(format!("parentheses nested deeper than {DEPTH_LIMIT}")));
                }
                self.depth += 1;
                tokens.advance()?;
                let inner = self.sum(tokens)?;
                self.depth -= 1;
                if *tokens.current() != Token::Close {
                    let found = tokens.current().describe();
                    return Err(tokens.error(format!("expected an operator or `)`, found {found}")));
                }
                inner
            }
            other => {
                return Err(tokens.error(format!("expected a number, a name or `(`, found {}", other.describe())));
            }
        };
        tokens.advance()?;
        Ok(id)
    }

    fn name(&mut self, name: &str, tokens: &Tokens<'_>) -> Result<Id, ParseError> {
        if name == "i" || name == "I" {
            let unit: Exact = Complex::new(BigRational::zero(), BigRational::one());
            return Ok(self.arena.graph.constant(unit));
        }
        if let Some(&id) = self.names.known.get(name) {
            return Ok(id);
        }
        if self.names.closed {
            let message = format!("`{name}` is neither an unknown nor a parameter; declare it or correct the name");
            return Err(tokens.error(message));
        }
        let id = self.arena.variable(name);
        self.names.known.insert(name.to_owned(), id);
        Ok(id)
    }
}

/// A formula that takes up the whole text.
pub(super) fn whole_formula(arena: &mut Arena, names: &mut Names, text: &str) -> Result<Id, ParseError> {
    let mut tokens = Tokens::new(text, 0)?;
    let id = FormulaParser::new(arena, names).sum(&mut tokens)?;
    at_end(&tokens)?;
    Ok(id)
}

/// An equation that takes up the whole text: a formula that is to vanish, or two with `=` between
/// them.
pub(super) fn whole_equation(arena: &mut Arena, names: &mut Names, text: &str) -> Result<Id, ParseError> {
    let mut tokens = Tokens::new(text, 0)?;
    let id = FormulaParser::new(arena, names).equation(&mut tokens)?;
    at_end(&tokens)?;
    Ok(id)
}

/// A system of these equations; errors name the `part` and its number.
pub(super) fn equations<S: AsRef<str>>(
    mut arena: Arena,
    mut names: Names,
    part: &str,
    formulas: &[S],
) -> Result<System, ParseError> {
    let mut equations = Vec::with_capacity(formulas.len());
    for (k, formula) in formulas.iter().enumerate() {
        let equation = whole_equation(&mut arena, &mut names, formula.as_ref());
        equations.push(equation.map_err(|e| e.within(format!("{part} {}", k + 1)))?);
    }
    Ok(System { arena, equations })
}

fn at_end(tokens: &Tokens<'_>) -> Result<(), ParseError> {
    if *tokens.current() == Token::End {
        return Ok(());
    }
    Err(tokens.error(format!("expected an operator, found {}", tokens.current().describe())))
}

/// Skips signs and tells whether they amount to a minus.
fn signs(tokens: &mut Tokens<'_>) -> Result<bool, ParseError> {
    let mut negative = false;
    loop {
        match tokens.current() {
            Token::Minus => negative = !negative,
            Token::Plus => {}
            _ => return Ok(negative),
        }
        tokens.advance()?;
    }
}

/// A whole number, signed or in parentheses, that fits in 32 bits.
fn exponent(tokens: &mut Tokens<'_>) -> Result<i32, ParseError> {
    let place = tokens.offset();
    let parentheses = *tokens.current() == Token::Open;
    if parentheses {
        tokens.advance()?;
    }
    let negative = signs(tokens)?;
    let Token::Number(value) = tokens.current() else {
        return Err(tokens.error("an exponent must be a whole number"));
    };
    if !value.re.is_integer() {
        return Err(tokens.error("an exponent must be a whole number"));
    }
    let magnitude = value.re.to_i32().filter(|&k| k < i32::MAX);
    let Some(magnitude) = magnitude else {
        return Err(tokens.error_at(place, "an exponent beyond 2^31"));
    };
    tokens.advance()?;
    if parentheses {
        if *tokens.current() != Token::Close {
            return Err(tokens.error("expected `)` after the exponent"));
        }
        tokens.advance()?;
    }
    Ok(if negative { -magnitude } else { magnitude })
}
