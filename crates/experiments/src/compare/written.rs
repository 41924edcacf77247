//! Formulas that multiply many sums beside the same with unknowns for these sums, written by hand.

use super::program::Plan;
use crate::counts::structure;
use crate::quantile::median;
use crate::workspace;
use anyhow::{Context, Result};
use hc::poly::System;
use hc::{Run, SolveOptions};
use std::fmt::Write;
use std::time::Instant;

/// Seeds of each system: 0, 1, ...
const SEEDS: u64 = 5;

/// What all seeds gave.
#[derive(Default)]
struct Solved {
    /// Seeds from which the solutions are as many as expected, and no path is lost.
    right: usize,
    lost: usize,
    milliseconds: f64,
}

fn solved(system: &System, expected: &str) -> Result<Solved> {
    let mut all = Solved::default();
    for seed in 0..SEEDS {
        let started = Instant::now();
        let found = Run::new().threads(1)?.solve(system, &SolveOptions::new().seed(seed))?;
        all.milliseconds += started.elapsed().as_secs_f64() * 1e3 / SEEDS as f64;
        all.right += usize::from(structure(&found) == expected && found.paths.failed == 0);
        all.lost += found.paths.failed;
    }
    Ok(all)
}

/// The table of both forms.
pub(super) fn beside_rewritten(plan: &Plan, text: &mut String) -> Result<()> {
    write!(
        text,
        "\n## Formulas as they are written beside the same rewritten by hand\n\n\
         The systems of [examples/written](../examples/written/README.md), {SEEDS} seeds each, one thread, both forms in turns in one process; \
         milliseconds are those of a solve. \"right\": seeds with all solutions and multiplicities and without lost paths.\n\n\
         | system | solutions | right | lost | ms | rewritten: right | lost | ms | time beside it |\n|---|---|---|---|---|---|---|---|---|\n"
    )?;
    let folder = workspace::root().join("examples/written");
    let table = workspace::read(&folder.join("expected.csv"))?;
    let mut shares = Vec::new();
    for line in table.lines().skip(1) {
        let mut fields = line.split(',');
        let (name, expected) = fields.next().zip(fields.next()).context("a name and a structure")?;
        eprintln!("{name}");
        let read = |name: &str| -> Result<System> {
            let file = folder.join(format!("{name}.txt"));
            workspace::read(&file)?.parse().with_context(|| file.display().to_string())
        };
        let systems = [read(name)?, read(&format!("{name}-rewritten"))?];
        let mut times = [Vec::new(), Vec::new()];
        let mut last = [Solved::default(), Solved::default()];
        for _ in 0..plan.repeats {
            for (k, system) in systems.iter().enumerate() {
                last[k] = solved(system, expected)?;
                times[k].push(last[k].milliseconds);
            }
        }
        let [ours, theirs] = times.map(|times| median(&times));
        let [as_written, rewritten] = last;
        shares.push(ours / theirs);
        writeln!(
            text,
            "| {name} | {expected} | {} of {SEEDS} | {} | {ours:.2} | {} of {SEEDS} | {} | {theirs:.2} | {:.2} |",
            as_written.right,
            as_written.lost,
            rewritten.right,
            rewritten.lost,
            ours / theirs
        )?;
    }
    let most = shares.iter().copied().fold(0.0, f64::max);
    writeln!(text, "\nThe median of the shares is {:.2}, the largest {most:.2}.", median(&shares))?;
    Ok(())
}
