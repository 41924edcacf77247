//! `tdoa experiment clean`.

use crate::{Failure, output};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use std::fmt::Write;
use std::path::PathBuf;
use tdoa::experiment::clean::{CleanSummary, CleanTrial, clean_trial, summarise};
use tdoa::minimal::{SolveOptions, Solver};
use tdoa::{Layout, SimulateOptions, simulate};

/// Solves clean random networks of one configuration (positions and offsets standard normal) and counts roots, lost paths and errors.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configuration, such as 6r/3s, 4r/5s or 9r/4s.
    #[arg(long, default_value = "6r/3s", value_parser = configuration)]
    configuration: (usize, usize),
    /// Number of networks.
    #[arg(long, default_value_t = 1000)]
    instances: u64,
    /// First seed; the networks have this and the following ones.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. Only the seconds depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Directory for trials.csv and summary.md; made if it is not there.
    #[arg(long)]
    output: PathBuf,
}

/// Reads `6r/3s`.
pub(super) fn configuration(text: &str) -> Result<(usize, usize), String> {
    let wrong = || format!("`{text}` is not a configuration such as 6r/3s");
    let (receivers, transmitters) = text.split_once('/').ok_or_else(wrong)?;
    let number = |part: &str, unit: char| part.strip_suffix(unit).and_then(|n| n.parse().ok()).ok_or_else(wrong);
    Ok((number(receivers, 'r')?, number(transmitters, 's')?))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let one = |solver: &mut Solver, seed: u64| -> Result<CleanTrial, Failure> {
        let mut options = SimulateOptions::default();
        (options.receivers, options.transmitters) = arguments.configuration;
        options.layout = Layout::Normal;
        options.noise = 0.0;
        options.outliers = 0.0;
        options.missing = 0.0;
        options.seed = seed;
        let simulation = simulate(&options).map_err(Failure::unusable)?;
        clean_trial(solver, &simulation, seed, &SolveOptions::default()).map_err(Failure::unusable)
    };
    let seeds = arguments.seed..arguments.seed.saturating_add(arguments.instances);
    let bar = output::progress(arguments.instances);
    let trials: Vec<CleanTrial> = crate::on_threads(arguments.threads, || {
        seeds
            .into_par_iter()
            .map_init(Solver::new, |solver, seed| {
                let trial = one(solver, seed);
                bar.inc(1);
                trial
            })
            .collect::<Result<_, _>>()
    })??;
    bar.finish_and_clear();
    let summary = page(arguments, &summarise(&trials), &trials);
    let directory = &arguments.output;
    std::fs::create_dir_all(directory)
        .map_err(|error| Failure::Unusable(format!("{}: cannot be made ({error})", directory.display())))?;
    output::write(&directory.join("trials.csv"), table(&trials).as_bytes())?;
    output::write(&directory.join("summary.md"), summary.as_bytes())?;
    output::print(&summary)
}

fn table(trials: &[CleanTrial]) -> String {
    let mut text = "seed,tracked,finite,at_infinity,failed,retracked,complex,real,positive_definite,physical,found,\
                    position_error,offset_error,steps,rejected,jacobians\n"
        .to_string();
    for t in trials {
        let (p, c) = (&t.paths, &t.counts);
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{:.2e},{:.2e},{},{},{}",
            t.seed,
            p.tracked,
            p.finite,
            p.at_infinity,
            p.failed,
            p.retracked,
            c.complex,
            c.real,
            c.positive_definite,
            c.physical,
            t.found,
            t.position_error,
            t.offset_error,
            t.steps,
            t.rejected,
            t.jacobians
        );
    }
    text
}

fn page(arguments: &Arguments, s: &CleanSummary, trials: &[CleanTrial]) -> String {
    let name = format!("{}r/{}s", arguments.configuration.0, arguments.configuration.1);
    let [steps, rejected, jacobians] = s.per_path;
    let row = |[least, largest, mean, deviation]: [f64; 4]| format!("{least} | {largest} | {mean:.2} | {deviation:.2}");
    let mut text = format!(
        "# {name} on clean data\n\n\
         `tdoa experiment clean --configuration {name} --instances {} --seed {} --output DIR`: positions and offsets standard normal, no noise.\n\n\
         | | |\n|---|---|\n\
         | instances | {} |\n\
         | with all paths ended well | {} |\n\
         | paths lost, of {} | {} |\n\
         | paths at infinity | {} |\n\
         | paths tracked again | {} in {} instances |\n\
         | true network among the candidates | {} |\n\
         | odd number of real networks | {} |\n\
         | relative position error, median and 99 % | {:.1e}, {:.1e} |\n\
         | relative offset error, median and 99 % | {:.1e}, {:.1e} |\n\
         | accepted steps, rejected steps, Jacobians a path | {steps:.1}, {rejected:.1}, {jacobians:.1} |\n\
         | milliseconds a solve on one thread (this machine), median and 99 % | {:.1}, {:.1} |\n\n",
        s.instances,
        arguments.seed,
        s.instances,
        s.complete,
        trials.iter().map(|t| t.paths.tracked).sum::<usize>(),
        s.paths_lost,
        s.paths_at_infinity,
        s.paths_retracked,
        s.instances_retracked,
        s.found,
        s.odd,
        s.position_error[0],
        s.position_error[1],
        s.offset_error[0],
        s.offset_error[1],
        1e3 * s.seconds[0],
        1e3 * s.seconds[1],
    );
    let [real, feasible] = if name == "6r/3s" {
        [
            "| the paper's Table 2: real | 2 | 55 | 8.7 | 7.6 |\n",
            "| the paper's Table 2: feasible | 1 | 32 | 3 | 3.9 |\n",
        ]
    } else {
        ["", ""]
    };
    let _ = write!(
        text,
        "Number of networks:\n\n\
         | | least | largest | mean | standard deviation |\n|---|---|---|---|---|\n\
         | real positions | {} |\n{real}| physical: all f_ij - o_j >= 0 | {} |\n{feasible}",
        row(s.positive_definite),
        row(s.physical),
    );
    let unusual: Vec<&CleanTrial> =
        trials.iter().filter(|t| !t.found || t.paths.failed > 0 || t.paths.at_infinity > 0).collect();
    if !unusual.is_empty() {
        text += "\nInstances that are not complete:\n\n| seed | finite | at infinity | failed | truth found |\n|---|---|---|---|---|\n";
        for t in unusual {
            let p = &t.paths;
            let _ = writeln!(text, "| {} | {} | {} | {} | {} |", t.seed, p.finite, p.at_infinity, p.failed, t.found);
        }
    }
    text
}
