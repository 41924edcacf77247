//! `hc solve`, `track` and so on with `--checkpoint`: runs that are killed and go on.

use end_to_end::{program, root, run};
use hc::random::Random;
use serde_json::{Value, json};
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

/// Standard output without the lines that say how long it took.
fn untimed(output: &Output) -> String {
    assert!(output.status.success(), "{}", said(output));
    let text = String::from_utf8(output.stdout.clone()).expect("text");
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("\"seconds\":")).collect();
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

/// Waits until a run has so many records, or has ended.
fn wait_for(child: &mut Child, directory: &str, records: u64) {
    let begun = Instant::now();
    while child.try_wait().expect("a child").is_none() && begun.elapsed() < Duration::from_secs(120) {
        if status(directory).is_some_and(|status| status["records"].as_u64() >= Some(records)) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Kills what these arguments do once it has so many records, then so many, then soon after it has
/// begun; it goes on to the same standard output, on other numbers of threads. Returns the status of
/// the end.
fn killed(folder: &Path, arguments: &[&str], moments: [u64; 2]) -> Value {
    let directory = text(&folder.join("run"));
    let resume = ["--checkpoint", &directory, "--resume"];
    let expected = untimed(&run("hc", &[arguments, &["--threads", "2"]].concat()));
    for (threads, records) in [("2", moments[0]), ("1", moments[1]), ("2", 0)] {
        let mut child = spawned(&[arguments, &["--threads", threads], &resume].concat());
        wait_for(&mut child, &directory, records);
        if records > 0 {
            let status = status(&directory).expect("a status");
            assert_eq!((&status["what"], &status["running"]), (&arguments[0].into(), &true.into()), "{status}");
        }
        child.kill().expect("killed");
        child.wait().expect("a child");
        assert_eq!(status(&directory).expect("a status")["running"], false);
    }
    let before = status(&directory).expect("a status")["records"].as_u64();
    assert!(before >= Some(moments[1]), "{before:?}");
    let resumed = run("hc", &[arguments, &["--threads", "1"], &resume].concat());
    assert_eq!(untimed(&resumed), expected);
    assert!(said(&resumed).contains(&format!("{directory}: goes on after ")), "{}", said(&resumed));
    status(&directory).expect("a status")
}

#[test]
fn a_solve_that_is_killed_at_any_moment_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("directory");
    // Four batches of 2,048 paths.
    let system = quadrics(folder.path(), 13);
    let arguments = ["solve", &system, "--start", "total-degree", "--seed", "1", "--json", "-"];
    let after = killed(folder.path(), &arguments, [2, 3]);
    // The last round is of paths that have jumped, if there are any.
    assert_eq!((&after["solutions"], &after["done"]), (&8192.into(), &after["total"]));
}

/// The family of five points in two cameras, its fibre of 20 solutions, and a file of targets.
fn five_points(folder: &Path, targets: usize) -> [String; 3] {
    let family = text(&root().join("examples/families/five_point.toml"));
    let path = folder.join(format!("targets{targets}.json"));
    let target = |k| Random::new(1, 1000 + k).normals(20).iter().map(|z| z.re).collect::<Vec<f64>>();
    let list: Vec<Value> = (0..targets as u64).map(|k| json!({ "parameters": target(k) })).collect();
    std::fs::write(&path, serde_json::to_string(&list).expect("JSON")).expect("written");
    [family.clone(), family.replace(".toml", ".start.json"), text(&path)]
}

#[test]
fn targets_that_are_killed_at_any_moment_go_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("directory");
    // Four blocks of 256.
    let [family, start, targets] = five_points(folder.path(), 1000);
    let arguments = ["track", &family, "--start", &start, "--target", &targets, "--json", "-"];
    let after = killed(folder.path(), &arguments, [2, 3]);
    assert_eq!((&after["done"], &after["total"], &after["solutions"]), (&1000.into(), &1000.into(), &20000.into()));
    // What is recorded can be certified.
    let directory = text(&folder.path().join("run"));
    let certified = run("hc", &[&arguments[..], &["--certify", "--checkpoint", &directory, "--resume"]].concat());
    let reports: Value = serde_json::from_slice(&certified.stdout).expect("JSON");
    let solutions = reports.as_array().expect("a list").iter().flat_map(|report| report["solutions"].as_array());
    assert!(solutions.flatten().all(|solution| solution["certified"].is_boolean()));
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

/// Loops, and the trace test after them.
#[test]
fn monodromy_that_is_killed_at_any_moment_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("directory");
    // As many solutions as a solve has paths; their number is not stated.
    let [family, directory] = ["family.toml", "run"].map(|name| folder.path().join(name));
    let equations: Vec<String> = std::fs::read_to_string(quadrics(folder.path(), 7))
        .expect("a system")
        .lines()
        .enumerate()
        .map(|(i, equation)| format!("\"{equation} + a{i} + b{i}*x{i}*x{}\"", (i + 3) % 7))
        .collect();
    let names = |of: &str| (0..7).map(|i| format!("\"{of}{i}\"")).collect::<Vec<_>>().join(", ");
    let content = format!(
        "name = \"\"\nunknowns = [{}]\nparameters = [{}, {}]\nequations = [{}]\n",
        names("x"),
        names("a"),
        names("b"),
        equations.join(", ")
    );
    std::fs::write(&family, content).expect("written");
    let family = text(&family);
    let after = killed(folder.path(), &["monodromy", &family, "--seed", "1", "--output", "-"], [20, 60]);
    // The search and three parts of the trace test, the last of three pieces.
    assert_eq!((&after["part"], &after["done"]), (&5.into(), &3.into()));
    let directory = text(&directory);
    let resume = |more: &[&str]| {
        let arguments = ["monodromy", &family, "--output", "-", "--checkpoint", &directory, "--resume"];
        run("hc", &[&arguments[..], more].concat())
    };
    // Without the trace test the loops are the same.
    let untested = resume(&["--seed", "1", "--no-trace"]);
    let untested: Value = serde_json::from_slice(&untested.stdout).expect("JSON");
    assert_eq!((untested["solutions"].as_array().map(Vec::len), &untested["trace_test"]), (Some(128), &Value::Null));
    let other = resume(&["--seed", "2"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(said(&other).contains("is of seed 1, this run has seed 2"), "{}", said(&other));
    let status = run("hc", &["monodromy", "--status", &directory]);
    assert!(status.status.success(), "{}", said(&status));
}

#[test]
fn targets_of_another_run_are_refused_with_the_difference() {
    let folder = tempfile::tempdir().expect("directory");
    let [family, start, targets] = five_points(folder.path(), 3);
    let directory = text(&folder.path().join("run"));
    let track = |family: &str, start: &str, targets: &str, more: &[&str]| {
        let arguments = ["track", family, "--start", start, "--target", targets, "--checkpoint", &directory];
        run("hc", &[&arguments[..], more].concat())
    };
    let made = track(&family, &start, &targets, &[]);
    assert!(made.status.success(), "{}", said(&made));
    // Another formula, one solution less, another number.
    let changed = |file: &str, name: &str, change: &dyn Fn(&str) -> String| {
        let path = folder.path().join(name);
        std::fs::write(&path, change(&std::fs::read_to_string(file).expect("text"))).expect("written");
        text(&path)
    };
    let in_json = |json: &str, change: &dyn Fn(&mut Value)| {
        let mut value: Value = serde_json::from_str(json).expect("JSON");
        change(&mut value);
        value.to_string()
    };
    let other_family = changed(&family, "family.toml", &|text| text.replacen("\"a11*(", "\"2*a11*(", 1));
    let one_less = |value: &mut Value| drop(value["solutions"].as_array_mut().expect("a list").pop());
    let other_start = changed(&start, "start.json", &|text| in_json(text, &one_less));
    let other_number = |value: &mut Value| value[1]["parameters"][2] = 0.25.into();
    let other_targets = changed(&targets, "targets.json", &|text| in_json(text, &other_number));
    let resume: &[&str] = &["--resume"];
    for (output, words) in [
        (track(&other_family, &start, &targets, resume), "the checkpoint is of system hash "),
        (track(&family, &other_start, &targets, resume), "is of start count 20, this run has start count 19"),
        (track(&family, &start, &other_targets, resume), "the checkpoint is of targets hash "),
        (
            track(&family, &start, &five_points(folder.path(), 4)[2], resume),
            "is of targets count 3, this run has targets count 4",
        ),
        (track(&family, &start, &targets, &["--seed", "2", "--resume"]), "is of seed 0, this run has seed 2"),
        (track(&family, &start, &targets, &[]), "already; resume that, or give another directory (--resume)"),
    ] {
        assert_eq!(output.status.code(), Some(2), "{words}: {}", said(&output));
        assert!(said(&output).contains(words), "{words}: {}", said(&output));
    }
    let solve = run("hc", &["solve", &quadrics(folder.path(), 3), "--checkpoint", &directory, "--resume"]);
    assert!(said(&solve).contains("the checkpoint is of what track, this run has what solve"), "{}", said(&solve));
    let resumed = track(&family, &start, &targets, resume);
    assert!(resumed.status.success(), "{}", said(&resumed));
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
