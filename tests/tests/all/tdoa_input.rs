//! What users bring to `tdoa`: other units, spellings and orders, names that do not match, heights,
//! several matrices in a file.

use std::path::Path;

use end_to_end::{Folder, root, run};
use serde_json::Value;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// What a run printed, said and ended with.
struct Ran {
    out: String,
    message: String,
    status: Option<i32>,
}

fn tdoa(arguments: &[&str]) -> Ran {
    let output = run("tdoa", arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!message.contains("panicked"), "{message}");
    Ran { out: String::from_utf8_lossy(&output.stdout).into_owned(), message, status: output.status.code() }
}

fn json(arguments: &[&str]) -> Value {
    let ran = tdoa(&[arguments, &["--json", "-"]].concat());
    assert_eq!(ran.status, Some(0), "{}", ran.message);
    serde_json::from_str(&ran.out).expect("JSON")
}

/// Refused with status 2 and these words.
fn refused(arguments: &[&str], parts: &[&str]) {
    let ran = tdoa(arguments);
    assert_eq!(ran.status, Some(2), "{}{}", ran.out, ran.message);
    for part in parts {
        assert!(ran.message.contains(part), "{part:?} is not in: {}", ran.message);
    }
}

fn example(name: &str) -> String {
    std::fs::read_to_string(root().join("examples/network").join(name)).expect("example")
}

/// The cells of a table with commas.
fn cells(table: &str) -> Vec<Vec<String>> {
    table.lines().map(|line| line.split(',').map(str::to_string).collect()).collect()
}

fn with(separator: &str, rows: &[Vec<String>]) -> String {
    rows.iter().map(|row| row.join(separator) + "\n").collect()
}

/// The example as a list with columns in this order: receiver, transmitter, value.
fn list(header: &str, order: [usize; 3], separator: &str) -> String {
    let rows = cells(&example("pseudoranges.csv"));
    let mut all = format!("{header}\n");
    for row in &rows[1..] {
        for (name, value) in rows[0][1..].iter().zip(&row[1..]) {
            let measurement = [&row[0], name, value];
            all += &(order.map(|k| measurement[k].as_str()).join(separator) + "\n");
        }
    }
    all
}

#[test]
fn all_units_give_one_network() {
    let folder = Folder::empty();
    let speed = 343.0;
    let size = ["--receivers", "8", "--transmitters", "10", "--noise", "0.001", "--seed", "4"];
    let found: Vec<Value> = ["m", "s", "ms", "us", "ns", "samples", "cm", "km"]
        .into_iter()
        .map(|unit| {
            let units: &[&str] = match unit {
                "m" | "cm" | "km" => &["--units", unit],
                "samples" => &["--units", "samples", "--rate", "48000", "--speed", "343"],
                unit => &["--units", unit, "--speed", "343"],
            };
            let output = folder.path().join(unit);
            let made = tdoa(&[&["simulate"], &size[..], units, &["--output", text(&output)]].concat());
            assert_eq!(made.status, Some(0), "{}", made.message);
            json(&[&["calibrate", text(&output.join("pseudoranges.csv"))], units].concat())
        })
        .collect();
    let number = |value: &Value| value.as_f64().expect("number");
    // One of each unit in metres.
    for (other, metres) in
        found[1..].iter().zip([speed, 1e-3 * speed, 1e-6 * speed, 1e-9 * speed, speed / 48000.0, 0.01, 1e3])
    {
        for i in 0..8 {
            for k in 0..2 {
                let (a, b) = (number(&found[0]["receivers"][i][k]), number(&other["receivers"][i][k]));
                // The tables are rounded to micrometres, or as finely in their unit.
                assert!((a - b).abs() < 1e-4, "{a} {b}");
            }
        }
        for j in 0..10 {
            let (offset, in_units) = (number(&other["offsets"][j]), number(&other["offsets_in_units"][j]));
            assert!((in_units * metres - offset).abs() < 1e-9 * offset.abs().max(1.0), "{offset} {in_units}");
        }
    }
    assert!(found[0].get("offsets_in_units").is_none() && found[0].get("units").is_none());
    assert_eq!(found[2]["units"]["name"], "ms");
    // The summary has the unit's column, the table of true offsets too.
    let table = folder.path().join("ms/pseudoranges.csv");
    let shown = tdoa(&["calibrate", text(&table), "--units", "ms", "--speed", "343"]);
    assert!(shown.out.contains("offset ms"), "{}", shown.out);
    let offsets = std::fs::read_to_string(folder.path().join("ms/offsets.csv")).expect("offsets");
    assert!(offsets.starts_with("id,offset,offset_ms\n"), "{offsets}");
}

