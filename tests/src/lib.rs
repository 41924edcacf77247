//! End-to-end tests live in `tests/tests`; this is what they share.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
#[cfg(unix)]
use std::time::{Duration, Instant};

/// A folder for the files of a test, removed after it.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// A new one with nothing in it.
    ///
    /// # Panics
    /// If there can be none.
    pub fn empty() -> Folder {
        Folder(tempfile::tempdir().expect("directory"))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file of this name; its path.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        std::fs::write(&path, content).expect("written");
        path
    }
}

/// The path of one of the workspace's programs (`hc`, `tdoa`, `xtask`) or of an example of the
/// guide, built with the profile of the running test.
///
/// # Panics
/// If this is not a test that cargo has started, or there is no such program.
pub fn program(name: &str) -> PathBuf {
    let variable = format!("CARGO_BIN_EXE_end-to-end-{name}");
    std::env::var_os(&variable).unwrap_or_else(|| panic!("{variable} is not set: cargo test sets it")).into()
}

/// Runs a program of the workspace to its end.
///
/// # Panics
/// If it cannot be started.
pub fn run(name: &str, arguments: &[&str]) -> Output {
    Command::new(program(name)).args(arguments).output().expect("the program starts")
}

/// A recording that `tdoa simulate` makes with these options, in a new directory, and the file of its
/// measurements.
///
/// # Panics
/// If the program refuses.
pub fn simulated(options: &str) -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("directory");
    let mut arguments = vec!["simulate", "--output", directory.path().to_str().expect("UTF-8 path")];
    arguments.extend(options.split_whitespace());
    let output = run("tdoa", &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let file = directory.path().join("pseudoranges.csv");
    (directory, file)
}

/// Runs a program of the workspace to its end, with this text as its standard input.
///
/// # Panics
/// If it cannot be started.
pub fn run_on(name: &str, arguments: &[&str], text: &str) -> Output {
    let mut command = Command::new(program(name));
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    // A program that does not read its input to the end is no failure of the test.
    let _ = child.stdin.take().expect("a pipe").write_all(text.as_bytes());
    child.wait_with_output().expect("the program ends")
}

/// Starts a program, interrupts it once it has caught interrupts for this long, and returns what it
/// leaves.
///
/// # Panics
/// If it does not start, or does not end within a minute of the interrupt.
#[cfg(unix)]
pub fn interrupted(command: &mut Command, after: Duration) -> Output {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait_for_handler(child.id());
    std::thread::sleep(after);
    let started = Instant::now();
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(killed.success());
    let output = child.wait_with_output().expect("the program ends");
    assert!(started.elapsed() < Duration::from_secs(60));
    output
}

/// Waits until a process catches interrupts, five minutes at most.
#[cfg(unix)]
pub fn wait_for_handler(process: u32) {
    let started = Instant::now();
    while catches_interrupts(process) == Some(false) && started.elapsed() < Duration::from_secs(300) {
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Whether a process has a handler for SIGINT, signal 2; `None` where the system does not tell.
#[cfg(unix)]
fn catches_interrupts(process: u32) -> Option<bool> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
    Some(u64::from_str_radix(caught.trim(), 16).ok()? & 2 != 0)
}

/// The workspace's root.
///
/// # Panics
/// Never: this package lies in it.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("workspace root")
}

/// A path among the recordings: `data` in the folder that `SHARED_DIR` names, by default `shared`
/// beside the workspace. Where they are absent, the tests that ask for them are ignored (cfg
/// `recordings`, see build.rs).
///
/// # Panics
/// If the recordings are absent.
pub fn recording(path: &str) -> PathBuf {
    let Some(folder) = option_env!("RECORDINGS") else {
        panic!("the recordings are absent: SHARED_DIR names the folder that has them in data/")
    };
    Path::new(folder).join(path)
}
