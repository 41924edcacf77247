//! Known positions and distances of receivers: they fix the frame, sharpen the rest and give the
//! propagation speed.

use hc::poly::counted;
use serde::{Deserialize, Serialize};

use crate::align::{Alignment, align, spanned};
use crate::calibrate::options::{CalibrateError, CalibrateOptions, KnownDistance, MeasuredPosition};
use crate::degeneracy::Usable;
use crate::flatness::flatness;
use crate::network::Network;
use crate::observations::{Node, Pin};
use crate::points::{centroid, distance, minus, trace};
use crate::pseudoranges::{MAX_MAGNITUDE, Pseudoranges};
use crate::refine::RefinedNetwork;

/// The propagation speed that follows from the known distances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SpeedEstimate {
    /// True speed divided by the speed with which the measurements were converted to metres.
    pub factor: f64,
    /// Its standard deviation, from the noise of the measurements; `None` if the noise is not
    /// known.
    pub factor_std: Option<f64>,
    /// The speed in metres per second, if the program knows the speed that was assumed.
    pub metres_per_second: Option<f64>,
    /// Root mean square of known minus found distances, metres.
    pub residual: f64,
    /// Number of distances that were used.
    pub distances: usize,
}

/// Standard deviation of a single coordinate that is said to be exact, as a share of the size of the
/// known positions.
const EXACT: f64 = 1e-6;

/// Known positions among the usable receivers, about their centroid.
pub(crate) struct Anchors<const D: usize> {
    /// Those known in all coordinates, exactly or not.
    pub(crate) positions: Vec<Option<[f64; D]>>,
    pub(crate) centre: [f64; D],
    /// Which are exact.
    exact: Vec<bool>,
    /// Those that are not, about the centroid.
    measured: Vec<MeasuredPosition<D>>,
}

/// Checks what is known against the size of the matrix.
pub(crate) fn validate<const D: usize>(
    measured: &Pseudoranges,
    options: &CalibrateOptions<D>,
) -> Result<(), CalibrateError<D>> {
    let m = measured.receivers();
    let bad = |problem: String| Err(CalibrateError::Known(problem));
    if !options.anchors.is_empty() && options.anchors.len() != m {
        return bad(format!(
            "{} for {}; one for each is needed",
            counted(options.anchors.len(), "anchor"),
            counted(m, "receiver")
        ));
    }
    let name = |i: usize| &measured.receiver_names()[i];
    for (i, position) in options.anchors.iter().enumerate() {
        if position.is_some_and(|p| p.iter().any(|x| x.is_nan() || x.abs() > MAX_MAGNITUDE)) {
            return bad(format!("the position of {} is not finite or too large; give metres", name(i)));
        }
    }
    for (k, measured) in options.positions.iter().enumerate() {
        let MeasuredPosition { receiver, position, sigma } = *measured;
        if receiver >= m || options.positions[..k].iter().any(|other| other.receiver == receiver) {
            return bad(format!("a position of receiver {} of {m} makes no sense, or is there twice", receiver + 1));
        }
        if options.anchors.get(receiver).is_some_and(Option::is_some) {
            return bad(format!("the position of {} is given both as exact and as measured; give one", name(receiver)));
        }
        let usable = |x: &f64| x.abs() <= MAX_MAGNITUDE;
        if !position.iter().flatten().all(usable) || position.iter().all(Option::is_none) {
            return bad(format!("the position of {} is not finite or too large; give metres", name(receiver)));
        }
        if let Some(wrong) = sigma.iter().find(|sigma| !(0.0..=MAX_MAGNITUDE).contains(*sigma)) {
            return bad(format!(
                "the standard deviation of the position of {} must not be negative, not {wrong}",
                name(receiver)
            ));
        }
    }
    if !options.positions.is_empty() {
        let whole = options.positions.iter().filter_map(MeasuredPosition::whole);
        let whole: Vec<[f64; D]> = whole.chain(options.anchors.iter().flatten().copied()).collect();
        if !fix_a_frame(&whole) {
            return bad(if D == 2 {
                "both coordinates of two receivers in different places are needed; single coordinates come beside these"
                    .to_string()
            } else {
                "all coordinates of three receivers that are not in one line are needed; single coordinates come beside these".to_string()
            });
        }
    }
    for known in &options.distances {
        let [a, b] = known.receivers;
        if a >= m || b >= m || a == b {
            return bad(format!("a distance between receivers {} and {} of {m} makes no sense", a + 1, b + 1));
        }
        if !(known.distance > 0.0 && known.distance <= MAX_MAGNITUDE) {
            return bad(format!(
                "the distance of {} and {} must be positive, not {}",
                name(a),
                name(b),
                known.distance
            ));
        }
    }
    if options.estimate_speed && distances(options).is_empty() {
        return bad(
            "no distance between receivers is known, which the speed needs; give two anchors or a distance".to_string()
        );
    }
    Ok(())
}