#[test]
fn solve_takes_units_too() {
    let folder = Folder::empty();
    let output = folder.path().join("made");
    let units = ["--units", "us", "--speed", "299792458"];
    let size = ["--receivers", "6", "--transmitters", "3"];
    let made = tdoa(&[&["simulate"], &size[..], &units, &["--output", text(&output)]].concat());
    assert_eq!(made.status, Some(0), "{}", made.message);
    let table = output.join("pseudoranges.csv");
    // Microseconds of light in metres lose some digits.
    let shown = tdoa(&[&["solve", text(&table)], &units[..], &["--tolerance", "1e-6"]].concat());
    assert_eq!(shown.status, Some(0), "{}", shown.message);
    assert!(shown.out.contains(" us\n"), "{}", shown.out);
    let found = json(&[&["solve", text(&table)], &units[..]].concat());
    assert_eq!((&found["units"]["name"], &found["seed"]), (&Value::from("us"), &Value::from(0)));
}

#[test]
fn units_that_are_not_whole_say_what_is_missing() {
    let file = root().join("examples/network/pseudoranges.csv");
    let file = text(&file);
    refused(&["calibrate", file, "--units", "ms"], &["--units ms needs --speed", "343"]);
    refused(&["solve", file, "--units", "samples", "--speed", "343"], &["needs --rate", "48000"]);
    refused(&["calibrate", file, "--units", "samples", "--rate", "48000"], &["needs --speed"]);
    refused(&["calibrate", file, "--speed", "343"], &["--speed needs --units s, ms, us, ns or samples"]);
    refused(&["calibrate", file, "--units", "cm", "--speed", "343"], &["--speed needs --units s, ms, us, ns"]);
    refused(&["calibrate", file, "--units", "ns"], &["--units ns needs --speed", "299792458"]);
    refused(&["calibrate", file, "--rate", "48000"], &["--rate needs --units samples"]);
    refused(&["calibrate", file, "--units", "s", "--speed", "343", "--rate", "9"], &["--rate is for --units samples"]);
    refused(
        &["calibrate", file, "--units", "samples", "--speed", "343", "--rate", "0"],
        &["rate must be positive and finite, not 0 Hz"],
    );
    refused(&["calibrate", file, "--units", "ms", "--speed", "-1"], &["speed must be positive"]);
    let folder = Folder::empty();
    let made = folder.path().join("made");
    refused(&["simulate", "--units", "s", "--speed", "0", "--output", text(&made)], &["--speed", "positive"]);
    refused(&["calibrate", file, "--units", "hours"], &["samples"]);
}

#[test]
fn headings_that_name_units() {
    let folder = Folder::empty();
    let file = folder.write("list.csv", list("mic,event,time_ms", [0, 1, 2], ","));
    refused(&["calibrate", text(&file)], &["line 1", "\"time_ms\" is in ms", "give --units ms --speed"]);
    refused(
        &["calibrate", text(&file), "--units", "s", "--speed", "343"],
        &["\"time_ms\" is in ms, but --units s is asked for"],
    );
    assert_eq!(json(&["calibrate", text(&file), "--units", "ms", "--speed", "1000"])["configuration"], "8r/12s");
    let file = folder.write("times.csv", list("mic,event,toa", [0, 1, 2], ","));
    refused(&["calibrate", text(&file)], &["\"toa\" holds times", "--units s --speed", "--units m if"]);
    assert_eq!(json(&["calibrate", text(&file), "--units", "m"])["configuration"], "8r/12s");
    let file = folder.write("shots.csv", list("Channel,Shot,Arrival time (ms)", [0, 1, 2], ","));
    refused(
        &["calibrate", text(&file), "--units", "s", "--speed", "343"],
        &["\"Arrival time (ms)\" is in ms, but --units s is asked for"],
    );
    assert_eq!(json(&["calibrate", text(&file), "--units", "ms", "--speed", "1000"])["configuration"], "8r/12s");
    let file = folder.write("beacons.csv", list("node,beacon,range (km)", [0, 1, 2], ","));
    refused(&["calibrate", text(&file)], &["is in km; give --units km"]);
    assert_eq!(json(&["calibrate", text(&file), "--units", "km"])["units"]["name"], "km");
}

