//! `tdoa solve` beside PHCpack on the smallest networks.

use super::program::{Pairs, Plan, Run, Tools, run, typical};
use super::solving::{phc, regular_solutions};
use crate::workspace;
use anyhow::{Context, Result, ensure};
use hc::poly::{self, Exact, ExpandLimits};
use num_traits::ToPrimitive;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Receivers and transmitters of the smallest networks.
const SIZES: [(usize, usize); 3] = [(6, 3), (5, 4), (4, 5)];

/// The table of networks.
pub(super) fn beside_phcpack(tools: &Tools, plan: &Plan, text: &mut String) -> Result<()> {
    *text += "\n## Smallest networks: `tdoa solve` beside `phc -b`\n\n\
        Both get the same random instance (standard normal positions and offsets, no noise), one thread each. PHCpack gets the \
        polynomials of this project's formulation, expanded.\n\n\
        | network | instance | tdoa found | lost | s | MB | phc found | s | MB | ratio |\n|---|---|---|---|---|---|---|---|---|---|\n";
    for (receivers, transmitters) in SIZES {
        for seed in 0..plan.instances {
            let name = format!("{receivers}r/{transmitters}s");
            eprintln!("{name}, instance {seed}, beside phc");
            let folder = tempfile::tempdir()?;
            let matrix = instance(tools, receivers, transmitters, seed, folder.path())?;
            let system = folder.path().join("system");
            std::fs::write(&system, member(receivers, transmitters, &matrix)?)?;
            let ours = || run(&tools.tdoa, &["solve", "--threads", "1", "--json", "-"], &[&matrix], "", 3600);
            let pairs = Pairs::measure(plan.repeats.min(2), ours, || phc(tools, &system, plan))?;
            let ours = typical(&pairs.ours).context("a run")?;
            let json: serde_json::Value = serde_json::from_str(&ours.output).context("JSON of tdoa solve")?;
            let paths = &json["paths"];
            write!(text, "| {name} | {seed} | {} | {} | {} |", paths["finite"], paths["failed"], ours.cells())?;
            match typical(&pairs.theirs) {
                None => *text += " not installed | | | |\n",
                Some(theirs) => {
                    let regular = regular_solutions(&theirs.output).map_or("none".to_owned(), |n| n.to_string());
                    let over = if theirs.stopped { "over " } else { "" };
                    let ratio = pairs.ratio(Run::work).unwrap_or(f64::NAN);
                    writeln!(text, " {regular} | {} | {over}{ratio:.0} |", theirs.cells())?;
                }
            }
        }
    }
    Ok(())
}

/// A simulated network's measurements.
fn instance(
    tools: &Tools,
    receivers: usize,
    transmitters: usize,
    seed: u64,
    folder: &Path,
) -> Result<std::path::PathBuf> {
    let directory = folder.join("network");
    let simulate = Command::new(&tools.tdoa)
        .args(["simulate", "--receivers", &receivers.to_string(), "--transmitters", &transmitters.to_string()])
        .args(["--layout", "normal", "--noise", "0", "--seed", &seed.to_string(), "--output"])
        .arg(&directory)
        .output()?;
    ensure!(simulate.status.success(), "{}", String::from_utf8_lossy(&simulate.stderr));
    Ok(directory.join("pseudoranges.csv"))
}

/// The family's polynomials with the measurements put in for the parameters, in PHCpack's format.
fn member(receivers: usize, transmitters: usize, matrix: &Path) -> Result<String> {
    let file = format!("crates/tdoa/families/{receivers}r{transmitters}s.toml");
    let family = poly::parse::family(&workspace::read(&workspace::root().join(file))?)?;
    let rows: Vec<Vec<f64>> = std::fs::read_to_string(matrix)?
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').skip(1).map(|v| v.trim().parse().ok()).collect())
        .collect();
    ensure!(rows.len() == receivers && rows.iter().all(|r| r.len() == transmitters), "a whole matrix was expected");
    // All three families have the measurements less those of the first receiver for parameters, row
    // by row.
    let parameters: Vec<f64> = (1..receivers)
        .flat_map(|i| (0..transmitters).map(move |j| (i, j)))
        .map(|(i, j)| rows[i][j] - rows[0][j])
        .collect();
    let system = family.system.at(&parameters)?;
    let mut text = format!("{}\n", system.len());
    for polynomial in system.expand(&ExpandLimits::default())? {
        for (k, (monomial, coefficient)) in polynomial.terms().iter().enumerate() {
            let factors: String = (system.variables().iter().zip(monomial.exponents()))
                .filter(|(_, e)| **e > 0)
                .map(|(name, e)| format!("*{name}^{e}"))
                .collect();
            write!(text, "{}{:+.17e}{factors}", if k > 0 { " " } else { "" }, real(coefficient))?;
        }
        text += ";\n";
    }
    Ok(text)
}

fn real(coefficient: &Exact) -> f64 {
    coefficient.re.to_f64().unwrap_or(f64::NAN)
}
