//! A family as Rust source: its equations as straight-line code, and its stored solutions.
//!
//! The program `hc codegen` and build scripts use this module; it needs the feature `codegen`. The
//! generated module depends only on this crate.

use crate::distinct::{coincidences, relative_distance};
use crate::family::{Family, FamilyError, Fibre, PackedFibreError, StartFile, pack_fibre};
use crate::refine::Refiner;
use crate::tolerances::{families, same};
use num_complex::Complex64;
use poly::program::{EmitError, EmitOptions, emit};
use poly::{Evaluate, counted};
use std::fmt::Write;
use thiserror::Error;

/// Why no source is written.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CodegenError {
    /// The start file cannot be used, or belongs to another family.
    #[error(transparent)]
    Family(#[from] FamilyError),
    /// The solutions cannot be packed.
    #[error(transparent)]
    Packed(#[from] PackedFibreError),
    /// The program cannot be written as Rust.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// The number of solutions differs from the number that the family states.
    #[error("{}, but the family states {stated}; compute the start file anew or correct `roots`", counted(*.found, "solution"))]
    Count {
        /// Number of stored solutions.
        found: usize,
        /// Number of solutions that the family states.
        stated: usize,
    },
    /// A stored solution does not solve the equations.
    #[error("solution {index} is off by {distance:.1e}; is it of another family? Compute the start file anew")]
    Inaccurate {
        /// The solution, from 1.
        index: usize,
        /// Its relative distance from the solution to which Newton's method converges.
        distance: f64,
    },
    /// A stored solution is singular.
    #[error("solution {index} is singular (condition {condition:.1e}); compute the start file anew")]
    Singular {
        /// The solution, from 1.
        index: usize,
        /// Condition number of its Jacobian.
        condition: f64,
    },
    /// A factor that must not vanish vanishes at a stored solution.
    #[error("solution {index} is degenerate: a factor of `nonzero` vanishes; compute the start file anew")]
    Degenerate {
        /// The solution, from 1.
        index: usize,
    },
    /// Stored solutions that are the same.
    #[error("solutions {solutions:?} coincide; compute the start file anew")]
    Coincident {
        /// The solutions, from 1.
        solutions: Vec<usize>,
    },
}

/// Writes a family and its solutions for a generic parameter point as a Rust module.
///
/// The module has a unit struct `System` that implements [`Evaluate`], and a
/// function `fibre()` that returns the stored solutions as a [`Fibre`]. The function `stated()` has what the family states
/// besides its equations, factors that do not vanish and symmetries, as a [`Stated`](crate::family::Stated). The header
/// names the `source`. Only the arguments determine the bytes.
///
/// If the family has more equations than unknowns, `System` are random combinations of them, as many as unknowns, and
/// `stated()` has all equations: trackers that are told count ends that do not solve all of them as failed.
///
/// The stored solutions are checked first: they must solve the equations, be regular, distinct and
/// not degenerate, and be as many as the family states.
///
/// ```
/// use hc::{Family, codegen, family::StartFile};
/// let family = Family::from_formulas(&["x"], &["a"], &["x^2 = a"])?;
/// let start = r#"{ "parameters": [[4, 0]], "solutions": [[[2, 0]], [[-2, 0]]], "stopped": "roots reached" }"#;
/// let module = codegen::generate(&family, &StartFile::from_json(start)?, "roots.toml")?;
/// assert!(module.contains("// Source: roots.toml") && module.contains("pub fn fibre()"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the stored solutions fail a check.
pub fn generate(family: &Family, start: &StartFile, source: &str) -> Result<String, CodegenError> {
    let fibre = family.stored(start)?;
    verify(family, &fibre)?;
    let mut options = EmitOptions::default();
    options.crate_path = "hc::poly".to_owned();
    options.source = one_line(source);
    let mut text = emit(family.program().program(), &options)?;
    // Writing to a string cannot fail.
    let _ = append_fibre(&mut text, start, &fibre);
    let factors = Some(family.factors()).filter(|factors| factors.equations() > 0);
    let mut stated = String::new();
    for (name, doc, program) in [
        (
            "equations",
            "All equations. [`System`] are combinations of them, as many as unknowns, which have further solutions.",
            family.all_equations(),
        ),
        ("nonzero", "Factors that do not vanish at a solution, one an equation.", factors),
        ("symmetry", "Images of a solution that are solutions, the coordinates of all as equations.", family.maps()),
    ] {
        let Some(program) = program else { continue };
        let module = emit(program.program(), &options)?;
        let _ = write!(text, "/// {doc}\n#[allow(dead_code)]\npub mod {name} {{\n{module}}}\n");
        let _ = write!(stated, ".{name}(&{name}::System)");
    }
    let _ = append_stated(&mut text, &stated);
    Ok(text)
}

/// The solutions in few bytes ([`pack_fibre`]), for families of which thousands are stored and that are
/// interpreted. They are checked as those of [`generate`].
///
/// # Errors
/// If the stored solutions fail a check.
pub fn pack(family: &Family, start: &StartFile) -> Result<Vec<u8>, CodegenError> {
    let fibre = family.stored(start)?;
    verify(family, &fibre)?;
    Ok(pack_fibre(family.program(), &fibre)?)
}

/// Checks that stored solutions solve the equations, are distinct, regular and not degenerate, and are
/// as many as the family states.
///
/// # Errors
/// If they fail a check.
pub fn verify(family: &Family, fibre: &Fibre) -> Result<(), CodegenError> {
    family.check(fibre)?;
    family.check_solutions(fibre)?;
    if let Some(stated) = family.roots().filter(|&stated| stated != fibre.len()) {
        return Err(CodegenError::Count { found: fibre.len(), stated });
    }
    let mut refiner = Refiner::new(family.program());
    for k in 0..fibre.len() {
        let (index, x) = (k + 1, fibre.solution(k));
        let refined = refiner.refine(&fibre.parameters, x);
        let distance = relative_distance(x, &refined.point);
        // What is not a number is no solution either.
        if !distance.lt(&families::STORED_MOVED) {
            return Err(CodegenError::Inaccurate { index, distance });
        }
        if !refined.condition.lt(&families::STORED_CONDITION) {
            return Err(CodegenError::Singular { index, condition: refined.condition });
        }
        if !family.accepts(&fibre.parameters, x) {
            return Err(CodegenError::Degenerate { index });
        }
    }
    let same = coincidences((0..fibre.len()).map(|k| (k, fibre.solution(k))), same::REGULAR);
    match same.first() {
        Some(group) => Err(CodegenError::Coincident { solutions: group.iter().map(|k| k + 1).collect() }),
        None => Ok(()),
    }
}

/// The stored solutions as tables, and the function that makes a fibre of them.
fn append_fibre(text: &mut String, start: &StartFile, fibre: &Fibre) -> std::fmt::Result {
    let unknowns = fibre.dimension;
    let trace = start.trace_test.map_or("not run".to_owned(), |t| format!("deviation {t:.1e}"));
    writeln!(text, "/// A generic parameter point, `[re, im]` each.")?;
    writeln!(text, "static PARAMETERS: [[f64; 2]; {}] = [", fibre.parameters.len())?;
    append_rows(text, &fibre.parameters)?;
    writeln!(text, "];")?;
    writeln!(text, "/// All solutions there, {unknowns} coordinates each, one after the other.")?;
    let stopped = if start.stopped.is_empty() { "not said".to_owned() } else { one_line(&start.stopped) };
    writeln!(text, "///\n/// Search ended: {stopped}; trace test: {trace}.")?;
    writeln!(text, "static SOLUTIONS: [[f64; 2]; {}] = [", fibre.solutions.len())?;
    append_rows(text, &fibre.solutions)?;
    writeln!(text, "];")?;
    writeln!(text, "/// All solutions for a generic parameter point.")?;
    writeln!(text, "pub fn fibre() -> hc::Fibre {{")?;
    writeln!(text, "    hc::Fibre::from_pairs(&PARAMETERS, {unknowns}, &SOLUTIONS)")?;
    writeln!(text, "}}")
}

/// The function that has what the family states besides its equations, by these calls.
fn append_stated(text: &mut String, calls: &str) -> std::fmt::Result {
    writeln!(text, "/// What the family states of its solutions besides its equations.")?;
    writeln!(text, "#[allow(dead_code)]")?;
    writeln!(text, "pub fn stated() -> hc::family::Stated<'static> {{")?;
    writeln!(text, "    hc::family::Stated::default(){calls}")?;
    writeln!(text, "}}")
}

fn append_rows(text: &mut String, numbers: &[Complex64]) -> std::fmt::Result {
    for z in numbers {
        writeln!(text, "    [{:?}, {:?}],", z.re, z.im)?;
    }
    Ok(())
}

/// Text that cannot break out of a comment of one line.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

#[cfg(test)]
mod tests {
    use super::{CodegenError, generate};
    use crate::family::{Family, FamilyError, Fibre, StartFile};

    fn family() -> Family {
        let family = poly::Family::from_formulas(&["x"], &["a", "b"], &["x^2 - (a + b)*x + a*b"]).unwrap();
        Family::new(family.with_roots(2).with_nonzero(&["x - 5"]).unwrap()).unwrap()
    }

    fn start(parameters: [f64; 2], solutions: &[f64]) -> StartFile {
        StartFile {
            parameters: parameters.map(|p| [p, 0.0]).to_vec(),
            solutions: solutions.iter().map(|&x| vec![[x, 0.0]]).collect(),
            stopped: "by hand\n}".to_owned(),
            ..StartFile::new(&Fibre::default(), None, "")
        }
    }

    #[test]
    fn a_module_has_the_solutions_and_no_stray_text() {
        let text = generate(&family(), &start([1.0, 2.0], &[1.0, 2.0]), "two\nroots").unwrap();
        assert!(
            text.contains("// Source: two roots\n") && text.contains("Search ended: by hand }; trace test: not run.")
        );
        assert!(text.contains("static SOLUTIONS: [[f64; 2]; 2] = [\n    [1.0, 0.0],\n    [2.0, 0.0],\n];"));
    }

    /// The only solution of both equations is `x = a`; a combination of them has one more.
    #[test]
    fn more_equations_than_unknowns_are_a_module_of_their_own() {
        let family = Family::from_formulas(&["x"], &["a", "b"], &["x^2 - a^2", "(x - a)*(x + b)"]).unwrap();
        let text = generate(&family, &start([1.0, 2.0], &[1.0]), "two equations").unwrap();
        for part in ["pub mod equations {", "2 equations, 1 unknowns", ".equations(&equations::System)"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(matches!(generate(&family, &start([1.0, 2.0], &[3.0]), ""), Err(CodegenError::Inaccurate { .. })));
    }

    #[test]
    fn solutions_that_do_not_pass_are_named() {
        let error = |parameters, solutions: &[f64]| generate(&family(), &start(parameters, solutions), "").unwrap_err();
        assert_eq!(error([1.0, 2.0], &[1.0]), CodegenError::Count { found: 1, stated: 2 });
        assert!(matches!(error([1.0, 2.0], &[1.0, 2.01]), CodegenError::Inaccurate { index: 2, .. }));
        assert_eq!(error([1.0, 2.0], &[1.0, 1.0]), CodegenError::Coincident { solutions: vec![1, 2] });
        assert_eq!(error([1.0, 5.0], &[1.0, 5.0]), CodegenError::Degenerate { index: 2 });
        assert!(matches!(error([1.0, 1.0], &[1.0, 1.0]), CodegenError::Singular { index: 1, .. }));
        assert!(matches!(error([f64::NAN, 1.0], &[1.0, 1.0]), CodegenError::Family(FamilyError::Start(_))));
        let mut ragged = start([1.0, 2.0], &[1.0, 2.0]);
        ragged.parameters.pop();
        assert!(matches!(generate(&family(), &ragged, "").unwrap_err(), CodegenError::Family(_)));
    }
}
