//! Known positions of nodes: they fix the frame and sharpen the rest.

use hc::poly::counted;

use crate::align::{Alignment, align, spanned};
use crate::calibrate::input::speed::known_distances;
use crate::calibrate::options::{CalibrateError, CalibrateOptions, MeasuredPosition};
use crate::degeneracy::Usable;
use crate::flatness::flatness;
use crate::network::Network;
use crate::observations::{Node, Pin};
use crate::points::{centroid, distance, minus, trace};
use crate::pseudoranges::{MAX_MAGNITUDE, Pseudoranges};
use crate::refine::{Covariance, RefinedNetwork};

/// Standard deviation of a single coordinate that is said to be exact, as a share of the size of the
/// known positions.
const EXACT: f64 = 1e-6;

/// Known positions among the usable nodes, about their centroid.
#[derive(Clone)]
pub(crate) struct Anchors<const D: usize> {
    /// Nodes of which all coordinates are known, exactly or not, and where they are.
    pub(crate) whole: Vec<(Node, [f64; D])>,
    pub(crate) centre: [f64; D],
    /// Which receivers are exact.
    exact: Vec<bool>,
    /// What else is known, about the centroid. Transmitters that are exact are here, with a deviation that says so.
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
    for (k, known) in options.positions.iter().enumerate() {
        let MeasuredPosition { node, position, sigma } = *known;
        let (what, index, count) = match node {
            Node::Receiver(i) => ("receiver", i, m),
            Node::Transmitter(j) => ("transmitter", j, measured.transmitters()),
        };
        if index >= count || options.positions[..k].iter().any(|other| other.node == node) {
            return bad(format!("a position of {what} {} of {count} makes no sense, or is there twice", index + 1));
        }
        let name = node.name(measured);
        if node == Node::Receiver(index) && options.anchors.get(index).is_some_and(Option::is_some) {
            return bad(format!("the position of {name} is given both as exact and as measured; give one"));
        }
        let usable = |x: &f64| x.abs() <= MAX_MAGNITUDE;
        if !position.iter().flatten().all(usable) || position.iter().all(Option::is_none) {
            return bad(format!("the position of {name} is not finite or too large; give metres"));
        }
        if let Some(wrong) = sigma.iter().find(|sigma| !(0.0..=MAX_MAGNITUDE).contains(*sigma)) {
            return bad(format!("the standard deviation of the position of {name} must not be negative, not {wrong}"));
        }
    }
    if !options.positions.is_empty() && !options.knows_heights_alone() {
        let whole = options.positions.iter().filter_map(MeasuredPosition::whole);
        let whole: Vec<[f64; D]> = whole.chain(options.anchors.iter().flatten().copied()).collect();
        if !fix_a_frame(&whole) {
            return bad(if D == 2 {
                "both coordinates of two nodes in different places are needed; single coordinates come beside these"
                    .to_string()
            } else {
                "all coordinates of three nodes that are not in one line are needed, or the heights of three and nothing else; single coordinates \
                 come beside these"
                    .to_string()
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
    for known in options.distances.iter().filter(|known| !options.estimate_speed || known.sigma.is_some()) {
        let [a, b] = known.receivers.map(|i| &measured.receiver_names()[i]);
        match known.sigma {
            Some(sigma) if sigma > 0.0 && sigma <= MAX_MAGNITUDE => {}
            Some(sigma) => {
                return bad(format!(
                    "the standard deviation of the distance of {a} and {b} must be positive, not {sigma}"
                ));
            }
            None => {
                return bad(format!(
                    "the distance of {a} and {b} has no standard deviation, which it needs beside other measurements; give one (a fourth \
                     column), or estimate the speed with it (--estimate-speed)"
                ));
            }
        }
    }
    if options.estimate_speed && known_distances(options).is_empty() {
        return bad(
            "no distance between receivers is known, which the speed needs; give two anchors or a distance".to_string()
        );
    }
    Ok(())
}

/// Whether points leave a network no motion but a mirror image: two places in the plane, three that are
/// not in one line in space.
fn fix_a_frame<const D: usize>(points: &[[f64; D]]) -> bool {
    spanned(points) + 1 >= D
}

impl<const D: usize> Anchors<D> {
    /// The anchors among the usable receivers; `None` if none are asked for.
    pub(crate) fn new(usable: &Usable, options: &CalibrateOptions<D>) -> Result<Option<Anchors<D>>, CalibrateError<D>> {
        let nothing = options.anchors.iter().all(Option::is_none) && options.positions.is_empty();
        // Heights alone turn the network once it is found.
        if nothing || options.knows_heights_alone() {
            return Ok(None);
        }
        let given = |i: &usize| options.anchors.get(*i).copied().flatten();
        let place = |all: &[usize], k: usize| all.iter().position(|&other| other == k);
        let node = |node: Node| match node {
            Node::Receiver(i) => place(&usable.receivers, i).map(Node::Receiver),
            Node::Transmitter(j) => place(&usable.transmitters, j).map(Node::Transmitter),
        };
        let mut measured: Vec<MeasuredPosition<D>> = (options.positions.iter())
            .filter_map(|known| Some(MeasuredPosition { node: node(known.node)?, ..*known }))
            .collect();
        let mut exact: Vec<bool> = usable.receivers.iter().map(|i| given(i).is_some()).collect();
        let anchors = usable.receivers.iter().enumerate().filter_map(|(k, i)| Some((Node::Receiver(k), given(i)?)));
        let mut whole: Vec<(Node, [f64; D])> = anchors.collect();
        whole.extend(measured.iter().filter_map(|known| Some((known.node, known.whole()?))));
        measured.retain(|known| match known.node {
            Node::Receiver(k) if known.whole().is_some() && known.sigma == [0.0; D] => {
                exact[k] = true;
                false
            }
            _ => true,
        });
        if whole.is_empty() {
            return Err(CalibrateError::Known(
                "too few measurements tie down the nodes of known position; measure more of them".to_string(),
            ));
        }
        let centre = centroid(whole.iter().map(|(_, p)| p));
        for (_, p) in &mut whole {
            *p = minus(*p, centre);
        }
        let size = whole.iter().map(|(_, p)| distance(*p, [0.0; D])).fold(0.0, f64::max);
        for known in &mut measured {
            // What can be held are whole positions.
            known.sigma = known.sigma.map(|sigma| sigma.max(EXACT * size));
            for (x, centre) in known.position.iter_mut().zip(centre) {
                *x = x.map(|x| x - centre);
            }
        }
        let anchors = Anchors { whole, centre, exact, measured };
        if !options.positions.is_empty() && !anchors.fix() {
            return Err(CalibrateError::Known(
                "too few measurements tie down the nodes of known position; measure more of them".to_string(),
            ));
        }
        Ok(Some(anchors))
    }

    /// Changes to units of which `factor` metres are one.
    pub(crate) fn divide(&mut self, factor: f64) {
        for (_, p) in &mut self.whole {
            *p = p.map(|x| x / factor);
        }
        for known in &mut self.measured {
            known.sigma = known.sigma.map(|sigma| sigma / factor);
            known.position = known.position.map(|x| x.map(|x| x / factor));
        }
    }

    /// What the known positions leave the network free to turn about; `None` if they leave no motion but a mirror image.
    pub(crate) fn free_turn(&self) -> Option<&'static str> {
        match D - 1 - spanned(&self.places()).min(D - 1) {
            0 => None,
            1 if D == 3 => Some("the line through them"),
            _ => Some("the only place"),
        }
    }

    /// Whether they leave no motion but a mirror image.
    pub(crate) fn fix(&self) -> bool {
        fix_a_frame(&self.places())
    }

    /// All positions that are known in all coordinates.
    fn places(&self) -> Vec<[f64; D]> {
        self.whole.iter().map(|(_, p)| *p).collect()
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
                Some(Pin { node: known.node, axis, value, precision })
            };
            (0..D).filter_map(pin)
        });
        pins.collect()
    }

