//! What the marks of a picture mean, and what it leaves out.

use hc::poly::{counted, one_or};

use super::canvas::{Canvas, Rectangle};
use super::layout::Layout;
use super::view::{BLUE, CROSS, DISC, ORANGE, PINK, RING, SQUARE, TRIANGLE};
use crate::calibrate::Calibration;
use crate::quantity::number;

/// Height of a row, and width of a letter, on average, in pixels.
const ROW: f64 = 22.0;
const LETTER: f64 = 5.8;

/// From the left edge to the middle of the marks, and to the words.
const MARK: f64 = 20.0;
const WORDS: f64 = 40.0;

/// What stands before the words of a row.
enum Mark {
    None,
    Receiver,
    Transmitter,
    Ellipse,
    Outlier,
    Truth,
    MirrorImage,
    Anchor,
}

/// Rows of a mark and words.
pub(super) struct Legend(Vec<(Mark, String)>);

impl Legend {
    /// The rows for what this picture has.
    pub(super) fn of<const D: usize>(calibration: &Calibration<D>, layout: &Layout) -> Self {
        let mut rows = Vec::new();
        let mut row = |mark: Mark, text: String| rows.push((mark, text));
        let times = number(layout.magnified, 3);
        let is_magnified = layout.magnified > 1.0;
        // What several views show are shadows. That takes more words, so it has rows of its own.
        let shadows = layout.views.len() > 1;
        let ellipse = if shadows { "ellipsoid" } else { "ellipse" };
        let with = match (shadows, is_magnified) {
            (true, _) => String::new(),
            (false, false) => ", with 95 % ellipse".to_string(),
            (false, true) => format!(", with 95 % ellipse, {times} times as large"),
        };
        row(Mark::Receiver, format!("receiver{with}"));
        row(Mark::Transmitter, format!("transmitter{with}"));
        if shadows {
            row(Mark::Ellipse, "shadow of the 95 % ellipsoid".to_string());
            if is_magnified {
                row(Mark::None, format!("(drawn {times} times as large)"));
            }
        }
        if calibration.relevant_systematic().is_some() {
            row(Mark::None, "(with systematic errors of the receivers)".to_string());
        }
        if layout.cut > 0 {
            row(Mark::None, format!("{} larger than the network, cut at the edge", counted(layout.cut, ellipse)));
        }
        if layout.undrawn > 0 {
            row(Mark::None, format!("{} larger than the picture, not drawn", counted(layout.undrawn, ellipse)));
        }
        let (measured, outlying) = (calibration.residuals.len(), calibration.residuals.outliers().count());
        row(Mark::Outlier, format!("outliers: {outlying} of {}", counted(measured, "measurement")));
        if calibration.truth.is_some() {
            row(Mark::Truth, "true position, and the error".to_string());
        }
        if !calibration.mirror_images.is_empty() {
            row(Mark::MirrorImage, "mirror image that fits as well".to_string());
        }
        if calibration.anchored.contains(&true) {
            row(Mark::Anchor, "receiver held at its known position".to_string());
        }
        let outside = layout.outside;
        if outside > 0 {
            let lies = one_or(outside, "lies", "lie");
            row(Mark::None, format!("{} {lies} outside the picture", counted(outside, "transmitter")));
        }
        if !calibration.unique {
            row(
                Mark::None,
                match calibration.alternatives.len() {
                    0 => "not unique, see the warnings".to_string(),
                    others => format!("not unique: {}", counted(others, "alternative")),
                },
            );
        }
        Legend(rows)
    }

    /// The rows for networks that are exact.
    pub(super) fn exact() -> Self {
        Legend(vec![(Mark::Receiver, "receiver".to_string()), (Mark::Transmitter, "transmitter".to_string())])
    }

    /// Height in pixels.
    pub(super) fn height(&self) -> f64 {
        ROW * self.0.len() as f64
    }

    /// Whether it has room in a rectangle.
    pub(super) fn fits(&self, room: &Rectangle) -> bool {
        let letters = self.0.iter().map(|(_, text)| text.chars().count()).max().unwrap_or(0);
        WORDS + LETTER * letters as f64 <= room.right - room.left && self.height() <= room.bottom - room.top
    }

    /// Draws it below and to the right of a corner.
    pub(super) fn draw(&self, canvas: &mut Canvas, [left, top]: [f64; 2]) {
        for (k, (mark, text)) in self.0.iter().enumerate() {
            let at = [left + MARK, top + ROW * (k as f64 + 0.5)];
            match mark {
                Mark::None => {}
                Mark::Receiver => canvas.triangle(at, TRIANGLE, BLUE),
                Mark::Transmitter => canvas.circle(at, DISC, ORANGE),
                Mark::Ellipse => canvas.ellipse(at, [11.0, 6.0], 0.0, BLUE),
                Mark::Outlier => canvas.line([at[0] - 11.0, at[1]], [at[0] + 11.0, at[1]], PINK, 1.0, "5 3"),
                Mark::Truth => canvas.cross(at, CROSS),
                Mark::MirrorImage => canvas.ring(at, RING, ORANGE),
                Mark::Anchor => canvas.square(at, SQUARE),
            }
            canvas.text([left + WORDS, at[1] + 4.0], "start", 12.0, text);
        }
    }
}
