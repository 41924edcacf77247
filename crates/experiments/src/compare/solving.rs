//! `hc solve` beside PHCpack and Macaulay2.

use super::generators::{cyclic, eco, katsura, noon, reimer};
use super::program::{Pairs, Plan, Run, Tools, run, typical};
use crate::quantile::median;
use anyhow::{Context, Result};
use hc::poly::parse::phcpack;
use std::fmt::Write;
use std::path::Path;

/// A system and the number of its isolated solutions, all regular.
struct Problem {
    name: &'static str,
    text: String,
    count: usize,
}

fn problems(plan: &Plan) -> Result<Vec<Problem>> {
    let file = |name: &'static str, count: usize| -> Result<Problem> {
        let path = plan.systems.join(format!("{name}.phc"));
        let text = std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        // What follows the polynomials is for readers.
        let end = text.rfind(';').map_or(text.len(), |k| k + 1);
        Ok(Problem { name, text: text[..end].to_owned() + "\n", count })
    };
    let generated = |name, text, count| Problem { name, text, count };
    let all = vec![
        generated("cyclic-7", cyclic(7), 924),
        generated("katsura-8", katsura(8), 256),
        generated("katsura-10", katsura(10), 1024),
        generated("noon-5", noon(5), 233),
        generated("eco-10", eco(10), 256),
        generated("reimer-5", reimer(5), 144),
        file("sparse5", 160)?,
        file("assur44", 56)?,
        file("heart", 4)?,
        file("game6two", 265)?,
    ];
    let quick = ["noon-5", "eco-10", "heart"];
    Ok(all.into_iter().filter(|p| !plan.quick || quick.contains(&p.name)).collect())
}

/// What one run of `hc solve` found: solutions and lost paths.
fn found(ours: &Run) -> Result<(usize, u64)> {
    let json: serde_json::Value = serde_json::from_str(&ours.output).context("JSON of hc solve")?;
    let solutions = json["solutions"].as_array().map_or(0, Vec::len);
    Ok((solutions, json["paths"]["failed"].as_u64().context("failed paths")?))
}

/// No fewer than the processor seconds that solving alone took on the one thread.
fn solving_seconds(ours: &Run) -> Result<f64> {
    let json: serde_json::Value = serde_json::from_str(&ours.output).context("JSON of hc solve")?;
    Ok(ours.work().min(json["seconds"].as_f64().context("seconds")?))
}

fn solve(tools: &Tools, system: &Path) -> Result<Run> {
    run(&tools.hc, &["solve", "--threads", "1", "--json", "-"], &[system], "", 3600)
}

/// `phc -b`; its output goes to a file.
pub(super) fn phc(tools: &Tools, system: &Path, plan: &Plan) -> Result<Option<Run>> {
    if !tools.phc {
        return Ok(None);
    }
    let folder = tempfile::tempdir()?;
    // It appends the solutions to its input, too.
    let (input, output) = (folder.path().join("system"), folder.path().join("result"));
    std::fs::copy(system, &input)?;
    let mut measured = run(Path::new("phc"), &["-b"], &[&input, &output], "", plan.limit)?;
    measured.output = std::fs::read_to_string(&output).unwrap_or_default();
    Ok(Some(measured))
}

/// Number of regular solutions from the last summary that `phc -b` writes.
pub(super) fn regular_solutions(result: &str) -> Option<usize> {
    let line = result.lines().rev().find(|line| line.trim_start().starts_with("Number of regular solutions"))?;
    line.rsplit(':').next()?.trim().trim_end_matches('.').parse().ok()
}

/// The table beside PHCpack.
pub(super) fn beside_phcpack(tools: &Tools, plan: &Plan, text: &mut String) -> Result<()> {
    *text += "## All isolated solutions: `hc solve` beside `phc -b`\n\n\
        One thread each. \"found\" counts distinct isolated solutions, for PHCpack those that its last summary calls regular.\n\n\
        | system | solutions | hc found | lost | s | MB | phc found | s | MB | ratio |\n|---|---|---|---|---|---|---|---|---|---|\n";
    let (mut ratios, mut crashes) = (Vec::new(), Vec::new());
    for problem in problems(plan)? {
        eprintln!("{} beside phc", problem.name);
        let folder = tempfile::tempdir()?;
        let system = folder.path().join("system");
        std::fs::write(&system, &problem.text)?;
        let pairs = Pairs::measure(plan.repeats, || solve(tools, &system), || phc(tools, &system, plan))?;
        if pairs.crashes > 0 {
            crashes.push(format!("{} of {} on {}", pairs.crashes, pairs.crashes + pairs.theirs.len(), problem.name));
        }
        let ours = typical(&pairs.ours).context("a run")?;
        let (solutions, lost) = found(ours)?;
        write!(text, "| {} | {} | {solutions} | {lost} | {} |", problem.name, problem.count, ours.cells())?;
        match typical(&pairs.theirs) {
            None => *text += " not installed | | | |\n",
            Some(theirs) => {
                let regular = regular_solutions(&theirs.output).map_or("none".to_owned(), |n| n.to_string());
                let ratio = pairs.ratio(Run::work).unwrap_or(f64::NAN);
                ratios.push(ratio);
                let over = if theirs.stopped { "over " } else { "" };
                writeln!(text, " {regular} | {} | {over}{ratio:.1} |", theirs.cells())?;
            }
        }
    }
    if !ratios.is_empty() {
        let mean = (ratios.iter().map(|r| r.ln()).sum::<f64>() / ratios.len() as f64).exp();
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        writeln!(text, "\nGeometric mean of the ratios {mean:.1}, least {least:.1}.")?;
    }
    if !crashes.is_empty() {
        writeln!(text, "\nRuns of phc that ended with an error and were made again: {}.", crashes.join(", "))?;
    }
    Ok(())
}

