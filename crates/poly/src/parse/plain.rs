//! Systems as plain text: one equation a line.

use super::error::ParseError;
use super::formula::{FormulaParser, Names, Role};
use super::token::{Token, Tokens};
use crate::arena::Arena;
use crate::graph::Id;
use crate::system::System;

/// Reads a system in plain text: see [`System::from_str`](System#impl-FromStr-for-System).
pub(super) fn plain(text: &str) -> Result<System, ParseError> {
    plain_in(text, Arena::default(), Names::default())
}

/// Reads a system in plain text into an arena in which some names are declared.
pub(super) fn plain_in(text: &str, arena: Arena, names: Names) -> Result<System, ParseError> {
    let mut reader = Reader::new(text, arena, names)?;
    while *reader.tokens.current() != Token::End {
        reader.statement()?;
    }
    reader.finish()
}

struct Reader<'t> {
    tokens: Tokens<'t>,
    arena: Arena,
    names: Names,
    equations: Vec<Id>,
    /// Which of the two declarations have been read.
    unknowns_declared: bool,
    parameters_declared: bool,
    /// Whether the last equation was ended by the end of its line, and whether any was ended by a
    /// semicolon.
    ended_by_line: bool,
    semicolons: bool,
    /// The first equation that begins with `-` after one that the end of its line has ended.
    doubtful: Option<usize>,
}

