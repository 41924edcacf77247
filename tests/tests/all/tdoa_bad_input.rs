//! Unusable input and data that determine nothing: the exit status, the place and the remedy.

use std::path::Path;

use end_to_end::run;

/// Standard error and exit status of `tdoa calibrate` on a file with this content.
fn calibrate(name: &str, content: &[u8], more: &[&str]) -> (String, Option<i32>) {
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join(name);
    std::fs::write(&file, content).expect("written");
    of(&[&["calibrate", text(&file)], more].concat())
}

fn of(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run("tdoa", arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!message.contains("panicked"), "{message}");
    (message, output.status.code())
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

fn assert_says((message, status): (String, Option<i32>), expected_status: i32, parts: &[&str]) {
    assert_eq!(status, Some(expected_status), "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in: {message}");
    }
}

/// A matrix of exact pseudoranges of given positions, as CSV.
fn matrix(receivers: &[[f64; 2]], transmitters: &[[f64; 2]]) -> String {
    let row = |r: &[f64; 2]| {
        let cells = transmitters.iter().enumerate();
        let cells: Vec<String> =
            cells.map(|(j, s)| ((r[0] - s[0]).hypot(r[1] - s[1]) + j as f64).to_string()).collect();
        cells.join(",") + "\n"
    };
    receivers.iter().map(row).collect()
}

const RECEIVERS: [[f64; 2]; 6] = [[0.0, 0.0], [5.0, 0.3], [4.1, 3.9], [0.2, 4.2], [2.3, 1.1], [1.7, 6.1]];
const TRANSMITTERS: [[f64; 2]; 6] = [[1.0, 2.0], [3.3, 2.7], [6.0, 5.0], [-1.0, 3.0], [2.0, -2.0], [3.9, 0.8]];

#[test]
fn missing_file_and_directory() {
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join("none.csv");
    assert_says(of(&["calibrate", text(&file)]), 2, &["none.csv", "check the path"]);
    assert_says(of(&["calibrate", text(directory.path())]), 2, &["is a directory"]);
}

#[test]
fn not_a_number_and_ragged_rows() {
    assert_says(
        calibrate("f.csv", b"1,2,3\n4,x5,6\n", &[]),
        2,
        &["line 2, column 2", "receiver r2, transmitter s2", "x5", "leave the cell empty"],
    );
    assert_says(
        calibrate("f.csv", b"1,2,3\n4,5,6\n7,8\n", &[]),
        2,
        &["line 3", "receiver r3", "has 2 cells in place of 3"],
    );
}

#[test]
fn too_few_nodes_and_nothing_measured() {
    let small = matrix(&RECEIVERS[..5], &TRANSMITTERS[..3]);
    assert_says(
        calibrate("f.csv", small.as_bytes(), &[]),
        1,
        &["5 receivers and 3 transmitters", "6 receivers and 3 transmitters, 5 and 4, or 4 and 5", "add 1 receiver"],
    );
    let small = matrix(&RECEIVERS[..3], &TRANSMITTERS);
    assert_says(calibrate("f.csv", small.as_bytes(), &[]), 1, &["add 1 receiver"]);
    let empty = "nan,nan,nan,nan\n".repeat(6);
    assert_says(calibrate("f.csv", empty.as_bytes(), &[]), 1, &["nothing was measured", "24 cells"]);
    assert_says(calibrate("f.csv", b"", &[]), 2, &["no measurements"]);
}

#[test]
fn infinite_and_huge_values() {
    for value in ["inf", "-Infinity", "1e300", "3e12"] {
        let table = matrix(&RECEIVERS, &TRANSMITTERS).replacen("2.23606797749979", value, 1);
        assert_says(
            calibrate("f.csv", table.as_bytes(), &[]),
            2,
            &["receiver r1, transmitter s1", "leave the cell empty"],
        );
    }
}

