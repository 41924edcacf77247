//! A calibration as an SVG picture: the network with 95 % ellipses, names, a scale bar, outliers, a
//! histogram of the residuals and, if the truth is given, the truth and error vectors.

use hc::poly::{counted, one_or};

mod canvas;
mod histogram;

use crate::calibrate::Calibration;
use crate::points::{centroid, distance, spread};
use crate::quantity::{length, number};
use crate::summary::deviation;
pub use canvas::Canvas;
pub(crate) use canvas::escape;
use canvas::{Map, nice};

const WIDTH: f64 = 900.0;
const MAP_HEIGHT: f64 = 620.0;
const FOOT_HEIGHT: f64 = 230.0;

/// Transmitters farther than this many network sizes from the centre are left out of the picture.
const REACH: f64 = 5.0;

/// Most nodes of a kind that get their names.
const NAMED: usize = 80;

/// Most outliers that are drawn as lines.
const OUTLIERS: usize = 200;

/// The picture as SVG text.
pub fn picture(calibration: &Calibration) -> String {
    let mut canvas = Canvas::new(WIDTH, MAP_HEIGHT + FOOT_HEIGHT);
    let (map, outside) = map_of(calibration);
    let visible = |p: &[f64; 2]| map.shows(*p);
    canvas.text([20.0, 28.0], "start", 16.0, &title(calibration));

    outliers(&mut canvas, calibration, &map);
    let magnified = magnification(calibration, &map);
    let radius = magnified * calibration.ellipse_radius.unwrap_or(0.0);
    let blue = "#0072B2";
    let orange = "#D55E00";
    let nodes = calibration.transmitters.iter().zip(&calibration.transmitter_covariance);
    for (position, covariance) in nodes {
        if let Some(p) = position.filter(visible) {
            ellipse(&mut canvas, &map, p, *covariance, radius, orange);
            canvas.circle(map.to(p), 3.0, orange);
        }
    }
    let nodes = calibration.receivers.iter().zip(&calibration.receiver_covariance).zip(&calibration.anchored);
    for ((position, covariance), anchored) in nodes {
        if let Some(p) = position.filter(visible) {
            ellipse(&mut canvas, &map, p, *covariance, radius, blue);
            canvas.triangle(map.to(p), 6.0, blue);
            if *anchored {
                canvas.square(map.to(p), 9.0);
            }
        }
    }
    if let Some(truth) = &calibration.truth {
        let receivers = calibration.receivers.iter().zip(&truth.positions);
        let transmitters = calibration.transmitters.iter().zip(&truth.transmitter_positions);
        for (found, known) in receivers.chain(transmitters.filter(|(p, _)| p.as_ref().is_some_and(visible))) {
            if let (Some(found), Some(known)) = (found, known) {
                canvas.line(map.to(*found), map.to(*known), "#000", 1.5, "");
                canvas.cross(map.to(*known), 5.0);
            }
        }
    }
    let named = |names: &[String], positions: &[Option<[f64; 2]>]| -> Vec<([f64; 2], String)> {
        let nodes = names.iter().zip(positions).filter_map(|(name, p)| Some(((*p)?, name.clone())));
        nodes.filter(|(p, _)| visible(p)).map(|(p, name)| (map.to(p), name)).collect()
    };
    let receivers = named(&calibration.receiver_names, &calibration.receivers);
    let transmitters = named(&calibration.transmitter_names, &calibration.transmitters);
    let points: Vec<[f64; 2]> = receivers.iter().chain(&transmitters).map(|(p, _)| *p).collect();
    canvas.labels(&receivers[..receivers.len().min(NAMED)], &points, blue);
    if transmitters.len() <= NAMED {
        canvas.labels(&transmitters, &points, orange);
    }
    scale_bar(&mut canvas, &map);
    histogram::draw(&mut canvas, calibration, [60.0, MAP_HEIGHT + 40.0], [480.0, 130.0]);
    legend(&mut canvas, calibration, magnified, outside, [600.0, MAP_HEIGHT + 40.0]);
    canvas.finish()
}

fn title(calibration: &Calibration) -> String {
    let mut title = format!("{}, {}", calibration.configuration, deviation(calibration));
    if let Some(truth) = &calibration.truth {
        title += &format!(", receivers {} from the truth (rms)", length(truth.receiver_rms));
    }
    if calibration.distrust().is_some() {
        title += ", NOT TO BE TRUSTED";
    }
    title
}

