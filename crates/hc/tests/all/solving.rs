//! Systems of real origin with verified counts, solved from the front door.

use crate::common::{multiplicities, options, real, solved};
use std::path::Path;

/// The counts of `expected.csv`: distinct solutions, their multiplicities and real ones, as far as
/// it states them.
fn check(name: &str, seeds: std::ops::Range<u64>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems");
    let expected = std::fs::read_to_string(folder.join("expected.csv")).expect("the table");
    let row = expected.lines().find(|l| l.split(',').next() == Some(name)).expect("a row");
    let fields: Vec<&str> = row.split(',').collect();
    let text = std::fs::read_to_string(folder.join(format!("{name}.phc"))).expect("the system");
    for seed in seeds {
        let found = solved(&text, &options(seed));
        assert_eq!(found.solutions.len(), fields[5].parse::<usize>().unwrap(), "{name} {seed}");
        if !fields[6].is_empty() {
            assert_eq!(multiplicities(&found), fields[6], "{name} {seed}");
        }
        if let Ok(count) = fields[8].parse::<usize>() {
            assert_eq!(real(&found), count, "{name} {seed}");
        }
        assert_eq!(found.on_components > 0, fields[7] == "1", "{name} {seed}");
        for solution in &found.solutions {
            assert!(solution.residual < 1e-10, "{name} {seed}: {solution:?}");
            assert_eq!(solution.singular, solution.multiplicity > 1, "{name} {seed}: {solution:?}");
        }
    }
}

#[test]
fn simple_roots() {
    for name in [
        "eco8", "noon5", "boon", "puma", "chandra6", "wright", "sendra", "trinks", "lorentz", "camera1s", "chemequ",
        "katsura8", "sparse5", "i1", "game6two", "cyclic7",
    ] {
        check(name, 0..2);
    }
}

/// Most paths go to infinity.
#[test]
fn roots_at_infinity() {
    for name in ["heart", "reimer5", "kinema", "assur44", "kin1", "tangents0", "stewgou40"] {
        check(name, 0..2);
    }
}

#[test]
fn multiple_roots() {
    for name in ["caprasse", "cbms1", "decker2", "ojika1", "rose", "solotarev"] {
        check(name, 0..4);
    }
}

/// A curve besides 1152 isolated solutions.
#[test]
fn a_component_of_positive_dimension() {
    check("cyclic8", 0..2);
}

#[test]
fn a_thousand_regular_roots() {
    check("rps10", 0..1);
}
