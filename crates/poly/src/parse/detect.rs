//! Which format a text of a system is in.

use super::error::ParseError;
use super::family::family;
use super::phcpack::phcpack;
use super::plain::plain;
use crate::system::System;
use std::str::FromStr;

impl FromStr for System {
    type Err = ParseError;

    /// Reads a system from text, in whichever of three formats it is.
    ///
    /// **Plain text** has one equation a line: a formula that is to vanish, or two with `=` between
    /// them. An equation ends at the end of its line, or at `;`; in parentheses it runs on. `#`
    /// begins a comment. Names are unknowns, in order of first appearance, unless a line
    /// `variables: x y z` before the equations gives them and their order. A line `parameters: a b`
    /// makes these names parameters. `i` and `I` are the imaginary unit. Powers are written `x^2`,
    /// `x**2` or `x²`; decimals are exact. A product needs its sign: `*`, `·` or `×`.
    ///
    /// **PHCpack's format** begins with the number of equations: a text whose first line is a whole
    /// number, or two, is read by [`phcpack`].
    ///
    /// **TOML** has a line that begins `equations =` or `unknowns =`, with a list: it is read by
    /// [`family`].
    ///
    /// ```
    /// use poly::System;
    /// let plain: System = "x^2 + y^2 = 5; x*y = 2".parse()?;
    /// let same: System = "2\n x^2 + y^2 - 5;\n x*y - 2;".parse()?;
    /// assert_eq!(plain.to_string(), same.to_string());
    /// let again: System = plain.to_string().parse()?;
    /// assert_eq!(plain.to_string(), again.to_string());
    /// # Ok::<(), poly::ParseError>(())
    /// ```
    ///
    /// # Errors
    /// If the text does not parse, has no equations, or is a family with factors that must not
    /// vanish, which a system cannot hold.
    fn from_str(text: &str) -> Result<System, ParseError> {
        let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
        if begins_with_count(text) {
            return phcpack(text);
        }
        let Some(list) = list_of_toml(text) else { return plain(text) };
        let family = family(text)?;
        if !family.nonzero.is_empty() {
            let message = "this is a family with `nonzero`, which a system cannot hold; read it as a family";
            return Err(ParseError::at(text, list, message));
        }
        Ok(family.system)
    }
}

/// The mark with which some editors begin a file.
pub(super) const BYTE_ORDER_MARK: char = '\u{feff}';

/// Whether the text begins with a count: a whole number after which no formula can go on.
pub(super) fn begins_with_count(text: &str) -> bool {
    let text = text.trim_start();
    let rest = text.trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.len() == text.len() || !rest.chars().next().is_none_or(char::is_whitespace) {
        return false;
    }
    let next = rest.trim_start_matches([' ', '\t', '\r']).chars().next();
    next.is_none_or(|c| c == '\n' || c.is_alphanumeric() || matches!(c, '_' | '(' | '.'))
}

/// Where the first line is that begins a list of equations or unknowns in TOML. No formula has a
/// `[`.
pub(super) fn list_of_toml(text: &str) -> Option<usize> {
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        let key = line.trim_start();
        let value = ["equations", "unknowns"].iter().find_map(|word| key.strip_prefix(word));
        if value
            .and_then(|rest| rest.trim_start().strip_prefix('='))
            .is_some_and(|rest| rest.trim_start().starts_with('['))
        {
            return Some(offset + line.len() - key.len());
        }
        offset += line.len();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::System;

    #[test]
    fn every_format_is_known_by_its_beginning() {
        let plain: System = "x^2 - 2\ny - x".parse().unwrap();
        for text in [
            "2\nx^2 - 2;\ny - x;\n",
            "\n 2 2 \r\nx^2 - 2;\r\ny - x;\r\nTITLE : [",
            "2 x^2 - 2; y - x;",
            "\u{feff}x^2 = 2\r\ny = x\r\n",
            "# equations\nname = 'n'\nunknowns = ['x', 'y']\nequations = [\n'x^2 - 2', 'y = x']\n",
            "equations = [\"x^2 - 2\", \"y = x\"]\nunknowns=['x', 'y']\nname = ''",
        ] {
            let read: System = text.parse().unwrap();
            assert_eq!(read.to_string(), plain.to_string(), "{text}");
        }
        let two: System = "2 - x^2; 1 - x*y".parse().unwrap();
        assert_eq!(two.to_string(), "variables: x y\n2 - x^2;\n1 - x*y;\n");
        let one: System = "2*x = equations".parse().unwrap();
        assert_eq!(one.variables(), ["x", "equations"]);
    }

    #[test]
    fn what_a_system_cannot_hold_is_refused() {
        let text = "name = 'n'\nunknowns = ['x']\nequations = ['x^2 - 2']\nnonzero = ['x']\n";
        let error = text.parse::<System>().unwrap_err();
        assert!(error.message.contains("nonzero") && error.line == 2, "{error}");
        assert!("2\nx;".parse::<System>().unwrap_err().message.contains("found 1"));
        assert!("".parse::<System>().unwrap_err().message.contains("no equations"));
    }
}
