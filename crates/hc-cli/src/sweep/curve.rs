//! The branches of an unknown over one parameter, with the folds at which they end.

use super::canvas::{Canvas, DOUBTFUL, FRAME, colour};
use super::swept::Swept;
use hc::poly::one_or;
use hc::sweep::{BreakKind, Cell, RealSolution};
use std::collections::BTreeMap;

/// Share of the values at either end of their order that may lie outside the picture: branches that go to infinity.
const OUTSIDE: f64 = 0.01;

/// From values of the parameter and the unknown to the picture.
struct View {
    count: usize,
    range: [f64; 2],
}

impl View {
    fn of(values: &mut [f64], count: usize) -> View {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values.get((share * values.len().saturating_sub(1) as f64).round() as usize).copied();
        let (low, high) = (at(OUTSIDE).unwrap_or(-1.0), at(1.0 - OUTSIDE).unwrap_or(1.0));
        // Halves, so that nothing overflows.
        let margin = (0.1 * (0.5 * high - 0.5 * low)).max(1e-3 * low.abs().max(high.abs()).max(f64::MIN_POSITIVE));
        View { count, range: [low - margin, high + margin] }
    }

    /// The place of a value of the unknown at a place on the axis, which may lie between cells.
    fn to(&self, place: f64, value: f64) -> [f64; 2] {
        let [left, top, right, bottom] = FRAME;
        let [low, high] = self.range;
        let share = (value - low) / (high - low);
        // Far outside is outside.
        let y = bottom - share.clamp(-10.0, 11.0) * (bottom - top);
        [left + place / self.count.saturating_sub(1).max(1) as f64 * (right - left), y]
    }
}

/// The picture of the branches of this unknown, as SVG.
pub(super) fn picture(swept: &Swept<'_>, unknown: usize) -> String {
    let Swept { family, grid, sweep, .. } = swept;
    let [axis] = grid.axes() else { return Canvas::new(family.name(), "").finish() };
    let value = |s: &RealSolution| s.value.get(unknown).copied().unwrap_or_default();
    let mut values: Vec<f64> = sweep.cells.iter().flat_map(|cell| cell.solutions.iter().map(value)).collect();
    let view = View::of(&mut values, axis.count);
    let mut canvas = Canvas::new(family.name(), &counted_branches(sweep.branches));
    let [left, top, right, bottom] = FRAME;
    canvas.add(format_args!(
        r#"<clipPath id="frame"><rect x="{left}" y="{top}" width="{}" height="{}"/></clipPath><g clip-path="url(#frame)">"#,
        right - left,
        bottom - top
    ));
    let mut branches: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    let mut multiple = Vec::new();
    for (k, cell) in sweep.cells.iter().enumerate() {
        for solution in &cell.solutions {
            match solution.branch {
                Some(branch) => branches.entry(branch).or_default().push((k, value(solution))),
                None => multiple.push(view.to(k as f64, value(solution))),
            }
        }
        if !cell.standing.is_shown() {
            let [x, _] = view.to(k as f64, 0.0);
            canvas.add(format_args!(
                r#"<path class="doubtful" d="M{x:.2} {top}V{bottom}" stroke="{DOUBTFUL}" stroke-dasharray="2 4"/>"#
            ));
        }
    }
    for (branch, points) in &branches {
        let points: Vec<String> =
            points.iter().map(|&(k, value)| view.to(k as f64, value)).map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        let colour = colour(*branch);
        canvas.add(format_args!(
            r#"<polyline class="branch" points="{}" fill="none" stroke="{colour}" stroke-width="1.5"/>"#,
            points.join(" ")
        ));
    }
    for broken in &sweep.breaks {
        let cells = broken.cells.map(|cell| &sweep.cells[cell]);
        let middle = 0.5 * (broken.cells[0] as f64 + broken.cells[1] as f64);
        for (side, cell) in cells.iter().enumerate() {
            let ended: Vec<f64> = ended(cell, cells[1 - side]).map(value).collect();
            if broken.kind == BreakKind::Fold && ended.len() == 2 {
                multiple.push(view.to(middle, 0.5 * ended[0] + 0.5 * ended[1]));
            } else if broken.kind != BreakKind::Infinity {
                multiple.extend(ended.iter().map(|&value| view.to(middle, value)));
            }
        }
    }
    for [x, y] in &multiple {
        canvas.add(format_args!(r##"<circle class="fold" cx="{x:.2}" cy="{y:.2}" r="3" fill="#111111"/>"##));
    }
    canvas.add(format_args!("</g>"));
    let name = family.system().variables().get(unknown).map_or("", String::as_str);
    canvas.frame(axis, name, view.range);
    if !multiple.is_empty() {
        canvas.explain("fold", |[x, y]| format!(r##"<circle cx="{}" cy="{y}" r="3" fill="#111111"/>"##, x + 7.0));
    }
    if sweep.cells.iter().any(|cell| !cell.standing.is_shown()) {
        canvas.explain("number not shown", |[x, y]| {
            format!(r#"<path d="M{} {}v14" stroke="{DOUBTFUL}" stroke-dasharray="2 4"/>"#, x + 7.0, y - 7.0)
        });
    }
    canvas.finish()
}

/// The regular solutions of a cell whose branches do not reach another.
fn ended<'a>(cell: &'a Cell, other: &'a Cell) -> impl Iterator<Item = &'a RealSolution> {
    let goes_on = |branch| other.solutions.iter().any(|s| s.branch == Some(branch));
    cell.solutions.iter().filter(move |s| s.branch.is_some_and(|branch| !goes_on(branch)))
}

/// Branches in words.
pub(super) fn counted_branches(branches: usize) -> String {
    format!("{branches} {}", one_or(branches, "branch", "branches"))
}
