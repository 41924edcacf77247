//! End-to-end tests live in `tests/tests`; this is what they share.

use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::process::Stdio;
use std::process::{Command, Output};
use std::sync::Mutex;
#[cfg(unix)]
use std::time::{Duration, Instant};

/// Whether this process has seen to it that the programs are built.
static BUILT: Mutex<bool> = Mutex::new(false);

/// The path of one of the workspace's programs, built with the profile of the running test.
///
/// # Panics
/// If the programs cannot be built.
pub fn program(name: &str) -> PathBuf {
    directory().join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// The path of an example of the workspace, built in the same way.
///
/// # Panics
/// If the examples cannot be built.
pub fn example(name: &str) -> PathBuf {
    directory().join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// The directory of the programs. `cargo test --workspace` builds no programs for other packages' tests, so this does; together
/// with everything that it does build, because the same features are then chosen and nothing is compiled twice.
fn directory() -> PathBuf {
    let test = std::env::current_exe().expect("path of the test");
    // target/<profile>/deps/<test>
    let directory = test.parent().and_then(Path::parent).expect("target directory");
    let mut built = BUILT.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if !*built {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--quiet", "--workspace", "--bins", "--examples", "--tests"]);
        cargo.arg("--target-dir").arg(directory.parent().expect("target directory"));
        if directory.file_name().is_some_and(|profile| profile == "release") {
            cargo.arg("--release");
        }
        cargo.current_dir(root());
        assert!(cargo.status().expect("cargo runs").success(), "the programs do not build");
        *built = true;
    }
    directory.to_path_buf()
}

/// Runs a program of the workspace to its end.
///
/// # Panics
/// If it cannot be started.
pub fn run(name: &str, arguments: &[&str]) -> Output {
    Command::new(program(name)).args(arguments).output().expect("the program starts")
}

/// Starts a program, interrupts it once it has caught interrupts for this long, and returns what it leaves.
///
/// # Panics
/// If it does not start, or does not end within a minute of the interrupt.
#[cfg(unix)]
pub fn interrupted(command: &mut Command, after: Duration) -> Output {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let started = Instant::now();
    while catches_interrupts(child.id()) == Some(false) && started.elapsed() < Duration::from_secs(300) {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(after);
    let started = Instant::now();
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(killed.success());
    let output = child.wait_with_output().expect("the program ends");
    assert!(started.elapsed() < Duration::from_secs(60));
    output
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

/// A path in the shared folder of recordings, `SHARED_DIR` or else `../shared` beside the workspace; `None`, with a
/// message, where it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SHARED_DIR").map_or_else(|| root().join("../shared"), PathBuf::from);
    let path = folder.join(path);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there (set SHARED_DIR to the folder of recordings)", path.display());
    None
}