/// The table beside Macaulay2.
pub(super) fn beside_macaulay2(tools: &Tools, plan: &Plan, text: &mut String) -> Result<()> {
    *text += "\n## `hc solve` beside Macaulay2's `solveSystem`\n\n\
        One thread each. Seconds are processor seconds of solving alone, without the start of the program and its output. For Macaulay2 \
        these are the seconds of `solveSystem` (package NumericalAlgebraicGeometry). For hc the smaller of two upper bounds is taken: the \
        wall-clock seconds that it reports for solving, and the processor seconds of the whole process.\n\n\
        | system | solutions | hc found | lost | s | MB | M2 found | s | MB | ratio |\n|---|---|---|---|---|---|---|---|---|---|\n";
    for problem in problems_beside_macaulay2(plan)? {
        eprintln!("{} beside M2", problem.name);
        let folder = tempfile::tempdir()?;
        let (system, script) = (folder.path().join("system"), folder.path().join("script.m2"));
        std::fs::write(&system, &problem.text)?;
        std::fs::write(&script, macaulay2_script(&problem.text)?)?;
        let theirs = || -> Result<Option<Run>> {
            if !tools.macaulay2 {
                return Ok(None);
            }
            let mut measured = run(Path::new("M2"), &["--script"], &[&script], "", plan.limit)?;
            if let Some(seconds) = said(&measured.output, "seconds") {
                measured.seconds = seconds;
            }
            Ok(Some(measured))
        };
        let ours = || -> Result<Run> {
            let mut measured = solve(tools, &system)?;
            measured.processor = Some(solving_seconds(&measured)?);
            Ok(measured)
        };
        let pairs = Pairs::measure(plan.repeats, ours, theirs)?;
        let ours = typical(&pairs.ours).context("a run")?;
        let (solutions, lost) = found(ours)?;
        let cells = ours.cells();
        write!(text, "| {} | {} | {solutions} | {lost} | {cells} |", problem.name, problem.count)?;
        match pairs.theirs.first() {
            None => *text += " not installed | | | |\n",
            Some(theirs) => {
                let regular = said(&theirs.output, "solutions").map_or("none".to_owned(), |n| format!("{n:.0}"));
                // Macaulay2 counts processor seconds of its own thread.
                let ratios: Vec<f64> =
                    pairs.ours.iter().zip(&pairs.theirs).map(|(a, b)| b.seconds / a.work()).collect();
                let ratio = median(&ratios);
                let over = if theirs.stopped { "over " } else { "" };
                let seconds = median(&pairs.theirs.iter().map(|run| run.seconds).collect::<Vec<f64>>());
                let memory = theirs.megabytes.map_or_else(String::new, |m| format!("{m:.0}"));
                writeln!(text, " {regular} | {over}{seconds:.3} | {memory} | {over}{ratio:.1} |")?;
            }
        }
    }
    Ok(())
}

fn problems_beside_macaulay2(plan: &Plan) -> Result<Vec<Problem>> {
    let names: &[&str] = if plan.quick { &["noon-5"] } else { &["katsura-10", "noon-5"] };
    Ok(problems(plan)?.into_iter().filter(|p| names.contains(&p.name)).collect())
}

/// The number that a script has printed behind a word.
fn said(output: &str, word: &str) -> Option<f64> {
    let mut words = output.split_whitespace();
    words.find(|&w| w == word)?;
    words.next()?.parse().ok()
}

fn macaulay2_script(system: &str) -> Result<String> {
    let unknowns = phcpack(system)?.variables().join(",");
    let equations: Vec<&str> = system
        .split_once('\n')
        .map_or("", |(_, rest)| rest)
        .split(';')
        .map(str::trim)
        .filter(|e| !e.is_empty())
        .collect();
    Ok(format!(
        "needsPackage \"NumericalAlgebraicGeometry\";\nR = CC[{unknowns}];\nF = {{{}}};\n\
         t = cpuTime();\ns = solveSystem F;\nprint(\"seconds \" | toString(cpuTime() - t));\n\
         print(\"solutions \" | toString(#s));\n",
        equations.join(",\n")
    ))
}

/// `hc solve` from the start of the process to its end.
pub(super) fn small(tools: &Tools, plan: &Plan, text: &mut String) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let system = folder.path().join("system");
    std::fs::write(&system, cyclic(5))?;
    let count = if plan.quick { 5 } else { 50 };
    let mut milliseconds = Vec::new();
    for _ in 0..count {
        let started = std::time::Instant::now();
        let output = std::process::Command::new(&tools.hc).args(["solve", "--threads", "1"]).arg(&system).output()?;
        milliseconds.push(1e3 * started.elapsed().as_secs_f64());
        anyhow::ensure!(output.status.success(), "hc solve fails on cyclic-5");
    }
    let least = milliseconds.iter().copied().fold(f64::INFINITY, f64::min);
    let most = milliseconds.iter().copied().fold(0.0, f64::max);
    writeln!(
        text,
        "\n`hc solve` on cyclic-5 (70 solutions), wall-clock time from the start of the process to its end: median {:.1} ms, least {least:.1} ms, \
         most {most:.1} ms of {count} runs.",
        median(&milliseconds)
    )?;
    Ok(())
}
