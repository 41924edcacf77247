//! Parameter families in TOML.

use super::error::ParseError;
use super::formula::{Names, Role, equations};
use crate::arena::Arena;
use crate::system::System;
use serde::Deserialize;
use toml::Spanned;

/// A parameter family: a system whose parameters are given values later, and what is known of its
/// solutions.
///
/// [`Family::from_formulas`] makes one from formulas; `text.parse::<Family>()` reads one in plain text
/// or TOML.
#[derive(Clone, Debug)]
pub struct Family {
    /// Name of the family; empty if it has none.
    pub name: String,
    /// The equations.
    pub system: System,
    /// The number of isolated solutions for generic parameters, where known.
    pub roots: Option<usize>,
    /// Factors that must not vanish at a solution: a system in the family's unknowns and
    /// parameters, one equation a factor, none where the family states none.
    pub nonzero: System,
    /// Symmetries: maps of the unknowns that take solutions to solutions for the same parameters.
    /// Each has one formula an unknown, its image.
    pub symmetry: Vec<System>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FamilyText {
    name: String,
    unknowns: Vec<Spanned<String>>,
    #[serde(default)]
    parameters: Vec<Spanned<String>>,
    equations: Vec<String>,
    roots: Option<usize>,
    #[serde(default)]
    nonzero: Vec<String>,
    #[serde(default)]
    symmetry: Vec<Vec<String>>,
}

/// Reads a parameter family in TOML.
///
/// ```
/// let family = poly::parse::family(r#"
///     name = "circle and line"
///     unknowns = ["x", "y"]
///     parameters = ["r", "a"]
///     equations = ["x^2 + y^2 - r^2", "y - a*x"]
///     roots = 2
///     nonzero = ["r"]
/// "#)?;
/// assert_eq!(family.system.len(), 2);
/// assert_eq!(family.roots, Some(2));
/// # Ok::<(), poly::parse::ParseError>(())
/// ```
///
/// # Errors
/// If the text is not TOML, misses a key or has one too many, declares a name twice, or if a
/// formula does not parse; line and column then count within the formula that the field `within` of
/// the error names.
pub fn family(text: &str) -> Result<Family, ParseError> {
    let fields: FamilyText = toml::from_str(text)
        .map_err(|e| ParseError::at(text, e.span().map_or(0, |span| span.start), e.message().to_owned()))?;
    let system = system(text, &fields, "equation", &fields.equations)?;
    let nonzero = self::system(text, &fields, "nonzero factor", &fields.nonzero)?;
    let map =
        |(k, map): (usize, &Vec<String>)| self::system(text, &fields, &format!("symmetry {}, formula", k + 1), map);
    let symmetry = fields.symmetry.iter().enumerate().map(map).collect::<Result<_, _>>()?;
    Ok(Family { name: fields.name, system, roots: fields.roots, nonzero, symmetry })
}

fn system(text: &str, fields: &FamilyText, part: &str, formulas: &[String]) -> Result<System, ParseError> {
    let mut arena = Arena::default();
    let mut names = Names { closed: true, ..Names::default() };
    for (declarations, role) in [(&fields.unknowns, Role::Unknown), (&fields.parameters, Role::Parameter)] {
        for declaration in declarations {
            let declared = names.declare(&mut arena, declaration.get_ref(), role);
            declared.map_err(|message| ParseError::at(text, offset(text, declaration), message))?;
        }
    }
    equations(arena, names, part, formulas)
}

/// Where a declared name begins: its span has the quotes in it.
fn offset(text: &str, declaration: &Spanned<String>) -> usize {
    let span = declaration.span();
    let quotes = text.get(span.clone()).and_then(|quoted| quoted.find(declaration.get_ref().as_str()));
    span.start + quotes.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const P3P: &str = r#"
        name = "p3p"
        unknowns = ["d1", "d2", "d3"]
        parameters = ["g12", "g13", "g23", "D12", "D13", "D23"]
        equations = ["d1^2 + d2^2 - 2*g12*d1*d2 - D12", "d1**2 + d3^2 - 2*g13*d1*d3 - D13",
                     "d2^2 + d3^2 - 2*g23*(d2*d3) - D23"]
        roots = 8
        nonzero = ["g12 - 1"]
    "#;

    #[test]
    fn reads_the_example_of_the_design() {
        let family = family(P3P).unwrap();
        assert_eq!(family.name, "p3p");
        assert_eq!(family.system.variables(), ["d1", "d2", "d3"]);
        assert_eq!(family.system.parameters().len(), 6);
        assert_eq!(family.system.len(), 3);
        assert_eq!(family.nonzero.len(), 1);
        assert_eq!(family.nonzero.variables(), family.system.variables());
        assert_eq!(family.roots, Some(8));
    }

    #[test]
    fn points_at_an_unknown_name() {
        let text = P3P.replace("(d2*d3)", "(d2*z)");
        let error = family(&text).unwrap_err();
        assert_eq!((error.within.as_deref(), error.line, error.column), (Some("equation 3"), 1, 25));
        let shown = error.to_string();
        let (line, caret) = (shown.lines().nth(1).unwrap(), shown.lines().nth(2).unwrap());
        assert_eq!(line.chars().nth(caret.find('^').unwrap()), Some('z'), "{shown}");
    }

    #[test]
    fn points_at_a_wrong_declaration() {
        let text = |unknowns: &str, parameters: &str| {
            format!(
                "name = \"box\"\nunknowns = [\"xy\", {unknowns}]\nparameters = [{parameters}]\nequations = [\"xy\"]\n"
            )
        };
        for (text, line, column, word) in [
            (text("\"x\", 'x'", ""), 2, 25, "twice"),
            (text("\"x\"", "\"a\", \"x\""), 3, 21, "twice"),
            (text("\"o x\"", ""), 2, 20, "cannot be a name"),
            (text("\"y\",\n  \"i\"", ""), 3, 4, "imaginary"),
            (text("\"\"", ""), 2, 19, "cannot be a name"),
        ] {
            let error = family(&text).unwrap_err();
            assert!(error.message.contains(word), "{error}");
            assert_eq!((error.within.as_deref(), error.line, error.column), (None, line, column), "{error}");
        }
    }

    #[test]
    fn refuses_what_is_wrong() {
        for (from, to, word) in [
            ("roots = 8", "rots = 8", "rots"),
            ("\"d3\"]", "\"d1\"]", "twice"),
            ("\"d3\"]", "\"i\"]", "imaginary"),
            ("- D12", "- D12)", "expected an operator"),
            ("- D12", "- D12/0", "division by zero"),
            ("- D12", "- D12^1.5", "whole number"),
            ("- D12", "- D12^99999999999", "exponent"),
            ("- D12", "- 1e99999", "exponent"),
            ("- D12", "- ", "end of the text"),
            ("- D12", "2", "expected an operator"),
        ] {
            let error = family(&P3P.replacen(from, to, 1)).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
        let deep = P3P.replacen("- D12", &format!("- {}D12", "(".repeat(100_000)), 1);
        assert!(family(&deep).unwrap_err().message.contains("nested"));
    }
}
