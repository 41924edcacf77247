//! Networks as rooms, arrays and equipment have them, of whose model nothing is said to the calibration.

use super::calibration::{apart, coverage, oracle};
use rand::seq::SliceRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use std::array::from_fn;
use std::f64::consts::TAU;
use tdoa::calibrate::{Calibrated, CalibratedError, Calibration, calibrate_either};
use tdoa::{
    CalibrateOptions, MeasuredPosition, Monitor, Network, Node, PseudorangeError, Pseudoranges, ReceiverDelays,
};

/// A calibration is wrong if its receivers are farther from the truth than this share of the network's size, and
/// this many times farther than least squares that starts at the truth and has no other errors than noise.
const WRONG: (f64, f64) = (0.02, 3.0);

/// Mirror images of which all choices are looked at, at most.
const MOST_SIDES: usize = 12;

/// A kind of network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// All nodes in one plane: 8 receivers and 12 transmitters in 10 m by 8 m.
    Plane,
    /// All nodes in one plane: 12 receivers and 40 transmitters.
    LargePlane,
    /// Radio anchors at two heights, a tag in a hand.
    TwoHeights,
    /// A square kilometre with hills of 30 m.
    Hills,
    /// Six microphones on a table, up to 2 cm above it, and talkers around it.
    Table,
    /// Radio anchors in six corners of a room.
    Corners,
    /// Receivers in a room of which the heights alone are known, to 2 cm.
    KnownHeights,
    /// Receivers in a room, each with a constant delay of its own (5 cm).
    Delays,
    /// A source that flies straight over an array.
    StraightFlight,
    /// A source that flies a circle around an array.
    CircularFlight,
    /// Receivers on the floor and on the ceiling.
    FloorAndCeiling,
    /// A room; one receiver hears a wall's echo of half of the events.
    Echo,
    /// A plane; one receiver's clock drifts.
    Drift,
    /// A room; three tenths of the measurements are late by reflections.
    Reflections,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Kind; 14] = [
        Kind::Plane,
        Kind::LargePlane,
        Kind::TwoHeights,
        Kind::Hills,
        Kind::Table,
        Kind::Corners,
        Kind::KnownHeights,
        Kind::Delays,
        Kind::StraightFlight,
        Kind::CircularFlight,
        Kind::FloorAndCeiling,
        Kind::Echo,
        Kind::Drift,
        Kind::Reflections,
    ];

    /// The name of the kind in tables.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Plane => "plane",
            Kind::LargePlane => "large plane",
            Kind::TwoHeights => "anchors at two heights",
            Kind::Hills => "hills",
            Kind::Table => "table",
            Kind::Corners => "anchors in corners",
            Kind::KnownHeights => "known heights",
            Kind::Delays => "delays",
            Kind::StraightFlight => "straight flight",
            Kind::CircularFlight => "circular flight",
            Kind::FloorAndCeiling => "floor and ceiling",
            Kind::Echo => "echo",
            Kind::Drift => "drift",
            Kind::Reflections => "reflections",
        }
    }

    /// A network of this kind, its measurements and the options of a user who says nothing of its model.
    ///
    /// # Errors
    /// None for these sizes; those of [`Pseudoranges::new`] are passed on.
    pub fn network(self, seed: u64) -> Result<Instance, PseudorangeError> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed ^ 0x51ce_0f6a_8d30_7b11 ^ ((self as u64) << 40));
        let rng = &mut rng;
        let room = [10.0, 8.0, 3.0];
        let hill = {
            let [a, b]: [f64; 2] = from_fn(|_| TAU * rng.random::<f64>());
            move |x: f64, y: f64| 15.0 * ((x / 150.0 + a).sin() + (y / 130.0 + b).cos())
        };
        let (receivers, transmitters, noise) = match self {
            Kind::Plane => (within(rng, 8, [10.0, 8.0, 0.0]), within(rng, 12, [10.0, 8.0, 0.0]), 0.01),
            Kind::LargePlane => (within(rng, 12, [10.0, 8.0, 0.0]), within(rng, 40, [10.0, 8.0, 0.0]), 0.01),
            Kind::TwoHeights => {
                let anchors = (0..8).map(|i| {
                    let at = TAU * i as f64 / 8.0;
                    [
                        4.0 + 4.5 * at.cos() + jitter(rng, 0.5),
                        3.0 + 3.5 * at.sin() + jitter(rng, 0.5),
                        [0.3, 2.3][i % 2],
                    ]
                });
                let anchors = anchors.collect();
                let tag = |p: [f64; 3]| [p[0], p[1], 1.1 + 0.1 * p[2]];
                (anchors, within(rng, 60, [8.0, 6.0, 3.0]).into_iter().map(tag).collect(), 0.05)
            }
            Kind::Hills => {
                let on_ground = |p: [f64; 3], above: f64| [p[0], p[1], hill(p[0], p[1]) + above];
                let receivers = within(rng, 12, [1000.0, 1000.0, 0.0]).into_iter().map(|p| on_ground(p, 1.5)).collect();
                let transmitters = within(rng, 40, [1000.0, 1000.0, 0.0]).into_iter().map(|p| on_ground(p, 1.0));
                (receivers, transmitters.collect(), 0.3)
            }
            Kind::Table => {
                let talker = |p: [f64; 3]| [p[0] - 0.8, p[1] - 0.9, 0.3 + p[2]];
                (
                    within(rng, 6, [2.4, 1.2, 0.02]),
                    within(rng, 40, [4.0, 3.0, 0.9]).into_iter().map(talker).collect(),
                    0.01,
                )
            }
            Kind::Corners => {
                let mut corners: Vec<[f64; 3]> = (0..8)
                    .map(|k| from_fn(|axis| if k >> axis & 1 == 1 { [8.0, 6.0, 2.8][axis] } else { 0.0 }))
                    .collect();
                corners.shuffle(rng);
                corners.truncate(6);
                (corners, within(rng, 40, [8.0, 6.0, 2.0]), 0.05)
            }
            Kind::StraightFlight => {
                let direction = TAU * rng.random::<f64>();
                let flight = (0..30).map(|k| {
                    let along = 3.0 * (k as f64 - 14.5);
                    [along * direction.cos() + 2.0, along * direction.sin() - 3.0, 15.0 + 0.01 * along]
                });
                (within(rng, 9, [20.0, 20.0, 4.0]), flight.collect(), 0.05)
            }
            Kind::CircularFlight => {
                let flight = (0..40).map(|k| {
                    let at = TAU * k as f64 / 40.0;
                    [5.0 + 25.0 * at.cos(), 5.0 + 25.0 * at.sin(), 12.0]
                });
                let flight = flight.collect();
                (within(rng, 9, [10.0, 10.0, 3.0]), flight, 0.05)
            }
            Kind::FloorAndCeiling => {
                let receivers = within(rng, 10, room)
                    .into_iter()
                    .enumerate()
                    .map(|(i, p)| [p[0], p[1], [0.0, 3.0][i % 2]])
                    .collect();
                (receivers, within(rng, 30, room), 0.01)
            }
            Kind::Drift => (within(rng, 10, [10.0, 8.0, 0.0]), within(rng, 30, [10.0, 8.0, 0.0]), 0.01),
            Kind::KnownHeights | Kind::Delays | Kind::Echo | Kind::Reflections => {
                (within(rng, 10, room), within(rng, 30, room), 0.01)
            }
        };
        let (m, n) = (receivers.len(), transmitters.len());
        let offsets = (0..n).map(|_| 30.0 * (rng.random::<f64>() - 0.5)).collect();
        let truth = Network::new(receivers, transmitters, offsets);
        let mut values: Vec<f64> =
            truth.pseudoranges().into_iter().map(|f| f + noise * rng.sample::<f64, _>(StandardNormal)).collect();
        let with_noise = Pseudoranges::new(m, n, values.clone())?;
        let mut options = CalibrateOptions::<3>::new();
        options.seed = seed;
        match self {
            Kind::KnownHeights => {
                let known = |(i, p): (usize, &[f64; 3])| MeasuredPosition {
                    node: Node::Receiver(i),
                    position: [None, None, Some(p[2])],
                    sigma: [0.0, 0.0, 0.02],
                };
                options.positions = truth.receivers.iter().enumerate().map(known).collect();
            }
            Kind::Delays => {
                options.receiver_delays = ReceiverDelays::Auto;
                for row in values.chunks_exact_mut(n) {
                    let delay = 0.05 * rng.sample::<f64, _>(StandardNormal);
                    row.iter_mut().for_each(|value| *value += delay);
                }
            }
            Kind::Echo => {
                // The wall x = -0.7, whose mirror image of the receiver hears what the receiver hears late.
                let mut mirrored = truth.clone();
                mirrored.receivers[0][0] = -1.4 - truth.receivers[0][0];
                for (j, value) in values[..n].iter_mut().enumerate() {
                    if rng.random::<bool>() {
                        *value += mirrored.distance(0, j) - truth.distance(0, j);
                    }
                }
            }
            Kind::Drift => {
                options.receiver_delays = ReceiverDelays::Auto;
                values[..n].iter_mut().enumerate().for_each(|(j, value)| *value += 0.5 * j as f64 / (n - 1) as f64);
            }
            Kind::Reflections => {
                let mut late: Vec<usize> = (0..m * n).collect();
                late.shuffle(rng);
                late[..3 * m * n / 10].iter().for_each(|&k| values[k] -= 1.5 * (1.0 - rng.random::<f64>()).ln());
            }
            _ => {}
        }
        Ok(Instance { measured: Pseudoranges::new(m, n, values)?, with_noise, truth, options })
    }
}

