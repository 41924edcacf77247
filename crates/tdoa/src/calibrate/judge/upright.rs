//! Which way is up, where heights are all that is known of positions.

use crate::align::{Transform, frame};
use crate::calibrate::options::MeasuredPosition;
use crate::calibrate::report::calibration::Calibration;
use crate::flatness::{FLAT, slenderness};
use crate::observations::Node;
use crate::points::{centroid, dot, minus, trace};
use crate::quantity::{length, number};
use faer::{Mat, Side};
use std::array::from_fn;

/// Heights fit if they are off by less than so many times what is expected, root mean square; two ways up differ if they
/// change heights by more than that.
const BEYOND: f64 = 4.0;

/// Standard deviation of the vertical, radians, above which the heights do not tell it.
const LOOSE: f64 = 0.1;

/// Standard deviation of a height that is said to be exact, as a share of the network's extent.
const EXACT: f64 = 1e-6;

/// A located node of known height.
struct Height<const D: usize> {
    place: [f64; D],
    height: f64,
    /// Inverse of the variance of the height, and of the place along any axis.
    weight: f64,
}

/// A vertical of a network.
struct Vertical<const D: usize> {
    /// Upwards, of length one.
    up: [f64; D],
    /// The middle of the nodes of known height, and its height.
    middle: ([f64; D], f64),
    /// Half of the sum of the squares of what is left of the heights, in their standard deviations.
    misfit: f64,
}

impl<const D: usize> Calibration<D> {
    /// Turns the network upright and to these heights; says how well they tell the vertical, and what they leave open. A
    /// second vertical is another answer if the heights are less likely with it by at most `margin` (natural logarithm).
    pub(crate) fn stand_upright(&mut self, known: &[MeasuredPosition<D>], margin: f64) {
        let heights = self.heights(known);
        let places: Vec<[f64; D]> = heights.iter().map(|of| of.place).collect();
        let verticals = if slenderness(&places) < FLAT || places.len() < 3 { None } else { verticals(&heights) };
        let Some(([best, other], map)) = verticals.and_then(|both| self.upright(&both[0]).map(|map| (both, map)))
        else {
            self.call_not_unique(
                "the nodes of known height lie nearly in one line: their heights do not tell which way is up, and were not used; give heights \
                 of three nodes that are not in one line"
                    .into(),
            );
            return;
        };
        let count = heights.len() as f64;
        let expected = (heights.iter().map(|of| 1.0 / of.weight).sum::<f64>() / count).sqrt();
        let located: Vec<[f64; D]> = self.receivers.iter().chain(&self.transmitters).flatten().copied().collect();
        let moved = located.iter().map(|p| (best.height(*p) - other.height(*p)).powi(2)).sum::<f64>();
        let moved = (moved / located.len().max(1) as f64).sqrt();
        let tilt = tilt(&heights, best.up);
        self.transform(&map);
        self.warnings.push(format!(
            "of positions heights alone are known: they turn the network upright, to {} degrees (standard deviation), and do not sharpen it; \
             its turn about the vertical is arbitrary, and its mirror image fits as well; give x, y and z of three nodes to fix these",
            number(tilt.to_degrees().min(90.0), 2)
        ));
        if 2.0 * best.misfit > BEYOND * BEYOND * count {
            self.call_not_unique(format!(
                "the known heights contradict the distances that the measurements give between these nodes: they are off by {}, which would be \
                 expected to be {}; check heights and names",
                length((2.0 * best.misfit / count).sqrt() * expected),
                length(expected)
            ));
        }
        if other.misfit - best.misfit <= margin && moved > BEYOND * expected {
            self.call_not_unique(
                "the nodes of known height lie in one plane, as far as is known: with the network mirrored in it the heights fit as well, and \
                 what is above may be below; give the height of a node off that plane"
                    .into(),
            );
        } else if tilt > LOOSE {
            self.call_not_unique(
                "the known heights hardly tell the vertical; give heights of nodes that lie farther apart".into(),
            );
        }
    }

    /// The located nodes of known height.
    fn heights(&self, known: &[MeasuredPosition<D>]) -> Vec<Height<D>> {
        let exact = EXACT * self.extent().unwrap_or(1.0);
        let covariances = self.trusted_covariances();
        let of = |known: &MeasuredPosition<D>| {
            let (place, covariance) = match known.node {
                Node::Receiver(i) => (self.receivers[i]?, covariances[0][i]),
                Node::Transmitter(j) => (self.transmitters[j]?, covariances[1][j]),
            };
            let of_place = covariance.map_or(0.0, |c| trace(&c).max(0.0) / D as f64);
            let weight = 1.0 / (of_place + known.sigma[D - 1].max(exact).powi(2));
            Some(Height { place, height: known.position[D - 1]?, weight })
        };
        known.iter().filter_map(of).collect()
    }

