//! `tdoa calibrate` with known positions, known distances and an unknown propagation speed.

use std::path::{Path, PathBuf};

use end_to_end::{run, simulated};
use serde_json::Value;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// A simulated recording in a new directory, and the true positions of its receivers.
fn recording() -> (tempfile::TempDir, PathBuf, Vec<[f64; 2]>) {
    let (directory, file) = simulated("--receivers 9 --transmitters 14 --noise 0.01 --seed 2");
    let nodes = tdoa::read::read_nodes(&directory.path().join("receivers.csv")).expect("positions");
    (directory, file, nodes.positions().into_iter().flatten().collect())
}

fn calibrate(arguments: &[&str]) -> (Option<Value>, String, Option<i32>) {
    let output = run("tdoa", &[&["calibrate"], arguments, &["--json", "-"]].concat());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!message.contains("panicked"), "{message}");
    (serde_json::from_slice(&output.stdout).ok(), message, output.status.code())
}

fn anchors(folder: &Path, truth: &[[f64; 2]], which: &[usize]) -> PathBuf {
    let path = folder.join("anchors.csv");
    let lines = which.iter().map(|&i| format!("r{},{},{}\n", i + 1, truth[i][0], truth[i][1]));
    std::fs::write(&path, format!("name,x,y\n{}", lines.collect::<String>())).expect("written");
    path
}

/// Largest distance of a receiver from the truth, without any alignment.
fn worst(found: &Value, truth: &[[f64; 2]]) -> f64 {
    let at = |i: usize, k: usize| found["receivers"][i][k].as_f64().expect("coordinate");
    let errors = truth.iter().enumerate().map(|(i, p)| (at(i, 0) - p[0]).hypot(at(i, 1) - p[1]));
    errors.fold(0.0, f64::max)
}

