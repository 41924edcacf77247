//! Interrupts leave no half-written file, and the best network so far where there is one.

use std::process::Command;
use std::time::Duration;

use end_to_end::{interrupted, program};

#[test]
fn an_interrupt_stops_the_search_and_leaves_the_best_network_so_far() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8 path").to_string();
    // Some measurements; the search goes on because more starts must agree than it ever makes.
    let cell = |k: u64| (k * k * k % 1009) as f64 / 60.0;
    let row = |i: u64| (0..40).map(|j| cell(1 + 40 * i + j).to_string()).collect::<Vec<_>>().join(",") + "\n";
    std::fs::write(path("pseudoranges.csv"), (0..20).map(row).collect::<String>()).expect("written");
    let mut command = Command::new(program("tdoa"));
    command
        .args(["calibrate", &path("pseudoranges.csv"), "--max-starts", "1000000000", "--agreeing", "1000000000"])
        .args(["--json", &path("out.json"), "--svg", &path("out.svg"), "--html", &path("out.html")]);
    let output = interrupted(&mut command, Duration::from_secs(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("starts agreed on the best network so far, which is the partial result"), "{message}");
    assert_eq!(names(folder), ["out.json", "pseudoranges.csv"]);
    let left = std::fs::read_to_string(path("out.json")).expect("written");
    let left: serde_json::Value = serde_json::from_str(&left).expect("JSON");
    assert_eq!((&left["unfinished"], left["receivers"].as_array().map(Vec::len)), (&true.into(), Some(20)));
    assert!(left["agreeing"].as_u64() <= left["starts"].as_u64() && left["receivers"][0].is_array());
}

#[test]
fn an_interrupt_stops_the_polyhedral_route() {
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join("pseudoranges.csv");
    // Differences of no network in particular: half a minute of work and more.
    let cell = |k: u64| (k * k * k % 1009) as f64 / 60.0;
    let row = |i: u64| (0..5).map(|j| cell(1 + 5 * i + j).to_string()).collect::<Vec<_>>().join(",") + "\n";
    std::fs::write(&file, (0..4).map(row).collect::<String>()).expect("written");
    let mut command = Command::new(program("tdoa"));
    command.args(["solve", file.to_str().expect("UTF-8 path"), "--start", "polyhedral"]);
    let output = interrupted(&mut command, Duration::from_secs(1));
    assert_eq!(output.status.code(), Some(130), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.is_empty());
}

fn names(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