/// All known distances: the given ones and those between anchors.
fn distances<const D: usize>(options: &CalibrateOptions<D>) -> Vec<KnownDistance> {
    let mut all = options.distances.clone();
    for (a, p) in options.anchors.iter().enumerate() {
        for (b, q) in options.anchors.iter().enumerate().skip(a + 1) {
            if let (Some(p), Some(q)) = (p, q)
                && p != q
            {
                all.push(KnownDistance { receivers: [a, b], distance: distance(*p, *q) });
            }
        }
    }
    all
}

/// The factor that brings found distances closest to known ones, sum d D / sum d^2 for found d and
/// known D; its deviation from the joint covariance (row-major) of the receivers by its derivative,
/// -factor d / sum d^2 for each d.
pub(crate) fn speed<const D: usize>(
    network: &Network<D>,
    usable: &Usable,
    joint: Option<&[f64]>,
    options: &CalibrateOptions<D>,
) -> Result<SpeedEstimate, CalibrateError<D>> {
    let place = |i: usize| usable.receivers.iter().position(|&other| other == i);
    let pairs: Vec<(usize, usize, f64)> = distances(options)
        .iter()
        .filter_map(|known| Some((place(known.receivers[0])?, place(known.receivers[1])?, known.distance)))
        .collect();
    let found = |a: usize, b: usize| distance(network.receivers[a], network.receivers[b]);
    let squares: f64 = pairs.iter().map(|&(a, b, _)| found(a, b).powi(2)).sum();
    let factor = pairs.iter().map(|&(a, b, known)| known * found(a, b)).sum::<f64>() / squares;
    if !(factor > 0.0 && factor.is_finite()) {
        return Err(CalibrateError::Known(
            "the receivers whose distance is known cannot be located; give the distance of others".to_string(),
        ));
    }
    let mut gradient = vec![0.0; D * network.receivers.len()];
    for &(a, b, _) in &pairs {
        for k in 0..D {
            // d times the derivative of d by a coordinate is the difference of the coordinates.
            let step = -factor / squares * (network.receivers[a][k] - network.receivers[b][k]);
            gradient[D * a + k] += step;
            gradient[D * b + k] -= step;
        }
    }
    let size = gradient.len();
    let variance = |joint: &[f64]| -> f64 {
        let cells = (0..size).flat_map(|p| (0..size).map(move |q| (p, q)));
        cells.map(|(p, q)| gradient[p] * joint[p * size + q] * gradient[q]).sum()
    };
    let misfit: f64 = pairs.iter().map(|&(a, b, known)| (known - factor * found(a, b)).powi(2)).sum();
    Ok(SpeedEstimate {
        factor,
        factor_std: joint.filter(|joint| joint.len() == size * size).map(|joint| variance(joint).max(0.0).sqrt()),
        metres_per_second: None,
        residual: (misfit / pairs.len() as f64).sqrt(),
        distances: pairs.len(),
    })
}

/// Whether points leave a network no motion but a mirror image: two places in the plane, three that are
/// not in one line in space.
fn fix_a_frame<const D: usize>(points: &[[f64; D]]) -> bool {
    spanned(points) + 1 >= D
}

