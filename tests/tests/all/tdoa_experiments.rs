//! `tdoa experiment` in small: every kind runs, goes on where it was stopped, and gives the same
//! tables on any number of threads.

use std::path::Path;

use end_to_end::{recording, run};

/// Runs an experiment and gives its summary table, line by line.
fn experiment(words: &str, output: &Path, threads: &str) -> Vec<String> {
    let output = output.to_str().expect("UTF-8 path");
    let words: Vec<&str> = ["experiment"].into_iter().chain(words.split(' ')).collect();
    let result = run("tdoa", &[words.as_slice(), &["--threads", threads, "--output", output]].concat());
    assert!(result.status.success(), "{words:?}: {}", String::from_utf8_lossy(&result.stderr));
    String::from_utf8_lossy(&result.stdout).lines().map(str::to_owned).collect()
}

fn cell(header: &str, line: &str, column: &str) -> String {
    let at = header.split(',').position(|name| name == column).unwrap_or_else(|| panic!("no column {column}"));
    line.split(',').nth(at).expect("cell").to_owned()
}

fn number(header: &str, line: &str, column: &str) -> f64 {
    cell(header, line, column).parse().expect("number")
}

#[test]
fn table2_goes_on_where_it_was_stopped() {
    let directory = tempfile::tempdir().expect("directory");
    let (one, two) = (directory.path().join("one"), directory.path().join("two"));
    let whole = experiment("table2 --instances 24", &one, "2");
    experiment("table2 --instances 9", &two, "1");
    // Stopped in the middle of a line.
    let trials = two.join("trials.csv");
    let text = std::fs::read_to_string(&trials).expect("trials");
    std::fs::write(&trials, &text[..text.len() - 4]).expect("written");
    assert_eq!(experiment("table2 --instances 24", &two, "2"), whole);
    for name in ["trials.csv", "summary.csv", "histogram.csv", "counts.svg"] {
        assert!(std::fs::read(one.join(name)).expect(name) == std::fs::read(two.join(name)).expect(name), "{name}");
    }
    // 180 roots in all (Groebner basis); at least one physical network, the true one; real ones in
    // pairs.
    let trials = std::fs::read_to_string(&trials).expect("trials");
    assert_eq!(trials.lines().count(), 25);
    assert!(trials.lines().skip(1).all(|line| line.split(',').nth(1) == Some("180")));
    let physical = whole.iter().find(|line| line.starts_with("physical,")).expect("row");
    assert!(number(&whole[0], physical, "min") >= 1.0);
    let real = whole.iter().find(|line| line.starts_with("positive_definite,")).expect("row");
    assert_eq!((cell(&whole[0], real, "odd"), cell(&whole[0], real, "with_lost_paths")), ("0".into(), "0".into()));
}

#[test]
fn clean_finds_every_network() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("clean --configuration 6r/4s,4r/5s --instances 6", directory.path(), "2");
    assert_eq!(lines.len(), 3);
    for line in &lines[1..] {
        assert_eq!((cell(&lines[0], line, "found"), cell(&lines[0], line, "paths_lost")), ("6".into(), "0".into()));
        assert!(number(&lines[0], line, "position_median") < 1e-12);
    }
    for name in ["6r4s.svg", "4r5s.svg", "histogram.csv"] {
        assert!(directory.path().join(name).exists(), "{name}");
    }
}