/// The map from metres to the picture, and how many transmitters lie outside it.
fn map_of(calibration: &Calibration) -> (Map, usize) {
    let receivers: Vec<[f64; 2]> = calibration.receivers.iter().flatten().copied().collect();
    let (centre, size) = (centroid(receivers.iter()), spread(receivers.iter()));
    let near = |p: &&[f64; 2]| distance(**p, centre) <= REACH * size;
    let transmitters: Vec<[f64; 2]> = calibration.transmitters.iter().flatten().copied().collect();
    let shown: Vec<[f64; 2]> = receivers
        .iter()
        .chain(transmitters.iter().filter(near))
        .chain(calibration.truth.iter().flat_map(|truth| truth.positions.iter().flatten()))
        .copied()
        .collect();
    let outside = transmitters.iter().filter(|p| !near(p)).count();
    (Map::fit(&shown, [20.0, 50.0], [WIDTH - 40.0, MAP_HEIGHT - 60.0]), outside)
}

fn ellipse(canvas: &mut Canvas, map: &Map, at: [f64; 2], covariance: Option<[[f64; 2]; 2]>, radius: f64, colour: &str) {
    let Some([[xx, xy], [_, yy]]) = covariance else { return };
    let axes = axes([[xx, xy], [xy, yy]]).map(|variance| radius * variance.sqrt() * map.scale);
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    // Beyond the picture it would be a wash of colour; below a pixel nothing is seen.
    if axes[0] < 2.0 * WIDTH && axes[0] > 0.5 {
        canvas.ellipse(map.to(at), axes, -angle.to_degrees(), colour);
    }
}

fn outliers(canvas: &mut Canvas, calibration: &Calibration, map: &Map) {
    let mut drawn = 0;
    for (i, j, _) in calibration.residuals.outliers() {
        if let (Some(r), Some(s)) = (calibration.receivers[i], calibration.transmitters[j])
            && map.shows(s)
            && drawn < OUTLIERS
        {
            canvas.line(map.to(r), map.to(s), "#CC79A7", 1.0, "5 3");
            drawn += 1;
        }
    }
}

fn scale_bar(canvas: &mut Canvas, map: &Map) {
    let metres = nice(150.0 / map.scale);
    let [x, y] = [20.0, MAP_HEIGHT + 8.0];
    let end = x + metres * map.scale;
    canvas.line([x, y], [end, y], "#000", 2.0, "");
    canvas.line([x, y - 4.0], [x, y + 4.0], "#000", 2.0, "");
    canvas.line([end, y - 4.0], [end, y + 4.0], "#000", 2.0, "");
    canvas.text([end + 8.0, y + 4.0], "start", 12.0, &length(metres));
}

/// By what factor ellipses are enlarged, so that they stand out from the dots: 1 if half of them do
/// so already, otherwise a round number.
pub fn ellipse_magnification(calibration: &Calibration) -> f64 {
    magnification(calibration, &map_of(calibration).0)
}

fn magnification(calibration: &Calibration, map: &Map) -> f64 {
    let radius = calibration.ellipse_radius.unwrap_or(0.0);
    let receivers = calibration.receivers.iter().zip(&calibration.receiver_covariance);
    let nodes = receivers.chain(calibration.transmitters.iter().zip(&calibration.transmitter_covariance));
    let shown = nodes.filter(|(position, _)| position.is_some_and(|p| map.shows(p)));
    let mut axes: Vec<f64> =
        shown.filter_map(|(_, covariance)| Some(radius * map.scale * axes((*covariance)?)[0].sqrt())).collect();
    axes.sort_by(f64::total_cmp);
    let (Some(middle), Some(large)) = (axes.get(axes.len() / 2), axes.get(axes.len() * 9 / 10)) else { return 1.0 };
    // Twice the size of the triangles; the largest ones must not cover the picture.
    let factor = (20.0 / middle).min(60.0 / large);
    if *middle > 10.0 || !factor.is_finite() { 1.0 } else { nice(factor.max(1.0)) }
}

/// The variances along the axes of an ellipse, the larger one first.
fn axes([[xx, xy], [_, yy]]: [[f64; 2]; 2]) -> [f64; 2] {
    let root = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    [0.5 * (xx + yy) + root, 0.5 * (xx + yy) - root].map(|variance| variance.max(0.0))
}

