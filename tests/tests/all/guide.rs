//! The commands of the documentation, as a reader would run them: those of a page one after the
//! other, in one folder.

use std::path::Path;
use std::process::{Command, Output};

use end_to_end::{program, root};

/// Commands that the tests do not run: steps that need the network, write into the repository,
/// contain these tests, or take long.
const NOT_RUN: &[&str] = &[
    "cargo test --workspace",
    "cargo fmt --all --check",
    "cargo clippy --workspace --all-targets -- -D warnings",
    "RUSTDOCFLAGS=\"-D warnings\" cargo doc -p poly --no-deps",
    "RUSTDOCFLAGS=\"-D warnings\" cargo doc --workspace --no-deps",
    "cargo deny check",
    // Takes minutes, and builds what the tests have built.
    "cargo build --profile dist -p tdoa-cli -p hc-cli",
    // Minutes, of a system that the reader has.
    "hc solve cyclic11.txt --checkpoint run --resume --json solutions.json",
    // Need Open MPI.
    "cargo build --release -p hc-cli -p tdoa-cli --features mpi",
    "cargo test -p end-to-end --features mpi --test all mpi",
    // Written into the repository; `--check` is run instead.
    "cargo xtask codegen",
    "cargo xtask experiments --page",
    // Builds a crate outside the workspace, for minutes.
    "cargo run --release --manifest-path examples/cameras/Cargo.toml -- 50",
    // Each experiment runs in small in tdoa_experiments.rs.
    "cargo xtask experiments --quick",
    "cargo bench -p benches --bench evaluate",
    "cargo bench -p hc --bench tracker",
    "cargo bench -p hc --bench lu",
    "cargo bench -p hc --bench mixed_volume",
    "cargo bench -p tdoa --bench calibrate",
    "cargo bench -p sound --bench listen",
    "cargo xtask compare",
    // In examples/network/README.md, of files that the reader has.
    "tdoa calibrate pseudoranges.csv --anchors anchors.csv",
    "tdoa calibrate seconds.csv --units s --estimate-speed --anchors anchors.csv",
];

/// The lines of a page that are commands.
fn commands(page: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(page)).expect("page");
    let first = ["cargo ", "tdoa ", "hc ", "RUSTDOCFLAGS="];
    let lines = text.lines().filter_map(|line| line.strip_prefix("    "));
    lines.filter(|line| first.iter().any(|word| line.starts_with(word))).map(str::to_owned).collect()
}

/// Runs one in this folder; files under examples/ are those of the repository.
fn run(command: &str, folder: &Path) -> Output {
    let place = |word: &str| match word {
        // Placeholders of the README.
        "FAMILY.toml" => root().join("examples/families/five_point.toml").to_string_lossy().into_owned(),
        "START.json" => root().join("examples/families/five_point.start.json").to_string_lossy().into_owned(),
        "five_point.rs" | "five_point.fibre" | "solver.rs" => folder.join(word).to_string_lossy().into_owned(),
        // Where a command makes an example, a copy is made.
        "examples/network" => folder.join("network").to_string_lossy().into_owned(),
        "examples/room" => folder.join("room").to_string_lossy().into_owned(),
        word if word.starts_with("examples/") => root().join(word).to_string_lossy().into_owned(),
        // A file that an earlier command of the page made; xtask runs in the repository.
        word if word.ends_with(".start.json") => folder.join(word).to_string_lossy().into_owned(),
        other => other.to_owned(),
    };
    let programs = [
        ("cargo run --release -p hc-cli -- ", "hc"),
        ("cargo run --release -p tdoa-cli -- ", "tdoa"),
        ("tdoa ", "tdoa"),
        ("hc ", "hc"),
        ("cargo xtask ", "xtask"),
    ];
    if let Some((rest, name)) = programs.iter().find_map(|(prefix, name)| Some((command.strip_prefix(prefix)?, name))) {
        let words = rest.split(' ').map(place);
        return Command::new(program(name)).args(words).current_dir(folder).output().expect("the program starts");
    }
    let examples = ["cargo run --release -p hc --example ", "cargo run --release -p tdoa --example "];
    let name = examples.iter().find_map(|prefix| command.strip_prefix(prefix)).expect("a known kind of command");
    Command::new(program(name)).current_dir(root()).output().expect("the example starts")
}

