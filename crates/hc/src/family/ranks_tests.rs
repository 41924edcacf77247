//! Targets tracked, and fibres filled, by several ranks.

use super::tests::{conics, fibre, pairs_of_roots, targets};
use super::{Family, FamilyError, Monodromy, MonodromyOptions, Stopped};
use crate::checkpoint::{Checkpoint, CheckpointOptions, status};
use crate::ranks::support::{Faulty, PATIENCE, on};
use crate::ranks::{Exchange, Local, Ranks, RanksError};
use crate::{Monitor, RanksRun, Run, SolveOptions, Stage};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

#[test]
fn any_number_of_ranks_tracks_to_the_same_bits() {
    let targets = targets(1000);
    for more in ["", "symmetry = [[\"-x\", \"-y\"]]"] {
        let family = conics(more);
        let fibre = fibre(&family);
        let expected = family.track(&fibre, &targets).run().unwrap();
        for count in [1, 2, 4] {
            let found = on(&Local::ranks(count), PATIENCE, |ranks| {
                Run::new().on_ranks(ranks).track(&family, &fibre, &targets).run()
            });
            assert_eq!(found[0].as_ref(), Ok(&expected), "{count} ranks");
            assert!(found[1..].iter().all(|other| other.as_ref().is_ok_and(Vec::is_empty)));
        }
        // Answers that are lost, late and out of order; rank 0 waits for some.
        let exchanges: Vec<Faulty> = Local::ranks(3).into_iter().map(|local| Faulty::new(local, 2)).collect();
        let (answers, begun) = (Arc::clone(exchanges[0].answers()), Instant::now());
        let monitor = Monitor::asking(move |progress| {
            let few = || progress.stage == Stage::Paths && answers.load(Ordering::Relaxed) < 4;
            while few() && begun.elapsed() < Duration::from_secs(120) {
                std::thread::sleep(Duration::from_millis(1));
            }
            false
        });
        let found = on(&exchanges, Duration::from_millis(150), |ranks| {
            Run::new().watched(&monitor).on_ranks(ranks).track(&family, &fibre, &targets).run()
        });
        assert_eq!(found[0].as_ref(), Ok(&expected));
        assert!(exchanges[0].answers().load(Ordering::Relaxed) >= 4);
        // As far as was asked for, certified, with a checkpoint.
        let folder = tempfile::tempdir().unwrap();
        let options = SolveOptions::new().certify(true);
        let first =
            |run: RanksRun<'_>| run.track(&family, &fibre, &targets).options(&options).until(|k, _| k == 300).run();
        let expected = first(Run::new().on_ranks(None)).unwrap();
        for count in [3, 2] {
            let found = on(&Local::ranks(count), PATIENCE, |ranks| {
                if !ranks.is_lead() {
                    return first(Run::new().on_ranks(ranks));
                }
                let checkpoint = Checkpoint::open(folder.path(), &CheckpointOptions::new().resume(true))?;
                first(Run::new().recorded(&checkpoint).on_ranks(ranks))
            });
            assert_eq!((found[0].as_ref(), expected.len()), (Ok(&expected), 301));
        }
    }
}

#[test]
fn ranks_with_other_targets_are_refused() {
    let family: Family = conics("");
    let fibre = fibre(&family);
    let found = on(&Local::ranks(2), PATIENCE, |ranks| {
        let targets = targets(if ranks.is_lead() { 5000 } else { 4999 });
        Run::new().on_ranks(ranks).track(&family, &fibre, &targets).run()
    });
    assert_eq!(found[0], Err(FamilyError::Ranks(RanksError::Differs { rank: 1 })));
    assert_eq!(found[1], Ok(Vec::new()));
    // A target that does not fit is refused by all.
    let found =
        on(&Local::ranks(2), PATIENCE, |ranks| Run::new().on_ranks(ranks).track(&family, &fibre, &[[1.0, 2.0]]).run());
    assert!(found.iter().all(|found| *found == Err(FamilyError::Target { target: 1, parameters: 3 })), "{found:?}");
}

/// Two curves of degree 8 in a plane: 64 points by Bezout's theorem, none of them at infinity.
fn curves(more: &str) -> Family {
    let text = "name = \"curves\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"a\", \"b\", \"c\", \"d\"]\n\
                equations = [\"x^8 + a*x*y - b\", \"y^8 + c*x*y - d\"]\n";
    format!("{text}{more}").parse().unwrap()
}

