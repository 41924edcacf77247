//! `tdoa solve`.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use cli::files::Files;
use cli::input::name;
use serde::Serialize;
use tdoa::minimal::{MinimalError, MinimalOptions, MinimalStart, RootProofs, Solver, spatial};
use tdoa::node_table::network_table;
use tdoa::picture::networks as picture;
use tdoa::quantity::{coordinate, decimals};
use tdoa::summary::networks;
use tdoa::{Emissions, MinimalSolution, Monitor, Pseudoranges};

use crate::clocks::EmissionArguments;
use crate::frame::Frame;
use crate::units::Unit;
use crate::{Failure, input, interrupt, output};

/// Finds every network that explains pseudoranges without errors, best first: in the plane 6r/3s,
/// 4r/5s, 5r/4s and all larger sizes, in space (--dimensions 3) 10r/4s, 7r/5s, 6r/6s and all larger
/// sizes. Of ranges (--ranges) 3r/3s and all larger sizes, in space 6r/4s, 5r/5s, 4r/6s and all larger sizes; of ranges
/// with one unknown constant (--emissions constant) 4r/3s, 3r/4s and all larger sizes, in space 7r/4s, 5r/5s, 4r/7s
/// and all larger sizes.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The measurements, in the forms that `calibrate` takes; none may be missing. - for standard
    /// input.
    file: PathBuf,
    #[command(flatten)]
    input: crate::units::InputArguments,
    /// Whether the network is sought in the plane or in space, which must be asked for: small
    /// tables of measurements in space may fit networks in the plane too.
    #[arg(long, value_name = "2|3", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimensions: u8,
    #[command(flatten)]
    sending: EmissionArguments,
    /// How far below zero a distance may lie for a network to count as physical, and in space how
    /// large residuals may be, as a share of the size of the data; for noisy data the noise.
    #[arg(long, default_value_t = MinimalOptions::default().tolerance)]
    tolerance: f64,
    /// Where paths start: at the stored solutions of a generic instance, or, in the plane, at a
    /// polyhedral start system computed for these data; ranges from the stored ones only.
    #[arg(long, value_enum, default_value = "stored")]
    start: StartArgument,
    /// Stops at the first physical network with a residual (root mean square, metres) below this;
    /// 6r/3s, 5r/4s, 4r/5s and 5r/6s only, in space 8r/5s, 7r/5s, 6r/6s and 10r/4s; of ranges the smallest sizes.
    #[arg(long, value_name = "METRES")]
    first_under: Option<f64>,
    /// Proves by interval arithmetic that the complex roots at the ends of all paths exist and are
    /// distinct, and counts how many are proved real; of larger sizes those of the part that is solved.
    /// Only sizes that are solved by paths have such roots.
    #[arg(long)]
    prove: bool,
    /// Puts every network into one frame, in which they can be compared: ORIGIN at (0, 0), XAXIS on the positive x
    /// axis and UP above it; in space ORIGIN,XAXIS,YSIDE,UP, with YSIDE in the plane of x and y, or the first three
    /// of these, with z positive on the side of most nodes.
    #[arg(long, value_name = "ORIGIN,XAXIS,UP")]
    frame: Option<String>,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Writes the result as JSON; - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Writes a picture of every physical network, one below another.
    #[arg(long)]
    svg: Option<PathBuf>,
    /// Writes the nodes of every physical network as a CSV table: rank of the network, kind, name, position, offset.
    #[arg(long, value_name = "FILE.csv")]
    nodes: Option<PathBuf>,
}

