//! From any matrix of pseudoranges to a network: leave out what cannot be determined, search from many starts, refine the
//! best, say how sure the result is.

mod calibration;
mod compare;
mod delays;
mod deviation;
mod finish;
mod hold;
mod hypotheses;
mod known;
mod minimal;
mod options;
mod ranking;
mod receiver_errors;
mod report;
mod report_errors;
mod same;
mod search;
mod truth;
mod warnings;

pub use calibration::{Alternative, Calibration};
pub use hypotheses::{Hypotheses, KnownReceivers, generator};
pub use known::SpeedEstimate;
pub use minimal::MinimalHypotheses;
pub use options::{CalibrateError, CalibrateOptions, Control, KnownDistance, Progress, ReceiverDelays};
pub use receiver_errors::{ReceiverError, ReceiverErrorKind};
pub use same::SAME_NETWORK;
pub use truth::Truth;

use crate::degeneracy::{Usable, usable};
use crate::loss::{Loss, SEARCH_NU, normal_deviation};
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{PartialNetwork, RefineOptions, Refined, Refiner, SEARCH, extend};
use delays::{Cleared, Clearing, without_middle_delays};
use deviation::typical_deviation;
use finish::finish;
use hold::{Free, Held};
use hypotheses::RandomRestarts;
use report::Solved;
use search::Search;

/// No measurement is trusted beyond this share of the network's diameter.
const RESOLUTION: f64 = 1e-9;

/// Calibrates a network from its pseudoranges: by restarts of the robust refinement, and from the networks that the
/// minimal solvers find for subsets.
///
/// ```
/// let mut options = tdoa::SimulateOptions::default();
/// options.noise = 0.01;
/// let simulation = tdoa::simulate(&options)?;
/// let calibration = tdoa::calibrate(&simulation.pseudoranges, &tdoa::CalibrateOptions::default())?;
/// let receivers: Vec<[f64; 2]> = calibration.receivers.iter().flatten().copied().collect();
/// let alignment = tdoa::align::align(&receivers, &simulation.network.receivers, false).unwrap();
/// assert!(alignment.rms < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Data that cannot determine a network, options outside their range, or no network found.
pub fn calibrate(measured: &Pseudoranges, options: &CalibrateOptions) -> Result<Calibration, CalibrateError> {
    calibrate_with(measured, options, &[], &Control::default())
}

/// [`calibrate`] with further sources of starts beside the restarts, which take turns, and with progress and
/// cancellation.
///
/// # Errors
/// As [`calibrate`], and [`CalibrateError::Cancelled`].
pub fn calibrate_with(
    measured: &Pseudoranges,
    options: &CalibrateOptions,
    sources: &[&dyn Hypotheses],
    control: &Control<'_>,
) -> Result<Calibration, CalibrateError> {
    options.validate()?;
    known::validate(measured, options)?;
    let usable = usable(measured)?;
    let (centred, shifts) = centre(&measured.select(&usable.receivers, &usable.transmitters));
    let delayed = options.receiver_delays == ReceiverDelays::All;
    let sought = if delayed { without_middle_delays(&centred) } else { centred.clone() };
    let observations = Observations::new(&sought, |_, _| true);

    let part = search_part(&sought, options);
    let small = sought.select(&part.receivers, &part.transmitters);
    let small_observations = Observations::new(&small, |_, _| true);
    let to_deviation = normal_deviation(SEARCH_NU);
    let restarts = RandomRestarts::new(&small_observations);
    let diameter = restarts.diameter();
    let known = options.sigma.or(if centred.has_sigmas() { Some(1.0) } else { None });
    // Where measurements carry deviations, residuals are multiples of them, and so is the network's size.
    let unit = typical_deviation(&centred);
    let refine = RefineOptions {
        scale: known.filter(|_| !delayed).map(|sigma| sigma / to_deviation),
        anneal_from: Some(0.1 * diameter / unit),
        floor: RESOLUTION * diameter / unit,
        ..SEARCH
    };
    let mut all: Vec<&dyn Hypotheses> = sources.to_vec();
    let minimal = MinimalHypotheses::at_most(options.minimal_subsets);
    if options.restarts || all.is_empty() {
        all.insert(0, &restarts);
        if options.minimal_subsets > 0 && MinimalHypotheses::fit(small.receivers(), small.transmitters()) {
            all.push(&minimal);
        }
    }
    let search = Search {
        measured: &small,
        observations: &small_observations,
        refine,
        sources: all,
        wide: Loss { nu: SEARCH_NU, scale: 0.03 * diameter / unit },
        deviation: known.filter(|_| !delayed).map(|sigma| sigma.max(refine.floor)),
    };
    let found = search.run(options, control)?;

    let best = found.networks[0].objective;
    let close = found.networks.into_iter().filter(|r| r.objective <= best + 4.0 * options.alternative_margin);
    let whole: Vec<Refined> =
        if part.receivers.len() == centred.receivers() && part.transmitters.len() == centred.transmitters() {
            close.collect()
        } else {
            complete(&observations, &part, close.take(4), &refine, control)
        };
    control.check()?;
    let Some(scale) = whole.iter().min_by(|a, b| a.objective.total_cmp(&b.objective)).map(|r| r.scale) else {
        return Err(CalibrateError::NotFound(found.starts));
    };
    let first = known.filter(|_| !delayed).unwrap_or(scale * to_deviation).max(refine.floor);
    let (ranked, deviation) =
        finish(&observations, whole, first, known.is_some() && !delayed, refine.floor, options, control)?;
    let clearing = Clearing { measured: &centred, known, floor: refine.floor, options, control };
    let Cleared { measured: centred, observations, ranked, deviation, taken, left } =
        clearing.clear(ranked, deviation)?;
    let free = Free { observations, centred: &centred, known, floor: refine.floor };
    let held = free.hold(ranked, deviation, &usable, options, control)?;
    let Held { observations, ranked, deviation, anchors, speed, warnings } = held;
    let solved = Solved {
        measured,
        taken: &taken,
        left: &left,
        usable: &usable,
        observations: &observations,
        centred: &centred,
        shifts: &shifts,
        ranked,
        deviation,
        known,
        starts: found.starts,
        anchors,
        speed,
        warnings,
    };
    Ok(solved.report(options))
}

