//! Networks with clocks, for tests.

use super::{Emissions, Recorders};
use crate::network::Network;
use crate::network::tests::random;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;

/// Receivers that share a recorder.
const CHANNELS: usize = 2;

/// What is unknown of clocks: of emissions, and of recorders nothing, offsets, or offsets and drifts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Model {
    pub(crate) emissions: Emissions,
    pub(crate) recorders: usize,
    /// Whether something is expected of the clocks.
    pub(crate) expecting: bool,
}

/// Expected deviations of offsets, and of drifts over half the recording, metres, and that of the measurements.
pub(crate) const EXPECTED: [f64; 2] = [0.4, 0.3];
pub(crate) const SIGMA: f64 = 0.02;

/// All models.
pub(crate) fn models() -> impl Iterator<Item = Model> {
    let all = [Emissions::Unknown, Emissions::Known, Emissions::Constant];
    let models = all
        .into_iter()
        .flat_map(|emissions| (0..3).map(move |recorders| Model { emissions, recorders, expecting: false }));
    // The offset of the first recorder would be a constant.
    models.filter(|model| model.emissions != Emissions::Known || model.recorders == 0)
}

/// Models in which something is expected of the clocks.
pub(crate) fn expecting() -> impl Iterator<Item = Model> {
    models().filter(|model| model.recorders > 0).map(|model| Model { expecting: true, ..model })
}

impl Model {
    /// A random network with such clocks, and all measurements but three.
    pub(crate) fn network<const D: usize>(self, m: usize, n: usize) -> (Network<D>, Pseudoranges) {
        let mut network: Network<D> = random(m, n, 2);
        match self.emissions {
            Emissions::Unknown => {}
            Emissions::Known => network.offsets.fill(0.0),
            Emissions::Constant => network.offsets.fill(0.7),
        }
        let time = |j: usize| 2.0 * j as f64 / (n - 1) as f64 - 1.0;
        let clock = |i: usize| {
            let recorder = (i / CHANNELS) as f64;
            [(1.0 + recorder).sin(), if self.recorders == 2 { (2.0 + 3.0 * recorder).cos() } else { 0.0 }]
        };
        if self.recorders > 0 {
            network.clocks = (0..m).map(clock).collect();
        }
        // Where clocks drift, times are those of these readings.
        let readings: Vec<f64> = (0..m * n).map(|k| 100.0 * time(k % n)).collect();
        let names = (0..m).map(|i| format!("rec{}", i / CHANNELS)).collect();
        let readings = Pseudoranges::new(m, n, readings).unwrap().with_recorders(names).unwrap();
        let clocks = match self.recorders {
            0 => None,
            1 => Some(Recorders::with_offsets(readings.recorders())),
            _ => Some(Recorders::with_rates(readings.recorders(), readings.cells())),
        };
        let [offset, drift] = EXPECTED;
        let expected = |recorders: Recorders| {
            let rate = recorders.rate(drift);
            recorders.expecting(Some(offset), Some(rate))
        };
        let clocks = if self.expecting { clocks.map(expected) } else { clocks };
        let mut values = network.pseudoranges();
        for (k, value) in values.iter_mut().enumerate() {
            let [offset, drift] = network.clocks.get(k / n).copied().unwrap_or_default();
            *value += offset + drift * clocks.as_ref().map_or(0.0, |clocks| clocks.time(k / n, k % n));
        }
        [1, n + 3, 2 * n + 4].into_iter().for_each(|k| values[k] = f64::NAN);
        let measured = Pseudoranges::new(m, n, values).unwrap().with_emissions(self.emissions);
        (network, measured.with_unknown_clocks(clocks).at_deviation(SIGMA))
    }

    /// Unknowns of a network of this size: those of nodes, less a rigid motion, and those of clocks.
    fn unknowns<const D: usize>(self, m: usize, n: usize) -> usize {
        let recorders = m.div_ceil(CHANNELS);
        // The first is the reference.
        let of_recorders = self.recorders * (recorders - 1);
        let offsets = match self.emissions {
            Emissions::Unknown => n,
            Emissions::Known => 0,
            Emissions::Constant => 1,
        };
        D * (m + n) - D * (D + 1) / 2 + offsets + of_recorders
    }
}