    /// The motion to this vertical, with the first receiver that is not in the middle of all in the direction of x.
    fn upright(&self, vertical: &Vertical<D>) -> Option<Transform<D>> {
        let up = vertical.up;
        let middle = centroid(self.receivers.iter().flatten());
        let along = |p: &[f64; D]| {
            let away = minus(*p, middle);
            let level = dot(away, up);
            from_fn(|k| away[k] - level * up[k])
        };
        let least = 1e-3 * self.extent()?;
        let x: [f64; D] = self.receivers.iter().flatten().map(along).find(|a| dot(*a, *a).sqrt() > least)?;
        let y: [f64; D] = from_fn(|k| {
            let (a, b) = ((k + 1) % D, (k + 2) % D);
            up[a] * x[b] - up[b] * x[a]
        });
        let ground = vertical.height(middle);
        let origin: [f64; D] = from_fn(|k| middle[k] - ground * up[k]);
        let axes = [x, y, up];
        frame(origin, from_fn(|axis| from_fn(|k| origin[k] + axes[axis.min(2)][k])))
    }
}

impl<const D: usize> Vertical<D> {
    /// How high a point is.
    fn height(&self, p: [f64; D]) -> f64 {
        dot(minus(p, self.middle.0), self.up) + self.middle.1
    }
}

/// The likeliest vertical, and the one with the nodes of known height mirrored in their plane of best fit; `None` where
/// numbers are not finite.
///
/// With q the places and z the heights about their weighted means, it minimises the sum of w (q u - z)^2 over vectors u
/// of length one: least squares on a sphere, (M + l I) u = g with M the sum of w q q^T and g that of w z q, where l is at least
/// minus the least eigenvalue of M and makes the length one (Gander, Golub and von Matt 1989).
fn verticals<const D: usize>(heights: &[Height<D>]) -> Option<[Vertical<D>; 2]> {
    let total: f64 = heights.iter().map(|of| of.weight).sum();
    let mean = |value: &dyn Fn(&Height<D>) -> f64| heights.iter().map(|of| of.weight * value(of)).sum::<f64>() / total;
    let centre: [f64; D] = from_fn(|k| mean(&|of| of.place[k]));
    let middle = (centre, mean(&|of| of.height));
    let about = |of: &Height<D>| (minus(of.place, middle.0), of.height - middle.1);
    let moment = |a: usize, b: usize| mean(&|of| about(of).0[a] * about(of).0[b]);
    // Eigenvalues ascend.
    let eigen = Mat::from_fn(D, D, moment).self_adjoint_eigen(Side::Lower).ok()?;
    let axes: [[f64; D]; D] = from_fn(|k| from_fn(|a| eigen.U()[(a, k)]));
    let values: [f64; D] = from_fn(|k| eigen.S()[k]);
    let with_height: [f64; D] = from_fn(|a| mean(&|of| about(of).0[a] * about(of).1));
    let parts: [f64; D] = axes.map(|axis| dot(axis, with_height));
    let length = dot(parts, parts).sqrt();
    if !(values.iter().all(|x| x.is_finite()) && length.is_finite()) {
        return None;
    }
    let of = |l: f64| -> [f64; D] { from_fn(|k| parts[k] / (values[k] + l)) };
    let (mut low, mut high) = (-values[0], length - values[0]);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let size = dot(of(middle), of(middle));
        // Beside the pole it is not a number.
        if size > 1.0 || !size.is_finite() { low = middle } else { high = middle }
    }
    let mut along = of(high).map(|x| if x.is_finite() { x } else { 0.0 });
    // Beside the pole the first part has lost its digits; the others tell it.
    let others = dot(along, along) - along[0] * along[0];
    along[0] = (1.0 - others).max(0.0).sqrt() * if parts[0] < 0.0 { -1.0 } else { 1.0 };
    let vertical = |along: [f64; D]| {
        let size = dot(along, along).sqrt();
        let up: [f64; D] = from_fn(|a| (0..D).map(|k| axes[k][a] * along[k]).sum::<f64>() / size);
        let misfit = |of: &Height<D>| of.weight * (dot(about(of).0, up) - about(of).1).powi(2);
        Vertical { up, middle, misfit: 0.5 * heights.iter().map(misfit).sum::<f64>() }
    };
    let best = vertical(along);
    along[0] = -along[0];
    Some([best, vertical(along)])
}

