//! What `hc monodromy` and `hc track` share: reading families, refusing degenerate solutions, failing with a status.

use hc::poly::{CompileError, Evaluate, Family, Interpreter, Isa, parse};
use num_complex::Complex64;
use std::path::Path;

/// Why the program ends without success.
pub(crate) enum Failure {
    /// Exit status 1: no solution, or an incomplete result.
    Incomplete(String),
    /// Exit status 2: unusable input or arguments.
    Unusable(String),
}

impl Failure {
    pub(crate) fn unusable(path: &Path, error: impl std::fmt::Display) -> Failure {
        Failure::Unusable(format!("{}: {error}", path.display()))
    }
}

/// Largest input file that is read.
const MAX_BYTES: u64 = 64 << 20;

/// Reads a text file of reasonable size.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    use std::io::Read;
    let file = std::fs::File::open(path).map_err(|e| Failure::unusable(path, e))?;
    let mut text = String::new();
    file.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(|e| Failure::unusable(path, e))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(Failure::unusable(path, "larger than 64 MB; is it the right file?"));
    }
    Ok(text)
}

/// A family, compiled.
pub(crate) struct Problem {
    pub(crate) family: Family,
    pub(crate) system: Interpreter,
    nonzero: Interpreter,
}

impl Problem {
    pub(crate) fn read(path: &Path) -> Result<Problem, Failure> {
        let family = parse::family(&read_text(path)?).map_err(|e| Failure::unusable(path, e))?;
        let compile = |system: &hc::poly::System| -> Result<Interpreter, CompileError> { system.compile() };
        let system = compile(&family.system).map_err(|e| Failure::unusable(path, e))?;
        let nonzero = compile(&family.nonzero).map_err(|e| Failure::unusable(path, e))?;
        if system.equations() != system.variables() || system.variables() == 0 {
            return Err(Failure::unusable(
                path,
                format!(
                    "{} equations in {} unknowns; as many equations as unknowns are needed, and at least one",
                    system.equations(),
                    system.variables()
                ),
            ));
        }
        Ok(Problem { family, system, nonzero })
    }

    /// Whether none of the factors that the family declares nonzero vanishes at a solution.
    pub(crate) fn accepts(&self, p: &[Complex64], x: &[Complex64]) -> bool {
        let mut memory = self.nonzero.memory(Isa::Portable);
        let mut values = vec![Complex64::new(0.0, 0.0); self.nonzero.equations()];
        self.nonzero.values(&mut memory, x, p, &mut values);
        values.iter().all(|z| z.norm() > 1e-9)
    }
}

/// Writes text to a file by way of a temporary one beside it, or to standard output for `-`.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    use std::io::Write;
    if path.as_os_str() == "-" {
        let mut out = std::io::stdout().lock();
        // A reader that has gone away is no error.
        let _ = out.write_all(text.as_bytes());
        return Ok(());
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(|e| Failure::unusable(path, e))?;
    file.write_all(text.as_bytes()).map_err(|e| Failure::unusable(path, e))?;
    file.persist(path).map_err(|e| Failure::unusable(path, e.error))?;
    Ok(())
}
