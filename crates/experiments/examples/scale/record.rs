//! Portions of paths, timed.

use cli::Failure;
use experiments::scale::{Load, Portion};
use hc::checkpoint::{Checkpoint, CheckpointOptions};
use hc::ranks::{Local, Ranks, RanksOptions};
use hc::{Monitor, Run, SolveOptions, Stage, System};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Cyclic n-roots: sums of products of k neighbours are zero, the product of all is one.
fn cyclic(n: usize) -> String {
    let product = |i: usize, k: usize| (i..i + k).map(|j| format!("x{}", j % n)).collect::<Vec<_>>().join("*");
    let sum = |k: usize| (0..n).map(|i| product(i, k)).collect::<Vec<_>>().join(" + ") + "\n";
    (1..n).map(sum).chain([product(0, n) + " - 1\n"]).collect()
}

/// Katsura's equations of magnetism with n + 1 unknowns, which have 2^n solutions.
fn katsura(n: i32) -> String {
    let u = |l: i32| format!("u{}", l.abs());
    let sum = |m: i32| {
        let terms = (-n..=n).filter(|l| (m - l).abs() <= n).map(|l| format!("{}*{}", u(l), u(m - l)));
        format!("{} - u{m}\n", terms.collect::<Vec<_>>().join(" + "))
    };
    let all = (-n..=n).map(u).collect::<Vec<_>>().join(" + ");
    (0..n).map(sum).chain([format!("{all} - 1\n")]).collect()
}

/// What the paths of some systems take.
pub(super) fn systems() -> Result<Vec<Load>, Failure> {
    let systems = [("katsura-13", katsura(13)), ("cyclic-11", cyclic(11))];
    systems.into_iter().map(|(name, text)| load(name, &text)).collect()
}

fn load(name: &str, text: &str) -> Result<Load, Failure> {
    let system: System = text.parse().map_err(Failure::unusable)?;
    let options = SolveOptions::new();
    let folder = tempfile::tempdir().map_err(Failure::unusable)?;
    eprintln!("{name}: two ranks of one thread");
    let (portions, start) = portions(&system, &options, folder.path())?;
    eprintln!("{name}: rank 0 alone takes in what has been recorded");
    let begun = Instant::now();
    let checkpoint =
        Checkpoint::open(folder.path(), &CheckpointOptions::new().resume(true)).map_err(Failure::unusable)?;
    let solved = Run::new().threads(1).map_err(Failure::unusable)?.recorded(&checkpoint).solve(&system, &options);
    let seconds = begun.elapsed().as_secs_f64();
    let found = solved.map_err(Failure::unusable)?;
    let (solutions, lost, systems) = (found.solutions.len(), found.paths.failed, found.start_systems);
    eprintln!("{name}: {solutions} solutions, {lost} paths lost, {systems} start systems");
    // All that comes after the start system, which is made anew.
    let lead = (seconds - start).max(0.0) / found.paths.tracked.max(1) as f64;
    Ok(Load { system: name.to_owned(), lead, start, portions })
}

/// Portions that the second of two ranks tracks, while a checkpoint is written, and the seconds until
/// paths began.
fn portions(system: &System, options: &SolveOptions, folder: &Path) -> Result<(Vec<Portion>, f64), Failure> {
    let (begun, start) = (Instant::now(), Arc::new(OnceLock::new()));
    let first = start.clone();
    let monitor = Monitor::calling(move |progress| {
        if progress.stage == Stage::Paths {
            first.get_or_init(|| begun.elapsed().as_secs_f64());
        }
    });
    let rank = |exchange: Local| {
        let ranks = Ranks::new(&exchange, &RanksOptions::new());
        let found = cli::on_threads(Some(1), || {
            let checkpoint = match ranks.is_lead() {
                true => Some(Checkpoint::open(folder, &CheckpointOptions::new()).map_err(Failure::unusable)?),
                false => None,
            };
            let solved =
                Run::new().watched(&monitor).recorded(checkpoint.as_ref()).on_ranks(&ranks).solve(system, options);
            solved.map(|_| ()).map_err(Failure::unusable)
        });
        let answered = ranks.answered();
        ranks.finish(None);
        found?.map(|()| answered)
    };
    let answered = std::thread::scope(|scope| {
        let rank = &rank;
        let all: Vec<_> = Local::ranks(2).into_iter().map(|local| scope.spawn(move || rank(local))).collect();
        let mut ends =
            all.into_iter().map(|thread| thread.join().map_err(|_| Failure::Unusable("a rank failed".into())));
        ends.next().unwrap_or_else(|| Err(Failure::Unusable("there is no rank".into())))?
    })?;
    let portion = |a: &hc::ranks::Answered| Portion { paths: a.paths, seconds: a.seconds, bytes: a.bytes };
    let portions = answered.iter().filter(|answered| answered.paths > 0).map(portion).collect();
    Ok((portions, start.get().copied().unwrap_or(0.0)))
}
