//! One network in the tables that recorders, programs and people write: names that are numbers, moments,
//! Raven's selections, differences of pairs, other languages, events in rows, thousands.

use std::path::Path;

use end_to_end::{Folder, root, run};
use serde_json::Value;

const SOUND: [&str; 4] = ["--units", "s", "--speed", "343"];

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// The example's measurements in metres, by receiver and transmitter; `None` where nothing was heard.
fn measurements() -> Vec<Vec<Option<f64>>> {
    let table = std::fs::read_to_string(root().join("examples/network/pseudoranges.csv")).expect("example");
    let cells = |line: &str| line.split(',').skip(1).map(|cell| cell.parse().ok()).collect();
    table.lines().skip(1).map(cells).collect()
}

/// Seconds of each measurement, of events five seconds apart, with nine digits; an empty text where
/// nothing was heard.
fn seconds(i: usize, j: usize) -> Option<f64> {
    measurements()[i][j].map(|metres| metres / 343.0 + 40.0 + 5.0 * j as f64)
}

/// A line for each measurement.
fn lines(mut line: impl FnMut(usize, usize, f64) -> String) -> String {
    let all = measurements();
    let mut text = String::new();
    for i in 0..all.len() {
        for j in 0..all[i].len() {
            if let Some(time) = seconds(i, j) {
                text += &line(i, j, time);
            }
        }
    }
    text
}

/// Calibrations of tables in a folder.
trait Tables {
    fn calibrated(&self, content: impl AsRef<[u8]>, options: &[&str]) -> Value;
    fn refused(&self, content: impl AsRef<[u8]>, options: &[&str], parts: &[&str]);
}

