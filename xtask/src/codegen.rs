//! `cargo xtask codegen`: families and stored fibres in, Rust source out.

use crate::refill;
use anyhow::{Context, Result};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct CodegenArguments {
    /// Only say which generated files are stale, and verify the stored fibres.
    #[arg(long)]
    check: bool,
    /// Compute the stored fibres anew before generating.
    #[arg(long)]
    refill: bool,
    /// With --refill: leave out the trace test.
    #[arg(long)]
    no_trace: bool,
    /// Only this family of this workspace, such as 6r3s.
    #[arg(long)]
    only: Option<String>,
    /// Seed of --refill.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

pub(crate) fn run(arguments: &CodegenArguments) -> Result<()> {
    let families = root().join("crates/tdoa/families");
    let name = arguments.only.as_deref().unwrap_or("6r3s");
    let text = std::fs::read_to_string(families.join(format!("{name}.toml")))?;
    let family = poly::parse::family(&text).context("family")?;
    if arguments.refill {
        let start = refill::refill(&family, arguments.seed, !arguments.no_trace)?;
        std::fs::write(families.join(format!("{name}.start.json")), start.to_json())?;
    }
    Ok(())
}
