//! The commands of docs/guide, as a reader would run them.

use end_to_end::{root, run};

/// The commands of a page that run the program `hc`, as arguments.
fn commands(page: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(root().join("docs/guide").join(page)).expect("page");
    let prefix = "    cargo run --release -p hc-cli -- ";
    text.lines().filter_map(|l| l.strip_prefix(prefix)).map(|l| l.split(' ').map(str::to_owned).collect()).collect()
}

#[test]
fn the_page_on_minimal_problems() {
    let directory = tempfile::tempdir().expect("directory");
    // Five points in front of a camera that has moved by (1, 0, 0) without turning: x = y = z = u = v = 0.
    let points = [[0.1, 0.2, 3.0], [-0.3, 0.4, 4.0], [0.5, -0.2, 5.0], [-0.4, -0.5, 3.5], [0.2, 0.6, 6.0]];
    let parameters: Vec<f64> =
        points.iter().flat_map(|p| [(p[0] + 1.0) / p[2], p[1] / p[2], p[0] / p[2], p[1] / p[2]]).collect();
    let target = directory.path().join("TARGET.json");
    std::fs::write(&target, serde_json::json!({ "parameters": parameters }).to_string()).expect("written");
    let commands = commands("minimal-problem.md");
    assert_eq!(commands.len(), 2, "{commands:?}");
    for command in &commands {
        let place = |word: &String| match word.as_str() {
            "five_point.start.json" | "TARGET.json" => directory.path().join(word).to_string_lossy().into_owned(),
            family if family.starts_with("examples/") => root().join(family).to_string_lossy().into_owned(),
            other => other.to_owned(),
        };
        let mut arguments: Vec<String> = command.iter().map(place).collect();
        if command[0] == "track" {
            arguments.extend(["--json".to_owned(), "-".to_owned()]);
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = run("hc", &arguments);
        assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
        if command[0] == "track" {
            let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
            let still = |s: &serde_json::Value| {
                s["value"].as_array().unwrap().iter().all(|z| z[0].as_f64().unwrap().abs() < 1e-9)
            };
            assert!(report["solutions"].as_array().unwrap().iter().any(still), "{report}");
        }
    }
}
