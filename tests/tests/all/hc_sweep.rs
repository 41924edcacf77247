//! `hc sweep`, as a user would run it.

use end_to_end::{Folder, root, run};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A family and its fibre.
fn prepared(folder: &Folder, family: &str) -> (PathBuf, PathBuf) {
    let family = folder.write("family.txt", family);
    let start = folder.path().join("start.json");
    let output = run("hc", &["monodromy", text(&family), "--output", text(&start)]);
    assert!(output.status.success(), "{}", said(&output));
    (family, start)
}

const CUBIC: &str = "parameters: a b\nx^3 + a*x + b = 0\n";

/// The lines of a CSV file below its heading.
fn lines(table: &str) -> Vec<Vec<&str>> {
    table.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

/// Every cell of the parametric oscillator against the closed form of its states; the same bytes on any number of threads.
#[test]
fn states_of_the_parametric_oscillator() {
    let folder = Folder::empty();
    let family = root().join("examples/families/parametron.toml");
    let start = folder.path().join("start.json");
    let output = run("hc", &["monodromy", text(&family), "--output", text(&start)]);
    assert!(output.status.success(), "{}", said(&output));
    let files = |name: &str| ["csv", "svg", "json"].map(|end| folder.path().join(format!("{name}.{end}")));
    let sweep = |name: &str, threads: &str| {
        let [table, svg, json] = files(name);
        let grids = ["--grid", "w=0.9:1.1:50", "--grid", "l=0.001:0.1:40", "--set", "g=0.01", "--threads", threads];
        let outputs = ["--table", text(&table), "--svg", text(&svg), "--json", text(&json)];
        run("hc", &[&["sweep", text(&family), text(&start)], &grids[..], &outputs[..]].concat())
    };
    let output = sweep("one", "1");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let summary = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(summary.starts_with("parametric oscillator: 50 x 40 cells in w and l, 5 solutions"), "{summary}");
    let [table, svg, json] = files("one").map(|file| std::fs::read_to_string(file).expect("written"));
    let rows = lines(&table);
    assert_eq!(
        (rows.len(), table.lines().next()),
        (2000, Some("w,l,real,positive,complex,at_infinity,standing,reason"))
    );
    let mut cells_of = [0; 6];
    for row in &rows {
        let [w, l] = [0, 1].map(|k: usize| row[k].parse::<f64>().expect("a number"));
        let (d, rest) = (1.0 - w * w, l * l - (0.01 * w).powi(2));
        let squares = if rest > 0.0 { [-d - rest.sqrt(), -d + rest.sqrt()] } else { [-1.0; 2] };
        let states = 1 + 2 * squares.iter().filter(|r| **r > 0.0).count();
        assert_eq!(row[2], states.to_string(), "w = {w}, l = {l}");
        assert!(["counted", "certified"].contains(&row[6]), "{row:?}");
        cells_of[states] += 1;
    }
    // The summary has a line for each number of real and of positive states.
    let mut summed = [0; 6];
    for line in summary.lines().filter(|line| line.contains(" positive")) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [cells, states] = [0, 3].map(|k: usize| words[k].parse::<usize>().expect("a number"));
        summed[states] += cells;
    }
    assert!(summed == cells_of && [1, 3, 5].iter().all(|&states| cells_of[states] > 0), "{summary}");
    assert!(svg.starts_with("<svg") && svg.contains("class=\"fold\"") && svg.contains("5 real solutions"));
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&json["format"], &json["doubtful"], &json["fibre"]), (&1.into(), &0.into(), &5.into()));
    assert_eq!(json["cells"].as_array().map(Vec::len), Some(2000));
    assert!(json["breaks"].as_array().expect("a list").iter().all(|b| b["kind"] == "fold"));
    let other = sweep("two", "2");
    assert_eq!(other.status.code(), Some(0), "{}", said(&other));
    let [other_table, other_svg, other_json] = files("two").map(|file| std::fs::read_to_string(file).expect("written"));
    assert!(other_table == table && other_svg == svg);
    let mut other: Value = serde_json::from_str(&other_json).expect("JSON");
    other["seconds"] = json["seconds"].clone();
    assert_eq!(other, json);
}

