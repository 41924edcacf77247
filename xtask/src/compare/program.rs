//! Programs built, started and measured.

use anyhow::{Context, Result, ensure};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// What one run of a program took.
pub(super) struct Run {
    /// From the start of the process to its end.
    pub(super) seconds: f64,
    /// Processor seconds, user and system, where GNU time is installed.
    pub(super) processor: Option<f64>,
    /// Peak memory in megabytes, where GNU time is installed.
    pub(super) megabytes: Option<f64>,
    pub(super) output: String,
    /// Whether the program was stopped at the limit.
    pub(super) stopped: bool,
}

impl Run {
    /// Processor seconds, which other work on the machine changes little; where they are not known or too few for the clock
    /// of GNU time, which counts hundredths, seconds by the wall.
    pub(super) fn work(&self) -> f64 {
        self.processor.filter(|&processor| processor >= 0.1).unwrap_or(self.seconds)
    }

    /// Work and memory as two cells of a table.
    pub(super) fn cells(&self) -> String {
        let memory = self.megabytes.map_or_else(String::new, |m| format!("{m:.0}"));
        let over = if self.stopped { "over " } else { "" };
        format!("{over}{:.3} | {memory}", self.work())
    }
}

/// Whether a program can be started.
pub(super) fn is_installed(program: &str) -> bool {
    Command::new(program).arg("--version").stdin(Stdio::null()).output().is_ok()
}

/// Builds programs of this workspace in the release profile and says where they are.
pub(super) fn build(packages: &[&str]) -> Result<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--quiet", "--release"]).current_dir(&root);
    packages.iter().for_each(|package| {
        command.args(["--package", package]);
    });
    ensure!(command.status()?.success(), "{} do not build", packages.join(" and "));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    Ok(target.join("release"))
}

/// Runs a program with the given standard input, for at most `limit` processor seconds, under GNU time where that is installed.
pub(super) fn run(program: &Path, arguments: &[&str], files: &[&Path], input: &str, limit: u32) -> Result<Run> {
    let folder = tempfile::tempdir()?;
    let measured = folder.path().join("measured");
    let gnu_time = Path::new("/usr/bin/time");
    let mut words: Vec<std::ffi::OsString> = Vec::new();
    if gnu_time.exists() {
        words.extend([gnu_time.into(), "-f".into(), "%U %S %M".into(), "-o".into(), measured.clone().into()]);
    }
    // The system ends a process that has used up its processor time.
    words.extend(["/bin/sh", "-c", "ulimit -t \"$0\"; exec \"$@\"", &limit.to_string()].map(Into::into));
    words.push(program.into());
    words.extend(arguments.iter().map(Into::into));
    words.extend(files.iter().map(Into::into));
    let started = Instant::now();
    let mut child = Command::new(&words[0])
        .args(&words[1..])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("{} cannot be started", program.display()))?;
    if let Some(mut stdin) = child.stdin.take() {
        // A program that does not read its input is no error.
        let _ = stdin.write_all(input.as_bytes());
    }
    let result = child.wait_with_output()?;
    let seconds = started.elapsed().as_secs_f64();
    // GNU time and shells give 128 and the number of the signal: SIGXCPU, SIGKILL.
    let stopped =
        matches!(result.status.code(), Some(137 | 152)) || (!gnu_time.exists() && result.status.code().is_none());
    let errors = String::from_utf8_lossy(&result.stderr);
    ensure!(stopped || result.status.success(), "{}: {errors}", program.display());
    let text = std::fs::read_to_string(&measured).unwrap_or_default();
    let numbers: Vec<f64> = text.lines().next_back().unwrap_or("").split(' ').filter_map(|n| n.parse().ok()).collect();
    let (processor, megabytes) = match numbers[..] {
        [user, system, kilobytes] => (Some(user + system), Some(kilobytes / 1024.0)),
        _ => (None, None),
    };
    let output = String::from_utf8_lossy(&result.stdout).into_owned();
    Ok(Run { seconds, processor, megabytes, output, stopped })
}

/// Runs of two programs, one after the other, pair by pair.
#[derive(Default)]
pub(super) struct Pairs {
    pub(super) ours: Vec<Run>,
    /// Empty where the peer is not installed.
    pub(super) theirs: Vec<Run>,
    /// Runs of the peer that ended with an error and were made again.
    pub(super) crashes: usize,
}

/// A peer may crash so often in one case; its seeds differ from run to run.
const CRASHES: usize = 5;

impl Pairs {
    /// Repeats both; a peer that takes longer than a minute is not repeated, one that crashes is run again.
    pub(super) fn measure(
        repeats: u32,
        mut ours: impl FnMut() -> Result<Run>,
        mut theirs: impl FnMut() -> Result<Option<Run>>,
    ) -> Result<Pairs> {
        let mut pairs = Pairs::default();
        for _ in 0..repeats {
            pairs.ours.push(ours()?);
            if pairs.theirs.last().is_none_or(|run| run.work() < 60.0) {
                let run = loop {
                    match theirs() {
                        Err(error) if pairs.crashes < CRASHES => {
                            eprintln!("run again: {error:#}");
                            pairs.crashes += 1;
                        }
                        other => break other?,
                    }
                };
                pairs.theirs.extend(run);
            }
        }
        Ok(pairs)
    }

    /// Median of what a quantity is in the peer's runs over what it is in ours, pair by pair.
    pub(super) fn ratio(&self, quantity: impl Fn(&Run) -> f64) -> Option<f64> {
        if self.theirs.is_empty() {
            return None;
        }
        let ratios = self.ours.iter().zip(&self.theirs).map(|(a, b)| quantity(b) / quantity(a));
        Some(median(ratios.collect()))
    }
}

/// The run of median work.
pub(super) fn typical(runs: &[Run]) -> Option<&Run> {
    let mut order: Vec<&Run> = runs.iter().collect();
    order.sort_by(|a, b| a.work().total_cmp(&b.work()));
    order.get(order.len() / 2).copied()
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
