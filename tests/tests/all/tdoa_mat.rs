//! `tdoa calibrate` on a .mat file. `tests/data/network.mat` is `examples/network` as
//! scipy.io.savemat (1.17.1) writes it with do_compression: z and rgt; `network_sgt.mat` has sgt,
//! the transmitters, too.

use std::path::Path;

use end_to_end::{root, run};

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

#[test]
fn a_mat_file_gives_what_the_table_gives() {
    let mat = root().join("tests/data/network.mat");
    let folder = root().join("examples/network");
    let (table, truth) = (folder.join("pseudoranges.csv"), folder.join("receivers.csv"));
    let from_mat = run("tdoa", &["calibrate", text(&mat), "--json", "-"]);
    assert!(from_mat.status.success(), "{}", String::from_utf8_lossy(&from_mat.stderr));
    let from_table = run("tdoa", &["calibrate", text(&table), "--truth", text(&truth), "--json", "-"]);
    assert!(from_mat.stdout == from_table.stdout);
    // The truth alone may come from it too, and the scale needs no other.
    let truth_in_mat = run("tdoa", &["calibrate", text(&table), "--truth", text(&mat), "--json", "-"]);
    assert!(truth_in_mat.stdout == from_table.stdout);
    let scaled = run("tdoa", &["calibrate", text(&mat), "--scale", "--json", "-"]);
    assert!(scaled.status.success(), "{}", String::from_utf8_lossy(&scaled.stderr));
}

/// The calibration is the same, and the true transmitters come into the comparison and the picture.
#[test]
fn true_transmitters_come_from_sgt() {
    let data = root().join("tests/data");
    let directory = tempfile::tempdir().expect("directory");
    let calibrated = |file: &str| {
        let svg = directory.path().join("network.svg");
        let output = run("tdoa", &["calibrate", text(&data.join(file)), "--json", "-", "--svg", text(&svg)]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        (json, std::fs::read_to_string(svg).expect("picture"))
    };
    let (with, without) = (calibrated("network_sgt.mat"), calibrated("network.mat"));
    assert_eq!(with.0["transmitters"], without.0["transmitters"]);
    let error = |json: &serde_json::Value| json["truth"]["transmitter_median"].as_f64();
    assert_eq!(error(&without.0), None);
    // The noise of the example is 2 cm (examples/network/README.md).
    assert!(error(&with.0).is_some_and(|median| median > 0.0 && median < 0.2), "{}", with.0["truth"]);
    let marks = |svg: &str| svg.matches("class=\"truth\"").count();
    assert_eq!(marks(&with.1), marks(&without.1) + 12);
}

#[test]
fn other_mat_files_are_refused() {
    let directory = tempfile::tempdir().expect("directory");
    for (content, part) in
        [(&b"MATLAB 7.3 MAT-file, HDF5"[..], "is not a .mat file"), (&[0; 4096][..], "not a .mat file of level 5")]
    {
        let file = directory.path().join("f.mat");
        std::fs::write(&file, content).expect("written");
        let output = run("tdoa", &["calibrate", text(&file)]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("f.mat") && message.contains(part) && message.contains("-v7"), "{message}");
    }
    let output = run("tdoa", &["calibrate", text(&root().join("examples/network/pseudoranges.csv")), "--scale"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--scale needs --truth"));
}
