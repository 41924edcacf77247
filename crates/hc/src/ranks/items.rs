//! Items that are computed by number, on all ranks.

use super::error::RanksError;
use super::lead::Lead;
use super::run::Ranks;
use super::worker::Worker;
use crate::checkpoint::{Hash, Job, System};
use crate::monitor::Monitor;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::ControlFlow;

/// An item counts for so many paths where portions are made: a rank is given one to eight for each
/// of its threads.
const WEIGHT: usize = 1 << 5;

/// Computes items on all ranks: the items with the `numbers` of rank 0, in ascending order. Other
/// ranks may have other numbers.
///
/// `job` describes the computation, and is the same on all ranks. `compute` returns the items with
/// some numbers, in their order, and works on the threads of the pool in which it is called; it
/// returns fewer items once its monitor is cancelled. An item depends only on its number. Rank 0
/// passes each item to `absorb` as it comes, in any order, until `absorb` breaks or `monitor` is
/// cancelled. The other ranks return when they are no longer needed; they never call `absorb`.
///
/// ```
/// use hc::Monitor;
/// use hc::ranks::{Local, Ranks, RanksOptions, compute_on_ranks};
/// use std::ops::ControlFlow;
///
/// let sum = |exchange: &Local| {
///     let ranks = Ranks::new(exchange, &RanksOptions::new());
///     let squares = |numbers: &[usize], _: &Monitor| numbers.iter().map(|k| k * k).collect::<Vec<_>>();
///     let mut sum = 0;
///     let add = |_, square: usize| {
///         sum += square;
///         ControlFlow::Continue(())
///     };
///     let numbers: Vec<usize> = (0..1000).collect();
///     let result = compute_on_ranks("squares", &numbers, &Monitor::default(), squares, add, &ranks);
///     ranks.finish(None);
///     result.map(|()| sum)
/// };
/// let exchanges = Local::ranks(3);
/// let sums = std::thread::scope(|scope| {
///     let all: Vec<_> = exchanges.iter().map(|exchange| scope.spawn(move || sum(exchange))).collect();
///     all.into_iter().map(|rank| rank.join().unwrap()).collect::<Result<Vec<_>, _>>()
/// })?;
/// assert_eq!(sums, [332_833_500, 0, 0]);
/// # Ok::<(), hc::ranks::RanksError>(())
/// ```
///
/// # Errors
/// On rank 0 if another rank fails, does another job or sends an unreadable message; on the other
/// ranks if rank 0 is silent. Items that were absorbed before remain.
pub fn compute_on_ranks<T: Serialize + DeserializeOwned>(
    job: &str,
    numbers: &[usize],
    monitor: &Monitor,
    compute: impl Fn(&[usize], &Monitor) -> Vec<T>,
    absorb: impl FnMut(usize, T) -> ControlFlow<()>,
    ranks: &Ranks<'_>,
) -> Result<(), RanksError> {
    // With the version of the program, and short.
    let system = System { unknowns: Vec::new(), equations: 0, hash: Hash::of([job]) };
    let job = &Job::new("items", system, &()).fingerprint();
    if ranks.is_lead() {
        return Lead::at(ranks, job, |lead| led(numbers, monitor, compute, absorb, lead));
    }
    Worker::at(ranks, job, |worker| {
        while let Some(task) = worker.next::<()>()? {
            worker.serve(&task, |numbers, _| compute(numbers, &task.monitor))?;
        }
        Ok(())
    })
}

/// The work at rank 0.
fn led<T: DeserializeOwned>(
    numbers: &[usize],
    monitor: &Monitor,
    compute: impl Fn(&[usize], &Monitor) -> Vec<T>,
    mut absorb: impl FnMut(usize, T) -> ControlFlow<()>,
    lead: &Lead<'_>,
) -> Result<(), RanksError> {
    lead.begin_part(&(), WEIGHT);
    let mut left = numbers.len();
    let mut take_in = |numbers: Vec<usize>, items: Vec<T>, left: &mut usize| {
        *left = left.saturating_sub(items.len());
        numbers.into_iter().zip(items).try_for_each(|(number, item)| absorb(number, item))
    };
    lead.offer(numbers, &[]);
    while left > 0 && !monitor.is_cancelled() {
        for arrived in lead.arrived() {
            let (rank, expected) = (arrived.rank, arrived.paths.len());
            let refused = |reason: String| RanksError::Message { rank, reason };
            let items: Vec<T> = postcard::from_bytes(&arrived.content).map_err(|error| refused(error.to_string()))?;
            if items.len() != expected {
                return Err(refused(format!("{} items instead of {expected}", items.len())));
            }
            if take_in(arrived.paths, items, &mut left).is_break() {
                return Ok(());
            }
        }
        if let Some(error) = lead.failure() {
            return Err(error);
        }
        let Some(portion) = lead.take() else {
            lead.wait();
            continue;
        };
        let items = compute(&portion.paths, monitor);
        if items.len() < portion.paths.len() && !monitor.is_cancelled() {
            let message = format!("{} items of {} were computed", items.len(), portion.paths.len());
            return Err(RanksError::Failed { rank: 0, message });
        }
        if lead.done(&portion) && take_in(portion.paths, items, &mut left).is_break() {
            return Ok(());
        }
    }
    Ok(())
}