/// Standard deviation of the vertical about the worst axis, radians.
fn tilt<const D: usize>(heights: &[Height<D>], up: [f64; D]) -> f64 {
    let middle = centroid(heights.iter().map(|of| &of.place));
    let level = |of: &Height<D>| {
        let away = minus(of.place, middle);
        let height = dot(away, up);
        from_fn::<f64, D, _>(|k| away[k] - height * up[k])
    };
    let moment = |a: usize, b: usize| heights.iter().map(|of| of.weight * level(of)[a] * level(of)[b]).sum::<f64>();
    let eigen = Mat::from_fn(D, D, moment).self_adjoint_eigen(Side::Lower);
    // The smallest value is that of the vertical itself.
    eigen.map_or(f64::INFINITY, |eigen| 1.0 / eigen.S()[1].max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use crate::calibrate::{Calibrated, calibrate_either};
    use crate::{
        CalibrateOptions, Calibration, MeasuredPosition, Node, SimulateOptions, Simulation, calibrate, simulate,
    };
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    fn room(seed: u64) -> Simulation<3> {
        let mut made = SimulateOptions::<3>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (10, 30, 0.01, seed);
        simulate(&made).unwrap()
    }

    fn heights(of: &[[f64; 3]], sigma: f64, seed: u64) -> CalibrateOptions<3> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let known = |(i, p): (usize, &[f64; 3])| MeasuredPosition {
            node: Node::Receiver(i),
            position: [None, None, Some(p[2] + sigma * rng.sample::<f64, _>(StandardNormal))],
            sigma: [0.0, 0.0, sigma],
        };
        let positions = of.iter().enumerate().map(known).collect();
        CalibrateOptions { positions, ..CalibrateOptions::new() }
    }

    /// Largest error of a height.
    fn off(found: &Calibration<3>, truth: &[[f64; 3]]) -> f64 {
        let pairs = found.receivers.iter().flatten().zip(truth);
        pairs.map(|(a, b)| (a[2] - b[2]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn heights_turn_a_room_upright() {
        for seed in 0..3 {
            let made = room(seed);
            let truth = &made.network.receivers;
            let options = heights(truth, 0.02, seed);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            // Nearly all of a height's error is the tilt of 2 cm on some metres.
            assert!(off(&found, truth) < 0.1, "seed {seed}: {}", off(&found, truth));
            assert!(found.unique && found.warnings.iter().any(|warning| warning.contains("turn about the vertical")));
            // The shape is what it is without them.
            let free = calibrate(&made.pseudoranges, &CalibrateOptions::<3>::new()).unwrap();
            assert_eq!(found.residuals, free.residuals);
            let Ok(Calibrated::Space(chosen)) = calibrate_either(&made.pseudoranges, &options, &Default::default())
            else {
                panic!("seed {seed}")
            };
            assert!(off(&chosen, truth) < 0.1, "seed {seed}");
        }
    }

    #[test]
    fn three_heights_leave_above_and_below_open() {
        let made = room(4);
        let truth = &made.network.receivers;
        let found = calibrate(&made.pseudoranges, &heights(&truth[..3], 0.0, 4)).unwrap();
        assert!(!found.unique && found.warnings.iter().any(|warning| warning.contains("what is above may be below")));
        // These three are as high as they are said to be, whichever it is.
        assert!(off(&found, &truth[..3]) < 0.05, "{}", off(&found, &truth[..3]));
    }

    #[test]
    fn heights_that_cannot_be_are_said() {
        let made = room(5);
        let mut wrong = made.network.receivers.clone();
        wrong.iter_mut().step_by(2).for_each(|p| p[2] += 2.0);
        let found = calibrate(&made.pseudoranges, &heights(&wrong, 0.02, 5)).unwrap();
        assert!(!found.unique && found.warnings.iter().any(|warning| warning.contains("known heights contradict")));
        let two = heights(&made.network.receivers[..2], 0.02, 5);
        let error = calibrate(&made.pseudoranges, &two).unwrap_err().to_string();
        assert!(error.contains("heights of three"), "{error}");
    }
}
