//! What a comparison measures; its programs, started and measured.

use crate::quantile::median;
use anyhow::{Context, Result, ensure};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::Instant;
use wait4::{ResUse, Wait4};

/// What is measured, and how.
pub(super) struct Plan {
    pub(super) quick: bool,
    pub(super) repeats: u32,
    pub(super) instances: u64,
    pub(super) limit: u32,
    pub(super) systems: PathBuf,
}

/// Where the programs of this workspace are, and which peers there are.
pub(super) struct Tools {
    pub(super) hc: PathBuf,
    pub(super) tdoa: PathBuf,
    pub(super) phc: bool,
    pub(super) macaulay2: bool,
    pub(super) gfan: bool,
}

/// What one run of a program took.
pub(super) struct Run {
    /// Seconds from the start of the process to its end.
    pub(super) seconds: f64,
    /// Processor seconds, user and system, where the system tells them.
    pub(super) processor: Option<f64>,
    /// Peak memory in megabytes, where the system tells it.
    pub(super) megabytes: Option<f64>,
    pub(super) output: String,
    /// Whether the program was stopped at the limit.
    pub(super) stopped: bool,
}

impl Run {
    /// Processor seconds, which other work on the machine changes little; where they are not known,
    /// seconds by the wall.
    pub(super) fn work(&self) -> f64 {
        self.processor.unwrap_or(self.seconds)
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

/// Runs a program with the given standard input, for at most `limit` processor seconds.
pub(super) fn run(program: &Path, arguments: &[&str], files: &[&Path], input: &str, limit: u32) -> Result<Run> {
    run_to(&[0], program, arguments, files, input, limit)
}

/// [`run`], where the program may end with one of these exit statuses.
pub(super) fn run_to(
    statuses: &[i32],
    program: &Path,
    arguments: &[&str],
    files: &[&Path],
    input: &str,
    limit: u32,
) -> Result<Run> {
    let folder = tempfile::tempdir()?;
    let [output, errors] = ["output", "errors"].map(|name| folder.path().join(name));
    // The system ends a process that has used up its processor time.
    let mut command = Command::new("/bin/sh");
    command.args(["-c", "ulimit -t \"$0\"; exec \"$@\"", &limit.to_string()]).arg(program).args(arguments).args(files);
    command.stdin(Stdio::piped()).stdout(File::create(&output)?).stderr(File::create(&errors)?);
    let started = Instant::now();
    let mut child = command.spawn().with_context(|| format!("{} cannot be started", program.display()))?;
    if let Some(mut stdin) = child.stdin.take() {
        // A program that does not read its input is no error.
        let _ = stdin.write_all(input.as_bytes());
    }
    let ResUse { status, rusage } = child.wait4()?;
    let seconds = started.elapsed().as_secs_f64();
    let stopped = was_stopped(status);
    let errors = std::fs::read(&errors)?;
    let ended = status.code().is_some_and(|code| statuses.contains(&code));
    ensure!(stopped || ended, "{}: {}", program.display(), String::from_utf8_lossy(&errors));
    let processor = Some((rusage.utime + rusage.stime).as_secs_f64()).filter(|&seconds| seconds > 0.0);
    let megabytes = Some(rusage.maxrss as f64 / (1 << 20) as f64).filter(|&megabytes| megabytes > 0.0);
    let output = String::from_utf8_lossy(&std::fs::read(&output)?).into_owned();
    Ok(Run { seconds, processor, megabytes, output, stopped })
}

/// Whether the limit of processor time has ended the process: SIGXCPU, then SIGKILL.
#[cfg(unix)]
fn was_stopped(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    matches!(status.signal(), Some(9 | 24)) || matches!(status.code(), Some(137 | 152))
}

#[cfg(not(unix))]
fn was_stopped(_: ExitStatus) -> bool {
    false
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
    /// Repeats both; a peer that takes longer than a minute is not repeated, one that crashes is
    /// run again.
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
        Some(median(&ratios.collect::<Vec<f64>>()))
    }
}

/// The run of median work.
pub(super) fn typical(runs: &[Run]) -> Option<&Run> {
    let mut order: Vec<&Run> = runs.iter().collect();
    order.sort_by(|a, b| a.work().total_cmp(&b.work()));
    order.get(order.len() / 2).copied()
}
