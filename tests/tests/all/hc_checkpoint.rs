//! `hc solve --checkpoint`: runs that are killed and go on.

use end_to_end::{program, run};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A system of `2^n` regular solutions, in a file.
fn quadrics(folder: &Path, n: usize) -> String {
    let next = |i: usize, k: usize| (i + k) % n;
    let equation =
        |i: usize| format!("x{i}^2 - {}*x{}*x{} + 3*x{} + {}\n", i + 2, next(i, 1), next(i, 2), next(i, 3), i + 1);
    let path = folder.join(format!("quadrics{n}.txt"));
    std::fs::write(&path, (0..n).map(equation).collect::<String>()).expect("written");
    text(&path)
}

fn text(path: &Path) -> String {
    path.to_str().expect("UTF-8 path").to_owned()
}

/// The arguments of a solve with JSON to standard output.
fn solve<'a>(system: &'a str, threads: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let first = ["solve", system, "--start", "total-degree", "--seed", "1", "--json", "-", "--threads", threads];
    first.iter().chain(more).copied().collect()
}

/// Standard output without the line that says how long it took.
fn untimed(output: &Output) -> String {
    assert!(output.status.success(), "{}", said(output));
    let text = String::from_utf8(output.stdout.clone()).expect("text");
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("\"seconds\":")).collect();
    assert_eq!(lines.len() + 1, text.lines().count());
    lines.join("\n")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn status(directory: &str) -> Option<Value> {
    let output = run("hc", &["solve", "--status", directory]);
    output.status.success().then(|| serde_json::from_slice(&output.stdout).expect("JSON"))
}

