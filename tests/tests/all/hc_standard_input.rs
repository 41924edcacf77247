//! `-` in the place of files that the program `hc` reads.

use end_to_end::{run, run_on};
use std::process::Output;

/// Two conics that meet in (1, 2), (2, 1) and their opposites.
const CONICS: &str = "x^2 + y^2 = 5\nx*y = 2\n";

fn words(output: &Output) -> (Option<i32>, String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn every_command_reads_its_system_from_standard_input() {
    for (arguments, says) in [
        (&["solve", "-"][..], "4 isolated solutions, 4 real"),
        (&["mixed-volume", "-"], "mixed volume 4"),
        (&["decompose", "-"], "4 isolated solutions"),
    ] {
        let (status, out, error) = words(&run_on("hc", arguments, CONICS));
        assert!(status == Some(0) && out.contains(says), "{arguments:?}: {out}{error}");
        let (status, _, error) = words(&run_on("hc", arguments, "x^2 = 5\nx*y = "));
        assert_eq!(status, Some(2), "{error}");
        assert!(error.starts_with("hc: standard input: line 2, column 7"), "{error}");
    }
    let folder = tempfile::tempdir().expect("folder");
    let system = folder.path().join("system.txt");
    std::fs::write(&system, CONICS).expect("written");
    let system = system.to_str().expect("UTF-8 path");
    let (status, out, error) = words(&run_on("hc", &["certify", system, "-"], "1 2\n2 1\n"));
    assert!(status == Some(0) && out.contains("2 of 2 points certified: 2 distinct solutions"), "{out}{error}");
    let (status, _, error) = words(&run_on("hc", &["certify", system, "-"], "1 2\n2 one\n"));
    assert!(status == Some(2) && error.contains("standard input: line 2: `one` is not a finite number"), "{error}");
}

#[test]
fn a_family_and_its_fibre_come_through_pipes() {
    let family = "parameters: a b\nunknowns: x y\nx^2 + y^2 = a\nx*y = b\n";
    let (status, fibre, error) = words(&run_on("hc", &["monodromy", "-", "--output", "-"], family));
    assert_eq!(status, Some(0), "{error}");
    assert!(error.starts_with("standard input: 4 solutions after "), "{error}");
    let folder = tempfile::tempdir().expect("folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8 path").to_owned();
    let (file, target) = (path("family.txt"), path("target.json"));
    std::fs::write(&file, family).expect("written");
    std::fs::write(&target, "{\"parameters\": [5, 2]}").expect("written");
    let (status, out, error) = words(&run_on("hc", &["track", &file, "--start", "-", "--target", &target], &fibre));
    assert!(status == Some(0) && out.contains("4 isolated solutions, 4 real"), "{out}{error}");
    let (status, out, error) = words(&run_on("hc", &["codegen", &file, "-", "-o", "-"], &fibre));
    assert!(status == Some(0) && out.contains("// Source: family.txt"), "{out}{error}");
}

#[test]
fn standard_input_is_read_once() {
    for arguments in [&["certify", "-", "-"][..], &["monodromy", "-", "--seed-pair", "-", "--output", "-"]] {
        let (status, _, error) = words(&run_on("hc", arguments, CONICS));
        assert!(status == Some(2) && error.contains("standard input can be read once"), "{error}");
    }
    let (status, _, error) = words(&run("hc", &["codegen", "-", "-", "-o", "-"]));
    assert!(status == Some(2) && error.contains("can be read once"), "{error}");
}
