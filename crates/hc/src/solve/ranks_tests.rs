//! Solves by several ranks, which are threads here.

use super::tests::quadrics;
use crate::checkpoint::{Checkpoint, CheckpointOptions, status};
use crate::ranks::support::{Faulty, PATIENCE, on};
use crate::ranks::{Exchange, ExchangeError, Local, Ranks, RanksError, RanksOptions};
use crate::{Monitor, Run, Solutions, SolveError, SolveOptions, Stage, Start, System, solve};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Cyclic n-roots: sums of products of k neighbours are zero, the product of all is one.
fn cyclic(n: usize) -> System {
    let product = |i: usize, k: usize| (i..i + k).map(|j| format!("x{}", j % n)).collect::<Vec<_>>().join("*");
    let equation = |k: usize| (0..n).map(|i| product(i, k)).collect::<Vec<_>>().join(" + ");
    let last = format!("{} - 1", product(0, n));
    (1..n).map(equation).chain([last]).collect::<Vec<_>>().join("\n").parse().unwrap()
}

/// Systems with start systems of all kinds, paths to infinity, multiple solutions, trials that fail
/// and paths that are tracked again.
fn cases() -> Vec<(&'static str, System, SolveOptions)> {
    let options = SolveOptions::new();
    let of = |text: &str| text.parse::<System>().unwrap();
    vec![
        ("quadrics", quadrics(11), options.clone().seed(3).start(Start::TotalDegree)),
        ("multiple", of("x*(x - y)*(x + y - 1)^2 - 1e-9\n(y - 1)^2*(y + x)*(x - 2)"), options.clone().seed(1)),
        ("cyclic", cyclic(6), options.clone().seed(2)),
        ("eigenvalues", of("x*t - 2*x - y\ny*t - x - 3*y\nx + y - 1"), {
            options.clone().start(Start::Multihomogeneous).groups(vec![vec![0, 2], vec![1]])
        }),
        ("one unknown", of("(x^2 - 2)^3*(x - 1)^4*(x^3 + x + 1)"), options.clone().seed(4)),
        ("infinity", of("x*y*z - 1\nx^2*y + z - 2\nx^2 + y^2*z - 3*x"), options.start(Start::TotalDegree)),
    ]
}

/// Runs that solve alike, of which rank 0 has the solutions.
fn solved<X: Exchange>(exchanges: &[X], patience: Duration, system: &System, options: &SolveOptions) -> Solutions {
    let each = |ranks: &Ranks<'_>| Run::new().on_ranks(ranks).solve(system, options);
    let mut found = on(exchanges, patience, each).into_iter();
    let first = found.next().unwrap().unwrap().unwrap();
    assert!(found.all(|other| other == Ok(None)));
    first
}

#[test]
fn any_number_of_ranks_finds_the_same_bits() {
    for (name, system, options) in cases() {
        let expected = solve(&system, &options).unwrap();
        for count in [1, 2, 4] {
            assert_eq!(solved(&Local::ranks(count), PATIENCE, &system, &options), expected, "{name} on {count}");
        }
        // Of more solutions than are sought the first ones are taken, whoever has tracked them.
        let options = options.known(expected.len() / 2);
        let expected = solve(&system, &options).unwrap();
        assert_eq!(solved(&Local::ranks(3), PATIENCE, &system, &options), expected, "{name}, half of it");
    }
}

#[test]
fn late_and_lost_answers_change_nothing() {
    for (name, system, options) in cases() {
        let expected = solve(&system, &options).unwrap();
        let exchanges: Vec<Faulty> = Local::ranks(3).into_iter().map(|local| Faulty::new(local, 2)).collect();
        // Small systems are done before others are ready; with large ones rank 0 waits for some answers.
        let enough = if expected.paths.tracked < 2048 { 0 } else { 4 };
        let (answers, begun) = (Arc::clone(exchanges[0].answers()), Instant::now());
        let monitor = Monitor::asking(move |progress| {
            let few = || progress.stage == Stage::Paths && answers.load(Ordering::Relaxed) < enough;
            while few() && begun.elapsed() < Duration::from_secs(120) {
                std::thread::sleep(Duration::from_millis(1));
            }
            false
        });
        let found = on(&exchanges, Duration::from_millis(150), |ranks| {
            Run::new().watched(&monitor).on_ranks(ranks).solve(&system, &options)
        });
        assert_eq!(found, [Ok(Some(expected)), Ok(None), Ok(None)], "{name}");
        assert!(exchanges[0].answers().load(Ordering::Relaxed) >= enough, "{name}");
    }
}

