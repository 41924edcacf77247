//! `cargo xtask compare`: this project beside the peers that are installed, in one run.

use anyhow::{Context, Result, ensure};
use clap::Args;
use hc::poly::{self, Exact, ExpandLimits, System};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

#[derive(Args)]
pub(crate) struct CompareArguments {
    /// Instances of 6r/3s.
    #[arg(long, default_value_t = 3)]
    instances: u64,
    /// Markdown file for the table; standard output if not given.
    #[arg(long)]
    output: Option<PathBuf>,
}

/// What one run of a program took.
struct Run {
    seconds: f64,
    /// Peak memory in megabytes, where GNU time is installed.
    megabytes: Option<f64>,
    output: String,
}

pub(crate) fn run(arguments: &CompareArguments) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let tdoa = build_tdoa()?;
    let phc = Command::new("phc").arg("--version").output().is_ok();
    let mut text = String::from(
        "# 6r/3s: `tdoa solve` beside PHCpack's blackbox solver\n\n\
         Written by `cargo xtask compare`: the same random instance (positions and offsets standard normal, no noise) for both, one after \
         the other, one thread each, whole processes from start to end. PHCpack gets the eight polynomials of the family, expanded.\n\n\
         | instance | tdoa solve, s (solver alone) | MB | roots | phc -b, s | MB | regular roots | ratio of seconds |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for seed in 0..arguments.instances {
        let directory = folder.path().join(format!("instance{seed}"));
        let simulate = Command::new(&tdoa)
            .args([
                "simulate",
                "--receivers",
                "6",
                "--transmitters",
                "3",
                "--layout",
                "normal",
                "--noise",
                "0",
                "--seed",
            ])
            .arg(seed.to_string())
            .arg("--output")
            .arg(&directory)
            .output()?;
        ensure!(simulate.status.success(), "{}", String::from_utf8_lossy(&simulate.stderr));
        let matrix = directory.join("pseudoranges.csv");
        let ours = timed(Path::new(&tdoa), &["solve", "--threads", "1", "--json", "-"], &[&matrix])?;
        let json: serde_json::Value = serde_json::from_str(&ours.output).context("JSON of tdoa solve")?;
        let solver = json["seconds"].as_f64().unwrap_or(f64::NAN);
        let finite = &json["paths"]["finite"];
        write!(text, "| {seed} | {:.3} ({solver:.4}) | {} | {finite} |", ours.seconds, memory(&ours))?;
        if phc {
            let (input, output) = (directory.join("system"), directory.join("result"));
            std::fs::write(&input, phc_system(&matrix)?)?;
            let theirs = timed(Path::new("phc"), &["-b"], &[&input, &output])?;
            let result = std::fs::read_to_string(&output).unwrap_or_default();
            let regular = regular_solutions(&result);
            writeln!(
                text,
                " {:.1} | {} | {} | {:.0} |",
                theirs.seconds,
                memory(&theirs),
                regular.map_or("none written".to_owned(), |n| n.to_string()),
                theirs.seconds / ours.seconds
            )?;
        } else {
            writeln!(text, " not installed | | | |")?;
        }
    }
    if !phc {
        text += "\nPHCpack (`phc`) is not installed here; Debian has it as `phcpack`.\n";
    }
    match &arguments.output {
        Some(path) => std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display())),
        None => {
            print!("{text}");
            Ok(())
        }
    }
}

fn memory(run: &Run) -> String {
    run.megabytes.map_or_else(String::new, |m| format!("{m:.0}"))
}

/// Builds the program and says where it is.
fn build_tdoa() -> Result<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["build", "--quiet", "--release", "--package", "tdoa-cli"])
        .current_dir(&root)
        .status()?;
    ensure!(status.success(), "tdoa does not build");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    Ok(target.join("release").join(format!("tdoa{}", std::env::consts::EXE_SUFFIX)))
}

/// Runs a program, with GNU time around it for the memory where that is installed.
fn timed(program: &Path, arguments: &[&str], files: &[&Path]) -> Result<Run> {
    let gnu_time = Path::new("/usr/bin/time");
    let mut command = if gnu_time.exists() {
        let mut command = Command::new(gnu_time);
        command.args(["-f", "peak-kilobytes %M"]).arg(program);
        command
    } else {
        Command::new(program)
    };
    let started = Instant::now();
    let result = command
        .args(arguments)
        .args(files)
        .output()
        .with_context(|| format!("{} cannot be started", program.display()))?;
    let seconds = started.elapsed().as_secs_f64();
    let errors = String::from_utf8_lossy(&result.stderr).into_owned();
    ensure!(result.status.success(), "{}: {errors}", program.display());
    let kilobytes = errors.lines().find_map(|line| line.strip_prefix("peak-kilobytes ")?.trim().parse::<f64>().ok());
    Ok(Run {
        seconds,
        megabytes: kilobytes.map(|k| k / 1024.0),
        output: String::from_utf8_lossy(&result.stdout).into_owned(),
    })
}

/// The family's polynomials with the measurements put in for the parameters, in PHCpack's format.
fn phc_system(matrix: &Path) -> Result<String> {
    let family = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/tdoa/families/6r3s.toml");
    let family = poly::parse::family(&std::fs::read_to_string(family)?)?;
    let rows: Vec<Vec<f64>> = std::fs::read_to_string(matrix)?
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').skip(1).map(|v| v.trim().parse().ok()).collect())
        .collect();
    ensure!(rows.len() == 6 && rows.iter().all(|r| r.len() == 3), "a 6 x 3 matrix was expected");
    let system = System::build(|s| {
        let unknowns: Vec<_> = family.system.variables().iter().map(|name| s.variable(name)).collect();
        let parameters: Vec<_> = (1..6)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| s.constant(rows[i][j] - rows[0][j]))
            .collect();
        family.system.instantiate(s, &unknowns, &parameters)
    })?;
    let mut text = format!("{}\n", system.len());
    for polynomial in system.expand(&ExpandLimits::default())? {
        for (k, (monomial, coefficient)) in polynomial.terms().iter().enumerate() {
            let factors: String = (system.variables().iter().enumerate())
                .map(|(j, name)| (monomial.exponents()[j], name))
                .filter(|(e, _)| *e > 0)
                .map(|(e, name)| format!("*{name}^{e}"))
                .collect();
            write!(text, "{}{:+.17e}{factors}", if k > 0 { " " } else { "" }, real(coefficient))?;
        }
        text += ";\n";
    }
    Ok(text)
}

fn real(coefficient: &Exact) -> f64 {
    use num_traits::ToPrimitive;
    coefficient.re.to_f64().unwrap_or(f64::NAN)
}

/// Number of regular solutions from the last summary that `phc -b` writes.
fn regular_solutions(result: &str) -> Option<usize> {
    let line = result.lines().rev().find(|line| line.trim_start().starts_with("Number of regular solutions"))?;
    line.rsplit(':').next()?.trim().trim_end_matches('.').parse().ok()
}
