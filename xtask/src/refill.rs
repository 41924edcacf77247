//! Computes the generic fibre of a family anew: first pair, monodromy, trace test, and a
//! well-placed parameter point.

use anyhow::{Context, Result, ensure};
use hc::family::{StartFile, Stopped, move_fibre, track_fibre};
use hc::poly::Interpreter;
use hc::random::Random;
use hc::{Family, Fibre, FibreOptions, MonodromyOptions};
use num_complex::Complex64;

/// Parameter points that are tried as the place of the fibre, and real targets that each is judged
/// by.
const PLACES: u64 = 24;
const TARGETS: u64 = 12;
/// The numbers of their random streams. Others would give other fibres.
const FIRST_TARGET: u64 = 1000;
const FIRST_PLACE: u64 = 2000;

/// Trace tests on different lines until one confirms the fibre.
const TRACES: u64 = 4;

/// The fibre of a family, found from nothing.
pub(crate) fn refill(family: &Family, seed: u64, with_trace: bool) -> Result<StartFile> {
    let mut options = MonodromyOptions::new().seed(seed).trace_test(false);
    let found = family.monodromy(&options).with_context(|| family.name().to_owned())?;
    eprintln!("{}: {} roots after {} loops and {} paths", family.name(), found.fibre.len(), found.loops, found.paths);
    let mut stopped = found.stopped;
    if let Some(roots) = family.roots() {
        ensure!(found.fibre.len() == roots, "{}: {} roots instead of {roots}", family.name(), found.fibre.len());
    }
    let fibre = place(family.program(), &found.fibre, seed)?;
    let mut deviation = None;
    if with_trace {
        // One further point far out that no path reaches spoils the test; on another line it lies
        // elsewhere.
        let mut passed = false;
        for attempt in 0..TRACES {
            options.seed = seed.wrapping_add(attempt);
            let test = family.trace_test(&fibre, &options)?;
            eprintln!("{}: trace test {test:?}", family.name());
            deviation = Some(test.deviation);
            passed = test.passed(fibre.len());
            if passed {
                break;
            }
        }
        if passed && family.roots().is_none() {
            stopped = Stopped::Trace;
        }
        ensure!(passed, "{}: the trace test does not confirm {} roots", family.name(), fibre.len());
    }
    Ok(StartFile::new(&fibre, deviation, &stopped.to_string()))
}

/// Moves the fibre to the parameter point, out of some random ones, from which random real targets
/// are reached in the fewest steps.
fn place(system: &Interpreter, fibre: &Fibre, seed: u64) -> Result<Fibre> {
    let m = fibre.parameters.len();
    let targets: Vec<Vec<Complex64>> = (0..TARGETS)
        .map(|k| {
            Random::new(seed, FIRST_TARGET + k)
                .normals(m)
                .iter()
                .map(|z| Complex64::new(z.re * 2f64.sqrt(), 0.0))
                .collect()
        })
        .collect();
    let mut best: Option<(usize, Fibre)> = None;
    for k in 0..PLACES {
        let point = Random::new(seed, FIRST_PLACE + k).normals(m);
        let Some(moved) = move_fibre(system, fibre, &point, &FibreOptions::default()) else { continue };
        let mut steps = 0;
        for target in &targets {
            let (ends, counts) = track_fibre(system, &moved, target, &FibreOptions::default());
            steps += ends.results().iter().map(|r| r.accepted + r.rejected).sum::<usize>();
            steps += 10_000 * (counts.failed + counts.retracked);
        }
        if best.as_ref().is_none_or(|(least, _)| steps < *least) {
            eprintln!("place {k}: {:.1} steps a path", steps as f64 / (TARGETS as usize * moved.len()) as f64);
            best = Some((steps, moved));
        }
    }
    best.map(|(_, fibre)| fibre).context("the fibre could not be moved whole to any other parameter point")
}
