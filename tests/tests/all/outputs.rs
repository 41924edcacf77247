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

/// What each command reads, asked for as its result too: under its name, by a detour, through a link.
#[test]
fn nothing_that_is_read_is_overwritten() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let write = |name: &str, content: &str| {
        let path = folder.join(name);
        std::fs::write(&path, content).expect("written");
        text(&path).to_owned()
    };
    let table = std::fs::read_to_string(root().join("examples/network/pseudoranges.csv")).expect("example");
    let positions = std::fs::read_to_string(root().join("examples/network/receivers.csv")).expect("example");
    let (table, positions) = (write("p.csv", &table), write("r.csv", &positions));
    let distances = write("d.csv", "r1,r2,3\n");
    let system = write("s.txt", "x^2 + y^2 = 5\nx*y = 2\n");
    let points = write("points.txt", "1 2\n2 1\n");
    let family = write("f.txt", "parameters: a b\nunknowns: x y\nx^2 + y^2 = a\nx*y = b\n");
    let pair = write("pair.json", "{\"parameters\": [[5, 0], [2, 0]], \"solutions\": [[[1, 0], [2, 0]]]}");
    let target = write("target.json", "{\"parameters\": [5, 2]}");
    let track = ["track", &family, "--start", &pair, "--target", &target, "--json"];
    let monodromy = ["monodromy", &family, "--seed-pair", &pair, "--output"];
    let calibrate = |option, read: &[&'static str]| [&["calibrate", &table], read, &[option]].concat().join(" ");
    let mut commands: Vec<(&str, String, &str)> = vec![
        ("hc", format!("solve {system} --json"), &system),
        ("hc", format!("decompose {system} --json"), &system),
        ("hc", format!("mixed-volume {system} --json"), &system),
        ("hc", format!("certify {system} {points} --json"), &system),
        ("hc", format!("certify {system} {points} --json"), &points),
        ("hc", track.join(" "), &family),
        ("hc", track.join(" "), &pair),
        ("hc", track.join(" "), &target),
        ("hc", monodromy.join(" "), &family),
        ("hc", monodromy.join(" "), &pair),
        ("hc", format!("codegen {family} {pair} --output"), &pair),
        ("tdoa", format!("solve {table} --json"), &table),
        ("tdoa", format!("calibrate {table} --truth {positions} --svg"), &positions),
        ("tdoa", format!("calibrate {table} --anchors {positions} --nodes"), &positions),
        ("tdoa", format!("calibrate {table} --estimate-speed --distances {distances} --json"), &distances),
    ];
    commands.extend(["--json", "--svg", "--html", "--nodes"].map(|option| ("tdoa", calibrate(option, &[]), &*table)));
    let all = || -> Vec<(String, Vec<u8>)> {
        let names = std::fs::read_dir(folder).expect("folder").map(|entry| entry.expect("entry").path());
        let mut all: Vec<_> = names
            .filter(|path| path.is_file())
            .map(|path| (text(&path).to_owned(), std::fs::read(&path).expect("file")))
            .collect();
        all.sort();
        all
    };
    std::fs::create_dir(folder.join("sub")).expect("folder");
    let before = all();
    for (program, command, read) in &commands {
        let name = Path::new(read).file_name().and_then(|name| name.to_str()).expect("name");
        let mut spellings = vec![(*read).to_owned(), text(&folder.join("sub/..").join(name)).to_owned()];
        #[cfg(unix)]
        {
            let link = folder.join("sub").join(name);
            if !link.exists() {
                std::os::unix::fs::symlink(read, &link).expect("link");
            }
            spellings.push(text(&link).to_owned());
        }
        for written in &spellings {
            let arguments: Vec<&str> = command.split(' ').chain([written.as_str()]).collect();
            let output = run(program, &arguments);
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
            assert!(
                message.contains("would overwrite") && message.contains("another name"),
                "{arguments:?}: {message}"
            );
        }
    }
    assert!(all() == before, "a file was changed");
    // Standard input is a file too.
    #[cfg(unix)]
    for arguments in [["solve", "-", "--json", &system], ["decompose", "-", "--json", &system]] {
        let mut command = std::process::Command::new(end_to_end::program("hc"));
        let output = command.args(arguments).stdin(std::fs::File::open(&system).expect("file")).output().expect("runs");
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(all() == before, "a file was changed");
}

#[test]
fn two_results_of_one_file_are_refused() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let table = root().join("examples/network/pseudoranges.csv");
    let (a, b) = (folder.join("a"), folder.join("../").join(folder.file_name().expect("name")).join("a"));
    let (a, b) = (text(&a), text(&b));
    for [one, other] in [[a, a], [a, b], ["-", "-"]] {
        let output = run("tdoa", &["calibrate", text(&table), "--svg", one, "--nodes", other]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("--svg and --nodes; give two names"), "{message}");
    }
    assert_eq!(std::fs::read_dir(folder).expect("folder").count(), 0);
}

