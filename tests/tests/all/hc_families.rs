//! The program `hc` on parameter families, as a user would run it.

use end_to_end::{root, run};
use hc::random::Random;
use serde_json::{Value, json};
use std::path::Path;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

fn family(name: &str) -> String {
    text(&root().join(format!("examples/families/{name}.toml"))).to_owned()
}

/// Fills the fibre, tracks it to the targets and returns the reports.
fn solve(name: &str, targets: &[Vec<f64>], threads: &str) -> Vec<Value> {
    let directory = tempfile::tempdir().expect("directory");
    let (start, target) = (directory.path().join("start.json"), directory.path().join("target.json"));
    let output = run("hc", &["monodromy", &family(name), "--output", text(&start)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let list: Vec<Value> = targets.iter().map(|p| json!({ "parameters": p })).collect();
    std::fs::write(&target, serde_json::to_string(&list).unwrap()).expect("written");
    let arguments = [
        "track",
        &family(name),
        "--start",
        text(&start),
        "--target",
        text(&target),
        "--json",
        "-",
        "--threads",
        threads,
    ];
    let output = run("hc", &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Whether a report has a real solution within `tolerance` of `x`.
fn has(report: &Value, x: &[f64], tolerance: f64) -> bool {
    report["solutions"].as_array().unwrap().iter().filter(|s| s["is_real"] == true).any(|s| {
        let value = s["value"].as_array().unwrap();
        value.iter().zip(x).all(|(z, x)| (z[0].as_f64().unwrap() - x).abs() < tolerance)
    })
}

#[test]
fn cameras_planted_before_three_points_are_found() {
    let mut random = Random::new(1, 0);
    let mut uniform = |low: f64, high: f64| low + (high - low) * (random.unit().arg() / std::f64::consts::TAU + 0.5);
    let planted: Vec<([f64; 3], Vec<f64>)> = (0..1000)
        .map(|_| {
            let d = [(); 3].map(|()| uniform(1.0, 5.0));
            let g = [(); 3].map(|()| uniform(-0.9, 0.9));
            let side = |a: usize, b: usize, g: f64| d[a] * d[a] + d[b] * d[b] - 2.0 * g * d[a] * d[b];
            (d, vec![g[0], g[1], g[2], side(0, 1, g[0]), side(0, 2, g[1]), side(1, 2, g[2])])
        })
        .collect();
    let targets: Vec<Vec<f64>> = planted.iter().map(|(_, p)| p.clone()).collect();
    for (k, (report, (d, _))) in solve("p3p", &targets, "2").iter().zip(&planted).enumerate() {
        assert_eq!(report["paths"]["finite"], 8, "target {k}");
        assert!(has(report, d, 1e-6), "target {k}");
    }
}

#[test]
fn relative_poses_planted_behind_five_points_are_found_on_any_number_of_threads() {
    let mut random = Random::new(2, 0);
    let mut normal = || random.normal().re * 2f64.sqrt();
    let planted: Vec<([f64; 5], Vec<f64>)> = (0..30)
        .map(|_| {
            let x @ [cx, cy, cz, u, v] = [(); 5].map(|()| 0.5 * normal());
            let scale = 1.0 + cx * cx + cy * cy + cz * cz;
            let rotation = [
                [1.0 + cx * cx - cy * cy - cz * cz, 2.0 * (cx * cy - cz), 2.0 * (cx * cz + cy)],
                [2.0 * (cx * cy + cz), 1.0 - cx * cx + cy * cy - cz * cz, 2.0 * (cy * cz - cx)],
                [2.0 * (cx * cz - cy), 2.0 * (cy * cz + cx), 1.0 - cx * cx - cy * cy + cz * cz],
            ];
            let mut parameters = Vec::new();
            for _ in 0..5 {
                // A point in the second camera's frame; the first sees R X + t.
                let point = [normal(), normal(), 4.0 + normal().abs()];
                let turned = rotation.map(|row| row.iter().zip(point).map(|(r, p)| r * p).sum::<f64>() / scale);
                let seen = [turned[0] + 1.0, turned[1] + u, turned[2] + v];
                parameters.extend([seen[0] / seen[2], seen[1] / seen[2], point[0] / point[2], point[1] / point[2]]);
            }
            (x, parameters)
        })
        .collect();
    let targets: Vec<Vec<f64>> = planted.iter().map(|(_, p)| p.clone()).collect();
    let reports = solve("five_point", &targets, "1");
    for (k, (report, (x, _))) in reports.iter().zip(&planted).enumerate() {
        assert_eq!(report["paths"]["failed"], 0, "target {k}: {}", report["paths"]);
        assert!(has(report, x, 1e-5), "target {k}");
    }
    for (one, two) in reports.iter().zip(solve("five_point", &targets, "2")) {
        assert_eq!((&one["solutions"], &one["paths"]), (&two["solutions"], &two["paths"]));
    }
}

/// What `hc codegen` writes is what `cargo xtask codegen` writes, to the byte; a stale file and
/// wrong inputs are named.
#[test]
fn the_solver_of_a_family_is_written_as_rust() {
    let directory = tempfile::tempdir().expect("directory");
    let solver = directory.path().join("solver.rs");
    let start = family("five_point").replace(".toml", ".start.json");
    let generate = |family: &str, start: &str, more: &[&str]| {
        let mut arguments = vec!["codegen", family, start, "-o", text(&solver)];
        arguments.extend(more);
        let output = run("hc", &arguments);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(generate(&family("five_point"), &start, &[]), (Some(0), format!("wrote {}\n", solver.display())));
    let written = std::fs::read_to_string(&solver).expect("written");
    let committed = std::fs::read_to_string(root().join("crates/hc/examples/five_point/generated.rs")).expect("source");
    // The header names the family as it was given: the file name here, its place in the repository
    // there.
    assert_eq!(
        written,
        committed.replace("// Source: examples/families/five_point.toml", "// Source: five_point.toml")
    );
    assert_eq!(generate(&family("five_point"), &start, &["--check"]).0, Some(0));
    std::fs::write(&solver, written + "\n").expect("written");
    let (status, message) = generate(&family("five_point"), &start, &["--check"]);
    assert!(status == Some(1) && message.contains("stale"), "{message}");
    let (status, message) = generate(&family("p3p"), &start, &[]);
    assert!(status == Some(2) && message.contains("the family has 6 parameters and 3 unknowns"), "{message}");
}

/// Of several members the one with the least work is stored, the same whenever it is sought.
#[test]
fn the_easiest_fibre_is_stored() {
    let start = family("five_point").replace(".toml", ".start.json");
    let generate = |members: &str, more: &[&str]| {
        let arguments = ["codegen", &family("five_point"), &start, "-o", "-", "--fibres", members];
        let output = run("hc", &[&arguments, more].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{message}");
        let jacobians = message.split(": ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
        (output.stdout, message.clone(), jacobians.unwrap_or_else(|| panic!("{message}")))
    };
    let (module, message, _) = generate("12", &[]);
    assert!(message.contains(" fibre: ") && message.ends_with(" Jacobians a path to 36 samples\n"), "{message}");
    assert!(String::from_utf8_lossy(&module).contains("pub fn fibre()"));
    assert_eq!(generate("12", &[]).0, module);

    let directory = tempfile::tempdir().expect("directory");
    let targets = directory.path().join("targets.json");
    let given: Value = serde_json::from_str(&std::fs::read_to_string(&start).expect("start")).expect("JSON");
    std::fs::write(&targets, json!([{ "parameters": given["parameters"] }]).to_string()).expect("written");
    // No way is shorter than none.
    let (_, message, jacobians) = generate("2", &["--targets", text(&targets)]);
    assert!(message.starts_with("the given fibre: ") && message.ends_with("to 1 sample\n"), "{message}");
    assert!(jacobians < 10.0, "{message}");

    std::fs::write(&targets, "[]").expect("written");
    let arguments = ["codegen", &family("five_point"), &start, "-o", "-", "--fibres", "2", "--targets", text(&targets)];
    let output = run("hc", &arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("at least one target is needed"), "{message}");
}

/// A fibre is packed where the file's name says so, and checked as the source is.
#[test]
fn the_solutions_of_a_family_are_packed() {
    let directory = tempfile::tempdir().expect("directory");
    let packed = directory.path().join("five_point.fibre");
    let start = family("five_point").replace(".toml", ".start.json");
    let pack = |more: &[&str]| {
        let output = run("hc", &[&["codegen", &family("five_point"), &start, "-o", text(&packed)], more].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(pack(&[]), (Some(0), format!("wrote {}\n", packed.display())));
    // Header, parameters in full, twenty solutions of five bytes a coordinate.
    let bytes = std::fs::read(&packed).expect("written");
    let given: Value = serde_json::from_str(&std::fs::read_to_string(&start).expect("start")).expect("JSON");
    let count = |value: &Value| value.as_array().expect("list").len();
    let (parameters, unknowns) = (count(&given["parameters"]), count(&given["solutions"][0]));
    assert_eq!(bytes.len(), 20 + 16 * parameters + 20 * 5 * unknowns);
    assert_eq!(pack(&["--check"]).0, Some(0));
    std::fs::write(&packed, &bytes[..100]).expect("written");
    let (status, message) = pack(&["--check"]);
    assert!(status == Some(2) && message.contains("not a packed fibre"), "{message}");
}

/// The common point of a double root, and roots at infinity, as in `hc solve`; regular roots are
/// certified.
#[test]
fn special_members_are_solved_like_any_system() {
    let directory = tempfile::tempdir().expect("directory");
    let write = |name: &str, content: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, content).expect("written");
        text(&path).to_owned()
    };
    let family = write(
        "conics.toml",
        "name = \"conics\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"a\", \"b\", \"c\"]\n\
         equations = [\"a*x^2 + y^2 - b\", \"x*y - c\"]",
    );
    let start = directory.path().join("start.json");
    let output = run("hc", &["monodromy", &family, "--output", text(&start)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // A hyperbola that touches the circle twice; one that meets two lines in two points; one that
    // crosses the circle.
    let targets = r#"[{"parameters": [1, 2, 1]}, {"parameters": [0, 4, 3]}, {"parameters": [1, 5, [2, 0]]}]"#;
    let arguments =
        ["track", &family, "--start", text(&start), "--target", &write("t.json", targets), "--certify", "--json", "-"];
    let output = run("hc", &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let reports: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for (report, (count, multiplicity, infinite)) in
        reports.as_array().unwrap().iter().zip([(2, 2, 0), (2, 1, 2), (4, 1, 0)])
    {
        assert_eq!(report["paths"]["at_infinity"], infinite, "{report}");
        let solutions = report["solutions"].as_array().unwrap();
        assert_eq!(solutions.len(), count, "{report}");
        for s in solutions {
            assert_eq!((&s["multiplicity"], &s["is_real"]), (&json!(multiplicity), &json!(true)), "{report}");
            assert_eq!((&s["singular"], &s["certified"]), (&json!(multiplicity == 2), &json!(multiplicity == 1)));
        }
    }
    assert!(has(&reports[0], &[1.0, 1.0], 1e-8) && has(&reports[0], &[-1.0, -1.0], 1e-8));
    assert!(has(&reports[1], &[1.5, 2.0], 1e-12) && has(&reports[2], &[2.0, 1.0], 1e-12));
}

/// Lines that cross, a quotient, which has no start system, and squares with a double point at the origin.
#[test]
fn orbits_are_found_or_said_not_to_be_excluded() {
    let directory = tempfile::tempdir().expect("directory");
    let write = |name: &str, content: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, content).expect("written");
        text(&path).to_owned()
    };
    let start = text(&directory.path().join("start.json")).to_owned();
    let search = |family: &str, more: &[&str]| {
        let output = run("hc", &[&["monodromy", family, "--output", &start], more].concat());
        let found = std::fs::read_to_string(&start).ok().and_then(|json| serde_json::from_str(&json).ok());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), found.unwrap_or(Value::Null), error)
    };
    let lines = write("lines.txt", "parameters: a b\n(x - a)*(x - b - 5)");
    let (status, found, error) = search(&lines, &[]);
    assert!(status == Some(0) && error.contains("2 orbits of sizes 1, 1; stopped: trace"), "{error}");
    assert_eq!((&found["orbits"], &found["others"]), (&json!([1, 1]), &json!("start system")));
    let (status, found, error) = search(&lines, &["--only-component"]);
    assert!(status == Some(0) && error.contains("1 orbit of size 1; stopped: component whole"), "{error}");
    assert_eq!((found["solutions"].as_array().map(Vec::len), &found["others"]), (Some(1), &json!("not sought")));

    let quotient = write("quotient.txt", "parameters: a b c\nx/y - a\n(y^2 - b)*(y - c)");
    let (status, found, error) = search(&quotient, &[]);
    assert!(status == Some(1) && error.contains("others are not excluded"), "{error}");
    assert_eq!((&found["stopped"], &found["others"]), (&json!("orbits whole"), &json!("not excluded")));

    let squares = write("squares.txt", "parameters: a b\nx^2 - a*x\ny^2 - b*x");
    let (status, found, error) = search(&squares, &[]);
    assert!(status == Some(0) && error.contains("1 solution of multiplicity 2"), "{error}");
    assert_eq!(found["multiple"], json!([{ "value": [[0.0, 0.0], [0.0, 0.0]], "multiplicity": 2 }]));
    let target = write("target.json", r#"{"parameters": [2, 1]}"#);
    let track = |more: &[&str]| {
        let output = run("hc", &[&["track", &squares, "--start", &start, "--target", &target], more].concat());
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    assert!(track(&[]).contains("1 solution of multiplicity 2"));
    let report: Value = serde_json::from_str(&track(&["--json", "-"])).expect("JSON");
    assert_eq!((report["solutions"].as_array().map(Vec::len), &report["untracked"]), (Some(2), &json!([2])));

    let circle = write("circle.txt", "parameters: a b\nx^2 + y^2 = a\nx*y = b");
    let pair = write("pair.json", r#"{"parameters": [[5, 0], [2, 0]], "solutions": [[[1, 0], [3, 0]]]}"#);
    let (status, _, error) = search(&circle, &["--seed-pair", &pair]);
    assert!(status == Some(2) && error.contains("pair.json: first solution 1 is none"), "{error}");
}

#[test]
fn limits_of_effort_are_said() {
    let directory = tempfile::tempdir().expect("directory");
    let (start, target) = (directory.path().join("start.json"), directory.path().join("target.json"));
    let output = run("hc", &["monodromy", &family("p3p"), "--output", text(&start)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::write(&target, json!({ "parameters": [0.5, 0.6, 0.7, 7.0, 10.4, 8.2] }).to_string()).expect("written");
    let track = |more: &[&str]| {
        let family = family("p3p");
        let arguments = ["track", &family, "--start", text(&start), "--target", text(&target)];
        let output = run("hc", &[&arguments[..], more].concat());
        let words = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        (output.status.code(), words)
    };
    let report = |json: &str| serde_json::from_str::<Value>(json).expect("JSON");
    let (status, [out, _]) = track(&["--json", "-", "--again", "0", "--time-limit", "1000"]);
    assert_eq!((status, &report(&out)["limited"]), (Some(0), &Value::Null));
    let (status, [out, error]) = track(&["--json", "-", "--time-limit", "0"]);
    let found = report(&out);
    assert_eq!((status, &found["limited"], &found["partial"]), (Some(1), &json!("time"), &json!(false)), "{error}");
    assert!(found["paths"]["failed"].as_u64() > Some(0) && error.contains("the lists are not whole"), "{error}");
    let (status, [out, _]) = track(&["--time-limit", "0"]);
    assert!(status == Some(1) && out.contains("left: the time limit was reached"), "{out}");
    let (status, [_, error]) = track(&["--again", "-1"]);
    assert!(status == Some(2) && error.contains("again must be zero or more"), "{error}");
}

#[test]
fn unusable_input_is_named() {
    let directory = tempfile::tempdir().expect("directory");
    let write = |name: &str, content: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, content).expect("written");
        text(&path).to_owned()
    };
    let start = write("start.json", "");
    let cases: &[(Vec<String>, i32, &str)] = &[
        (
            vec!["monodromy".into(), "no-such-file.toml".into(), "--output".into(), start.clone()],
            2,
            "no-such-file.toml",
        ),
        (
            vec!["monodromy".into(), write("a.toml", "name = ['a']"), "--output".into(), start.clone()],
            2,
            "invalid type",
        ),
        (vec!["monodromy".into(), write("a.txt", "x^2 = 1"), "--output".into(), start.clone()], 2, "parameters: a b"),
        (
            vec!["monodromy".into(), write("c.txt", "parameters: a\nx = a*y"), "--output".into(), start.clone()],
            2,
            "1 equation in 2 unknowns; at least as many equations as unknowns are needed",
        ),
        (
            vec![
                "monodromy".into(),
                write("b.toml", "name = \"b\"\nunknowns = [\"x\", \"y\"]\nparameters = []\nequations = [\"x*y\"]"),
                "--output".into(),
                start.clone(),
            ],
            2,
            "as many equations as unknowns",
        ),
        (
            vec![
                "track".into(),
                family("p3p"),
                "--start".into(),
                write("c.json", "{\"parameters\": [[1, 0]], \"solutions\": [[[1, 0]]], \"stopped\": \"\"}"),
                "--target".into(),
                start.clone(),
            ],
            2,
            "6 parameters and 3 unknowns",
        ),
    ];
    for (arguments, status, part) in cases {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = run("hc", &arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(*status), "{message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{part:?} is not in: {message}");
    }
}

/// All minors of 2 x 3 linear forms in the plane, of rank one at three points: the degree of the variety. With a fibre, and
/// targets in three equations of two unknowns, a user gets all three or is told which equation fails.
#[test]
fn families_with_more_equations_than_unknowns_are_solved() {
    let directory = tempfile::tempdir().expect("directory");
    let path = |name: &str| directory.path().join(name);
    let write = |name: &str, content: &str| std::fs::write(path(name), content).expect("written");
    let forms = [["a", "x + b", "y + c"], ["x + 2*y + d", "3*x - y + e", "2*x + 5*y + f"]];
    let minor =
        |j: usize, k: usize| format!("({})*({}) = ({})*({})", forms[0][j], forms[1][k], forms[0][k], forms[1][j]);
    let equations = [minor(0, 1), minor(0, 2), minor(1, 2)].join("\n");
    write("minors.txt", &format!("parameters: a b c d e f\n{equations}\n"));
    write("minors.json", r#"[{"parameters": [1, 2, 3, 4, 5, 7]}, {"parameters": [3, -1, 0.5, 2, 8, -4]}]"#);
    let [family, start, target] = ["minors.txt", "start.json", "minors.json"].map(|name| text(&path(name)).to_owned());
    let ran = |arguments: &[&str]| {
        let output = run("hc", arguments);
        let [out, error] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("UTF-8"));
        (output.status.code(), out, error)
    };
    let (status, _, error) = ran(&["monodromy", &family, "--output", &start]);
    assert!(status == Some(0) && error.contains("3 solutions"), "{error}");
    let (status, out, error) = ran(&["track", &family, "--start", &start, "--target", &target, "--json", "-"]);
    assert_eq!(status, Some(0), "{error}");
    let reports: Vec<Value> = serde_json::from_str(&out).expect("JSON");
    let values = [[1.0, 2.0, 3.0, 4.0, 5.0, 7.0], [3.0, -1.0, 0.5, 2.0, 8.0, -4.0]];
    for (report, [a, b, c, d, e, f]) in reports.iter().zip(values) {
        let counts = ["finite", "failed"].map(|key| report["paths"][key].as_u64());
        assert_eq!((counts, report["excess"].as_u64()), ([Some(3), Some(0)], Some(0)), "{report}");
        for solution in report["solutions"].as_array().unwrap() {
            let [x, y] = [0, 1].map(|j| {
                let [re, im] = [0, 1].map(|k| solution["value"][j][k].as_f64().unwrap());
                hc::Complex64::new(re, im)
            });
            let rows = [[x * 0.0 + a, x + b, y + c], [x + 2.0 * y + d, 3.0 * x - y + e, 2.0 * x + 5.0 * y + f]];
            for (j, k) in [(0, 1), (0, 2), (1, 2)] {
                assert!((rows[0][j] * rows[1][k] - rows[0][k] * rows[1][j]).norm() < 1e-10, "{solution}");
            }
        }
    }
    let (status, _, error) =
        ran(&["track", &family, "--start", &start, "--target", &target, "--certify", "--json", "-"]);
    assert!(status == Some(2) && error.contains("3 equations in 2 unknowns; only families of as many"), "{error}");
    let (status, solver, error) = ran(&["codegen", &family, &start, "-o", "-"]);
    assert!(status == Some(0) && solver.contains(".equations(&equations::System)"), "{error}");

    write("redundant.txt", "parameters: a b\nx^2 = a\nx*y = b\na*y^2 = b^2\n");
    write("pair.json", r#"{"parameters": [[1, 0], [1, 0]], "solutions": [[[1, 0], [3, 0]]]}"#);
    let (redundant, pair) = (text(&path("redundant.txt")).to_owned(), text(&path("pair.json")).to_owned());
    let (status, _, error) = ran(&["monodromy", &redundant, "--seed-pair", &pair, "--output", &start]);
    assert!(status == Some(2) && error.contains("pair.json"), "{error}");
    let (status, _, error) = ran(&["monodromy", &redundant, "--output", &start]);
    assert!(status == Some(0) && error.contains("2 solutions"), "{error}");

    write("special.txt", "parameters: a b\nx = a\nx = b\n");
    let (status, _, error) = ran(&["monodromy", text(&path("special.txt")), "--output", &start]);
    assert!(status == Some(1) && error.contains("no solution for generic parameters"), "{error}");
}

/// Roots and their negatives have the symmetries of a square, with its diagonals as blocks; those of a quintic with two free
/// coefficients have all permutations.
#[test]
fn permutations_of_solutions_are_told_on_request() {
    let directory = tempfile::tempdir().expect("directory");
    let path = |name: &str| text(&directory.path().join(name)).to_owned();
    let group = |equation: &str, more: &[&str]| {
        let (family, start) = (path("family.txt"), path("start.json"));
        std::fs::write(&family, format!("parameters: a b\n{equation}\n")).expect("written");
        let output = run("hc", &[&["monodromy", &family, "--output", &start], more].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{error}");
        let found: Value = serde_json::from_str(&std::fs::read_to_string(&start).expect("written")).expect("JSON");
        (found["monodromy_group"].clone(), error)
    };
    let (square, error) = group("x^4 + a*x^2 + b", &["--group", "12"]);
    assert!(error.contains("from 12 of 12 loops") && error.contains("which permutes blocks"), "{error}");
    assert_eq!((&square["orbits"], &square["symmetric"]), (&json!([[0, 1, 2, 3]]), &json!(false)));
    assert_eq!((square["blocks"][0].as_array().map(Vec::len), &square["loops"]), (Some(1), &json!(12)), "{square}");
    let (quintic, error) = group("x^5 + a*x + b", &["--group", "12"]);
    assert!(error.contains("all permutations of the solutions"), "{error}");
    assert_eq!((&quintic["blocks"], &quintic["symmetric"]), (&json!([[]]), &json!(true)));
    assert_eq!(group("x^5 + a*x + b", &[]).0, Value::Null);
}

/// Twelve solutions, `x` up to its sign and `y` up to third roots of one: two orbits of six, of which one is listed of
/// each. The start file is read back whole.
#[test]
fn solutions_are_listed_up_to_symmetry_on_request() {
    let directory = tempfile::tempdir().expect("directory");
    let path = |name: &str| text(&directory.path().join(name)).to_owned();
    let family = |symmetry: &str| {
        let equations = "equations = ['(x^2 - a)*(x^2 - b)', 'y^3 - c']";
        let content =
            format!("name = ''\nunknowns = ['x', 'y']\nparameters = ['a', 'b', 'c']\n{equations}\n{symmetry}\n");
        std::fs::write(path("family.toml"), content).expect("written");
        path("family.toml")
    };
    let third = "y*(-0.5 + 0.86602540378443864676*i)";
    let symmetric = family(&format!("symmetry = [['-x', 'y'], ['x', '{third}']]"));
    std::fs::write(path("target.json"), r#"{"parameters": [4, 9, 8]}"#).expect("written");
    let (start, target, solver) = (path("start.json"), path("target.json"), path("solver.rs"));
    let ran = |arguments: &[&str]| {
        let output = run("hc", arguments);
        let [out, error] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("UTF-8"));
        (output.status.code(), out, error)
    };
    let (status, _, error) = ran(&["monodromy", &symmetric, "--output", &start, "--up-to-symmetry"]);
    assert!(status == Some(0) && error.contains("12 solutions (2 up to symmetry) after"), "{error}");
    let file: Value = serde_json::from_str(&std::fs::read_to_string(&start).expect("written")).expect("JSON");
    assert_eq!((file["solutions"].as_array().map(Vec::len), &file["represents"]), (Some(2), &json!([6, 6])));
    let track = |more: &[&str]| {
        ran(&[&["track", &symmetric, "--start", &start, "--target", &target, "--json", "-"], more].concat())
    };
    let report = |json: &str| serde_json::from_str::<Value>(json).expect("JSON");
    let all = report(&track(&[]).1);
    assert_eq!((all["solutions"].as_array().map(Vec::len), &all["represents"]), (Some(12), &json!([])));
    let listed = report(&track(&["--up-to-symmetry"]).1);
    assert_eq!((listed["solutions"].as_array().map(Vec::len), &listed["represents"]), (Some(2), &json!([6, 6])));
    // The real ones of each orbit have y = 2, and x = 2 or x = 3 up to the sign.
    assert!([2.0, 3.0].iter().all(|x| [*x, -*x].iter().any(|x| has(&listed, &[*x, 2.0], 1e-9))), "{listed}");
    assert_eq!(ran(&["codegen", &symmetric, &start, "-o", &solver]).0, Some(0));
    assert!(std::fs::read_to_string(&solver).expect("written").contains("static SOLUTIONS: [[f64; 2]; 24]"));

    let (status, _, error) = ran(&["monodromy", &symmetric, "--output", &start, "--up-to-symmetry", "--group", "3"]);
    assert!(status == Some(2) && error.contains("cannot be used with"), "{error}");
    let plain = family("");
    for arguments in [
        vec!["monodromy", &plain, "--output", &solver, "--up-to-symmetry"],
        vec!["track", &plain, "--start", &start, "--target", &target, "--up-to-symmetry"],
    ] {
        let (status, _, error) = ran(&arguments);
        let is_named = error.contains("states no symmetry") || error.contains("stands for 6 of its orbit, but");
        assert!(status == Some(2) && is_named, "{error}");
    }
}