impl<const D: usize> Anchors<D> {
    /// The anchors among the usable receivers; `None` if none are asked for.
    pub(crate) fn new(usable: &Usable, options: &CalibrateOptions<D>) -> Result<Option<Anchors<D>>, CalibrateError<D>> {
        if options.anchors.iter().all(Option::is_none) && options.positions.is_empty() {
            return Ok(None);
        }
        let exact = |i: &usize| options.anchors.get(*i).copied().flatten();
        let place = |i: usize| usable.receivers.iter().position(|&other| other == i);
        let mut measured: Vec<MeasuredPosition<D>> = (options.positions.iter())
            .filter_map(|known| Some(MeasuredPosition { receiver: place(known.receiver)?, ..*known }))
            .collect();
        let mut positions: Vec<Option<[f64; D]>> = usable.receivers.iter().map(exact).collect();
        let mut exact: Vec<bool> = positions.iter().map(Option::is_some).collect();
        for known in &measured {
            if let Some(whole) = known.whole() {
                positions[known.receiver] = Some(whole);
                exact[known.receiver] = known.sigma == [0.0; D];
            }
        }
        measured.retain(|known| !exact[known.receiver]);
        if positions.iter().flatten().next().is_none() {
            return Err(CalibrateError::Known(
                "too few measurements tie down the receivers of known position; measure more of them".to_string(),
            ));
        }
        let centre = centroid(positions.iter().flatten());
        for p in positions.iter_mut().flatten() {
            *p = minus(*p, centre);
        }
        let size = positions.iter().flatten().map(|p| distance(*p, [0.0; D])).fold(0.0, f64::max);
        for known in &mut measured {
            // What can be held are whole positions.
            known.sigma = known.sigma.map(|sigma| sigma.max(EXACT * size));
            for (x, centre) in known.position.iter_mut().zip(centre) {
                *x = x.map(|x| x - centre);
            }
        }
        let anchors = Anchors { positions, centre, exact, measured };
        if !options.positions.is_empty() && !anchors.fix() {
            return Err(CalibrateError::Known(
                "too few measurements tie down the receivers of known position; measure more of them".to_string(),
            ));
        }
        Ok(Some(anchors))
    }

    /// Changes to units of which `factor` metres are one.
    pub(crate) fn divide(&mut self, factor: f64) {
        for p in self.positions.iter_mut().flatten() {
            *p = p.map(|x| x / factor);
        }
        for known in &mut self.measured {
            known.sigma = known.sigma.map(|sigma| sigma / factor);
            known.position = known.position.map(|x| x.map(|x| x / factor));
        }
    }

    /// Whether they leave no motion but a mirror image.
    pub(crate) fn fix(&self) -> bool {
        let all: Vec<[f64; D]> = self.positions.iter().flatten().copied().collect();
        fix_a_frame(&all)
    }

    /// How many positions are known in all coordinates.
    pub(crate) fn count(&self) -> usize {
        self.positions.iter().flatten().count()
    }

    /// Which receivers are held: all exact anchors, if the known positions leave no motion.
    pub(crate) fn held(&self) -> Vec<bool> {
        let fix = self.fix();
        self.exact.iter().map(|exact| fix && *exact).collect()
    }

    /// The coordinates that were measured, beside measurements of this deviation.
    pub(crate) fn pins(&self, deviation: f64) -> Vec<Pin> {
        let pins = self.measured.iter().flat_map(|known| {
            let pin = move |axis: usize| {
                let (value, precision) = (known.position[axis]?, deviation / known.sigma[axis]);
                Some(Pin { node: Node::Receiver(known.receiver), axis, value, precision })
            };
            (0..D).filter_map(pin)
        });
        pins.collect()
    }

    /// Sum of the variances of the known coordinates of a receiver; zero if they are exact.
    fn variance(&self, i: usize) -> f64 {
        let known = self.measured.iter().find(|known| known.receiver == i);
        known.map_or(0.0, |known| known.sigma.iter().map(|sigma| sigma * sigma).sum())
    }

