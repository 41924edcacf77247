//! The unknowns of clocks.

use crate::clocks::prior::{ClockPrior, ExpectedClock};
use crate::clocks::{Emissions, Recorders};
use crate::network::Network;

/// Which unknowns the clocks have beside the network's nodes.
#[derive(Debug, Clone, Default)]
pub(crate) struct ClockUnknowns {
    /// The one that all transmitters' offsets are, if they are one.
    constant: Option<usize>,
    /// Per receiver, the offset and the drift of its recorder, as far as they are unknown. Empty where all receivers share
    /// a clock.
    recorders: Vec<[Option<usize>; 2]>,
    /// What is expected of them, where something is.
    prior: Option<ClockPrior>,
    count: usize,
}

impl ClockUnknowns {
    /// Those of receivers with these recorders, and of transmitters of which this is known.
    ///
    /// What all recorders have in common is the transmitters' offsets, and the propagation speed: the clock of the first
    /// recorder is the reference. Where transmitters send by a schedule, its rate is unknown too.
    pub(crate) fn new(emissions: Emissions, recorders: Option<&Recorders>) -> ClockUnknowns {
        let mut count = 0;
        let mut next = || {
            count += 1;
            count - 1
        };
        let constant = (emissions == Emissions::Constant).then(&mut next);
        let Some(recorders) = recorders else {
            return ClockUnknowns { constant, count, ..ClockUnknowns::default() };
        };
        let all = recorders.present();
        // By recorder, those that are there in ascending order.
        let mut of_one = |k: usize| {
            [k > 0, recorders.drift() && (k > 0 || recorders.is_scheduled())].map(|unknown| unknown.then(&mut next))
        };
        let unknowns: Vec<[Option<usize>; 2]> = (0..all.len()).map(&mut of_one).collect();
        let of = |recorder: &usize| all.binary_search(recorder).map_or([None; 2], |k| unknowns[k]);
        let prior = prior(recorders, &all, &unknowns);
        let recorders = recorders.of_receivers().iter().map(of).collect();
        ClockUnknowns { constant, recorders, prior, count }
    }

    /// How many there are.
    #[inline]
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Those on which the residual of a measurement of this receiver and time depends, with its derivative over its precision.
    pub(crate) fn terms(&self, receiver: usize, time: f64) -> impl Iterator<Item = (usize, f64)> + use<> {
        let [offset, drift] = self.recorders.get(receiver).copied().unwrap_or([None; 2]);
        let all = [self.constant.map(|at| (at, -1.0)), offset.map(|at| (at, -1.0)), drift.map(|at| (at, -time))];
        all.into_iter().flatten()
    }

    /// Gives a network clocks, if it has none and there are unknowns of them.
    pub(crate) fn begin<const D: usize>(&self, network: &mut Network<D>) {
        if network.clocks.len() != self.recorders.len() {
            network.clocks = vec![[0.0; 2]; self.recorders.len()];
        }
    }

    /// Clocks of all receivers from those of some of them: of a recorder that none of these has, none is known.
    pub(crate) fn of_all(&self, clocks: &[[f64; 2]], receivers: &[usize]) -> Vec<[f64; 2]> {
        let of = |unknowns: &[Option<usize>; 2]| {
            let place = receivers.iter().position(|i| self.recorders.get(*i) == Some(unknowns));
            place.and_then(|place| clocks.get(place)).copied().unwrap_or_default()
        };
        self.recorders.iter().map(of).collect()
    }

    /// Clocks of all receivers against those of the recorder that is the reference, as far as it is one.
    pub(crate) fn against_the_first(&self, mut clocks: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        for k in 0..2 {
            let first = self.recorders.iter().position(|unknowns| unknowns[k].is_none());
            let first = first.and_then(|i| clocks.get(i)).map_or(0.0, |clock| clock[k]);
            clocks.iter_mut().for_each(|clock| clock[k] -= first);
        }
        clocks
    }

    /// Adds a share of changes of these unknowns to those of a network.
    pub(crate) fn add<const D: usize>(&self, network: &mut Network<D>, changes: &[f64], share: f64) {
        if let Some(constant) = self.constant {
            network.offsets.iter_mut().for_each(|offset| *offset += share * changes[constant]);
        }
        for (clock, unknowns) in network.clocks.iter_mut().zip(&self.recorders) {
            for (value, unknown) in clock.iter_mut().zip(unknowns) {
                *value += unknown.map_or(0.0, |at| share * changes[at]);
            }
        }
    }

    /// With a further receiver, the last one, that has the recorder of this one.
    pub(crate) fn split(&self, receiver: usize) -> ClockUnknowns {
        let mut recorders = self.recorders.clone();
        recorders.extend(self.recorders.get(receiver).copied());
        ClockUnknowns { recorders, ..self.clone() }
    }

    /// What is expected of them, where something is.
    #[inline]
    pub(crate) fn prior(&self) -> Option<&ClockPrior> {
        self.prior.as_ref()
    }

    /// The offset and the drift of a receiver's recorder among these unknowns, as far as they are unknown.
    pub(crate) fn of_receiver(&self, receiver: usize) -> [Option<usize>; 2] {
        self.recorders.get(receiver).copied().unwrap_or([None; 2])
    }

    /// The one that all transmitters' offsets are, if they are one.
    pub(crate) fn constant(&self) -> Option<usize> {
        self.constant
    }
}

/// What is expected of the clocks of the recorders that are `present`, which have these unknowns.
fn prior(recorders: &Recorders, present: &[usize], unknowns: &[[Option<usize>; 2]]) -> Option<ClockPrior> {
    let information = recorders.information();
    let expected = |(recorder, unknowns): (&usize, &[Option<usize>; 2])| {
        let receiver = recorders.of_receivers().iter().position(|of| of == recorder)?;
        Some(ExpectedClock { receiver, unknowns: *unknowns, taken: recorders.taken()[receiver] })
    };
    (information != [0.0; 2])
        .then(|| ClockPrior { information, clocks: present.iter().zip(unknowns).filter_map(expected).collect() })
}