/// A network, what was measured in it, and how it is calibrated.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The measurements.
    pub measured: Pseudoranges,
    /// These with their noise alone, without delays, drift, echoes and reflections.
    pub with_noise: Pseudoranges,
    /// The network in space.
    pub truth: Network<3>,
    /// The options of the calibration.
    pub options: CalibrateOptions<3>,
}

/// How one calibration went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Coordinates of the nodes that it reports, 2 or 3; 0 if there is no calibration.
    pub dimensions: usize,
    /// Whether the program ends with exit status 0.
    pub trusted: bool,
    /// Whether it calls the network unique.
    pub unique: bool,
    /// Root mean square distance of the receivers from the truth after the best rigid motion in space, metres.
    pub error: Option<f64>,
    /// The least such distance of the network, whichever sides its mirror images take, and of the alternatives that are
    /// listed beside it, metres.
    pub nearest: Option<f64>,
    /// Likewise of least squares that starts at the true receivers and has measurements with noise alone, in the plane
    /// where all nodes lie in one, metres; `None` if it finds no network.
    pub oracle: Option<f64>,
    /// Root mean square error of the receivers' heights, where heights were given to the calibration, metres.
    pub heights: Option<f64>,
    /// Size of the true network, metres.
    pub size: f64,
    /// 95 % ellipses of receivers that hold the truth, and their number.
    pub covered: (usize, usize),
}

