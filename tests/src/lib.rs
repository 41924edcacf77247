//! End-to-end tests live in `tests/tests`; this is what they share.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;

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