/// What NumPy saved is named in words.
#[test]
fn arrays_of_complex_numbers_are_refused_without_their_header() {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    let header = "{'descr': '<c16', 'fortran_order': False, 'shape': (8, 12), }\n";
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    let folder = Folder::empty();
    let file = folder.write("z.npy", bytes);
    let ran = tdoa(&["calibrate", text(&file)]);
    assert_eq!(ran.status, Some(2), "{}", ran.message);
    let says = "z.npy: holds complex numbers (c16); real numbers are needed";
    assert!(ran.message.contains(says) && !ran.message.contains("fortran"), "{}", ran.message);
}

#[test]
fn one_network_in_many_spellings() {
    let folder = Folder::empty();
    let plain = example("pseudoranges.csv");
    let rows = cells(&plain);
    let points_to_commas: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| cell.replace('.', ",")).collect()).collect();
    let quoted: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| format!(" \"{cell}\" ")).collect()).collect();
    let wide = |bytes: fn(u16) -> [u8; 2], text: &str| -> Vec<u8> {
        format!("\u{feff}{text}").encode_utf16().flat_map(bytes).collect()
    };
    let expected = json(&["calibrate", text(&root().join("examples/network/pseudoranges.csv"))]);
    let spellings: Vec<(&str, Vec<u8>)> = vec![
        ("mark", format!("\u{feff}{plain}").into()),
        ("windows", plain.replace('\n', "\r\n").into()),
        ("mic", plain.replacen("receiver", "Mic", 1).into()),
        ("word", plain.replacen("receiver", "channel", 1).into()),
        ("decimal commas", with(";", &points_to_commas).into()),
        ("tabs and decimal commas", with("\t", &points_to_commas).into()),
        ("tabs", with("\t", &rows).into()),
        ("UTF-16 of a spreadsheet", wide(u16::to_le_bytes, &with("\t", &points_to_commas))),
        ("UTF-16, other order", wide(u16::to_be_bytes, &plain)),
        ("quoted", with(",", &quoted).into()),
        ("comments and empty lines", format!("# a recording\n\n{}\n\n#end\n", plain.replace('\n', "\n\n")).into()),
        ("separators at the ends", plain.lines().map(|line| format!("{line},\n")).collect::<String>().into()),
        ("rows of nothing", format!("{plain},,,,\n,,,,,\n").into()),
    ];
    for (name, content) in spellings {
        let file = folder.write("table.csv", content);
        assert!(json(&["calibrate", text(&file)]) == expected, "{name}");
    }
    // A list knows the nodes in the order of the matrix too.
    for (header, order) in [
        ("receiver,transmitter,value", [0, 1, 2]),
        ("Anchor,Tag,Range", [0, 1, 2]),
        ("pseudorange,microphone,source", [2, 0, 1]),
        ("mic_id,value,event_id", [0, 2, 1]),
    ] {
        let file = folder.write("list.csv", list(header, order, ","));
        assert!(json(&["calibrate", text(&file)]) == expected, "{header}");
    }
    let file = folder.write("list.csv", list("sensor;event;value", [0, 1, 2], ";").replace('.', ","));
    assert!(json(&["calibrate", text(&file)]) == expected);
    // Blanks between numbers, as numpy.savetxt writes them; missing ones are nan.
    let bare: Vec<Vec<String>> = rows[1..]
        .iter()
        .map(|row| row[1..].iter().map(|cell| if cell.is_empty() { "nan".into() } else { cell.clone() }).collect())
        .collect();
    let file = folder.write("blanks.txt", with("  ", &bare));
    assert_eq!(json(&["calibrate", text(&file)])["receivers"], expected["receivers"]);
}

