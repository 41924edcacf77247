//! Systems with verified counts, solved from the front door.

use hc::poly::parse::phcpack;
use hc::solve::{SolveError, SolveOptions, Solved, solve};
use std::path::PathBuf;

fn solved(text: &str, seed: u64) -> Result<Solved, SolveError> {
    let polynomials = phcpack(text).unwrap().expand(&Default::default()).unwrap();
    let mut options = SolveOptions::default();
    options.seed = seed;
    solve(&polynomials, &options)
}

/// Where the systems with their counts are: `SHARED_DIR`, or `shared` beside the workspace.
fn systems() -> PathBuf {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    std::env::var_os("SHARED_DIR").map_or_else(beside, PathBuf::from).join("systems")
}

/// Systems whose roots are all simple and isolated: distinct and real counts of `expected.csv`.
#[test]
fn systems_with_simple_roots() {
    let folder = systems();
    let Ok(expected) = std::fs::read_to_string(folder.join("expected.csv")) else {
        eprintln!("skipped: the shared systems are not here; set SHARED_DIR");
        return;
    };
    let names = [
        "eco8", "noon5", "boon", "puma", "heart", "chandra6", "wright", "sendra", "trinks", "lorentz", "camera1s",
        "chemequ", "katsura8", "cyclic7", "reimer5", "kinema", "assur44",
    ];
    for name in names {
        let row = expected.lines().find(|l| l.split(',').next() == Some(name)).unwrap();
        let fields: Vec<&str> = row.split(',').collect();
        let text = std::fs::read_to_string(folder.join(format!("{name}.phc"))).unwrap();
        for seed in 0..2 {
            let found = solved(&text, seed).unwrap();
            assert_eq!(found.paths.failed, 0, "{name} {seed}");
            assert_eq!(found.solutions.len(), fields[5].parse::<usize>().unwrap(), "{name} {seed}");
            if let Ok(real) = fields[8].parse::<usize>() {
                assert_eq!(found.solutions.iter().filter(|s| s.real).count(), real, "{name} {seed}");
            }
        }
    }
}

/// x^2 + y^2 + 1, 2x + 3y - 1 has two roots, none real; mickey four, two of them real; roots at zero are found too.
#[test]
fn small_systems() {
    let count = |text: &str| {
        let found = solved(text, 3).unwrap();
        (found.solutions.len(), found.solutions.iter().filter(|s| s.real).count(), found.paths.failed)
    };
    assert_eq!(count("2\nx^2+y^2+1;\n2*x+3*y-1;"), (2, 0, 0));
    assert_eq!(count("2\nx^2+4*y^2-4;\n2*y^2-x;"), (4, 2, 0));
    assert_eq!(count("1\n-2*x;"), (1, 1, 0));
    assert_eq!(count("1\nx^3-2*x;"), (3, 3, 0));
    // Three with a zero coordinate; in the torus x = (2 + 3 y) / y^2 with y^3 - 6 y^2 - 16 y - 8 = 0, discriminant 3136 > 0.
    assert_eq!(count("2\n2*y+3*y^2-x*y^3;\nx+4*x^2-2*x^3*y;"), (6, 6, 0));
}

#[test]
fn unusable_systems_are_refused() {
    assert!(matches!(solved("2\nx - x;\ny - 1 + 0*x;", 0), Err(SolveError::Zero(1))));
}

#[test]
fn threads_do_not_change_the_result() {
    let text = "3\nx^2+y*z-x-1;\ny^2+x*z-2*y+3;\nz^3+x*y-5;";
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solved(text, 5).unwrap())
    };
    assert_eq!(on(1), on(3));
}
