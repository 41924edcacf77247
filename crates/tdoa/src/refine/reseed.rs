//! Single nodes located anew from all others. A joint minimisation cannot carry a node across a
//! ridge of its own cost; multilateration can.

use super::cancel::{Cancelled, check};
use crate::loss::Loss;
use crate::multilateration::{self, Located, Sight};
use crate::network::Network;
use crate::observations::{Observation, Observations};
use hc::Monitor;

/// A node moves only if the cost of its measurements falls by more than this (units of
/// log-likelihood).
const GAIN: f64 = 0.01;

/// Locates every transmitter from the receivers, which alone of `network` are used. Transmitters
/// that cannot be located keep their place; their number is returned.
pub(crate) fn place_transmitters<const D: usize>(
    observations: &Observations<D>,
    network: &mut Network<D>,
    loss: &Loss,
) -> usize {
    let mut sights = Vec::new();
    let mut kept = 0;
    for j in 0..observations.transmitters {
        sights_of_transmitter(observations, network, j, &mut sights);
        match locate_transmitter(observations, &sights, None, loss) {
            Some(found) => {
                network.transmitters[j] = found.position;
                network.offsets[j] = found.offset;
            }
            None => kept += 1,
        }
    }
    kept
}

/// A transmitter by what receivers measured of it. One that shares its offset with all others has this one, if it is
/// given: it is located as a receiver is.
pub(super) fn locate_transmitter<const D: usize>(
    observations: &Observations<D>,
    sights: &[Sight<D>],
    offset: Option<f64>,
    loss: &Loss,
) -> Option<Located<D>> {
    match observations.emissions().shared(offset) {
        None => multilateration::transmitter(sights, loss),
        Some(offset) => {
            multilateration::receiver(&without(offset, sights), loss).map(|found| Located { offset, ..found })
        }
    }
}

/// What is left of sights without an offset.
fn without<const D: usize>(offset: f64, sights: &[Sight<D>]) -> Vec<Sight<D>> {
    sights.iter().map(|sight| Sight { length: sight.length - offset, ..*sight }).collect()
}

/// Locates every transmitter, then every receiver that is not held, from all other nodes and moves
/// those whose measurements then fit better. Returns how many moved.
pub(crate) fn reseed<const D: usize>(
    observations: &Observations<D>,
    network: &mut Network<D>,
    loss: &Loss,
    monitor: &Monitor,
) -> Result<usize, Cancelled> {
    let mut sights = Vec::new();
    let mut moved = 0;
    for j in 0..observations.transmitters {
        sights_of_transmitter(observations, network, j, &mut sights);
        check(monitor)?;
        let now = multilateration::cost(&sights, network.transmitters[j], network.offsets[j], loss);
        let offset = Some(network.offsets[j]);
        if let Some(found) = better(locate_transmitter(observations, &sights, offset, loss), now) {
            network.transmitters[j] = found.position;
            network.offsets[j] = found.offset;
            moved += 1;
        }
    }
    for i in (0..observations.receivers).filter(|&i| !observations.held()[i]) {
        sights_of_receiver(observations, network, i, &mut sights);
        check(monitor)?;
        let now = multilateration::cost(&sights, network.receivers[i], 0.0, loss);
        if let Some(found) = better(multilateration::receiver(&sights, loss), now) {
            network.receivers[i] = found.position;
            moved += 1;
        }
    }
    Ok(moved)
}

/// Places of a transmitter that all others leave it, whatever they cost.
pub(crate) fn places_of_transmitter<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    j: usize,
    loss: &Loss,
) -> Vec<Located<D>> {
    let mut sights = Vec::new();
    sights_of_transmitter(observations, network, j, &mut sights);
    match observations.emissions().shared(Some(network.offsets[j])) {
        None => multilateration::transmitters(&sights, loss),
        Some(offset) => {
            let found = multilateration::receivers(&without(offset, &sights), loss);
            found.into_iter().map(|place| Located { offset, ..place }).collect()
        }
    }
}

/// Places of a receiver that all others leave it, whatever they cost.
pub(crate) fn places_of_receiver<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    i: usize,
    loss: &Loss,
) -> Vec<Located<D>> {
    let mut sights = Vec::new();
    sights_of_receiver(observations, network, i, &mut sights);
    multilateration::receivers(&sights, loss)
}

fn better<const D: usize>(found: Option<Located<D>>, now: f64) -> Option<Located<D>> {
    found.filter(|f| f.cost < now - GAIN)
}

fn sights_of_transmitter<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    j: usize,
    sights: &mut Vec<Sight<D>>,
) {
    let sight = |o: &Observation| Sight {
        position: network.receivers[o.receiver],
        length: o.synchronised(network),
        precision: o.precision,
    };
    sights.clear();
    sights.extend(observations.of_transmitter(j).iter().map(sight));
}

fn sights_of_receiver<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    i: usize,
    sights: &mut Vec<Sight<D>>,
) {
    let sight = |o: &Observation| Sight {
        position: network.transmitters[o.transmitter],
        length: o.length(network),
        precision: o.precision,
    };
    sights.clear();
    sights.extend(observations.of_receiver(i).map(sight));
}
