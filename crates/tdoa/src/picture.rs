//! A calibration as an SVG picture: the network with 95 % ellipses, names, axes in metres, outliers, a
//! histogram of the residuals and, if the truth is given, the truth and error vectors. A network in
//! space has two views: from above, with x to the right and y upwards, and from the side, with x to the
//! right and z upwards.

use hc::poly::{counted, one_or};

mod canvas;
mod histogram;
mod labels;
mod layout;
mod view;

use crate::calibrate::Calibration;
use crate::quantity::{length, number};
use crate::summary::deviation;
pub use canvas::Canvas;
pub(crate) use canvas::escape;
pub(crate) use layout::Layout;
use view::{BLUE, CROSS, DISC, ORANGE, PINK, RING, SQUARE, TRIANGLE, WIDTH};

/// Height of the histogram and the legend.
const FOOT: f64 = 190.0;

/// The picture as SVG text: one view of a network in the plane, two at one scale of one in space.
pub fn picture<const D: usize>(calibration: &Calibration<D>) -> String {
    let layout = Layout::of(calibration);
    let mut canvas = Canvas::new(WIDTH, layout.foot + FOOT);
    canvas.text([20.0, 28.0], "start", 16.0, &title(calibration));
    for view in &layout.views {
        view.draw(&mut canvas, calibration, |p| layout.shows(p), layout.radius(calibration));
    }
    histogram::draw(&mut canvas, calibration, [60.0, layout.foot], [480.0, 130.0]);
    legend(&mut canvas, calibration, &layout, [600.0, layout.foot]);
    canvas.finish()
}

/// By what factor ellipses are enlarged, so that they stand out from the dots: 1 if half of them do
/// so already, otherwise a round number.
pub fn ellipse_magnification<const D: usize>(calibration: &Calibration<D>) -> f64 {
    Layout::of(calibration).magnified
}

fn title<const D: usize>(calibration: &Calibration<D>) -> String {
    let mut title = format!("{}, {}", calibration.configuration, deviation(calibration));
    if let Some(truth) = &calibration.truth {
        title += &format!(", receivers {} from the truth (rms)", length(truth.receiver_rms));
    }
    if calibration.distrust().is_some() {
        title += ", NOT TO BE TRUSTED";
    }
    title
}

fn legend<const D: usize>(canvas: &mut Canvas, calibration: &Calibration<D>, layout: &Layout, at: [f64; 2]) {
    let magnified = layout.magnified;
    let mut y = at[1];
    let mut row = |canvas: &mut Canvas, text: &str| {
        canvas.text([at[0] + 20.0, y + 4.0], "start", 12.0, text);
        y += 22.0;
        y - 22.0
    };
    let times = if magnified > 1.0 { format!(", {} times as large", number(magnified, 3)) } else { String::new() };
    // What several views show are shadows. That takes more words, so it has rows of its own.
    let shadows = layout.views.len() > 1;
    let with = if shadows { String::new() } else { format!(", with 95 % ellipse{times}") };
    let h = row(canvas, &format!("receiver{with}"));
    canvas.triangle([at[0], h], TRIANGLE, BLUE);
    let h = row(canvas, &format!("transmitter{with}"));
    canvas.circle([at[0], h], DISC, ORANGE);
    if shadows {
        let h = row(canvas, "shadow of the 95 % ellipsoid");
        canvas.ellipse([at[0], h], [11.0, 6.0], 0.0, BLUE);
        if magnified > 1.0 {
            row(canvas, &format!("(drawn {} times as large)", number(magnified, 3)));
        }
    }
    if calibration.relevant_systematic().is_some() {
        row(canvas, "(with systematic errors of the receivers)");
    }
    let ellipse = if shadows { "ellipsoid" } else { "ellipse" };
    if layout.cut > 0 {
        let words = "larger than the network, cut at the edge";
        row(canvas, &format!("{} {words}", counted(layout.cut, ellipse)));
    }
    if layout.undrawn > 0 {
        let words = "larger than the picture, not drawn";
        row(canvas, &format!("{} {words}", counted(layout.undrawn, ellipse)));
    }
    let (measured, outlying) = (calibration.residuals.len(), calibration.residuals.outliers().count());
    let h = row(canvas, &format!("outliers: {outlying} of {}", counted(measured, "measurement")));
    canvas.line([at[0] - 10.0, h], [at[0] + 12.0, h], PINK, 1.0, "5 3");
    if calibration.truth.is_some() {
        let h = row(canvas, "true position, and the error");
        canvas.cross([at[0], h], CROSS);
    }
    if !calibration.mirror_images.is_empty() {
        let h = row(canvas, "mirror image that fits as well");
        canvas.ring([at[0], h], RING, ORANGE);
    }
    if calibration.anchored.contains(&true) {
        let h = row(canvas, "receiver held at its known position");
        canvas.square([at[0], h], SQUARE);
    }
    let outside = layout.outside;
    if outside > 0 {
        row(
            canvas,
            &format!("{} {} outside the picture", counted(outside, "transmitter"), one_or(outside, "lies", "lie")),
        );
    }
    if !calibration.unique {
        row(
            canvas,
            &match calibration.alternatives.len() {
                0 => "not unique, see the warnings".to_string(),
                others => format!("not unique: {}", counted(others, "alternative")),
            },
        );
    }
}

#[cfg(test)]
mod tests;