/// Runs all commands of a page, and gives what each printed.
fn run_page(page: &str, folder: &Path) -> Vec<(String, String)> {
    let mut printed = Vec::new();
    for command in commands(page).into_iter().filter(|command| !NOT_RUN.contains(&command.as_str())) {
        let output = run(&command, folder);
        assert!(output.status.success(), "{page}: {command}: {}", String::from_utf8_lossy(&output.stderr));
        printed.push((command, String::from_utf8_lossy(&output.stdout).into_owned()));
    }
    assert!(!printed.is_empty(), "{page} has no commands");
    printed
}

#[test]
fn no_page_is_left_out() {
    // The page of Python is tested by crates/python/tests/test_guide.py.
    let tested = [
        "calibrate-a-network.md",
        "cluster.md",
        "polynomial-system.md",
        "minimal-problem.md",
        "tracker.md",
        "checks.md",
        "python.md",
        "recordings.md",
        "sweeps.md",
    ];
    let mut pages: Vec<String> = std::fs::read_dir(root().join("docs/guide"))
        .expect("folder")
        .map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned())
        .collect();
    pages.sort();
    let mut tested = tested.map(str::to_owned).to_vec();
    tested.sort();
    assert_eq!(pages, tested);
}

#[test]
fn calibrating_a_network() {
    let folder = tempfile::tempdir().expect("folder");
    let printed = run_page("docs/guide/calibrate-a-network.md", folder.path());
    assert_eq!(printed.len(), 27);
    for name in ["report.html", "network.json", "nodes.csv", "network.svg"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
    // Noise of 0.01 m and a robust estimate; three times the Cramer-Rao bound is the experiments'
    // measure of success.
    let text = std::fs::read_to_string(folder.path().join("network.json")).expect("JSON");
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(found["unique"], true);
    assert!((0.005..0.02).contains(&found["sigma"].as_f64().expect("sigma")), "{}", found["sigma"]);
    assert!(printed[3].1.contains("against the truth"));
    // What the page says that clocks cost is printed.
    let page = std::fs::read_to_string(root().join("docs/guide/calibrate-a-network.md")).expect("page");
    let costs = &printed.iter().find(|(command, _)| command.ends_with("--example clocks")).expect("the command").1;
    let costs: Vec<Vec<&str>> = costs.lines().map(|line| line.rsplitn(8, ' ').collect()).collect();
    let said = page.lines().filter(|line| line.starts_with("| ") && line.contains("` | ")).filter(|line| {
        let words = line.rsplitn(4, '|').collect::<Vec<_>>();
        costs.iter().any(|cost| cost[6] == words[2].trim() && cost[2] == words[1].trim())
    });
    assert_eq!(said.count(), 9);
}

#[test]
fn solving_a_polynomial_system() {
    let folder = tempfile::tempdir().expect("folder");
    let page = "docs/guide/polynomial-system.md";
    let text = std::fs::read_to_string(root().join(page)).expect("page");
    let system = text.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("the system");
    std::fs::write(folder.path().join("system.txt"), system).expect("written");
    run_page(page, folder.path());
    let text = std::fs::read_to_string(folder.path().join("solutions.json")).expect("JSON");
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    // x^2 = y^2 = 4/5.
    let solutions = found["solutions"].as_array().expect("solutions");
    assert_eq!(solutions.len(), 4);
    for solution in solutions {
        for z in solution["value"].as_array().expect("value") {
            let (re, im) = (z[0].as_f64().expect("number"), z[1].as_f64().expect("number"));
            assert!((re.abs() - 0.8f64.sqrt()).abs() < 1e-12 && im.abs() < 1e-12);
        }
    }
}

#[test]
fn sweeping_a_family() {
    let folder = tempfile::tempdir().expect("folder");
    let page = "docs/guide/sweeps.md";
    let printed = run_page(page, folder.path());
    for name in ["branches.svg", "branches.csv", "map.svg", "cells.csv", "sweep.json"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
    // What the page says is printed: four states, which the formula of the family has, and rest.
    let text = std::fs::read_to_string(root().join(page)).expect("page");
    let said: Vec<&str> = printed[1].1.lines().take(5).collect();
    assert!(said.len() == 5 && said.iter().all(|line| text.contains(line)), "{said:?}");
    let states = |k: u32| {
        let w = 0.9 + 0.2 * f64::from(k) / 299.0;
        let (d, rest) = (1.0 - w * w, (0.05f64.powi(2) - (0.01 * w).powi(2)).sqrt());
        1 + 2 * [-d - rest, -d + rest].iter().filter(|r| **r > 0.0).count()
    };
    for (line, count) in said[1..4].iter().zip([1, 3, 5]) {
        let cells = (0..300).filter(|&k| states(k) == count).count();
        assert!(line.starts_with(&format!("  {cells} cells with {count} real")), "{line}");
    }
}

/// The job script of the page runs as Slurm would run it, with a launcher that starts one rank.
#[test]
#[cfg(unix)]
fn a_job_on_a_cluster() {
    use std::os::unix::fs::{PermissionsExt, symlink};

    let folder = tempfile::tempdir().expect("folder");
    let text = std::fs::read_to_string(root().join("docs/guide/cluster.md")).expect("page");
    let script = text.split("```bash\n").nth(1).and_then(|rest| rest.split("```").next()).expect("the script");
    let programs = folder.path().join("bin");
    std::fs::create_dir(&programs).expect("folder");
    for name in ["hc", "tdoa"] {
        symlink(program(name), programs.join(name)).expect("link");
    }
    // The words from the program on.
    let launcher = "#!/bin/sh\nwhile [ $# -gt 0 ] && [ \"$1\" != hc ]; do shift; done\nexec \"$@\"\n";
    std::fs::write(programs.join("mpirun"), launcher).expect("written");
    std::fs::set_permissions(programs.join("mpirun"), PermissionsExt::from_mode(0o755)).expect("executable");
    std::fs::write(folder.path().join("job.sh"), script).expect("written");
    std::fs::write(folder.path().join("system.txt"), "x^2 + y^2 - 5\nx*y - 2\n").expect("written");
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    // Started again it goes on, with nothing left to do.
    for _ in 0..2 {
        let mut job = Command::new("bash");
        job.arg("job.sh").current_dir(&folder).env("PATH", &path).env("SLURM_CPUS_PER_TASK", "2");
        let output = job.output().expect("bash runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(folder.path().join("solutions.json")).expect("JSON");
        let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(found["solutions"].as_array().map(Vec::len), Some(4));
    }
}

#[test]
fn minimal_problems() {
    let folder = tempfile::tempdir().expect("folder");
    // Five points b in front of a camera that has turned by R (Cayley's x, y, z) and moved by t =
    // (1, u, v): a = R b + t.
    let planted = [0.1, -0.2, 0.15, 0.3, -0.2];
    let [x, y, z, u, v] = planted;
    let d = 1.0 + x * x + y * y + z * z;
    let rotation = [
        [1.0 + x * x - y * y - z * z, 2.0 * (x * y - z), 2.0 * (x * z + y)],
        [2.0 * (x * y + z), 1.0 - x * x + y * y - z * z, 2.0 * (y * z - x)],
        [2.0 * (x * z - y), 2.0 * (y * z + x), 1.0 - x * x - y * y + z * z],
    ];
    let points = [[0.1, 0.2, 3.0], [-0.3, 0.4, 4.0], [0.5, -0.2, 5.0], [-0.4, -0.5, 3.5], [0.2, 0.6, 6.0]];
    let seen = |p: &[f64; 3]| {
        let turned = rotation.map(|row| (row[0] * p[0] + row[1] * p[1] + row[2] * p[2]) / d);
        let a = [turned[0] + 1.0, turned[1] + u, turned[2] + v];
        [a[0] / a[2], a[1] / a[2], p[0] / p[2], p[1] / p[2]]
    };
    let parameters: Vec<f64> = points.iter().flat_map(seen).collect();
    let target = serde_json::json!({ "parameters": parameters }).to_string();
    std::fs::write(folder.path().join("TARGET.json"), target).expect("written");
    let page = "docs/guide/minimal-problem.md";
    let printed = run_page(page, folder.path());
    assert_eq!(printed.len(), 5, "{printed:?}");
    assert!(folder.path().join("five_point.rs").exists() && folder.path().join("five_point.fibre").exists());
    assert!(printed[4].1.contains("planted poses found: 1000 of 1000"), "{}", printed[4].1);
    // A module is up to date, or stale and named.
    let check = format!("{} --check", printed[2].0);
    assert!(run(&check, folder.path()).status.success());
    std::fs::write(folder.path().join("five_point.rs"), "// older").expect("written");
    let output = run(&check, folder.path());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("stale") && message.contains("five_point.rs"), "{message}");
    // The target again, for its solutions.
    let output = run(&format!("{} --json -", printed[1].0), folder.path());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let found = |s: &serde_json::Value| {
        let near = |(z, known): (&serde_json::Value, &f64)| {
            (z[0].as_f64().unwrap() - known).hypot(z[1].as_f64().unwrap()) < 1e-8
        };
        s["value"].as_array().unwrap().iter().zip(&planted).all(near)
    };
    assert!(report["solutions"].as_array().unwrap().iter().any(found), "{report}");
}

#[test]
fn the_tracker_and_the_checks() {
    let folder = tempfile::tempdir().expect("folder");
    let printed = run_page("docs/guide/tracker.md", folder.path());
    // Twenty networks each, all found and no path lost: configuration, instances, paths, lost, at
    // infinity, tracked again, found.
    for (line, paths) in printed[0].1.lines().skip(1).zip([180, 344]) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!((cells[1], cells[2], cells[3], cells[6]), ("20", (20 * paths).to_string().as_str(), "0", "20"));
    }
    run_page("docs/guide/checks.md", folder.path());
}

/// Recordings that the program makes are calibrated to millimetres, as the page says.
#[test]
fn from_recordings_to_a_network() {
    let folder = tempfile::tempdir().expect("folder");
    let printed = run_page("docs/guide/recordings.md", folder.path());
    assert_eq!(printed.len(), 10);
    let rms = |text: &str| -> f64 {
        let line = text.lines().find(|line| line.starts_with("against the truth")).expect("a comparison");
        let (length, unit) =
            line.split_once("receivers, ").and_then(|(_, rest)| rest.split_once(' ')).expect("a length");
        let metres = if unit.starts_with("mm") { 1e-3 } else { 1.0 };
        metres * length.parse::<f64>().expect("a number")
    };
    // One recorder, four recorders, chirps in noise.
    for (command, most) in [(1, 3e-3), (5, 5e-3), (7, 3e-3)] {
        let text = &printed[command].1;
        assert!(rms(text) < most && text.contains("; unique"), "{text}");
    }
    assert!(folder.path().join("room.html").exists());
    // Twenty-five claps of which twenty made the network.
    assert!(printed[9].1.lines().filter(|line| line.contains("\"unique\":true")).count() == 25, "{}", printed[9].1);
}

#[test]
fn readme_and_contributing() {
    let folder = tempfile::tempdir().expect("folder");
    // A camera at distances 2, 3 and 4 from three points, as on the front page of the crate hc.
    let g = [0.5, 0.6, 0.7];
    let parameters = [g[0], g[1], g[2], 13.0 - 12.0 * g[0], 20.0 - 16.0 * g[1], 25.0 - 24.0 * g[2]];
    let text = std::fs::read_to_string(root().join("examples/families/p3p.target.json")).expect("target");
    let target: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for (k, parameter) in parameters.iter().enumerate() {
        assert!((target["parameters"][k].as_f64().expect("number") - parameter).abs() < 1e-12, "{text}");
    }
    run_page("README.md", folder.path());
    run_page("CONTRIBUTING.md", folder.path());
    // The examples are what their pages say they are.
    for name in ["network", "room"] {
        run_page(&format!("examples/{name}/README.md"), folder.path());
        let made = std::fs::read(folder.path().join(name).join("pseudoranges.csv")).expect("made");
        let file = root().join("examples").join(name).join("pseudoranges.csv");
        assert!(made == std::fs::read(file).expect("example"), "{name}");
    }
}
