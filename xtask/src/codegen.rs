//! `cargo xtask codegen`: families and stored fibres in, Rust source out.
//!
//! A generated module holds the evaluator of a family and the solutions for one generic parameter point. Both come from
//! committed inputs alone (`NAME.toml` and `NAME.start.json`), so that the bytes are the same on any machine.
//!
//! Families with thousands of solutions are interpreted, and their fibres packed in a binary file (`NAME.fibre`), which
//! `--check` unpacks and verifies.

use crate::refill;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use experiments::workspace;
use hc::Family;
use hc::codegen::{self, generate, verify};
use hc::family::{StartFile, unpack_fibre};
use std::path::{Path, PathBuf};

/// A family of this workspace, and where its files are, from the root of the repository.
struct Known {
    name: &'static str,
    family: &'static str,
    start: &'static str,
    output: &'static str,
}

const FAMILIES: &[Known] = &[
    known(
        "6r3s",
        "crates/tdoa/families/6r3s.toml",
        "crates/tdoa/families/6r3s.start.json",
        "crates/tdoa/src/generated/six_three.rs",
    ),
    known(
        "5r4s",
        "crates/tdoa/families/5r4s.toml",
        "crates/tdoa/families/5r4s.start.json",
        "crates/tdoa/src/generated/five_four.rs",
    ),
    known(
        "4r5s",
        "crates/tdoa/families/4r5s.toml",
        "crates/tdoa/families/4r5s.start.json",
        "crates/tdoa/src/generated/four_five.rs",
    ),
    known(
        "5r6s",
        "crates/tdoa/families/5r6s.toml",
        "crates/tdoa/families/5r6s.start.json",
        "crates/tdoa/src/generated/five_six.rs",
    ),
    known(
        "3r3s_ranges",
        "crates/tdoa/families/3r3s_ranges.toml",
        "crates/tdoa/families/3r3s_ranges.start.json",
        "crates/tdoa/src/generated/three_three_ranges.rs",
    ),
    known(
        "4r6s_ranges",
        "crates/tdoa/families/4r6s_ranges.toml",
        "crates/tdoa/families/4r6s_ranges.start.json",
        "crates/tdoa/src/generated/four_six_ranges.rs",
    ),
    known(
        "5r5s_ranges",
        "crates/tdoa/families/5r5s_ranges.toml",
        "crates/tdoa/families/5r5s_ranges.start.json",
        "crates/tdoa/src/generated/five_five_ranges.rs",
    ),
    known(
        "3r4s_constant",
        "crates/tdoa/families/3r4s_constant.toml",
        "crates/tdoa/families/3r4s_constant.start.json",
        "crates/tdoa/src/generated/three_four_constant.rs",
    ),
    known(
        "4r7s_constant",
        "crates/tdoa/families/4r7s_constant.toml",
        "crates/tdoa/families/4r7s_constant.start.json",
        "crates/tdoa/src/generated/four_seven_constant.rs",
    ),
    known(
        "five_point",
        "examples/families/five_point.toml",
        "examples/families/five_point.start.json",
        "crates/hc/examples/five_point/generated.rs",
    ),
    known(
        "signs",
        "crates/hc/tests/all/stated/signs.toml",
        "crates/hc/tests/all/stated/signs.start.json",
        "crates/hc/tests/all/stated/signs.rs",
    ),
    known(
        "minors",
        "crates/hc/tests/all/stated/minors.toml",
        "crates/hc/tests/all/stated/minors.start.json",
        "crates/hc/tests/all/stated/minors.rs",
    ),
];

/// Families whose fibres are packed, and where both are.
const PACKED: &[(&str, &str, &str)] = &[
    ("10r4s", "crates/tdoa/families/10r4s.toml", "crates/tdoa/families/10r4s.fibre"),
    ("8r5s", "crates/tdoa/families/8r5s.toml", "crates/tdoa/families/8r5s.fibre"),
    ("7r5s", "crates/tdoa/families/7r5s.toml", "crates/tdoa/families/7r5s.fibre"),
    ("6r6s", "crates/tdoa/families/6r6s.toml", "crates/tdoa/families/6r6s.fibre"),
];

const fn known(name: &'static str, family: &'static str, start: &'static str, output: &'static str) -> Known {
    Known { name, family, start, output }
}

#[derive(Args)]
pub(crate) struct CodegenArguments {
    /// Change nothing; name the generated files that are stale and verify the stored fibres.
    #[arg(long, conflicts_with = "refill")]
    check: bool,
    /// Compute the stored fibres anew before generating.
    #[arg(long)]
    refill: bool,
    /// With --refill: leave out the trace test, which takes minutes.
    #[arg(long, requires = "refill")]
    no_trace: bool,
    /// Only this family of the workspace, such as 6r3s.
    #[arg(long)]
    only: Option<String>,
    /// Seed of --refill.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// A family of your own (TOML) instead of those of the workspace.
    #[arg(long, requires_all = ["start", "output"], conflicts_with_all = ["only", "refill"])]
    family: Option<PathBuf>,
    /// Its stored fibre (the JSON of `hc monodromy`).
    #[arg(long, requires = "family")]
    start: Option<PathBuf>,
    /// The Rust file to write; a packed fibre if its name ends in `.fibre`.
    #[arg(long, requires = "family")]
    output: Option<PathBuf>,
}

