//! Warnings about nodes in one line or one plane: the sides on which others lie, and heights that are less
//! certain than the rest.

use crate::calibrate::judge::mirror_images::Mirrored;
use crate::degeneracy::list;
use crate::flatness::{FLAT, Plane, breadth, flatness, slenderness};
use crate::median::median;
use crate::minimal::NodeKind;
use crate::network::Network;
use crate::points::{centroid, distance, dot, minus, trace};
use crate::pseudoranges::Pseudoranges;
use crate::quantity::{length, number};
use crate::refine::Covariance;

/// Ratio of the standard deviations across a plane and along it from which on it is worth a word.
const LESS_CERTAIN: f64 = 1.5;

/// Points lie in one line, as far as is known, if their width is less than so many of its standard deviations.
const WIDE: f64 = 4.0;

/// Lengths below this share of the network's size are rounding.
const ROUNDING: f64 = 1e-9;

/// Kinds of nodes that lie in one line of space, as far as the measurements tell: the others may be anywhere
/// around it.
pub(crate) fn turning<const D: usize>(network: &Network<D>, uncertainty: &Covariance<D>) -> Vec<NodeKind> {
    let of_receivers: Vec<&[[f64; D]; D]> = uncertainty.receivers.iter().collect();
    let of_transmitters: Vec<&[[f64; D]; D]> = uncertainty.transmitters.iter().flatten().map(|c| &c.rows).collect();
    // In the plane, a line leaves mirror images alone.
    let in_line = |points, covariances| D > 2 && in_line(points, covariances, network.size());
    let mut turning = Vec::new();
    if in_line(&network.receivers, &of_receivers) {
        turning.push(NodeKind::Receivers);
    }
    if in_line(&network.transmitters, &of_transmitters) && may_be_in_line(network, uncertainty) {
        turning.push(NodeKind::Transmitters);
    }
    turning
}

/// Warns of receivers and of transmitters in one line, in space in one plane, and of mirror images.
pub(crate) fn warn_of_sides<const D: usize>(
    measured: &Pseudoranges,
    network: &Network<D>,
    uncertainty: &Covariance<D>,
    turning: &[NodeKind],
    images: &[Mirrored<D>],
    warnings: &mut Vec<String>,
) {
    let (receivers, transmitters) = (NodeKind::Receivers, NodeKind::Transmitters);
    for (kind, points, other, names) in [
        (receivers, &network.receivers, transmitters, measured.transmitter_names()),
        (transmitters, &network.transmitters, receivers, measured.receiver_names()),
    ] {
        if turning.contains(&kind) {
            warnings.push(format!(
                "the {kind} lie in one line, as far as the measurements tell: the {other} may be anywhere around it, and the places given for \
                 them are some of many; move some {kind} off the line"
            ));
            continue;
        }
        let mirrored: Vec<String> =
            images.iter().filter(|image| image.kind == other).map(|image| names[image.index].clone()).collect();
        let sides = (!mirrored.is_empty()).then(|| format!("{} of {} {other}", mirrored.len(), names.len()));
        let named = list(&mirrored);
        // In one line of space they are in a plane too, which is the lesser evil.
        let (thin, what, width) = match (slenderness(points), flatness(points)) {
            (thin, _) if thin < FLAT => (thin, "line", "width"),
            (_, thin) => (thin, "plane", "height"),
        };
        let flat = format!("the {kind} lie nearly in one {what} ({width} {:.1} % of length)", 100.0 * thin);
        let across = if what == "plane" { across(points, network, uncertainty) } else { None };
        let uncertain = across.map(|[across, along]| {
            format!(
                "standard deviations across it are {} times those along it (medians {} and {})",
                number(across / along, 2),
                length(across),
                length(along)
            )
        });
        let remedy = format!("move some {kind} off the {what}");
        match (thin < FLAT, sides, uncertain) {
            (true, Some(sides), uncertain) => {
                let uncertain = uncertain.map_or_else(String::new, |uncertain| format!("; {uncertain}"));
                warnings.push(format!(
                    "{flat}: {sides} may lie on the other side of it, {named}, where they fit as well (see mirror_images)\
                     {uncertain}; {remedy}"
                ));
            }
            (false, Some(sides), _) => warnings.push(format!(
                "{sides} may lie on the other side of the plane of the {kind} that they were measured with, {named}: they fit as well there \
                 (see mirror_images); measure them with {kind} off that plane"
            )),
            (true, None, Some(uncertain)) => warnings.push(format!("{flat}: {uncertain}; {remedy}")),
            // Where the deviations are known, no side that is open would have been missed.
            (true, None, None) if D == 3 && what == "plane" && !uncertainty.receivers.is_empty() => {}
            (true, None, None) => warnings.push(format!(
                "{flat}: on which side of it the other nodes lie is poorly determined; {remedy}"
            )),
            (false, None, _) => {}
        }
    }
}

/// Whether the width of points is not known to be more than zero; by its share of the length alone where
/// errors are not known.
fn in_line<const D: usize>(points: &[[f64; D]], covariances: &[&[[f64; D]; D]], size: f64) -> bool {
    if covariances.is_empty() {
        return slenderness(points) < FLAT;
    }
    let Some((width, axis)) = breadth(points) else { return false };
    // Of most of them: a few far nodes have errors of any size, and make the others look slender.
    let squares = covariances.iter().map(|c| dot(axis, c.map(|row| dot(row, axis))).max(0.0));
    width < (WIDE * median(squares.collect()).map_or(0.0, f64::sqrt)).max(ROUNDING * size)
}

