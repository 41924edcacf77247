//! `hc sweep`.

mod canvas;
mod curve;
mod given;
mod map;
mod report;
mod swept;
mod table;

use crate::{family, input, watch};
use cli::files::Files;
use cli::{Failure, output};
use given::{Fixed, GivenAxis};
use hc::poly::counted;
use hc::sweep::{BreakKind, Grid, Standing, Sweep, SweepError, SweepOptions};
use hc::{Family, FamilyError, Run};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;
use swept::Swept;

/// Cells in doubt, and numbers of solutions, that a summary lists.
const LISTED: usize = 10;

/// Counts the real solutions of a family in every cell of a grid of parameters, and joins them to branches.
///
/// The whole fibre is tracked to every cell, so that no branch is lost from cell to cell. Exit status 1 if the number of
/// real solutions of a cell is not shown, or it is not shown why a branch ends.
///
/// Interrupted, it gives the cells done so far, with exit status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family: plain text with a line `parameters: a b`, or TOML; - for standard input.
    family: PathBuf,
    /// Its fibre, as `hc monodromy` writes it.
    start: PathBuf,
    /// Values of a parameter: the first, the last and how many. One grid gives curves, two give a map.
    #[arg(long, required = true, value_name = "NAME=FROM:TO:COUNT")]
    grid: Vec<GivenAxis>,
    /// The value of another parameter; each that is not on the grid needs one.
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Fixed>,
    /// Certify the solutions of every cell, not only of those in which pairs of conjugates leave a doubt.
    #[arg(long)]
    certify: bool,
    /// The unknown whose branches a picture of one grid shows; the first one if not given.
    #[arg(long, value_name = "NAME")]
    unknown: Option<String>,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Accepted everywhere; a sweep draws no random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// File for all that is found (JSON); - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
    /// File for a table (CSV) with a line for each cell: its values, how many solutions are real, positive, complex, and
    /// how sure that is.
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// File for a table (CSV) with a line for each real solution of each cell: its branch and coordinates.
    #[arg(long, value_name = "FILE")]
    branches: Option<PathBuf>,
    /// File for a picture (SVG): branches over one parameter, or numbers of real solutions over two, with the folds.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

/// Sweeps, writes files and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files = Files::new().reads(Some(&arguments.family)).reads(Some(&arguments.start));
    let files = files.writes("--json", arguments.json.as_deref()).writes("--table", arguments.table.as_deref());
    let files = files.writes("--branches", arguments.branches.as_deref()).writes("--svg", arguments.svg.as_deref());
    input::check(&files, None)?;
    let begun = Instant::now();
    let family = family::read(&arguments.family)?;
    let axes = arguments.grid.iter().map(|given| given.0.clone()).collect();
    let fixed: Vec<(&str, f64)> = arguments.set.iter().map(|set| (set.name.as_str(), set.value)).collect();
    let grid = Grid::new(&family, axes, &fixed).map_err(Failure::unusable)?;
    let unknown = unknown(&family, arguments.unknown.as_deref())?;
    let (fibre, multiple) = family::fibre(&family, &arguments.start)?;
    let monitor = watch::interruptible()?;
    let run = Run::new().watched(&monitor);
    let options = SweepOptions::new().certify(arguments.certify);
    let work = || run.sweep(&family, &fibre, &grid, &options);
    let sweep = watch::watched(arguments.threads, &monitor, watch::stages, work)?.map_err(|error| match error {
        SweepError::Family(error @ FamilyError::Misses { .. }) => Failure::in_file(&arguments.start, error),
        SweepError::Family(error) => family::failure(&arguments.family, error),
        SweepError::NotReal => Failure::in_file(&arguments.family, error),
        error => Failure::unusable(error),
    })?;
    let seconds = begun.elapsed().as_secs_f64();
    let untracked: Vec<usize> = multiple.iter().map(|m| m.multiplicity).collect();
    let swept = Swept { family: &family, grid: &grid, sweep: &sweep, untracked: &untracked };
    if let Some(path) = &arguments.json {
        output::json(path, &report::Report::new(&swept, arguments.seed, seconds))?;
    }
    if let Some(path) = &arguments.table {
        output::text(path, &table::cells(&swept))?;
    }
    if let Some(path) = &arguments.branches {
        output::text(path, &table::branches(&swept))?;
    }
    if let Some(path) = &arguments.svg {
        let picture = if grid.axes().len() == 1 { curve::picture(&swept, unknown) } else { map::picture(&swept) };
        output::text(path, &picture)?;
    }
    let outputs = [&arguments.json, &arguments.table, &arguments.branches, &arguments.svg];
    let outputs = outputs.into_iter().filter_map(|path| path.as_deref());
    output::summary(outputs, || summary(&swept, seconds) + &family::besides(&multiple))?;
    if sweep.interrupted {
        return Err(Failure::Interrupted);
    }
    judged(&sweep)
}