pub(crate) fn run(arguments: &CodegenArguments) -> Result<()> {
    if let (Some(family), Some(start), Some(output)) = (&arguments.family, &arguments.start, &arguments.output) {
        if output.extension().is_some_and(|extension| extension == "fibre") {
            return pack(arguments.check, family, start, output);
        }
        let name = family.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let stale = write_or_check(arguments, &name, family, start, output)?;
        ensure!(!stale, "stale: {}; run the same command without --check", output.display());
        return Ok(());
    }
    let root = workspace::root();
    let chosen: Vec<&Known> =
        FAMILIES.iter().filter(|known| arguments.only.as_deref().is_none_or(|only| only == known.name)).collect();
    let packed: Vec<_> =
        PACKED.iter().filter(|(name, ..)| arguments.only.as_deref().is_none_or(|only| only == *name)).collect();
    let names: Vec<&str> =
        FAMILIES.iter().map(|known| known.name).chain(PACKED.iter().map(|(name, ..)| *name)).collect();
    ensure!(!chosen.is_empty() || !packed.is_empty(), "no family of that name; there are: {}", names.join(", "));
    let mut stale = Vec::new();
    for (_, family, fibre) in packed {
        let [family, fibre] = [family, fibre].map(|path| root.join(path));
        if arguments.refill {
            let file = refill::refill(&read_family(&family)?, arguments.seed, !arguments.no_trace)?;
            write_packed(&read_family(&family)?, &file, &fibre)?;
        } else {
            check_packed(&read_family(&family)?, &fibre)?;
        }
    }
    for known in chosen {
        let [family, start, output] = [known.family, known.start, known.output].map(|path| root.join(path));
        if arguments.refill {
            let file = refill::refill(&read_family(&family)?, arguments.seed, !arguments.no_trace)?;
            workspace::write(&start, &file.to_json())?;
        }
        if write_or_check(arguments, known.family, &family, &start, &output)? {
            stale.push(known.output.to_owned());
        }
    }
    if !stale.is_empty() {
        bail!("stale: {}; run `cargo xtask codegen` and commit what it writes", stale.join(", "));
    }
    Ok(())
}

fn read_family(path: &Path) -> Result<Family> {
    workspace::read(path)?.parse::<Family>().with_context(|| format!("{} is not a family", path.display()))
}

/// Writes the fibre of a start file as a packed one, or with `check` verifies the one on disk.
fn pack(check: bool, family: &Path, start: &Path, output: &Path) -> Result<()> {
    let family = read_family(family)?;
    if check {
        return check_packed(&family, output);
    }
    let start_file = StartFile::from_json(&workspace::read(start)?).with_context(|| start.display().to_string())?;
    write_packed(&family, &start_file, output)
}

fn write_packed(family: &Family, start: &StartFile, output: &Path) -> Result<()> {
    let bytes = codegen::pack(family, start)?;
    std::fs::write(output, &bytes).with_context(|| format!("cannot write {}", output.display()))?;
    eprintln!("wrote {}: {} solutions in {} bytes", output.display(), start.solutions.len(), bytes.len());
    Ok(())
}

/// Unpacks a fibre and puts its solutions to the tests of generated ones.
fn check_packed(family: &Family, path: &Path) -> Result<()> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let fibre = unpack_fibre(family.program(), &bytes).with_context(|| path.display().to_string())?;
    verify(family, &fibre).with_context(|| path.display().to_string())?;
    eprintln!("{} is whole: {} solutions", path.display(), fibre.len());
    Ok(())
}

/// Writes the module of a family, or with `--check` says whether the one on disk is stale.
fn write_or_check(
    arguments: &CodegenArguments,
    source: &str,
    family: &Path,
    start: &Path,
    output: &Path,
) -> Result<bool> {
    let family = read_family(family)?;
    let start_file = StartFile::from_json(&workspace::read(start)?).with_context(|| start.display().to_string())?;
    let module = generate(&family, &start_file, source).with_context(|| start.display().to_string())?;
    place(arguments, &module, output)
}

/// Writes one file, or with `--check` says whether what is there differs.
fn place(arguments: &CodegenArguments, module: &str, output: &Path) -> Result<bool> {
    if arguments.check {
        let stale = std::fs::read_to_string(output).ok().as_deref() != Some(module);
        if !stale {
            eprintln!("{} is up to date", output.display());
        }
        return Ok(stale);
    }
    if let Some(folder) = output.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    }
    workspace::write(output, module)?;
    eprintln!("wrote {}", output.display());
    Ok(false)
}