/// Subtracts each column's median, which the offsets take back at the end: large common times cost digits.
fn centre(measured: &Pseudoranges) -> (Pseudoranges, Vec<f64>) {
    let shifts: Vec<f64> = (0..measured.transmitters())
        .map(|j| {
            let mut column: Vec<f64> = (0..measured.receivers()).filter_map(|i| measured.get(i, j)).collect();
            column.sort_by(f64::total_cmp);
            column.get(column.len() / 2).copied().unwrap_or(0.0)
        })
        .collect();
    (measured.shifted(&shifts), shifts)
}

/// The nodes that the search works on: where there are many, some of the better observed half, evenly spaced, because
/// neighbours in a recording are often neighbours in the plane.
fn search_part(measured: &Pseudoranges, options: &CalibrateOptions) -> Usable {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let pick = |total: usize, most: usize, count: &dyn Fn(usize) -> usize| -> Vec<usize> {
        if total <= most {
            return (0..total).collect();
        }
        let mut order: Vec<usize> = (0..total).collect();
        order.sort_by_key(|&k| std::cmp::Reverse(count(k)));
        let better = most.max(total / 2);
        let mut better: Vec<usize> = order[..better].to_vec();
        better.sort_unstable();
        (0..most).map(|k| better[k * better.len() / most]).collect()
    };
    let receivers = pick(m, options.search_receivers, &|i| (0..n).filter(|&j| measured.get(i, j).is_some()).count());
    let heard = |j: usize| receivers.iter().filter(|&&i| measured.get(i, j).is_some()).count();
    let transmitters = pick(n, options.search_transmitters, &heard);
    // A part that cannot be solved on its own is no help.
    match usable(&measured.select(&receivers, &transmitters)) {
        Ok(part) => Usable {
            receivers: part.receivers.iter().map(|&i| receivers[i]).collect(),
            transmitters: part.transmitters.iter().map(|&j| transmitters[j]).collect(),
            warnings: Vec::new(),
        },
        Err(_) => Usable { receivers: (0..m).collect(), transmitters: (0..n).collect(), warnings: Vec::new() },
    }
}

/// Extends networks of a part of the nodes to all of them and refines them.
fn complete(
    observations: &Observations,
    part: &Usable,
    networks: impl Iterator<Item = Refined>,
    refine: &RefineOptions,
    control: &Control<'_>,
) -> Vec<Refined> {
    let mut refiner = Refiner::new(observations, SEARCH_NU).heeding(&control.monitor);
    let refine = RefineOptions { anneal_from: None, ..*refine };
    networks
        .filter_map(|refined| {
            let mut known = PartialNetwork::unknown(observations.receivers, observations.transmitters);
            known.place(&refined.network, &part.receivers, &part.transmitters);
            let network = extend(observations, &known, &Loss { nu: SEARCH_NU, scale: refined.scale })?;
            Some(Refined { starts: refined.starts, ..refiner.refine(network, &refine) })
        })
        .filter(|refined| refined.objective.is_finite() && refined.network.is_finite())
        .collect()
}