/// The number of the unknown of this name.
fn unknown(family: &Family, name: Option<&str>) -> Result<usize, Failure> {
    let Some(name) = name else { return Ok(0) };
    let names = family.system().variables();
    names.iter().position(|known| known == name).ok_or_else(|| {
        Failure::Unusable(format!("`{name}` is no unknown of the family; its unknowns are: {}", names.join(", ")))
    })
}

/// An error unless all numbers and ends of branches are shown.
fn judged(sweep: &Sweep) -> Result<(), Failure> {
    let (doubtful, unexplained) = (sweep.doubtful(), sweep.unexplained());
    let mut words = Vec::new();
    if doubtful > 0 {
        words.push(format!("the number of real solutions is not shown in {}", counted(doubtful, "cell")));
    }
    if unexplained > 0 {
        let pairs = counted(unexplained, "pair");
        words.push(format!("it is not shown why branches end between {pairs} of neighbouring cells"));
    }
    if words.is_empty() { Ok(()) } else { Err(Failure::Undetermined(words.join("; "))) }
}

/// How many cells have how many solutions, and what is in doubt.
fn summary(swept: &Swept<'_>, seconds: f64) -> String {
    let Swept { family, grid, sweep, .. } = swept;
    let name = if family.name().is_empty() { String::new() } else { format!("{}: ", family.name()) };
    let counts: Vec<String> = grid.axes().iter().map(|axis| axis.count.to_string()).collect();
    let names: Vec<&str> = grid.axes().iter().map(|axis| axis.parameter.as_str()).collect();
    let mut text = format!(
        "{name}{} cells in {}, {} for generic parameters\n",
        counts.join(" x "),
        names.join(" and "),
        counted(sweep.fibre, "solution")
    );
    let mut numbers: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for cell in sweep.cells.iter().filter(|cell| cell.standing.is_shown()) {
        *numbers.entry((cell.real(), cell.positive())).or_default() += 1;
    }
    for ((real, positive), cells) in numbers.iter().take(LISTED) {
        text +=
            &format!("  {} with {}, {positive} positive\n", counted(*cells, "cell"), counted(*real, "real solution"));
    }
    if numbers.len() > LISTED {
        text += &format!("  and {} more such numbers; --table lists all cells\n", numbers.len() - LISTED);
    }
    let of = |standing: Standing| sweep.cells.iter().filter(|cell| cell.standing == standing).count();
    for (cells, words) in [
        (of(Standing::Certified), "with certified solutions"),
        (of(Standing::Multiple), "on a fold, with multiple solutions"),
        (of(Standing::Unreached), "not reached"),
    ] {
        if cells > 0 {
            text += &format!("  {} {words}\n", counted(cells, "cell"));
        }
    }
    let kind = |kind: BreakKind| sweep.breaks.iter().filter(|b| b.kind == kind).count();
    text += &format!(
        "{}; folds between {}, branches to infinity between {}\n",
        curve::counted_branches(sweep.branches),
        pairs(kind(BreakKind::Fold)),
        pairs(kind(BreakKind::Infinity))
    );
    text += &format!(
        "{} to cells, {} tracked again; {} between cells; {seconds:.3} s\n",
        counted(sweep.paths.to_cells, "path"),
        sweep.paths.again,
        counted(sweep.paths.between_cells, "path")
    );
    let doubtful = sweep.cells.iter().enumerate().filter_map(|(k, cell)| Some((k, cell.standing.doubt()?)));
    for (k, doubt) in doubtful.take(LISTED) {
        text += &format!("warning: {}: {doubt}\n", place(grid, k));
    }
    let more = sweep.doubtful().saturating_sub(LISTED);
    if more > 0 {
        text += &format!("doubts in {}; --table lists all\n", counted(more, "more cell"));
    }
    for broken in sweep.breaks.iter().filter(|b| b.kind == BreakKind::Unexplained).take(LISTED) {
        let [a, b] = broken.cells;
        let [from, to] = broken.ended;
        text += &format!(
            "warning: between {} and {}: of {from} and {to} branches it is not shown why they end\n",
            place(grid, a),
            place(grid, b)
        );
    }
    text
}

fn pairs(count: usize) -> String {
    format!("{} of cells", counted(count, "pair"))
}

/// Where a cell lies.
fn place(grid: &Grid, cell: usize) -> String {
    let parts = grid.axes().iter().zip(grid.values(cell)).map(|(axis, value)| format!("{} = {value}", axis.parameter));
    parts.collect::<Vec<_>>().join(", ")
}