#[test]
fn ranks_that_never_answer_are_done_without() {
    let (system, options) = (cyclic(5), SolveOptions::new());
    let each = |ranks: &Ranks<'_>| match ranks.is_lead() {
        true => Run::new().on_ranks(ranks).solve(&system, &options),
        false => Ok(None),
    };
    let found = on(&Local::ranks(2), PATIENCE, each);
    assert_eq!(found, [Ok(Some(solve(&system, &options).unwrap())), Ok(None)]);
}

#[test]
fn several_jobs_follow_each_other() {
    let (first, second, options) = (cyclic(5), quadrics(8), SolveOptions::new());
    let each = |ranks: &Ranks<'_>| {
        let job = |system| Run::new().on_ranks(ranks).solve(system, &options);
        job(&first).and_then(|_| job(&second))
    };
    let found = on(&Local::ranks(3), PATIENCE, each);
    assert_eq!(found, [Ok(Some(solve(&second, &options).unwrap())), Ok(None), Ok(None)]);
}

#[test]
fn checkpoints_of_several_ranks_serve_any_number() {
    let (system, options) = (quadrics(13), SolveOptions::new().start(Start::TotalDegree));
    let expected = solve(&system, &options).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // Ended by a cancelled monitor once some batches are recorded, then resumed.
    let directory = folder.path();
    let run = |count: usize, paths: u64| {
        let recorded = || status(directory).is_ok_and(|status| status.done >= paths);
        let monitor = Monitor::asking(move |progress| progress.done >= paths && paths > 0);
        let found = on(&Local::ranks(count), PATIENCE, |ranks| {
            let open = || Checkpoint::open(directory, &CheckpointOptions::new().resume(true));
            let checkpoint = if ranks.is_lead() { Some(open()?) } else { None };
            Run::new().watched(&monitor).recorded(checkpoint.as_ref()).on_ranks(ranks).solve(&system, &options)
        });
        (found[0].clone().unwrap().unwrap(), recorded())
    };
    let (found, recorded) = run(2, 2100);
    assert!(found.interrupted && !recorded);
    assert_eq!(status(directory).unwrap().done, 2048);
    assert_eq!(run(3, 0).0, expected);
    assert_eq!(run(1, 0).0, expected);
}

#[test]
fn a_cancelled_run_ends_on_all_ranks_with_what_it_has() {
    let (system, options) = (quadrics(14), SolveOptions::new().start(Start::TotalDegree));
    let monitor = Monitor::asking(|progress| progress.done >= 100);
    let begun = Instant::now();
    let found =
        on(&Local::ranks(3), PATIENCE, |ranks| Run::new().watched(&monitor).on_ranks(ranks).solve(&system, &options));
    assert!(begun.elapsed() < Duration::from_secs(60));
    let partial = found[0].clone().unwrap().unwrap();
    assert!(partial.interrupted && (100..1 << 14).contains(&partial.len()), "{}", partial.len());
    assert_eq!(found[1..], [Ok(None), Ok(None)]);
}