/// Whether the directions in which transmitters are seen from the middle of the receivers lie in one plane, as those of
/// nodes in one line do: far ones tell their directions well, and their distances hardly.
fn may_be_in_line<const D: usize>(network: &Network<D>, uncertainty: &Covariance<D>) -> bool {
    let middle = centroid(network.receivers.iter());
    let seen = network.transmitters.iter().zip(&uncertainty.transmitters).filter_map(|(p, c)| {
        let (off, distance) = (minus(*p, middle), distance(*p, middle));
        Some((off.map(|x| x / distance), distance, c.as_ref()?.rows)).filter(|_| distance > 0.0)
    });
    let seen: Vec<([f64; D], f64, [[f64; D]; D])> = seen.collect();
    // With its opposite each, their plane is one through the middle.
    let both: Vec<[f64; D]> = seen.iter().flat_map(|(u, ..)| [*u, u.map(|x| -x)]).collect();
    let Some(Plane { normal, .. }) = Plane::through(&both) else { return true };
    let width = (seen.iter().map(|(u, ..)| dot(*u, normal).powi(2)).sum::<f64>() / seen.len() as f64).sqrt();
    // A distance does not move a direction.
    let error = |(u, d, c): &([f64; D], f64, [[f64; D]; D])| {
        let across = minus(normal, u.map(|x| x * dot(*u, normal)));
        dot(across, c.map(|row| dot(row, across))).max(0.0).sqrt() / d
    };
    let errors = seen.iter().map(error).collect();
    width < (WIDE * median(errors).unwrap_or(0.0)).max(ROUNDING)
}

/// Standard deviations of all nodes across the plane of these points and along it, medians; `None` if they
/// are not known, there is no plane, or they hardly differ.
fn across<const D: usize>(points: &[[f64; D]], network: &Network<D>, uncertainty: &Covariance<D>) -> Option<[f64; 2]> {
    let plane = Plane::through(points)?;
    let all = uncertainty.transmitters.iter().flatten().map(|c| &c.rows).chain(&uncertainty.receivers);
    let (across, along) = all
        .map(|c| {
            let square = dot(plane.normal, c.map(|row| dot(row, plane.normal)));
            (square.max(0.0).sqrt(), (0.5 * (trace(c) - square)).max(0.0).sqrt())
        })
        .unzip();
    let [across, along] = [median(across)?, median(along)?];
    // Exact measurements leave nothing but rounding.
    let told = across > LESS_CERTAIN * along && along > ROUNDING * network.size();
    told.then_some([across, along])
}

#[cfg(test)]
mod tests {
    use super::{in_line, may_be_in_line};
    use crate::bordered::Bordered;
    use crate::network::Network;
    use crate::points::dot;
    use crate::refine::Covariance;

    #[test]
    fn a_line_is_one_as_far_as_its_errors_go() {
        let points: Vec<[f64; 3]> = (0..12).map(|k| [k as f64, [0.0, 0.05][k % 2], 0.0]).collect();
        let errors = |deviation: f64| {
            let square = deviation * deviation;
            [[square, 0.0, 0.0], [0.0, square, 0.0], [0.0, 0.0, square]]
        };
        // Half of the points are 5 cm beside the others: a width of 2.5 cm.
        for (deviation, expected) in [(0.002, false), (0.006, false), (0.007, true), (0.1, true)] {
            let error = errors(deviation);
            assert_eq!(in_line(&points, &[&error; 12], 11.0), expected, "{deviation}");
        }
        // A far point of uncertain place makes no line of the rest.
        let mut far: Vec<[f64; 3]> = points.iter().map(|p| [p[0], 40.0 * p[1], p[0] % 3.0]).collect();
        far.push([0.0, 0.0, 3000.0]);
        let (near, wide) = (errors(0.01), errors(500.0));
        let all: Vec<_> = (0..13).map(|k| if k < 12 { &near } else { &wide }).collect();
        assert!(!in_line(&far, &all, 11.0));
        // An exact line is one whether errors are unknown or as small as rounding.
        let line: Vec<[f64; 3]> = points.iter().map(|p| [p[0], 2.0 * p[0], -p[0]]).collect();
        let none = errors(0.0);
        assert!(in_line(&line, &[], 11.0) && in_line(&line, &[&none; 12], 11.0));
        assert!(!in_line(&points, &[&none; 12], 11.0));
    }

    #[test]
    fn directions_tell_that_far_transmitters_are_in_no_line() {
        let receivers = vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5], [0.0, -1.0, -0.5]];
        let seen = |transmitters: Vec<[f64; 3]>| {
            // Distances are uncertain by half, directions by a hundredth.
            let along = |p: &[f64; 3]| {
                let entry = |a: usize, b: usize| 0.25 * p[a] * p[b] + f64::from(u8::from(a == b)) * 1e-4 * dot(*p, *p);
                let rows = std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b)));
                Some(Bordered { rows, border: [0.0; 3], corner: 1.0 })
            };
            let uncertainty =
                Covariance { transmitters: transmitters.iter().map(along).collect(), ..Covariance::default() };
            let offsets = vec![0.0; transmitters.len()];
            may_be_in_line(&Network::new(receivers.clone(), transmitters, offsets), &uncertainty)
        };
        let around = |k: u32| {
            let at = f64::from(k);
            [20.0 * at.cos(), 20.0 * at.sin(), 8.0 * (3.0 * at).cos()]
        };
        assert!(!seen((0..20).map(around).collect()));
        assert!(seen((0..20).map(|k| [3.0 * f64::from(k) - 30.0, 12.0, 7.0]).collect()));
    }
}
