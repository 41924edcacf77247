//! End-to-end tests live in `tests/tests`; this is what they share.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;

/// Programs that this process has built.
static BUILT: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// The path of one of the workspace's programs, built with the profile of the running test. `cargo test --workspace`
/// builds no programs for other packages' tests, so this does.
///
/// # Panics
/// If the program cannot be built.
pub fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("path of the test");
    // target/<profile>/deps/<test>
    let directory = test.parent().and_then(Path::parent).expect("target directory");
    let mut built = BUILT.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if !built.iter().any(|other| other == name) {
        let mut cargo = Command::new(env!("CARGO"));
        let package = if name == "xtask" { name.to_string() } else { format!("{name}-cli") };
        cargo.args(["build", "--quiet", "--package", &package, "--bin", name]);
        cargo.arg("--target-dir").arg(directory.parent().expect("target directory"));
        if directory.file_name().is_some_and(|profile| profile == "release") {
            cargo.arg("--release");
        }
        cargo.current_dir(root());
        assert!(cargo.status().expect("cargo runs").success(), "{name} does not build");
        built.push(name.to_string());
    }
    directory.join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// Runs a program of the workspace to its end.
///
/// # Panics
/// If it cannot be started.
pub fn run(name: &str, arguments: &[&str]) -> Output {
    Command::new(program(name)).args(arguments).output().expect("the program starts")
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
