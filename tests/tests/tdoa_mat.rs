//! `tdoa calibrate` on a .mat file. `tests/data/network.mat` is `examples/network` as scipy.io.savemat (1.17.1) writes it
//! with do_compression: z and rgt.

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
