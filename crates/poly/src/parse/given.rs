//! Systems and families from formulas that a program gives one by one.

use super::detect::{begins_with_count, line_of_toml, unmarked};
use super::error::ParseError;
use super::family::Family;
use super::formula::{Names, Role, equations, whole_formula};
use super::phcpack::phcpack_in;
use super::plain::plain_in;
use crate::arena::Arena;
use crate::formula::Formula;
use crate::system::System;
use std::str::FromStr;

impl FromStr for Formula {
    type Err = ParseError;

    /// Reads a formula; every name is a symbol.
    ///
    /// # Errors
    /// If the text is not one formula.
    fn from_str(text: &str) -> Result<Formula, ParseError> {
        let mut arena = Arena::default();
        let root = whole_formula(&mut arena, &mut Names::default(), text)?;
        Ok(Formula::from_arena(&arena, root))
    }
}

impl System {
    /// A system of equations given as text; every name is an unknown.
    ///
    /// An equation is a formula that is to vanish, or two formulas with `=` between them. Unknowns
    /// are ordered by first appearance. `i` and `I` are the imaginary unit.
    ///
    /// ```
    /// let system = poly::System::from_formulas(&["x^2 + y^2 = 5", "x*y - 2"])?;
    /// assert_eq!(system.variables(), ["x", "y"]);
    /// # Ok::<(), poly::ParseError>(())
    /// ```
    ///
    /// # Errors
    /// If an equation does not parse; the field `within` of the error names the equation.
    pub fn from_formulas<S: AsRef<str>>(formulas: &[S]) -> Result<System, ParseError> {
        equations(Arena::default(), Names::default(), "equation", formulas)
    }

    /// A system of equations given as text, in these unknowns.
    ///
    /// ```
    /// let system = poly::System::from_formulas_in(&["y", "x"], &["x^2 + y^2 = 5", "x*y - 2"])?;
    /// assert_eq!(system.variables(), ["y", "x"]);
    /// assert!(poly::System::from_formulas_in(&["x"], &["x*y - 2"]).is_err());
    /// # Ok::<(), poly::ParseError>(())
    /// ```
    ///
    /// # Errors
    /// If an equation does not parse or has a name that is not among the unknowns, or if an unknown
    /// is given twice or cannot be a name.
    pub fn from_formulas_in<N: AsRef<str>, S: AsRef<str>>(
        unknowns: &[N],
        formulas: &[S],
    ) -> Result<System, ParseError> {
        let none: &[&str] = &[];
        let (arena, names) = declared(unknowns, none)?;
        equations(arena, names, "equation", formulas)
    }

    /// A system from text in one of the formats of [`from_str`](System#impl-FromStr-for-System), in
    /// these unknowns.
    ///
    /// ```
    /// let system = poly::System::from_text_in(&["y", "x"], "2\n x^2 + y^2 - 5;\n x*y - 2;")?;
    /// assert_eq!(system.variables(), ["y", "x"]);
    /// # Ok::<(), poly::ParseError>(())
    /// ```
    ///
    /// # Errors
    /// If the text does not parse, declares its unknowns itself or has a name that is not among
    /// these, or if an unknown is given twice or cannot be a name.
    pub fn from_text_in<N: AsRef<str>>(unknowns: &[N], text: &str) -> Result<System, ParseError> {
        let none: &[&str] = &[];
        let (arena, names) = declared(unknowns, none)?;
        let text = unmarked(text);
        if begins_with_count(text) {
            return phcpack_in(text, arena, names);
        }
        match line_of_toml(text) {
            None => plain_in(text, arena, names),
            Some(list) => Err(ParseError::at(text, list, "this text declares its unknowns; do not give them again")),
        }
    }
}

/// A family without a name, of which nothing but the equations is known.
impl From<System> for Family {
    fn from(system: System) -> Family {
        let nonzero = System { arena: system.arena.clone(), equations: Vec::new() };
        Family { name: String::new(), system, roots: None, nonzero, symmetry: Vec::new() }
    }
}

impl Family {
    /// A family of equations in these unknowns and parameters, without a name, a number of roots or
    /// factors that must not vanish.
    ///
    /// ```
    /// use poly::Family;
    /// let family = Family::from_formulas(&["x", "y"], &["r", "a"], &["x^2 + y^2 = r^2", "y = a*x"])?
    ///     .with_name("circle and line")
    ///     .with_roots(2)
    ///     .with_nonzero(&["r"])?;
    /// assert_eq!(family.system.parameters(), ["r", "a"]);
    /// assert_eq!(family.nonzero.len(), 1);
    /// # Ok::<(), poly::ParseError>(())
    /// ```
    ///
    /// # Errors
    /// If an equation does not parse or has an undeclared name, or if a name is declared twice or
    /// cannot be one.
    pub fn from_formulas<N: AsRef<str>, P: AsRef<str>, S: AsRef<str>>(
        unknowns: &[N],
        parameters: &[P],
        formulas: &[S],
    ) -> Result<Family, ParseError> {
        let (arena, names) = declared(unknowns, parameters)?;
        Ok(Family::from(equations(arena, names, "equation", formulas)?))
    }