impl<'t> Reader<'t> {
    fn new(text: &'t str, arena: Arena, names: Names) -> Result<Reader<'t>, ParseError> {
        Ok(Reader {
            tokens: Tokens::with_lines(text)?,
            arena,
            names,
            equations: Vec::new(),
            unknowns_declared: false,
            parameters_declared: false,
            ended_by_line: false,
            semicolons: false,
            doubtful: None,
        })
    }

    /// A declaration, an equation or nothing, up to its end.
    fn statement(&mut self) -> Result<(), ParseError> {
        let role = match *self.tokens.current() {
            Token::LineEnd | Token::Semicolon => return self.tokens.advance(),
            Token::Name("variables" | "unknowns") if self.tokens.colon_follows() => Some(Role::Unknown),
            Token::Name("parameters") if self.tokens.colon_follows() => Some(Role::Parameter),
            _ => None,
        };
        match role {
            Some(role) => self.declaration(role),
            None => self.equation(),
        }
    }

    fn declaration(&mut self, role: Role) -> Result<(), ParseError> {
        let (seen, word) = match role {
            Role::Unknown => (&mut self.unknowns_declared, "unknowns"),
            Role::Parameter => (&mut self.parameters_declared, "parameters"),
        };
        if std::mem::replace(seen, true) {
            return Err(self.tokens.error(format!("a second line of {word}; name all of them in one")));
        }
        if !self.equations.is_empty() {
            return Err(self.tokens.error(format!("the {word} must be named before the first equation")));
        }
        // The word and its colon.
        self.tokens.advance()?;
        self.tokens.advance()?;
        loop {
            match *self.tokens.current() {
                Token::LineEnd | Token::Semicolon | Token::End => break,
                Token::Comma => {}
                Token::Name(name) => {
                    let declared = self.names.declare(&mut self.arena, name, role);
                    declared.map_err(|message| self.tokens.error(message))?;
                }
                ref other => {
                    let message = format!("expected the name of one of the {word}, found {}", other.describe());
                    return Err(self.tokens.error(message));
                }
            }
            self.tokens.advance()?;
        }
        // Parameters alone leave the unknowns to be found.
        self.names.closed |= matches!(role, Role::Unknown);
        Ok(())
    }

    fn equation(&mut self) -> Result<(), ParseError> {
        let start = self.tokens.offset();
        match self.tokens.current() {
            Token::Plus => {
                let message = "an equation begins with `+`; if it goes on with the one above, write both on one line";
                return Err(self.tokens.error(message));
            }
            Token::Minus if self.ended_by_line => self.doubtful = self.doubtful.or(Some(start)),
            _ => {}
        }
        let equation = FormulaParser::new(&mut self.arena, &mut self.names).equation(&mut self.tokens)?;
        self.equations.push(equation);
        match self.tokens.current() {
            Token::LineEnd | Token::End => self.ended_by_line = true,
            Token::Semicolon => (self.ended_by_line, self.semicolons) = (false, true),
            other => {
                let found = other.describe();
                return Err(self
                    .tokens
                    .error(format!("expected an operator or the end of the equation, found {found}")));
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<System, ParseError> {
        if self.equations.is_empty() {
            return Err(self.tokens.error("no equations; write one a line, such as `x^2 + y^2 = 5`"));
        }
        if let Some(offset) = self.doubtful.filter(|_| self.semicolons) {
            let message = "does this line begin an equation, or go on with the one above? End every equation with `;` \
                           on its line, or none";
            return Err(self.tokens.error_at(offset, message));
        }
        Ok(System { arena: self.arena, equations: self.equations })
    }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn reads_equations_comments_and_declarations() {
        let text =
            "# Two curves\r\nvariables: y, x\r\n\r\nx^2 + y^2 = 5  # a circle\n(x +\n  y)*2 = x*y*i # # =\n-x = 0;\n";
        let system = plain(text.strip_suffix(";\n").unwrap()).unwrap();
        assert_eq!((system.variables(), system.len()), (["y".to_owned(), "x".to_owned()].as_slice(), 3));
        let found = plain("x^2 + y^2 - 5; x*y - 2").unwrap();
        assert_eq!((found.variables(), found.len()), (["x".to_owned(), "y".to_owned()].as_slice(), 2));
        let same = plain("unknowns: y x\nx^2 + y^2 - 5; x*y - 2\nunknowns = 3").unwrap_err();
        assert!(same.message.contains("`unknowns` is neither"), "{same}");
        assert_eq!(plain("unknowns: y x\nx*y").unwrap().variables(), ["y".to_owned(), "x".to_owned()].as_slice());
        let family = plain("parameters: r\nx^2 + y^2 = r^2\nvariables = 3").unwrap();
        assert_eq!((family.variables().len(), family.parameters()), (3, ["r".to_owned()].as_slice()));
    }

    #[test]
    fn reads_signs_as_they_are_printed() {
        let printed = "x₁² + 2·x₁×y³ \u{2212} (x₁ \u{2013} y)⁻² = y¹⁰∙3⋅y; x₁⁺² - 2³*y⁰";
        let typed = "x₁^2 + 2*x₁*y^3 - (x₁ - y)^-2 = y^10*3*y; x₁^2 - 2^3*y^0";
        assert_eq!(plain(printed).unwrap().to_string(), plain(typed).unwrap().to_string());
        assert_eq!(plain(printed).unwrap().variables(), ["x₁", "y"]);
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (text, line, column, word) in [
            ("", 1, 1, "no equations"),
            ("# nothing\n\n", 3, 1, "no equations"),
            ("x +\ny", 1, 4, "the end of the line"),
            ("x\n+ y", 2, 1, "goes on"),
            ("x - 1; y\n- z;", 2, 1, "`;`"),
            ("x = 1 = y", 1, 7, "second `=`"),
            ("x = ", 1, 5, "the end of the text"),
            ("2 x = 3", 1, 3, "found `x`"),
            ("(x\n\ny", 3, 1, "found `y`"),
            ("x, y", 1, 2, "found `,`"),
            ("variables: x\nx*y", 2, 3, "neither an unknown"),
            ("variables: x x\nx", 1, 14, "twice"),
            ("variables: x 2\nx", 1, 14, "a number"),
            ("variables: i\nx", 1, 12, "imaginary"),
            ("variables: x\nvariables: y\nx", 2, 1, "second"),
            ("x\nvariables: x", 2, 1, "before the first equation"),
            ("x\ny ? 2", 2, 3, "unexpected character"),
            ("x²³ - x^2²", 1, 10, "power of a power"),
            ("x²^3", 1, 3, "power of a power"),
            ("xⁿ - 1", 1, 2, "no whole number"),
            ("x²⁻³", 1, 2, "no whole number"),
            ("x⁻", 1, 2, "no whole number"),
            ("x⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹", 1, 2, "2^31"),
            ("² - x", 1, 1, "expected a number"),
            ("x½ - 1", 1, 2, "unexpected character"),
        ] {
            let error = plain(text).unwrap_err();
            assert_eq!((error.line, error.column), (line, column), "{text:?}: {error}");
            assert!(error.message.contains(word), "{text:?}: {error}");
        }
    }
}
