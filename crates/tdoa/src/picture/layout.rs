//! Which views of a scene the picture has, and where.

use std::array::from_fn;

use super::canvas::{Map, Rectangle};
use super::scene::Scene;
use super::view::{View, WIDTH, magnification};
use crate::points::{centroid, distance, spread};

/// Transmitters farther than this many network sizes from the centre are left out of the picture.
const REACH: f64 = 5.0;

/// Heights of the view from above and the view from the front together, at most, and of each at
/// least, so that a flat one has ticks too.
const HEIGHTS: f64 = 860.0;
const HEIGHT: f64 = 110.0;

/// Least extent of a view, as a share of the network's.
const FLAT: f64 = 0.15;

/// Left of a view are the numbers of its upward axis; above it are the name of that axis and the label.
const LEFT: f64 = 75.0;
const RIGHT: f64 = 20.0;
const BETWEEN: f64 = 65.0;
const TOP: f64 = 72.0;

/// Below a view are its numbers, the name of their axis, and what stands above the next one.
const FEET: f64 = 66.0;

/// Pixels that remain between the largest ellipse and the edge are those of a margin beyond these.
const LEAST_MARGIN: f64 = 20.0;

/// The views and what they show.
pub(crate) struct Layout {
    /// One in the plane, three in space, at one scale.
    pub(super) views: Vec<View>,
    /// By what factor ellipses are enlarged.
    pub(crate) magnified: f64,
    /// How many transmitters lie too far away to be shown.
    pub(super) outside: usize,
    /// How many ellipses are too large for a view, which cuts them.
    pub(super) cut: usize,
    /// How many ellipses are so large that they are not drawn.
    pub(super) undrawn: usize,
    /// Room that no view takes, beside the view from above.
    pub(super) corner: Option<Rectangle>,
    /// Where what is below the views begins.
    pub(super) foot: f64,
}

impl Layout {
    /// The views of a scene in the plane or in space.
    pub(crate) fn of<const D: usize>(scene: &Scene<D>) -> Self {
        const { assert!(D == 2 || D == 3, "a picture is of the plane or of space") }
        let points = points(scene);
        let ranges = from_fn(|k| range(points.iter().map(|p| p[k])));
        let mut layout = Layout::arranged(&ranges);
        let magnified = layout.magnification(scene);
        layout.magnified = magnified;
        layout = Layout { magnified, ..Layout::arranged(&layout.with_ellipses(ranges, scene)) };
        layout.outside = scene.transmitters.positions.iter().flatten().filter(|p| !layout.shows(p)).count();
        for (p, covariance) in layout.ellipsoids(scene) {
            let fits = |view: &View| view.ellipse_fits(p, covariance, layout.radius(scene));
            if layout.views.iter().any(|view| fits(view).is_none()) {
                layout.undrawn += 1;
            } else if layout.views.iter().any(|view| fits(view) == Some(false)) {
                layout.cut += 1;
            }
        }
        layout
    }

    /// The views of these ranges, with nothing in them yet.
    fn arranged<const D: usize>(ranges: &[(f64, f64); D]) -> Self {
        if D == 2 { in_the_plane(ranges) } else { in_space(ranges) }
    }

    fn of_views(views: Vec<View>, corner: Option<Rectangle>, foot: f64) -> Self {
        Layout { views, magnified: 1.0, outside: 0, cut: 0, undrawn: 0, corner, foot }
    }

    /// This layout further down in the picture.
    pub(super) fn down(mut self, pixels: f64) -> Self {
        self.views.iter_mut().for_each(|view| view.map.down(pixels));
        self.corner = self.corner.map(|r| Rectangle { top: r.top + pixels, bottom: r.bottom + pixels, ..r });
        self.foot += pixels;
        self
    }

    /// Whether all views have this point.
    pub(crate) fn shows<const D: usize>(&self, p: &[f64; D]) -> bool {
        self.views.iter().all(|view| view.map.shows(view.point(*p)))
    }

    /// The radius of ellipses as they are drawn, in standard deviations.
    pub(crate) fn radius<const D: usize>(&self, scene: &Scene<D>) -> f64 {
        self.magnified * scene.radius
    }