fn legend(canvas: &mut Canvas, calibration: &Calibration, magnified: f64, outside: usize, at: [f64; 2]) {
    let mut y = at[1];
    let mut row = |canvas: &mut Canvas, text: &str| {
        canvas.text([at[0] + 20.0, y + 4.0], "start", 12.0, text);
        y += 22.0;
        y - 22.0
    };
    let times = if magnified > 1.0 { format!(", {} times as large", number(magnified, 3)) } else { String::new() };
    let h = row(canvas, &format!("receiver, with 95 % ellipse{times}"));
    canvas.triangle([at[0], h], 6.0, "#0072B2");
    let h = row(canvas, &format!("transmitter, with 95 % ellipse{times}"));
    canvas.circle([at[0], h], 3.0, "#D55E00");
    let (measured, outlying) = (calibration.residuals.len(), calibration.residuals.outliers().count());
    let h = row(canvas, &format!("outliers: {outlying} of {}", counted(measured, "measurement")));
    canvas.line([at[0] - 10.0, h], [at[0] + 12.0, h], "#CC79A7", 1.0, "5 3");
    if calibration.truth.is_some() {
        let h = row(canvas, "true position, and the error");
        canvas.cross([at[0], h], 5.0);
    }
    if calibration.anchored.contains(&true) {
        let h = row(canvas, "receiver held at its known position");
        canvas.square([at[0], h], 9.0);
    }
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
mod tests {
    use super::*;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

    #[test]
    fn shows_every_node_and_escapes_names() {
        let mut options = SimulateOptions { noise: 0.01, outliers: 0.02, ..Default::default() };
        options.missing = 0.02;
        let simulation = simulate(&options).unwrap();
        let names = |kind: &str, count: usize| (0..count).map(|k| format!("{kind}<{k}&\"")).collect();
        let measured = simulation.pseudoranges.with_names(names("r", 8), names("s", 12)).unwrap();
        let mut calibration = calibrate(&measured, &CalibrateOptions::default()).unwrap();
        let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
        calibration.compare(&truth);
        let svg = picture(&calibration);
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
        for name in ["r&lt;0&amp;&quot;", "r&lt;7&amp;&quot;", "s&lt;11&amp;&quot;", "true position"] {
            assert!(svg.contains(name), "{name}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        // Eight receivers and one in the legend; twelve transmitters and one.
        assert_eq!(svg.matches("class=\"receiver\"").count(), 9);
        assert_eq!(svg.matches("class=\"transmitter\"").count(), 13);
        assert_eq!(svg.matches("class=\"truth\"").count(), 9);
        assert!(!svg.contains("class=\"anchor\""));
    }

    #[test]
    fn small_ellipses_are_magnified_by_a_stated_number() {
        for (noise, least) in [(1e-4, 100.0), (0.01, 2.0), (0.5, 1.0)] {
            let simulation = simulate(&SimulateOptions { noise, ..Default::default() }).unwrap();
            let calibration = calibrate(&simulation.pseudoranges, &CalibrateOptions::default()).unwrap();
            let (factor, svg) = (ellipse_magnification(&calibration), picture(&calibration));
            assert!(factor >= least && (least > 1.0 || factor == 1.0), "{noise}: {factor}");
            let stated = format!("receiver, with 95 % ellipse, {factor} times as large");
            assert_eq!(svg.contains(&stated), factor > 1.0, "{noise}");
            // Half of the ellipses are larger than the triangles of 6 pixels.
            let radii = svg.split("rx=\"").skip(1).filter_map(|rest| rest.split('"').next()?.parse::<f64>().ok());
            let mut radii: Vec<f64> = radii.collect();
            radii.sort_by(f64::total_cmp);
            assert!(radii[radii.len() / 2] > 6.0, "{noise}: {radii:?}");
        }
    }

    #[test]
    fn marks_anchors_and_true_transmitters() {
        let simulation = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        let known: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
        let mut options = CalibrateOptions { anchors: known.clone(), ..Default::default() };
        options.anchors[3..].fill(None);
        let mut calibration = calibrate(&simulation.pseudoranges, &options).unwrap();
        let mut transmitters: Vec<_> = simulation.network.transmitters.iter().copied().map(Some).collect();
        transmitters[5] = None;
        calibration.compare_all(&known, &transmitters);
        assert!(calibration.truth.as_ref().unwrap().transmitter_median.unwrap() < 0.1);
        let svg = picture(&calibration);
        // Three anchors and one in the legend; eight receivers, eleven transmitters and the legend.
        assert_eq!(svg.matches("class=\"anchor\"").count(), 4);
        assert_eq!(svg.matches("class=\"truth\"").count(), 20);
    }
}
