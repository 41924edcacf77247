//! Work on families that goes on from a checkpoint.

use super::{Family, FamilyError, Fibre, MonodromyOptions, Stopped};
use crate::checkpoint::support::{goes_on_from_every_record, resumed};
use crate::checkpoint::{Checkpoint, CheckpointError, CheckpointOptions, status};
use crate::{Run, Solutions, SolveOptions};
use num_complex::Complex64;

/// Four solutions in two orbits; for `a = 0` two of them are at infinity.
pub(super) fn conics(more: &str) -> Family {
    let text = "name = \"conics\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"a\", \"b\", \"c\"]\n\
                equations = [\"a*x^2 + y^2 - b\", \"x*y - c\"]\n";
    format!("{text}{more}").parse().unwrap()
}

pub(super) fn fibre(family: &Family) -> Fibre {
    family.monodromy(&MonodromyOptions::new().roots(4)).unwrap().fibre
}

/// Hyperbolas that cross a circle, touch it, and meet two lines.
pub(super) fn targets(count: usize) -> Vec<[f64; 3]> {
    let target = |k: usize| match k % 100 {
        7 => [1.0, 2.0, 1.0],
        8 => [0.0, 4.0, 3.0],
        _ => [1.0, 5.0 + k as f64, 2.0],
    };
    (0..count).map(target).collect()
}

fn tracked(
    family: &Family,
    fibre: &Fibre,
    targets: &[[f64; 3]],
    options: &SolveOptions,
    checkpoint: &Checkpoint,
) -> Result<Vec<Solutions>, FamilyError> {
    Run::new().recorded(checkpoint).track(family, fibre, targets).options(options).run()
}

#[test]
fn targets_go_on_from_every_record_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let targets = targets(1000);
    let options = SolveOptions::new();
    for (name, more) in [("all", ""), ("orbits", "symmetry = [[\"-x\", \"-y\"]]")] {
        let family = conics(more);
        let fibre = fibre(&family);
        let directory = folder.path().join(name);
        let expected = family.track(&fibre, &targets).run().unwrap();
        assert_eq!((expected[7].len(), expected[7].iter().next().unwrap().multiplicity), (2, 2));
        assert_eq!((expected[8].len(), expected[8].paths.at_infinity > 0), (2, true));
        let checkpoint = Checkpoint::open(&directory, &CheckpointOptions::new()).unwrap();
        assert_eq!(tracked(&family, &fibre, &targets, &options, &checkpoint).unwrap(), expected);
        let again = tracked(&family, &fibre, &targets, &options, &checkpoint);
        assert_eq!(again, Err(FamilyError::Checkpoint(CheckpointError::Used(directory.clone()))));
        drop(checkpoint);
        let now = status(&directory).unwrap();
        assert_eq!((now.what.as_str(), now.running, now.part, now.round), ("track", false, 1, 1));
        let solutions = expected.iter().map(|found| found.len() as u64).sum();
        assert_eq!((now.done, now.total, now.solutions), (1000, Some(1000), solutions));
        let work = |checkpoint: &Checkpoint| tracked(&family, &fibre, &targets, &options, checkpoint);
        // The beginning, and four blocks.
        assert_eq!(goes_on_from_every_record(&directory, &expected, work), 5);
        // What is recorded can be certified, and left out.
        let asked = |checkpoint: &Checkpoint| {
            let all = Run::new().recorded(checkpoint).track(&family, &fibre, &targets);
            all.options(&SolveOptions::new().certify(true)).only_real(true).run()
        };
        let (real, _) = resumed(&directory, 2, asked).unwrap();
        assert!(real.iter().flatten().all(|s| s.is_real && s.certified == Some(!s.singular)));
        // As far as was asked for.
        let first = |checkpoint: &Checkpoint| {
            Run::new().recorded(checkpoint).track(&family, &fibre, &targets).until(|k, _| k == 300).run()
        };
        assert_eq!(resumed(&directory, 1, first).unwrap().0, expected[..=300]);
    }
}

#[test]
fn targets_of_other_runs_are_refused_with_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let (family, targets, options) = (conics(""), targets(3), SolveOptions::new());
    let fibre = fibre(&family);
    let checkpoint = Checkpoint::open(folder.path(), &CheckpointOptions::new()).unwrap();
    tracked(&family, &fibre, &targets, &options, &checkpoint).unwrap();
    drop(checkpoint);
    let differs = |family: &Family, fibre: &Fibre, targets: &[[f64; 3]], options: &SolveOptions| {
        let work = |checkpoint: &Checkpoint| tracked(family, fibre, targets, options, checkpoint);
        let error = resumed(folder.path(), 1, work).unwrap_err();
        let FamilyError::Checkpoint(CheckpointError::Differs { name, recorded, own, .. }) = error else {
            panic!("{error}")
        };
        (name, recorded, own)
    };
    let named = |name: &str, recorded: &str, own: &str| (name.to_owned(), recorded.to_owned(), own.to_owned());
    assert_eq!(differs(&family, &fibre, &targets, &options.clone().seed(2)), named("seed", "0", "2"));
    assert_eq!(differs(&family, &fibre, &targets[..2], &options), named("targets count", "3", "2"));
    let mut others = targets.clone();
    others[2][1] = 7.5;
    assert_eq!(differs(&family, &fibre, &others, &options).0, "targets hash");
    let mut paths = options.paths.clone();
    paths.retries = 2;
    assert_eq!(differs(&family, &fibre, &targets, &options.clone().paths(paths)), named("paths retries", "4", "2"));
    let mut other = fibre.clone();
    other.solutions.truncate(6);
    assert_eq!(differs(&family, &other, &targets, &options), named("start count", "4", "3"));
    for more in ["nonzero = [\"x\"]", "symmetry = [[\"-x\", \"-y\"]]"] {
        assert_eq!(differs(&conics(more), &fibre, &targets, &options).0, "system hash");
    }
    assert_eq!(resumed(folder.path(), 1, |c| tracked(&family, &fibre, &targets, &options, c)).unwrap().0.len(), 3);
}

