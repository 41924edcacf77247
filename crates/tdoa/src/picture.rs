//! A calibration as an SVG picture: the network with 95 % ellipses, names, axes in metres, outliers, a
//! histogram of the residuals and, if the truth is given, the truth and error vectors. A network in
//! space has three views: from above, with x to the right and y upwards; below it from the front, with x
//! to the right and z upwards; and beside this one from the side, with y to the right and z upwards.

mod canvas;
mod histogram;
mod labels;
mod layout;
mod legend;
mod networks;
mod scene;
mod view;

use crate::calibrate::Calibration;
use crate::quantity::length;
use crate::summary::deviation;
pub use canvas::Canvas;
pub(crate) use canvas::escape;
pub(crate) use layout::Layout;
use legend::Legend;
pub use networks::networks;
pub(crate) use scene::Scene;
use view::WIDTH;

/// Least height of what is below the views.
const FOOT: f64 = 190.0;

/// The picture as SVG text: one view of a network in the plane, three at one scale of one in space.
pub fn picture<const D: usize>(calibration: &Calibration<D>) -> String {
    let scene = Scene::of(calibration);
    let layout = Layout::of(&scene);
    let legend = Legend::of(calibration, &layout);
    // Between views in space there is a corner without one.
    let corner = layout.corner.filter(|room| legend.fits(room));
    let below = if corner.is_some() { FOOT } else { FOOT.max(legend.height() + 15.0) };
    let mut canvas = Canvas::new(WIDTH, layout.foot + below);
    canvas.text([20.0, 28.0], "start", 16.0, &title(calibration));
    for view in &layout.views {
        view.draw(&mut canvas, &scene, |p| layout.shows(p), layout.radius(&scene));
    }
    let width = if corner.is_some() { WIDTH - 120.0 } else { 480.0 };
    histogram::draw(&mut canvas, calibration, [60.0, layout.foot], [width, 130.0]);
    legend.draw(&mut canvas, corner.map_or([580.0, layout.foot - 11.0], |room| [room.left, room.top]));
    canvas.finish()
}

/// By what factor ellipses are enlarged, so that they stand out from the dots: 1 if half of them do
/// so already, otherwise a round number.
pub fn ellipse_magnification<const D: usize>(calibration: &Calibration<D>) -> f64 {
    Layout::of(&Scene::of(calibration)).magnified
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

#[cfg(test)]
mod tests;
