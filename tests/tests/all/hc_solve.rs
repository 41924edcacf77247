//! The program `hc solve` as a user would run it: what it prints and writes, and what it says to
//! unusable input.

use end_to_end::run;
use serde_json::Value;
use std::path::PathBuf;

/// Runs `hc solve` on a text; the exit status, standard output and standard error.
fn solve(text: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let file: PathBuf = folder.path().join("system.phc");
    std::fs::write(&file, text).expect("written");
    let mut all = vec!["solve", file.to_str().expect("UTF-8 path")];
    all.extend(arguments);
    let output = run("hc", &all);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn writes_what_the_contract_says() {
    let (status, out, _) = solve("2\nx*(x - y)^2;\n(y - 1)*(y + 2);", &["--json", "-", "--seed", "3"]);
    assert_eq!(status, Some(0));
    let json: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(json["variables"], serde_json::json!(["x", "y"]));
    assert_eq!(json["mixed_volume"], 6);
    assert_eq!(json["seed"], 3);
    assert_eq!(json["paths"]["tracked"], 6);
    assert_eq!(json["paths"]["failed"], 0);
    let solutions = json["solutions"].as_array().expect("solutions");
    assert_eq!(solutions.len(), 4);
    for solution in solutions {
        // x = 0 is simple, x = y is double.
        let double = solution["value"][0][0].as_f64().expect("a number").abs() > 0.5;
        assert_eq!(solution["multiplicity"], if double { 2 } else { 1 });
        assert_eq!(solution["singular"], double);
        assert_eq!(solution["is_real"], true);
        assert_eq!(solution["certified"], Value::Null);
        assert!(solution["residual"].as_f64().expect("a number") < 1e-10);
    }
}

/// `hc solve` on a system with multiple solutions, which takes an endgame: its result without the time, or the
/// exit status and what it said.
fn result(arguments: &[&str]) -> Result<String, (Option<i32>, String)> {
    let text = "3\nx^2+y*z-x-1;\n(y^2+x*z-2*y+3)*(x-z);\n(z-1)^2*(x*y-5);";
    let (status, out, error) = solve(text, &[&["--json", "-"], arguments].concat());
    if status != Some(0) {
        return Err((status, error));
    }
    let mut json: Value = serde_json::from_str(&out).expect("JSON");
    json["seconds"] = Value::Null;
    Ok(json.to_string())
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let one = result(&["--threads", "1"]);
    assert!(one.is_ok(), "{one:?}");
    assert_eq!(one, result(&["--threads", "3"]));
}

#[test]
fn the_same_bytes_with_any_instruction_set() {
    let portable = result(&["--instructions", "portable"]);
    assert!(portable.is_ok(), "{portable:?}");
    for set in ["avx2", "avx512"] {
        match result(&["--instructions", set]) {
            // A machine without them says so.
            Err((status, error)) => assert!(status == Some(2) && error.contains("does not have"), "{error}"),
            same => assert_eq!(same, portable, "{set}"),
        }
    }
    let (status, words) = result(&["--instructions", "abacus"]).unwrap_err();
    assert!(status == Some(2) && words.contains("portable, avx2, avx512"), "{words}");
}

/// A circle and a hyperbola that meet in (1, 2), (2, 1) and their opposites, in each of the formats
/// that are read.
#[test]
fn every_format_of_a_system_is_known() {
    let results: Vec<Value> = [
        "2\n x^2 + y^2 - 5;\n x*y - 2;\n",
        "# A circle\nx^2 + y^2 = 5\n\nx*y = 2  # and a hyperbola",
        "variables: x y\nx*y*0 + x^2 + y^2 - 5; x*y - 2;",
        "name = 'conics'\nunknowns = ['x', 'y']\nequations = ['x^2 + y^2 = 5', 'x*y - 2']\n",
    ]
    .into_iter()
    .map(|text| {
        let (status, out, error) = solve(text, &["--json", "-"]);
        assert_eq!(status, Some(0), "{text}: {error}");
        let mut json: Value = serde_json::from_str(&out).expect("JSON");
        json["seconds"] = Value::Null;
        json
    })
    .collect();
    let solutions = results[0]["solutions"].as_array().expect("solutions");
    assert_eq!(solutions.len(), 4);
    for solution in solutions {
        let [x, y] = [0, 1].map(|k| solution["value"][k][0].as_f64().expect("a number"));
        assert!((x * y - 2.0).abs() < 1e-12 && (x.abs() + y.abs() - 3.0).abs() < 1e-12, "{solution}");
    }
    assert!(results.iter().all(|result| result == &results[0]));
    let family = "name = 'f'\nunknowns = ['x']\nparameters = ['a']\nequations = ['x^2 - a']\n";
    for (text, words) in
        [(family, "parameters (a"), ("x^2 = 5\nx*y = ", "line 2, column 7"), ("x^2\n+ y^2 = 5", "line 2")]
    {
        let (status, out, error) = solve(text, &[]);
        assert!(status == Some(2) && error.contains(words), "{text}: {out}{error}");
    }
}

#[test]
fn multihomogeneous_start_with_given_groups() {
    // Bilinear in (x, y) and (z): the multihomogeneous number is the coefficient of a^2 b in (a +
    // b)^3, three; the degree is eight.
    let text = "3\nx*z+2*y+z-1;\n3*x*z-y*z+x+5;\nx+y*z-7*z+2;";
    let (status, out, error) = solve(text, &["--json", "-", "--start", "multihomogeneous", "--groups", "x,y;z"]);
    assert_eq!(status, Some(0), "{error}");
    let json: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((&json["paths"]["tracked"], &json["paths"]["failed"]), (&3.into(), &0.into()), "{out}");
    let count = |json: &Value| json["solutions"].as_array().expect("solutions").len();
    let (_, other, _) = solve(text, &["--json", "-", "--start", "total-degree"]);
    let other: Value = serde_json::from_str(&other).expect("JSON");
    assert_eq!((count(&json), &other["paths"]["tracked"]), (count(&other), &8.into()));
    for groups in ["x;z", "x,y;z,w", "x,y;y,z", ""] {
        let (status, out, error) = solve(text, &["--start", "multihomogeneous", "--groups", groups]);
        assert_eq!((status, out.as_str()), (Some(2), ""), "{groups}: {error}");
        assert!(error.starts_with("hc: ") && error.contains("group"), "{groups}: {error}");
    }
}

#[test]
fn no_solution_and_components_are_said() {
    let (status, out, _) = solve("2\nx+y-1;\nx+y-2;", &[]);
    assert_eq!((status, out.contains("0 isolated solutions")), (Some(1), true), "{out}");
    let (status, out, _) = solve("2\nx*(x-1);\nx*(y-2)*(y-3);", &[]);
    assert_eq!((status, out.contains("2 isolated solutions")), (Some(0), true), "{out}");
    assert!(out.contains("positive dimension"), "{out}");
}

#[test]
fn unusable_input_ends_with_status_two_and_a_reason() {
    for (text, words) in [
        ("", "line 1"),
        ("0\n", "0 equations"),
        ("1\nx + y - 1;", "unknowns (x, y)"),
        // There are no such numbers: the word is read as the name of an unknown.
        ("1\nNaN*x - 1;", "unknowns (NaN, x)"),
        ("1\nx^2 - ;", "line 2"),
        ("2\nx - x;\ny + 0*x - 1;", "equation 1 is zero"),
        ("2\nx + y;\nx - x + 3;", "equation 2 is a constant"),
        ("1\n1.0E999*x - 1;", "double precision"),
        ("1\nx^99999999999 - 1;", "exponent"),
        ("2\nx^2000000000*y-1;\ny^2000000000-x;", "exponents"),
        ("2\nx^40000-1;\ny^40000*x-1;", "paths"),
    ] {
        let (status, out, error) = solve(text, &[]);
        assert_eq!(status, Some(2), "{text}: {out}{error}");
        assert!(error.contains(words) && !error.contains("panicked"), "{text}: {error}");
    }
    let output = run("hc", &["solve", "no such file"]);
    assert_eq!(output.status.code(), Some(2));
    let (status, _, error) = solve("1\nx - x^(-1);", &["--start", "total-degree"]);
    assert_eq!((status, error.contains("negative")), (Some(2), true), "{error}");
}
