//! PHCpack's format: the number of polynomials, then polynomials ended by `;`.

use super::error::ParseError;
use super::formula::{FormulaParser, Names};
use super::token::{Token, Tokens};
use crate::arena::Arena;
use crate::system::System;
use crate::wording::counted;

/// Reads a system in PHCpack's format.
///
/// The first line is the number of polynomials, or that number and the number of unknowns. Each
/// polynomial ends in `;`; powers are written `^` or `**`, the imaginary unit `i` or `I`. Unknowns
/// are ordered by first appearance (so a leading `x - x + y - y` fixes an order). What follows the
/// last polynomial is not read.
///
/// ```
/// let system = poly::parse::phcpack("2\n x**2 + y^2 - 1;\n (x - y)*(1 + 2*i) - 1.5E-3;\nTITLE : an example")?;
/// assert_eq!(system.variables(), ["x", "y"]);
/// # Ok::<(), poly::parse::ParseError>(())
/// ```
///
/// # Errors
/// If the count is missing or does not fit, or if a polynomial does not parse.
pub fn phcpack(text: &str) -> Result<System, ParseError> {
    phcpack_in(text, Arena::default(), Names::default())
}

/// Reads PHCpack's format into an arena in which some names are declared.
pub(super) fn phcpack_in(text: &str, mut arena: Arena, mut names: Names) -> Result<System, ParseError> {
    let (count, unknowns, body) = header(text)?;
    let mut equations = Vec::new();
    let mut position = body;
    for k in 0..count {
        let mut tokens = Tokens::new(text, position)?;
        if *tokens.current() == Token::End {
            return Err(
                tokens.error(format!("expected {}, each ended by `;`, found {k}", counted(count, "polynomial")))
            );
        }
        equations.push(FormulaParser::new(&mut arena, &mut names).sum(&mut tokens)?);
        if *tokens.current() != Token::Semicolon {
            let found = tokens.current().describe();
            return Err(tokens.error(format!("expected an operator or `;`, found {found}")));
        }
        position = tokens.offset() + 1;
    }
    if let Some(unknowns) = unknowns.filter(|&unknowns| unknowns != arena.variables.len()) {
        let found = arena.variables.len();
        let message =
            format!("the first line announces {}, the polynomials have {found}", counted(unknowns, "unknown"));
        return Err(ParseError::at(text, 0, message));
    }
    Ok(System { arena, equations })
}

/// Number of polynomials, number of unknowns where stated, and where the polynomials begin.
fn header(text: &str) -> Result<(usize, Option<usize>, usize), ParseError> {
    let start = text.len() - text.trim_start().len();
    let end = text[start..].find('\n').map_or(text.len(), |k| start + k);
    let mut numbers = Vec::new();
    let mut position = start;
    while numbers.len() < 2 {
        let rest = text[position..end].trim_start_matches([' ', '\t', '\r']);
        let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        let follows = rest[digits..].chars().next();
        // The second number may also be the coefficient that begins the first polynomial.
        if digits == 0 || !(follows.is_none_or(char::is_whitespace)) {
            break;
        }
        let place = end - rest.len();
        let number = rest[..digits].parse().map_err(|_| ParseError::at(text, place, "this count is too large"))?;
        numbers.push(number);
        position = place + digits;
    }
    match numbers[..] {
        [] => Err(ParseError::at(text, start, "expected the number of polynomials on the first line")),
        [count] => Ok((count, None, position)),
        [count, unknowns, ..] => Ok((count, Some(unknowns), position)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_every_spelling() {
        let text = "2 2\r\n x**2+ y^2 - 1;\r\n(1.0 + 2.5E+00*i)*(x-y)**3/4 + 1.0E-40*I;\nTITLE : x # @ ((";
        let system = phcpack(text).unwrap();
        assert_eq!(system.variables(), ["x", "y"]);
        assert_eq!(system.len(), 2);
        let again: System = system.to_string().parse().unwrap();
        assert_eq!(again.to_string(), system.to_string());
    }

    #[test]
    fn unknowns_keep_the_order_of_first_mention() {
        let system = phcpack("1\nb - b + a - a + a*b - 2;").unwrap();
        assert_eq!(system.variables(), ["b", "a"]);
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (text, line, column, word) in [
            ("", 1, 1, "number of polynomials"),
            ("x^2 - 1;", 1, 1, "number of polynomials"),
            ("2\nx^2 - 1;\n", 3, 1, "found 1"),
            ("1\nx^2 - 1", 2, 8, "`;`"),
            ("1\nx^2 + * 3;", 2, 7, "found `*`"),
            ("1\n 2 x;", 2, 4, "found `x`"),
            ("1 3\nx + y;", 1, 1, "announces 3"),
            ("99999999999999999999999\nx;", 1, 1, "too large"),
            ("1\nx^999999999999;", 2, 3, "exponent"),
            ("1\nx ? y;", 2, 3, "unexpected character"),
            ("999999999999\nx;", 2, 3, "found 1"),
        ] {
            let error = phcpack(text).unwrap_err();
            assert_eq!((error.line, error.column), (line, column), "{error}");
            assert!(error.message.contains(word), "{error}");
        }
    }
}
