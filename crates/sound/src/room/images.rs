//! Images of a source: behind each wall is the same room again, mirrored, and so on without end.

/// Images on one axis: how far each is from the microphone, metres, and how often it is reflected.
type Axis = Vec<(f64, u32)>;

/// Calls `each` with distance, in metres, and number of reflections of a source and its images, as far as they are at
/// most `radius` metres away and have at most `order` reflections. Both points are in the room.
pub(super) fn images(
    extent: [f64; 3],
    source: [f64; 3],
    microphone: [f64; 3],
    radius: f64,
    order: u32,
    mut each: impl FnMut(f64, u32),
) {
    let [xs, ys, zs] = [0, 1, 2].map(|axis| on_axis(extent[axis], source[axis], microphone[axis], radius, order));
    let square = radius * radius;
    for &(x, in_x) in &xs {
        for &(y, in_y) in &ys {
            let flat = x * x + y * y;
            // The nearest come first.
            if flat > square {
                break;
            }
            for &(z, in_z) in &zs {
                let distance = flat + z * z;
                if distance > square {
                    break;
                }
                let reflections = in_x + in_y + in_z;
                if reflections <= order {
                    each(distance.sqrt(), reflections);
                }
            }
        }
    }
}

/// The images on one axis, the nearest first. The room is there from 0 to `side`.
fn on_axis(side: f64, source: f64, microphone: f64, radius: f64, order: u32) -> Axis {
    // Options keep this far below the largest integer.
    let most = ((radius / side).ceil() as u32).saturating_add(1).min(order);
    let rooms = -i64::from(most)..=i64::from(most);
    let image = |room: i64| {
        let at = if room % 2 == 0 { room as f64 * side + source } else { (room + 1) as f64 * side - source };
        ((at - microphone).abs(), room.unsigned_abs() as u32)
    };
    let mut axis: Axis = rooms.map(image).filter(|(distance, _)| *distance <= radius).collect();
    axis.sort_by(|a, b| a.0.total_cmp(&b.0));
    axis
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(radius: f64, order: u32) -> Vec<(f64, u32)> {
        let mut all = Vec::new();
        let (source, microphone) = ([1.0, 2.0, 1.0], [4.0, 2.0, 1.0]);
        images([6.0, 5.0, 3.0], source, microphone, radius, order, |distance, order| all.push((distance, order)));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    #[test]
    fn six_walls_by_hand() {
        // The source is 3 m away; its images are at x = -1 and 11, y = -2 and 8, z = -1 and 5.
        let squares = [9.0, 9.0 + 4.0, 25.0, 9.0 + 16.0, 9.0 + 16.0, 9.0 + 36.0, 49.0];
        let found = all(7.5, 1);
        assert_eq!(found.len(), 7);
        for ((distance, order), square) in found.into_iter().zip(squares) {
            assert!((distance * distance - square).abs() < 1e-12, "{distance}");
            assert_eq!(order, u32::from(square != 9.0));
        }
    }

    #[test]
    fn images_fill_space_as_rooms_do() {
        // One image a room: a sphere of 60 m has 4/3 pi 60^3 / 90 = 10053 of them, give or take its surface.
        let count = all(60.0, u32::MAX).len() as f64;
        assert!((count / 10053.0 - 1.0).abs() < 0.02, "{count}");
    }

    #[test]
    fn orders_have_as_many_images_as_they_should() {
        // Triples of integers with the sum of amounts n: 1, 6, 18, 38 for n = 0 to 3 (4 n^2 + 2).
        let found = all(1e3, 3);
        let of = |order| found.iter().filter(|(_, o)| *o == order).count();
        assert_eq!([of(0), of(1), of(2), of(3)], [1, 6, 18, 38]);
    }
}
