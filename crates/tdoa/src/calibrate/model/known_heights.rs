//! What known positions say of the third coordinate.

use crate::calibrate::options::{CalibrateOptions, MeasuredPosition};
use crate::observations::Node;

/// What is known of heights.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum KnownHeights {
    None,
    One,
    Different,
}

impl KnownHeights {
    /// Those of known positions.
    pub(super) fn of(options: &CalibrateOptions<3>) -> KnownHeights {
        let exact = options.anchors.iter().flatten().map(|p| Some(p[2]));
        let measured = options.positions.iter().map(|known| known.position[2]);
        let mut all = exact.chain(measured).flatten();
        match all.next() {
            None => KnownHeights::None,
            Some(first) if all.all(|z| z == first) => KnownHeights::One,
            Some(_) => KnownHeights::Different,
        }
    }
}

/// Options for the plane with these values, for so many receivers. All fields are named, so that none is forgotten.
pub(super) fn in_plane(options: &CalibrateOptions<3>, receivers: usize) -> CalibrateOptions {
    let mut anchors: Vec<_> = options.anchors.iter().map(|p| p.map(|[x, y, _]| [x, y])).collect();
    let mut positions = Vec::new();
    for known in &options.positions {
        let ([x, y, _], [of_x, of_y, _]) = (known.position, known.sigma);
        let flat = MeasuredPosition { node: known.node, position: [x, y], sigma: [of_x, of_y] };
        match (flat.whole().filter(|_| flat.sigma == [0.0; 2]), known.node) {
            // Exact but for the height.
            (Some(exact), Node::Receiver(i)) if i < receivers => {
                anchors.resize(receivers.max(anchors.len()), None);
                anchors[i] = Some(exact);
            }
            _ if flat.position == [None; 2] => {}
            _ => positions.push(flat),
        }
    }
    CalibrateOptions {
        sigma: options.sigma,
        seed: options.seed,
        search: options.search,
        inlier_threshold: options.inlier_threshold,
        alternative_margin: options.alternative_margin,
        planar_limit: options.planar_limit,
        anchors,
        positions,
        receiver_delays: options.receiver_delays,
        clocks: options.clocks,
        errors: options.errors,
        distances: options.distances.clone(),
        estimate_speed: options.estimate_speed,
    }
}
