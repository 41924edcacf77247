//! Targets tracked by several ranks.

use super::tests::{conics, fibre, targets};
use super::{Family, FamilyError};
use crate::checkpoint::{Checkpoint, CheckpointOptions};
use crate::ranks::support::{Faulty, PATIENCE, on};
use crate::ranks::{Local, RanksError};
use crate::{Monitor, SolveOptions, Stage};
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
            let found =
                on(&Local::ranks(count), PATIENCE, |ranks| family.track(&fibre, &targets).on_ranks(ranks).run());
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
            family.track(&fibre, &targets).watched(&monitor).on_ranks(ranks).run()
        });
        assert_eq!(found[0].as_ref(), Ok(&expected));
        assert!(exchanges[0].answers().load(Ordering::Relaxed) >= 4);
        // As far as was asked for, certified, with a checkpoint.
        let folder = tempfile::tempdir().unwrap();
        let options = SolveOptions::new().certify(true);
        let first = || family.track(&fibre, &targets).options(&options).until(|k, _| k == 300);
        let expected = first().run().unwrap();
        for count in [3, 2] {
            let found = on(&Local::ranks(count), PATIENCE, |ranks| {
                let all = first().on_ranks(ranks);
                if !ranks.is_lead() {
                    return all.run();
                }
                let checkpoint = Checkpoint::open(folder.path(), &CheckpointOptions::new().resume(true))?;
                all.recorded(&checkpoint).run()
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
        family.track(&fibre, &targets).on_ranks(ranks).run()
    });
    assert_eq!(found[0], Err(FamilyError::Ranks(RanksError::Differs { rank: 1 })));
    assert_eq!(found[1], Ok(Vec::new()));
    // A target that does not fit is refused by all.
    let found = on(&Local::ranks(2), PATIENCE, |ranks| family.track(&fibre, &[[1.0, 2.0]]).on_ranks(ranks).run());
    assert!(found.iter().all(|found| *found == Err(FamilyError::Target { target: 1, parameters: 3 })), "{found:?}");
}
