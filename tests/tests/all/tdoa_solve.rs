//! `tdoa solve` as a user would run it: the JSON contract, and data that cannot determine the
//! network.

use end_to_end::run;
use serde_json::Value;
use std::path::Path;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// Exact pseudoranges of given positions, offsets 0, 1, 2.
fn matrix(receivers: &[[f64; 2]; 6], transmitters: &[[f64; 2]; 3]) -> String {
    let row = |r: &[f64; 2]| {
        let cell = |(j, s): (usize, &[f64; 2])| format!("{:?}", (r[0] - s[0]).hypot(r[1] - s[1]) + j as f64);
        transmitters.iter().enumerate().map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    receivers.iter().map(row).collect()
}

fn solve(content: &str) -> (Value, String, Option<i32>) {
    solve_with(content, &["--prove"])
}

fn solve_with(content: &str, options: &[&str]) -> (Value, String, Option<i32>) {
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join("pseudoranges.csv");
    std::fs::write(&file, content).expect("written");
    let output = run("tdoa", &[&["solve", text(&file), "--json", "-"], options].concat());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!message.contains("panicked"), "{message}");
    (serde_json::from_slice(&output.stdout).unwrap_or(Value::Null), message, output.status.code())
}

const TRANSMITTERS: [[f64; 2]; 3] = [[0.3, 2.1], [4.0, 0.7], [2.2, -1.9]];

#[test]
fn the_json_form_holds_every_network_that_fits() {
    let receivers = [[0.0, 0.0], [3.1, 0.4], [1.2, 2.7], [4.4, 3.3], [-0.8, 1.9], [2.5, -2.6]];
    let (json, message, status) = solve(&matrix(&receivers, &TRANSMITTERS));
    assert_eq!(status, Some(0), "{message}");
    assert_eq!((&json["configuration"], &json["solver"]), (&Value::from("6r/3s"), &Value::from("6r/3s")));
    let proofs = &json["proofs"];
    assert_eq!((&proofs["proved"], &proofs["unseparated"]), (&180.into(), &0.into()), "{message}");
    assert_eq!(proofs["real"], json["counts"]["real"], "{message}");
    // 180 is the degree of the saturated ideal, computed exactly over a prime field.
    for (field, count) in [("tracked", 180), ("finite", 180), ("failed", 0), ("at_infinity", 0)] {
        assert_eq!(json["paths"][field], count, "{field}");
    }
    assert_eq!(json["counts"]["complex"], 180);
    let solutions = json["solutions"].as_array().unwrap();
    let distance = |a: &Value, b: &Value| {
        (a[0].as_f64().unwrap() - b[0].as_f64().unwrap()).hypot(a[1].as_f64().unwrap() - b[1].as_f64().unwrap())
    };
    // Distances between receivers do not depend on the frame.
    let truth = solutions.iter().find(|s| {
        s["physical"] == true
            && (0..6).all(|i| {
                let expected = receivers[i][0].hypot(receivers[i][1]);
                (distance(&s["receivers"][i], &s["receivers"][0]) - expected).abs() < 1e-9
            })
    });
    let truth = truth.expect("the true network is among the solutions");
    for j in 0..3 {
        assert!((truth["offsets"][j].as_f64().unwrap() - j as f64).abs() < 1e-9);
    }
    assert!(truth["residual"].as_f64().unwrap() < 1e-12 && truth["condition"].as_f64().unwrap() > 1.0);
}

#[test]
fn nodes_in_one_line_are_named_and_all_mirror_images_listed() {
    let line = [0, 1, 2, 3, 4, 5].map(|i| [f64::from(i), 0.3 * f64::from(i)]);
    let receivers = [[0.0, 0.0], [3.1, 0.4], [1.2, 2.7], [4.4, 3.3], [-0.8, 1.9], [2.5, -2.6]];
    let cases = [
        (
            matrix(&line, &TRANSMITTERS),
            "receivers r1, r2, r3, r4, r5, r6 lie exactly in one line",
            "move some receivers",
            3,
        ),
        (
            matrix(&receivers, &[[0.0, 1.0], [1.0, 1.5], [3.0, 2.5]]),
            "transmitters s1, s2, s3 lie exactly in one line",
            "move some transmitters",
            6,
        ),
    ];
    for (measured, named, remedy, others) in cases {
        let (json, message, status) = solve(&measured);
        assert_eq!(status, Some(1), "{message}");
        assert!(message.contains(named) && message.contains(remedy), "{message}");
        let warnings = json["warnings"].as_array().unwrap();
        assert!(warnings.iter().any(|warning| warning.as_str().unwrap().contains(named)), "{warnings:?}");
        // Each node off the line on either side, but for the mirror image of the whole.
        let fits = |s: &&Value| s["physical"] == true && s["residual"].as_f64().unwrap() < 1e-12;
        assert!(json["solutions"].as_array().unwrap().iter().filter(fits).count() >= 1 << (others - 1), "{json}");
    }
}

