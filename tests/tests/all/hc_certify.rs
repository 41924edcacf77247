//! `hc certify` and `hc solve --certify`, as a user would run them.

use end_to_end::{Folder, run};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Output;

/// A cubic and a line: solutions (0.1, 0.2), (-1, -2) and (2, 4).
const SYSTEM: &str = "2\n(x - 0.1)*(x + 1)*(x - 2);\n y - 2*x;\n";

fn hc(arguments: &[&str], files: &[&Path]) -> Output {
    let mut all = arguments.to_vec();
    all.extend(files.iter().map(|p| p.to_str().expect("UTF-8 path")));
    run("hc", &all)
}

fn report(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn what_solve_finds_certify_proves() {
    let folder = Folder::empty();
    let (system, solved) = (folder.write("system.phc", SYSTEM), folder.path().join("solved.json"));
    let output = hc(&["solve", "--certify", "--json", solved.to_str().unwrap()], &[&system]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&std::fs::read(&solved).unwrap()).unwrap();
    let solutions = found["solutions"].as_array().unwrap();
    assert_eq!(solutions.len(), 3);
    assert!(solutions.iter().all(|s| s["certified"] == true && s["is_real"] == true));

    let output = hc(&["certify", "--json", "-"], &[&system, &solved]);
    assert_eq!(output.status.code(), Some(0));
    let proved = report(&output);
    assert_eq!((&proved["n_certified"], &proved["n_distinct"], &proved["n_real"]), (&json!(3), &json!(3), &json!(3)));
    for s in proved["solutions"].as_array().unwrap() {
        for (value, bounds) in s["value"].as_array().unwrap().iter().zip(s["box"].as_array().unwrap()) {
            for part in 0..2 {
                let (low, high) = (bounds[part][0].as_f64().unwrap(), bounds[part][1].as_f64().unwrap());
                let middle = value[part].as_f64().unwrap();
                assert!(low <= middle && middle <= high && high - low < 1e-14);
            }
        }
    }
    // The same bytes on any number of threads, but for the time taken.
    let strip = |mut report: Value| {
        report["seconds"] = Value::Null;
        report.to_string()
    };
    let again = hc(&["certify", "--threads", "2", "--json", "-"], &[&system, &solved]);
    assert_eq!(strip(report(&again)), strip(proved));
}

#[test]
fn without_the_option_certified_is_null() {
    let folder = Folder::empty();
    let system = folder.write("system.phc", SYSTEM);
    let found = report(&hc(&["solve", "--json", "-"], &[&system]));
    assert!(found["solutions"].as_array().unwrap().iter().all(|s| s["certified"].is_null()));
}

#[test]
fn lists_of_points_are_read_in_the_order_of_the_unknowns() {
    let folder = Folder::empty();
    let system = folder.write("system.phc", SYSTEM);
    let points = folder.write("points.json", "[[2, 4], [[2.000001, 0], [4, 1e-6]], [-1, -2.0], [5, 6]]");
    let output = hc(&["certify", "--json", "-"], &[&system, &points]);
    // One point is no solution.
    assert_eq!(output.status.code(), Some(1));
    let proved = report(&output);
    assert_eq!((&proved["n_points"], &proved["n_certified"], &proved["n_distinct"]), (&json!(4), &json!(3), &json!(2)));
    assert_eq!(proved["partial"], json!(false));
    assert_eq!(proved["solutions"][1]["duplicate_of"], 0);
    assert_eq!(proved["solutions"][3]["certified"], false);
    assert!(proved["solutions"][3]["reason"].is_string());
    assert!(proved["solutions"][3]["box"].is_null());

    // Names decide where there are some.
    let named = folder.write("named.json", r#"{"variables": ["y", "x"], "solutions": [{"value": [[4, 0], [2, 0]]}]}"#);
    let proved = report(&hc(&["certify", "--json", "-"], &[&system, &named]));
    assert_eq!((&proved["n_certified"], &proved["solutions"][0]["value"][1][0]), (&json!(1), &json!(4.0)));
}

#[test]
fn plain_numbers_are_read() {
    let folder = Folder::empty();
    let system = folder.write("system.phc", SYSTEM);
    let points = folder.write("points.txt", "# two and one that is none\n2 4\n-1+0i, (-2-1e-9j)\n\n1e1 i\n");
    let output = hc(&["certify", "--json", "-"], &[&system, &points]);
    assert_eq!(output.status.code(), Some(1));
    let proved = report(&output);
    assert_eq!((&proved["n_points"], &proved["n_certified"], &proved["n_distinct"]), (&json!(3), &json!(2), &json!(2)));
    // Names decide where there are some.
    let named = folder.write("named.txt", "variables: y x\n4 2\n");
    let output = hc(&["certify"], &[&system, &named]);
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(shown.starts_with("1 of 1 point certified: 1 distinct solution, 1 of them proved real\n"), "{shown}");
    for (text, word) in [
        ("2 4\n2 4 6", "bad.txt: line 2: 3 numbers, but 2 coordinates needed: x y"),
        ("2 four", "bad.txt: line 1: `four` is not a finite number"),
        ("variables: u v\n1 2", "bad.txt: its variables are u v, those of the system x y"),
    ] {
        let output = hc(&["certify"], &[&system, &folder.write("bad.txt", text)]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains(word), "{message}");
    }
}

#[test]
fn lists_of_phcpack_are_read() {
    let folder = Folder::empty();
    let system = folder.write("system.phc", SYSTEM);
    // Two solutions in the form in which `phc -b` writes them, unknowns in another order.
    let solution = |k: usize, x: &str, y: &str| {
        format!(
            "solution {k} :\nt :  1.00000000000000E+00   0.00000000000000E+00\nm : 1\nthe solution for t :\n y : {y}\n x : {x}\n\
             == err :  1.234E-16 = rco :  1.111E-01 = res :  2.220E-16 =\n"
        )
    };
    let list = format!(
        "2\n the system once more;\n\nTHE SOLUTIONS :\n2 2\n{}\n{}{}",
        "=".repeat(75),
        solution(1, "2.00000000000000E+00  1.0E-30", "4.00000000000000E+00  0.00000000000000E+00"),
        solution(2, "-1.00000000000000E+00  0.0E+00", "-2.00000000000000E+00  0.00000000000000E+00")
    );
    let proved = report(&hc(&["certify", "--json", "-"], &[&system, &folder.write("solutions", &list)]));
    assert_eq!((&proved["n_certified"], &proved["n_distinct"], &proved["n_real"]), (&json!(2), &json!(2), &json!(2)));
    assert_eq!(proved["solutions"][0]["value"], json!([[2.0, 0.0], [4.0, 0.0]]));
}

#[test]
fn unusable_input_is_told_apart_from_failure() {
    let folder = Folder::empty();
    let system = folder.write("system.phc", SYSTEM);
    let wide = folder.write("wide.phc", "1\nx + y;");
    let points = folder.write("points.json", "[[2, 4]]");
    for (system, solutions, word) in [
        (&system, "[[1]]", "point 1 has 1 coordinate, the system has 2 unknowns"),
        (&system, "{\"solutions\": 3}", "expected the JSON"),
        (&system, r#"{"variables": ["u", "v"], "solutions": []}"#, "variables are u v"),
        (&wide, "[[2, 4]]", "1 equation in 2 unknowns"),
    ] {
        let solutions = folder.write("bad.json", solutions);
        let output = hc(&["certify"], &[system, &solutions]);
        assert_eq!(output.status.code(), Some(2));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains(word), "{message}");
    }
    let missing = folder.path().join("missing.phc");
    assert_eq!(hc(&["certify"], &[&missing, &points]).status.code(), Some(2));
    // A double root is not certified, and that is no error of the input.
    let double = folder.write("double.phc", "1\nx^2 - 2*x + 1;");
    let one = folder.write("one.json", "[[1]]");
    let output = hc(&["certify"], &[&double, &one]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("0 of 1 point certified"));
}
