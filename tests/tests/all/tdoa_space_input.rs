//! Input in space that is incomplete or determines nothing: a clear word, and nothing wrong with exit
//! status 0.

use std::path::Path;

use end_to_end::{run, simulated};
use serde_json::Value;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// JSON (null if there is none), standard output and error together, and exit status of `tdoa calibrate`.
fn calibrate(file: &Path, words: &[&str]) -> (Value, String, Option<i32>) {
    let json = file.with_extension("json");
    let output = run("tdoa", &[&["calibrate", text(file), "--json", text(&json)], words].concat());
    let said = [output.stdout, output.stderr].map(|said| String::from_utf8_lossy(&said).into_owned()).concat();
    assert!(!said.contains("panicked"), "{said}");
    let found = std::fs::read(&json).ok().and_then(|text| serde_json::from_slice(&text).ok());
    (found.unwrap_or_default(), said, output.status.code())
}

const ROOM: &str = "--receivers 10 --transmitters 20 --layout 10x8x3 --noise 0.01 --seed 4";

/// The file of receivers with the z of some left out.
fn without_z(receivers: &Path, names: &[&str]) -> String {
    let all = std::fs::read_to_string(receivers).expect("receivers");
    let line = |line: &str| match line.rsplit_once(',') {
        Some((rest, _)) if names.iter().any(|name| line.starts_with(&format!("{name},"))) => format!("{rest},\n"),
        _ => format!("{line}\n"),
    };
    all.lines().map(line).collect()
}

#[test]
fn a_z_that_is_missing_in_some_rows() {
    let (directory, file) = simulated(ROOM);
    let truth = directory.path().join("receivers.csv");
    let gaps = directory.path().join("gaps.csv");
    std::fs::write(&gaps, without_z(&truth, &["r3"])).expect("written");
    // A truth without a height is no truth in space.
    let (_, said, status) = calibrate(&file, &["--truth", text(&gaps), "--dimensions", "3"]);
    assert!(status == Some(2) && said.contains("r3 has no z; a truth in space needs x, y and z"), "{said}");
    let (found, said, status) = calibrate(&file, &["--truth", text(&gaps)]);
    assert!(status == Some(0) && said.contains("nothing is compared") && said.contains("r3 has no z"), "{said}");
    assert!(found["dimensions"] == 3 && found.get("truth").is_none(), "{}", found["truth"]);
    // An anchor without a height has its place in the plan, and its height is found.
    let rows: Vec<String> = without_z(&truth, &["r3"]).lines().take(6).map(str::to_owned).collect();
    std::fs::write(&gaps, rows.join("\n") + "\n").expect("written");
    let (found, said, status) = calibrate(&file, &["--anchors", text(&gaps), "--truth", text(&truth)]);
    assert_eq!(status, Some(0), "{said}");
    let coordinates = |name: &str| -> Vec<f64> {
        let all = std::fs::read_to_string(&truth).expect("truth");
        let row = all.lines().find(|line| line.starts_with(&format!("{name},"))).expect("row");
        row.split(',').skip(1).map(|x| x.parse().expect("number")).collect()
    };
    let [at, truth] = [found["receivers"][2].clone(), coordinates("r3").into()];
    let off = |k: usize| (at[k].as_f64().expect("number") - truth[k].as_f64().expect("number")).abs();
    assert!(off(0) < 1e-3 && off(1) < 1e-3 && off(2) < 0.1, "{at} {truth}");
    // Rows of different lengths say the same as empty cells; words are no numbers.
    let short = std::fs::read_to_string(&gaps).expect("gaps").replace(",\n", "\n");
    std::fs::write(&gaps, short).expect("written");
    assert_eq!(calibrate(&file, &["--anchors", text(&gaps)]).0["receivers"], found["receivers"]);
    std::fs::write(&gaps, rows.join("\n").replace(",\n", ",high\n")).expect("written");
    let (_, said, status) = calibrate(&file, &["--anchors", text(&gaps)]);
    assert!(status == Some(2) && said.contains("line 4") && said.contains("\"high\" is not a coordinate"), "{said}");
}

#[test]
fn five_receivers_in_space() {
    // 5 x 8 measurements for 3 x 5 + 4 x 8 - 6 = 41 unknowns.
    let (_directory, file) = simulated("--receivers 5 --transmitters 8 --layout 10x8x3 --noise 0.01");
    let (found, said, status) = calibrate(&file, &["--dimensions", "3"]);
    assert!(status == Some(1) && found.is_null(), "{said}");
    for part in ["5 receivers and 8 transmitters", "in space", "5 and 9", "add 1 receiver or 1 transmitter"] {
        assert!(said.contains(part), "{part:?} is not in: {said}");
    }
    // As many measurements as unknowns: every network that fits is as good, and none is called unique.
    let (_directory, file) = simulated("--receivers 5 --transmitters 9 --layout 10x8x3 --noise 0.01");
    let (found, said, status) = calibrate(&file, &["--dimensions", "3"]);
    assert!(status == Some(1) || found["unique"] == false, "{said}");
}

/// Pseudoranges with errors of this size by a fixed pattern, as CSV.
fn matrix(receivers: &[[f64; 3]], transmitters: &[[f64; 3]], size: f64) -> String {
    let row = |(i, r): (usize, &[f64; 3])| {
        let cell = |(j, s): (usize, &[f64; 3])| {
            let distance = (0..3).map(|k| (r[k] - s[k]).powi(2)).sum::<f64>().sqrt();
            let error = 2.0 * size * ((0.618 * (17 * i + 5 * j + i * j) as f64).fract() - 0.5);
            (distance + error + j as f64).to_string()
        };
        transmitters.iter().enumerate().map(cell).collect::<Vec<String>>().join(",") + "\n"
    };
    receivers.iter().enumerate().map(row).collect()
}

/// Points spread over a room.
fn spread(count: usize, shift: f64) -> Vec<[f64; 3]> {
    let at = |k: usize, step: f64, side: f64| side * (shift + step * k as f64).fract();
    (0..count).map(|k| [at(k, 0.7549, 10.0), at(k, 0.5698, 8.0), at(k, 0.4302, 3.0)]).collect()
}

#[test]
fn nodes_in_one_line_of_space_leave_the_others_to_turn_about_it() {
    let line = |count: usize| (0..count).map(|k| [1.1 * k as f64, 4.0, 1.5]).collect::<Vec<[f64; 3]>>();
    let directory = tempfile::tempdir().expect("directory");
    for (kind, receivers, transmitters) in
        [("receivers", line(10), spread(20, 0.1)), ("transmitters", spread(12, 0.3), line(14))]
    {
        let file = directory.path().join(format!("{kind}.csv"));
        std::fs::write(&file, matrix(&receivers, &transmitters, 0.0)).expect("written");
        let (found, said, status) = calibrate(&file, &["--dimensions", "3"]);
        assert_eq!((status, &found["unique"]), (Some(1), &false.into()), "{kind}: {said}");
        std::fs::write(&file, matrix(&receivers, &transmitters, 0.01)).expect("written");
        let (found, said, status) = calibrate(&file, &["--dimensions", "3"]);
        assert_eq!((status, &found["unique"]), (Some(1), &false.into()), "{kind}: {said}");
        assert!(said.contains(&format!("the {kind} lie in one line")), "{kind}: {said}");
    }
}
