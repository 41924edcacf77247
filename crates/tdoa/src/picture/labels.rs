//! Names beside their points.

use super::canvas::{Canvas, Rectangle};

/// Where a name may stand from its point: the point of its baseline, and which point that is.
type Place = (f64, f64, &'static str);

/// Places so near that the eye needs no line. The last four are beside the square of an anchor.
const NEAR: [Place; 12] = [
    (8.0, 4.0, "start"),
    (-8.0, 4.0, "end"),
    (0.0, -9.0, "middle"),
    (0.0, 17.0, "middle"),
    (7.0, -6.0, "start"),
    (-7.0, -6.0, "end"),
    (7.0, 14.0, "start"),
    (-7.0, 14.0, "end"),
    (12.0, 4.0, "start"),
    (-12.0, 4.0, "end"),
    (0.0, -13.0, "middle"),
    (0.0, 21.0, "middle"),
];

/// Distances in pixels of further places, which have a line to the point.
const RINGS: [f64; 6] = [24.0, 34.0, 46.0, 60.0, 76.0, 94.0];

/// Directions of these places.
const DIRECTIONS: u32 = 16;

/// Width of a letter in pixels, on average.
const LETTER: f64 = 6.2;

/// Places names so that they cover neither marks nor each other.
pub(super) struct Labels<'a> {
    marks: &'a [Rectangle],
    frame: Rectangle,
    taken: Vec<Rectangle>,
    /// Points of the lines from names to their points, close together.
    lines: Vec<[f64; 2]>,
}

impl<'a> Labels<'a> {
    /// Names among these marks, which stay in a frame. A name for which there is no room is left out.
    pub(super) fn new(marks: &'a [Rectangle], frame: Rectangle) -> Self {
        Labels { marks, frame, taken: Vec::new(), lines: Vec::new() }
    }

    /// Draws names of points: near them where the fewest marks are close, otherwise as near as there is room.
    pub(super) fn place(&mut self, canvas: &mut Canvas, nodes: &[([f64; 2], String)], colour: &str) {
        for (at, name) in nodes {
            let width = LETTER * name.chars().count() as f64;
            let near = NEAR.iter().filter(|place| self.is_free(&extent(*at, **place, width)));
            if let Some(place) = near.min_by_key(|place| self.crowd(*at, &extent(*at, **place, width))) {
                self.write(canvas, *at, *place, name, colour);
                continue;
            }
            let far = RINGS.iter().flat_map(|radius| (0..DIRECTIONS).map(|k| on_ring(*radius, k)));
            let free = |place: &Place| {
                let name = extent(*at, *place, width);
                self.is_free(&name) && !line(*at, &name).any(|p| self.taken.iter().any(|other| other.has(p)))
            };
            let Some(place) = far.into_iter().find(free) else { continue };
            let name_at = extent(*at, place, width);
            canvas.line(*at, name_at.nearest(*at), colour, 0.5, "");
            self.lines.extend(line(*at, &name_at));
            self.write(canvas, *at, place, name, colour);
        }
    }

    fn write(&mut self, canvas: &mut Canvas, at: [f64; 2], place: Place, name: &str, colour: &str) {
        self.taken.push(extent(at, place, LETTER * name.chars().count() as f64));
        let (dx, dy, anchor) = place;
        canvas.name([at[0] + dx, at[1] + dy], anchor, 11.0, colour, name);
    }

    fn is_free(&self, name: &Rectangle) -> bool {
        let met = |others: &[Rectangle]| others.iter().any(|other| other.meets(name));
        self.frame.holds(name) && !met(self.marks) && !met(&self.taken) && !self.lines.iter().any(|p| name.has(*p))
    }

    /// How many marks of other points are so close to a name that it may seem to be theirs.
    fn crowd(&self, at: [f64; 2], name: &Rectangle) -> usize {
        let Rectangle { left, top, right, bottom } = *name;
        let about = Rectangle { left: left - 6.0, top: top - 4.0, right: right + 6.0, bottom: bottom + 4.0 };
        self.marks.iter().filter(|mark| mark.meets(&about) && !mark.has(at)).count()
    }
}

/// A place at this distance in one of the directions, first to the right and then clockwise.
fn on_ring(radius: f64, direction: u32) -> Place {
    let (s, c) = (std::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS)).sin_cos();
    let anchor = if c > 0.3 {
        "start"
    } else if c < -0.3 {
        "end"
    } else {
        "middle"
    };
    // The middle of small letters is three pixels above their baseline.
    (radius * c, radius * s + 3.0, anchor)
}

/// What a name of this width covers.
fn extent(at: [f64; 2], (dx, dy, anchor): Place, width: f64) -> Rectangle {
    let before = match anchor {
        "end" => width,
        "middle" => 0.5 * width,
        _ => 0.0,
    };
    let (left, base) = (at[0] + dx - before, at[1] + dy);
    Rectangle { left, top: base - 9.0, right: left + width, bottom: base + 3.0 }
}

/// Points of the line from a point to a name, two pixels apart.
fn line(at: [f64; 2], name: &Rectangle) -> impl Iterator<Item = [f64; 2]> + use<> {
    let end = name.nearest(at);
    let away = [end[0] - at[0], end[1] - at[1]];
    let steps = (0.5 * away[0].hypot(away[1])).floor().clamp(0.0, 200.0) as u32;
    (0..steps).map(move |k| [0, 1].map(|i| at[i] + away[i] * f64::from(k) / f64::from(steps)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rectangle = Rectangle { left: 0.0, top: 0.0, right: 300.0, bottom: 300.0 };

    /// What is placed of names of three letters at these points, with marks of this half width.
    fn placed(at: &[[f64; 2]], half: f64) -> Vec<Rectangle> {
        let nodes: Vec<_> = at.iter().map(|p| (*p, "abc".to_string())).collect();
        let marks: Vec<Rectangle> = at.iter().map(|p| Rectangle::about(*p, half)).collect();
        let (mut canvas, mut labels) = (Canvas::new(300.0, 300.0), Labels::new(&marks, FRAME));
        labels.place(&mut canvas, &nodes, "#000");
        assert_eq!(canvas.finish().matches("abc").count(), labels.taken.len());
        for (k, name) in labels.taken.iter().enumerate() {
            assert!(FRAME.holds(name) && !labels.taken[..k].iter().any(|other| other.meets(name)));
            assert!(!marks.iter().any(|mark| mark.meets(name)), "{name:?}");
            assert!(!labels.lines.iter().any(|p| name.has(*p)), "{name:?}");
        }
        labels.taken
    }

    #[test]
    fn names_cover_neither_marks_nor_each_other_nor_the_edge() {
        let row = |apart: f64| -> Vec<[f64; 2]> { (0..6).map(|k| [150.0 + apart * f64::from(k), 150.0]).collect() };
        for half in [3.0, 6.0, 9.0] {
            for apart in [0.0, 3.0, 12.0, 20.0] {
                assert_eq!(placed(&row(apart), half).len(), 6);
            }
        }
        // At the right edge a name stands to the left, elsewhere to the right.
        assert!(placed(&[[295.0, 150.0]], 3.0)[0].right < 295.0);
        assert!(placed(&[[150.0, 150.0]], 3.0)[0].left > 150.0);
    }

    #[test]
    fn a_name_without_room_is_left_out() {
        let grid: Vec<[f64; 2]> =
            (0..900).map(|k| [5.0 + f64::from(k % 30) * 10.0, f64::from(k / 30) * 10.0]).collect();
        assert!(placed(&grid, 5.0).len() < 900);
    }
}
