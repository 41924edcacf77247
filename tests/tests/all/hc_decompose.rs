//! `hc decompose`, as a user would run it: what it prints.

use end_to_end::run_on;
use serde_json::Value;

fn decompose(text: &str, arguments: &[&str]) -> (Option<i32>, String) {
    let output = run_on("hc", &[&["decompose", "-"], arguments].concat(), text);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!message.contains("panicked"), "{message}");
    (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A line and the points (1, 2) and (1, -2): x = 1 leaves y = 2 and y = -2 of the second equation.
const LINE_AND_POINTS: &str = "x*(x - 1)\nx*(y^2 - 4)";

#[test]
fn witness_points_and_isolated_solutions_are_shown() {
    let (status, out) = decompose(LINE_AND_POINTS, &[]);
    assert_eq!(status, Some(0), "{out}");
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines[0], "1 component of positive dimension, 2 isolated solutions", "{out}");
    assert_eq!(lines[1], "  dimension 1, degree 1", "{out}");
    // The line is x = 0, so that its one witness point is too.
    assert!(lines[2].starts_with("    x = 0.0000") || lines[2].starts_with("    x = -0.0000"), "{out}");
    assert!(lines[2].contains(", y = "), "{out}");
    assert_eq!(lines[3], "  isolated", "{out}");
    let mut isolated = lines[4..lines.len() - 1].to_vec();
    isolated.sort_unstable();
    let y = |sign: &str| format!("    x = 1.000000000000, y = {sign}2.000000000000");
    assert_eq!(isolated, [y("-"), y("")], "{out}");
}

/// What the text shows are the points of the JSON.
#[test]
fn the_first_ten_of_many_points_are_shown() {
    let circles = "(x^2 + y^2 - 1)*(x^11 + y^11 - 3)";
    let (status, out) = decompose(circles, &[]);
    let (_, json) = decompose(circles, &["--json", "-"]);
    assert_eq!(status, Some(0), "{out}");
    assert!(out.starts_with("2 components of positive dimension, 0 isolated solutions"), "{out}");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    let mut degrees = Vec::new();
    for component in json["components"].as_array().expect("components") {
        let points = component["witness_points"].as_array().expect("points");
        degrees.push(points.len());
        for (k, point) in points.iter().enumerate() {
            let start = format!("    x = {:.12}", point[0][0].as_f64().expect("a number"));
            assert_eq!(out.contains(&start), k < 10, "{start}: {out}");
        }
    }
    degrees.sort_unstable();
    assert_eq!(degrees, [2, 11]);
    assert_eq!(out.matches("    and 1 more witness point (the JSON has all)\n").count(), 1, "{out}");
}

#[test]
fn multiple_isolated_solutions_say_so() {
    let (status, out) = decompose("x*(x - 1)\nx*(y - 2)^2", &[]);
    assert_eq!(status, Some(0), "{out}");
    assert!(out.contains("1 isolated solution\n"), "{out}");
    assert!(out.contains("    x = 1.000000000000, y = 2.000000000000  (multiplicity 2)\n"), "{out}");
}
