//! Errors of receivers that a network shows: those that are taken out, and those at which it only
//! hints.

use crate::calibrate::options::{CalibrateError, CalibrateOptions, Errors};
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind};
use crate::calibrate::receivers::refits::{Refit, refits};
use crate::calibrate::receivers::score_test::{Suspects, find, find_one_sided};
use crate::calibrate::search::one_sided::mixture_of;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Where the size of an error by the linear test is off by more than this share, it is the fit that
/// counts.
const MISJUDGED: f64 = 0.2;

/// Errors of receivers that a network shows.
#[derive(Default)]
pub(crate) struct Evidence<const D: usize> {
    /// One of each receiver, or the one that it hides if that tells more.
    pub(crate) found: Vec<Fault<D>>,
    /// The network without the first of them, where the present one is bent by it.
    pub(crate) hidden: Option<Network<D>>,
    /// Further errors that are worth a doubt, with the networks without them.
    pub(crate) doubted: Vec<Refit<D>>,
    /// Errors that may be there in the place of the first, likewise.
    pub(crate) rivals: Vec<Refit<D>>,
}

impl<const D: usize> Evidence<D> {
    /// With those of these fits that tell about as much as the first error, of other receivers.
    fn with_rivals(mut self, fitted: Vec<Refit<D>>, margin: f64) -> Evidence<D> {
        let of = |fault: &Fault<D>| fitted.iter().find(|other| other.fault.receiver == fault.receiver);
        let Some(lead) = self.found.first().and_then(of).map(|other| other.lead) else { return self };
        let behind = fitted.into_iter().map(|other| Refit { lead: other.lead - lead, ..other });
        let is_other = |other: &Refit<D>| self.found.iter().all(|fault| fault.receiver != other.fault.receiver);
        self.rivals = behind.filter(|other| other.lead > -margin && is_other(other)).collect();
        self
    }
}

/// What a network shows. `deviation` is that of the measurements, and errors of less than `least_size`
/// metres are none.
pub(crate) fn find_errors<const D: usize>(
    observations: &Observations<D>,
    best: &Network<D>,
    deviation: f64,
    least_size: f64,
    options: &CalibrateOptions<D>,
    monitor: &Monitor,
) -> Result<Evidence<D>, CalibrateError<D>> {
    if options.errors == Errors::OneSided {
        let mixture = mixture_of(observations, best, deviation);
        let found = find_one_sided(observations, best, &mixture, monitor)?.found;
        return Ok(Evidence { found, ..Evidence::default() });
    }
    let limit = options.inlier_threshold;
    let mut unmoved = Vec::new();
    loop {
        let Suspects { found, doubted } = find(observations, best, deviation, limit, &unmoved, monitor)?;
        let mut found = one_of_each(found);
        found.retain(|fault| fault.length().abs() >= least_size);
        let is_move = |fault: &Fault<D>| fault.kind == ReceiverErrorKind::Move;
        let unsure = found.iter().enumerate().filter(|(k, fault)| *k == 0 || is_move(fault));
        let suspects: Vec<Fault<D>> = unsure.map(|(_, fault)| *fault).chain(one_of_each(doubted)).collect();
        let mut fitted = refits(observations, best, deviation, limit, &suspects, monitor)?;
        let doubted = fitted.split_off(fitted.partition_point(|other| other.lead > 0.0));
        let of = |receiver: usize| fitted.iter().find(|other| other.fault.receiver == receiver);
        // What a move adds is not linear, and gross errors look like one: two places have to fit.
        if let Some(refuted) = found.iter().find(|fault| is_move(fault) && of(fault.receiver).is_none()) {
            unmoved.push(refuted.receiver);
            continue;
        }
        let Some(hidden) = fitted.first() else { return Ok(Evidence { found, doubted, ..Evidence::default() }) };
        let alone = |hidden: &Refit<D>| (vec![hidden.fault], Some(hidden.network.clone()));
        let (found, hidden) = match found.first().copied() {
            None => alone(hidden),
            Some(first) => {
                let other_kind = of(first.receiver).is_some_and(|other| other.fault.kind != first.kind);
                let unsure = is_move(&first) || other_kind;
                let more = unsure || hidden.fault.gain > first.gain;
                if hidden.fault.receiver != first.receiver && more {
                    alone(hidden)
                } else {
                    // A size that the linear test has far too small is that of a network still bent.
                    let off = (hidden.fault.length() - first.length()).abs();
                    let better = more || off > MISJUDGED * hidden.fault.length().abs();
                    for fault in &mut found {
                        if let Some(other) = of(fault.receiver).filter(|other| is_move(&other.fault)) {
                            *fault = other.fault;
                        }
                    }
                    if better {
                        found[0] = hidden.fault;
                    }
                    (found, better.then(|| hidden.network.clone()))
                }
            }
        };
        let shown = Evidence { found, hidden, doubted, ..Evidence::default() };
        return Ok(shown.with_rivals(fitted, options.alternative_margin));
    }
}

