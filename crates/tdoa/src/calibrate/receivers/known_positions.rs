//! The last refinement with prior knowledge: first the propagation speed from known distances, then
//! with nodes held at their known positions.

use crate::calibrate::input::anchors::Anchors;
use crate::calibrate::input::speed::speed;
use crate::calibrate::options::CalibrateError;
use crate::calibrate::search::deviation::median_size;
use crate::calibrate::search::one_sided::noise;
use crate::calibrate::state::State;
use crate::degeneracy::Usable;
use crate::flatness::Plane;
use crate::network::Network;
use crate::observations::{Node, Observation, Observations, Pin};
use crate::quantity::length;
use crate::refine::covariance;

impl<const D: usize> State<'_, D> {
    /// Estimates the propagation speed, then refines with the nodes of known position in their places.
    pub(crate) fn hold(&mut self, usable: &Usable) -> Result<(), CalibrateError<D>> {
        let State { options, monitor, known, deviation, .. } = *self;
        let mut anchors = Anchors::new(usable, options)?;
        if anchors.is_none() && !options.estimate_speed {
            return Ok(());
        }
        let State { measured, observations, ranked, warnings, .. } = self;
        let best = &ranked[0].network;
        let sigma = known.unwrap_or_else(|| noise(observations, best, deviation, options));
        let kept = Observations::new(measured, |i, j| {
            let residual = best.residual(measured, i, j).unwrap_or(0.0);
            residual.abs() <= options.inlier_threshold * sigma * measured.sigma(i, j).unwrap_or(1.0)
        });
        let sure = known.is_some() || kept.len() > kept.unknowns();
        let uncertainty = covariance(&kept, best, sigma, monitor)?.filter(|_| sure);
        let joint = uncertainty.as_ref().map(|all| all.joint.as_slice());
        let estimate = options.estimate_speed.then(|| speed(best, usable, joint, options)).transpose()?;
        let metre = estimate.map_or(1.0, |speed| speed.factor);
        if let Some(anchors) = &mut anchors {
            anchors.divide(metre);
            let expected = uncertainty.as_ref().map(|all| anchors.expected(all));
            if let Some((node, off)) = expected.and_then(|expected| anchors.culprit(best, 4.0 * expected)) {
                anchors.release(node);
                let name = node.name(measured);
                warnings.push(format!(
                    "the known position of {name} is {} from where the measurements and the other known positions put it, and was not used; \
                     check the position and the name",
                    length(metre * off)
                ));
            }
        }
        self.speed = estimate;
        self.anchors = anchors;
        let Some(anchors) = &self.anchors else { return Ok(()) };
        if let Some(turn) = anchors.free_turn() {
            warnings.push(format!(
                "the known positions leave the network free to turn about {turn}: its turn is arbitrary, and the deviations are those of its \
                 shape; give {} known positions{}",
                if D == 2 { "two" } else { "three" },
                if D == 2 { "" } else { " that are not in one line" }
            ));
            return Ok(());
        }
        let places = anchors;
        let misfit: Vec<f64> = ranked.iter_mut().map(|refined| places.place(refined)).collect();
        let expected = uncertainty.as_ref().map(|all| places.expected(all));
        if let Some(expected) = expected.filter(|expected| misfit.iter().all(|misfit| *misfit > 4.0 * expected)) {
            let count = places.whole.len();
            // As many as fix a frame and its side can contradict, one more can tell.
            let few = match (count, D) {
                (3, 2) => " (one of the three may be wrong; which one can be told with a fourth)",
                (4, 3) => " (one of the four may be wrong; which one can be told with a fifth)",
                _ if count <= D => "",
                _ => " (more than one, or names exchanged)",
            };
            warnings.push(format!(
                "the known positions contradict the distances that the measurements give between these nodes: they are {} (root mean \
                 square) from where the measurements put them, which would be expected to {}{few}; check the positions and names, and the \
                 propagation speed (--estimate-speed)",
                length(metre * misfit[0]),
                length(metre * expected)
            ));
            self.contradiction = Some(misfit[0]);
        }
        if places.leave_mirror() {
            let what = if D == 2 { "line" } else { "plane" };
            warnings.push(format!(
                "the known positions lie in one {what}, so that the mirror image of the network fits as well; give one \
                 off the {what}"
            ));
        }
        *observations = observations.clone().holding(&places.held()).pinned(&places.pins(sigma));
        ranked.iter_mut().for_each(|refined| put_on_known_sides(observations, &mut refined.network));
        // Where few measurements were left over, the free network took up most of the noise.
        let first = known.unwrap_or_else(|| deviation.max(median_size(observations, &ranked[0].network) / 0.6745));
        self.finish(first)
    }
}