/// A search by these ranks, with the result of rank 0.
fn searched<X: Exchange>(
    exchanges: &[X],
    patience: Duration,
    family: &Family,
    options: &MonodromyOptions,
    monitor: &Monitor,
) -> Monodromy {
    let first = family.find_pair(1).unwrap();
    let mut found =
        on(exchanges, patience, |ranks| Run::new().watched(monitor).on_ranks(ranks).complete(family, &first, options))
            .into_iter();
    let found_first = found.next().unwrap().unwrap().unwrap();
    assert!(found.all(|other| other == Ok(None)));
    found_first
}

#[test]
fn any_number_of_ranks_fills_a_fibre_to_the_same_bits() {
    for (more, orbits) in [("", None), ("symmetry = [[\"-x\", \"-y\"]]", Some(32))] {
        let family = curves(more);
        let options = MonodromyOptions::new().seed(1);
        let expected = family.complete(&family.find_pair(1).unwrap(), &options).unwrap();
        assert_eq!((expected.fibre.len(), expected.stopped), (64, Stopped::Trace));
        assert_eq!(expected.fibre.representatives.as_ref().map(Vec::len), orbits);
        assert!(expected.trace.is_some_and(|test| test.passed(64)), "{:?}", expected.trace);
        for count in [1, 2, 4] {
            let found = searched(&Local::ranks(count), PATIENCE, &family, &options, &Monitor::default());
            assert_eq!(found, expected, "{count} ranks");
        }
        // Answers that are lost, late and out of order; rank 0 waits for the first.
        let exchanges: Vec<Faulty> = Local::ranks(3).into_iter().map(|local| Faulty::new(local, 2)).collect();
        let (answers, begun) = (Arc::clone(exchanges[0].answers()), Instant::now());
        let monitor = Monitor::asking(move |progress| {
            // Three sides, with enough paths for all ranks.
            let waits = || progress.total >= 3 * 64 && answers.load(Ordering::Relaxed) == 0;
            while waits() && begun.elapsed() < Duration::from_secs(120) {
                std::thread::sleep(Duration::from_millis(1));
            }
            false
        });
        let found = searched(&exchanges, Duration::from_millis(150), &family, &options, &monitor);
        assert_eq!(found, expected);
        assert!(exchanges[0].answers().load(Ordering::Relaxed) >= 1);
    }
}

#[test]
fn checkpoints_of_searches_by_several_ranks_serve_any_number() {
    let (family, first) = pairs_of_roots();
    let options = MonodromyOptions::new().roots(65 * 65);
    let expected = family.complete(&first, &options).unwrap();
    assert_eq!((expected.fibre.len(), expected.stopped), (4225, Stopped::RootsReached));
    let folder = tempfile::tempdir().unwrap();
    let run = |count: usize, monitor: &Monitor| {
        let found = on(&Local::ranks(count), PATIENCE, |ranks| {
            let open = || Checkpoint::open(folder.path(), &CheckpointOptions::new().resume(true));
            let checkpoint = if ranks.is_lead() { Some(open()?) } else { None };
            Run::new()
                .watched(monitor)
                .recorded(checkpoint.as_ref())
                .on_ranks(ranks)
                .complete(&family, &first, &options)
        });
        assert!(found[1..].iter().all(|other| *other == Ok(None)));
        found[0].clone().unwrap().unwrap()
    };
    // Cancelled on the second side of the first loop; paths that have come back by then may have found solutions.
    let cancelled = run(3, &Monitor::asking(|progress| progress.done >= 5000));
    assert_eq!(cancelled.stopped, Stopped::Cancelled);
    assert!(cancelled.fibre.solutions.starts_with(&first.solutions) && cancelled.fibre.len() < 4225);
    assert_eq!(status(folder.path()).unwrap().records, 1);
    assert_eq!(run(2, &Monitor::default()), expected);
    assert_eq!(run(1, &Monitor::default()), expected);
}

#[test]
fn ranks_with_another_search_are_refused() {
    let (family, first) = pairs_of_roots();
    let search =
        |ranks: &Ranks<'_>, options: &MonodromyOptions| Run::new().on_ranks(ranks).complete(&family, &first, options);
    let options = MonodromyOptions::new().roots(65 * 65);
    let found =
        on(&Local::ranks(2), PATIENCE, |ranks| search(ranks, &options.clone().seed(u64::from(!ranks.is_lead()))));
    assert_eq!(found, [Err(FamilyError::Ranks(RanksError::Differs { rank: 1 })), Ok(None)]);
    // Other work than a search is refused by all.
    let mut wrong = options.clone();
    wrong.fibre.coincidence = -1.0;
    let found = on(&Local::ranks(2), PATIENCE, |ranks| search(ranks, &wrong));
    assert!(found.iter().all(|found| matches!(found, Err(FamilyError::Option(_)))), "{found:?}");
}
