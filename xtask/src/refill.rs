//! Computes the generic fibre of a family anew: first pair, monodromy, trace test, and a
//! well-placed parameter point.

use anyhow::{Context, Result, ensure};
use hc::family::{ChoiceOptions, StartFile, Stopped, easiest_fibre, real_sample};
use hc::{Family, Fibre, MonodromyOptions};
use tdoa::minimal::parameters_near;
use tdoa::{Layout, Pseudoranges, SimulateOptions, simulate};

/// Members and networks that are tried for the solvers in the plane.
const MEMBERS: usize = 240;
const NETWORKS: usize = 72;
/// Seed of the first network; the experiments begin at zero.
const FIRST_NETWORK: u64 = 1_000_000;

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
    let fibre = place(family, &found.fibre, seed);
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

/// The fibre at the parameter point, out of some random ones, from which others are reached with fewest
/// Jacobians: random networks for the solvers in the plane, random real parameters for the rest.
fn place(family: &Family, fibre: &Fibre, seed: u64) -> Fibre {
    let mut options = ChoiceOptions::default();
    options.seed = seed;
    let network = match family.name() {
        "6r3s" => Some((6, 3)),
        "5r4s" => Some((5, 4)),
        "4r5s" => Some((4, 5)),
        _ => None,
    };
    if network.is_some() {
        (options.members, options.samples) = (MEMBERS, NETWORKS);
    }
    let sample = |fibre: &Fibre, k: u64| match network {
        Some((receivers, transmitters)) => parameters_near(fibre, &random_network(receivers, transmitters, k)),
        None => real_sample(fibre.parameters.len(), k),
    };
    let (fibre, jacobians) = easiest_fibre(family.program(), fibre, sample, &options);
    eprintln!("{}: {jacobians:.1} Jacobians a path", family.name());
    fibre
}

/// The measurements of a random network in the plane.
fn random_network(receivers: usize, transmitters: usize, k: u64) -> Pseudoranges {
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters, options.seed) = (receivers, transmitters, FIRST_NETWORK + k);
    options.layout = Layout::Normal;
    simulate(&options).expect("a network").pseudoranges
}