/// Puts nodes of which coordinates are known on the side of the plane of those they were measured with where these
/// coordinates have them. A refinement does not carry them through that plane.
fn put_on_known_sides<const D: usize>(observations: &Observations<D>, network: &mut Network<D>) {
    let receivers = (0..observations.receivers).filter(|&i| !observations.held()[i]).map(Node::Receiver);
    for node in receivers.chain((0..observations.transmitters).map(Node::Transmitter)) {
        let pins: Vec<&Pin> = observations.pins().iter().filter(|pin| pin.node == node).collect();
        if pins.is_empty() {
            continue;
        }
        let (cells, others): (Vec<Observation>, Vec<[f64; D]>) = match node {
            Node::Receiver(i) => observations.of_receiver(i).map(|o| (*o, network.transmitters[o.transmitter])).unzip(),
            Node::Transmitter(j) => {
                observations.of_transmitter(j).iter().map(|o| (*o, network.receivers[o.receiver])).unzip()
            }
        };
        let Some(plane) = Plane::through(&others) else { continue };
        let misfit = |network: &Network<D>| {
            let known = pins.iter().map(|pin| pin.residual(network).powi(2));
            known.chain(cells.iter().map(|o| o.residual(network).powi(2))).sum::<f64>()
        };
        let mut other = network.clone();
        *node.of_mut(&mut other) = plane.mirrored(node.of(network));
        if misfit(&other) < misfit(network) {
            *network = other;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        CalibrateOptions, Calibration, KnownDistance, MeasuredPosition, Node, SimulateOptions, Simulation, calibrate,
        simulate,
    };
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    const SIGMA: f64 = 0.01;

    fn simulation(seed: u64) -> Simulation {
        simulate(&SimulateOptions { noise: SIGMA, seed, receivers: 9, transmitters: 12, ..Default::default() }).unwrap()
    }

    fn options(simulation: &Simulation, anchors: &[usize]) -> CalibrateOptions {
        let known = |(i, p): (usize, &[f64; 2])| anchors.contains(&i).then_some(*p);
        let anchors = simulation.network.receivers.iter().enumerate().map(known).collect();
        CalibrateOptions { sigma: Some(SIGMA), anchors, ..Default::default() }
    }

    /// Squared error of a point in terms of its covariance; 2 in the mean.
    fn squared_error(at: [f64; 2], truth: [f64; 2], c: [[f64; 2]; 2]) -> f64 {
        let [x, y] = [at[0] - truth[0], at[1] - truth[1]];
        let det = c[0][0] * c[1][1] - c[0][1] * c[1][0];
        (c[1][1] * x * x - 2.0 * c[0][1] * x * y + c[0][0] * y * y) / det
    }

    #[test]
    fn errors_beside_anchors_have_the_stated_covariance() {
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..60 {
            let simulation = simulation(seed);
            let found = calibrate(&simulation.pseudoranges, &options(&simulation, &[0, 3, 5, 7])).unwrap();
            for (i, truth) in simulation.network.receivers.iter().enumerate() {
                let at = found.receivers[i].unwrap();
                if found.anchored[i] {
                    assert!((at[0] - truth[0]).abs() + (at[1] - truth[1]).abs() < 1e-12, "anchor {i} moved");
                    assert_eq!(found.receiver_std[i], Some([0.0; 2]));
                } else {
                    sum += squared_error(at, *truth, found.receiver_covariance[i].unwrap()) / 2.0;
                    count += 1.0;
                }
            }
        }
        // Sixty networks with one mean each, of deviation at most 1: three deviations of their mean
        // are 0.39.
        assert_eq!(count, 300.0);
        assert!((sum / count - 1.0).abs() < 0.39, "{}", sum / count);
    }

    #[test]
    fn anchors_sharpen_what_they_fix() {
        let deviation = |found: &Calibration| -> f64 {
            let free = found.receiver_std.iter().zip(&found.anchored).filter(|(_, held)| !**held);
            free.map(|(std, _)| std.map_or(0.0, |[x, y]| x * x + y * y)).sum()
        };
        for seed in 0..10 {
            let simulation = simulation(seed);
            let [three, six] = [&[0, 3, 5][..], &[0, 3, 5, 1, 2, 4][..]]
                .map(|anchors| calibrate(&simulation.pseudoranges, &options(&simulation, anchors)).unwrap());
            // The three that are free in both know more with six anchors than with three.
            let of = |found: &Calibration| {
                let mut found = found.clone();
                found.anchored.clone_from(&six.anchored);
                deviation(&found)
            };
            assert!(of(&six) < of(&three), "seed {seed}");
        }
    }

    #[test]
    fn the_speed_is_found_within_its_deviation() {
        let mut squares = Vec::new();
        for seed in 0..60 {
            let simulation = simulation(seed);
            let all = &simulation.network.receivers;
            // As if the speed had been taken 4 % too low.
            let measured = simulation.pseudoranges.dense().iter().map(|f| f / 1.04).collect();
            let measured = crate::Pseudoranges::new(9, 12, measured).unwrap();
            let known = |a: usize, b: usize| {
                let distance = (all[a][0] - all[b][0]).hypot(all[a][1] - all[b][1]);
                KnownDistance { receivers: [a, b], distance, sigma: None }
            };
            let distances = vec![known(0, 4), known(2, 7), known(8, 1)];
            let options =
                CalibrateOptions { distances, estimate_speed: true, sigma: Some(SIGMA / 1.04), ..Default::default() };
            let found = calibrate(&measured, &options).unwrap();
            let speed = found.speed.unwrap();
            squares.push(((speed.factor - 1.04) / speed.factor_std.unwrap()).powi(2));
            assert!((found.sigma / SIGMA - speed.factor / 1.04).abs() < 1e-9);
            // With anchors beside it the whole network has the right size.
            if seed >= 10 {
                continue;
            }
            let mut options = self::options(&simulation, &[0, 3, 5, 7]);
            options.estimate_speed = true;
            let found = calibrate(&measured, &options).unwrap();
            let at = found.receivers[1].unwrap();
            assert!((at[0] - all[1][0]).hypot(at[1] - all[1][1]) < 0.2, "seed {seed}: {at:?}, {:?}", all[1]);
        }
        let mean = squares.iter().sum::<f64>() / 60.0;
        // The square of a normal variable has the deviation sqrt(2): three deviations of the mean
        // are 0.55.
        assert!((mean - 1.0).abs() < 0.55, "{mean}");
    }

    #[test]
    fn one_anchor_moves_two_leave_a_mirror_image() {
        let simulation = simulation(3);
        let one = calibrate(&simulation.pseudoranges, &options(&simulation, &[4])).unwrap();
        let (at, truth) = (one.receivers[4].unwrap(), simulation.network.receivers[4]);
        assert!((at[0] - truth[0]).abs() + (at[1] - truth[1]).abs() < 1e-12);
        assert!(!one.anchored.contains(&true));
        let two = calibrate(&simulation.pseudoranges, &options(&simulation, &[4, 5])).unwrap();
        assert!(two.warnings.iter().any(|warning| warning.contains("mirror image")), "{:?}", two.warnings);
    }

    #[test]
    fn two_anchors_in_space_are_met_and_hold_nothing() {
        let mut made = SimulateOptions::<3>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (10, 20, SIGMA, 3);
        let made = simulate(&made).unwrap();
        let truth = &made.network.receivers;
        let mut options = CalibrateOptions::<3>::new();
        options.sigma = Some(SIGMA);
        options.anchors = (0..10).map(|i| (i == 2 || i == 6).then_some(truth[i])).collect();
        let found = calibrate(&made.pseudoranges, &options).unwrap();
        // The network still turns about the line through both.
        assert!(!found.anchored.contains(&true));
        for i in [2, 6] {
            let off = crate::points::distance(found.receivers[i].unwrap(), truth[i]);
            assert!(off < 0.1, "{off}");
        }
    }

    #[test]
    fn a_wrong_anchor_is_noticed() {
        let simulation = simulation(4);
        let mut options = options(&simulation, &[0, 3, 5, 7]);
        let good = calibrate(&simulation.pseudoranges, &options).unwrap();
        assert!(!good.warnings.iter().any(|warning| warning.contains("known positions")), "{:?}", good.warnings);
        options.anchors[3].as_mut().unwrap()[0] += 1.0;
        let bad = calibrate(&simulation.pseudoranges, &options).unwrap();
        let named =
            |warning: &String| warning.contains("the known position of r4 is") && warning.contains("was not used");
        assert!(bad.warnings.iter().any(named), "{:?}", bad.warnings);
        // Without it the network is where it is.
        let truth = simulation.network.receivers[3];
        let at = bad.receivers[3].unwrap();
        assert!(!bad.anchored[3] && (at[0] - truth[0]).hypot(at[1] - truth[1]) < 0.1, "{at:?} {truth:?}");
    }

    #[test]
    fn measured_positions_have_their_errors() {
        let (mut sum, mut count, mut of_known) = (0.0, 0.0, 0.0);
        for seed in 0..60 {
            let simulation = simulation(seed);
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let mut noisy = |x: f64, sigma: f64| x + sigma * rng.sample::<f64, _>(StandardNormal);
            let truth = &simulation.network.receivers;
            // Four to 5 cm, one of them in x alone, and one to 5 mm.
            let mut position = |receiver: usize, sigma: f64| {
                let [x, y] = truth[receiver].map(|x| Some(noisy(x, sigma)));
                MeasuredPosition {
                    node: Node::Receiver(receiver),
                    position: if receiver == 5 { [x, None] } else { [x, y] },
                    sigma: [sigma; 2],
                }
            };
            let positions =
                vec![position(0, 0.05), position(3, 0.05), position(5, 0.05), position(7, 0.05), position(8, 0.005)];
            let options = CalibrateOptions { sigma: Some(SIGMA), positions, ..Default::default() };
            let found = calibrate(&simulation.pseudoranges, &options).unwrap();
            assert!(!found.anchored.contains(&true));
            for (i, truth) in truth.iter().enumerate() {
                let (at, covariance) = (found.receivers[i].unwrap(), found.receiver_covariance[i].unwrap());
                let square = squared_error(at, *truth, covariance) / 2.0;
                if i == 8 {
                    of_known += square / 60.0;
                    // Better known than by the position alone.
                    assert!(covariance[0][0] < 1.1 * 0.005f64.powi(2), "{covariance:?}");
                }
                (sum, count) = (sum + square, count + 1.0);
            }
        }
        // As for exact ones: three deviations of the mean of sixty networks.
        assert!((sum / count - 1.0).abs() < 0.39 && (of_known - 1.0).abs() < 0.39, "{} {of_known}", sum / count);
    }

    #[test]
    fn positions_that_make_no_frame_are_refused() {
        let simulation = simulation(5);
        let known = |i, position, sigma| MeasuredPosition { node: Node::Receiver(i), position, sigma: [sigma; 2] };
        let both = known(0, [Some(0.0), Some(0.0)], 0.1);
        for (positions, part) in [
            (vec![both, known(1, [Some(1.0), None], 0.1)], "both coordinates of two nodes"),
            (vec![both, known(0, [Some(1.0), Some(2.0)], 0.1)], "is there twice"),
            (vec![both, known(99, [Some(1.0), Some(2.0)], 0.1)], "receiver 100 of 9"),
            (vec![both, known(1, [Some(1.0), Some(2.0)], -0.1)], "must not be negative"),
            (vec![both, known(1, [Some(f64::NAN), Some(2.0)], 0.1)], "is not finite"),
        ] {
            let options = CalibrateOptions { positions, ..Default::default() };
            let error = calibrate(&simulation.pseudoranges, &options).unwrap_err().to_string();
            assert!(error.contains(part), "{part:?} is not in: {error}");
        }
    }
}
