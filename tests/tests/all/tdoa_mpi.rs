//! `mpirun tdoa experiment`: the same tables on any number of ranks, also after some of them died.

use crate::mpi::{on_ranks, process, said, signal, succeeds, text, waited};
use end_to_end::run;
use std::path::Path;
use std::process::Stdio;

/// A table of a folder without the columns that take times.
fn untimed(folder: &Path, name: &str) -> Vec<Vec<String>> {
    let table = std::fs::read_to_string(folder.join(name)).expect(name);
    let timed = |column: &str| column.contains("milliseconds") || column.contains("seconds");
    let header: Vec<bool> = table.lines().next().expect("header").split(',').map(timed).collect();
    let kept = |line: &str| {
        let cells = line.split(',').zip(&header).filter(|(_, timed)| !**timed);
        cells.map(|(cell, _)| cell.to_owned()).collect()
    };
    table.lines().map(kept).collect()
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn tables_are_the_same_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().expect("directory");
    for (name, words) in [
        ("table2", &["--instances", "10"][..]),
        ("clean", &["--configuration", "9r/4s", "--instances", "100"]),
        ("coverage", &["--configuration", "6r/10s", "--instances", "2"]),
    ] {
        let experiment = |output: &Path, threads: &str| {
            let words = [&["experiment", name], words, &["--threads", threads, "--output"]].concat();
            words.into_iter().map(str::to_owned).chain([text(output)]).collect::<Vec<_>>()
        };
        let alone = folder.path().join(name);
        let words = experiment(&alone, "2");
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        assert!(run("tdoa", &words).status.success());
        for (count, threads) in [(1, "1"), (2, "1"), (4, "1"), (2, "2")] {
            let shared = folder.path().join(format!("{name}{count}{threads}"));
            let words = experiment(&shared, threads);
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let output = on_ranks("tdoa", count, &words).output().expect("mpirun runs");
            assert!(output.status.success(), "{name} on {count} ranks: {}", said(&output));
            for table in ["trials.csv", "summary.csv"] {
                assert_eq!(untimed(&shared, table), untimed(&alone, table), "{name} on {count} ranks");
            }
        }
    }
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn an_experiment_whose_rank_dies_goes_on_where_it_was() {
    let folder = tempfile::tempdir().expect("directory");
    let (whole, killed) = (folder.path().join("whole"), folder.path().join("killed"));
    let words =
        ["experiment", "clean", "--configuration", "9r/4s", "--instances", "3000", "--threads", "1", "--output"];
    assert!(run("tdoa", &[&words[..], &[&text(&whole)]].concat()).status.success());
    let output = text(&killed);
    let words = [&words[..], &[&output]].concat();
    let rows = || std::fs::read_to_string(killed.join("trials.csv")).map_or(0, |table| table.lines().count());
    for (rank, least) in [(1, 300), (0, 900)] {
        let child = on_ranks("tdoa", 2, &words).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("runs");
        let victim = waited(|| process(&child, rank));
        waited(|| Some(rows()).filter(|&rows| rows >= least));
        signal("-KILL", victim);
        assert!(!succeeds(child));
        assert!(rows() < 3000, "there was something left to do");
    }
    let output = on_ranks("tdoa", 4, &words).output().expect("mpirun runs");
    assert!(output.status.success(), "{}", said(&output));
    for name in ["trials.csv", "summary.csv", "histogram.csv"] {
        assert_eq!(untimed(&killed, name), untimed(&whole, name), "{name}");
    }
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn what_ranks_cannot_share_is_refused_once() {
    let folder = tempfile::tempdir().expect("directory");
    let output = text(folder.path());
    let those = "run on several ranks; start this without mpirun";
    for (words, expected) in [
        (&["simulate", "--output", &output][..], those),
        (&["experiment", "speed", "--output", &output], those),
        (&["experiment", "table2", "--instances", "0", "--output", &output], "--instances must be at least 1"),
        (&["experiment", "table2", "--rank-timeout", "0", "--output", &output], "--rank-timeout"),
    ] {
        let output = on_ranks("tdoa", 3, words).output().expect("mpirun runs");
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", said(&output));
        assert_eq!(said(&output).matches(expected).count(), 1, "{words:?}: {}", said(&output));
    }
}
