//! One view of a scene: the network along a pair of axes, with ellipses, names, outliers and, if
//! the truth is given, the truth and error vectors.

use super::canvas::{Canvas, Map, Rectangle, nice};
use super::labels::Labels;
use super::scene::{Nodes, Scene};
use crate::minimal::NodeKind;
use crate::quantity::coordinate;

/// Width of the picture.
pub(super) const WIDTH: f64 = 900.0;

/// The colour of receivers.
pub(super) const BLUE: &str = "#0072B2";
/// The colour of transmitters.
pub(super) const ORANGE: &str = "#D55E00";
/// The colour of outliers.
pub(super) const PINK: &str = "#CC79A7";

// Half the widths of marks, in pixels.
pub(super) const TRIANGLE: f64 = 6.0;
pub(super) const DISC: f64 = 3.0;
pub(super) const SQUARE: f64 = 9.0;
pub(super) const RING: f64 = 3.5;
pub(super) const CROSS: f64 = 5.0;

/// Most nodes of a kind that get their names.
const NAMED: usize = 80;

/// Most outliers that are drawn as lines.
const OUTLIERS: usize = 200;

/// Semi-axis in pixels from which on an ellipse would be a wash of colour, and is not drawn.
const TOO_LARGE: f64 = 2.0 * WIDTH;

/// A pair of axes and its box in the picture.
pub(super) struct View {
    /// Which coordinate is to the right and which is upwards.
    pub(super) axes: [usize; 2],
    pub(super) map: Map,
    /// From where it is seen, if the view is one of several.
    pub(super) label: Option<&'static str>,
}

impl View {
    /// The two coordinates of a point.
    pub(super) fn point<const D: usize>(&self, p: [f64; D]) -> [f64; 2] {
        self.axes.map(|k| p[k])
    }

    fn to<const D: usize>(&self, p: [f64; D]) -> [f64; 2] {
        self.map.to(self.point(p))
    }

    /// The block of a covariance that belongs to the two axes. The ellipse of the block is the
    /// shadow of the ellipsoid, with the same radius.
    fn shadow<const D: usize>(&self, covariance: &[[f64; D]; D]) -> [[f64; 2]; 2] {
        let [a, b] = self.axes;
        [[covariance[a][a], covariance[a][b]], [covariance[a][b], covariance[b][b]]]
    }

    /// The semi-axes of an ellipse in the picture, the larger one first.
    pub(super) fn semiaxes<const D: usize>(&self, covariance: &[[f64; D]; D], radius: f64) -> [f64; 2] {
        variances(self.shadow(covariance)).map(|variance| radius * variance.sqrt() * self.map.scale)
    }

    /// Whether an ellipse about a point lies within the view; `None` if it is so large that it is not drawn.
    pub(super) fn ellipse_fits<const D: usize>(
        &self,
        at: [f64; D],
        covariance: &[[f64; D]; D],
        radius: f64,
    ) -> Option<bool> {
        if self.semiaxes(covariance, radius)[0] >= TOO_LARGE {
            return None;
        }
        let [dx, dy] = self.axes.map(|k| radius * covariance[k][k].sqrt() * self.map.scale);
        let [x, y] = self.to(at);
        Some(self.map.frame().holds(&Rectangle { left: x - dx, top: y - dy, right: x + dx, bottom: y + dy }))
    }

    /// Draws the view. Nodes are those that `shows` lets through, and ellipses have this radius in
    /// standard deviations.
    pub(super) fn draw<const D: usize>(
        &self,
        canvas: &mut Canvas,
        scene: &Scene<D>,
        shows: impl Fn(&[f64; D]) -> bool,
        radius: f64,
    ) {
        self.grid(canvas);
        canvas.within(&self.map.frame());
        self.outliers(canvas, scene, &shows);
        self.nodes(canvas, scene, &shows, radius);
        self.truth(canvas, scene, &shows);
        canvas.whole();
        self.names(canvas, scene, &shows);
    }

    fn outliers<const D: usize>(&self, canvas: &mut Canvas, scene: &Scene<D>, shows: impl Fn(&[f64; D]) -> bool) {
        let ends = scene.outliers.iter().filter_map(|&(i, j)| {
            let (receiver, transmitter) = (scene.receivers.positions[i]?, scene.transmitters.positions[j]?);
            shows(&transmitter).then_some((receiver, transmitter))
        });
        for (receiver, transmitter) in ends.take(OUTLIERS) {
            canvas.line(self.to(receiver), self.to(transmitter), PINK, 1.0, "5 3");
        }
    }