#[test]
fn tables_that_are_not_understood_say_what_is() {
    let folder = Folder::empty();
    let says = |content: &[u8], parts: &[&str]| {
        let file = folder.write("table.csv", content);
        refused(&["calibrate", text(&file)], &[&["table.csv"], parts].concat());
    };
    says(b"receiver,transmitter,value\n", &["no measurements"]);
    says(b"receiver,s1,s2\n", &["no measurements"]);
    says(b"event,mic,loudness\ne,m,1\n", &["line 1", "no column is the value", "receiver (or mic"]);
    says(b"who,what,when\nm,e,1\n", &["line 2", "line 1 was taken for names", "transmitter (or event"]);
    says(b"mic,event,time,toa\nm,e,1,2\n", &["\"time\" and \"toa\" may both be the value"]);
    says(b"mic,event,value\nm,e,0,5\n", &["line 2", "4 cells where the header has 3", "semicolons"]);
    says(b"mic;event;value\nm;e;1.234,5\n", &["line 2, column 3", "without marks between thousands"]);
    says(b"mic;event;value\nm;e;1,5\nm;f;1.5\n", &["line 3", "decimal mark ','"]);
    says(b"mic,event,value\nm,e,3 ms\n", &["line 2", "give that as --units"]);
    says(b"mic,event,value\nm,e,1\nm,e,2\n", &["line 3", "receiver m, transmitter e is there twice, on line 2 too"]);
    says(b"receiver,a,b\nm,1,2\nm,3,4\n", &["two receivers are named \"m\""]);
    says(b"# one\n\n# two\n1,2,3\n4,x,6\n", &["line 5, column 2"]);
    says(b"PK\x03\x04 a spreadsheet", &["export the sheet as CSV"]);
    says(b"m\x00,1\n", &["line 1", "is no text"]);
}

#[test]
fn a_truth_with_foreign_names() {
    let folder = Folder::empty();
    let table = root().join("examples/network/pseudoranges.csv");
    let truth = example("receivers.csv");
    let mut lines: Vec<&str> = truth.lines().collect();
    lines[1..].reverse();
    // In another order, by name.
    let known = json(&["calibrate", text(&table), "--truth", text(&root().join("examples/network/receivers.csv"))]);
    let file = folder.write("reversed.csv", lines.join("\n"));
    assert!(json(&["calibrate", text(&table), "--truth", text(&file)]) == known);
    // Foreign names in another order are refused.
    let file = folder.write("foreign.csv", lines.join("\n").replace("\nr", "\nanchor "));
    refused(
        &["calibrate", text(&table), "--truth", text(&file)],
        &["foreign.csv", "no receiver is named \"anchor 8\"", "the receivers are r1, r2", "leave out the names"],
    );
    // Some foreign names are left out, and named.
    let file = folder.write("more.csv", truth.replace("\nr3,", "\nbase,"));
    let ran = tdoa(&["calibrate", text(&table), "--truth", text(&file)]);
    assert_eq!(ran.status, Some(0), "{}", ran.message);
    assert!(ran.message.contains("no receiver is named \"base\": left out"), "{}", ran.message);
    assert!(ran.out.contains("against the truth: 7 receivers"), "{}", ran.out);
    // Where one side has no names they are taken in order, and the output says so.
    let bare: String =
        truth.lines().skip(1).map(|line| line.split_once(',').expect("cells").1.to_string() + "\n").collect();
    let file = folder.write("bare.csv", bare);
    let ran = tdoa(&["calibrate", text(&table), "--truth", text(&file)]);
    assert!(
        ran.message.contains("bare.csv: has no names, so that its positions were taken in the order"),
        "{}",
        ran.message
    );
    let rows = cells(&example("pseudoranges.csv"));
    let unnamed: Vec<Vec<String>> = rows[1..].iter().map(|row| row[1..].to_vec()).collect();
    let matrix = folder.write("matrix.csv", with(",", &unnamed));
    let file = folder.write("named.csv", truth.replace("\nr", "\nanchor "));
    let ran = tdoa(&["calibrate", text(&matrix), "--truth", text(&file)]);
    assert!(ran.out.contains("no name in common with the receivers, so that its positions were taken"), "{}", ran.out);
    let file = folder.write("twice.csv", format!("{truth}r1,0,0\n"));
    refused(
        &["calibrate", text(&table), "--truth", text(&file)],
        &["line 10", "receiver r1 is there twice, on line 2"],
    );
}