#[test]
fn sizes_without_a_solution_name_those_with_one() {
    let (_, message, status) = solve("2,3,4,4\n1,2,3,4\n3,3,3,1\n4,1,2,2\n");
    assert_eq!(status, Some(1), "{message}");
    assert!(
        message.contains("4r/4s is underdetermined") && message.contains("6 receivers with 3 transmitters"),
        "{message}"
    );
}

#[test]
fn every_physical_network_is_written_in_the_frame() {
    let receivers = [[0.0, 0.0], [3.1, 0.4], [1.2, 2.7], [4.4, 3.3], [-0.8, 1.9], [2.5, -2.6]];
    let directory = tempfile::tempdir().expect("directory");
    let [file, svg, nodes] = ["pseudoranges.csv", "n.svg", "n.csv"].map(|name| directory.path().join(name));
    std::fs::write(&file, matrix(&receivers, &TRANSMITTERS)).expect("written");
    let command = |frame: &'static str| {
        let files = ["--json", "-", "--svg", text(&svg), "--nodes", text(&nodes)];
        run("tdoa", &[&["solve", text(&file), "--frame", frame], &files[..]].concat())
    };
    let output = command("r2,s1,r4");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let solutions = found["solutions"].as_array().expect("solutions");
    for solution in solutions {
        let at = |kind: &str, i: usize, k: usize| solution[kind][i][k].as_f64().expect("number");
        let zero = [at("receivers", 1, 0), at("receivers", 1, 1), at("transmitters", 0, 1)];
        assert!(zero.iter().all(|x| x.abs() < 1e-9), "{zero:?}");
        assert!(at("transmitters", 0, 0) > 0.0 && at("receivers", 3, 1) > 0.0);
    }
    // Each physical network has six receivers and three transmitters, in the table and, with a legend, in the picture.
    let physical = solutions.iter().filter(|solution| solution["physical"] == true).count();
    let [picture, table] = [&svg, &nodes].map(|path| std::fs::read_to_string(path).expect("file"));
    assert!(physical > 0 && table.starts_with("network,kind,name,x,y,offset\n"));
    assert_eq!(table.lines().count(), 1 + 9 * physical);
    assert_eq!(picture.matches("class=\"receiver\"").count(), 1 + 6 * physical);
    for (frame, part) in [("r1,r2,r3,r4", "give three"), ("r1,r2,r9", "no node is named \"r9\"")] {
        let output = command(frame);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(part), "{said}");
    }
}

/// Exact distances of given positions.
fn ranges<const D: usize>(receivers: &[[f64; D]], transmitters: &[[f64; D]]) -> String {
    ranges_with(0.0, receivers, transmitters)
}

/// Exact distances of given positions, and a constant.
fn ranges_with<const D: usize>(constant: f64, receivers: &[[f64; D]], transmitters: &[[f64; D]]) -> String {
    let distance = |r: &[f64; D], s: &[f64; D]| r.iter().zip(s).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let row = |r: &[f64; D]| {
        transmitters.iter().map(|s| format!("{:?}", distance(r, s) + constant)).collect::<Vec<_>>().join(",")
    };
    receivers.iter().map(|r| row(r) + "\n").collect()
}

