//! Mixed volumes by several ranks, which are threads here.

use super::{MixedError, mixed_volume};
use crate::ranks::support::{Faulty, PATIENCE, on};
use crate::ranks::{Exchange, Local, Ranks, RanksError};
use crate::{Monitor, Run};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// The supports of cyclic n-roots, exponents times a factor.
fn cyclic(n: usize, factor: i32) -> Vec<Vec<Vec<i32>>> {
    let product = |first: usize, count: usize| {
        (0..n).map(|l| if (l + n - first) % n < count { factor } else { 0 }).collect::<Vec<i32>>()
    };
    let sums = (1..n).map(|count| (0..n).map(|first| product(first, count)).collect());
    sums.chain([vec![vec![factor; n], vec![0; n]]]).collect()
}

/// The volume that rank 0 finds with others, and the number of cells.
fn volume<X: Exchange>(
    exchanges: &[X],
    patience: Duration,
    supports: &[Vec<Vec<i32>>],
    monitor: &Monitor,
) -> (u64, usize) {
    let each = |ranks: &Ranks<'_>| Run::new().watched(monitor).on_ranks(ranks).mixed_volume(supports.len(), supports);
    let mut found = on(exchanges, patience, each).into_iter();
    let first = found.next().unwrap().unwrap().unwrap();
    assert!(found.all(|other| other == Ok(None)));
    (first.volume, first.cells)
}

/// Counts from the literature, as for one rank; times the factor to the power n.
#[test]
fn any_number_of_ranks_finds_the_same_cells() {
    for (n, factor, expected) in [(5, 1, 70), (7, 1, 924), (9, 1, 11016), (10, 1, 35940), (7, 1 << 7, 924 << 49)] {
        let supports = cyclic(n, factor);
        let alone = mixed_volume(n, &supports).unwrap();
        assert_eq!(alone.volume, expected);
        for count in [1, 2, 4] {
            let found = volume(&Local::ranks(count), PATIENCE, &supports, &Monitor::default());
            assert_eq!(found, (expected, alone.cells), "cyclic {n} on {count} ranks");
        }
    }
    // A support without an edge.
    let point = [vec![vec![1, 0]], vec![vec![0, 0], vec![0, 1]]];
    assert_eq!(volume(&Local::ranks(2), PATIENCE, &point, &Monitor::default()), (0, 0));
}

#[test]
fn late_and_lost_answers_change_no_volume() {
    let exchanges: Vec<Faulty> = Local::ranks(3).into_iter().map(|local| Faulty::new(local, 2)).collect();
    // Rank 0 waits for some answers once it counts cells of subtrees.
    let (answers, begun) = (Arc::clone(exchanges[0].answers()), Instant::now());
    let monitor = Monitor::asking(move |progress| {
        let few = || progress.done > 0 && answers.load(Ordering::Relaxed) < 4;
        while few() && begun.elapsed() < Duration::from_secs(120) {
            std::thread::sleep(Duration::from_millis(1));
        }
        false
    });
    assert_eq!(volume(&exchanges, Duration::from_millis(150), &cyclic(10, 1), &monitor).0, 35940);
    assert!(exchanges[0].answers().load(Ordering::Relaxed) >= 4);
}

#[test]
fn a_cancelled_search_has_a_lower_bound() {
    let (supports, monitor) = (cyclic(12, 1), Monitor::asking(|progress| progress.done >= 1000));
    let each = |ranks: &Ranks<'_>| Run::new().watched(&monitor).on_ranks(ranks).mixed_volume(12, &supports);
    assert_eq!(on(&Local::ranks(3), PATIENCE, each), [Err(MixedError::Cancelled), Ok(None), Ok(None)]);
    // The whole volume is 500,352.
    let found = monitor.progress();
    assert!(found.done >= 1000 && (found.done..500_352).contains(&found.counted), "{found:?}");
}

#[test]
fn ranks_that_do_not_fit_end_the_search_with_the_reason() {
    let each = |ranks: &Ranks<'_>| {
        let n = if ranks.is_lead() { 11 } else { 10 };
        Run::new().on_ranks(ranks).mixed_volume(n, &cyclic(n, 1))
    };
    let differs = Err(MixedError::Ranks(RanksError::Differs { rank: 1 }));
    assert_eq!(on(&Local::ranks(2), PATIENCE, each), [differs, Ok(None)]);
    // All ranks that get so far have the same error.
    let not_square = |ranks: &Ranks<'_>| Run::new().on_ranks(ranks).mixed_volume(3, &cyclic(2, 1));
    let found = on(&Local::ranks(2), PATIENCE, not_square);
    assert_eq!(found[0], Err(MixedError::NotSquare { supports: 2, unknowns: 3 }));
    // Volumes of 2^64 and more.
    let cubes: Vec<Vec<Vec<i32>>> =
        (0..3).map(|k| [0, i32::MAX].map(|x| (0..3).map(|l| if l == k { x } else { 0 }).collect()).to_vec()).collect();
    let large = |ranks: &Ranks<'_>| Run::new().on_ranks(ranks).mixed_volume(3, &cubes);
    assert_eq!(on(&Local::ranks(2), PATIENCE, large)[0], Err(MixedError::TooLarge));
}