#[test]
fn noise_errors_grow_with_the_noise() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("noise --configuration 7r/3s --noise 1e-6,1e-3 --instances 9", directory.path(), "2");
    let [fine, coarse] = [1, 2].map(|k| number(&lines[0], &lines[k], "position_refined_median"));
    // Proportional to the noise to first order.
    assert!((100.0..10_000.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn calibrate_compares_sources_of_starts() {
    let directory = tempfile::tempdir().expect("directory");
    let words =
        "calibrate --configuration 10r/20s --outliers 0 --instances 2 --method portfolio,restarts,minimal --starts 12";
    let lines = experiment(words, directory.path(), "2");
    assert_eq!(lines.len(), 4);
    for line in &lines[1..] {
        assert_eq!(cell(&lines[0], line, "success"), "1", "{line}");
    }
    let lines = experiment("coverage --configuration 8r/12s --instances 5", &directory.path().join("coverage"), "2");
    // The Cramer-Rao bound is a mean over noise; of five networks with 13 degrees of freedom each,
    // the root mean square ratio lies well within a factor of two.
    assert!((0.5..2.0).contains(&number(&lines[0], &lines[1], "rms_over_bound")));
    let wrong = run("tdoa", &["experiment", "calibrate", "--starts", "1,2", "--output", "unused"]);
    assert_eq!(wrong.status.code(), Some(2));
}

#[test]
fn conditions_stand_beside_the_oracle() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("conditions --only sigma --instances 1", directory.path(), "2");
    // Told deviations of 1, 0.67, 0.5 and 0.2 times the true one.
    assert_eq!(lines.len(), 5);
    let of = |line: usize, column: &str| cell(&lines[0], &lines[line], column);
    assert!((1..5).all(|line| of(line, "success") == "1" && of(line, "oracle") == "1"), "{lines:?}");
    assert_eq!((of(1, "warned"), of(4, "warned")), ("0".into(), "1".into()));
}

#[test]
fn growth_takes_time_and_memory() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("growth --configuration 10r/20s,20r/30s --missing 0.1", directory.path(), "2");
    assert_eq!(lines.len(), 3);
    assert!(lines[1..].iter().all(|line| cell(&lines[0], line, "success") == "true"), "{lines:?}");
}

#[test]
#[cfg_attr(not(recordings), ignore = "needs the recordings: SHARED_DIR names their folder")]
fn damaged_recordings_beside_the_oracle() {
    let folder = recording("lund_floor_planar/h40");
    let directory = tempfile::tempdir().expect("directory");
    let words = format!("damaged --recordings {} --instances 1 --triples 9", folder.display());
    let lines = experiment(&words, directory.path(), "2");
    for line in &lines[1..3] {
        assert_eq!(cell(&lines[0], line, "within_1.1_of_oracle"), "1", "{line}");
    }
}

#[test]
#[cfg_attr(not(recordings), ignore = "needs the recordings: SHARED_DIR names their folder")]
fn parts_of_a_recording_in_space_beside_the_oracle() {
    let folder = recording("lund_tdoa_real/data3");
    let directory = tempfile::tempdir().expect("directory");
    let words = format!("damaged --dimensions 3 --recordings {} --instances 1 --transmitters 24", folder.display());
    let lines = experiment(&words, directory.path(), "2");
    // As it is, damaged, and 24 of the 97 chirps.
    assert_eq!(lines.len(), 4);
    for line in &lines[1..] {
        assert_eq!(cell(&lines[0], line, "within_1.1_of_oracle"), "1", "{line}");
        assert_eq!(cell(&lines[0], line, "unique_and_wrong"), "0", "{line}");
    }
    assert_eq!(cell(&lines[0], &lines[3], "transmitters"), "24");
}

#[test]
#[cfg_attr(not(recordings), ignore = "needs the recordings: SHARED_DIR names their folder")]
fn recordings_reduced_to_small_sizes_beside_the_oracle() {
    let folders = format!("{},{}", recording("lund_tdoa_real/data3").display(), recording("xtdoa_real").display());
    let words = format!("reduced --recordings {folders} --configuration 8r/5s,7r/6s --instances 4");
    let (one, two) = (tempfile::tempdir().expect("directory"), tempfile::tempdir().expect("directory"));
    let lines = experiment(&words, one.path(), "2");
    assert_eq!(lines.len(), 3);
    for line in &lines[1..] {
        let of = |column: &str| number(&lines[0], line, column);
        assert_eq!((of("tried"), of("special"), of("unexplained")), (8.0, 0.0, 0.0), "{line}");
        // Whatever errors do, without them the network is found.
        assert_eq!(of("found") + of("control"), 8.0, "{line}");
        assert!(of("best_is_oracle") <= of("found") && of("oracle_rms_median") < 0.5, "{line}");
    }
    // All columns but the last, the time, are the same on one thread.
    experiment(&words, two.path(), "1");
    let [first, second] = [one.path(), two.path()].map(|folder| {
        let text = std::fs::read_to_string(folder.join("trials.csv")).expect("trials");
        text.lines().map(|line| line.rsplit_once(',').expect("cells").0.to_owned()).collect::<Vec<_>>()
    });
    assert_eq!(first, second);
    let output = one.path().to_str().expect("UTF-8 path");
    let folder = recording("xtdoa_real").display().to_string();
    let refused = |size: &str| {
        let words = ["experiment", "reduced", "--recordings", &folder, "--configuration", size, "--output", output];
        let result = run("tdoa", &words);
        (result.status.code(), String::from_utf8_lossy(&result.stderr).into_owned())
    };
    let (status, words) = refused("13r/4s");
    assert!(status == Some(2) && words.contains("no recording has 13 receivers"), "{words}");
    let (status, words) = refused("5r/9s");
    assert!(status == Some(2) && words.contains("not solved exactly in space"), "{words}");
}