fn family(unknowns: &str, parameters: &str, equations: &str) -> Family {
    let text =
        format!("name = \"\"\nunknowns = [{unknowns}]\nparameters = [{parameters}]\nequations = [{equations}]\n");
    text.parse().unwrap()
}

/// Loops, solutions for other parameters where these bring nothing new, and the trace test.
#[test]
fn searches_go_on_from_every_record_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    // A root of its own beside two that change places; orbits.
    let apart = family("\"x\"", "\"a\", \"b\"", "\"(x^2 - a)*(x - b)\"");
    for (name, family, count) in [("apart", apart, 3), ("orbits", conics("symmetry = [[\"-x\", \"-y\"]]"), 4)] {
        let options = MonodromyOptions::new().seed(1);
        let first = family.find_pair(1).unwrap();
        let directory = folder.path().join(name);
        let expected = family.complete(&first, &options).unwrap();
        assert_eq!((expected.fibre.len(), expected.stopped), (count, Stopped::Trace));
        let test = family.trace_test(&expected.fibre, &options).unwrap();
        assert!(test.passed(count) && expected.trace == Some(test), "{test:?}");
        assert_eq!(expected.start_file().stopped, "trace");
        let work = |checkpoint: &Checkpoint| Run::new().recorded(checkpoint).complete(&family, &first, &options);
        let checkpoint = Checkpoint::open(&directory, &CheckpointOptions::new()).unwrap();
        assert_eq!(work(&checkpoint).unwrap(), expected);
        drop(checkpoint);
        let now = status(&directory).unwrap();
        // The search, with others if need be, and three parts of the trace test.
        assert_eq!((now.what.as_str(), now.part, now.round, now.done, now.total), ("monodromy", 5, 1, 3, None));
        assert_eq!(now.solutions, (count + test.further) as u64);
        assert!(goes_on_from_every_record(&directory, &expected, work) > expected.loops);
        // Neither the trace test nor threads belong to the search.
        let untested = options.clone().trace_test(false);
        let search = |checkpoint: &Checkpoint| Run::new().recorded(checkpoint).complete(&family, &first, &untested);
        let (found, _) = resumed(&directory, 2, search).unwrap();
        // Without the trace test the start system says that it is whole.
        assert_eq!((found.fibre, found.trace, found.stopped), (expected.fibre, None, Stopped::StartSystem));
        for (options, differs) in [(options.clone().seed(2), "seed"), (options.clone().patience(9), "patience")] {
            let work = |checkpoint: &Checkpoint| Run::new().recorded(checkpoint).complete(&family, &first, &options);
            let error = resumed(&directory, 1, work).unwrap_err();
            let FamilyError::Checkpoint(CheckpointError::Differs { name, .. }) = error else { panic!("{error}") };
            assert_eq!(name, differs);
        }
    }
}

/// The pairs of 65th roots of two numbers, and all but some of them.
pub(super) fn pairs_of_roots() -> (Family, Fibre) {
    let family = family("\"x\", \"y\"", "\"a\", \"b\"", "\"x^65 - a\", \"y^65 - b\"");
    let root = |k: usize| Complex64::from_polar(1.0, std::f64::consts::TAU * k as f64 / 65.0);
    let solutions = (10..65 * 65).flat_map(|k| [root(k / 65), root(k % 65)]).collect();
    let half = Fibre::new(vec![Complex64::new(1.0, 0.0); 2], 2, solutions);
    (family, Fibre { is_partial: true, ..half })
}

#[test]
fn sides_of_long_loops_are_recorded() {
    let (family, first) = pairs_of_roots();
    let options = MonodromyOptions::new().roots(65 * 65);
    let expected = family.complete(&first, &options).unwrap();
    assert_eq!((expected.fibre.len(), expected.stopped), (4225, Stopped::RootsReached));
    let folder = tempfile::tempdir().unwrap();
    let work = |checkpoint: &Checkpoint| Run::new().recorded(checkpoint).complete(&family, &first, &options);
    let checkpoint = Checkpoint::open(folder.path(), &CheckpointOptions::new()).unwrap();
    assert_eq!(work(&checkpoint).unwrap(), expected);
    drop(checkpoint);
    // Two sides and the end of each loop.
    assert_eq!(goes_on_from_every_record(folder.path(), &expected, work), 3 * expected.loops);
    let now = status(folder.path()).unwrap();
    assert_eq!((now.done, now.solutions), (expected.loops as u64, 4225));
    // Two complex numbers for each solution and side, and two numbers of solutions for each that is joined to another.
    let bytes = (now.bytes - 4225 * 16) / (2 * expected.loops as u64);
    assert!(bytes < 4225 * 32 + 1000, "{bytes}");
}
