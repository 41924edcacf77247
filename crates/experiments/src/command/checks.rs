//! `tdoa experiment proofs | hurry | charts`.

use super::common::configuration;
use crate::trials::checks::{ChartTrial, HurryTrial, chart_trial, hurry_trial, proof_trial};
use cli::bar::Bar;
use cli::files::Files;
use cli::{Failure, output};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use std::fmt::Write;
use std::path::PathBuf;
use tdoa::minimal::{MinimalError, MinimalOptions, RootProofs, Solver};
use tdoa::{Layout, SimulateOptions, Simulation, simulate};

/// What all of them take.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "6r/3s,5r/4s,4r/5s", value_parser = configuration, value_delimiter = ',')]
    configuration: Vec<(usize, usize)>,
    /// Number of networks of each configuration (positions and offsets standard normal, no noise).
    #[arg(long, default_value_t = 100)]
    instances: u64,
    /// First seed.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. Only the seconds depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Markdown file to write.
    #[arg(long)]
    output: PathBuf,
}

impl Arguments {
    /// Runs `one` on every network of a configuration, in the order of the seeds.
    fn each<T: Send>(
        &self,
        (receivers, transmitters): (usize, usize),
        one: impl Fn(&mut Solver, &Simulation) -> Result<T, MinimalError> + Sync,
    ) -> Result<Vec<T>, Failure> {
        Files::new().writes("--output", Some(&self.output)).check()?;
        let bar = Bar::counted(self.instances);
        let seeds = self.seed..self.seed.saturating_add(self.instances);
        let trials = cli::on_threads(self.threads, || {
            seeds
                .into_par_iter()
                .map_init(Solver::new, |solver, seed| {
                    let mut options = SimulateOptions::default();
                    (options.receivers, options.transmitters) = (receivers, transmitters);
                    options.layout = Layout::Normal;
                    options.noise = 0.0;
                    options.seed = seed;
                    let simulation = simulate(&options).map_err(Failure::unusable)?;
                    let trial = one(solver, &simulation).map_err(Failure::unusable);
                    bar.inc(1);
                    trial
                })
                .collect::<Result<Vec<T>, Failure>>()
        })??;
        bar.finish_and_clear();
        Ok(trials)
    }

    fn command(&self, name: &str) -> String {
        format!("`tdoa experiment {name} --instances {} --seed {} --output FILE`", self.instances, self.seed)
    }

    fn write(&self, text: &str) -> Result<(), Failure> {
        output::write(&self.output, text.as_bytes())?;
        output::print(text)
    }
}

/// Proves by interval arithmetic that all roots that the solvers report exist and are distinct.
pub(super) fn proofs(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = format!(
        "# Roots proved\n\n{}: every complex root of every instance put to the test of Krawczyk in interval arithmetic, in another chart \
         where it fails in the first.\n\n\
         | configuration | instances | roots | proved to exist | pairs not proved different | proved real | counted as real |\n\
         |---|---|---|---|---|---|---|\n",
        arguments.command("proofs")
    );
    let mut notes = String::new();
    for &(receivers, transmitters) in &arguments.configuration {
        let trials = arguments.each((receivers, transmitters), proof_trial)?;
        let sum = |f: fn(&RootProofs) -> usize| trials.iter().map(|(proofs, _)| f(proofs)).sum::<usize>();
        let _ = writeln!(
            text,
            "| {receivers}r/{transmitters}s | {} | {} | {} | {} | {} | {} |",
            trials.len(),
            sum(|t| t.roots),
            sum(|t| t.proved),
            sum(|t| t.unseparated),
            sum(|t| t.real),
            trials.iter().map(|(_, real)| real).sum::<usize>(),
        );
        for (seed, (proofs, _)) in (arguments.seed..).zip(&trials).filter(|(_, (p, _))| p.proved < p.roots) {
            let _ = writeln!(
                notes,
                "* {receivers}r/{transmitters}s, seed {seed}: {} of {} not proved",
                proofs.roots - proofs.proved,
                proofs.roots
            );
        }
    }
    arguments.write(&format!("{text}\n{notes}"))
}

/// Measures what stopping early saves, and what it loses.
pub(super) fn hurry(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = format!(
        "# In a hurry\n\n{}: each instance in full and stopped at the first physical network that fits. \"networks\": real positions.\n\n\
         | configuration | option | time, of the full search | paths tracked | networks found | truth found |\n\
         |---|---|---|---|---|---|\n",
        arguments.command("hurry")
    );
    let mut options = MinimalOptions::default();
    options.first_under = Some(1e-9);
    for &size in &arguments.configuration {
        let trials = arguments.each(size, |solver, simulation| hurry_trial(solver, simulation, &options))?;
        let total = |f: fn(&HurryTrial) -> f64| trials.iter().map(f).sum::<f64>();
        let count = trials.len() as f64;
        let _ = writeln!(
            text,
            "| {}r/{}s | `first_under` 1e-9 m | {:.2} | {:.1} | {} of {} | {} of {} |",
            size.0,
            size.1,
            total(|t| t.seconds) / total(|t| t.seconds_full),
            total(|t| t.tracked as f64) / count,
            total(|t| t.networks as f64),
            total(|t| t.networks_full as f64),
            trials.iter().filter(|t| t.truth).count(),
            trials.iter().filter(|t| t.truth_full).count(),
        );
    }
    arguments.write(&text)
}

/// Measures how paths that fail are recovered.
pub(super) fn charts(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = format!(
        "# Paths that fail\n\n{}: each instance in one round at full steps and with four more rounds of shorter steps \
         (the default). In the latter, where up to four paths are left over, all are tracked again from turned starts, which counts as tracked again too. Complex roots come in pairs: an odd number of real ones would tell of paths that have jumped unseen.\n\n\
         | configuration | rounds | instances | paths | lost | in instances | tracked again | odd | Jacobians a path | milliseconds \
         a solve |\n|---|---|---|---|---|---|---|---|---|---|\n",
        arguments.command("charts")
    );
    for &size in &arguments.configuration {
        for retries in [0, 4] {
            let trials = arguments.each(size, |solver, simulation| chart_trial(solver, simulation, retries))?;
            let sum = |f: fn(&ChartTrial) -> usize| trials.iter().map(f).sum::<usize>();
            let paths = sum(|t| t.paths.tracked);
            let seconds: f64 = trials.iter().map(|t| t.seconds).sum();
            let _ = writeln!(
                text,
                "| {}r/{}s | {} | {} | {paths} | {} | {} | {} | {} | {:.1} | {:.1} |",
                size.0,
                size.1,
                retries + 1,
                trials.len(),
                sum(|t| t.paths.failed),
                sum(|t| usize::from(t.paths.failed > 0)),
                sum(|t| t.paths.retracked),
                sum(|t| usize::from(t.odd)),
                sum(|t| t.jacobians) as f64 / paths.max(1) as f64,
                1e3 * seconds / trials.len().max(1) as f64,
            );
        }
    }
    arguments.write(&text)
}