#[test]
fn identical_receivers() {
    let mut receivers = RECEIVERS.to_vec();
    receivers[4] = receivers[1];
    let table = matrix(&receivers, &TRANSMITTERS);
    assert_says(calibrate("f.csv", table.as_bytes(), &[]), 1, &["receivers r2 and r5", "remove one"]);
    // Also if one of them has a constant delay.
    let mut rows: Vec<String> = table.lines().map(str::to_string).collect();
    let delayed = rows[4].split(',').map(|cell| (cell.parse::<f64>().expect("number") + 0.5).to_string());
    rows[4] = delayed.collect::<Vec<_>>().join(",");
    assert_says(calibrate("f.csv", rows.join("\n").as_bytes(), &[]), 1, &["receivers r2 and r5", "remove one"]);
}

#[test]
fn collinear_receivers_are_warned_of() {
    let receivers: Vec<[f64; 2]> = (0..7).map(|k| [k as f64 * 1.3 + 0.1 * (k * k) as f64, 0.0]).collect();
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join("f.csv");
    std::fs::write(&file, matrix(&receivers, &TRANSMITTERS)).expect("written");
    let output = run("tdoa", &["calibrate", text(&file)]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("one line"), "{said}");
    assert!(matches!(output.status.code(), Some(0 | 1)), "{said}");
}

#[test]
#[cfg_attr(not(recordings), ignore = "needs the recordings: SHARED_DIR names their folder")]
fn data_from_space_are_no_plane() {
    for recording in ["lund_tdoa_real/data1", "xtdoa_real"] {
        let file = end_to_end::recording(recording).join("pseudoranges_m.csv");
        let plane = &["calibrate", text(&file), "--dimensions", "2"];
        assert_says(of(plane), 1, &["do not fit a network in the plane"]);
    }
}

#[test]
fn wrong_arguments() {
    let good = matrix(&RECEIVERS, &TRANSMITTERS);
    let with = |more: &[&str]| calibrate("f.csv", good.as_bytes(), more);
    assert_says(with(&["--units", "s"]), 2, &["--speed"]);
    assert_says(with(&["--units", "s", "--speed", "-3"]), 2, &["speed must be positive"]);
    assert_says(with(&["--sigma", "0"]), 2, &["sigma must be positive"]);
    assert_says(with(&["--threads", "0"]), 2, &["--threads"]);
    assert_says(with(&["--frame", "r1,r2"]), 2, &["three names"]);
    assert_says(with(&["--frame", "r1,r2,r9"]), 2, &["no node is named \"r9\""]);
    assert_says(with(&["--truth", "none.csv"]), 2, &["none.csv"]);
    assert_says(with(&["--nonsense"]), 2, &["--nonsense"]);
    assert_says(with(&["--json", "no/such/folder/out.json"]), 2, &["out.json", "check that the directory exists"]);
}

#[test]
fn garbage_is_refused() {
    assert_says(calibrate("f.csv", &[0xff, 0xfe, 0, 1, 2], &[]), 2, &["line 1", "is no text"]);
    assert_says(calibrate("f.npy", b"not an array at all", &[]), 2, &["is not a .npy file"]);
    assert_says(of(&["simulate", "--missing", "2", "--output", "x"]), 2, &["between 0 and 1"]);
    assert_says(of(&["simulate", "--receivers", "0", "--output", "x"]), 2, &["empty"]);
    let many = ["simulate", "--receivers", "0", "--transmitters", "999999999999", "--output", "x"];
    assert_says(of(&many), 2, &["empty"]);
    assert_says(
        of(&["simulate", "--receivers", "99999999999", "--transmitters", "99999999999", "--output", "x"]),
        2,
        &["more than"],
    );
}