impl Outcome {
    /// Whether the receivers are not where they are said to be, or not as high as they were known to be.
    pub fn is_wrong(&self) -> bool {
        self.error.is_some_and(|error| error > self.near()) || self.is_tilted()
    }

    /// Whether known heights have not turned it upright.
    fn is_tilted(&self) -> bool {
        self.heights.is_some_and(|error| error > self.near())
    }

    /// Whether the receivers are elsewhere than the network, its mirror images and all alternatives have them.
    pub fn is_unlisted(&self) -> bool {
        self.nearest.is_some_and(|error| error > self.near()) || self.is_tilted()
    }

    /// The largest error of a right network, metres.
    fn near(&self) -> f64 {
        self.oracle.map_or(0.0, |oracle| WRONG.1 * oracle).max(WRONG.0 * self.size)
    }
}

/// Calibrates a network and compares with its truth.
pub fn outcome(instance: &Instance) -> Outcome {
    let Instance { measured, with_noise, truth, options } = instance;
    let known: Vec<Option<[f64; 3]>> = truth.receivers.iter().copied().map(Some).collect();
    let mut outcome = Outcome { size: truth.size(), ..Outcome::default() };
    let above: Vec<Option<[f64; 2]>> = truth.receivers.iter().map(|p| Some([p[0], p[1]])).collect();
    outcome.oracle = if truth.transmitters.iter().chain(&truth.receivers).all(|p| p[2] == 0.0) {
        let found = oracle(with_noise, &above, &CalibrateOptions::new());
        found.ok().and_then(|found| apart(&found.receivers, &above))
    } else {
        let found = oracle(with_noise, &known, &CalibrateOptions::new());
        found.ok().and_then(|found| apart(&found.receivers, &known))
    };
    match calibrate_either(measured, options, &Monitor::default()) {
        Ok(Calibrated::Space(found)) => {
            let heights = (!options.positions.is_empty()).then(|| of_heights(&found.receivers, truth));
            Outcome { heights, ..outcome.of(&found, &known, &known) }
        }
        // As far as the plane tells: the truth seen from above.
        Ok(Calibrated::Plane(found)) => outcome.of(&found, &known, &above),
        Err(CalibratedError::Plane(_) | CalibratedError::Space(_)) => outcome,
    }
}

