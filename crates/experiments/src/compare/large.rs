//! Large systems: all solutions with all threads, beside figures that others have published.

use super::curves::{tangent_conics, tritangents};
use super::generators::{cyclic, katsura};
use super::program::{Plan, Run, Tools, run, run_to};
use crate::workspace;
use anyhow::{Context, Result};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Targets of a family, whose solutions are tracked from one fibre.
const TARGETS: usize = 10;
/// Processor seconds after which a run is stopped.
const LIMIT: u32 = 36_000;

/// A system, or a family.
struct Problem {
    name: &'static str,
    text: String,
    /// The number of isolated solutions.
    count: usize,
    /// Where that number comes from.
    source: &'static str,
    published: &'static str,
}

fn problems(plan: &Plan) -> Vec<Problem> {
    let all = vec![
        Problem {
            name: "katsura-14",
            text: katsura(14),
            count: 16_384,
            source: "product of the degrees, all regular",
            published: "none found",
        },
        Problem {
            name: "tritangents of a sextic",
            text: tritangents(),
            count: 720,
            source: "120 tritangents, the points of contact in any order",
            published: "HomotopyContinuation.jl 2: 102 s for 110,592 paths (total degree), 720 solutions, 91 paths lost, \
                        on a laptop (juliahomotopycontinuation.org/examples/tritangents)",
        },
        Problem {
            name: "cyclic-11",
            text: cyclic(11),
            count: 184_756,
            source: "20 over 10 (Haagerup 2008)",
            published: "none found",
        },
    ];
    all.into_iter().filter(|p| !plan.quick || p.name == "katsura-14").collect()
}

/// What a run took.
fn cells(run: &Run) -> String {
    format!("{:.1} | {:.1}", run.seconds, run.work())
}

/// Solutions, paths and lost paths.
fn found(json: &Value) -> Result<[u64; 3]> {
    let paths = |what: &str| json["paths"][what].as_u64().with_context(|| format!("{what} paths"));
    Ok([json["solutions"].as_array().map_or(0, Vec::len) as u64, paths("tracked")?, paths("failed")?])
}

/// The table.
pub(super) fn table(tools: &Tools, plan: &Plan, text: &mut String) -> Result<()> {
    *text += "\n## Large systems\n\n\
        `hc solve`, or for families `hc monodromy`, which fills a fibre, and `hc track` from it; on all threads, once. Wall-clock and processor \
        seconds are those of the whole process. Others' figures are as they were published, on their machines.\n\n\
        | system | solutions | why | paths | found | lost | s | processor s | published by others |\n|---|---|---|---|---|---|---|---|---|\n";
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    for Problem { name, text: system, count, source, published } in problems(plan) {
        eprintln!("{name}");
        let file = folder.join("system");
        std::fs::write(&file, system)?;
        // With status 1 paths are lost, which the table says.
        let ours = run_to(&[0, 1], &tools.hc, &["solve", "--json", "-"], &[&file], "", LIMIT)?;
        let [solutions, paths, lost] = found(&serde_json::from_str(&ours.output).context("JSON of hc solve")?)?;
        writeln!(
            text,
            "| {name} | {count} | {source} | {paths} | {solutions} | {lost} | {} | {published} |",
            cells(&ours)
        )?;
    }
    let chicago = workspace::read(&workspace::root().join("examples/families/chicago.toml"))?;
    for family in [
        Problem {
            name: "conics that touch five conics",
            text: tangent_conics(),
            count: 3264,
            source: "Chasles 1864",
            published: "HomotopyContinuation.jl 2: 19 s for 27,072 paths (polyhedral), machine not named (pull request 372 of its repository)",
        },
        Problem {
            name: "Chicago: three views of points and lines",
            text: chicago,
            count: 312,
            source: "Fabbri et al. 2020",
            published: "for a target 235 ms on eight cores, 54 ms on a GPU that is not named \
                        (github.com/C-H-Chien/Homotopy-Continuation-Tracker-on-GPU; in 30 unknowns)",
        },
    ] {
        eprintln!("{}", family.name);
        of_family(tools, folder, &family, text)?;
    }
    Ok(())
}

/// The rows of a family: its fibre by monodromy, and the paths from there to random targets.
fn of_family(tools: &Tools, folder: &Path, family: &Problem, text: &mut String) -> Result<()> {
    let Problem { name, count, source, published, .. } = family;
    let [file, start, target] = ["family.toml", "start.json", "target.json"].map(|name| folder.join(name));
    std::fs::write(&file, &family.text)?;
    let [from, to] = [&start, &target].map(|path| path.to_string_lossy().into_owned());
    let filled = run(&tools.hc, &["monodromy", "--output", &from], &[&file], "", LIMIT)?;
    let fibre: Value = serde_json::from_str(&workspace::read(&start)?)?;
    let [parameters, solutions] = ["parameters", "solutions"].map(|list| fibre[list].as_array().map_or(0, Vec::len));
    writeln!(text, "| {name}: fibre | {count} | {source} | | {solutions} | | {} | {published} |", cells(&filled))?;
    let normals = |k: usize| hc::random::Random::new(k as u64, 149).normals(parameters);
    let point = |k: usize| normals(k).iter().map(|z| [z.re, z.im]).collect::<Vec<_>>();
    let all: Vec<Value> = (0..TARGETS).map(|k| json!({ "parameters": point(k) })).collect();
    std::fs::write(&target, serde_json::to_string(&all)?)?;
    let tracked = run(&tools.hc, &["track", "--start", &from, "--target", &to, "--json", "-"], &[&file], "", LIMIT)?;
    let results: Vec<Value> = serde_json::from_str(&tracked.output).context("JSON of hc track")?;
    let mut sums = [0; 3];
    for result in &results {
        sums.iter_mut().zip(found(result)?).for_each(|(sum, number)| *sum += number);
    }
    let [solutions, paths, lost] = sums;
    let count = count * TARGETS;
    writeln!(
        text,
        "| {name}: {TARGETS} targets | {count} | | {paths} | {solutions} | {lost} | {} | |",
        cells(&tracked)
    )?;
    Ok(())
}