    /// Sum of the variances of the known coordinates of a node; zero if they are exact.
    fn variance(&self, node: Node) -> f64 {
        let known = self.measured.iter().find(|known| known.node == node);
        known.map_or(0.0, |known| known.sigma.iter().map(|sigma| sigma * sigma).sum())
    }

    /// The one known position that the network and the others contradict, and by how much: without it
    /// the others, enough and spread enough to fix a frame without its mirror image, lie within `limit` (root mean square) of where the
    /// network has these nodes, and it lies beyond.
    pub(crate) fn culprit(&self, network: &Network<D>, limit: f64) -> Option<(Node, f64)> {
        let known = &self.whole;
        let rest = |left: Option<Node>| -> Option<Alignment<D>> {
            let pairs = known.iter().filter(|(node, _)| Some(*node) != left);
            let (from, to): (Vec<_>, Vec<_>) = pairs.map(|&(node, p)| (node.of(network), p)).unzip();
            if from.len() <= D || flatness(&to) < 0.02 { None } else { align(&from, &to, false) }
        };
        if known.len() < D + 2 || rest(None).is_none_or(|all| all.rms <= limit) {
            return None;
        }
        let mut found = known.iter().filter_map(|&(node, p)| {
            let others = rest(Some(node)).filter(|others| others.rms <= limit)?;
            let off = distance(others.transform.apply(node.of(network)), p);
            (off > limit).then_some((node, off))
        });
        // With two suspects, neither can be singled out.
        found.next().filter(|_| found.next().is_none())
    }

    /// Forgets the known position of a node.
    pub(crate) fn release(&mut self, node: Node) {
        self.whole.retain(|(other, _)| *other != node);
        self.measured.retain(|known| known.node != node);
        if let Node::Receiver(i) = node {
            self.exact[i] = false;
        }
    }

    /// Whether the network's mirror image fits the anchors as well: they lie in one line, in space in one
    /// plane (by a thousandth of its length).
    pub(crate) fn leave_mirror(&self) -> bool {
        flatness(&self.places()) < 1e-3 || self.whole.len() <= D
    }

    /// Moves a network onto the anchors and puts exact receivers in their places; root mean square of the
    /// distances that remain before.
    pub(crate) fn place(&self, refined: &mut RefinedNetwork<D>) -> f64 {
        let pairs = self.whole.iter().map(|&(node, p)| (node.of(&refined.network), p));
        let (from, to): (Vec<_>, Vec<_>) = pairs.unzip();
        let Some(alignment) = align(&from, &to, false) else { return 0.0 };
        refined.network = alignment.transform.apply_network(&refined.network);
        for &(node, p) in &self.whole {
            if let Node::Receiver(i) = node
                && self.exact[i]
            {
                refined.network.receivers[i] = p;
            }
        }
        alignment.rms
    }

    /// Root mean square distance by which the anchors would be missed by chance, from the
    /// covariances of these nodes and their own deviations.
    pub(crate) fn expected(&self, covariance: &Covariance<D>) -> f64 {
        let of = |node: Node| match node {
            Node::Receiver(i) => Some(trace(&covariance.receivers[i])),
            Node::Transmitter(j) => covariance.transmitters[j].as_ref().map(|block| trace(&block.rows)),
        };
        let traces = self.whole.iter().filter_map(|&(node, _)| Some(of(node)? + self.variance(node)));
        let (sum, count) = traces.fold((0.0, 0.0), |(sum, count), trace| (sum + trace, count + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    }
}