#[test]
fn heights_are_never_dropped_without_a_word() {
    let folder = Folder::empty();
    let table = root().join("examples/network/pseudoranges.csv");
    let heights = |height: fn(usize) -> String| -> String {
        let rows = example("receivers.csv")
            .lines()
            .skip(1)
            .enumerate()
            .map(|(k, row)| format!("{row},{}\n", height(k)))
            .collect::<String>();
        format!("Mic,x_m,y_m,z_m\n{rows}")
    };
    let level = folder.write("level.csv", heights(|_| "1.2".to_string()));
    let steep = folder.write("steep.csv", heights(|k| k.to_string()));
    let said = |option: &str, file: &Path, parts: &[&str]| {
        let ran = tdoa(&["calibrate", text(&table), option, text(file)]);
        assert_eq!(ran.status, Some(0), "{}", ran.message);
        for part in parts {
            assert!(ran.message.contains(part), "{part:?} is not in: {}", ran.message);
        }
    };
    said("--truth", &level, &["level.csv: the heights (z, 1.2 m) are left out"]);
    said("--truth", &steep, &["the heights (z, 0 m to 7 m) are left out", "form no plane"]);
    said("--anchors", &level, &["level.csv: the heights (z, 1.2 m) are left out"]);
    refused(
        &["calibrate", text(&table), "--dimensions", "2", "--anchors", text(&steep)],
        &["steep.csv", "differ by 7 m", "one height", "leave out the column z"],
    );
    let file = folder.write("numbers.csv", "1,2,3\n4,5,6\n");
    refused(&["calibrate", text(&table), "--truth", text(&file)], &["line 1", "id,x,y or x,y,z", "first line"]);
    let file = folder.write("places.csv", "name,lat,lon\nr1,1,2\n");
    refused(
        &["calibrate", text(&table), "--anchors", text(&file)],
        &["line 1", "name (or id", "x and y, in any order"],
    );
    let file = folder.write("mm.csv", "name,x_mm,y_mm\nr1,1,2\n");
    refused(&["calibrate", text(&table), "--anchors", text(&file)], &["\"x_mm\" is in mm; convert it to metres"]);
}

/// Largest of small: scaled copies of the example say how large they are, in numbers that people
/// read.
#[test]
fn the_size_of_a_network_in_a_unit_that_suits() {
    let folder = Folder::empty();
    let rows = cells(&example("pseudoranges.csv"));
    let positions = cells(&example("receivers.csv"));
    let at = |row: &[String]| [1, 2].map(|k| row[k].parse::<f64>().expect("number"));
    let all: Vec<[f64; 2]> = positions[1..].iter().map(|row| at(row)).collect();
    let pairs = all.iter().flat_map(|a| all.iter().map(|b| (a[0] - b[0]).hypot(a[1] - b[1])));
    let across = pairs.fold(0.0, f64::max);
    for (factor, unit, of_unit) in [(0.017 / across, "mm", 1e-3), (1.0, "m", 1.0), (6100.0 / across, "km", 1e3)] {
        let scaled: Vec<Vec<String>> = rows
            .iter()
            .map(|row| {
                row.iter().map(|cell| cell.parse::<f64>().map_or(cell.clone(), |f| (factor * f).to_string())).collect()
            })
            .collect();
        let file = folder.write("scaled.csv", with(",", &scaled));
        let ran = tdoa(&["calibrate", text(&file)]);
        assert_eq!(ran.status, Some(0), "{}", ran.message);
        let line = ran.out.lines().find_map(|line| line.strip_prefix("size: ")).expect("the size");
        let words: Vec<&str> = line.split(' ').collect();
        assert_eq!(words[1..3], [unit, "across"], "{line}");
        // The noise of the example is 2 cm in about ten metres.
        let size: f64 = words[0].parse().expect("number");
        assert!((size * of_unit / (factor * across) - 1.0).abs() < 0.02, "{line}");
        // Plain numbers, and coordinates that tell the nodes apart.
        let has_power = |word: &str| word.contains("e-") || (word.contains('e') && word.parse::<f64>().is_ok());
        assert!(!ran.out.split_whitespace().any(has_power), "{}", ran.out);
        assert!(ran.out.split_whitespace().all(|word| word.trim_start_matches('-').len() < 24), "{}", ran.out);
        let x = |name: &str| -> f64 {
            let row = ran.out.lines().find(|line| line.starts_with(name)).expect("row");
            row.split_whitespace().nth(1).expect("x").parse().expect("number")
        };
        assert!((x("r2 ") - x("r3 ")).abs() > 1e-3 * factor * across, "{}", ran.out);
    }
}