fn spawned(arguments: &[&str]) -> Child {
    let mut command = Command::new(program("hc"));
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

/// Waits until a run has recorded so many paths, or has ended.
fn wait_for(child: &mut Child, directory: &str, paths: u64) {
    let begun = Instant::now();
    while child.try_wait().expect("a child").is_none() && begun.elapsed() < Duration::from_secs(120) {
        if status(directory).is_some_and(|status| status["done"].as_u64() >= Some(paths)) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn killed_at_any_moment_it_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("directory");
    let directory = text(&folder.path().join("run"));
    // Four batches of 2,048 paths.
    let system = quadrics(folder.path(), 13);
    let expected = untimed(&run("hc", &solve(&system, "2", &[])));
    // Twice killed once it has recorded more, and once soon after it has begun.
    for (threads, paths) in [("2", 2048), ("1", 4096), ("2", 0)] {
        let mut child = spawned(&solve(&system, threads, &["--checkpoint", &directory, "--resume"]));
        wait_for(&mut child, &directory, paths);
        if paths > 0 {
            let status = status(&directory).expect("a status");
            assert_eq!((&status["what"], &status["total"]), (&"solve".into(), &8192.into()));
            assert!(status["solutions"].as_u64() <= status["done"].as_u64(), "{status}");
        }
        child.kill().expect("killed");
        child.wait().expect("a child");
        assert_eq!(status(&directory).expect("a status")["running"], false);
    }
    let before = status(&directory).expect("a status")["done"].as_u64();
    assert!(before >= Some(2048), "{before:?}");
    let resumed = run("hc", &solve(&system, "1", &["--checkpoint", &directory, "--resume"]));
    assert_eq!(untimed(&resumed), expected);
    assert!(said(&resumed).contains(&format!("{directory}: goes on after ")), "{}", said(&resumed));
    let after = status(&directory).expect("a status");
    assert_eq!((&after["done"], &after["solutions"]), (&8192.into(), &8192.into()));
}

#[test]
fn an_interrupted_run_says_how_it_goes_on() {
    let folder = tempfile::tempdir().expect("directory");
    let directory = text(&folder.path().join("run"));
    let system = quadrics(folder.path(), 18);
    let mut command = Command::new(program("hc"));
    let checkpoint = ["--checkpoint", &directory];
    let output = end_to_end::interrupted(command.args(solve(&system, "1", &checkpoint)), Duration::from_millis(500));
    assert_eq!(output.status.code(), Some(130));
    assert!(said(&output).ends_with("the same command with --resume goes on\n"), "{}", said(&output));
}

/// A checkpoint of a small system, and its log.
fn small(folder: &Path) -> (String, String, PathBuf) {
    let (system, directory) = (quadrics(folder, 5), folder.join("run"));
    let made = run("hc", &solve(&system, "1", &["--checkpoint", &text(&directory)]));
    assert!(made.status.success(), "{}", said(&made));
    (system, text(&directory), directory.join("records.log"))
}

#[test]
fn torn_and_damaged_records_are_said_and_computed_again() {
    let folder = tempfile::tempdir().expect("directory");
    let (system, directory, log) = small(folder.path());
    let expected = untimed(&run("hc", &solve(&system, "1", &[])));
    let whole = std::fs::read(&log).expect("a log");
    let flipped = |at: usize| whole.iter().enumerate().map(|(k, &byte)| byte ^ u8::from(k == at)).collect::<Vec<u8>>();
    let cases = [
        (whole[..whole.len() - 3].to_vec(), "the log ends within a record"),
        (flipped(whole.len() - 100), "is damaged; it and those after it"),
        (flipped(20), "is damaged; it and those after it"),
    ];
    for (bytes, words) in cases {
        std::fs::write(&log, bytes).expect("written");
        let resumed = run("hc", &solve(&system, "2", &["--checkpoint", &directory, "--resume"]));
        assert_eq!(untimed(&resumed), expected);
        assert!(said(&resumed).contains(words), "{}", said(&resumed));
        // Whole again; only when records were brought to it may differ.
        assert_eq!(std::fs::metadata(&log).expect("a log").len(), whole.len() as u64);
    }
}

#[test]
fn what_is_no_checkpoint_of_this_run_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("directory");
    let (system, directory, log) = small(folder.path());
    let refused = |arguments: &[&str], words: &str| {
        let output = run("hc", arguments);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", said(&output));
        assert!(said(&output).contains(words), "{words}: {}", said(&output));
    };
    let resume = ["--checkpoint", &directory[..], "--resume"];
    refused(
        &["solve", &system, "--seed", "2", "--start", "total-degree", "--checkpoint", &directory, "--resume"],
        "is of seed 1, this run has seed 2",
    );
    refused(
        &["solve", &system, "--seed", "1", "--checkpoint", &directory, "--resume"],
        "is of start total-degree, this run has start auto",
    );
    refused(
        &solve(&quadrics(folder.path(), 4), "1", &resume),
        "is of system equations 5, this run has system equations 4",
    );
    refused(
        &solve(&system, "1", &["--checkpoint", &directory]),
        "already; resume that, or give another directory (--resume)",
    );
    refused(&["solve", &system, "--resume"], "--checkpoint <DIR>");
    refused(&["solve", &system, "--status", &directory], "cannot be used with");
    refused(&["solve"], "<FILE>");
    refused(&["solve", "--status", &text(folder.path())], "cannot be read");
    // In use.
    let held = std::fs::File::open(Path::new(&directory).join("lock")).expect("a lock");
    held.lock().expect("locked");
    refused(&solve(&system, "1", &resume), "another run records its work there");
    drop(held);
    // Of somebody else, or of a later program.
    let header = Path::new(&directory).join("checkpoint.json");
    let own = std::fs::read_to_string(&header).expect("a header");
    for (text, words) in [
        (own.replace("\"format\": 1", "\"format\": 2"), "the checkpoint is of format 2, this run has format 1"),
        (own.replace("\"version\": \"", "\"version\": \"9."), "the checkpoint is of version 9."),
        (own.replace("  ", ""), "its header is another one"),
        ("{}".to_owned(), "is not of a checkpoint"),
        ("no JSON".to_owned(), "is not of a checkpoint"),
    ] {
        std::fs::write(&header, text).expect("written");
        refused(&solve(&system, "1", &resume), words);
    }
    std::fs::write(&header, own).expect("written");
    std::fs::write(&log, "somebody's notes").expect("written");
    refused(&solve(&system, "1", &resume), "is not of a checkpoint");
    std::fs::remove_file(&header).expect("removed");
    refused(&solve(&system, "1", &resume), "is not of a checkpoint");
    assert_eq!(std::fs::read(&log).expect("kept"), b"somebody's notes");
}

/// Files that may not grow beyond some blocks are a full disk.
#[test]
fn a_full_disk_is_said_and_the_run_goes_on_or_ends() {
    let folder = tempfile::tempdir().expect("directory");
    let system = quadrics(folder.path(), 9);
    let expected = untimed(&run("hc", &solve(&system, "1", &[])));
    let limited = |directory: &str, more: &[&str]| {
        let directory = text(&folder.path().join(directory));
        let checkpoint = [&["--checkpoint", &directory], more].concat();
        let mut command = Command::new("sh");
        command.args(["-c", "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\""]).arg(program("hc"));
        (command.args(solve(&system, "1", &checkpoint)).output().expect("sh runs"), directory)
    };
    let (output, directory) = limited("first", &[]);
    assert!(said(&output).contains("cannot be written ("), "{}", said(&output));
    assert_eq!(untimed(&output), expected);
    // What was recorded before is still good.
    let resumed = run("hc", &solve(&system, "2", &["--checkpoint", &directory, "--resume"]));
    assert_eq!(untimed(&resumed), expected);
    let (output, _) = limited("second", &["--checkpoint-required"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("records.log: cannot be read or written ("), "{}", said(&output));
}
