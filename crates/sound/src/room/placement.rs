//! Where microphones and sources are, and when sources sound.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::error::RoomError;
use super::options::{Placement, RoomOptions};

/// Points that are tried for each random one.
const TRIES: usize = 10_000;

/// Least distance of a source from a microphone, metres.
const LEAST: f64 = 0.01;

/// A point, metres.
type Point = [f64; 3];

/// The microphones and the sources.
///
/// # Errors
/// If there is no place for a random one, or a given source is at a given microphone.
pub(super) fn place(options: &RoomOptions, rng: &mut Pcg64Mcg) -> Result<(Vec<Point>, Vec<Point>), RoomError> {
    let given = |placement: &Placement| match placement {
        Placement::Given(points) => points.clone(),
        Placement::Random(_) => Vec::new(),
    };
    let (mut microphones, mut sources) = (given(&options.microphones), given(&options.sources));
    let mut all = [&microphones[..], &sources].concat();
    for (placement, points) in [(&options.microphones, &mut microphones), (&options.sources, &mut sources)] {
        let Placement::Random(count) = *placement else { continue };
        for _ in 0..count {
            let point = free(options, &all, rng)?;
            all.push(point);
            points.push(point);
        }
    }
    for (&a, microphone) in microphones.iter().zip(1..) {
        for (&b, source_number) in sources.iter().zip(1..) {
            if distance(a, b) < LEAST {
                return Err(RoomError::Together { microphone, source_number });
            }
        }
    }
    Ok((microphones, sources))
}

/// A random point that is far enough from walls and from others.
fn free(options: &RoomOptions, others: &[Point], rng: &mut Pcg64Mcg) -> Result<Point, RoomError> {
    let (wall, separation) = (options.wall_distance, options.separation);
    let inner = options.extent.map(|side| side - 2.0 * wall);
    if inner.iter().all(|&side| side > 0.0) {
        for _ in 0..TRIES {
            let point = inner.map(|side| wall + side * rng.random::<f64>());
            // At a wall there would be two sounds at once, at a corner of random numbers.
            let is_inside = (0..3).all(|axis| point[axis] > 0.0 && point[axis] < options.extent[axis]);
            if is_inside && others.iter().all(|&other| distance(point, other) >= separation) {
                return Ok(point);
            }
        }
    }
    let count = options.microphones.count() + options.sources.count();
    Err(RoomError::Full { count, separation, wall_distance: wall })
}

/// The times of emission, seconds.
pub(super) fn times(options: &RoomOptions, rng: &mut Pcg64Mcg) -> Vec<f64> {
    let mut at = |k: usize| options.first + k as f64 * options.interval + options.jitter * rng.random::<f64>();
    options.times.clone().unwrap_or_else(|| (0..options.sources.count()).map(&mut at).collect())
}

/// The distance of two points, metres.
pub(super) fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}