#[test]
fn anchors_fix_the_frame() {
    let (directory, file, truth) = recording();
    let known = anchors(directory.path(), &truth, &[1, 4, 6, 8]);
    let (found, message, status) = calibrate(&[text(&file), "--anchors", text(&known)]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    assert!(worst(&found, &truth) < 0.1, "{}", worst(&found, &truth));
    assert_eq!(found["anchored"].to_string(), "[false,true,false,false,true,false,true,false,true]");
    assert!(found["gauge"].as_str().expect("text").contains("known position"));
}

#[test]
fn known_transmitters_fix_the_frame() {
    let (directory, file, truth) = recording();
    let transmitters = tdoa::read::read_nodes(&directory.path().join("transmitters.csv")).expect("positions");
    let transmitters: Vec<[f64; 2]> = transmitters.positions().into_iter().flatten().collect();
    let path = directory.path().join("known.csv");
    let line = |name: &str, p: [f64; 2], sigma: f64| format!("{name},{},{},{sigma}\n", p[0], p[1]);
    // Three surveyed tags, one of them to 2 cm, and no receiver.
    let exact = [0, 4].map(|j| line(&format!("s{}", j + 1), transmitters[j], 0.0)).concat();
    std::fs::write(&path, format!("name,x,y,sigma\n{exact}{}", line("s9", transmitters[8], 0.02))).expect("written");
    let (found, message, status) = calibrate(&[text(&file), "--anchors", text(&path)]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    assert!(worst(&found, &truth) < 0.1, "{}", worst(&found, &truth));
    for j in [0, 4] {
        let off = |k: usize| (found["transmitters"][j][k].as_f64().expect("coordinate") - transmitters[j][k]).abs();
        assert!(off(0) < 1e-4 && off(1) < 1e-4, "s{}: {} {}", j + 1, off(0), off(1));
    }
    assert!(found["gauge"].as_str().expect("text").contains("known positions"));
    // One of them a metre off among six is named.
    let mut lines: String = (0..6).map(|j| line(&format!("s{}", j + 1), transmitters[j], 0.0)).collect();
    lines += &line("s8", transmitters[7].map(|x| x + 1.0), 0.0);
    std::fs::write(&path, format!("name,x,y,sigma\n{lines}")).expect("written");
    let (found, message, _) = calibrate(&[text(&file), "--anchors", text(&path)]);
    let warnings = found.expect("JSON")["warnings"].to_string();
    assert!(
        warnings.contains("the known position of s8 is") && warnings.contains("was not used"),
        "{message} {warnings}"
    );
}

#[test]
fn one_anchor_leaves_the_turn_open() {
    let (directory, file, truth) = recording();
    let known = anchors(directory.path(), &truth, &[3]);
    let (found, message, _) = calibrate(&[text(&file), "--anchors", text(&known)]);
    let found = found.expect("JSON");
    let at = |k: usize| found["receivers"][3][k].as_f64().expect("coordinate");
    assert!((at(0) - truth[3][0]).hypot(at(1) - truth[3][1]) < 1e-9, "{message}");
    assert!(found["warnings"].to_string().contains("free to turn about the only place"), "{}", found["warnings"]);
}

#[test]
fn the_speed_follows_from_measured_anchors() {
    let (directory, file, truth) = recording();
    let table = std::fs::read_to_string(&file).expect("table");
    let shorter = |cell: &str| cell.parse::<f64>().map_or(cell.to_string(), |f| (f / 1.05).to_string());
    let line = |line: &str| line.split(',').map(shorter).collect::<Vec<_>>().join(",") + "\n";
    let wrong = directory.path().join("wrong.csv");
    std::fs::write(&wrong, table.lines().map(line).collect::<String>()).expect("written");
    let path = directory.path().join("known.csv");
    let lines = [1, 4, 6, 8].map(|i: usize| format!("r{},{},{},0.005\n", i + 1, truth[i][0], truth[i][1])).concat();
    std::fs::write(&path, format!("name,x,y,sigma\n{lines}")).expect("written");
    let (found, message, status) = calibrate(&[text(&wrong), "--anchors", text(&path), "--estimate-speed"]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    let [factor, std] = ["factor", "factor_std"].map(|field| found["speed"][field].as_f64().expect("number"));
    assert!((factor - 1.05).abs() < 4.0 * std && std < 0.01, "{factor} +- {std}");
    assert!(worst(&found, &truth) < 0.1, "{}", worst(&found, &truth));
}

#[test]
fn anchors_have_standard_deviations() {
    let (directory, file, truth) = recording();
    let path = directory.path().join("measured.csv");
    let write = |lines: &str| std::fs::write(&path, format!("name,x,y,sigma\n{lines}")).expect("written");
    // Exact, 10 cm off with a deviation of 10 cm, exact, and one coordinate.
    let at = |i: usize, off: f64, sigma: &str| format!("r{},{},{},{sigma}\n", i + 1, truth[i][0] + off, truth[i][1]);
    write(&(at(1, 0.0, "0") + &at(4, 0.1, "0.1") + &at(6, 0.0, "0") + &format!("r9,,{},0.01\n", truth[8][1])));
    let (found, message, status) = calibrate(&[text(&file), "--anchors", text(&path)]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    assert_eq!(found["anchored"].to_string(), "[false,true,false,false,false,false,true,false,false]");
    // Nearer to the truth than the position that was given.
    assert!(worst(&found, &truth) < 0.08, "{}", worst(&found, &truth));
    write(&(at(1, 0.0, "0.1") + &at(4, 0.0, "")));
    let (_, message, status) = calibrate(&[text(&file), "--anchors", text(&path)]);
    assert_eq!(status, Some(2), "{message}");
    assert!(message.contains("the standard deviation of r5 is missing"), "{message}");
}

#[test]
fn a_node_table_gives_anchors_with_their_deviations() {
    let (directory, file, truth) = recording();
    let nodes = directory.path().join("nodes.csv");
    let known = anchors(directory.path(), &truth, &[1, 4, 6, 8]);
    let (_, message, status) = calibrate(&[text(&file), "--anchors", text(&known), "--nodes", text(&nodes)]);
    assert_eq!(status, Some(0), "{message}");
    let (found, message, status) = calibrate(&[text(&file), "--anchors", text(&nodes)]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    // What was held has deviation 0 in the table and is held again; the others were measured.
    assert_eq!(found["anchored"].to_string(), "[false,true,false,false,true,false,true,false,true]");
    assert!(worst(&found, &truth) < 0.1, "{}", worst(&found, &truth));
    // Along x to a micrometre, along y to a metre: one coordinate is kept, the other is that of the measurements.
    let at = |i: usize, off: f64, std: &str| format!("r{},{},{},{std}\n", i + 1, truth[i][0], truth[i][1] + off);
    let lines = at(1, 0.0, "0,0") + &at(4, 0.0, "0,0") + &at(6, 0.0, "0,0") + &at(8, 0.5, "1e-6,1");
    std::fs::write(&nodes, format!("name,x,y,std_x,std_y\n{lines}")).expect("written");
    let (found, message, status) = calibrate(&[text(&file), "--anchors", text(&nodes)]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    let of = |k: usize| found["receivers"][8][k].as_f64().expect("coordinate") - truth[8][k];
    assert!(of(0).abs() < 1e-4 && of(1).abs() < 0.1, "{} {}", of(0), of(1));
}

#[test]
fn three_anchors_that_contradict_each_other_are_not_trusted() {
    let (directory, file, mut truth) = recording();
    truth[6][0] += 2.8;
    let known = anchors(directory.path(), &truth, &[1, 4, 6]);
    let (found, message, status) = calibrate(&[text(&file), "--anchors", text(&known)]);
    assert_eq!(status, Some(1), "{message}");
    assert!(message.contains("the known positions contradict the measurements"), "{message}");
    let found = found.expect("JSON");
    assert!(found["unique"] == false && found["anchors_agree"] == false);
    let warnings = found["warnings"].to_string();
    assert!(warnings.contains("one of the three may be wrong"), "{warnings}");
}

#[test]
fn the_speed_of_sound_and_of_light() {
    let (directory, file, truth) = recording();
    let known = anchors(directory.path(), &truth, &[1, 4, 6, 8]);
    let table = std::fs::read_to_string(&file).expect("table");
    for speed in [343.0, 299_792_458.0] {
        let seconds = |cell: &str| cell.parse::<f64>().map_or(cell.to_string(), |f| (f / speed).to_string());
        let line = |line: &str| line.split(',').map(seconds).collect::<Vec<_>>().join(",");
        let in_seconds = directory.path().join("seconds.csv");
        std::fs::write(&in_seconds, table.lines().map(|l| line(l) + "\n").collect::<String>()).expect("written");
        let units = [text(&in_seconds), "--units", "s", "--estimate-speed"];
        let (found, message, status) = calibrate(&[&units[..], &["--anchors", text(&known)]].concat());
        assert_eq!(status, Some(0), "{message}");
        let found = found.expect("JSON");
        let estimate = found["speed"]["metres_per_second"].as_f64().expect("speed");
        assert!((estimate / speed - 1.0).abs() < 0.01, "{estimate} of {speed}");
        assert!(worst(&found, &truth) < 0.1, "{}", worst(&found, &truth));

        let distances = directory.path().join("distances.csv");
        let d = |a: usize, b: usize| (truth[a][0] - truth[b][0]).hypot(truth[a][1] - truth[b][1]);
        let list = format!("receiver,receiver,distance\nr1,r5,{}\nr7,r3,{}\n", d(0, 4), d(6, 2));
        std::fs::write(&distances, list).expect("written");
        let (found, message, status) = calibrate(&[&units[..], &["--distances", text(&distances)]].concat());
        assert_eq!(status, Some(0), "{message}");
        let estimate = found.expect("JSON")["speed"]["metres_per_second"].as_f64().expect("speed");
        assert!((estimate / speed - 1.0).abs() < 0.01, "{estimate} of {speed}");
    }
}

#[test]
fn unusable_knowledge_is_refused() {
    let (directory, file, truth) = recording();
    let says = |arguments: &[&str], parts: &[&str]| {
        let (_, message, status) = calibrate(&[&[text(&file)], arguments].concat());
        assert_eq!(status, Some(2), "{message}");
        for part in parts {
            assert!(message.contains(part), "{part:?} is not in: {message}");
        }
    };
    let write = |name: &str, content: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, content).expect("written");
        path
    };
    let known = anchors(directory.path(), &truth, &[1]);
    says(&["--estimate-speed"], &["no distance between receivers is known", "two anchors or a distance"]);
    says(&["--estimate-speed", "--anchors", text(&known)], &["two anchors or a distance"]);
    says(&["--anchors", "none.csv"], &["none.csv"]);
    says(&["--anchors", text(&write("a.csv", "name,x,y\nr77,1,2\n"))], &["a.csv", "\"r77\"", "r1, r2, r3", "s1, s2"]);
    says(&["--anchors", text(&write("b.csv", "name,x,y\nr1,1,2\nr1,1,2\n"))], &["r1 is there twice"]);
    says(&["--anchors", text(&write("c.csv", "1,2\n3,4\n"))], &["name,x,y"]);
    says(&["--anchors", text(&write("d.csv", "name,x,y\nr1,1e300,2\nr2,1,1\n"))], &["r1", "too large"]);
    let of_height = write("g.csv", "name,x,y,z\nr1,1,2,0\nr2,,,0\n");
    says(&["--dimensions", "2", "--anchors", text(&of_height)], &["r2 has neither x nor y"]);
    let taped = |content: &str, parts: &[&str]| says(&["--distances", text(&write("f.csv", content))], parts);
    taped("r1,r2,3\n", &["r1 and r2 has no standard deviation", "fourth column", "--estimate-speed"]);
    taped("r1,r2,3,none\n", &["line 1", "is not a standard deviation"]);
    taped("r1,r2,3,-1\n", &["line 1", "is not a standard deviation"]);
    let distances = |content: &str, parts: &[&str]| {
        says(&["--estimate-speed", "--distances", text(&write("e.csv", content))], parts);
    };
    distances("r1,r2,x\nr1,r3,-4\n", &["line 2", "is not a distance"]);
    distances("r1,r77,4\n", &["line 1", "\"r77\""]);
    distances("r1,4\n", &["line 1", "two names"]);
    distances("r1,r1,4\n", &["makes no sense"]);
    distances("a,b,distance\n", &["no distances"]);
}

/// Distances of a network, with and without the knowledge that transmitters have no offsets.
#[test]
fn ranges_have_no_offsets() {
    let (directory, file) = simulated("--ranges --receivers 6 --transmitters 12 --noise 0.01 --seed 4");
    let truth = directory.path().join("receivers.csv");
    let error = |options: &[&str]| {
        let (found, message, status) = calibrate(&[&[text(&file), "--truth", text(&truth)], options].concat());
        assert_eq!(status, Some(0), "{message}");
        let found = found.expect("JSON");
        (found["truth"]["receiver_rms"].as_f64().expect("number"), found)
    };
    let (with_offsets, found) = error(&[]);
    assert_eq!(found["emissions"], "unknown");
    let (without, found) = error(&["--ranges"]);
    assert_eq!(found["emissions"], "known");
    assert!(found["offsets"].as_array().expect("list").iter().all(|offset| offset == 0.0));
    // Standard deviations of the distances are 1 cm, and each receiver has twelve.
    assert!(without < 0.01 && without < with_offsets, "{without} {with_offsets}");

    // A constant that all share costs a little, and is told: none was added.
    let (but_for_one, found) = error(&["--emissions", "constant"]);
    assert_eq!(found["emissions"], "constant");
    let of = |name: &str| found[name][0].as_f64().expect("number");
    assert!(but_for_one < with_offsets && of("offsets").abs() < 4.0 * of("offset_std"), "{but_for_one} {found}");

    // A clock of each receiver costs more, and is told: all agree with the send times.
    let (with_clocks, found) = error(&["--ranges", "--receiver-delays", "all"]);
    let clocks = found["clocks"].as_array().expect("list");
    assert!(clocks.len() == 6 && without < with_clocks && with_clocks < 0.1, "{without} {with_clocks}");
    for clock in clocks {
        let of = |name: &str| clock[name].as_f64().expect("number");
        assert!(of("offset").abs() < 4.0 * of("offset_std"), "{clock}");
    }
    let (_, message, status) = calibrate(&[text(&file), "--receiver-delays", "all", "--receiver-clocks", "rate"]);
    assert!(status == Some(2) && message.contains("give one of both"), "{message}");
    let (_directory, file) = simulated("--receivers 6 --transmitters 12 --noise 0.01");
    let (_, message, status) = calibrate(&[text(&file), "--ranges"]);
    assert!(status == Some(2) && message.contains("below zero"), "{message}");
}

/// Distances between receivers by a tape, one of them misread.
#[test]
fn taped_distances_are_measurements() {
    let (directory, file) = simulated("--ranges --receivers 6 --transmitters 20 --noise 0.1 --seed 2");
    let truth = directory.path().join("receivers.csv");
    let nodes = tdoa::read::read_nodes(&truth).expect("positions");
    let places: Vec<[f64; 2]> = nodes.positions().into_iter().flatten().collect();
    let d = |a: usize, b: usize| (places[a][0] - places[b][0]).hypot(places[a][1] - places[b][1]);
    let tape = directory.path().join("tape.csv");
    let list = format!(
        "from,to,distance,sigma\nr1,r4,{},0.001\nr6,r2,{},0.001\nr3,r5,{},0.001\n",
        d(0, 3),
        d(5, 1),
        d(2, 4) + 1.0
    );
    std::fs::write(&tape, list).expect("written");
    let calibrated = |options: &[&str]| {
        let (found, message, status) =
            calibrate(&[&[text(&file), "--ranges", "--truth", text(&truth)], options].concat());
        assert_eq!(status, Some(0), "{message}");
        found.expect("JSON")
    };
    let found = calibrated(&["--distances", text(&tape)]);
    let taped = found["distances"].as_array().expect("list");
    let inliers: Vec<bool> = taped.iter().map(|known| known["inlier"].as_bool().expect("bool")).collect();
    assert_eq!(inliers, [true, true, false], "{found}");
    assert!((taped[0]["found"].as_f64().expect("number") - d(0, 3)).abs() < 0.004, "{found}");
    let printed = run("tdoa", &["calibrate", text(&file), "--ranges", "--distances", text(&tape)]).stdout;
    let printed = String::from_utf8(printed).expect("UTF-8");
    assert!(printed.contains("3 measured distances between receivers: 2 agree with the network"), "{printed}");
    assert!(found["warnings"].to_string().contains("not used: r3-r5 (measured"), "{found}");
    assert!(calibrated(&[]).get("distances").is_none());
}

/// Recorders of two channels whose clocks were started apart and drift: their offsets and rates, against those of the first.
#[test]
fn recorders_have_clocks_of_their_own() {
    let clocks = "--channels 2 --delays 300 --rate-sigma 20 --duration 200000";
    let (directory, file) = simulated(&format!("{clocks} --receivers 10 --transmitters 30 --noise 0.01 --seed 3"));
    let (file, truth) = (text(&file), directory.path().join("receivers.csv"));
    let run = |options: &[&str]| calibrate(&[&[file, "--dimensions", "2", "--truth", text(&truth)], options].concat());
    let (found, message, status) = run(&["--receiver-clocks", "rate"]);
    assert_eq!(status, Some(0), "{message}");
    let found = found.expect("JSON");
    // Receivers are as well determined as by thirty transmitters each, of a noise of a centimetre.
    assert!(found["truth"]["receiver_rms"].as_f64().expect("number") < 0.03, "{found}");
    let known = std::fs::read_to_string(directory.path().join("clocks.csv")).expect("clocks");
    let known: Vec<Vec<f64>> = (known.lines().skip(1))
        .map(|line| line.split(',').skip(1).map(|number| number.parse().expect("number")).collect())
        .collect();
    let clocks = found["clocks"].as_array().expect("list");
    assert_eq!(clocks.len(), 5);
    for (k, clock) in clocks.iter().enumerate() {
        let of = |name: &str| clock[name].as_f64().expect("number");
        assert_eq!(clock["recorder"], format!("rec{}", k + 1));
        // Of two readings of one time, each off by its own clock.
        let time = (of("at") - known[2 * k][0]) / (1.0 + known[2 * k][1]);
        let first = time * (1.0 + known[0][1]) + known[0][0];
        let off = of("at") - first - of("offset");
        assert!(off.abs() <= 4.0 * of("offset_std") + 1e-6 && of("offset_std") < 0.05, "{clock} {off}");
        let rate = (1.0 + known[2 * k][1]) / (1.0 + known[0][1]) - 1.0;
        assert!((rate - of("rate")).abs() <= 4.0 * of("rate_std") + 1e-12 && of("rate_std") < 1e-6, "{clock} {rate}");
    }
    // One clock is not enough.
    let (_, _, status) = run(&[]);
    assert_eq!(status, Some(1));
    let write = |content: &str| {
        let path = directory.path().join("recorders.csv");
        std::fs::write(&path, content).expect("written");
        path
    };
    let (found, message, status) = run(&[
        "--receiver-clocks",
        "rate",
        "--recorders",
        text(&write("receiver,recorder\nrec1:1,left\nrec1:2,right\n")),
    ]);
    assert_eq!(status, Some(0), "{message}");
    assert_eq!(found.expect("JSON")["clocks"].as_array().expect("list").len(), 6);
    let (_, message, status) = run(&["--receiver-clocks", "rate", "--recorders", text(&write("rec9,x\nrec8,x\n"))]);
    assert!(status == Some(2) && message.contains("no receiver is named \"rec8\""), "{message}");
}
