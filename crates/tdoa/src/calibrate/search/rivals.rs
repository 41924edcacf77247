//! Networks that fit as well as the best one where few measurements are left over, but in which no
//! start of the search ends.
//!
//! A receiver with a gross error among its few measurements may have two places, each of which
//! leaves out one or two of its measurements. The search takes the place that its own loss prefers,
//! even if it starts from exact solutions or from the truth. That loss grows with the size of the
//! error that is left out. Here every place of every single node is tried together with the best
//! network of the other nodes, and refined under the truncated cost, which does not grow with it.

use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::search::same_network::same;
use crate::calibrate::search::truncated_cost::{annealed, refit, refit_annealed};
use crate::calibrate::state::State;
use crate::loss::{Loss, SEARCH_NU};
use crate::network::Network;
use crate::refine::{RefinedNetwork, places_of_receiver, places_of_transmitter};

/// Measurements left over, outliers not counted, above which no rivals are looked for: a node has
/// then more to agree with than another place can.
const MOST_LEFT_OVER: usize = 20;

/// Adds their rivals to the networks of a state.
pub(crate) fn add_rivals<const D: usize>(state: &mut State<'_, D>) -> Result<(), CalibrateError<D>> {
    let State { observations, ranked, deviation, options, monitor, .. } = state;
    let deviation = *deviation;
    let limit = options.inlier_threshold * deviation;
    let (best, cost) = refit(observations, &ranked[0].network, deviation, monitor)?;
    let suspected = observations.all().iter().filter(|o| o.residual(&best).abs() > limit).count();
    let left_over = (observations.len() - suspected).saturating_sub(observations.unknowns());
    if suspected == 0 || left_over > MOST_LEFT_OVER || !cost.is_finite() {
        return Ok(());
    }
    let loss = Loss { nu: SEARCH_NU, scale: 3.0 * deviation };
    let mut starts: Vec<Network<D>> = Vec::new();
    for i in (0..observations.receivers).filter(|&i| !observations.held()[i]) {
        check(monitor)?;
        // What its measurements have bent the others to is undone first.
        let others = refit(&observations.subset(|o| o.receiver != i), &best, deviation, monitor)?.0;
        for place in places_of_receiver(observations, &others, i, &loss) {
            let mut network = others.clone();
            network.receivers[i] = place.position;
            starts.push(network);
        }
    }
    for j in 0..observations.transmitters {
        check(monitor)?;
        let others = refit(&observations.subset(|o| o.transmitter != j), &best, deviation, monitor)?.0;
        for place in places_of_transmitter(observations, &others, j, &loss) {
            let mut network = others.clone();
            (network.transmitters[j], network.offsets[j]) = (place.position, place.offset);
            starts.push(network);
        }
    }
    let carried = |network: &Network<D>| refit_annealed(observations, network, annealed(3.0), deviation, monitor);
    let carried = starts.iter().filter(|network| network.is_finite()).map(carried);
    let mut found: Vec<(Network<D>, f64)> = carried.collect::<Result<_, _>>()?;
    found.retain(|(network, new)| *new <= cost + options.alternative_margin && network.is_finite());
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    // Costs are put on the scale of the last refinement's objectives.
    let (shift, scale) = (ranked[0].objective - cost, ranked[0].scale);
    for (network, new) in found {
        if !same(&best, &network) && !ranked.iter().any(|r| same(&r.network, &network)) {
            ranked.push(RefinedNetwork { network, scale, objective: new + shift, starts: 1 });
        }
    }
    ranked.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::accuracy::cramer_rao;
    use crate::align::align;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

    #[test]
    fn the_truth_is_listed_where_a_receiver_has_two_places() {
        // Two gross errors in seven receivers' measurements of five transmitters: the network that
        // the search ends in, from the truth too, costs about as much as the truth.
        for seed in [5012, 5032] {
            let options = SimulateOptions {
                receivers: 7,
                transmitters: 5,
                noise: 0.01,
                outliers: 2.0 / 35.0,
                seed,
                ..Default::default()
            };
            let simulation = simulate(&options).unwrap();
            let truth = &simulation.network;
            let options = CalibrateOptions { sigma: Some(0.01), seed, ..Default::default() };
            let found = calibrate(&simulation.pseudoranges, &options).unwrap();
            let bound = cramer_rao(&simulation.pseudoranges, &simulation.outliers, truth, 0.01);
            let all = found.alternatives.iter().map(|other| &other.receivers).chain([&found.receivers]);
            let near = |receivers: &Vec<Option<[f64; 2]>>| {
                let pairs = receivers.iter().zip(&truth.receivers).filter_map(|(p, q)| Some(((*p)?, *q)));
                let (placed, known): (Vec<_>, Vec<_>) = pairs.unzip();
                align(&placed, &known, false).is_some_and(|alignment| alignment.rms < 3.0 * bound)
            };
            assert!(all.into_iter().any(near), "seed {seed}: {:?}", found.alternatives.len());
        }
    }
}
