//! When two networks count as one.

use crate::align::align;
use crate::network::Network;
use crate::points::{centroid, distance};
use crate::refine::RefinedNetwork;

/// Two networks are the same if their nodes differ by less than this share of the network's size,
/// as a root mean square.
pub const SAME_NETWORK: f64 = 0.02;

/// The first of each kind of network in a list sorted by objective, at most `most` of them, with
/// the starts of the one that most ended in.
pub(super) fn distinct<const D: usize>(sorted: Vec<RefinedNetwork<D>>, most: usize) -> Vec<RefinedNetwork<D>> {
    let mut kept: Vec<RefinedNetwork<D>> = Vec::new();
    for candidate in sorted {
        if kept.len() == most {
            break;
        }
        match kept.iter_mut().find(|k| same(&k.network, &candidate.network)) {
            // Starts that ended apart may be refined to one network.
            Some(first) => first.starts = first.starts.max(candidate.starts),
            None => kept.push(candidate),
        }
    }
    kept
}

/// The first of each kind of network in a sorted list, with the starts of all of its kind.
pub(super) fn merged<T, const D: usize>(sorted: Vec<T>, of: impl Fn(&mut T) -> &mut RefinedNetwork<D>) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for mut next in sorted {
        let this = of(&mut next);
        match kept.iter_mut().map(&of).find(|first| same(&first.network, &this.network)) {
            Some(first) => first.starts += this.starts,
            None => kept.push(next),
        }
    }
    kept
}

/// Whether two networks agree up to a rigid motion or reflection. Transmitters far outside count in
/// proportion to their distance, since their range is hardly determined.
pub(super) fn same<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    same_receivers(a, b) && same_transmitters(a, b)
}

/// Whether the receivers of two networks agree.
pub(super) fn same_receivers<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    let size = a.size().max(b.size());
    align(&b.receivers, &a.receivers, false).is_none_or(|alignment| alignment.rms <= SAME_NETWORK * size)
}

/// Whether the transmitters of two networks agree once the receivers lie on each other.
pub(super) fn same_transmitters<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    let size = a.size().max(b.size());
    let Some(alignment) = align(&b.receivers, &a.receivers, false) else { return true };
    let centre = centroid(a.receivers.iter());
    let differing = a
        .transmitters
        .iter()
        .zip(&b.transmitters)
        .filter(|(s, t)| {
            let reach = size.max(distance(**s, centre));
            distance(**s, alignment.transform.apply(**t)) > 5.0 * SAME_NETWORK * reach
        })
        .count();
    // One stray transmitter is an ambiguity of that transmitter, not another network.
    differing <= a.transmitters.len() / 10
}
