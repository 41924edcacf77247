//! `tdoa solve --dimensions 3` as a user would run it.

use std::path::Path;

use end_to_end::{run, simulated};
use serde_json::Value;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// What `tdoa solve --dimensions 3` says of a file: JSON, if any, messages, and the exit status.
fn solve(file: &Path, words: &[&str]) -> (Value, String, Option<i32>) {
    let output = run("tdoa", &[&["solve", text(file), "--dimensions", "3", "--json", "-"], words].concat());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!message.contains("panicked"), "{message}");
    (serde_json::from_slice(&output.stdout).unwrap_or(Value::Null), message, output.status.code())
}

/// The same of exact measurements of these nodes.
fn solve_nodes(receivers: &[[f64; 3]], transmitters: &[[f64; 3]]) -> (Value, String, Option<i32>) {
    let distance = |r: &[f64; 3], s: &[f64; 3]| (0..3).map(|k| (r[k] - s[k]).powi(2)).sum::<f64>().sqrt();
    let row = |r: &[f64; 3]| {
        let cell = |(j, s): (usize, &[f64; 3])| format!("{:?}", distance(r, s) + j as f64);
        transmitters.iter().enumerate().map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join("pseudoranges.csv");
    std::fs::write(&file, receivers.iter().map(row).collect::<String>()).expect("written");
    solve(&file, &[])
}

/// Numbers of a table of positions with names before them.
fn positions(file: &Path) -> Vec<[f64; 3]> {
    let table = std::fs::read_to_string(file).expect("positions");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').skip(1).map(|x| x.parse().expect("number")).collect();
        numbers.try_into().expect("three coordinates")
    };
    table.lines().skip(1).map(row).collect()
}

/// Positions of some nodes, metres.
type Nodes<'a> = &'a [[f64; 3]];

const RECEIVERS: [[f64; 3]; 9] = [
    [0.0, 0.1, 2.4],
    [4.0, 0.0, 1.9],
    [0.2, 5.0, 1.1],
    [3.8, 4.7, 2.5],
    [2.1, 0.3, 0.2],
    [0.1, 2.6, 0.5],
    [3.9, 2.2, 0.8],
    [1.8, 4.9, 2.2],
    [2.0, 1.0, 1.3],
];
const TRANSMITTERS: [[f64; 3]; 5] =
    [[1.0, 1.0, 1.0], [3.0, 1.5, 0.4], [2.5, 4.0, 1.7], [0.5, 3.0, 0.9], [1.7, 2.2, 2.2]];

#[test]
fn the_network_is_found_with_three_coordinates() {
    for (receivers, transmitters, solver) in [
        (9, 5, "9r/5s"),
        (10, 8, "9r/5s"),
        (15, 30, "9r/5s"),
        (7, 6, "7r/6s"),
        (6, 8, "6r/8s"),
        (8, 12, "7r/6s"),
        (8, 5, "8r/5s"),
    ] {
        let size = format!("--receivers {receivers} --transmitters {transmitters}");
        let (directory, file) = simulated(&format!("{size} --dimensions 3 --seed 7"));
        let (found, message, status) = solve(&file, &[]);
        assert_eq!((status, &found["dimensions"], &found["solver"]), (Some(0), &3.into(), &solver.into()), "{message}");
        let solutions = found["solutions"].as_array().expect("solutions");
        assert_eq!((solutions.len(), &solutions[0]["physical"]), (1, &true.into()), "{size}");
        // Distances between receivers do not depend on the frame.
        let truth = positions(&directory.path().join("receivers.csv"));
        let place = |i: usize| [0, 1, 2].map(|k| solutions[0]["receivers"][i][k].as_f64().expect("three coordinates"));
        let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        for (i, r) in truth.iter().enumerate() {
            assert!((distance(place(i), place(0)) - distance(*r, truth[0])).abs() < 1e-8, "{size}, receiver {i}");
        }
        assert!(solutions[0]["residual"].as_f64().expect("number") < 1e-12, "{size}");
        let table = String::from_utf8(run("tdoa", &["solve", text(&file), "--dimensions", "3"]).stdout).expect("UTF-8");
        let last = table.lines().find(|line| line.starts_with("receiver       r6")).expect("a receiver");
        assert_eq!(last.split_whitespace().count(), 5, "{table}");
    }
}

/// One of the networks of a smallest size is the true one, and only physical ones with real positions fit.
#[test]
fn all_networks_of_a_smallest_size_are_listed() {
    let (directory, file) = simulated("--receivers 7 --transmitters 5 --dimensions 3 --seed 7");
    let (found, message, status) = solve(&file, &[]);
    assert_eq!(
        (status, &found["solver"], &found["paths"]["finite"]),
        (Some(0), &"7r/5s".into(), &2321.into()),
        "{message}"
    );
    let truth = positions(&directory.path().join("receivers.csv"));
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let is_true = |solution: &&Value| {
        let place = |i: usize| [0, 1, 2].map(|k| solution["receivers"][i][k].as_f64().expect("three coordinates"));
        (0..7).all(|i| (distance(place(i), place(0)) - distance(truth[i], truth[0])).abs() < 1e-7)
    };
    let solutions = found["solutions"].as_array().expect("solutions");
    assert_eq!(solutions.iter().filter(is_true).count(), 1, "{found}");
    // They come in pairs.
    assert_eq!(found["counts"]["positive_definite"].as_u64().map(|count| count % 2), Some(0), "{found}");
    let (_, message, status) = solve(&file, &["--start", "polyhedral"]);
    assert!(status == Some(1) && message.contains("leave out the polyhedral start"), "{message}");
}