#[test]
fn rooms_in_space_and_the_choice_of_the_dimension() {
    let directory = tempfile::tempdir().expect("directory");
    let words = "calibrate --dimensions 3 --configuration 12r/20s --outliers 0 --instances 2";
    let lines = experiment(words, directory.path(), "2");
    assert_eq!(cell(&lines[0], &lines[1], "success"), "1", "{}", lines[1]);
    assert!((0.5..2.0).contains(&number(&lines[0], &lines[1], "rms_over_bound")));
    // 240 measurements without the missing tenth, 36 coordinates of receivers and 80 of transmitters with offsets but for six of the frame.
    assert_eq!(cell(&lines[0], &lines[1], "redundancy"), "106");
    let words = "dimension --configuration 10r/20s --outliers 0 --instances 1";
    let lines = experiment(words, &directory.path().join("dimension"), "2");
    let of = |line: usize, column: &str| cell(&lines[0], &lines[line], column);
    assert_eq!((of(1, "height"), of(1, "in_the_plane"), of(1, "in_space")), ("0".into(), "1".into(), "0".into()));
    assert_eq!((of(2, "height"), of(2, "in_the_plane"), of(2, "in_space")), ("3".into(), "0".into(), "1".into()));
}

#[test]
fn families_with_known_numbers_of_solutions() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("families --kind species,minors --instances 2 --searches 1", directory.path(), "2");
    for row in &lines[1..] {
        let of = |column: &str| cell(&lines[0], row, column);
        assert_eq!((of("families"), of("right"), of("wrong")), ("2".into(), "2".into(), "0".into()), "{row}");
    }
    // Nothing is searched where another program is to count.
    let folder = directory.path().join("singular");
    experiment("families --kind component,minors --instances 1 --singular", &folder, "1");
    let text = std::fs::read_to_string(folder.join("families.sing")).expect("written");
    assert_eq!((text.matches("ideal I =").count(), folder.join("trials.csv").exists()), (4, false));
}

#[test]
fn another_table_in_the_folder_is_left_alone() {
    let directory = tempfile::tempdir().expect("directory");
    std::fs::write(directory.path().join("trials.csv"), "a,b\n1,2\n").expect("written");
    let output = directory.path().to_str().expect("UTF-8 path");
    let result = run("tdoa", &["experiment", "table2", "--instances", "1", "--output", output]);
    assert_eq!(result.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&result.stderr).contains("other columns"));
    assert_eq!(std::fs::read_to_string(directory.path().join("trials.csv")).expect("table"), "a,b\n1,2\n");
}

#[test]
fn both_routes_lead_to_the_same_networks() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("routes --configuration 5r/6s --instances 5", directory.path(), "2");
    assert_eq!(lines.len(), 2);
    // Five roots each.
    for (column, expected) in [("agree", "5"), ("roots_stored", "25"), ("roots_polyhedral", "25")] {
        assert_eq!(cell(&lines[0], &lines[1], column), expected, "{}", lines[1]);
    }
}

#[test]
fn speed_is_measured_on_one_thread_and_on_all() {
    let directory = tempfile::tempdir().expect("directory");
    let lines = experiment("speed --configuration 5r/6s,6r/3s --instances 2", directory.path(), "2");
    assert_eq!(lines.len(), 3);
    for (line, paths) in lines[1..].iter().zip([10.0, 360.0]) {
        let number = |column| number(&lines[0], line, column);
        assert_eq!((number("paths"), number("threads")), (paths, 2.0), "{line}");
        // Every step needs a Jacobian where it arrives.
        assert!(number("jacobians_a_path") > number("steps_a_path") && number("steps_a_path") > 1.0, "{line}");
        assert!(number("solves_a_second") > 0.0 && number("solves_a_second_on_all") > 0.0, "{line}");
    }
}