    /// The nodes that all views have and whose covariance is known.
    fn ellipsoids<'a, const D: usize>(&self, scene: &'a Scene<D>) -> Vec<([f64; D], &'a [[f64; D]; D])> {
        let all = [&scene.receivers, &scene.transmitters].into_iter();
        let nodes = all.flat_map(|nodes| nodes.positions.iter().zip(&nodes.covariances));
        let known = nodes.filter_map(|(position, covariance)| Some(((*position)?, covariance.as_ref()?)));
        known.filter(|(p, _)| self.shows(p)).collect()
    }

    fn magnification<const D: usize>(&self, scene: &Scene<D>) -> f64 {
        let ellipsoids = self.ellipsoids(scene);
        magnification(
            self.views.iter().flat_map(|view| ellipsoids.iter().map(|(_, c)| view.semiaxes(c, scene.radius)[0])),
        )
    }

    /// The ranges of the points, grown for ellipses. One that is larger than the network would leave a dot of the
    /// network: it is cut instead.
    fn with_ellipses<const D: usize>(&self, ranges: [(f64, f64); D], scene: &Scene<D>) -> [(f64, f64); D] {
        let largest = ranges.iter().map(|(low, high)| 0.5 * (high - low)).fold(0.0, f64::max);
        // Ellipses need no room for names. What grows has a smaller scale, at which the margin is worth more.
        let margin = self.views.iter().map(|view| LEAST_MARGIN / view.map.scale).fold(0.0, f64::max);
        let mut grown = ranges;
        for (p, covariance) in self.ellipsoids(scene) {
            let reach: [f64; D] = from_fn(|k| self.radius(scene) * covariance[k][k].sqrt());
            if reach.iter().all(|reach| *reach <= largest) {
                for (k, (low, high)) in grown.iter_mut().enumerate() {
                    let beyond = (reach[k] - margin).max(0.0);
                    (*low, *high) = (low.min(p[k] - beyond), high.max(p[k] + beyond));
                }
            }
        }
        grown
    }
}

/// All points that the views must have.
fn points<const D: usize>(scene: &Scene<D>) -> Vec<[f64; D]> {
    let receivers: Vec<[f64; D]> = scene.receivers.positions.iter().flatten().copied().collect();
    let (centre, size) = (centroid(receivers.iter()), spread(receivers.iter()));
    let near = |p: &&[f64; D]| distance(**p, centre) <= REACH * size;
    let transmitters = scene.transmitters.positions.iter().flatten().filter(near);
    let images = scene.mirror_images.iter().map(|(_, image)| image).filter(near);
    let truth = scene.receivers.truth.iter().flatten().chain(scene.transmitters.truth.iter().flatten().filter(near));
    receivers.iter().chain(transmitters).chain(images).chain(truth).copied().collect()
}

/// The least and the greatest of these coordinates; zeros if there are none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

fn in_the_plane<const D: usize>(ranges: &[(f64, f64); D]) -> Layout {
    let (axes, corner, size) = ([0, 1], [LEFT, TOP], [WIDTH - LEFT - RIGHT, 560.0]);
    let ranges = axes.map(|k| ranges[k]);
    let map = Map::new(Map::scale_to_fit(ranges.map(|(low, high)| high - low), size), ranges, corner, size);
    Layout::of_views(vec![View { axes, map, label: None }], None, TOP + 560.0 + FEET)
}

/// Three views as in a technical drawing: what is in the one from above and the one from the front lies on one
/// vertical line, and what is in the latter and the one from the side on one horizontal line.
fn in_space<const D: usize>(ranges: &[(f64, f64); D]) -> Layout {
    let length = |k: usize| ranges[k].1 - ranges[k].0;
    let longest = (0..D).map(length).fold(0.0, f64::max);
    // A flat network needs room for numbers too.
    let length = |k: usize| length(k).max(FLAT * longest);
    let [across, along] = Map::MARGIN.map(|margin| 2.0 * margin);
    let width = WIDTH - LEFT - BETWEEN - RIGHT;
    let size = [width - across, HEIGHTS - along];
    let scale = Map::scale_to_fit([length(0) + length(1), length(1) + length(2)], size);
    let spare = 0.5 * (width - scale * (length(0) + length(1)) - 2.0 * across);
    let widths = [0, 1].map(|k| scale * length(k) + across + spare);
    let heights = [1, 2].map(|k| (scale * length(k) + along).max(HEIGHT));
    let (right, bottom) = (LEFT + widths[0] + BETWEEN, TOP + heights[0] + FEET);
    let view = |axes: [usize; 2], label: &'static str, corner: [f64; 2], size: [f64; 2]| View {
        axes,
        map: Map::new(scale, axes.map(|k| ranges[k]), corner, size),
        label: Some(label),
    };
    let views = vec![
        view([0, 1], "from above", [LEFT, TOP], [widths[0], heights[0]]),
        view([0, 2], "from the front", [LEFT, bottom], [widths[0], heights[1]]),
        view([1, 2], "from the side", [right, bottom], [widths[1], heights[1]]),
    ];
    let corner = Rectangle { left: right - 15.0, top: TOP, right: WIDTH - 5.0, bottom: TOP + heights[0] + 20.0 };
    Layout::of_views(views, Some(corner), bottom + heights[1] + FEET)
}
