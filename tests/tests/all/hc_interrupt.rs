//! What `hc` leaves when it is interrupted: a partial result that says so.

use end_to_end::{program, root, run};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Runs `hc` with JSON to standard output, sends SIGINT after a second and a half, and returns what
/// it leaves.
fn interrupted(arguments: &[&str]) -> Value {
    interrupted_with_output("--json", arguments)
}

fn interrupted_with_output(option: &str, arguments: &[&str]) -> Value {
    let mut command = Command::new(program("hc"));
    let output = end_to_end::interrupted(
        command.args(arguments).args([option, "-", "--threads", "1"]),
        Duration::from_millis(1500),
    );
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.ends_with("hc: interrupted; the result is partial\n"), "{message}");
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn written(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("UTF-8 path").to_owned()
}

fn cyclic(n: usize) -> String {
    let product = |j: usize, m: usize| (j..=j + m).map(|k| format!("x{}", k % n)).collect::<Vec<_>>().join("*");
    let sum = |m: usize| (0..n).map(|j| product(j, m)).collect::<Vec<_>>().join("+");
    let sums: String = (0..n - 1).map(|m| sum(m) + ";\n").collect();
    format!("{n}\n{sums}{}-1;\n", product(0, n - 1))
}

#[test]
fn solutions_found_so_far() {
    let folder = tempfile::tempdir().expect("directory");
    // 2^18 roots, a minute's work and more.
    let n = 18;
    let equation = |i: usize| {
        let next = |k: usize| (i + k) % n;
        format!("x{i}^2 - {}*x{}*x{} + 3*x{} + {};\n", i + 2, next(1), next(2), next(3), i + 1)
    };
    let system = format!("{n}\n{}", (0..n).map(equation).collect::<String>());
    let system = written(folder.path(), "quadrics.phc", &system);
    let found = interrupted(&["solve", &system, "--start", "total-degree"]);
    assert_eq!((&found["partial"], &found["paths"]["tracked"]), (&json!(true), &json!(1 << 18)));
    let count = |name: &str| found["paths"][name].as_u64().expect("a count");
    assert!(count("failed") > 0);
    assert_eq!(count("finite") + count("at_infinity") + count("failed"), 1 << 18);
    assert_eq!(count("finite"), found["solutions"].as_array().expect("a list").len() as u64);
}

#[test]
fn a_lower_bound_of_the_mixed_volume() {
    let folder = tempfile::tempdir().expect("directory");
    let found = interrupted(&["mixed-volume", &written(folder.path(), "cyclic.phc", &cyclic(14))]);
    assert_eq!(found["partial"], true);
    // Of 8,795,976.
    assert!(found["mixed_volume"].as_u64().expect("a number") < 8_795_976, "{found}");
}

#[test]
fn the_targets_done_so_far() {
    let folder = tempfile::tempdir().expect("directory");
    let family = root().join("examples/families/p3p.toml");
    let family = family.to_str().expect("UTF-8 path");
    let start = folder.path().join("start.json");
    let start = start.to_str().expect("UTF-8 path");
    assert!(run("hc", &["monodromy", family, "--output", start]).status.success());
    let target = json!({ "parameters": [0.5, 0.6, 0.7, 7.0, 10.4, 8.2] });
    let targets = json!(vec![target; 300_000]).to_string();
    let found =
        interrupted(&["track", family, "--start", start, "--target", &written(folder.path(), "t.json", &targets)]);
    let found = found.as_array().expect("a list");
    assert!((1..300_000).contains(&found.len()), "{}", found.len());
    assert!(found[..found.len() - 1].iter().all(|report| report["partial"] == false));
}

#[test]
fn the_solutions_of_a_family_found_so_far() {
    let folder = tempfile::tempdir().expect("directory");
    let family = "name = 'dense'\nunknowns = ['x', 'y']\nparameters = ['a', 'b', 'c', 'd', 'e', 'f']\n\
                  equations = ['x^90 + a*x*y^40 + b*y + c', 'y^90 + d*x^40*y + e*x + f']\n";
    let found = interrupted_with_output("--output", &["monodromy", &written(folder.path(), "dense.toml", family)]);
    assert_eq!((&found["stopped"], &found["trace_test"]), (&json!("interrupted"), &Value::Null));
    // Of 8100.
    assert!((1..8100).contains(&found["solutions"].as_array().expect("a list").len()));
}