#[cfg(all(test, feature = "threads"))]
mod tests {
    use super::super::Local;
    use super::super::support::{Faulty, PATIENCE, on};
    use super::*;
    use std::collections::BTreeMap;
    use std::sync::atomic::Ordering;
    use std::time::Duration;

    /// What a rank has absorbed when it computes texts of numbers, and how that ended; rank 0 does
    /// `wait` each time before it computes.
    fn texts(
        job: &str,
        numbers: &[usize],
        until: usize,
        wait: impl Fn(),
        ranks: &Ranks<'_>,
    ) -> (BTreeMap<usize, String>, Result<(), RanksError>) {
        let mut found = BTreeMap::new();
        let compute = |numbers: &[usize], _: &Monitor| {
            if ranks.is_lead() {
                wait();
            }
            numbers.iter().map(|k| k.to_string()).collect::<Vec<String>>()
        };
        let absorb = |number, item| {
            assert!(found.insert(number, item).is_none(), "{number} comes once");
            if found.len() == until { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let result = compute_on_ranks(job, numbers, &Monitor::default(), compute, absorb, ranks);
        (found, result)
    }

    #[test]
    fn every_item_comes_once_though_answers_are_lost() {
        let numbers: Vec<usize> = (0..500).filter(|k| k % 3 != 0).collect();
        let expected: BTreeMap<usize, String> = numbers.iter().map(|k| (*k, k.to_string())).collect();
        for (count, lost) in [(1, 0), (2, 1), (4, 3)] {
            let exchanges: Vec<Faulty> =
                Local::ranks(count).into_iter().map(|local| Faulty::new(local, lost)).collect();
            let answers = exchanges[0].answers().clone();
            // The others have a part in it.
            let wait = || {
                while count > 1 && answers.load(Ordering::Relaxed) == 0 {
                    std::thread::sleep(Duration::from_millis(1));
                }
            };
            let found =
                on(&exchanges, Duration::from_millis(100), |ranks| texts("texts", &numbers, usize::MAX, wait, ranks));
            assert_eq!(found[0], (expected.clone(), Ok(())), "{count} ranks");
            assert!(found[1..].iter().all(|end| *end == (BTreeMap::new(), Ok(()))));
        }
    }

    #[test]
    fn rank_0_knows_what_others_have_sent_back() {
        let numbers: Vec<usize> = (0..300).collect();
        let exchanges: Vec<Faulty> = Local::ranks(2).into_iter().map(|local| Faulty::new(local, 0)).collect();
        let answers = exchanges[0].answers().clone();
        let wait = || {
            while answers.load(Ordering::Relaxed) == 0 {
                std::thread::sleep(Duration::from_millis(1));
            }
        };
        let answered = on(&exchanges, PATIENCE, |ranks| {
            let _ = texts("texts", &numbers, usize::MAX, wait, ranks);
            ranks.answered()
        });
        assert!(!answered[0].is_empty() && answered[1].is_empty());
        assert!(answered[0].iter().all(|answered| answered.rank == 1 && answered.bytes > answered.paths));
        assert!(answered[0].iter().map(|answered| answered.paths).sum::<usize>() <= numbers.len());
    }

    #[test]
    fn the_job_ends_early_and_only_between_ranks_that_do_the_same() {
        let numbers: Vec<usize> = (0..100_000).collect();
        let found = on(&Local::ranks(3), PATIENCE, |ranks| texts("texts", &numbers, 7, || (), ranks));
        assert_eq!((found[0].0.len(), &found[0].1), (7, &Ok(())));
        // Alone it would take minutes.
        let wait = || std::thread::sleep(Duration::from_millis(10));
        let job = |ranks: &Ranks<'_>| if ranks.is_lead() { "texts" } else { "others" };
        let found = on(&Local::ranks(2), PATIENCE, |ranks| texts(job(ranks), &numbers, usize::MAX, wait, ranks));
        assert_eq!(found[0].1, Err(RanksError::Differs { rank: 1 }));
    }
}
