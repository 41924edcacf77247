//! The few SVG shapes that a picture needs.

use std::fmt::Write;

/// From metres to a box of the picture, y upwards.
pub(super) struct Map {
    pub(super) scale: f64,
    centre: [f64; 2],
    middle: [f64; 2],
    half: [f64; 2],
}

impl Map {
    /// Room for names between the outermost points and the edges of the box.
    pub(super) const MARGIN: [f64; 2] = [50.0, 25.0];

    /// The largest scale at which these lengths, to the right and upwards, fit into a box.
    pub(super) fn scale_to_fit(lengths: [f64; 2], size: [f64; 2]) -> f64 {
        let fits = |k: usize| (size[k] - 2.0 * Self::MARGIN[k]) / lengths[k].max(1e-9);
        fits(0).min(fits(1)).min(1e9)
    }

    /// At this scale, the middle of these ranges, to the right and upwards, in the middle of a box.
    pub(super) fn new(scale: f64, ranges: [(f64, f64); 2], corner: [f64; 2], size: [f64; 2]) -> Map {
        Map {
            scale,
            centre: ranges.map(|(low, high)| 0.5 * (low + high)),
            middle: [corner[0] + 0.5 * size[0], corner[1] + 0.5 * size[1]],
            half: [0.5 * size[0], 0.5 * size[1]],
        }
    }

    pub(super) fn to(&self, p: [f64; 2]) -> [f64; 2] {
        let x = self.middle[0] + (p[0] - self.centre[0]) * self.scale;
        [x, self.middle[1] - (p[1] - self.centre[1]) * self.scale]
    }

    pub(super) fn shows(&self, p: [f64; 2]) -> bool {
        let at = self.to(p);
        (0..2).all(|k| (at[k] - self.middle[k]).abs() <= self.half[k])
    }

    /// Moves the box further down in the picture.
    pub(super) fn down(&mut self, pixels: f64) {
        self.middle[1] += pixels;
    }

    /// The metres that the box shows to the right (0) or upwards (1).
    pub(super) fn range(&self, k: usize) -> (f64, f64) {
        let reach = self.half[k] / self.scale;
        (self.centre[k] - reach, self.centre[k] + reach)
    }

    /// The box.
    pub(super) fn frame(&self) -> Rectangle {
        let [[x, y], [dx, dy]] = [self.middle, self.half];
        Rectangle { left: x - dx, top: y - dy, right: x + dx, bottom: y + dy }
    }
}

/// A rectangle of the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rectangle {
    /// A square about a point.
    pub(super) fn about([x, y]: [f64; 2], half: f64) -> Self {
        Rectangle { left: x - half, top: y - half, right: x + half, bottom: y + half }
    }

    /// The point of this rectangle that is nearest to another point.
    pub(super) fn nearest(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x.max(self.left).min(self.right), y.max(self.top).min(self.bottom)]
    }

    /// Whether a point lies within.
    pub(super) fn has(&self, p: [f64; 2]) -> bool {
        self.nearest(p) == p
    }

    /// Whether two rectangles have an area in common.
    pub(super) fn meets(&self, other: &Rectangle) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    /// Whether the other one lies within this one.
    pub(super) fn holds(&self, other: &Rectangle) -> bool {
        self.left <= other.left && other.right <= self.right && self.top <= other.top && other.bottom <= self.bottom
    }
}

/// The largest of 1, 2, 5 times a power of ten that is at most `length`.
pub(super) fn nice(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    let step = [5.0, 2.0, 1.0].into_iter().find(|step| step * power <= length).unwrap_or(1.0);
    // 2 * 10^-2 is not the double nearest to 0.02; printing and reading makes it so.
    format!("{:.1e}", step * power).parse().unwrap_or(step * power)
}