    fn nodes<const D: usize>(
        &self,
        canvas: &mut Canvas,
        scene: &Scene<D>,
        shows: impl Fn(&[f64; D]) -> bool,
        radius: f64,
    ) {
        for (kind, image) in scene.mirror_images.iter().filter(|(_, image)| shows(image)) {
            let colour = if *kind == NodeKind::Receivers { BLUE } else { ORANGE };
            canvas.ring(self.to(*image), RING, colour);
        }
        let nodes = scene.transmitters.positions.iter().zip(&scene.transmitters.covariances);
        for (position, covariance) in nodes {
            if let Some(p) = position.filter(&shows) {
                self.ellipse(canvas, p, covariance, radius, ORANGE);
                canvas.circle(self.to(p), DISC, ORANGE);
            }
        }
        let nodes = scene.receivers.positions.iter().zip(&scene.receivers.covariances).zip(&scene.anchored);
        for ((position, covariance), anchored) in nodes {
            if let Some(p) = position.filter(&shows) {
                self.ellipse(canvas, p, covariance, radius, BLUE);
                canvas.triangle(self.to(p), TRIANGLE, BLUE);
                if *anchored {
                    canvas.square(self.to(p), SQUARE);
                }
            }
        }
    }

    fn ellipse<const D: usize>(
        &self,
        canvas: &mut Canvas,
        at: [f64; D],
        covariance: &Option<[[f64; D]; D]>,
        radius: f64,
        colour: &str,
    ) {
        let Some(covariance) = covariance else { return };
        let axes = self.semiaxes(covariance, radius);
        let [[xx, xy], [_, yy]] = self.shadow(covariance);
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        // Below a pixel nothing is seen.
        if axes[0] < TOO_LARGE && axes[0] > 0.5 {
            canvas.ellipse(self.to(at), axes, -angle.to_degrees(), colour);
        }
    }

    fn truth<const D: usize>(&self, canvas: &mut Canvas, scene: &Scene<D>, shows: impl Fn(&[f64; D]) -> bool) {
        let receivers = scene.receivers.positions.iter().zip(&scene.receivers.truth);
        let transmitters = scene.transmitters.positions.iter().zip(&scene.transmitters.truth);
        for (found, known) in receivers.chain(transmitters.filter(|(p, _)| p.as_ref().is_some_and(&shows))) {
            if let (Some(found), Some(known)) = (found, known) {
                canvas.line(self.to(*found), self.to(*known), "#000", 1.5, "");
                canvas.cross(self.to(*known), CROSS);
            }
        }
    }

    fn names<const D: usize>(&self, canvas: &mut Canvas, scene: &Scene<D>, shows: impl Fn(&[f64; D]) -> bool) {
        let named = |nodes: &Nodes<D>| -> Vec<([f64; 2], String)> {
            let nodes = nodes.names.iter().zip(&nodes.positions).filter_map(|(name, p)| Some(((*p)?, name.clone())));
            nodes.filter(|(p, _)| shows(p)).map(|(p, name)| (self.to(p), name)).collect()
        };
        let receivers = named(&scene.receivers);
        let transmitters = named(&scene.transmitters);
        let marks = self.marks(scene, &shows);
        let mut labels = Labels::new(&marks, self.map.frame());
        labels.place(canvas, &receivers[..receivers.len().min(NAMED)], BLUE);
        if transmitters.len() <= NAMED {
            labels.place(canvas, &transmitters, ORANGE);
        }
    }

    /// What names must leave free: the boxes of all marks.
    fn marks<const D: usize>(&self, scene: &Scene<D>, shows: impl Fn(&[f64; D]) -> bool) -> Vec<Rectangle> {
        let mut marks = Vec::new();
        let mut mark = |p: Option<[f64; D]>, half: f64| {
            marks.extend(p.filter(&shows).map(|p| Rectangle::about(self.to(p), half)));
        };
        for (position, anchored) in scene.receivers.positions.iter().zip(&scene.anchored) {
            mark(*position, if *anchored { SQUARE } else { TRIANGLE });
        }
        scene.transmitters.positions.iter().for_each(|p| mark(*p, DISC));
        scene.mirror_images.iter().for_each(|(_, image)| mark(Some(*image), RING));
        scene.receivers.truth.iter().chain(&scene.transmitters.truth).for_each(|p| mark(*p, CROSS));
        marks
    }