impl Tables for Folder {
    /// What a calibration of this table gives.
    fn calibrated(&self, content: impl AsRef<[u8]>, options: &[&str]) -> Value {
        let file = self.write("table.csv", content);
        let output = run("tdoa", &[&["calibrate", text(&file), "--json", "-"], options].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{message}");
        serde_json::from_slice(&output.stdout).expect("JSON")
    }

    /// Refused with these words.
    fn refused(&self, content: impl AsRef<[u8]>, options: &[&str], parts: &[&str]) {
        let file = self.write("table.csv", content);
        let output = run("tdoa", &[&["calibrate", text(&file)], options].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in parts {
            assert!(message.contains(part), "{part:?} is not in: {message}");
        }
    }
}

/// Distances between all receivers, by their names.
fn distances(found: &Value, names: &[&str]) -> Vec<f64> {
    let place = |name: &&str| {
        let all = found["receiver_names"].as_array().expect("names");
        all.iter().position(|other| other == *name).unwrap_or_else(|| panic!("no {name} in {all:?}"))
    };
    let at = |name: &&str| -> Vec<f64> {
        let place = &found["receivers"][place(name)];
        place.as_array().expect("a place").iter().map(|x| x.as_f64().expect("number")).collect()
    };
    let places: Vec<Vec<f64>> = names.iter().map(at).collect();
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    (0..places.len()).flat_map(|a| (0..a).map(move |b| (a, b))).map(|(a, b)| distance(&places[a], &places[b])).collect()
}

const EIGHT: [&str; 8] = ["r1", "r2", "r3", "r4", "r5", "r6", "r7", "r8"];

/// The distances that the example gives as it is.
fn expected() -> Vec<f64> {
    let table = root().join("examples/network/pseudoranges.csv");
    let output = run("tdoa", &["calibrate", text(&table), "--json", "-"]);
    distances(&serde_json::from_slice(&output.stdout).expect("JSON"), &EIGHT)
}

fn assert_same(found: &Value, names: &[&str]) {
    for (a, b) in distances(found, names).iter().zip(expected()) {
        // A tenth of the noise, 2 cm: offsets and digits are others.
        assert!((a - b).abs() < 2e-3, "{a} {b}");
    }
}

#[test]
fn numbers_of_recorders_are_names() {
    let folder = Folder::empty();
    let table = std::fs::read_to_string(root().join("examples/network/pseudoranges.csv")).expect("example");
    let serials = ["4711", "12", "13", "905", "77", "1001", "3", "8"];
    let rows = |heading: &str, names: &[&str]| -> String {
        let body = table
            .lines()
            .skip(1)
            .zip(names)
            .map(|(row, name)| format!("{name},{}\n", row.split_once(',').expect("cells").1));
        format!("{heading},clap,bang,e3,e4,dog,e6,e7,e8,e9,e10,e11,door\n{}", body.collect::<String>())
    };
    let counted = ["1", "2", "3", "4", "5", "6", "7", "8"];
    for heading in ["recorder", "serial", "Unnamed: 0", "box"] {
        for names in [&counted, &serials] {
            assert_same(&folder.calibrated(rows(heading, names), &[]), names);
        }
    }
}

#[test]
fn times_in_many_forms() {
    let folder = Folder::empty();
    let moment = |time: f64| format!("2024-05-12T05:{:02}:{:09.6}Z", 30 + (time / 60.0) as usize, time % 60.0);
    let iso = lines(|i, j, time| format!("r{},{j},{}\n", i + 1, moment(time)));
    let iso = folder.calibrated(format!("recorder,call,timestamp\n{iso}"), &SOUND);
    assert_same(&iso, &EIGHT);
    let mut number = 0;
    let raven = lines(|i, j, time| {
        number += 1;
        let row = |view: &str| format!("{number}\t{view} 1\tr{}\t{time:.6}\t{:.6}\t2000.0\t{j}\n", i + 1, time + 0.2);
        row("Waveform") + &row("Spectrogram")
    });
    let header = "Selection\tView\tChannel\tBegin Time (s)\tEnd Time (s)\tLow Freq (Hz)\tEvent\n";
    assert_same(&folder.calibrated(format!("{header}{raven}"), &SOUND), &EIGHT);
    let german = lines(|i, j, time| format!("r{};{j};{time:.6};0,9\n", i + 1).replace('.', ","));
    assert_same(&folder.calibrated(format!("Empfänger;Ereignis;Zeit;Güte\n{german}"), &SOUND), &EIGHT);
    let options = ["--columns", "receiver=wo,transmitter=was,time=wann"];
    assert_same(&folder.calibrated(format!("wo;was;wann;wie\n{german}"), &[&SOUND[..], &options].concat()), &EIGHT);
    folder.refused(format!("wo;was;wann;wie\n{german}"), &SOUND, &["--columns receiver="]);
}

#[test]
fn differences_of_pairs() {
    let folder = Folder::empty();
    let first = |j: usize| (0..8).find(|&i| seconds(i, j).is_some()).expect("a receiver");
    let rows = lines(|i, j, time| match first(j) {
        k if k == i => String::new(),
        k => format!("{j},r{},r{},{:.6}\n", k + 1, i + 1, 1e3 * (time - seconds(k, j).expect("measured"))),
    });
    let table = format!("event,mic_a,mic_b,tdoa_ms\n{rows}");
    let units = ["--units", "ms", "--speed", "343"];
    folder.refused(&table, &units, &["receiver=mic_b,reference=mic_a", "receiver=mic_a,reference=mic_b"]);
    let columns = ["--columns", "receiver=mic_b,reference=mic_a"];
    assert_same(&folder.calibrated(&table, &[&units[..], &columns].concat()), &EIGHT);
}

#[test]
fn events_in_rows() {
    let folder = Folder::empty();
    let row = |j: usize| {
        let cells = (0..8).map(|i| seconds(i, j).map_or(String::new(), |time| format!("{time:.6}")));
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    let rows: String = (0..12).map(row).collect();
    let transpose = [&SOUND[..], &["--transpose"]].concat();
    assert_same(&folder.calibrated(&rows, &transpose), &EIGHT);
    // What is wrong is said before the search, which finds nothing.
    let file = folder.write("table.csv", &rows);
    let few = ["--max-starts", "1", "--agreeing", "1"];
    let output = run("tdoa", &[&["calibrate", text(&file)], &SOUND[..], &few].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.starts_with("note: ") && message.contains("--transpose"), "{message}");
    let indexed: String = (0..12).map(|j| format!("{j},{},20.5\n", row(j).trim_end())).collect();
    let table = format!("idx,r1,r2,r3,r4,r5,r6,r7,r8,temp\n{indexed}");
    folder.refused(&table, &SOUND, &["\"temp\"", "--columns ignore=temp"]);
    folder.refused(&table, &[&SOUND[..], &["--columns", "ignore=temp"]].concat(), &["--transpose"]);
    assert_same(&folder.calibrated(&table, &[&transpose[..], &["--columns", "ignore=temp"]].concat()), &EIGHT);
}

#[test]
fn thousands_and_old_text() {
    let folder = Folder::empty();
    let samples = ["--units", "samples", "--rate", "48000", "--speed", "343"];
    // The example in millimetres of sound that is sampled so.
    let sample = |i: usize, j: usize| seconds(i, j).map(|time| (48_000.0 * (time - 39.0 - 5.0 * j as f64)).round());
    let grouped = |mark: &str| {
        let row = |i: usize| -> String {
            let cell = |j: usize| {
                sample(i, j).map_or(String::new(), |s| format!("{}{mark}{:03}", s as u32 / 1000, s as u32 % 1000))
            };
            format!("r{};{}\n", i + 1, (0..12).map(cell).collect::<Vec<_>>().join(";"))
        };
        format!(
            "receiver;{}\n{}",
            (1..=12).map(|j| format!("s{j}")).collect::<Vec<_>>().join(";"),
            (0..8).map(row).collect::<String>()
        )
    };
    for (mark, option) in [(",", "point"), (".", "comma")] {
        folder.refused(grouped(mark), &samples, &["thousands", &format!("--decimal-mark {option}")]);
        let found = folder.calibrated(grouped(mark), &[&samples[..], &["--decimal-mark", option]].concat());
        // A sample is 7 mm.
        for (a, b) in distances(&found, &EIGHT).iter().zip(expected()) {
            assert!((a - b).abs() < 0.03, "{a} {b}");
        }
    }
    let table = std::fs::read_to_string(root().join("examples/network/pseudoranges.csv")).expect("example");
    let excel = format!(
        "sep=;\r\n{}",
        table.replace(',', ";").replace('.', ",").replace(";-", ";\u{2212}").replace("r1;", "K\u{fc}che;")
    );
    let names = ["K\u{fc}che", "r2", "r3", "r4", "r5", "r6", "r7", "r8"];
    assert_same(&folder.calibrated(&excel, &[]), &names);
    let latin: Vec<u8> = excel.replace('\u{2212}', "-").chars().map(|c| c as u8).collect();
    assert_same(&folder.calibrated(latin, &[]), &names);
}

#[test]
fn positions_with_the_words_of_surveyors() {
    let folder = Folder::empty();
    let table = root().join("examples/room/pseudoranges.csv");
    let positions = std::fs::read_to_string(root().join("examples/room/receivers.csv")).expect("example");
    let surveyed = folder.write("s.csv", positions.replacen("id,x,y,z", "Station,Easting,Northing,Elevation", 1));
    let plain = folder.write("p.csv", &positions);
    let json = |file: &Path| {
        let output = run("tdoa", &["calibrate", text(&table), "--anchors", text(file), "--json", "-"]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    assert!(json(&surveyed) == json(&plain));
    for (header, part) in [("name,lat,lon,z", "an angle on the earth"), ("name,x,y,depth", "counts downwards")] {
        let file = folder.write("wrong.csv", positions.replacen("id,x,y,z", header, 1));
        let output = run("tdoa", &["calibrate", text(&table), "--anchors", text(&file)]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains(part), "{message}");
    }
    let file = folder.write("both.csv", format!("{positions}s1,1,2,3\n"));
    let output = run("tdoa", &["calibrate", text(&table), "--anchors", text(&file)]);
    // The place of a transmitter among those of receivers, and a wrong one.
    let said = [output.stdout, output.stderr].map(|said| String::from_utf8_lossy(&said).into_owned()).concat();
    assert!(said.contains("the known position of s1 is") && said.contains("was not used"), "{said}");
}