/// Values of the clocks' unknowns, one after the other, and networks and unknowns that agree.
fn are_as_the_model_says<const D: usize>(m: usize, n: usize) {
    for model in models() {
        let (network, measured) = model.network::<D>(m, n);
        let observations = Observations::<D>::new(&measured, |_, _| true);
        assert!(observations.all().iter().all(|o| o.residual(&network).abs() < 1e-12), "{model:?}");
        assert_eq!(observations.unknowns(), model.unknowns::<D>(m, n), "{model:?}");
        // Terms are derivatives.
        let step = 1e-6;
        for at in 0..observations.clocks().count() {
            let mut changes = vec![0.0; observations.clocks().count()];
            changes[at] = step;
            let mut moved = network.clone();
            observations.clocks().add(&mut moved, &changes, 1.0);
            for (k, o) in observations.all().iter().enumerate() {
                let by_difference = (o.residual(&moved) - o.residual(&network)) / step;
                let terms = observations.clock_terms().of(k).iter();
                let term = terms.filter(|(to, _)| *to == D * m + at).map(|(_, x)| x).sum::<f64>();
                assert!((by_difference - term).abs() < 1e-8, "{model:?}: {by_difference} {term}");
            }
        }
    }
}

#[test]
fn unknowns_and_terms_are_those_of_the_model() {
    are_as_the_model_says::<2>(7, 8);
    are_as_the_model_says::<3>(8, 9);
}

/// The misfit of clocks is the sum of the squares that its front page says, and its derivatives are those by differences,
/// whatever has been taken off the measurements.
#[test]
fn expected_clocks_are_normal_about_their_mean() {
    for model in expecting() {
        let (network, measured) = model.network::<2>(8, 9);
        let clocks =
            |network: &Network<2>| -> Vec<[f64; 2]> { network.clocks.iter().step_by(CHANNELS).copied().collect() };
        let by_definition = |all: &[[f64; 2]]| -> f64 {
            let of = |k: usize| {
                let mean = all.iter().map(|clock| clock[k]).sum::<f64>() / all.len() as f64;
                all.iter().map(|clock| ((clock[k] - mean) / EXPECTED[k]).powi(2)).sum::<f64>()
            };
            0.5 * (0..model.recorders).map(of).sum::<f64>()
        };
        let observations = Observations::<2>::new(&measured, |_, _| true);
        let prior = observations.clocks().prior().unwrap();
        let wanted = by_definition(&clocks(&network));
        assert!((prior.misfit(&network) - wanted).abs() < 1e-12 * wanted, "{model:?}");
        let moved = |at: usize, by: f64| {
            let (mut moved, mut changes) = (network.clone(), vec![0.0; observations.clocks().count()]);
            changes[at] = by;
            observations.clocks().add(&mut moved, &changes, 1.0);
            moved
        };
        let gradient = |network: &Network<2>, at: usize| -> f64 {
            prior.gradient(network).filter(|(of, _)| *of == at).map(|(_, slope)| slope).sum()
        };
        let step = 1e-5;
        for at in 0..observations.clocks().count() {
            let [above, below] = [step, -step].map(|by| moved(at, by));
            let slope = (prior.misfit(&above) - prior.misfit(&below)) / (2.0 * step);
            assert!((slope - gradient(&network, at)).abs() < 1e-6, "{model:?} {at}: {slope}");
            for other in 0..observations.clocks().count() {
                let second = (gradient(&above, other) - gradient(&below, other)) / (2.0 * step);
                let all = prior.curvature().filter(|(a, b, _)| (*a, *b) == (at, other));
                let curvature: f64 = all.map(|(.., curvature)| curvature).sum();
                assert!((second - curvature).abs() < 1e-6, "{model:?} {at} {other}: {second} {curvature}");
            }
        }
        // The same clocks, once they are taken off.
        let recorders = measured.unknown_clocks().unwrap().clone().taking(&network.clocks);
        let taken = Observations::<2>::new(&measured.with_unknown_clocks(Some(recorders)), |_, _| true);
        let rest = Network { clocks: vec![[0.0; 2]; 8], ..network };
        assert!((taken.clocks().prior().unwrap().misfit(&rest) - wanted).abs() < 1e-12 * wanted);
    }
}
