//! `tdoa locate`: new transmitters in a network that was calibrated, from a file and as they come.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use end_to_end::{program, run, run_on, simulated};

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// How far a line of JSON is from these coordinates.
fn off(line: &str, truth: &[f64]) -> f64 {
    position(line).iter().zip(truth).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Columns of a CSV matrix with these numbers, the first being 0, as a matrix.
fn columns(table: &str, numbers: std::ops::Range<usize>) -> String {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{}\n", cells[0], cells[numbers.clone()].join(","))
    };
    table.lines().map(row).collect()
}

/// A matrix as a list, one transmitter after the other.
fn list(table: &str) -> String {
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let mut list = String::from("receiver,event,range\n");
    for j in 1..rows[0].len() {
        rows[1..].iter().for_each(|row| list += &format!("{},{},{}\n", row[0], rows[0][j], row[j]));
    }
    list
}

/// The coordinates of a transmitter in a line of JSON.
fn position(line: &str) -> Vec<f64> {
    let inner = line.split("\"position\":[").nth(1).and_then(|rest| rest.split(']').next()).expect("a position");
    inner.split(',').map(|x| x.parse().expect("a number")).collect()
}

#[test]
fn new_transmitters_are_located_in_a_calibrated_network() {
    let (folder, file) = simulated("--receivers 10 --transmitters 30 --noise 0.01 --seed 4");
    let folder = folder.path();
    let table = std::fs::read_to_string(file).expect("measurements");
    let (known, new) = (columns(&table, 1..21), columns(&table, 21..31));
    let [known_file, new_file, network] = ["known.csv", "new.csv", "network.json"].map(|name| folder.join(name));
    std::fs::write(&known_file, known).expect("written");
    std::fs::write(&new_file, &new).expect("written");
    let truth = folder.join("receivers.csv");
    let calibrate = ["calibrate", text(&known_file), "--truth", text(&truth), "--json", text(&network)];
    assert!(run("tdoa", &calibrate).status.success());

    let output = run("tdoa", &["locate", text(&network), text(&new_file)]);
    let lines = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success() && lines.lines().count() == 10, "{lines}");
    let transmitters = std::fs::read_to_string(folder.join("transmitters.csv")).expect("truth");
    for (line, truth) in lines.lines().zip(transmitters.lines().skip(21)) {
        let truth: Vec<f64> = truth.split(',').skip(1).map(|x| x.parse().expect("a number")).collect();
        let off = off(line, &truth);
        // Far from all receivers a centimetre of noise is some more of place.
        assert!(off < 0.15 && line.contains("\"unique\":true"), "{off}: {line}");
    }
    // A list gives the same, as a file and from standard input; so does a matrix from there.
    for given in [list(&new), new] {
        let streamed = run_on("tdoa", &["locate", text(&network), "-"], &given);
        assert_eq!(String::from_utf8(streamed.stdout).expect("text"), lines);
    }
    // A receiver that is not there, a network that is none.
    let other = run_on("tdoa", &["locate", text(&network), "-"], "receiver,event,range\nr99,e,1.0\n");
    let said = String::from_utf8(other.stderr).expect("text");
    assert!(other.status.code() == Some(2) && said.contains("r99"), "{said}");
    let none = run("tdoa", &["locate", text(&new_file), text(&new_file)]);
    let said = String::from_utf8(none.stderr).expect("text");
    assert!(none.status.code() == Some(2) && said.contains("tdoa calibrate --json"), "{said}");
    // Measurements that fit no network.
    let wrong = std::fs::read_to_string(&network).expect("network").replace("\"fits\": true", "\"fits\": false");
    let wrong = wrong.replace("\"fits\":true", "\"fits\":false");
    std::fs::write(&network, wrong).expect("written");
    let refused = run("tdoa", &["locate", text(&network), text(&new_file)]);
    assert!(refused.status.code() == Some(1) && refused.stdout.is_empty());
}

