//! The shapes of a picture in SVG, and a frame with axes.

use hc::sweep::Axis;
use std::fmt::Write;

/// Lengths in pixels: the picture, and the frame in it.
const SIZE: [f64; 2] = [860.0, 640.0];
/// Left, top, right and bottom of the frame.
pub(super) const FRAME: [f64; 4] = [80.0, 40.0, 640.0, 580.0];
/// Marks on an axis.
const MARKS: usize = 5;

/// Colours of branches, and of numbers of solutions.
const COLOURS: [&str; 10] =
    ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#44bb99", "#8888cc", "#997755"];
/// The colour of what is in doubt.
pub(super) const DOUBTFUL: &str = "#000000";

/// The colour of this number; they repeat after ten.
pub(super) fn colour(number: usize) -> &'static str {
    COLOURS[number % COLOURS.len()]
}

/// A picture, drawn shape by shape: x to the right, y downwards.
pub(super) struct Canvas {
    body: String,
    /// Lines of the legend so far.
    legend: usize,
}

impl Canvas {
    /// A picture with nothing but a title: the name of a family, and what is shown of it.
    pub(super) fn new(family: &str, shown: &str) -> Canvas {
        let mut canvas = Canvas { body: String::new(), legend: 0 };
        let title = if family.is_empty() { shown.to_owned() } else { format!("{family}: {shown}") };
        canvas.text([FRAME[0], 24.0], "start", &title);
        canvas
    }

    /// Adds an element.
    pub(super) fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    pub(super) fn text(&mut self, [x, y]: [f64; 2], anchor: &str, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.add(format_args!(
            r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-family="sans-serif" font-size="13">{text}</text>"#
        ));
    }

    /// A line of the legend, with an element drawn at its left middle.
    pub(super) fn explain(&mut self, text: &str, sign: impl FnOnce([f64; 2]) -> String) {
        let at = [FRAME[2] + 20.0, FRAME[1] + 10.0 + 22.0 * self.legend as f64];
        self.legend += 1;
        let sign = sign(at);
        self.add(format_args!("{sign}"));
        self.text([at[0] + 22.0, at[1] + 4.5], "start", text);
    }

    /// The frame, with the values of the axis to the right below it, and those of a range or axis upwards at its left.
    pub(super) fn frame(&mut self, right: &Axis, name: &str, upwards: [f64; 2]) {
        let [left, top, to, bottom] = FRAME;
        self.add(format_args!(
            r##"<rect x="{left}" y="{top}" width="{}" height="{}" fill="none" stroke="#222"/>"##,
            to - left,
            bottom - top
        ));
        for mark in 0..MARKS {
            let share = mark as f64 / (MARKS - 1) as f64;
            let at = |[a, b]: [f64; 2]| short(a * (1.0 - share) + b * share);
            let (x, y) = (left + share * (to - left), bottom - share * (bottom - top));
            self.add(format_args!(r##"<path d="M{x:.1} {bottom}v5M{left} {y:.1}h-5" stroke="#222"/>"##));
            self.text([x, bottom + 20.0], "middle", &at([right.from, right.to]));
            self.text([left - 9.0, y + 4.5], "end", &at(upwards));
        }
        self.text([0.5 * (left + to), bottom + 42.0], "middle", &right.parameter);
        self.text([left - 9.0, top - 12.0], "end", name);
    }

    /// The picture as text.
    pub(super) fn finish(self) -> String {
        let [width, height] = SIZE;
        let Canvas { body, .. } = self;
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">
<rect width="{width}" height="{height}" fill="#fff"/>
{body}</svg>
"##
        )
    }
}

/// A number in some four digits.
pub(super) fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&x.abs()) {
        return format!("{x:.2e}");
    }
    let digits = (3 - x.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_are_short() {
        let found = [0.0, 1.0, -0.125, 1234.5678, 99999.0, 1e5, 1.23456e-4, 0.1 + 0.2, -0.001].map(short);
        assert_eq!(found, ["0", "1", "-0.125", "1235", "99999", "1.00e5", "1.23e-4", "0.3", "-0.001"]);
    }
}
