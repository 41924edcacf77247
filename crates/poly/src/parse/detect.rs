//! Which format a text of a system is in.

use super::error::ParseError;
use super::family::{Family, family};
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
    /// `variables: x y z` before the equations, or `unknowns: x y z`, gives them and their order. A
    /// line `parameters: a b` makes these names parameters. `i` and `I` are the imaginary unit.
    /// Powers are written `x^2`, `x**2` or `x²`; decimals are exact. A product needs its sign: `*`,
    /// `·` or `×`.
    ///
    /// **PHCpack's format** begins with the number of equations: a text whose first line is a whole
    /// number, or two, is read by [`phcpack`].
    ///
    /// **TOML** has a line in which a key of families (`equations`, `unknowns`, ...) stands before `=`
    /// and a list or a text in quotes: it is read by [`family`].
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
        let text = unmarked(text);
        if begins_with_count(text) {
            return phcpack(text);
        }
        let Some(toml) = line_of_toml(text) else { return plain(text) };
        let family = family(text)?;
        if !family.nonzero.is_empty() {
            let message = "this is a family with `nonzero`, which a system cannot hold; read it as a family";
            return Err(ParseError::at(text, text.find("nonzero").unwrap_or(toml), message));
        }
        Ok(family.system)
    }
}

/// The mark with which some editors begin a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

impl FromStr for Family {
    type Err = ParseError;

    /// Reads a family from text.
    ///
    /// **TOML** is read by [`family`]. **Plain text** is that of a [`System`], where a line
    /// `parameters: a b` before the equations names the parameters; it states nothing but the
    /// equations.
    ///
    /// ```
    /// let family: poly::Family = "parameters: r a\nx^2 + y^2 = r^2\ny = a*x".parse()?;
    /// assert_eq!(family.system.variables(), ["x", "y"]);
    /// assert_eq!(family.system.parameters(), ["r", "a"]);
    /// # Ok::<(), poly::ParseError>(())
    /// ```
    ///
    /// # Errors
    /// If the text does not parse, or is plain and names no parameters.
    fn from_str(text: &str) -> Result<Family, ParseError> {
        let text = unmarked(text);
        if line_of_toml(text).is_some() {
            return family(text);
        }
        let system: System = text.parse()?;
        if system.parameters().is_empty() {
            let message = "a family has parameters; name them in a line `parameters: a b` before the equations";
            return Err(ParseError::at(text, 0, message));
        }
        Ok(Family::from(system))
    }
}

/// The text without the mark with which some editors begin a file.
pub(super) fn unmarked(text: &str) -> &str {
    text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text)
}

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

/// Where the first line is in which a key of families has a list or a text in quotes as its value.
/// No formula has a `[` or quotes.
pub(super) fn line_of_toml(text: &str) -> Option<usize> {
    const KEYS: [&str; 6] = ["equations", "unknowns", "parameters", "name", "nonzero", "symmetry"];
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        let key = line.trim_start();
        let value = KEYS.iter().find_map(|word| key.strip_prefix(word));
        if value
            .and_then(|rest| rest.trim_start().strip_prefix('='))
            .is_some_and(|rest| rest.trim_start().starts_with(['[', '"', '\'']))
        {
            return Some(offset + line.len() - key.len());
        }
        offset += line.len();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{Family, System};

    #[test]
    fn families_are_read_from_plain_text_and_toml() {
        let toml = "name = ''\nunknowns = ['y', 'x']\nparameters = ['a', 'b']\nequations = ['a*x = b', 'y = x']\n";
        let toml: Family = toml.parse().unwrap();
        for text in [
            "parameters: a b\nunknowns: y x\na*x = b\ny = x",
            "\u{feff}# lines\r\nvariables: y, x\r\nparameters: a, b\r\na*x = b; y = x;\r\n",
        ] {
            let plain: Family = text.parse().unwrap();
            assert_eq!(plain.system.to_string(), toml.system.to_string(), "{text}");
            assert_eq!((plain.name.as_str(), plain.roots, plain.nonzero.len()), ("", None, 0));
            // What is printed is read back.
            let again: Family = plain.system.to_string().parse().unwrap();
            assert_eq!(again.system.to_string(), toml.system.to_string(), "{text}");
        }
        for (text, line, words) in [
            ("x^2 = 2", 1, "parameters: a b"),
            ("1\nx^2 - 2;", 1, "parameters: a b"),
            ("", 1, "no equations"),
            ("parameters: a\nunknowns: x\na*x = y", 3, "neither an unknown"),
            ("parameters: a\nunknowns: x\nvariables: y\na*x = y", 3, "second line"),
            ("name = 'n'\n", 1, "missing field"),
        ] {
            let error = text.parse::<Family>().unwrap_err();
            assert!(error.line == line && error.message.contains(words), "{text}: {error}");
        }
    }

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
        assert!(error.message.contains("nonzero") && error.line == 4, "{error}");
        assert!("2\nx;".parse::<System>().unwrap_err().message.contains("found 1"));
        assert!("".parse::<System>().unwrap_err().message.contains("no equations"));
    }
}