impl Arguments {
    /// The options that ask for files, with these.
    fn outputs(&self) -> [(&'static str, Option<&Path>); 3] {
        [("--json", self.json.as_deref()), ("--svg", self.svg.as_deref()), ("--nodes", self.nodes.as_deref())]
    }
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum StartArgument {
    Stored,
    Polyhedral,
}

/// The JSON form.
#[derive(Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
struct Report<'a, const D: usize> {
    /// 2 in the plane, 3 in space.
    dimensions: usize,
    #[serde(flatten)]
    solution: &'a MinimalSolution<D>,
    /// What is proved of the roots, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    proofs: Option<RootProofs>,
    receiver_names: &'a [String],
    transmitter_names: &'a [String],
    seconds: f64,
    /// Zero: the solvers draw no random numbers.
    seed: u64,
    /// Unit of the input, where that is not the metre.
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<Unit>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files = Files::new().reads(Some(&arguments.file));
    arguments.outputs().into_iter().fold(files, |files, (option, path)| files.writes(option, path)).check()?;
    let options = arguments.input.options(false)?;
    let unit = Unit::new(options.units.unwrap_or_default());
    let measured = input::measurements(&arguments.file, options)?;
    let frame = arguments.frame.as_deref().map(|text| Frame::parse(text, &measured)).transpose()?;
    if arguments.dimensions == 2 && frame.as_ref().is_some_and(Frame::is_spatial) {
        return Err(Frame::too_many_names());
    }
    if measured.has_candidates() {
        eprintln!("note: exact solvers take the first candidate of each cell; tdoa calibrate picks among all");
    }
    if arguments.tolerance.is_nan() || arguments.tolerance < 0.0 {
        return Err(Failure::Unusable("--tolerance must not be negative".to_string()));
    }
    if arguments.first_under.is_some_and(|v| v.is_nan() || v < 0.0) {
        return Err(Failure::Unusable("--first-under must not be negative".to_string()));
    }
    let mut options = MinimalOptions::default();
    options.emissions = arguments.sending.emissions();
    options.first_under = arguments.first_under;
    options.tolerance = arguments.tolerance;
    options.start = match arguments.start {
        StartArgument::Stored => MinimalStart::Stored,
        StartArgument::Polyhedral => MinimalStart::Polyhedral,
    };
    let (prove, options) = (arguments.prove, &options);
    let solve_in_plane = |monitor: &Monitor| {
        let mut solver = Solver::new();
        let solved = solver.solve_watched(&measured, options, monitor)?;
        Ok((solved, prove.then(|| solver.prove_watched(monitor)).flatten()))
    };
    let solve_in_space = |monitor: &Monitor| {
        let mut solver = spatial::Solver::new();
        let solved = solver.solve_watched(&measured, options, monitor)?;
        Ok((solved, prove.then(|| solver.prove_watched(monitor)).flatten()))
    };
    match arguments.dimensions {
        2 => answer(arguments, unit, &measured, frame, solve_in_plane),
        _ => answer(arguments, unit, &measured, frame, solve_in_space),
    }
}

/// Networks, and what is proved of the roots behind them.
type Solved<const D: usize> = (MinimalSolution<D>, Option<RootProofs>);

/// Solves and reports.
fn answer<const D: usize>(
    arguments: &Arguments,
    unit: Option<Unit>,
    measured: &Pseudoranges,
    frame: Option<Frame>,
    solve: impl FnOnce(&Monitor) -> Result<Solved<D>, MinimalError> + Send,
) -> Result<(), Failure>
where
    [f64; D]: Serialize,
{
    let monitor = Monitor::heeding(interrupt::watch()?);
    let progress = || {
        let progress = monitor.progress();
        (progress.done, progress.total, progress.to_string())
    };
    let started = Instant::now();
    let solved = cli::bar::while_shown(arguments.threads, progress, || solve(&monitor))?;
    interrupt::check()?;
    let (mut solution, proofs) =
        solved.map_err(|error| Failure::Undetermined(format!("{}: {error}", name(&arguments.file))))?;
    if let Some(frame) = frame {
        for candidate in &mut solution.candidates {
            frame.apply_network(&mut candidate.network)?;
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    if let Some(path) = &arguments.json {
        let report = Report {
            dimensions: D,
            solution: &solution,
            proofs,
            receiver_names: measured.receiver_names(),
            transmitter_names: measured.transmitter_names(),
            seconds,
            seed: 0,
            units: unit,
        };
        output::json(path, &report)?;
    }
    let names = [measured.receiver_names(), measured.transmitter_names()];
    if let Some(path) = &arguments.svg {
        output::text(path, &picture(&solution, names))?;
    }
    if let Some(path) = &arguments.nodes {
        output::text(path, &network_table(&solution, names))?;
    }
    for warning in &solution.warnings {
        eprintln!("warning: {warning}");
    }
    let outputs = arguments.outputs().into_iter().filter_map(|(_, path)| path);
    output::summary(outputs, || summary(&solution, proofs, measured, unit, seconds))?;
    if !solution.warnings.is_empty() {
        return Err(Failure::Undetermined(format!(
            "{}: the data do not determine the network, or the result is not whole; see the warnings",
            name(&arguments.file)
        )));
    }
    if arguments.prove && !proofs.is_some_and(|proofs| proofs.proved == proofs.roots && proofs.unseparated == 0) {
        return Err(Failure::Undetermined(match proofs {
            Some(proofs) => format!(
                "{}: {} of {} roots are not proved to exist, and {} pairs not to be different; the networks are as listed without \
                 proof",
                name(&arguments.file),
                proofs.roots - proofs.proved,
                proofs.roots,
                proofs.unseparated
            ),
            None => format!(
                "{}: --prove proves the roots at the ends of paths, and {} is solved without paths",
                name(&arguments.file),
                solution.configuration
            ),
        }));
    }
    if solution.candidates.iter().any(|candidate| candidate.physical) {
        return Ok(());
    }
    let in_space = if D == 2 { "; if they are of space, --dimensions 3 looks there" } else { "" };
    Err(Failure::Undetermined(format!(
        "{}: no physical network explains the measurements exactly; if they are noisy, give the noise as --tolerance or use \
         `tdoa calibrate`{in_space}",
        name(&arguments.file)
    )))
}

fn summary<const D: usize>(
    solution: &MinimalSolution<D>,
    proofs: Option<RootProofs>,
    measured: &Pseudoranges,
    unit: Option<Unit>,
    seconds: f64,
) -> String {
    let mut text = networks(solution, Some(Duration::from_secs_f64(seconds)));
    if let Some(RootProofs { roots, proved, real, unseparated }) = proofs {
        text += &format!(
            "proved: {proved} of {roots} roots exist, {real} of them real; {unseparated} pairs not proved different\n"
        );
    }
    text += &format!("\n{:>4} {:>12} {:>10} {:>10}\n", "rank", "residual m", "physical", "condition");
    for (k, candidate) in solution.candidates.iter().take(20).enumerate() {
        let physical = if candidate.physical { "yes" } else { "no" };
        text +=
            &format!("{:>4} {:>12.2e} {:>10} {:>10.1e}\n", k + 1, candidate.residual, physical, candidate.condition);
    }
    if solution.candidates.len() > 20 {
        text += &format!("... and {} more, all in --json\n", solution.candidates.len() - 20);
    }
    if let Some(best) = solution.candidates.first() {
        text += "\nbest network, metres\n";
        let digits = decimals(best.network.size()) + 2;
        let shown = |value: f64| coordinate(value, digits);
        let place = |p: &[f64; D]| p.iter().map(|&x| format!(" {:>13}", shown(x))).collect::<String>();
        for (name, p) in measured.receiver_names().iter().zip(&best.network.receivers) {
            text += &format!("receiver    {name:>5}{}\n", place(p));
        }
        let transmitters = best.network.transmitters.iter().zip(&best.network.offsets);
        for (name, (p, o)) in measured.transmitter_names().iter().zip(transmitters) {
            let in_unit = unit.map_or_else(String::new, |unit| {
                format!(" = {} {}", coordinate(unit.of(*o), unit.decimals(digits)), unit.name)
            });
            let offset = format!("   offset {:>13}{in_unit}", shown(*o));
            let offset = if solution.emissions == Emissions::Known { "" } else { &*offset };
            text += &format!("transmitter {name:>5}{}{offset}\n", place(p));
        }
    }
    text
}
