//! Small networks of neighbouring receivers, laid together where they overlap.

use crate::align::{Transform, align};
use crate::flatness::flatness;
use crate::median::median;
use crate::points::distance;

/// Receivers that two networks must share to be laid together: one more than fix a frame.
pub(crate) const fn overlap<const D: usize>() -> usize {
    D + 2
}

/// Submaps fit where common receivers lie within this share of the submap's size (root mean
/// square).
pub(crate) const FIT: f64 = 0.04;

/// A network of a few receivers.
pub(crate) struct Submap<const D: usize> {
    /// Their indices.
    pub(crate) receivers: Vec<usize>,
    /// Their positions, in a frame of its own and perhaps reflected.
    pub(crate) positions: Vec<[f64; D]>,
    /// Their clocks, offset and drift against one of them; zero where they share one.
    pub(crate) clocks: Vec<[f64; 2]>,
    pub(crate) size: f64,
}

/// Where a receiver is, with its clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedReceiver<const D: usize> {
    pub(crate) position: [f64; D],
    pub(crate) clock: [f64; 2],
}

/// The receivers of the largest part that hangs together, in one frame and with clocks against one of them.
pub(crate) fn largest<const D: usize>(submaps: &[Submap<D>], receivers: usize) -> Vec<Option<PlacedReceiver<D>>> {
    let mut best = vec![None; receivers];
    let mut used = vec![false; submaps.len()];
    // Each part begins with the unused submap of the most receivers.
    while let Some(first) =
        (0..submaps.len()).filter(|&k| !used[k]).max_by_key(|&k| (submaps[k].receivers.len(), usize::MAX - k))
    {
        let part = grow(submaps, first, receivers, &mut used);
        let placed = |part: &[Option<PlacedReceiver<D>>]| part.iter().flatten().count();
        if placed(&part) > placed(&best) {
            best = part;
        }
        used[first] = true;
    }
    best
}

/// A part from one submap on: the submap that fits in the most receivers is always the next.
fn grow<const D: usize>(
    submaps: &[Submap<D>],
    first: usize,
    receivers: usize,
    used: &mut [bool],
) -> Vec<Option<PlacedReceiver<D>>> {
    let mut placed: Vec<Option<PlacedReceiver<D>>> = vec![None; receivers];
    for (i, receiver) in submaps[first].placed() {
        placed[i] = Some(receiver);
    }
    used[first] = true;
    // How submaps fit, which changes for those that have one of the receivers placed last.
    let mut fits: Vec<Option<(usize, Transform<D>)>> = vec![None; submaps.len()];
    let mut fresh = submaps[first].receivers.clone();
    loop {
        for (k, submap) in submaps.iter().enumerate().filter(|&(k, _)| !used[k]) {
            if submap.receivers.iter().any(|i| fresh.contains(i)) {
                fits[k] = fit(submap, |i| placed[i].map(|receiver| receiver.position));
            }
        }
        let all = (0..submaps.len()).filter(|&k| !used[k]).filter_map(|k| Some((k, fits[k]?)));
        let Some((k, (_, map))) = all.max_by_key(|(k, (count, _))| (*count, usize::MAX - k)) else { return placed };
        used[k] = true;
        fresh.clear();
        let later = submaps[k].later(&placed);
        for (i, PlacedReceiver { position, clock }) in submaps[k].placed() {
            if placed[i].is_none() {
                let clock = [clock[0] + later[0], clock[1] + later[1]];
                placed[i] = Some(PlacedReceiver { position: map.apply(position), clock });
                fresh.push(i);
            }
        }
    }
}

impl<const D: usize> Submap<D> {
    /// Its receivers by index, in its own frame.
    fn placed(&self) -> impl Iterator<Item = (usize, PlacedReceiver<D>)> {
        let all = self.receivers.iter().zip(&self.positions).zip(&self.clocks);
        all.map(|((&i, &position), &clock)| (i, PlacedReceiver { position, clock }))
    }

    /// By how much the clocks of placed receivers are ahead of its own: the middle of those in common.
    fn later(&self, placed: &[Option<PlacedReceiver<D>>]) -> [f64; 2] {
        [0, 1].map(|k| {
            let ahead = |(i, own): (usize, PlacedReceiver<D>)| Some(placed[i]?.clock[k] - own.clock[k]);
            median(self.placed().filter_map(ahead).collect()).unwrap_or_default()
        })
    }
}

/// The map that lays a submap on placed receivers, with how many of the common ones it fits: at
/// least [`overlap`] that are not in one line, in space not in one plane, and more than half of those in common.
pub(crate) fn fit<const D: usize>(
    submap: &Submap<D>,
    placed: impl Fn(usize) -> Option<[f64; D]>,
) -> Option<(usize, Transform<D>)> {
    let pairs = submap.receivers.iter().zip(&submap.positions).filter_map(|(&i, &p)| Some((p, placed(i)?)));
    let (mut from, mut to): (Vec<_>, Vec<_>) = pairs.unzip();
    let common = from.len();
    while from.len() >= overlap::<D>() && 2 * from.len() > common {
        let alignment = align(&from, &to, false)?;
        if alignment.rms <= FIT * submap.size {
            // Receivers in one line leave open on which side of it the others lie.
            return (flatness(&from) > 0.05).then_some((from.len(), alignment.transform));
        }
        let error = |k: usize| distance(alignment.transform.apply(from[k]), to[k]);
        let worst = (0..from.len()).max_by(|&a, &b| error(a).total_cmp(&error(b)))?;
        from.swap_remove(worst);
        to.swap_remove(worst);
    }
    None
}
