//! What `hc monodromy` and `hc track` share: families, compiled, and the sizes of their fibres.

use crate::input;
use cli::Failure;
use hc::fibre::Fibre;
use hc::poly::{CompileError, Evaluate, Family, Interpreter, Isa, parse};
use hc::start_file::StartFile;
use num_complex::Complex64;
use std::path::Path;

/// A family, compiled.
pub(crate) struct Problem {
    pub(crate) family: Family,
    pub(crate) system: Interpreter,
    nonzero: Interpreter,
}

impl Problem {
    pub(crate) fn read(path: &Path) -> Result<Problem, Failure> {
        let family = parse::family(&input::text(path)?).map_err(|e| Failure::in_file(path, e))?;
        let compile = |system: &hc::poly::System| -> Result<Interpreter, CompileError> { system.compile() };
        let system = compile(&family.system).map_err(|e| Failure::in_file(path, e))?;
        let nonzero = compile(&family.nonzero).map_err(|e| Failure::in_file(path, e))?;
        if system.equations() != system.variables() || system.variables() == 0 {
            return Err(Failure::in_file(
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

    /// Reads a stored fibre, or a first pair, of this family.
    pub(crate) fn fibre(&self, path: &Path) -> Result<Fibre, Failure> {
        let file = StartFile::from_json(&input::text(path)?).map_err(|e| Failure::in_file(path, e))?;
        let fibre = file.fibre().map_err(|e| Failure::in_file(path, e))?;
        let (parameters, unknowns) = (self.system.parameters(), self.system.variables());
        if fibre.parameters.len() != parameters || fibre.dimension != unknowns {
            return Err(Failure::in_file(
                path,
                format!(
                    "{} parameters and solutions of {} coordinates, but the family has {parameters} parameters and {unknowns} unknowns",
                    fibre.parameters.len(),
                    fibre.dimension
                ),
            ));
        }
        Ok(fibre)
    }
}
