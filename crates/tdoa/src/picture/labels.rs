//! Names beside their points.

use super::canvas::{Canvas, Rectangle};

/// Where a name may stand from its point: the point of its baseline, and which point that is.
type Place = (f64, f64, &'static str);

const BESIDE: [Place; 4] = [(8.0, 4.0, "start"), (-8.0, 4.0, "end"), (0.0, -9.0, "middle"), (0.0, 17.0, "middle")];

/// More places, for names that must not cover each other. The last ones have a line to the point.
const FURTHER: [Place; 12] = [
    (7.0, -6.0, "start"),
    (-7.0, -6.0, "end"),
    (7.0, 14.0, "start"),
    (-7.0, 14.0, "end"),
    (20.0, -16.0, "start"),
    (-20.0, -16.0, "end"),
    (20.0, 24.0, "start"),
    (-20.0, 24.0, "end"),
    (0.0, -26.0, "middle"),
    (0.0, 34.0, "middle"),
    (12.0, -32.0, "start"),
    (12.0, 40.0, "start"),
];
const WITH_LINES: usize = 8;

/// Places names on the side of their points where the fewest other points are close.
pub(super) struct Labels<'a> {
    points: &'a [[f64; 2]],
    frame: Rectangle,
    taken: Vec<Rectangle>,
}

impl<'a> Labels<'a> {
    /// Names among these points. They stay in the frame, and none covers another: a name for which
    /// there is no room is left out.
    pub(super) fn new(points: &'a [[f64; 2]], frame: Rectangle) -> Self {
        Labels { points, frame, taken: Vec::new() }
    }

    pub(super) fn place(&mut self, canvas: &mut Canvas, nodes: &[([f64; 2], String)], colour: &str) {
        for (at, name) in nodes {
            let width = 6.2 * name.chars().count() as f64;
            let places = BESIDE.iter().chain(&FURTHER).enumerate();
            let free = places.filter(|(_, place)| self.is_free(&extent(*at, **place, width)));
            let Some((k, place)) = free.min_by_key(|(_, place)| self.crowd(*at, **place, width)) else { continue };
            self.taken.push(extent(*at, *place, width));
            let (dx, dy, anchor) = *place;
            let end = [at[0] + dx, at[1] + dy];
            if k >= BESIDE.len() + FURTHER.len() - WITH_LINES {
                canvas.line(*at, [end[0], end[1] - if dy > 0.0 { 9.0 } else { -2.0 }], colour, 0.5, "");
            }
            canvas.coloured(end, anchor, 11.0, colour, name);
        }
    }

    fn is_free(&self, name: &Rectangle) -> bool {
        self.frame.holds(name) && !self.taken.iter().any(|other| other.meets(name))
    }

    /// How many points a name would cover, or nearly so.
    fn crowd(&self, at: [f64; 2], (dx, dy, anchor): Place, width: f64) -> usize {
        let left = left(at, (dx, dy, anchor), width);
        let covers = |p: &&[f64; 2]| {
            p[0] > left - 6.0 && p[0] < left + width + 6.0 && p[1] > at[1] + dy - 15.0 && p[1] < at[1] + dy + 7.0
        };
        self.points.iter().filter(covers).count()
    }
}

fn left(at: [f64; 2], (dx, _, anchor): Place, width: f64) -> f64 {
    at[0] + dx
        - match anchor {
            "end" => width,
            "middle" => 0.5 * width,
            _ => 0.0,
        }
}

/// What a name of this width covers.
fn extent(at: [f64; 2], place: Place, width: f64) -> Rectangle {
    let (left, base) = (left(at, place, width), at[1] + place.1);
    Rectangle { left, top: base - 9.0, right: left + width, bottom: base + 3.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is placed of names of three letters at these points.
    fn placed(at: &[[f64; 2]], frame: Rectangle) -> Vec<Rectangle> {
        let nodes: Vec<_> = at.iter().map(|p| (*p, "abc".to_string())).collect();
        let (mut canvas, mut labels) = (Canvas::new(300.0, 300.0), Labels::new(at, frame));
        labels.place(&mut canvas, &nodes, "#000");
        assert_eq!(canvas.finish().matches("abc").count(), labels.taken.len());
        labels.taken
    }

    #[test]
    fn names_in_a_frame_cover_neither_each_other_nor_its_edge() {
        let frame = Rectangle { left: 0.0, top: 0.0, right: 300.0, bottom: 300.0 };
        let near: Vec<[f64; 2]> = (0..6).map(|k| [150.0 + 3.0 * f64::from(k), 150.0]).collect();
        let names = placed(&near, frame);
        assert_eq!(names.len(), 6);
        for (k, name) in names.iter().enumerate() {
            assert!(frame.holds(name) && !names[..k].iter().any(|other| other.meets(name)));
        }
        // At the right edge a name stands to the left, elsewhere to the right.
        assert!(placed(&[[295.0, 150.0]], frame)[0].right < 295.0);
        assert!(placed(&[[150.0, 150.0]], frame)[0].left > 150.0);
        // Sixteen places are not enough for thirty names.
        assert!(placed(&[[150.0, 150.0]; 30], frame).len() < 30);
    }
}