    /// A frame with a grid, square unless the view is flat, numbers in metres, and the label, if any, above it.
    fn grid(&self, canvas: &mut Canvas) {
        let frame = self.map.frame();
        let [right, up] = self.axes.map(|k| ["x", "y", "z"].get(k).copied().unwrap_or_default());
        let step = self.step();
        for value in ticks(self.map.range(0), step) {
            let [x, _] = self.map.to([value, 0.0]);
            canvas.line([x, frame.top], [x, frame.bottom], "#ddd", 0.7, "");
            canvas.text([x, frame.bottom + 16.0], "middle", 11.0, &tick(value, step));
        }
        let step = self.upward_step(step);
        for value in ticks(self.map.range(1), step) {
            let [_, y] = self.map.to([0.0, value]);
            canvas.line([frame.left, y], [frame.right, y], "#ddd", 0.7, "");
            canvas.text([frame.left - 6.0, y + 4.0], "end", 11.0, &tick(value, step));
        }
        canvas.outline(&frame, "#888");
        canvas.text([0.5 * (frame.left + frame.right), frame.bottom + 32.0], "middle", 12.0, &format!("{right} (m)"));
        canvas.text([frame.left - 6.0, frame.top - 10.0], "end", 12.0, &format!("{up} (m)"));
        if let Some(label) = self.label {
            canvas.text([frame.left + 12.0, frame.top - 10.0], "start", 13.0, label);
        }
    }

    /// Metres between two level lines: those between upright ones, or fewer, so that a flat view has three at least.
    fn upward_step(&self, step: f64) -> f64 {
        let (low, high) = self.map.range(1);
        if (high - low) / step >= 3.0 { step } else { nice((high - low) / 3.0) }
    }

    /// Metres between two upright lines of the grid: at least the width of their numbers.
    fn step(&self) -> f64 {
        let (low, high) = self.map.range(0);
        let fits = |step: &f64| {
            let letters = [low, high].map(|value| tick(value, *step).chars().count());
            6.2 * letters[0].max(letters[1]) as f64 + 8.0 <= step * self.map.scale
        };
        let steps = [100.0, 200.0, 400.0, 800.0].map(|pixels| nice(pixels / self.map.scale));
        steps.into_iter().find(fits).unwrap_or(steps[3])
    }
}

/// The multiples of a step in a range; none if that makes no sense.
fn ticks((low, high): (f64, f64), step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step).ceil();
    // At coordinates so large that doubles are farther apart than the steps, there would be more.
    let count = ((high / step).floor() - first + 1.0).clamp(0.0, 50.0);
    let count = if step > 0.0 && step.is_finite() && first.is_finite() { count as usize } else { 0 };
    (0..count).map(move |k| (first + k as f64) * step)
}

/// A multiple of a step as text.
fn tick(value: f64, step: f64) -> String {
    // The logarithm of a power of ten may be a little less than the whole number.
    coordinate(value, (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize)
}

/// The factor by which to enlarge ellipses with these longer semi-axes in pixels.
pub(super) fn magnification(axes: impl Iterator<Item = f64>) -> f64 {
    let mut axes: Vec<f64> = axes.collect();
    axes.sort_by(f64::total_cmp);
    let (Some(middle), Some(large)) = (axes.get(axes.len() / 2), axes.get(axes.len() * 9 / 10)) else { return 1.0 };
    // Twice the size of the triangles; the largest ones must not cover the picture.
    let factor = (20.0 / middle).min(60.0 / large);
    if *middle > 10.0 || !factor.is_finite() { 1.0 } else { nice(factor.max(1.0)) }
}

/// The variances along the axes of an ellipse, the larger one first.
fn variances([[xx, xy], [_, yy]]: [[f64; 2]; 2]) -> [f64; 2] {
    let root = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    [0.5 * (xx + yy) + root, 0.5 * (xx + yy) - root].map(|variance| variance.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_multiples_of_the_step() {
        let shown = |range, step| ticks(range, step).map(|value| tick(value, step)).collect::<Vec<_>>();
        assert_eq!(shown((-0.25, 0.31), 0.1), ["-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(shown((3.0, 41.0), 20.0), ["20", "40"]);
        assert_eq!(shown((1e-3, 3e-3), 1e-3), ["0.001", "0.002", "0.003"]);
        // No endless lists.
        for (range, step) in [((0.0, 1.0), 0.0), ((0.0, f64::INFINITY), 1.0), ((1e300, 2e300), 1e-9)] {
            assert!(ticks(range, step).count() <= 50);
        }
        assert_eq!(ticks((f64::NAN, f64::NAN), 1.0).count() + ticks((0.0, 1.0), f64::NAN).count(), 0);
    }
}
