//! Computes the generic fibre of a family anew: first pair, monodromy, trace test, and a
//! well-placed parameter point.

use anyhow::{Context, Result, ensure};
use hc::family::{ChoiceOptions, StartFile, Stopped, easiest_fibre, real_sample};
use hc::{Family, Fibre, MonodromyOptions};
use tdoa::minimal::parameters_near;
use tdoa::{Layout, Pseudoranges, SimulateOptions, simulate};

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
        // The trace test alone shows no more than that orbits are whole.
        stopped = match stopped {
            Stopped::StartSystem => Stopped::Trace,
            Stopped::NoProgress => Stopped::OrbitsWhole,
            other => other,
        };
        ensure!(passed, "{}: the trace test does not confirm {} roots", family.name(), fibre.len());
    }
    Ok(StartFile::new(&fibre, deviation, &stopped.to_string()))
}

/// The fibre at the parameter point, out of some random ones, from which others are reached with fewest
/// Jacobians: random networks for the solvers of `tdoa` that are chosen for them, random real parameters for the
/// rest.
fn place(family: &Family, fibre: &Fibre, seed: u64) -> Fibre {
    let mut options = ChoiceOptions::default();
    options.seed = seed;
    let solver = SOLVERS.iter().find(|solver| solver.name == family.name());
    if let Some(solver) = solver {
        (options.members, options.samples) = (solver.members, solver.networks);
        options.solutions = solver.solutions;
    }
    let sample = |fibre: &Fibre, k: u64| match solver {
        Some(solver) => parameters_near(fibre, &solver.network(FIRST_NETWORK + k)),
        None => real_sample(fibre.parameters.len(), k),
    };
    let (fibre, jacobians) = easiest_fibre(family.program(), fibre, sample, &options);
    eprintln!("{}: {jacobians:.1} Jacobians a path", family.name());
    fibre
}

/// A solver whose fibre is chosen by random networks, and how many members and networks are tried.
struct Solver {
    name: &'static str,
    dimensions: usize,
    receivers: usize,
    transmitters: usize,
    members: usize,
    networks: usize,
    /// Solutions of a member that are tracked, if not all.
    solutions: Option<usize>,
}

/// Those of the solvers in space with thousands of paths are chosen by a few hundred.
const SOLVERS: [Solver; 7] = [
    planar("6r3s", 6, 3),
    planar("5r4s", 5, 4),
    planar("4r5s", 4, 5),
    spatial("8r5s", 8, 5, 120, None),
    spatial("7r5s", 7, 5, 64, Some(256)),
    spatial("6r6s", 6, 6, 32, Some(128)),
    spatial("10r4s", 10, 4, 64, Some(256)),
];

const fn planar(name: &'static str, receivers: usize, transmitters: usize) -> Solver {
    Solver { name, dimensions: 2, receivers, transmitters, members: 240, networks: 72, solutions: None }
}

const fn spatial(
    name: &'static str,
    receivers: usize,
    transmitters: usize,
    members: usize,
    solutions: Option<usize>,
) -> Solver {
    Solver { name, dimensions: 3, receivers, transmitters, members, networks: 36, solutions }
}

impl Solver {
    /// The measurements of a random network.
    fn network(&self, seed: u64) -> Pseudoranges {
        if self.dimensions == 2 { self.random::<2>(seed) } else { self.random::<3>(seed) }
    }

    fn random<const D: usize>(&self, seed: u64) -> Pseudoranges {
        let mut options = SimulateOptions::<D>::new();
        (options.receivers, options.transmitters, options.seed) = (self.receivers, self.transmitters, seed);
        options.layout = Layout::Normal;
        simulate(&options).expect("a network").pseudoranges
    }
}