/// A picture in SVG, drawn shape by shape: lengths in pixels, x to the right, y downwards.
///
/// ```
/// let mut canvas = tdoa::picture::Canvas::new(100.0, 50.0);
/// canvas.line([10.0, 40.0], [90.0, 40.0], "#222", 1.0, "");
/// canvas.text([50.0, 30.0], "middle", 12.0, "80 px");
/// assert!(canvas.finish().starts_with("<svg"));
/// ```
#[derive(Debug, Clone)]
pub struct Canvas {
    body: String,
    width: f64,
    height: f64,
}

impl Canvas {
    /// An empty white picture.
    pub fn new(width: f64, height: f64) -> Self {
        Canvas { body: String::new(), width, height }
    }

    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    /// A straight line; `dashes` as SVG has them, such as `5 3`, or empty.
    pub fn line(&mut self, a: [f64; 2], b: [f64; 2], colour: &str, width: f64, dashes: &str) {
        self.add(format_args!(
            r#"<line x1="{:.2}" y1="{:.2}" x2="{:.2}" y2="{:.2}" stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}"/>"#,
            a[0], a[1], b[0], b[1]
        ));
    }

    /// Lines from point to point. The area that they enclose is filled with this opacity, 0 to 1.
    pub fn polyline(&mut self, points: &[[f64; 2]], colour: &str, fill: f64) {
        let list: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.add(format_args!(
            r#"<polyline points="{}" fill="{colour}" fill-opacity="{fill}" stroke="{colour}" stroke-width="1.5"/>"#,
            list.join(" ")
        ));
    }

    pub(super) fn circle(&mut self, at: [f64; 2], radius: f64, colour: &str) {
        self.add(format_args!(
            r#"<circle class="transmitter" cx="{:.2}" cy="{:.2}" r="{radius}" fill="{colour}"/>"#,
            at[0], at[1]
        ));
    }

    /// The outline of a circle about a point.
    pub(super) fn ring(&mut self, at: [f64; 2], radius: f64, colour: &str) {
        self.add(format_args!(
            r#"<circle class="mirror" cx="{:.2}" cy="{:.2}" r="{radius}" fill="none" stroke="{colour}"/>"#,
            at[0], at[1]
        ));
    }

    pub(super) fn triangle(&mut self, at: [f64; 2], radius: f64, colour: &str) {
        let (dx, dy) = (0.866 * radius, 0.5 * radius);
        self.add(format_args!(
            r#"<path class="receiver" d="M{:.2} {:.2}l{:.2} {:.2}h{:.2}z" fill="{colour}"/>"#,
            at[0],
            at[1] - radius,
            dx,
            radius + dy,
            -2.0 * dx
        ));
    }

    /// The outline of a square about a point.
    pub(super) fn square(&mut self, at: [f64; 2], half: f64) {
        let side = 2.0 * half;
        self.add(format_args!(
            r##"<rect class="anchor" x="{:.2}" y="{:.2}" width="{side}" height="{side}" fill="none" stroke="#000"/>"##,
            at[0] - half,
            at[1] - half
        ));
    }

    pub(super) fn cross(&mut self, at: [f64; 2], radius: f64) {
        let d = 2.0 * radius;
        self.add(format_args!(
            r##"<path class="truth" d="M{:.2} {:.2}h{d}m{:.2} {:.2}v{d}" stroke="#000" stroke-width="1.5" fill="none"/>"##,
            at[0] - radius,
            at[1],
            -radius,
            -radius
        ));
    }

    pub(super) fn ellipse(&mut self, at: [f64; 2], axes: [f64; 2], degrees: f64, colour: &str) {
        self.add(format_args!(
            r#"<ellipse transform="translate({:.2} {:.2}) rotate({degrees:.2})" rx="{:.2}" ry="{:.2}" fill="{colour}" fill-opacity="0.15" stroke="{colour}" stroke-opacity="0.6"/>"#,
            at[0], at[1], axes[0], axes[1]
        ));
    }

    pub(super) fn rectangle(&mut self, corner: [f64; 2], size: [f64; 2], colour: &str) {
        self.add(format_args!(
            r#"<rect x="{:.2}" y="{:.2}" width="{:.2}" height="{:.2}" fill="{colour}"/>"#,
            corner[0], corner[1], size[0], size[1]
        ));
    }

