//! Where results go: places are checked before the work begins, and a second interrupt leaves what
//! the first one asked for.

use std::path::Path;
use std::time::{Duration, Instant};

use end_to_end::{root, run};

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// A system with 3^12 roots, an hour's work and more.
fn long_system(folder: &Path) -> String {
    let n = 12;
    let equation = |i: usize| {
        format!("x{i}^3 - {}*x{}^2*x{} + 2*x{} + {};\n", i + 2, (i + 1) % n, (i + 2) % n, (i + 3) % n, i + 1)
    };
    let path = folder.join("cubics.phc");
    std::fs::write(&path, format!("{n}\n{}", (0..n).map(equation).collect::<String>())).expect("written");
    text(&path).to_string()
}

/// Every result says the number of its form first, in a list each of them.
#[test]
fn results_say_the_number_of_their_form() {
    let directory = tempfile::tempdir().expect("directory");
    let system = directory.path().join("circle.txt");
    std::fs::write(&system, "x^2 + y^2 - 1\nx - y\n").expect("written");
    let families = root().join("examples/families");
    let (family, one) = (families.join("p3p.toml"), families.join("p3p.target.json"));
    let start = directory.path().join("start.json");
    let made = run("hc", &["monodromy", text(&family), "--output", text(&start)]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let targets = directory.path().join("targets.json");
    let target = std::fs::read_to_string(&one).expect("target");
    std::fs::write(&targets, format!("[{target}, {target}]")).expect("written");
    let (exact, network) =
        (directory.path().join("exact/pseudoranges.csv"), root().join("examples/network/pseudoranges.csv"));
    let made = run(
        "tdoa",
        &["simulate", "--receivers", "5", "--transmitters", "4", "--output", text(exact.parent().expect("a folder"))],
    );
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let track = |target| vec!["track", text(&family), "--start", text(&start), "--target", target];
    for (program, arguments, results) in [
        ("hc", vec!["solve", text(&system)], 1),
        ("hc", vec!["decompose", text(&system)], 1),
        ("hc", vec!["mixed-volume", text(&system)], 1),
        ("hc", track(text(&one)), 1),
        ("hc", track(text(&targets)), 2),
        ("tdoa", vec!["solve", text(&exact), "--dimensions", "2"], 1),
        ("tdoa", vec!["calibrate", text(&network), "--dimensions", "2"], 1),
    ] {
        let output = run(program, &[&arguments[..], &["--json", "-"]].concat());
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let all = found.as_array().cloned().unwrap_or_else(|| vec![found]);
        assert_eq!(all.len(), results, "{program} {arguments:?}");
        assert!(all.iter().all(|found| found["format"] == 1), "{program} {arguments:?}");
    }
}

#[test]
fn unwritable_places_are_said_at_once() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let system = long_system(folder);
    let rows: String = (0..20u64)
        .map(|i| (0..40).map(|j| ((i * 40 + j).pow(3) % 1009).to_string()).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    let table = folder.join("table.csv");
    std::fs::write(&table, rows).expect("written");
    let missing = folder.join("no/such/folder/out");
    let families = root().join("examples/families");
    let family = families.join("five_point.toml");
    let (start, target) = (families.join("five_point.start.json"), families.join("p3p.target.json"));
    let endless = ["--max-starts", "1000000000", "--agreeing", "1000000000"];
    let commands: Vec<(&str, Vec<&str>)> = vec![
        ("hc", vec!["solve", &system, "--json"]),
        ("hc", vec!["mixed-volume", &system, "--json"]),
        ("hc", vec!["certify", &system, "none.json", "--json"]),
        ("hc", vec!["track", text(&family), "--start", text(&start), "--target", text(&target), "--json"]),
        ("hc", vec!["monodromy", text(&family), "--output"]),
        ("tdoa", [&["calibrate", text(&table)], &endless[..], &["--json"]].concat()),
        ("tdoa", [&["calibrate", text(&table)], &endless[..], &["--svg"]].concat()),
        ("tdoa", [&["calibrate", text(&table)], &endless[..], &["--html"]].concat()),
        ("tdoa", [&["calibrate", text(&table)], &endless[..], &["--nodes"]].concat()),
        ("tdoa", vec!["solve", text(&table), "--json"]),
    ];
    let before = std::fs::read_dir(folder).expect("folder").count();
    for (program, arguments) in commands {
        for (place, part) in [(missing.as_path(), "check that the directory exists"), (folder, "is a directory")] {
            let begun = Instant::now();
            let output = run(program, &[&arguments[..], &[text(place)]].concat());
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{program} {arguments:?}: {message}");
            assert!(message.contains(part), "{program} {arguments:?}: {message}");
            // The work itself takes very much longer.
            assert!(begun.elapsed() < Duration::from_secs(30), "{program} {arguments:?}");
        }
    }
    assert_eq!(std::fs::read_dir(folder).expect("folder").count(), before);
}

/// The partial result goes to a pipe that is read only after the second interrupt.
#[cfg(unix)]
#[test]
fn a_second_interrupt_keeps_what_is_being_written() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let pipe = folder.join("result.json");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    let system = long_system(folder);
    let mut child = Command::new(end_to_end::program("hc"))
        .args(["solve", &system, "--start", "total-degree", "--threads", "1", "--json", text(&pipe)])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let id = child.id().to_string();
    let interrupt = || {
        assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill runs").success());
    };
    end_to_end::wait_for_handler(child.id());
    std::thread::sleep(Duration::from_millis(1500));
    interrupt();
    // The summary is printed before the JSON is written, to a pipe without a reader.
    let mut out = BufReader::new(child.stdout.take().expect("output"));
    let mut summary = String::new();
    assert!(!out.fill_buf().expect("output").is_empty(), "no summary");
    std::thread::sleep(Duration::from_millis(500));
    interrupt();
    std::thread::sleep(Duration::from_millis(500));
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).expect("JSON")
    });
    std::io::Read::read_to_string(&mut out, &mut summary).expect("output");
    let status = child.wait().expect("the program ends");
    assert_eq!(status.code(), Some(130));
    // Where nothing was written the reader would wait for ever.
    if !reader.is_finished() {
        std::thread::sleep(Duration::from_secs(2));
    }
    assert!(reader.is_finished(), "the result was not written");
    let found: serde_json::Value = serde_json::from_str(&reader.join().expect("reader")).expect("whole JSON");
    assert_eq!(found["partial"], true);
    assert!(!summary.is_empty());
}