#[test]
fn speeds_are_plain_numbers() {
    let folder = Folder::empty();
    let made = folder.path().join("made");
    let units = ["--units", "s", "--speed", "343"];
    let made_it =
        tdoa(&[&["simulate", "--noise", "0.005", "--seed", "2"], &units[..], &["--output", text(&made)]].concat());
    assert_eq!(made_it.status, Some(0), "{}", made_it.message);
    let (table, receivers) = (made.join("pseudoranges.csv"), made.join("receivers.csv"));
    let arguments = ["calibrate", text(&table), "--units", "s", "--estimate-speed", "--anchors", text(&receivers)];
    let ran = tdoa(&arguments);
    assert_eq!(ran.status, Some(0), "{}", ran.message);
    let line = ran.out.lines().find_map(|line| line.strip_prefix("propagation speed ")).expect("the speed");
    let speed: f64 = line.split(' ').next().expect("number").parse().expect("number");
    assert!((speed / 343.0 - 1.0).abs() < 0.01 && !line.contains("e2"), "{line}");
    // Offsets in seconds are those that were made, whatever the speed that was assumed.
    let found = json(&arguments);
    let true_offset = |j: usize| -> f64 {
        let table = std::fs::read_to_string(made.join("offsets.csv")).expect("offsets");
        table.lines().nth(j + 1).expect("row").split(',').nth(2).expect("cell").parse().expect("number")
    };
    for j in 0..3 {
        let offset = found["offsets_in_units"][j].as_f64().expect("offset");
        // A decimetre of sound: twenty times the noise.
        assert!((offset - true_offset(j)).abs() < 0.1 / 343.0, "{offset} {}", true_offset(j));
    }
}

/// `tests/data/network.mat` has z and rgt, `crates/tdoa/src/read/plain.mat` counts, label, z and
/// rgt.
#[test]
fn variables_of_a_mat_file() {
    let network = root().join("tests/data/network.mat");
    let network = text(&network);
    assert!(json(&["calibrate", network, "--variable", "z"]) == json(&["calibrate", network]));
    refused(&["calibrate", network, "--variable", "Z"], &["has no variable Z", "z (8 x 12)", "--variable NAME"]);
    let plain = root().join("crates/tdoa/src/read/plain.mat");
    refused(
        &["solve", text(&plain), "--variable", "label"],
        &["variable label that is no array", "counts (1 x 3)", "label (1 x 4, no numbers)"],
    );
    let table = root().join("examples/network/pseudoranges.csv");
    refused(&["calibrate", text(&table), "--variable", "z"], &["--variable is for .mat files"]);
}

#[test]
fn files_that_are_written_are_named() {
    let folder = Folder::empty();
    let table = root().join("examples/network/pseudoranges.csv");
    let path = |name: &str| folder.path().join(name);
    let [json, svg, html, nodes] = ["a.json", "a.svg", "a.html", "a.csv"].map(path);
    let ran = tdoa(&[
        "calibrate",
        text(&table),
        "--json",
        text(&json),
        "--svg",
        text(&svg),
        "--html",
        text(&html),
        "--nodes",
        text(&nodes),
    ]);
    assert_eq!(ran.status, Some(0), "{}", ran.message);
    for file in [&json, &svg, &html, &nodes] {
        assert!(ran.message.contains(&format!("wrote {}\n", file.display())), "{}", ran.message);
    }
    refused(
        &["calibrate", text(&table), "--json", text(&json), "--html", text(&json)],
        &["a.json", "--json and --html", "two names"],
    );
}

/// Warnings stand before the tables, where they are seen.
#[test]
fn warnings_come_first() {
    let folder = Folder::empty();
    let unnamed: Vec<Vec<String>> =
        cells(&example("pseudoranges.csv"))[1..].iter().map(|row| row[1..].to_vec()).collect();
    let matrix = folder.write("matrix.csv", with(",", &unnamed));
    let truth = folder.write("truth.csv", example("receivers.csv").replace("\nr", "\nanchor "));
    let ran = tdoa(&["calibrate", text(&matrix), "--truth", text(&truth)]);
    let last = ran.out.rfind("\nwarning: ").expect("the warning of a truth in order");
    assert!(last < ran.out.find("\nreceiver ").expect("the table"), "{}", ran.out);
}

#[test]
fn no_seed_where_nothing_is_random() {
    let table = root().join("examples/network/pseudoranges.csv");
    refused(&["solve", text(&table), "--seed", "1"], &["--seed"]);
}
