//! Interrupts leave no half-written file.
#![cfg(unix)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use end_to_end::program;

#[test]
fn an_interrupt_stops_the_search_and_leaves_no_file() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8 path").to_string();
    // Some measurements; the search goes on because more starts must agree than it ever makes.
    let cell = |k: u64| (k * k * k % 1009) as f64 / 60.0;
    let row = |i: u64| (0..40).map(|j| cell(1 + 40 * i + j).to_string()).collect::<Vec<_>>().join(",") + "\n";
    std::fs::write(path("pseudoranges.csv"), (0..20).map(row).collect::<String>()).expect("written");
    let before = names(folder);
    let child = Command::new(program("tdoa"))
        .args(["calibrate", &path("pseudoranges.csv"), "--max-starts", "1000000000", "--agreeing", "1000000000"])
        .args(["--json", &path("out.json"), "--svg", &path("out.svg"), "--html", &path("out.html")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(Duration::from_secs(2));
    let started = Instant::now();
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(killed.success());
    let output = child.wait_with_output().expect("the program ends");
    assert!(started.elapsed() < Duration::from_secs(60));
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("interrupted; nothing was written"), "{message}");
    assert_eq!(names(folder), before);
}

fn names(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