    /// The one known position that the network and the others contradict, and by how much: without it
    /// the others, enough and spread enough to fix a frame without its mirror image, lie within `limit` (root mean square) of where the
    /// network has these receivers, and it lies beyond.
    pub(crate) fn culprit(&self, network: &Network<D>, limit: f64) -> Option<(usize, f64)> {
        let known: Vec<(usize, [f64; D])> =
            self.positions.iter().enumerate().filter_map(|(i, p)| Some((i, (*p)?))).collect();
        let rest = |left: Option<usize>| -> Option<Alignment<D>> {
            let pairs = known.iter().filter(|(i, _)| Some(*i) != left);
            let (from, to): (Vec<_>, Vec<_>) = pairs.map(|&(i, p)| (network.receivers[i], p)).unzip();
            if from.len() <= D || flatness(&to) < 0.02 { None } else { align(&from, &to, false) }
        };
        if known.len() < D + 2 || rest(None).is_none_or(|all| all.rms <= limit) {
            return None;
        }
        let mut found = known.iter().filter_map(|&(i, p)| {
            let others = rest(Some(i)).filter(|others| others.rms <= limit)?;
            let off = distance(others.transform.apply(network.receivers[i]), p);
            (off > limit).then_some((i, off))
        });
        // With two suspects, neither can be singled out.
        found.next().filter(|_| found.next().is_none())
    }

    /// Forgets the known position of a receiver.
    pub(crate) fn release(&mut self, i: usize) {
        self.positions[i] = None;
        self.exact[i] = false;
        self.measured.retain(|known| known.receiver != i);
    }

    /// Whether the network's mirror image fits the anchors as well: they lie in one line, in space in one
    /// plane (by a thousandth of its length).
    pub(crate) fn leave_mirror(&self) -> bool {
        let all: Vec<[f64; D]> = self.positions.iter().flatten().copied().collect();
        flatness(&all) < 1e-3 || all.len() <= D
    }

    /// Moves a network onto the anchors and puts exact ones in their places; root mean square of the
    /// distances that remain before.
    pub(crate) fn place(&self, refined: &mut RefinedNetwork<D>) -> f64 {
        let pairs = refined.network.receivers.iter().zip(&self.positions);
        let (from, to): (Vec<_>, Vec<_>) = pairs.filter_map(|(r, p)| Some((*r, (*p)?))).unzip();
        let Some(alignment) = align(&from, &to, false) else { return 0.0 };
        refined.network = alignment.transform.apply_network(&refined.network);
        for (i, receiver) in refined.network.receivers.iter_mut().enumerate().filter(|(i, _)| self.exact[*i]) {
            *receiver = self.positions[i].unwrap_or(*receiver);
        }
        alignment.rms
    }

    /// Root mean square distance by which the anchors would be missed by chance, from the
    /// covariances of the receivers and their own deviations.
    pub(crate) fn expected(&self, covariance: &[[[f64; D]; D]]) -> f64 {
        let known = covariance.iter().zip(&self.positions).enumerate().filter(|(_, (_, p))| p.is_some());
        let traces = known.map(|(i, (c, _))| trace(c) + self.variance(i));
        let (sum, count) = traces.fold((0.0, 0.0), |(sum, count), trace| (sum + trace, count + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_distance_gives_factor_and_deviation() {
        let network = Network { receivers: vec![[0.0, 0.0], [3.0, 4.0], [1.0, 0.0]], ..Default::default() };
        let usable = Usable { receivers: vec![0, 2, 3], transmitters: vec![], warnings: vec![] };
        let options = CalibrateOptions {
            distances: vec![KnownDistance { receivers: [2, 0], distance: 10.0 }],
            ..Default::default()
        };
        // The distance 5 m with independent errors of 0.1 m in all coordinates has a deviation of
        // 0.1 sqrt(2); the factor 10 / 5 has 10 / 25 of it.
        let joint: Vec<f64> = (0..36).map(|k| if k % 7 == 0 { 0.01 } else { 0.0 }).collect();
        let found = speed(&network, &usable, Some(&joint), &options).unwrap();
        assert_eq!((found.factor, found.distances, found.residual), (2.0, 1, 0.0));
        assert!((found.factor_std.unwrap() - 0.4 * 0.1 * 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(speed(&network, &usable, None, &options).unwrap().factor_std, None);
        let unlocated = Usable { receivers: vec![0, 1, 3], transmitters: vec![], warnings: vec![] };
        assert!(speed(&network, &unlocated, None, &options).is_err());
    }
}
