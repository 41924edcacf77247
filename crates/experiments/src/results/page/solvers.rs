//! The parts of the page on the exact solvers.

use super::super::table::{Row, Table, head, line, summary};
use anyhow::{Context, Result};
use std::path::Path;

pub(super) fn table2(results: &Path) -> Result<String> {
    let table = summary(results, "table2")?;
    let row =
        |kind: &str| table.rows().find(|row| row.is(&[("count", kind)])).with_context(|| format!("table2: no {kind}"));
    let (all, real, physical) = (row("real")?, row("positive_definite")?, row("physical")?);
    let ours = |name: &str, row: Row<'_>| -> Result<String> {
        let error = row.number("standard_deviation")? / row.number("instances")?.sqrt();
        let mut cells = vec![name.to_owned()];
        for column in ["min", "max"] {
            cells.push(row.get(column)?.to_owned());
        }
        cells.push(format!("{} ± {error:.2}", row.get("mean")?));
        cells.push(row.get("standard_deviation")?.to_owned());
        Ok(line(&cells))
    };
    let mut text = format!(
        "{} random networks, with standard normal positions and offsets, without noise. The mean is given with its standard error.\n\n",
        real.get("instances")?
    );
    text += &head(&["", "min", "max", "mean", "standard deviation"]);
    text += &ours("real with H > 0", real)?;
    text += "| the paper: real solutions | 2 | 55 | 8.7 | 7.6 |\n| 260 instances, computed independently | 2 | 48 | 8.40 | 7.36 |\n";
    text += &ours("physical: all f - o >= 0", physical)?;
    text += "| the paper: feasible solutions | 1 | 32 | 3 | 3.9 |\n| 260 instances, computed independently | 1 | 35 | 3.44 | 4.85 |\n";
    text += &ours("real, H of any sign", all)?;
    text += "\n![Histogram of the numbers of solutions](../results/table2/counts.svg)\n\n";
    text += "The largest count grows with the number of instances, because the tail is long; it is not a bound. The means of the few hundred instances elsewhere have \
             standard errors of about 0.5 (real) and 0.3 (physical).\n\n\
             The paper calls solutions feasible if their residual in the squared equations is below 1e-10, and calls the others false roots. But every real \
             solution with H > 0 solves the squared equations exactly; the residual only tells how accurately it was computed. A false root really has \
             a wrong sign: some f_ij - o_j is negative, although it must be a distance. Here the sign decides, so that these counts do not depend on a \
             threshold for rounding errors. The paper has another slip: with L upper triangular the frame of the paper's parametrisation has (s_2 - s_1)_y = 0, not r_2y = 0 as its text says; counts \
             and distances do not depend on it.\n\n";
    text += &format!(
        "Real networks come in pairs along any path of real data, so that their number is even. An odd number reveals a lost or doubled path, or a \
         real root that was called complex. Odd counts: {} of {}; instances \
         with a lost path: {}.\n",
        real.get("odd")?,
        real.get("instances")?,
        real.get("with_lost_paths")?
    );
    Ok(text)
}

pub(super) fn clean(results: &Path) -> Result<String> {
    let tables =
        ["clean-6r3s", "clean", "clean-larger", "clean-others"].map(|name| (name, summary(results, name).ok()));
    let mut text = String::from(
        "Relative errors |X^ - X| / |X - mean X| over all nodes after the best rigid alignment, and |o^ - o| / |o|, of the physical candidate nearest to the truth. \
         \"Found\" means within 1e-4. The paper gives errors \"in the order of magnitude 1e-12\" and about 10 s per solve. It has no figures for \
         6r/3s, and leaves 4r/5s and 4r/6s unsolved.\n\n",
    );
    text += &clean_rows(tables.iter().filter_map(|(_, table)| table.as_ref()))?;
    text += "\nThe errors are smaller than the paper's because every candidate is polished after its path has ended. This is done in the positions \
             themselves, in which the problem is far better conditioned than in H. The remaining error is due to the condition of the instance. \
             Milliseconds are processor time, on a machine with other work on the same cores. The one root of 7r/4s and the five of 5r/6s, from ranks, \
             need not be real in pairs. Where paths were lost, the result says so.\n\n";
    for (folder, table) in &tables {
        text += &figures(table.iter().flat_map(Table::rows), folder)?;
    }
    Ok(text)
}

fn figures<'a>(rows: impl Iterator<Item = Row<'a>>, folder: &str) -> Result<String> {
    let mut text = String::new();
    let mut seen = Vec::new();
    for row in rows {
        let size = row.get("configuration")?;
        if !seen.contains(&size) {
            seen.push(size);
            text += &format!("![{size}](../results/{folder}/{}.svg)\n", size.replace('/', ""));
        }
    }
    Ok(text)
}

pub(super) fn speed(results: &Path) -> Result<String> {
    let table = summary(results, "speed")?;
    let mut text = String::from(
        "Clean random networks with all paths tracked; wall-clock time on an otherwise idle machine. Each Jacobian includes its factorisation. [How \
         the tracker works](guide/tracker.md) says where the time goes, and what stands in the way of more speed. [compare.md](compare.md) has PHCpack \
         on the same networks.\n\n",
    );
    text += &head(&[
        "",
        "networks",
        "ms a solve: median",
        "99 %",
        "µs a path",
        "steps a path",
        "rejected",
        "Jacobians a path",
        "solves a second, one thread",
        "on all (threads)",
    ]);
    for row in table.rows() {
        let columns = [
            "configuration",
            "instances",
            "milliseconds_median",
            "milliseconds_99",
            "microseconds_a_path",
            "steps_a_path",
            "rejected_a_path",
            "jacobians_a_path",
            "solves_a_second",
        ];
        let mut cells = columns.iter().map(|column| Ok(row.get(column)?.to_owned())).collect::<Result<Vec<_>>>()?;
        cells.push(format!("{} ({})", row.get("solves_a_second_on_all")?, row.get("threads")?));
        text += &line(&cells);
    }
    Ok(text)
}

