//! Files in and out, common to the commands. Errors are messages for the user.

use hc::poly::{Exact, Polynomial, System, parse::phcpack};
use serde::Serialize;
use std::path::Path;

/// Reads a system in PHCpack's format and multiplies it out.
pub(crate) fn system(file: &Path) -> Result<(System, Vec<Polynomial<Exact>>), String> {
    let at = |error: &dyn std::fmt::Display| format!("{}: {error}", file.display());
    let text = std::fs::read_to_string(file).map_err(|e| at(&e))?;
    let system = phcpack(&text).map_err(|e| at(&e))?;
    let polynomials = system.expand(&Default::default()).map_err(|e| at(&e))?;
    Ok((system, polynomials))
}

/// Writes JSON to a file, or to standard output for `-`.
pub(crate) fn write_json(out: &Path, value: &impl Serialize) -> Result<(), String> {
    let mut text = serde_json::to_string(value).map_err(|e| format!("JSON: {e}"))?;
    text.push('\n');
    if out.as_os_str() == "-" {
        use std::io::Write;
        return std::io::stdout().write_all(text.as_bytes()).map_err(|e| format!("standard output: {e}"));
    }
    std::fs::write(out, text).map_err(|e| format!("{}: {e}", out.display()))
}

/// Runs `work` on the given number of threads, all processors for `None`.
pub(crate) fn on_threads<R: Send>(threads: Option<usize>, work: impl FnOnce() -> R + Send) -> Result<R, String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    Ok(pool.map_err(|e| format!("threads: {e}"))?.install(work))
}