#[test]
fn a_hundred_thousand_columns() {
    // Three receivers cannot locate anything, however many transmitters they hear; said at once,
    // with names.
    let row = |i: usize| (0..100_000).map(|j| ((i * j) % 97).to_string()).collect::<Vec<_>>().join(",");
    let table = [row(1), row(2), row(3)].join("\n");
    assert_says(
        calibrate("wide.csv", table.as_bytes(), &[]),
        1,
        &["3 receivers and 100000 transmitters", "add 1 receiver"],
    );
    // The other way round; and the exact solvers, whose last refinement is over all measurements at
    // once.
    let table = vec!["1,2,3,5"; 100_000].join("\n");
    assert_says(calibrate("high.csv", table.as_bytes(), &[]), 1, &["100000 receivers", "2000", "in groups"]);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("high.csv");
    std::fs::write(&path, table).unwrap();
    assert_says(of(&["solve", path.to_str().unwrap()]), 1, &["100000r/4s", "5000 measurements", "calibrate"]);
    // More cells than any recording, most of them empty.
    let row = format!("1{}", ",".repeat(99_999));
    let table = vec![row; 241].join("\n");
    assert_says(calibrate("wide.csv", table.as_bytes(), &[]), 2, &["line 241", "more than 24000000 cells", "split"]);
}

/// A gigabyte that is no table: refused by its size before it is read, whatever it claims to be.
/// The file takes no space on the disk.
#[test]
fn a_gigabyte_of_garbage() {
    let directory = tempfile::tempdir().expect("directory");
    for name in ["f.csv", "f.npy", "f.mat"] {
        let path = directory.path().join(name);
        let file = std::fs::File::create(&path).expect("made");
        file.set_len(1 << 30).expect("sparse file");
        let started = std::time::Instant::now();
        assert_says(of(&["calibrate", text(&path)]), 2, &[name, "larger than 512 MB", "right file"]);
        assert!(started.elapsed() < std::time::Duration::from_secs(20));
    }
    // Below the limit, garbage is refused at its first bytes.
    let path = directory.path().join("zeros.csv");
    std::fs::File::create(&path).expect("made").set_len(200 << 20).expect("sparse file");
    assert_says(of(&["calibrate", text(&path)]), 2, &["line 1", "is no text"]);
}

/// Enough receivers and very many events: calibrated, in bounded memory.
#[test]
fn wide_tables_are_calibrated() {
    let transmitters: Vec<[f64; 2]> = (0..20_000)
        .map(|k| {
            let angle = f64::from(k) * 2.399_963;
            let radius = 0.5 + 5.0 * (f64::from(k % 1009) / 1009.0);
            [2.5 + radius * angle.cos(), 2.5 + radius * angle.sin()]
        })
        .collect();
    let directory = tempfile::tempdir().expect("directory");
    let file = directory.path().join("wide.csv");
    std::fs::write(&file, matrix(&RECEIVERS, &transmitters)).expect("written");
    let output = run("tdoa", &["calibrate", text(&file)]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("6r/20000s: 120000 measurements, 0 of them outliers"), "{said}");
}

#[test]
fn unusable_places_for_results() {
    let good = matrix(&RECEIVERS, &TRANSMITTERS);
    let directory = tempfile::tempdir().expect("directory");
    for option in ["--json", "--svg", "--html", "--nodes"] {
        let missing = directory.path().join("no/such/folder/out");
        assert_says(
            calibrate("f.csv", good.as_bytes(), &[option, text(&missing)]),
            2,
            &["out", "cannot be written", "check that the directory exists"],
        );
        assert_says(
            calibrate("f.csv", good.as_bytes(), &[option, text(directory.path())]),
            2,
            &["is a directory; give a file name in it"],
        );
        // A file in the place of a directory.
        let file = directory.path().join("file");
        std::fs::write(&file, "kept").expect("written");
        assert_says(calibrate("f.csv", good.as_bytes(), &[option, text(&file.join("out"))]), 2, &["cannot be written"]);
        assert_eq!(std::fs::read_to_string(&file).expect("file"), "kept");
    }
}

/// Where the system has a device that is always full, the message says so.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let good = matrix(&RECEIVERS, &TRANSMITTERS);
    assert_says(calibrate("f.csv", good.as_bytes(), &["--html", "/dev/full"]), 2, &["/dev/full", "No space left"]);
}
