//! `tdoa` with several candidates of a cell: columns `value2`, lines of one pair, and what is chosen.

use std::path::Path;

use end_to_end::{Folder, run, simulated};
use serde_json::Value;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

fn calibrated(file: &Path, truth: &Path, more: &[&str]) -> Value {
    let arguments = ["calibrate", text(file), "--truth", text(truth), "--dimensions", "2", "--json", "-"];
    let output = run("tdoa", &[&arguments, more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn the_right_candidates_are_chosen_and_told() {
    // 58 of 144 first candidates come by a detour; the direct ones are second.
    let (folder, file) = simulated(
        "--receivers 9 --transmitters 16 --noise 0.001 --detours 0.4 --detour-size 4 --candidates 2 --seed 5",
    );
    let truth = folder.path().join("receivers.csv");
    let table = std::fs::read_to_string(&file).expect("table");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("receiver,transmitter,value,value2"));
    // Of a detour the second candidate is earlier, of all others it is later.
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let number = |cell: &str| cell.parse::<f64>().expect("number");
    let mut late: Vec<(String, String)> = rows
        .iter()
        .filter(|row| number(row[3]) < number(row[2]))
        .map(|row| (row[0].to_string(), row[1].to_string()))
        .collect();
    assert_eq!((rows.len(), late.len()), (144, 58));

    let found = calibrated(&file, &truth, &[]);
    let rms = found.pointer("/truth/receiver_rms").and_then(Value::as_f64).expect("a comparison");
    assert!(rms < 0.01, "{rms}");
    assert_eq!(found["with_candidates"], 144);
    let name = |chosen: &Value, key: &str| chosen[key].as_str().expect("a name").to_string();
    let list = found["chosen"].as_array().expect("a list");
    let mut chosen: Vec<(String, String)> =
        list.iter().map(|c| (name(c, "receiver"), name(c, "transmitter"))).collect();
    // Candidates that differ by little more than the noise may be taken for each other.
    let close = |pair: &(String, String)| {
        let row = rows.iter().find(|row| row[0] == pair.0 && row[1] == pair.1).expect("a line");
        (number(row[2]) - number(row[3])).abs() < 0.01
    };
    late.retain(|pair| !close(pair));
    chosen.retain(|pair| !close(pair));
    assert_eq!(chosen, late);

    // The same as lines of one pair.
    let pairs: String =
        rows.iter().map(|row| format!("{0},{1},{2}\n{0},{1},{3}\n", row[0], row[1], row[2], row[3])).collect();
    let other = Folder::empty();
    let lines = other.write("lines.csv", format!("receiver,transmitter,value\n{pairs}"));
    let again = calibrated(&lines, &truth, &["--candidates"]);
    assert_eq!((&again["receivers"], &again["chosen"]), (&found["receivers"], &found["chosen"]));
    let refused = run("tdoa", &["calibrate", text(&lines)]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && said.contains("there twice") && said.contains("--candidates"), "{said}");

    let output = run("tdoa", &["calibrate", text(&file), "--dimensions", "2"]);
    let said = String::from_utf8_lossy(&output.stdout);
    let line = format!("candidates: of 144 measurements with several, {} take another than the first", list.len());
    assert!(said.contains(&line), "{said}");
}