/// All roots of a member of a family whose trace test passed are proved, and as many real as are counted real.
#[test]
fn roots_are_proved_on_demand() {
    for (size, roots) in [("--receivers 8 --transmitters 5", 256), ("--receivers 8 --transmitters 6", 0)] {
        let (_directory, file) = simulated(&format!("{size} --dimensions 3 --seed 7"));
        let (found, message, status) = solve(&file, &["--prove"]);
        if roots == 0 {
            assert!(status == Some(1) && message.contains("8r/6s is solved without paths"), "{message}");
            assert_eq!((found["proofs"].is_null(), &found["counts"]["physical"]), (true, &1.into()), "{message}");
            continue;
        }
        let proofs = &found["proofs"];
        assert_eq!((status, &proofs["roots"], &proofs["proved"]), (Some(0), &roots.into(), &roots.into()), "{message}");
        assert_eq!((&proofs["unseparated"], &proofs["real"]), (&0.into(), &found["counts"]["real"]), "{message}");
        assert!(solve(&file, &[]).0["proofs"].is_null());
    }
}

#[test]
fn the_plane_is_the_default_and_says_where_space_is() {
    let (_directory, file) = simulated("--receivers 9 --transmitters 5 --dimensions 3 --seed 3");
    let output = run("tdoa", &["solve", text(&file)]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("--dimensions 3 looks there"), "{message}");
    let output = run("tdoa", &["solve", text(&file), "--dimensions", "4"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn nodes_in_special_position_are_named() {
    let flat = |nodes: &[[f64; 3]]| nodes.iter().map(|p| [p[0], p[1], 1.0]).collect::<Vec<_>>();
    let line = |nodes: &[[f64; 3]]| nodes.iter().map(|p| [p[1], 2.0 * p[1], 0.3 * p[1]]).collect::<Vec<_>>();
    let in_plane = "all receivers or all transmitters lie in one plane (or line)";
    let mut four = TRANSMITTERS;
    four[1..].iter_mut().for_each(|s| s[2] = 0.7);
    let mut twin = RECEIVERS.to_vec();
    twin[6] = twin[2];
    let nine = RECEIVERS.map(|p| [p[1], p[2] + 0.3, p[0]]);
    let nearly = RECEIVERS.iter().enumerate().map(|(i, p)| [p[0], p[1], 1.0 + 1e-6 * i as f64]).collect::<Vec<_>>();
    let cases: [(Nodes, Nodes, &str); 12] = [
        (&flat(&RECEIVERS), &TRANSMITTERS, in_plane),
        (&RECEIVERS, &flat(&TRANSMITTERS), in_plane),
        (&flat(&RECEIVERS), &flat(&TRANSMITTERS), in_plane),
        (&line(&RECEIVERS), &TRANSMITTERS, in_plane),
        (&RECEIVERS, &line(&TRANSMITTERS), in_plane),
        (&RECEIVERS, &four, "transmitters s2, s3, s4, s5 lie in one plane"),
        (&twin, &TRANSMITTERS, "receivers r3 and r7 measure the same"),
        (&RECEIVERS[..5], &nine, "5r/9s is not solved exactly in space"),
        (&flat(&RECEIVERS)[..8], &TRANSMITTERS, in_plane),
        (&[&RECEIVERS[..], &[[1.1, 3.3, 1.9]]].concat(), &flat(&TRANSMITTERS[..4]), in_plane),
        (&RECEIVERS[..6], &TRANSMITTERS, "6r/5s is underdetermined in space"),
        (&nearly, &TRANSMITTERS, "lie in one plane"),
    ];
    for (receivers, transmitters, named) in cases {
        let (_, message, status) = solve_nodes(receivers, transmitters);
        assert!(status == Some(1) && message.contains(named), "{named}: {status:?}, {message}");
    }
}

#[test]
fn wrong_and_noisy_measurements_are_no_network() {
    let (_directory, file) = simulated("--receivers 12 --transmitters 7 --dimensions 3 --noise 0.0001 --seed 5");
    let (_, message, status) = solve(&file, &[]);
    assert_eq!(status, Some(1), "{message}");
    assert!(message.contains("calibrate"), "{message}");
    // With the noise as tolerance, a share of about ten metres.
    let (found, message, status) = solve(&file, &["--tolerance", "0.0001"]);
    assert_eq!(status, Some(0), "{message}");
    assert!(found["solutions"][0]["residual"].as_f64().expect("number") < 2e-4, "{found}");
    // One wrong measurement.
    let (_directory, file) = simulated("--receivers 12 --transmitters 7 --dimensions 3 --seed 5");
    let table = std::fs::read_to_string(&file).expect("table");
    let mut lines: Vec<String> = table.lines().map(str::to_owned).collect();
    let mut cells: Vec<String> = lines[4].split(',').map(str::to_owned).collect();
    cells[3] = (cells[3].parse::<f64>().expect("number") + 1.0).to_string();
    lines[4] = cells.join(",");
    std::fs::write(&file, lines.join("\n")).expect("written");
    let (_, message, status) = solve(&file, &[]);
    assert!(status == Some(1) && message.contains("calibrate"), "{message}");
}
