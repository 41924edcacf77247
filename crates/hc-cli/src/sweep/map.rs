//! The numbers of real solutions over two parameters, with the folds between them.

use super::canvas::{Canvas, DOUBTFUL, FRAME, colour};
use super::swept::Swept;
use hc::poly::counted;
use hc::sweep::{BreakKind, Cell, Standing};
use std::collections::BTreeSet;
use std::fmt::Write;

/// What cells of one colour have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Real(usize),
    Doubtful,
    Unreached,
}

fn kind(cell: &Cell) -> Kind {
    match cell.standing {
        Standing::Unreached => Kind::Unreached,
        _ if !cell.standing.is_shown() => Kind::Doubtful,
        _ => Kind::Real(cell.real()),
    }
}

fn fill(kind: Kind) -> &'static str {
    match kind {
        // Few solutions are pale.
        Kind::Real(0) => "#eeeeee",
        Kind::Real(count) => colour(count - 1),
        Kind::Doubtful => DOUBTFUL,
        Kind::Unreached => "#ffffff",
    }
}

/// The picture as SVG.
pub(super) fn picture(swept: &Swept<'_>) -> String {
    let Swept { family, grid, sweep, .. } = swept;
    let [right, upwards] = grid.axes() else { return Canvas::new(family.name(), "").finish() };
    let mut canvas = Canvas::new(family.name(), &format!("real ones of {}", counted(sweep.fibre, "solution")));
    let [left, top, to, bottom] = FRAME;
    let (width, height) = ((to - left) / right.count as f64, (bottom - top) / upwards.count as f64);
    let mut kinds = BTreeSet::new();
    for (row, cells) in sweep.cells.chunks(right.count).enumerate() {
        let y = bottom - (row + 1) as f64 * height;
        let mut column = 0;
        // Cells of one colour that lie side by side are one rectangle.
        for run in cells.chunk_by(|a, b| kind(a) == kind(b)) {
            let kind = kind(&run[0]);
            kinds.insert(kind);
            canvas.add(format_args!(
                r#"<rect x="{:.2}" y="{y:.2}" width="{:.2}" height="{height:.2}" fill="{}" shape-rendering="crispEdges"/>"#,
                left + column as f64 * width,
                run.len() as f64 * width,
                fill(kind)
            ));
            column += run.len();
        }
    }
    let mut ways = [String::new(), String::new(), String::new()];
    for broken in &sweep.breaks {
        let [a, b] = broken.cells;
        let (column, row) = (a % right.count, a / right.count);
        let (x, y) = (left + (column + 1) as f64 * width, bottom - (row + 1) as f64 * height);
        let (x, way) = if b == a + 1 { (x, format!("v{height:.2}")) } else { (x - width, format!("h{width:.2}")) };
        // Writing to a string does not fail.
        let _ = write!(ways[number(broken.kind)], "M{x:.2} {y:.2}{way}");
    }
    for (way, (colour, class, _)) in ways.iter().zip(LINES) {
        if !way.is_empty() {
            canvas.add(format_args!(
                r#"<path class="{class}" d="{way}" stroke="{colour}" stroke-width="1.5" fill="none"/>"#
            ));
        }
    }
    canvas.frame(right, &upwards.parameter, [upwards.from, upwards.to]);
    for kind in kinds {
        let words = match kind {
            Kind::Real(count) => counted(count, "real solution"),
            Kind::Doubtful => "number not shown".to_owned(),
            Kind::Unreached => "not reached".to_owned(),
        };
        let square = |[x, y]: [f64; 2]| {
            let (x, y, colour) = (x, y - 7.0, fill(kind));
            format!(r##"<rect x="{x}" y="{y}" width="14" height="14" fill="{colour}" stroke="#222"/>"##)
        };
        canvas.explain(&words, square);
    }
    for (way, (colour, _, words)) in ways.iter().zip(LINES) {
        if !way.is_empty() {
            canvas.explain(words, |[x, y]| format!(r#"<path d="M{x} {y}h14" stroke="{colour}" stroke-width="1.5"/>"#));
        }
    }
    canvas.finish()
}

/// Colours, classes and words of the lines between cells.
const LINES: [(&str, &str, &str); 3] = [
    ("#111111", "fold", "fold"),
    ("#ff00ff", "infinity", "branch to infinity"),
    ("#ff0000", "unexplained", "end not explained"),
];

fn number(kind: BreakKind) -> usize {
    match kind {
        BreakKind::Fold => 0,
        BreakKind::Infinity => 1,
        _ => 2,
    }
}