#[test]
fn ranks_that_do_not_fit_end_the_run_with_the_reason() {
    let (system, options) = (quadrics(12), SolveOptions::new().start(Start::TotalDegree));
    let solved = |options: &SolveOptions, ranks: &Ranks<'_>| Run::new().on_ranks(ranks).solve(&system, options);
    // Another seed.
    let locals = Local::ranks(2);
    let found = on(&locals, PATIENCE, |ranks| solved(&options.clone().seed(u64::from(!ranks.is_lead())), ranks));
    assert_eq!(found, [Err(SolveError::Ranks(RanksError::Differs { rank: 1 })), Ok(None)]);
    // A rank that cannot begin.
    let unreadable = "system.txt: no such file";
    let found = on(&Local::ranks(2), PATIENCE, |ranks| match ranks.is_lead() {
        true => solved(&options, ranks),
        false => {
            ranks.finish(Some(unreadable));
            Ok(None)
        }
    });
    let failed = RanksError::Failed { rank: 1, message: unreadable.to_owned() };
    assert_eq!(found, [Err(SolveError::Ranks(failed)), Ok(None)]);
    // The same error on all.
    let few = options.clone().max_paths(10);
    let found = on(&Local::ranks(2), PATIENCE, |ranks| solved(&few, ranks));
    assert!(found.iter().all(|found| matches!(found, Err(SolveError::TooManyPaths { .. }))), "{found:?}");
    // What is no message, and one that claims to be longer than it is.
    for bytes in [&b""[..], b"\x09", b"\x01\x07", b"\x01\x01\x01\x01\x00\xff\xff\xff\xff\x0f"] {
        let locals = Local::ranks(2);
        locals[1].send(0, bytes.to_vec()).unwrap();
        let found = on(&locals, PATIENCE, |ranks| solved(&options, ranks));
        assert!(matches!(found[0], Err(SolveError::Ranks(RanksError::Message { rank: 1, .. }))), "{found:?}");
        assert_eq!(found[1], Ok(None));
        let locals = Local::ranks(2);
        locals[0].send(1, bytes.to_vec()).unwrap();
        let found = on(&locals, PATIENCE, |ranks| solved(&options, ranks));
        assert!(matches!(found[0], Err(SolveError::Ranks(RanksError::Failed { rank: 1, .. }))), "{found:?}");
        assert!(matches!(found[1], Err(SolveError::Ranks(RanksError::Message { rank: 0, .. }))), "{found:?}");
    }
}

/// An exchange of a rank that answers with ends of other paths.
struct Wrong(Local);

impl Exchange for Wrong {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn rank(&self) -> usize {
        self.0.rank()
    }

    fn send(&self, to: usize, mut message: Vec<u8>) -> Result<(), ExchangeError> {
        if self.rank() == 1 && message.get(1) == Some(&1) {
            // Job, part and number are a byte each, then comes the length of an empty list of ends.
            message.truncate(5);
            message.extend([1, 0]);
        }
        self.0.send(to, message)
    }

    fn receive(&self, wait: Duration) -> Result<Option<(usize, Vec<u8>)>, ExchangeError> {
        self.0.receive(wait)
    }
}

#[test]
fn answers_about_other_paths_are_refused() {
    let (system, options) = (quadrics(13), SolveOptions::new().start(Start::TotalDegree));
    let exchanges: Vec<Wrong> = Local::ranks(2).into_iter().map(Wrong).collect();
    let found = on(&exchanges, PATIENCE, |ranks| Run::new().on_ranks(ranks).solve(&system, &options));
    let Err(SolveError::Ranks(RanksError::Message { rank: 1, reason })) = &found[0] else { panic!("{found:?}") };
    assert!(!reason.is_empty());
}

#[test]
fn a_rank_that_comes_when_all_is_done_has_nothing_to_do() {
    let system: System = "x^2 + y^2 - 5; x*y - 2".parse().unwrap();
    let options = SolveOptions::new().seed(1);
    let job = |local: &Local| {
        let ranks = Ranks::new(local, &RanksOptions::new());
        let found = Run::new().on_ranks(&ranks).solve(&system, &options);
        ranks.finish(None);
        found
    };
    let mut all = Local::ranks(2);
    let late = all.pop().unwrap();
    // Rank 0 is gone before the other has begun.
    assert_eq!(job(&all.pop().unwrap()), solve(&system, &options).map(Some));
    assert_eq!(job(&late), Ok(None));
}