/// Three solutions between the folds of `x^3 - 3 x + b` at -2 and 2, one outside.
#[test]
fn branches_over_one_parameter() {
    let folder = Folder::empty();
    let (family, start) = prepared(&folder, CUBIC);
    let (svg, branches) = (folder.path().join("out.svg"), folder.path().join("branches.csv"));
    let arguments = ["sweep", text(&family), text(&start), "--grid", "b=-4.1:4.1:42", "--set", "a=-3"];
    let outputs = ["--svg", text(&svg), "--branches", text(&branches)];
    let output = run("hc", &[&arguments[..], &outputs].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let summary = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        summary.contains("3 branches; folds between 2 pairs of cells, branches to infinity between 0"),
        "{summary}"
    );
    let picture = std::fs::read_to_string(&svg).expect("written");
    assert_eq!(picture.matches("class=\"branch\"").count(), 3);
    assert_eq!(picture.matches("class=\"fold\"").count(), 2);
    let table = std::fs::read_to_string(&branches).expect("written");
    assert_eq!(table.lines().next(), Some("b,branch,multiplicity,x"));
    for row in lines(&table) {
        let [b, x] = [0, 3].map(|k: usize| row[k].parse::<f64>().expect("a number"));
        assert!((x.powi(3) - 3.0 * x + b).abs() < 1e-12 && row[2] == "1");
    }
    // 20 of 42 values lie between the folds: -1.9, -1.7, ..., 1.9.
    assert_eq!(lines(&table).len(), 42 + 2 * 20);
}

#[test]
fn a_cell_that_is_not_shown_is_said() {
    let folder = Folder::empty();
    // For a = b = 0 all (0, y) are solutions.
    let (family, start) = prepared(&folder, "parameters: a b\nx*y = a\nx*(y + 1) = b\n");
    let table = folder.path().join("table.csv");
    let arguments = ["sweep", text(&family), text(&start), "--grid", "a=-1:1:3", "--grid", "b=-2:2:3"];
    let output = run("hc", &[&arguments[..], &["--table", text(&table)]].concat());
    let message = said(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the number of real solutions is not shown in 1 cell"), "{message}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("warning: a = 0, b = 0: 1 path on a set of solutions"));
    let table = std::fs::read_to_string(&table).expect("written");
    let doubtful: Vec<&str> = table.lines().filter(|line| line.contains("doubtful")).collect();
    assert_eq!(doubtful.len(), 1);
    assert!(doubtful[0].starts_with("0,0,"), "{doubtful:?}");
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let folder = Folder::empty();
    let (family, start) = prepared(&folder, CUBIC);
    let refused = |more: &[&str]| {
        let output = run("hc", &[&["sweep", text(&family), text(&start)], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", said(&output));
        said(&output)
    };
    for (arguments, words) in [
        (vec!["--grid", "c=0:1:5", "--set", "a=1", "--set", "b=1"], "`c` is no parameter of the family"),
        (vec!["--grid", "a=0:1:5"], "no value for b"),
        (vec!["--grid", "a=0:1:5", "--set", "b=1", "--set", "b=2"], "b is given twice"),
        (vec!["--grid", "a=0:1:0", "--set", "b=1"], "0 values on the axis"),
        (vec!["--grid", "a=1:1:5", "--set", "b=1"], "begins and ends at 1"),
        (vec!["--grid", "a=nan:1:5", "--set", "b=1"], "`nan` is not a finite number"),
        (vec!["--grid", "a=0:1:5", "--set", "b=inf"], "`inf` is not a finite number"),
        (vec!["--grid", "a=0:1", "--set", "b=1"], "expected NAME=FROM:TO:COUNT"),
        (vec!["--grid", "a=0:1:2", "--grid", "b=0:1:2", "--grid", "a=0:1:2"], "one axis or two"),
        (vec!["--grid", "a=0:1:4000", "--grid", "b=0:1:4000"], "4000 x 4000 cells; 10000000 are the most"),
        (vec!["--grid", "a=0:1:18446744073709551615", "--set", "b=1"], "not told apart"),
        (vec!["--grid", "a=0:1:5", "--set", "b=1", "--unknown", "y"], "`y` is no unknown"),
        (vec!["--set", "b=1"], "--grid"),
    ] {
        let message = refused(&arguments);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
    let grid = ["--grid", "a=0:1:5", "--set", "b=1"];
    for option in ["--json", "--table", "--svg", "--branches"] {
        let message = refused(&[&grid[..], &[option, text(&start)]].concat());
        assert!(message.contains("would overwrite it"), "{message}");
        let message = refused(&[&grid[..], &[option, "no/such/folder/out"]].concat());
        assert!(message.contains("check that the directory exists"), "{message}");
    }
    let complex = folder.write("complex.txt", "parameters: a b\nx^3 + a*x + i*b = 0\n");
    let started = folder.path().join("complex.json");
    let made = run("hc", &["monodromy", text(&complex), "--output", text(&started)]);
    assert!(made.status.success(), "{}", said(&made));
    let output = run("hc", &[&["sweep", text(&complex), text(&started)], &grid[..]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("coefficients that are not real"), "{}", said(&output));
}
