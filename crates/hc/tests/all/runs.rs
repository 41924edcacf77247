//! One way to watch, stop, record and divide every long work, and to set its threads.

use hc::certify::{CertifyError, Obstacle};
use hc::checkpoint::{Checkpoint, CheckpointError, CheckpointOptions};
use hc::start::MixedError;
use hc::{CertifyOptions, Complex64, Family, FamilyError, Monitor, MonodromyOptions, Run, SolveError, SolveOptions};
use hc::{Stage, System};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

static SQUARES: &str = r#"
    name = "squares"
    unknowns = ["x"]
    parameters = ["a", "b"]
    equations = ["x^2 + a*x + b"]
"#;

fn circle() -> System {
    "x^2 + y^2 - 5; x*y - 2".parse().unwrap()
}

/// The four real points of the circle and the hyperbola.
fn points() -> Vec<Vec<Complex64>> {
    let real = |x: f64, y: f64| vec![Complex64::new(x, 0.0), Complex64::new(y, 0.0)];
    vec![real(1.0, 2.0), real(2.0, 1.0), real(-1.0, -2.0), real(-2.0, -1.0)]
}

fn supports() -> Vec<Vec<Vec<i32>>> {
    vec![vec![vec![0, 0], vec![2, 0], vec![0, 2]], vec![vec![0, 0], vec![1, 1]]]
}

#[test]
fn no_run_changes_a_result() {
    let (system, family) = (circle(), SQUARES.parse::<Family>().unwrap());
    let (options, search) = (SolveOptions::new().seed(3), MonodromyOptions::new().seed(3));
    let fibre = family.monodromy(&search).unwrap().fibre;
    let all = |run: &Run| {
        let targets = [[1.0, 2.0], [3.0, 2.0]];
        (
            run.solve(&system, &options).unwrap(),
            run.decompose(&system, &options).unwrap(),
            run.monodromy(&family, &search).unwrap().fibre,
            run.track(&family, &fibre, &targets).run().unwrap(),
            run.trace_test(&family, &fibre, &search).unwrap(),
            run.certify(&system, &[], &points(), &CertifyOptions::default()).unwrap(),
            run.mixed_volume(2, &supports()).unwrap(),
        )
    };
    let expected = (
        hc::solve(&system, &options).unwrap(),
        hc::witness::decompose(&system, &options).unwrap(),
        fibre.clone(),
        family.track(&fibre, &[[1.0, 2.0], [3.0, 2.0]]).run().unwrap(),
        family.trace_test(&fibre, &search).unwrap(),
        hc::certify(&system, &[], &points(), &CertifyOptions::default()).unwrap(),
        hc::mixed_volume(2, &supports()).unwrap(),
    );
    // Four points, two roots, and as many as the mixed volume says.
    assert_eq!((expected.0.len(), expected.2.len(), expected.5.n_distinct(), expected.6.volume), (4, 2, 4, 4));
    for threads in [1, 3] {
        let run = Run::new().threads(threads).unwrap().watched(&Monitor::watched());
        assert!(all(&run) == expected, "{threads} threads");
    }
    // Without other ranks, the same.
    let alone = Run::new().on_ranks(None);
    assert_eq!(alone.solve(&system, &options).unwrap(), Some(expected.0));
    assert_eq!(alone.complete(&family, &fibre, &search).unwrap().unwrap().fibre, expected.2);
    assert_eq!(alone.mixed_volume(2, &supports()).unwrap(), Some(expected.6));
}

#[test]
fn work_without_records_refuses_a_checkpoint() {
    let (system, family) = (circle(), SQUARES.parse::<Family>().unwrap());
    let (options, search) = (SolveOptions::new(), MonodromyOptions::new());
    let fibre = family.monodromy(&search).unwrap().fibre;
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = Checkpoint::open(folder.path().join("run"), &CheckpointOptions::new()).unwrap();
    let run = Run::new().recorded(&checkpoint);
    let refused = |error: CheckpointError| assert!(matches!(error, CheckpointError::Unrecorded(_)), "{error}");
    let Err(SolveError::Checkpoint(error)) = run.decompose(&system, &options) else { panic!("recorded") };
    refused(error);
    let Err(FamilyError::Checkpoint(error)) = run.trace_test(&family, &fibre, &search) else { panic!("recorded") };
    refused(error);
    let Err(CertifyError::Checkpoint(error)) = run.certify(&system, &[], &points(), &CertifyOptions::default()) else {
        panic!("recorded")
    };
    refused(error);
    let Err(MixedError::Checkpoint(error)) = run.mixed_volume(2, &supports()) else { panic!("recorded") };
    refused(error);
    // The checkpoint has served nobody.
    assert_eq!(run.solve(&system, &options).unwrap().len(), 4);
}

#[test]
fn proofs_are_watched_and_stopped() {
    let system = circle();
    let stages = std::sync::Arc::new((Mutex::new(Vec::new()), AtomicUsize::new(0)));
    let heard = stages.clone();
    let watching = Monitor::calling(move |progress| {
        heard.0.lock().unwrap().push((progress.stage, progress.total));
        heard.1.fetch_max(progress.counted as usize, Ordering::Relaxed);
    });
    let run = Run::new().watched(&watching);
    let proofs = run.certify(&system, &[], &points(), &CertifyOptions::default()).unwrap();
    assert!(proofs.complete() && !proofs.interrupted());
    assert!(stages.0.lock().unwrap().iter().all(|stage| *stage == (Stage::Proofs, 4)));
    assert_eq!(stages.1.load(Ordering::Relaxed), 4);
    // Stopped after two points, on one thread: the others are not tried, and nobody is told that all are proved.
    let stopping = Monitor::asking(|progress| progress.done >= 2);
    let run = Run::new().threads(1).unwrap().watched(&stopping);
    let partial = run.certify(&system, &[], &points(), &CertifyOptions::default()).unwrap();
    assert!(partial.interrupted() && !partial.complete());
    assert_eq!(partial.n_certified(), 2);
    assert_eq!(partial.points[2..], [Err(Obstacle::Cancelled), Err(Obstacle::Cancelled)]);
}