    /// Text. The point is the `start`, `middle` or `end` of its baseline.
    pub fn text(&mut self, at: [f64; 2], anchor: &str, size: f64, text: &str) {
        let text = escape(text);
        self.add(format_args!(
            r##"<text x="{:.2}" y="{:.2}" text-anchor="{anchor}" font-size="{size}" fill="#222">{text}</text>"##,
            at[0], at[1]
        ));
    }

    /// Text in a colour, with a light edge against the lines below it.
    pub(super) fn name(&mut self, at: [f64; 2], anchor: &str, size: f64, colour: &str, text: &str) {
        let text = escape(text);
        self.add(format_args!(
            r##"<text class="name" x="{:.2}" y="{:.2}" text-anchor="{anchor}" font-size="{size}" fill="{colour}" stroke="#fff" stroke-opacity="0.7" stroke-width="2.5" paint-order="stroke">{text}</text>"##,
            at[0], at[1]
        ));
    }

    /// The outline of a rectangle.
    pub(super) fn outline(&mut self, r: &Rectangle, colour: &str) {
        self.add(format_args!(
            r#"<rect x="{:.2}" y="{:.2}" width="{:.2}" height="{:.2}" fill="none" stroke="{colour}"/>"#,
            r.left,
            r.top,
            r.right - r.left,
            r.bottom - r.top
        ));
    }

    /// Cuts off what lies outside a rectangle, up to [`Canvas::whole`].
    pub(super) fn within(&mut self, r: &Rectangle) {
        let [x, y, width, height] = [r.left, r.top, r.right - r.left, r.bottom - r.top].map(f64::round);
        // Pictures in one page share their names; under this one all have the same rectangle.
        let name = format!("tdoa-{x}-{y}-{width}-{height}");
        self.add(format_args!(
            r##"<clipPath id="{name}"><rect x="{x}" y="{y}" width="{width}" height="{height}"/></clipPath>
<g clip-path="url(#{name})">"##
        ));
    }

    /// Ends what [`Canvas::within`] began.
    pub(super) fn whole(&mut self) {
        self.add(format_args!("</g>"));
    }

    /// The whole text of the picture.
    pub fn finish(self) -> String {
        let (width, height) = (self.width, self.height);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// Text that is safe between tags and in attributes; control characters are not allowed in XML.
pub(crate) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            c if c.is_control() => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn map_fits_and_turns_y_up() {
        let size = [500.0, 250.0];
        let map = Map::new(Map::scale_to_fit([4.0, 2.0], size), [(0.0, 4.0), (0.0, 2.0)], [0.0, 0.0], size);
        assert!(map.shows([0.0, 0.0]) && map.shows([4.0, 2.0]) && !map.shows([9.0, 0.0]));
        assert!(map.to([0.0, 2.0])[1] < map.to([0.0, 0.0])[1]);
        assert!((map.scale - 100.0).abs() < 1e-9);
        assert_eq!([map.range(0), map.range(1)], [(-0.5, 4.5), (-0.25, 2.25)]);
    }

    #[test]
    fn rectangles_that_touch_have_no_area_in_common() {
        let at = |left: f64| Rectangle { left, top: 0.0, right: left + 2.0, bottom: 1.0 };
        assert!(at(0.0).meets(&at(1.0)) && at(1.0).meets(&at(0.0)) && !at(0.0).meets(&at(2.0)));
        assert!(at(0.0).holds(&at(0.0)) && !at(0.0).holds(&at(0.5)));
        assert!(at(0.0).has([1.0, 0.5]) && !at(0.0).has([2.5, 0.5]));
        assert_eq!(at(0.0).nearest([2.5, 0.5]), [2.0, 0.5]);
    }

    #[test]
    fn nice_lengths() {
        assert_eq!([nice(7.3), nice(0.024), nice(1.0), nice(4900.0)], [5.0, 0.02, 1.0, 2000.0]);
    }
}