pub(super) fn routes(results: &Path) -> Result<String> {
    let table = summary(results, "routes")?;
    let mut text = String::from(
        "All real networks of clean data were found twice: from the stored start solutions, and from a polyhedral start system as in the paper (`tdoa \
         solve --start polyhedral`), which is computed anew for each network. \"Agree\" counts those with the same networks, no more and no fewer. \
         \"At the data\" counts those for which the start system for the data themselves led to all roots. For the others, a start system for a random \
         member of the family, another one each time, led to all of its roots, and these led to the data. Seconds are processor \
         seconds of one thread for both routes. 7r/4s is solved linearly, without paths.\n\n",
    );
    text +=
        &head(&["", "networks", "agree", "roots, stored", "roots, polyhedral", "at the data", "s, mean", "s, largest"]);
    for row in table.rows() {
        let columns = [
            "configuration",
            "instances",
            "agree",
            "roots_stored",
            "roots_polyhedral",
            "at_data",
            "seconds_mean",
            "seconds_max",
        ];
        let cells = columns.iter().map(|column| Ok(row.get(column)?.to_owned())).collect::<Result<Vec<_>>>()?;
        text += &line(&cells);
    }
    Ok(text)
}

pub(super) fn noise(results: &Path) -> Result<String> {
    let table = summary(results, "noise")?;
    let mut text = String::from(
        "Every measurement has normal noise, in units of the standard deviation of the positions. Where there are more measurements than unknowns, the \
         candidate with the smallest residual is judged, as in the paper. For the minimal 6r/3s and 4r/5s every candidate fits exactly, and the one \
         nearest to the truth is judged. \"Refined\" is least squares over all measurements from the candidate. The table has relative position \
         errors; offsets are in \
         [results/noise/summary.csv](../results/noise/summary.csv). The paper's own figures are not in its source, so that these cannot be compared \
             with them.\n\n",
    );
    text += &head(&["", "noise", "instances", "median", "90 %", "refined: median", "90 %", "no candidate"]);
    for row in table.rows() {
        let columns = [
            "configuration",
            "noise",
            "instances",
            "position_raw_median",
            "position_raw_90",
            "position_refined_median",
            "position_refined_90",
            "without_candidate",
        ];
        let cells = columns.iter().map(|column| Ok(row.get(column)?.to_owned())).collect::<Result<Vec<_>>>()?;
        text += &line(&cells);
    }
    text += "\nRefinement does not move a candidate that fits exactly as many measurements as there are unknowns (6r/3s, 4r/5s). In the other sizes \
             refinement uses the measurements that the solver left over. The 90 % columns show near-degenerate networks, where a little noise moves \
             the nodes far. The more noise there is, the more often small networks also prefer a wrong candidate.\n\n";
    text += &figures(table.rows(), "noise")?;
    Ok(text)
}

/// Clean networks in space.
pub(super) fn clean_space(results: &Path) -> Result<String> {
    let tables = ["clean-space", "clean-space-eight", "clean-space-others"].map(|name| summary(results, name).ok());
    let mut text = String::from(
        "As above, in space. 10r/4s, 7r/5s and 6r/6s are the smallest sizes and have several networks each; of the others the true one is the only \
         one. 9r/5s, 10r/5s, 7r/6s, 8r/6s and 6r/8s take no paths.\n\n",
    );
    text += &clean_rows(tables.iter().flatten())?;
    Ok(text)
}

/// The rows of tables of clean networks.
fn clean_rows<'a>(tables: impl Iterator<Item = &'a Table>) -> Result<String> {
    let mut text = head(&[
        "",
        "instances",
        "found",
        "positions: median",
        "90 %",
        "99 %",
        "offsets: median",
        "90 %",
        "99 %",
        "paths lost",
        "tracked again",
        "odd numbers of real networks",
        "ms a solve (one thread)",
    ]);
    for row in tables.flat_map(Table::rows) {
        let mut cells = Vec::new();
        for column in ["configuration", "instances", "found"] {
            cells.push(row.get(column)?.to_owned());
        }
        for column in ["position_median", "position_90", "position_99", "offset_median", "offset_90", "offset_99"] {
            cells.push(row.get(column)?.to_owned());
        }
        cells.push(format!("{} of {}", row.get("paths_lost")?, row.get("paths")?));
        cells.push(row.get("retracked")?.to_owned());
        // Only sizes without a measurement to spare have networks in pairs.
        let size = row.get("configuration")?;
        let paired =
            !matches!(size, "7r/4s" | "5r/6s" | "8r/5s" | "6r/7s" | "11r/4s" | "12r/4s") && row.get("paths")? != "0";
        cells.push(if paired { row.get("odd")?.to_owned() } else { "-".to_owned() });
        let milliseconds = row.get("milliseconds_median")?;
        cells.push(if milliseconds == "0" { "below 0.01" } else { milliseconds }.to_owned());
        text += &line(&cells);
    }
    Ok(text)
}
