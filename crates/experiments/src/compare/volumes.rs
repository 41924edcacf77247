//! `hc mixed-volume` beside gfan.

use super::generators::{cyclic, eco, gaukwa, katsura, noon};
use super::program::{Pairs, Plan, Run, Tools, run, typical};
use anyhow::{Context, Result};
use hc::poly::{Polynomial, parse::phcpack};
use std::fmt::Write;
use std::path::Path;

fn problems(plan: &Plan) -> Vec<(&'static str, String)> {
    if plan.quick {
        return vec![("cyclic-9", cyclic(9)), ("noon-8", noon(8))];
    }
    vec![
        ("cyclic-10", cyclic(10)),
        ("cyclic-11", cyclic(11)),
        ("cyclic-12", cyclic(12)),
        ("katsura-14", katsura(14)),
        ("eco-18", eco(18)),
        ("noon-10", noon(10)),
        ("gaukwa-6", gaukwa(6)),
    ]
}

/// The supports in the notation of gfan.
fn supports(system: &str) -> Result<String> {
    let polynomials = phcpack(system)?.expand(&Default::default())?;
    let point = |p: &Vec<i32>| format!("({})", p.iter().map(i32::to_string).collect::<Vec<_>>().join(","));
    let support = |p: &Polynomial<_>| format!("({})", p.support().iter().map(point).collect::<Vec<_>>().join(","));
    Ok(format!("{{{}}}\n", polynomials.iter().map(support).collect::<Vec<_>>().join(",\n")))
}

/// The table beside gfan.
pub(super) fn beside_gfan(tools: &Tools, plan: &Plan, text: &mut String) -> Result<()> {
    *text += "\n## Mixed volumes: `hc mixed-volume` beside `gfan _mixedvolume`\n\n\
        Both get the same supports. Processor seconds are compared with one thread, wall-clock seconds with two.\n\n\
        | system | threads | hc | s | MB | gfan | s | MB | ratio |\n|---|---|---|---|---|---|---|---|---|\n";
    for (name, system) in problems(plan) {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("system");
        std::fs::write(&file, &system)?;
        let vectors = supports(&system)?;
        for threads in ["1", "2"] {
            eprintln!("{name} beside gfan, {threads} threads");
            let ours = || run(&tools.hc, &["mixed-volume", "--threads", threads, "--json", "-"], &[&file], "", 3600);
            let theirs = || -> Result<Option<Run>> {
                if !tools.gfan {
                    return Ok(None);
                }
                let arguments = ["_mixedvolume", "--vectorinput", "-j", threads];
                run(Path::new("gfan"), &arguments, &[], &vectors, plan.limit).map(Some)
            };
            let pairs = Pairs::measure(plan.repeats, ours, theirs)?;
            let quantity = |run: &Run| if threads == "1" { run.work() } else { run.seconds };
            let cells = |run: &Run| {
                let memory = run.megabytes.map_or_else(String::new, |m| format!("{m:.0}"));
                format!("{}{:.2} | {memory}", if run.stopped { "over " } else { "" }, quantity(run))
            };
            let ours = typical(&pairs.ours).context("a run")?;
            let json: serde_json::Value = serde_json::from_str(&ours.output).context("JSON of hc mixed-volume")?;
            write!(text, "| {name} | {threads} | {} | {} |", json["mixed_volume"], cells(ours))?;
            match typical(&pairs.theirs) {
                None => *text += " not installed | | | |\n",
                Some(theirs) => writeln!(
                    text,
                    " {} | {} | {:.2} |",
                    theirs.output.trim(),
                    cells(theirs),
                    pairs.ratio(quantity).unwrap_or(f64::NAN)
                )?,
            }
        }
    }
    if !plan.quick {
        larger(tools, text)?;
    }
    Ok(())
}

/// What would take gfan long, once and on both threads.
fn larger(tools: &Tools, text: &mut String) -> Result<()> {
    for (name, system) in [("cyclic-13", cyclic(13)), ("cyclic-14", cyclic(14))] {
        eprintln!("{name}");
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("system");
        std::fs::write(&file, &system)?;
        let ours = run(&tools.hc, &["mixed-volume", "--threads", "2", "--json", "-"], &[&file], "", 3600)?;
        let json: serde_json::Value = serde_json::from_str(&ours.output).context("JSON of hc mixed-volume")?;
        writeln!(
            text,
            "\n{name}, hc alone on two threads: mixed volume {}, {} mixed cells, {:.0} s, {:.0} processor seconds.",
            json["mixed_volume"],
            json["cells"],
            ours.seconds,
            ours.work()
        )?;
    }
    Ok(())
}