impl Outcome {
    /// That of a calibration of receivers that are known in space and in as many coordinates as it has.
    fn of<const D: usize>(
        self,
        found: &Calibration<D>,
        known: &[Option<[f64; 3]>],
        seen: &[Option<[f64; D]>],
    ) -> Outcome {
        let off = |receivers: &[Option<[f64; D]>]| {
            let raised = |p: &[f64; D]| from_fn(|axis| p.get(axis).copied().unwrap_or(0.0));
            apart(&receivers.iter().map(|p| p.as_ref().map(raised)).collect::<Vec<_>>(), known)
        };
        let others = found.alternatives.iter().filter_map(|other| off(&other.receivers));
        let images = found.mirror_images.iter().filter_map(|image| {
            Some((found.receiver_names.iter().position(|name| *name == image.node)?, image.position))
        });
        let images: Vec<(usize, [f64; D])> = images.take(MOST_SIDES).collect();
        let on_sides = (0..1usize << images.len()).filter_map(|sides| {
            let mut receivers = found.receivers.clone();
            let chosen = images.iter().enumerate().filter(|(k, _)| sides >> k & 1 == 1);
            chosen.for_each(|(_, (i, position))| receivers[*i] = Some(*position));
            off(&receivers)
        });
        Outcome {
            dimensions: D,
            trusted: found.distrust().is_none(),
            unique: found.unique,
            error: off(&found.receivers),
            nearest: others.chain(on_sides).reduce(f64::min),
            covered: coverage(found, found.trusted_covariances()[0], seen),
            ..self
        }
    }
}

/// Root mean square difference of the receivers' heights from the true ones.
fn of_heights(receivers: &[Option<[f64; 3]>], truth: &Network<3>) -> f64 {
    let squares = receivers.iter().zip(&truth.receivers).filter_map(|(p, q)| Some((p.as_ref()?[2] - q[2]).powi(2)));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Points evenly distributed in a box from the origin to this corner.
fn within(rng: &mut impl Rng, count: usize, corner: [f64; 3]) -> Vec<[f64; 3]> {
    (0..count).map(|_| corner.map(|side| side * rng.random::<f64>())).collect()
}

/// A number between plus and minus this.
fn jitter(rng: &mut impl Rng, most: f64) -> f64 {
    most * (2.0 * rng.random::<f64>() - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_what_they_say() {
        for kind in Kind::ALL {
            let Instance { measured, truth, .. } = kind.network(3).unwrap();
            let [low, high] = [f64::min, f64::max]
                .map(|of| truth.receivers.iter().chain(&truth.transmitters).map(|p| p[2]).reduce(of).unwrap());
            let flat = matches!(kind, Kind::Plane | Kind::LargePlane | Kind::Drift);
            assert_eq!(high == low, flat, "{kind:?}");
            assert_eq!(measured.observed(), truth.receivers.len() * truth.transmitters.len(), "{kind:?}");
            let other = kind.network(4).unwrap();
            assert!(other.measured.dense() != measured.dense(), "{kind:?}");
        }
    }

    #[test]
    fn heights_of_two_levels_are_not_lost() {
        // In one network of four another one is likelier, which is said.
        let found: Vec<Outcome> = (0..4).map(|seed| outcome(&Kind::TwoHeights.network(seed).unwrap())).collect();
        assert!(found.iter().all(|found| found.dimensions == 3 && !found.unique), "{found:?}");
        let right = found.iter().filter(|found| found.error.unwrap() < 1.1 * found.oracle.unwrap());
        let (held, all) = right.clone().fold((0, 0), |(a, b), found| (a + found.covered.0, b + found.covered.1));
        assert!(right.count() >= 3 && 10 * held >= 9 * all, "{found:?}");
        assert!(found.iter().all(|found| !(found.trusted && found.is_wrong())), "{found:?}");
    }

    #[test]
    fn two_levels_are_said() {
        let Instance { measured, options, .. } = Kind::TwoHeights.network(0).unwrap();
        let Ok(Calibrated::Space(found)) = calibrate_either(&measured, &options, &Monitor::default()) else { panic!() };
        // Anchors at 0.3 and 2.3 m.
        let levels = found.plane_distances.and_then(|distances| distances.levels).unwrap();
        assert!((levels / 2.0).ln().abs() < 0.3, "{levels}");
        assert!(found.warnings.iter().any(|warning| warning.contains("two heights")), "{:?}", found.warnings);
    }

    #[test]
    fn a_straight_flight_is_not_trusted() {
        // Receivers may be turned about its line.
        assert!(!outcome(&Kind::StraightFlight.network(3).unwrap()).trusted);
    }

    #[test]
    fn an_outcome_counts_what_is_wrong() {
        let found = Outcome { dimensions: 2, size: 5.0, error: Some(0.2), oracle: Some(0.03), ..Outcome::default() };
        assert!(found.is_wrong());
        assert!(
            !Outcome { oracle: Some(0.1), ..found }.is_wrong() && !Outcome { error: Some(0.09), ..found }.is_wrong()
        );
        assert!(!Outcome { error: None, ..found }.is_wrong());
    }
}
