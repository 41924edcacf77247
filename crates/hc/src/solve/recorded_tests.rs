//! Solves that go on from a checkpoint.

use crate::checkpoint::support::{goes_on_from_every_record, resumed};
use crate::checkpoint::{Checkpoint, CheckpointError, CheckpointOptions, status};
use crate::{Monitor, Progress, Run, SolveError, SolveOptions, Stage, Start, System, solve};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// `2^n` regular solutions.
pub(super) fn quadrics(n: usize) -> System {
    let next = |i: usize, k: usize| (i + k) % n;
    let equation =
        |i: usize| format!("x{i}^2 - {}*x{}*x{} + 3*x{} + {}\n", i + 2, next(i, 1), next(i, 2), next(i, 3), i + 1);
    (0..n).map(equation).collect::<String>().parse().unwrap()
}

/// The number of paths that are tracked: progress counts them.
fn counted() -> (Monitor, Arc<AtomicU64>) {
    let most = Arc::new(AtomicU64::new(0));
    let count = Arc::clone(&most);
    let told = move |progress: Progress| {
        if progress.stage == Stage::Paths {
            count.fetch_max(progress.done, Ordering::Relaxed);
        }
    };
    (Monitor::calling(told), most)
}

/// Wherever the log ends, the solutions are the same, on any number of threads.
#[test]
fn solves_go_on_from_every_record_to_the_same_bits() {
    // Several batches; and paths to infinity, multiple solutions, a trial and paths tracked again.
    let small: System = "x*(x - y)*(x + y - 1)^2 - 1e-9\n(y - 1)^2*(y + x)*(x - 2)".parse().unwrap();
    let cases =
        [(quadrics(12), SolveOptions::new().seed(3).start(Start::TotalDegree)), (small, SolveOptions::new().seed(1))];
    for (system, options) in cases {
        let expected = solve(&system, &options).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let directory = folder.path().join("run");
        let checkpoint = Checkpoint::open(&directory, &CheckpointOptions::new()).unwrap();
        let (monitor, tracked) = counted();
        assert_eq!(Run::new().watched(&monitor).recorded(&checkpoint).solve(&system, &options).unwrap(), expected);
        assert!(tracked.load(Ordering::Relaxed) > 0);
        let again = Run::new().watched(&monitor).recorded(&checkpoint).solve(&system, &options);
        assert_eq!(again, Err(SolveError::Checkpoint(CheckpointError::Used(directory.clone()))));
        drop(checkpoint);

        let work = |checkpoint: &Checkpoint| Run::new().recorded(checkpoint).solve(&system, &options);
        assert!(goes_on_from_every_record(&directory, &expected, work) >= 2);
        // Nothing is tracked any more.
        let checkpoint = Checkpoint::open(&directory, &CheckpointOptions::new().resume(true)).unwrap();
        let (monitor, tracked) = counted();
        assert_eq!(Run::new().watched(&monitor).recorded(&checkpoint).solve(&system, &options).unwrap(), expected);
        assert_eq!(tracked.load(Ordering::Relaxed), 0);
    }
}

#[test]
fn other_runs_are_refused_with_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let (system, options) = (quadrics(3), SolveOptions::new().seed(1));
    let record = || {
        let checkpoint = Checkpoint::open(folder.path(), &CheckpointOptions::new())?;
        Run::new().recorded(&checkpoint).solve(&system, &options)
    };
    let found = record().unwrap();
    assert!(matches!(record(), Err(SolveError::Checkpoint(CheckpointError::Taken(_)))));
    let again = |system: &System, options: &SolveOptions| {
        resumed(folder.path(), 1, |checkpoint| Run::new().recorded(checkpoint).solve(system, options))
    };
    let differs = |system: &System, options: &SolveOptions| {
        let error = again(system, options).unwrap_err();
        let SolveError::Checkpoint(CheckpointError::Differs { name, recorded, own, .. }) = error else {
            panic!("{error}")
        };
        (name, recorded, own)
    };
    let named = |name: &str, recorded: &str, own: &str| (name.to_owned(), recorded.to_owned(), own.to_owned());
    assert_eq!(differs(&system, &options.clone().seed(2)), named("seed", "1", "2"));
    assert_eq!(differs(&system, &options.clone().torus_only(true)), named("torus_only", "false", "true"));
    assert_eq!(differs(&system, &options.clone().start(Start::Polyhedral)), named("start", "auto", "polyhedral"));
    assert_eq!(differs(&quadrics(4), &options).0, "system equations");
    // A coefficient.
    let other: System = quadrics(3).to_string().replacen('3', "3.5", 1).parse().unwrap();
    assert_eq!(differs(&other, &options).0, "system hash");
    // What changes no path may change.
    let (certified, _) = again(&system, &options.max_paths(1 << 20).certify(true)).unwrap();
    assert_eq!((certified.len(), certified.uncertified()), (found.len(), 0));
}

#[test]
fn one_run_at_a_time_and_a_status_for_everybody() {
    let folder = tempfile::tempdir().unwrap();
    let (system, options) = (quadrics(3), SolveOptions::new());
    let checkpoint = Checkpoint::open(folder.path(), &CheckpointOptions::new()).unwrap();
    let second = Checkpoint::open(folder.path(), &CheckpointOptions::new().resume(true));
    assert_eq!(second.map(|_| ()), Err(CheckpointError::InUse(folder.path().to_owned())));
    assert!(matches!(status(folder.path()), Err(CheckpointError::Io { .. })));
    Run::new().recorded(&checkpoint).solve(&system, &options).unwrap();
    let now = status(folder.path()).unwrap();
    assert_eq!((now.what.as_str(), now.running, now.part, now.round), ("solve", true, 1, 1));
    assert_eq!((now.done, now.total, now.solutions), (8, Some(8), 8));
    drop(checkpoint);
    assert!(!status(folder.path()).unwrap().running);
    assert!(matches!(status(folder.path().join("none")), Err(CheckpointError::Io { .. })));
}