/// Networks of the smallest sizes by their ranges alone, with one unknown constant or without: the true one is among those
/// listed, and roots are as many as theory says: all four constants of this 5r/5s are real.
#[test]
fn ranges_of_the_smallest_sizes() {
    let places =
        [[0.0, 0.0, 0.2], [3.1, 0.4, 1.9], [1.2, 2.7, 0.6], [4.4, 3.3, -1.1], [-0.8, 1.9, 2.3], [2.5, -2.6, 1.4]];
    let others =
        [[0.3, 2.1, 1.0], [4.0, 0.7, -0.4], [2.2, -1.9, 2.8], [1.6, 3.9, 0.1], [-1.5, -0.9, 1.7], [3.3, 1.5, 3.1]];
    let flat = |p: &[f64; 3]| [p[0], p[1]];
    let [plane, other_plane] = [&places, &others].map(|all| all.each_ref().map(flat));
    let constant = -7.25;
    let cases = [
        ("2", "known", "3r/3s", 8, ranges(&plane[..3], &other_plane[..3])),
        ("3", "known", "4r/6s", 38, ranges(&places[..4], &others)),
        ("3", "known", "6r/4s", 38, ranges(&places, &others[..4])),
        ("3", "known", "5r/5s", 42, ranges(&places[..5], &others[..5])),
        ("2", "constant", "3r/4s", 43, ranges_with(constant, &plane[..3], &other_plane[..4])),
        ("2", "constant", "4r/3s", 43, ranges_with(constant, &plane[..4], &other_plane[..3])),
        ("3", "constant", "5r/5s", 168, ranges_with(constant, &places[..5], &others[..5])),
    ];
    for (dimensions, emissions, size, roots, table) in cases {
        let (json, message, status) =
            solve_with(&table, &["--emissions", emissions, "--dimensions", dimensions, "--prove"]);
        assert_eq!(status, Some(0), "{size}: {message}");
        assert_eq!((&json["solver"], &json["emissions"]), (&Value::from(size), &Value::from(emissions)));
        assert_eq!((&json["counts"]["complex"], &json["proofs"]["proved"]), (&roots.into(), &roots.into()), "{size}");
        let number = |value: &Value| value.as_f64().unwrap();
        let apart = |a: &Value, b: &Value| {
            let pairs = a.as_array().unwrap().iter().zip(b.as_array().unwrap());
            pairs.map(|(a, b)| (number(a) - number(b)).powi(2)).sum::<f64>().sqrt()
        };
        let solutions = json["solutions"].as_array().unwrap();
        let plane = dimensions == "2";
        let between = |i: usize| {
            let [a, b] = [places[i], places[0]].map(|p| if plane { [p[0], p[1], 0.0] } else { p });
            a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let is_true = |s: &&Value| {
            let receivers = s["receivers"].as_array().unwrap();
            receivers.iter().enumerate().all(|(i, r)| (apart(r, &receivers[0]) - between(i)).abs() < 1e-8)
        };
        let truth = solutions.iter().find(is_true).unwrap_or_else(|| panic!("{size}: {json}"));
        let offset = if emissions == "known" { 0.0 } else { constant };
        let mut offsets = truth["offsets"].as_array().unwrap().iter();
        assert!(
            number(&truth["residual"]) < 1e-12 && offsets.all(|o| (number(o) - offset).abs() < 1e-8),
            "{size}: {truth}"
        );
    }
}

#[test]
fn what_is_no_table_of_ranges_is_said() {
    let all = [[0.3, 2.1, 1.0], [4.0, 0.7, -0.4], [2.2, -1.9, 2.8], [1.6, 3.9, 0.1], [-1.5, -0.9, 1.7]];
    let small = ranges(&all[..4], &all);
    let (_, message, status) = solve_with(&small, &["--ranges", "--dimensions", "3"]);
    assert_eq!(status, Some(1), "{message}");
    assert!(message.contains("6 receivers with 4 transmitters, 5 with 5, and 4 with 6"), "{message}");
    let (_, message, status) = solve_with(&ranges(&all[..4], &all), &["--emissions", "constant", "--dimensions", "3"]);
    assert_eq!(status, Some(1), "{message}");
    assert!(message.contains("7 receivers with 4 transmitters, 5 with 5, and 4 with 7"), "{message}");
    let (_, message, status) = solve_with("1,2,3\n2,-1.5,2\n3,1,2.5\n", &["--ranges"]);
    assert_eq!(status, Some(1), "{message}");
    assert!(message.contains("the range of receiver r2 and transmitter s2 is negative (-1.5 m)"), "{message}");
}
