//! The two kinds of figures of the paper, as SVG: histograms and curves on logarithmic axes.

use tdoa::picture::Canvas;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 60.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 76.0;

/// Colours that people with any kind of colour vision can tell apart.
const COLOURS: [&str; 4] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7"];

/// Points joined by lines, or heights of bars, with the name in the legend.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
}

/// What stands around the figure.
pub(super) struct Labels {
    pub(super) title: String,
    pub(super) x: String,
    pub(super) y: String,
}

/// Outlines of histograms over one another: a point is the left end of a bin of this width, and its
/// height.
pub(super) fn histogram(labels: &Labels, width: f64, series: &[Series]) -> String {
    let all = || series.iter().flat_map(|s| &s.points);
    // Empty bins at both ends are left out.
    let filled = || all().filter(|p| p.1 > 0.0);
    let low = filled().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let high = filled().map(|p| p.0 + width).fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
    let top = all().map(|p| p.1).fold(1e-12, f64::max);
    let mut frame = Frame::new(labels, [low, high], [0.0, 1.05 * top], false);
    for (k, series) in series.iter().enumerate() {
        let inside = series.points.iter().filter(|p| p.0 >= low - 1e-9 && p.0 < high - 1e-9);
        let mut path = vec![[low, 0.0]];
        for &(x, height) in inside {
            path.extend([[x, height], [x + width, height]]);
        }
        path.push([high, 0.0]);
        frame.curve(k, &path, 0.18);
        frame.legend(k, &series.name);
    }
    frame.canvas.finish()
}

/// Curves through points, both axes logarithmic (base ten).
pub(super) fn curves(labels: &Labels, series: &[Series]) -> String {
    let logarithms = |points: &[(f64, f64)]| -> Vec<[f64; 2]> {
        points.iter().map(|&(x, y)| [x.log10(), y.log10()]).filter(|p| p.iter().all(|v| v.is_finite())).collect()
    };
    let all: Vec<[f64; 2]> = series.iter().flat_map(|s| logarithms(&s.points)).collect();
    let range = |k: usize| {
        let low = all.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min).floor();
        let high = all.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max).ceil();
        if low < high { [low, high] } else { [0.0, 1.0] }
    };
    let mut frame = Frame::new(labels, range(0), range(1), true);
    for (k, series) in series.iter().enumerate() {
        frame.curve(k, &logarithms(&series.points), 0.0);
        frame.legend(k, &series.name);
    }
    frame.canvas.finish()
}

struct Frame {
    canvas: Canvas,
    x: [f64; 2],
    y: [f64; 2],
}

impl Frame {
    fn new(labels: &Labels, x: [f64; 2], y: [f64; 2], logarithmic: bool) -> Self {
        let mut frame = Frame { canvas: Canvas::new(WIDTH, HEIGHT), x, y };
        let (right, base) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        let middle = 0.5 * (LEFT + right);
        frame.canvas.text([middle, 20.0], "middle", 14.0, &labels.title);
        frame.canvas.text([middle, base + 36.0], "middle", 12.0, &labels.x);
        frame.canvas.text([LEFT - 52.0, TOP - 10.0], "start", 12.0, &labels.y);
        let tick = |value: f64| {
            if logarithmic { format!("1e{value}") } else { super::statistics::short(value) }
        };
        for value in ticks(x, logarithmic) {
            let at = frame.at([value, y[0]]);
            frame.line(at, [at[0], TOP], "#ddd");
            frame.canvas.text([at[0], base + 17.0], "middle", 11.0, &tick(value));
        }
        for value in ticks(y, logarithmic) {
            let at = frame.at([x[0], value]);
            frame.line(at, [right, at[1]], "#ddd");
            frame.canvas.text([LEFT - 6.0, at[1] + 4.0], "end", 11.0, &tick(value));
        }
        frame.line([LEFT, base], [right, base], "#222");
        frame.line([LEFT, base], [LEFT, TOP], "#222");
        frame
    }

    fn at(&self, p: [f64; 2]) -> [f64; 2] {
        let share = |k: usize, range: [f64; 2]| (p[k] - range[0]) / (range[1] - range[0]);
        let (x, y) = (share(0, self.x), share(1, self.y));
        [LEFT + x * (WIDTH - RIGHT - LEFT), HEIGHT - BOTTOM - y * (HEIGHT - BOTTOM - TOP)]
    }

    fn curve(&mut self, k: usize, points: &[[f64; 2]], fill: f64) {
        let points: Vec<[f64; 2]> = points.iter().map(|&p| self.at(p)).collect();
        self.canvas.polyline(&points, COLOURS[k % COLOURS.len()], fill);
    }

    fn legend(&mut self, k: usize, name: &str) {
        let (x, y) = (LEFT + 225.0 * (k % 2) as f64, HEIGHT - 24.0 + 16.0 * (k / 2) as f64);
        self.line([x, y - 4.0], [x + 18.0, y - 4.0], COLOURS[k % COLOURS.len()]);
        self.canvas.text([x + 24.0, y], "start", 12.0, name);
    }

    fn line(&mut self, a: [f64; 2], b: [f64; 2], colour: &str) {
        self.canvas.line(a, b, colour, 1.0, "");
    }
}

/// Round numbers in a range, at most ten or so; whole decades on a logarithmic axis.
fn ticks(range: [f64; 2], logarithmic: bool) -> Vec<f64> {
    let extent = range[1] - range[0];
    let power = 10f64.powf((extent / 8.0).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|step| extent / step <= 8.0).unwrap_or(extent);
    let step = if logarithmic { step.ceil().max(1.0) } else { step };
    let (first, last) = ((range[0] / step - 1e-9).ceil() as i64, (range[1] / step + 1e-9).floor() as i64);
    (first..=last).map(|k| k as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels() -> Labels {
        Labels { title: "a < b".into(), x: "x".into(), y: "y".into() }
    }

    #[test]
    fn figures_are_whole_and_finite() {
        let series = [Series { name: "one".into(), points: vec![(1.0, 0.0), (2.0, 4.0), (3.0, 1.0), (4.0, 0.0)] }];
        let bars = histogram(&labels(), 1.0, &series);
        assert!(bars.starts_with("<svg ") && bars.ends_with("</svg>\n") && bars.contains("a &lt; b"));
        // The empty bins are left out: the corners of two bars and both ends.
        let points = bars.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
        assert_eq!(points.split(' ').count(), 6);
        for svg in [bars, histogram(&labels(), 1.0, &[]), curves(&labels(), &series), curves(&labels(), &[])] {
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks([0.0, 50.0], false), [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]);
        assert_eq!(ticks([-6.0, -1.0], true), [-6.0, -5.0, -4.0, -3.0, -2.0, -1.0]);
    }
}