/// The first error of each receiver: what remains beside it may be its own.
fn one_of_each<const D: usize>(mut found: Vec<Fault<D>>) -> Vec<Fault<D>> {
    let mut seen = Vec::new();
    found.retain(|fault| {
        !seen.contains(&fault.receiver) && {
            seen.push(fault.receiver);
            true
        }
    });
    found
}

#[cfg(test)]
pub(crate) mod tests {
    use crate::align::align;
    use crate::{CalibrateOptions, ReceiverDelays, ReceiverErrorKind, ReceiverFault, SimulateOptions, Simulation};
    use crate::{calibrate, simulate};

    const SIGMA: f64 = 0.01;

    /// 8r/20s with the first receiver 0.3 m late.
    pub(crate) fn late(outliers: f64, seed: u64) -> Simulation {
        let fault = Some(ReceiverFault::Delay(0.3));
        let options = SimulateOptions {
            receivers: 8,
            transmitters: 20,
            noise: SIGMA,
            fault,
            outliers,
            seed,
            ..Default::default()
        };
        simulate(&options).unwrap()
    }

    #[test]
    fn an_error_that_is_hardly_told_leaves_a_network_without_it() {
        for (seed, outliers) in [(40012, 0.0), (40097, 0.0), (40080, 0.05), (40050, 0.05)] {
            let simulation = late(outliers, seed);
            let options = CalibrateOptions { receiver_delays: ReceiverDelays::Auto, seed, ..Default::default() };
            let found = calibrate(&simulation.pseudoranges, &options).unwrap();
            assert!(!found.unique && !found.unique_receivers, "seed {seed}");
            let errors = found.alternatives.iter().filter_map(|other| Some((other, other.receiver_error.as_ref()?)));
            let of_the_first = errors.filter(|(_, error)| error.receiver == "r1").collect::<Vec<_>>();
            let [(other, error)] = of_the_first[..] else { panic!("seed {seed}: {:?}", found.alternatives.len()) };
            // 30 deviations, in the noise of twenty measurements with little beside to tell them from.
            assert!(
                error.kind == ReceiverErrorKind::Delay && (error.size - 0.3).abs() < 0.15,
                "seed {seed}: {error:?}"
            );
            assert!(found.warnings.iter().any(|warning| warning.starts_with("receiver r1 may have a delay")));
            assert!(other.residual < 1.5 * SIGMA, "seed {seed}: {}", other.residual);
            let distance = |receivers: &[Option<[f64; 2]>]| {
                let pairs = receivers.iter().zip(&simulation.network.receivers).filter_map(|(p, q)| Some(((*p)?, *q)));
                let (placed, truth): (Vec<_>, Vec<_>) = pairs.unzip();
                align(&placed, &truth, false).unwrap().rms
            };
            assert!(distance(&other.receivers) < 0.5 * distance(&found.receivers), "seed {seed}");
        }
    }
}
