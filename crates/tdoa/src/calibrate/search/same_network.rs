//! When two networks count as one.

use crate::align::align;
use crate::flatness::{FLAT, Plane, flatness};
use crate::network::Network;
use crate::points::{centroid, distance};
use crate::refine::RefinedNetwork;

/// Two networks are the same if their nodes differ by less than this share of the network's size,
/// as a root mean square.
pub const SAME_NETWORK: f64 = 0.02;

/// The first of each kind of network in a list sorted by objective, at most `most` of them, with
/// the starts of the one that most ended in.
pub(crate) fn distinct<const D: usize>(sorted: Vec<RefinedNetwork<D>>, most: usize) -> Vec<RefinedNetwork<D>> {
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
pub(crate) fn merged<T, const D: usize>(sorted: Vec<T>, of: impl Fn(&mut T) -> &mut RefinedNetwork<D>) -> Vec<T> {
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
pub(crate) fn same<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    same_receivers(a, b) && same_transmitters(a, b)
}

/// Whether the receivers of two networks agree.
pub(crate) fn same_receivers<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    fits([&a.receivers, &b.receivers], a.size().max(b.size()))
}

/// Whether the transmitters of two networks agree once the receivers lie on each other. Where the receivers
/// of one lie in a plane of space, they do so in two ways.
pub(crate) fn same_transmitters<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    let size = a.size().max(b.size());
    agree([&a.receivers, &b.receivers], [&a.transmitters, &b.transmitters], size, |_, _| None)
}

/// Whether two networks agree, but for the sides of the plane of all nodes of the other kind on which
/// nodes lie.
pub(crate) fn same_but_for_sides<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    let size = a.size().max(b.size());
    let by = |fixed: [&[[f64; D]]; 2], free: [&[[f64; D]]; 2]| {
        let Some(plane) = flat_plane(fixed[0]) else { return false };
        fits(fixed, size) && agree(fixed, free, size, |_, p| Some(plane.mirrored(p)))
    };
    let (receivers, transmitters): ([&[_]; 2], [&[_]; 2]) =
        ([&a.receivers, &b.receivers], [&a.transmitters, &b.transmitters]);
    same(a, b) || by(receivers, transmitters) || by(transmitters, receivers)
}

/// The plane of points that lie nearly in one.
fn flat_plane<const D: usize>(points: &[[f64; D]]) -> Option<Plane<D>> {
    if D == 3 && flatness(points) < FLAT { Plane::through(points) } else { None }
}

/// Whether nodes of two networks lie on each other, closely for their size.
pub(crate) fn fits<const D: usize>([a, b]: [&[[f64; D]]; 2], size: f64) -> bool {
    align(b, a, false).is_none_or(|alignment| alignment.rms <= SAME_NETWORK * size)
}

/// Whether the `free` nodes of two networks agree once the `fixed` ones lie on each other. A node of the
/// first network may have another place, too.
pub(crate) fn agree<const D: usize>(
    fixed: [&[[f64; D]]; 2],
    free: [&[[f64; D]]; 2],
    size: f64,
    other_place: impl Fn(usize, [f64; D]) -> Option<[f64; D]>,
) -> bool {
    let Some(alignment) = align(fixed[1], fixed[0], false) else { return true };
    let centre = centroid(fixed[0].iter());
    let differing = |turned: &dyn Fn([f64; D]) -> [f64; D]| {
        let differs = |k: usize, s: [f64; D], t: [f64; D]| {
            let far = |s: [f64; D]| distance(s, t) > 5.0 * SAME_NETWORK * size.max(distance(s, centre));
            far(s) && other_place(k, s).is_none_or(far)
        };
        let pairs = free[0].iter().zip(free[1]).enumerate();
        pairs.filter(|&(k, (s, t))| differs(k, *s, turned(*t))).count()
    };
    // One stray node is an ambiguity of that node, not another network.
    let few = free[0].len() / 10;
    differing(&|t| alignment.transform.apply(t)) <= few
        || flat_plane(fixed[0]).is_some_and(|plane| differing(&|t| plane.mirrored(alignment.transform.apply(t))) <= few)
}

#[cfg(test)]
mod tests {
    use super::{same, same_but_for_sides};
    use crate::network::Network;
    use crate::network::tests::random;

    /// Twelve transmitters, the first of them mirrored in the plane of x and y.
    fn mirrored(network: &Network<3>, first: usize) -> Network<3> {
        let mut other = network.clone();
        other.transmitters[..first].iter_mut().for_each(|s| s[2] = -s[2]);
        other
    }

    #[test]
    fn sides_of_a_plane_of_receivers_make_other_networks_of_the_same_basin() {
        for seed in 0..20 {
            let mut network: Network<3> = random(8, 12, seed);
            assert!(!same_but_for_sides(&network, &mirrored(&network, 6)), "seed {seed}");
            network.receivers.iter_mut().for_each(|r| r[2] = 0.0);
            network.transmitters.iter_mut().for_each(|s| s[2] += 2f64.copysign(s[2]));
            let half = mirrored(&network, 6);
            assert!(!same(&network, &half) && same_but_for_sides(&network, &half), "seed {seed}");
            // One stray is none, and the whole network mirrored is itself.
            assert!([1, 11, 12].iter().all(|&first| same(&network, &mirrored(&network, first))), "seed {seed}");
        }
    }
}
