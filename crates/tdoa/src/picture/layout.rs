//! Which views of a calibration the picture has, and where.

use super::canvas::Map;
use super::view::{View, WIDTH, magnification};
use crate::calibrate::Calibration;
use crate::points::{centroid, distance, spread};

/// Transmitters farther than this many network sizes from the centre are left out of the picture.
const REACH: f64 = 5.0;

/// Heights of the view from above and the view from the side together, at most, and of each at
/// least, so that a flat one has ticks too.
const HEIGHTS: f64 = 860.0;
const HEIGHT: f64 = 110.0;

/// Left of a view are the numbers of its upward axis; above it are the name of that axis and the label.
const LEFT: f64 = 75.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 72.0;

/// Below a view are its numbers, the name of their axis, and what stands above the next one.
const FEET: f64 = 66.0;

/// The views and what they show.
pub(crate) struct Layout {
    /// One in the plane, two in space, at one scale.
    pub(super) views: Vec<View>,
    /// How many transmitters lie too far away to be shown.
    pub(super) outside: usize,
    /// Where the histogram and the legend begin.
    pub(super) foot: f64,
}

impl Layout {
    /// The views of a calibration in the plane or in space.
    pub(crate) fn of<const D: usize>(calibration: &Calibration<D>) -> Self {
        const { assert!(D == 2 || D == 3, "a picture is of the plane or of space") }
        let receivers: Vec<[f64; D]> = calibration.receivers.iter().flatten().copied().collect();
        let (centre, size) = (centroid(receivers.iter()), spread(receivers.iter()));
        let near = |p: &&[f64; D]| distance(**p, centre) <= REACH * size;
        let transmitters: Vec<[f64; D]> = calibration.transmitters.iter().flatten().copied().collect();
        let shown: Vec<[f64; D]> = receivers
            .iter()
            .chain(transmitters.iter().filter(near))
            .chain(calibration.mirror_images.iter().map(|image| &image.position).filter(near))
            .chain(calibration.truth.iter().flat_map(|truth| truth.positions.iter().flatten()))
            .copied()
            .collect();
        let outside = transmitters.iter().filter(|p| !near(p)).count();
        let (views, foot) = if D == 2 { in_the_plane(&shown) } else { in_space(&shown) };
        Layout { views, outside, foot }
    }

    /// Whether all views have this point.
    pub(crate) fn shows<const D: usize>(&self, p: &[f64; D]) -> bool {
        self.views.iter().all(|view| view.map.shows(view.point(*p)))
    }

    /// By what factor ellipses are enlarged.
    pub(super) fn magnification<const D: usize>(&self, calibration: &Calibration<D>) -> f64 {
        let [of_receivers, of_transmitters] = calibration.trusted_covariances();
        let receivers = calibration.receivers.iter().zip(of_receivers);
        let nodes = receivers.chain(calibration.transmitters.iter().zip(of_transmitters));
        let shown = nodes.filter(|(position, _)| position.as_ref().is_some_and(|p| self.shows(p)));
        let covariances: Vec<_> = shown.filter_map(|(_, covariance)| *covariance).collect();
        let radius = calibration.ellipse_radius.unwrap_or(0.0);
        magnification(self.views.iter().flat_map(|view| covariances.iter().map(|c| view.semiaxes(c, radius)[0])))
    }
}

/// The least and the greatest of a coordinate; zeros if there are no points.
fn range<const D: usize>(points: &[[f64; D]], k: usize) -> (f64, f64) {
    let low = points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

fn in_the_plane<const D: usize>(points: &[[f64; D]]) -> (Vec<View>, f64) {
    let (axes, corner, size) = ([0, 1], [LEFT, TOP], [WIDTH - LEFT - RIGHT, 560.0]);
    let ranges = axes.map(|k| range(points, k));
    let map = Map::new(Map::scale_to_fit(ranges.map(|(low, high)| high - low), size), ranges, corner, size);
    (vec![View { axes, map, label: None }], TOP + 560.0 + FEET)
}

/// A view from above and below it one from the side: what is in both lies on one vertical line.
fn in_space<const D: usize>(points: &[[f64; D]]) -> (Vec<View>, f64) {
    let length = |k: usize| {
        let (low, high) = range(points, k);
        high - low
    };
    let (width, [_, margin]) = (WIDTH - LEFT - RIGHT, Map::MARGIN);
    let scale = Map::scale_to_fit([length(0), length(1) + length(2)], [width, HEIGHTS - 2.0 * margin]);
    let mut top = TOP;
    let views = [([0, 1], "from above"), ([0, 2], "from the side")].map(|(axes, label)| {
        let height = (length(axes[1]) * scale + 2.0 * margin).max(HEIGHT);
        let map = Map::new(scale, axes.map(|k| range(points, k)), [LEFT, top], [width, height]);
        top += height + FEET;
        View { axes, map, label: Some(label) }
    });
    (views.into(), top)
}
