//! `tdoa simulate`: files of networks in the plane and in space, and layouts that contradict the
//! dimension.

use std::path::Path;

use end_to_end::run;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// The rows of a table with a first line, which is checked, and a first column of names.
fn table(file: &Path, heading: &str) -> Vec<Vec<f64>> {
    let content = std::fs::read_to_string(file).expect("table");
    let mut lines = content.lines();
    assert_eq!(lines.next(), Some(heading), "{}", file.display());
    let numbers = |line: &str| line.split(',').skip(1).map(|cell| cell.parse().expect("number")).collect();
    lines.map(numbers).collect()
}

/// The receivers of a network without noise, after its measurements are compared with its nodes.
fn receivers(words: &str, heading: &str) -> Vec<Vec<f64>> {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let words: Vec<&str> = words.split_whitespace().collect();
    let size = ["simulate", "--receivers", "5", "--transmitters", "6", "--output", text(folder)];
    let output = run("tdoa", &[&size, &words[..]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let [receivers, transmitters] =
        ["receivers.csv", "transmitters.csv"].map(|name| table(&folder.join(name), heading));
    let offsets = table(&folder.join("offsets.csv"), "id,offset");
    let measured = table(&folder.join("pseudoranges.csv"), "receiver,s1,s2,s3,s4,s5,s6");
    assert_eq!((receivers.len(), transmitters.len(), offsets.len(), measured.len()), (5, 6, 6, 5));
    for (receiver, row) in receivers.iter().zip(&measured) {
        for ((transmitter, offset), value) in transmitters.iter().zip(&offsets).zip(row) {
            let squares = receiver.iter().zip(transmitter).map(|(a, b)| (a - b) * (a - b));
            assert!((squares.sum::<f64>().sqrt() + offset[0] - value).abs() < 1e-9);
        }
    }
    receivers
}

#[test]
fn networks_in_the_plane_and_in_space() {
    for (words, extent) in [
        ("", &[10.0, 10.0][..]),
        ("--dimensions 2", &[10.0, 10.0]),
        ("--layout 40x20", &[40.0, 20.0]),
        ("--layout 40x20 --dimensions 2 --shape chain", &[40.0, 20.0]),
        ("--dimensions 3", &[10.0, 10.0, 3.0]),
        ("--dimensions 3 --shape grid", &[10.0, 10.0, 3.0]),
        ("--layout 40x20x2.5", &[40.0, 20.0, 2.5]),
        ("--layout 40x20x2.5 --shape chain --dimensions 3", &[40.0, 20.0, 2.5]),
        ("--layout normal --dimensions 3", &[f64::INFINITY; 3]),
    ] {
        let heading = if extent.len() == 3 { "id,x,y,z" } else { "id,x,y" };
        for receiver in receivers(words, heading) {
            assert_eq!(receiver.len(), extent.len(), "{words}");
            let within = |(x, side): (&f64, &f64)| side.is_infinite() || (0.0..=*side).contains(x);
            assert!(receiver.iter().zip(extent).all(within), "{words}: {receiver:?}");
        }
    }
}

#[test]
fn layouts_that_contradict_the_dimension_are_refused() {
    for (words, parts) in [
        ("--layout 10x10x3 --dimensions 2", &["--layout has three sides", "--dimensions 3"][..]),
        ("--layout 10x10 --dimensions 3", &["--layout has two sides", "--dimensions 2"]),
        ("--dimensions 4", &["--dimensions", "4"]),
        ("--layout 10", &["normal, WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT", "\"10\""]),
        ("--layout 10 --dimensions 3", &["normal, WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT", "\"10\""]),
        ("--layout 1x2x3x4", &["normal, WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT", "1x2x3x4"]),
        ("--layout 10xwide", &["normal, WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT", "10xwide"]),
        ("--layout normal --shape grid --dimensions 3", &["--shape needs --layout"]),
        ("--layout 10x10x0", &["the extent in z must be positive"]),
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let output = run("tdoa", &[&["simulate", "--output", "never-made"], &words[..]].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{words:?}: {message}");
        assert!(!Path::new("never-made").exists());
    }
}
