//! What tests of `mpirun` share.

use end_to_end::program;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::time::{Duration, Instant};

pub(crate) fn written(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("written");
    text(&path)
}

pub(crate) fn text(path: &Path) -> String {
    path.to_str().expect("UTF-8 path").to_owned()
}

/// A program on so many ranks, of which there may be more than processors.
pub(crate) fn on_ranks(name: &str, count: usize, arguments: &[&str]) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["-q", "--oversubscribe", "--allow-run-as-root", "--bind-to", "none"]);
    // What a container may forbid, and what would be said about it.
    command.args(["--mca", "btl_vader_single_copy_mechanism", "none", "--mca", "btl_base_warn_component_unused", "0"]);
    command.args(["-n", &count.to_string()]).arg(program(name)).args(arguments);
    command
}

pub(crate) fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The process of a rank: that with this rank among the children of mpirun.
pub(crate) fn process(mpirun: &Child, rank: usize) -> Option<u32> {
    let children = format!("/proc/{0}/task/{0}/children", mpirun.id());
    let children = std::fs::read_to_string(children).ok()?;
    let own = format!("OMPI_COMM_WORLD_RANK={rank}");
    children.split_whitespace().filter_map(|id| id.parse().ok()).find(|id: &u32| {
        let environment = std::fs::read(format!("/proc/{id}/environ")).unwrap_or_default();
        environment.split(|&byte| byte == 0).any(|variable| variable == own.as_bytes())
    })
}

/// Waits until something is there, two minutes at most.
pub(crate) fn waited<T>(mut there: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = there() {
            return found;
        }
        assert!(begun.elapsed() < Duration::from_secs(120), "nothing came");
        std::thread::sleep(Duration::from_millis(10));
    }
}

pub(crate) fn signal(name: &str, process: u32) {
    let killed = Command::new("kill").args([name, &process.to_string()]).status().expect("kill runs");
    assert!(killed.success());
}

/// Waits for the end of mpirun; whether it was a success. After a rank was killed Open MPI 4.1 waits for
/// itself for ever now and then (in `pmix_rte_finalize`, all ranks are gone), and is killed too.
pub(crate) fn succeeds(mut mpirun: Child) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(20) {
        if let Some(status) = mpirun.try_wait().expect("mpirun can be waited for") {
            return status.success();
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    mpirun.kill().expect("mpirun can be killed");
    mpirun.wait().expect("mpirun ends").success()
}
