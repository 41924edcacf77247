//! Measurements that do not fit and are nearly all late: whether one-sided errors would give
//! another network.

use crate::calibrate::judge::neighbours::{Neighbour, Reason};
use crate::calibrate::options::CalibrateError;
use crate::calibrate::search::one_sided::finish_one_sided;
use crate::calibrate::state::State;
use crate::network::Network;

/// Probability that gross errors of either sign are late as often, at most: three of three.
const CHANCE: f64 = 1.0 / 8.0;

/// Measurements left over, above which gross errors of one sign do not bend a network.
const MOST_LEFT_OVER: usize = 100;

impl<const D: usize> State<'_, D> {
    /// Adds the network that one-sided errors lead to from the best one to the neighbours, if outliers are
    /// nearly all late.
    pub(crate) fn compare_with_one_sided(&mut self) -> Result<(), CalibrateError<D>> {
        let best = &self.ranked[0];
        let (late, all) = self.late_outliers();
        let left_over = (self.observations.len() - all).saturating_sub(self.observations.unknowns());
        if left_over > MOST_LEFT_OVER || as_often(late, all) > CHANCE {
            return Ok(());
        }
        let (ranked, deviation) = finish_one_sided(self, &self.observations, vec![best.clone()], self.deviation)?;
        let of = |network: &Network<D>| Neighbour::new(network, 0.0, Reason::Late { late, all }, &best.network);
        let share = deviation / self.deviation;
        let late = ranked.first().and_then(|refined| of(&refined.network)).map(|neighbour| neighbour.narrowed(share));
        self.neighbours.extend(late);
        Ok(())
    }

    /// Late outliers, and outliers.
    fn late_outliers(&self) -> (usize, usize) {
        let residuals = self.observations.all().iter().map(|o| o.residual(&self.ranked[0].network));
        let outliers = residuals.filter(|e| e.abs() > self.options.inlier_threshold * self.deviation);
        outliers.fold((0, 0), |(late, all), e| (late + usize::from(e > 0.0), all + 1))
    }
}

/// Probability that of so many signs at least so many are positive, where both are as likely.
fn as_often(positive: usize, all: usize) -> f64 {
    let (mut term, mut tail) = (0.5f64.powi(all as i32), 0.0);
    // From all of them down: the number of subsets from one size to the next.
    for negative in 0..=all - positive {
        tail += term;
        term *= (all - negative) as f64 / (negative + 1) as f64;
    }
    tail
}

#[cfg(test)]
mod tests {
    use super::as_often;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

    #[test]
    fn signs_are_those_of_a_fair_coin() {
        assert_eq!(as_often(5, 5), 1.0 / 32.0);
        // 1 + 10 + 45 of 1024.
        assert_eq!(as_often(8, 10), 56.0 / 1024.0);
        assert_eq!([as_often(0, 0), as_often(0, 7)], [1.0, 1.0]);
    }

    #[test]
    fn late_measurements_that_have_bent_a_network_are_told() {
        // A third of 96 measurements late; as noise of either sign they bend the network.
        for seed in [20007, 20041] {
            let options = SimulateOptions {
                receivers: 8,
                transmitters: 12,
                noise: 0.01,
                detours: 0.3,
                detour_size: 0.5,
                seed,
                ..Default::default()
            };
            let simulation = simulate(&options).unwrap();
            let found = calibrate(&simulation.pseudoranges, &CalibrateOptions { seed, ..Default::default() }).unwrap();
            assert!(!found.unique && !found.alternatives.is_empty(), "seed {seed}");
            assert!(found.warnings.iter().any(|warning| warning.contains("--errors one-sided")), "seed {seed}");
        }
    }
}
