//! What `hc monodromy` and `hc track` share: families, compiled, and the sizes of their fibres.

use crate::input;
use cli::Failure;
use hc::family::Compiled;
use hc::fibre::Fibre;
use hc::poly::{Family, parse};
use hc::start_file::StartFile;
use std::path::Path;

/// A family, compiled.
pub(crate) struct Problem {
    pub(crate) family: Family,
    pub(crate) compiled: Compiled,
}

impl Problem {
    pub(crate) fn read(path: &Path) -> Result<Problem, Failure> {
        let family = parse::family(&input::text(path)?).map_err(|e| Failure::in_file(path, e))?;
        let compiled = Compiled::new(&family).map_err(|e| Failure::in_file(path, e))?;
        Ok(Problem { family, compiled })
    }

    /// Reads a stored fibre, or a first pair, of this family.
    pub(crate) fn fibre(&self, path: &Path) -> Result<Fibre, Failure> {
        let file = StartFile::from_json(&input::text(path)?).map_err(|e| Failure::in_file(path, e))?;
        let fibre = file.fibre().map_err(|e| Failure::in_file(path, e))?;
        self.compiled.check(&fibre).map_err(|e| Failure::in_file(path, e))?;
        Ok(fibre)
    }
}