#[test]
fn a_simulation_replaces_nothing_unless_told_to() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path().join("made");
    let make = |seed: &'static str, more: &[&'static str]| {
        let output = run("tdoa", &[&["simulate", "--seed", seed, "--output", text(&folder)], more].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let read = || std::fs::read(folder.join("pseudoranges.csv")).expect("table");
    assert_eq!(make("1", &[]).0, Some(0));
    let first = read();
    let (status, message) = make("2", &[]);
    assert_eq!(status, Some(2), "{message}");
    assert!(message.contains("pseudoranges.csv, receivers.csv") && message.contains("--force"), "{message}");
    assert!(read() == first);
    assert_eq!(make("2", &["--force"]).0, Some(0));
    assert!(read() != first);
    // What else lies there is in nobody's way, one of the files is.
    let other = directory.path().join("other");
    std::fs::create_dir(&other).expect("folder");
    std::fs::write(other.join("notes.txt"), "mine").expect("written");
    assert_eq!(run("tdoa", &["simulate", "--output", text(&other)]).status.code(), Some(0));
    let file = other.join("notes.txt");
    let output = run("tdoa", &["simulate", "--output", text(&file)]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && message.contains("give a directory"), "{message}");
    assert_eq!(run("tdoa", &["simulate", "--output", "-"]).status.code(), Some(2));
}

/// `-` is standard input and standard output, as in `hc`.
#[test]
fn measurements_come_and_results_go_through_pipes() {
    let example = |name: &str| std::fs::read_to_string(root().join("examples/network").join(name)).expect("example");
    let (table, positions) = (root().join("examples/network/pseudoranges.csv"), example("receivers.csv"));
    let out = |output: std::process::Output| {
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let run_on = |arguments: &[&str], input: &str| out(end_to_end::run_on("tdoa", arguments, input));
    let expected = out(run("tdoa", &["calibrate", text(&table), "--json", "-"]));
    let found = run_on(&["calibrate", "-", "--json", "-"], &example("pseudoranges.csv"));
    assert!(found == expected);
    for (option, begins) in [("--nodes", "kind,name,x,y,"), ("--svg", "<svg"), ("--html", "<!DOCTYPE html>")] {
        let found = run_on(&["calibrate", "-", option, "-"], &example("pseudoranges.csv"));
        assert!(found.to_lowercase().starts_with(&begins.to_lowercase()), "{option}: {}", &found[..40]);
    }
    let compared = run_on(&["calibrate", text(&table), "--truth", "-"], &positions);
    assert!(compared.contains("against the truth: 8 receivers"), "{compared}");
    let held = run_on(&["calibrate", text(&table), "--anchors", "-"], &positions);
    assert!(held.contains("r1"), "{held}");
    let output = end_to_end::run_on("tdoa", &["calibrate", "-", "--truth", "-"], &positions);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && message.contains("can be read once"), "{message}");
    let output = end_to_end::run_on("tdoa", &["calibrate", "-"], "receiver,s1,s2\nm,1,x\n");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && message.contains("standard input, line 2, column 3"), "{message}");
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
