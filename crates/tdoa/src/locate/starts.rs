//! Where the search for a transmitter begins.

use std::array::from_fn;

use crate::flatness::Plane;
use crate::loss::Loss;
use crate::multilateration::{Located, Sight, cost, polish, receivers, transmitters};
use crate::points::{centroid, distance, spread};

/// Distances from the middle of the receivers, in their spread, at which the search begins beside closed forms.
const AROUND: [f64; 2] = [1.0, 4.0];

/// Minima of the loss: from closed forms, from the other side of the receivers' plane, and from all around, as where the
/// receivers stand in one line or plane closed forms give nothing.
pub(super) fn minima<const D: usize>(sights: &[Sight<D>], is_range: bool, loss: &Loss) -> Vec<Located<D>> {
    let mut found = if is_range { receivers(sights, loss) } else { transmitters(sights, loss) };
    let points: Vec<[f64; D]> = sights.iter().map(|sight| sight.position).collect();
    let (middle, size) = (centroid(points.iter()), spread(points.iter()));
    let start = |position: [f64; D]| {
        let offset = if is_range { 0.0 } else { offset(sights, position) };
        polish(sights, Located { position, offset, cost: cost(sights, position, offset, loss) }, !is_range, loss)
    };
    let mut further = Vec::new();
    for axis in 0..D {
        for far in AROUND.into_iter().flat_map(|far| [far * size, -far * size]) {
            further.push(start(from_fn(|k| middle[k] + if k == axis { far } else { 0.0 })));
        }
    }
    if let Some(plane) = Plane::through(&points) {
        further.extend(
            found.iter().chain(&further).map(|place| start(plane.mirrored(place.position))).collect::<Vec<_>>(),
        );
    }
    for place in further.into_iter().filter(|place| place.cost.is_finite()) {
        if !found.iter().any(|other| distance(other.position, place.position) < loss.scale) {
            found.push(place);
        }
    }
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    found
}

/// The middle one of the offsets that the sights would have.
fn offset<const D: usize>(sights: &[Sight<D>], position: [f64; D]) -> f64 {
    let mut all: Vec<f64> = sights.iter().map(|sight| sight.length - distance(sight.position, position)).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}