    /// The family under a name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Family {
        self.name = name.into();
        self
    }

    /// The family with its number of isolated solutions for generic parameters.
    #[must_use]
    pub fn with_roots(mut self, roots: usize) -> Family {
        self.roots = Some(roots);
        self
    }

    /// The family with these factors that must not vanish at a solution, instead of those that it
    /// had.
    ///
    /// # Errors
    /// If a factor does not parse or has an undeclared name.
    pub fn with_nonzero<S: AsRef<str>>(mut self, factors: &[S]) -> Result<Family, ParseError> {
        let (arena, names) = declared(self.system.variables(), self.system.parameters())?;
        self.nonzero = equations(arena, names, "nonzero factor", factors)?;
        Ok(self)
    }

    /// The family with one more symmetry: a map that takes solutions to solutions for the same
    /// parameters, one formula an unknown.
    ///
    /// # Errors
    /// If a formula does not parse or has an undeclared name.
    pub fn with_symmetry<S: AsRef<str>>(mut self, map: &[S]) -> Result<Family, ParseError> {
        let (arena, names) = declared(self.system.variables(), self.system.parameters())?;
        self.symmetry.push(equations(arena, names, "symmetry", map)?);
        Ok(self)
    }
}

/// An arena with these names in it; all others are errors.
fn declared<N: AsRef<str>, P: AsRef<str>>(unknowns: &[N], parameters: &[P]) -> Result<(Arena, Names), ParseError> {
    let mut arena = Arena::default();
    let mut names = Names { closed: true, ..Names::default() };
    let unknowns = unknowns.iter().map(|name| (name.as_ref(), Role::Unknown, "unknowns"));
    let parameters = parameters.iter().map(|name| (name.as_ref(), Role::Parameter, "parameters"));
    for (name, role, list) in unknowns.chain(parameters) {
        let declared = names.declare(&mut arena, name, role);
        declared.map_err(|message| ParseError::at(name, 0, message).within(list))?;
    }
    Ok((arena, names))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_the_equation_and_the_place() {
        let error = System::from_formulas(&["x^2 - 1", "x*y +"]).unwrap_err();
        assert_eq!((error.within.as_deref(), error.line, error.column), (Some("equation 2"), 1, 6));
        let error = System::from_formulas_in(&["x"], &["x", "x - y"]).unwrap_err();
        assert_eq!((error.within.as_deref(), error.column), (Some("equation 2"), 5));
        let error = System::from_formulas(&["x = y = 1"]).unwrap_err();
        assert!(error.message.contains("second `=`") && error.column == 7, "{error}");
        let error = Family::from_formulas(&["x"], &["a", "x"], &["x - a"]).unwrap_err();
        assert!(error.message.contains("twice") && error.within.as_deref() == Some("parameters"), "{error}");
        let error = Family::from_formulas(&["x"], &["i"], &["x"]).unwrap_err();
        assert!(error.message.contains("imaginary"), "{error}");
        let family = Family::from_formulas(&["x"], &["a"], &["x = a"]).unwrap();
        let error = family.with_nonzero(&["a", "b"]).unwrap_err();
        assert_eq!(error.within.as_deref(), Some("nonzero factor 2"));
    }

    #[test]
    fn texts_of_every_format_take_unknowns() {
        for text in ["2 2\nx^2 - y;\nx - 3;\n", "x^2 = y\nx = 3", "x^2 - y; x - 3;"] {
            let system = System::from_text_in(&["y", "x"], text).unwrap();
            assert_eq!((system.variables(), system.len()), (["y".to_owned(), "x".to_owned()].as_slice(), 2), "{text}");
            let error = System::from_text_in(&["y", "z"], text).unwrap_err();
            assert!(error.message.contains("`x` is neither"), "{error}");
        }
        for (text, word) in [("variables: x\nx - 1", "twice"), ("unknowns = ['x']\nequations = ['x - 1']", "again")] {
            let error = System::from_text_in(&["x"], text).unwrap_err();
            assert!(error.message.contains(word), "{error}");
        }
    }

    #[test]
    fn families_from_formulas_are_those_of_the_text() {
        let text = "name = 'lines'\nunknowns = ['x']\nparameters = ['a', 'b']\nequations = ['a*x - b']\nroots = 1\nnonzero = ['a']";
        let read: Family = text.parse().unwrap();
        let made = Family::from_formulas(&["x"], &["a", "b"], &["a*x = b"]).unwrap();
        let made = made.with_name("lines").with_roots(1).with_nonzero(&["a"]).unwrap();
        assert_eq!((read.name, read.roots), (made.name, made.roots));
        assert_eq!(read.system.to_string(), made.system.to_string());
        assert_eq!(read.nonzero.to_string(), made.nonzero.to_string());
    }
}