/// A transmitter is located as soon as the next one begins, while the program waits for more.
#[test]
fn events_are_located_as_they_come() {
    let (folder, file) = simulated("--receivers 8 --transmitters 20 --noise 0.01 --seed 5");
    let network = folder.path().join("network.json");
    assert!(run("tdoa", &["calibrate", text(&file), "--json", text(&network)]).status.success());
    let table = std::fs::read_to_string(file).expect("measurements");
    let mut child = Command::new(program("tdoa"))
        .args(["locate", text(&network), "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let (mut input, mut output) =
        (child.stdin.take().expect("a pipe"), BufReader::new(child.stdout.take().expect("a pipe")));
    let list = list(&columns(&table, 1..4));
    let lines: Vec<&str> = list.lines().collect();
    let mut written = lines.iter().map(|line| format!("{line}\n"));
    // The header, the first transmitter, and the first measurement of the second.
    for line in written.by_ref().take(10) {
        input.write_all(line.as_bytes()).expect("written");
    }
    input.flush().expect("written");
    let mut first = String::new();
    output.read_line(&mut first).expect("a line");
    assert!(first.contains("\"transmitter\":\"s1\"") && first.contains("\"heard\":8"), "{first}");
    written.for_each(|line| input.write_all(line.as_bytes()).expect("written"));
    drop(input);
    assert_eq!(output.lines().count(), 2);
    assert!(child.wait().expect("the program ends").success());
}

/// New sounds of the same microphones, in a recording of another name.
#[test]
fn new_sounds_are_located() {
    let folder = end_to_end::Folder::empty();
    let folder = folder.path();
    let network = folder.join("network.json");
    let made = |name: &str, receivers: &str, transmitters: &str| {
        let output = folder.join(name);
        let more = ["--receivers", receivers, "--transmitters", transmitters, "--seed", "3", "--output", text(&output)];
        assert!(run("tdoa", &[&["simulate", "--sound"], &more[..]].concat()).status.success());
        (output.join("recording.wav"), output.join("receivers.csv"), output.join("transmitters.csv"))
    };
    let (first, truth, _) = made("first", "9", "16");
    let calibrate =
        ["calibrate", text(&first), "--temperature", "20", "--truth", text(&truth), "--json", text(&network)];
    assert!(run("tdoa", &calibrate).status.success());

    // Receivers are drawn first.
    let (second, same, transmitters) = made("second", "9", "20");
    assert_eq!(std::fs::read(truth).expect("truth"), std::fs::read(same).expect("truth"));
    let later = folder.join("later.wav");
    std::fs::rename(second, &later).expect("renamed");
    let output = run("tdoa", &["locate", text(&network), text(&later)]);
    let (lines, said) =
        (String::from_utf8(output.stdout).expect("text"), String::from_utf8(output.stderr).expect("text"));
    assert!(output.status.success() && lines.lines().count() == 20, "{said}");
    assert!(said.contains("343.2 m/s, as the network was calibrated") && said.contains("by their numbers"), "{said}");
    let transmitters = std::fs::read_to_string(transmitters).expect("truth");
    let mut moments = Vec::new();
    for (line, truth) in lines.lines().zip(transmitters.lines().skip(1)) {
        let truth: Vec<f64> = truth.split(',').skip(1).map(|x| x.parse().expect("a number")).collect();
        // Receivers are within 3 mm, and sounds at the edge of the room less well.
        assert!(off(line, &truth) < 0.02, "{}: {line}", off(line, &truth));
        let line: serde_json::Value = serde_json::from_str(line).expect("JSON");
        moments.push(line["seconds"].as_f64().expect("seconds"));
    }
    assert!(moments.is_sorted() && moments[0] > 0.0);

    // A network of ranges: a recording tells none.
    let (_kept, ranges) = simulated("--receivers 9 --transmitters 16 --ranges --noise 0.01");
    let of_ranges = folder.join("ranges.json");
    assert!(run("tdoa", &["calibrate", text(&ranges), "--ranges", "--json", text(&of_ranges)]).status.success());
    let refused = run("tdoa", &["locate", text(&of_ranges), text(&later)]);
    let said = String::from_utf8(refused.stderr).expect("text");
    assert!(refused.status.code() == Some(2) && said.contains("does not tell when"), "{said}");

    // Another number of channels, and a table beside a recording.
    let (other, ..) = made("other", "11", "3");
    for files in [vec![text(&other)], vec![text(&later), text(&network)]] {
        let refused = run("tdoa", &[&["locate", text(&network)], &files[..]].concat());
        assert_eq!(refused.status.code(), Some(2), "{files:?}");
    }
}
