//! The steps of a calibration, from measurements to a report.

use super::calibration::Calibration;
use super::clocks::{on_a_grid, without_middle_delays};
use super::delays::{Cleared, Clearing};
use super::hold::{Free, Held};
use super::hypotheses::Hypotheses;
use super::impossible::without_impossible;
use super::known;
use super::late::Symmetric;
use super::options::{CalibrateError, CalibrateOptions, Errors, ReceiverDelays, check};
use super::report::Solved;
use super::submaps::{ReceiverLayout, hearing_is_local, lay_out, overlap};
use super::unfinished::Unfinished;
use super::whole::{Sought, search_whole};
use crate::degeneracy::{Usable, least_per_transmitter, list, usable};
use crate::median::median;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// What `calibrate_with` does, for any number of coordinates.
pub(super) fn calibrate_with<const D: usize>(
    measured: &Pseudoranges,
    options: &CalibrateOptions<D>,
    sources: &[&dyn Hypotheses<D>],
    monitor: &Monitor,
) -> Result<Calibration<D>, CalibrateError<D>> {
    options.validate()?;
    known::validate(measured, options)?;
    let (measured, impossible) = without_impossible(measured);
    check(monitor)?;
    let measured = measured.as_ref();
    let mut usable = usable::<D>(measured)?;
    check(monitor)?;
    usable.warnings.extend(impossible);
    let known = options.sigma.or(if measured.has_sigmas() { Some(1.0) } else { None });
    let local = if options.receiver_delays != ReceiverDelays::All {
        local_layout(measured, &mut usable, known, options, sources, monitor)?
    } else {
        None
    };
    let delayed = options.receiver_delays == ReceiverDelays::All;
    let selected = measured.select(&usable.receivers, &usable.transmitters);
    let (centred, shifts) = if delayed {
        // What is subtracted does not depend on the delays.
        let (_, shifts) = centre(&without_middle_delays(&selected));
        (shifted(&selected, &shifts), shifts)
    } else {
        centre(&selected)
    };
    let sought = if delayed { on_a_grid(&without_middle_delays(&centred)) } else { centred.clone() };
    let noise = known.filter(|_| !delayed);
    let found = match &local {
        Some((layout, places)) => layout.refine(&sought, places, noise, options, monitor),
        // What fits best before the delays are known says little.
        None if delayed => {
            let options = CalibrateOptions { alternative_margin: 1e9, ..options.clone() };
            search_whole(&sought, noise, &options, sources, monitor)
        }
        None => search_whole(&sought, noise, options, sources, monitor),
    };
    let (m, n) = (measured.receivers(), measured.transmitters());
    let place = |best: Unfinished<D>| best.shifted(&shifts).among(m, &usable.receivers, n, &usable.transmitters);
    let Sought { ranked, neighbours, deviation, floor, starts, weak } = found.map_err(|error| error.placing(place))?;
    let so_far = place(Unfinished::of(&ranked[0].network, starts, ranked[0].starts));
    let clearing = Clearing { measured: &centred, known, floor, options, monitor };
    let Cleared { measured: centred, observations, ranked, deviation, taken, left, doubted } =
        clearing.clear(ranked, deviation).map_err(|error| error.leaving(&so_far))?;
    let free = Free { observations, centred: &centred, known, floor };
    let held = free.hold(ranked, deviation, &usable, options, monitor).map_err(|error| error.leaving(&so_far))?;
    check(monitor).map_err(|error| error.leaving(&so_far))?;
    let Held { observations, ranked, deviation, anchors, speed, warnings, contradiction } = held;
    let neighbours = if anchors.is_some() {
        Vec::new()
    } else {
        let (best, limit) = (&ranked[0], options.inlier_threshold);
        let symmetric = Symmetric { observations: &observations, best, deviation, known, floor, limit };
        let late = match (options.errors, options.receiver_delays) {
            (Errors::OneSided, _) | (_, ReceiverDelays::All) => None,
            _ => symmetric.under_one_sided(monitor).map_err(|error| error.leaving(&so_far))?,
        };
        let near = neighbours.into_iter().filter(|_| taken.is_empty());
        near.chain(doubted).chain(late).collect()
    };
    let solved = Solved {
        measured,
        neighbours,
        taken: &taken,
        left: &left,
        usable: &usable,
        observations: &observations,
        centred: &centred,
        shifts: &shifts,
        ranked,
        deviation,
        known,
        starts,
        weak,
        anchors,
        speed,
        warnings,
        contradiction,
    };
    solved.report(options, monitor).map_err(|error| error.leaving(&so_far))
}

/// Where hearing is local: the layout of the usable receivers by submaps, and which of them it
/// places. Nodes that do not hang together with these are left out of `usable`, with a warning.
fn local_layout<const D: usize>(
    measured: &Pseudoranges,
    usable: &mut Usable,
    known: Option<f64>,
    options: &CalibrateOptions<D>,
    sources: &[&dyn Hypotheses<D>],
    monitor: &Monitor,
) -> Result<Option<(ReceiverLayout<D>, Vec<usize>)>, CalibrateError<D>> {
    let (centred, _) = centre(&measured.select(&usable.receivers, &usable.transmitters));
    if !hearing_is_local(&centred) {
        return Ok(None);
    }
    let (m, n) = (measured.receivers(), measured.transmitters());
    let place = |best: Unfinished<D>| best.among(m, &usable.receivers, n, &usable.transmitters);
    let mut layout = match sources.first() {
        None => lay_out(&centred, known, options, monitor).map_err(|error| error.placing(place))?,
        Some(source) => match ReceiverLayout::proposed(&centred, *source, options.seed) {
            Some(layout) => layout,
            None => return Ok(None),
        },
    };
    let placed = layout.place_strays(&centred, monitor);
    placed.map_err(|error| error.leaving(&layout.unfinished(&centred)).placing(place))?;
    let places: Vec<usize> = (0..centred.receivers()).filter(|&i| layout.positions[i].is_some()).collect();
    let heard =
        |&j: &usize| places.iter().filter(|&&i| centred.get(i, j).is_some()).count() >= least_per_transmitter::<D>();
    let columns: Vec<usize> = (0..centred.transmitters()).filter(heard).collect();
    let gone: Vec<String> =
        (0..centred.receivers()).filter(|i| !places.contains(i)).map(|i| centred.receiver_names()[i].clone()).collect();
    if !gone.is_empty() {
        usable.warnings.push(format!(
            "the measurements tie the receivers together in parts only; the largest part is calibrated, without {}; measure transmitters \
             between the parts that at least {} receivers of each hear",
            list(&gone),
            overlap::<D>()
        ));
    }
    usable.receivers = places.iter().map(|&i| usable.receivers[i]).collect();
    usable.transmitters = columns.iter().map(|&j| usable.transmitters[j]).collect();
    Ok(Some((layout, places)))
}

/// Subtracts each column's median, which the offsets take back at the end: large common times cost
/// digits.
fn centre(measured: &Pseudoranges) -> (Pseudoranges, Vec<f64>) {
    let shifts: Vec<f64> = (0..measured.transmitters())
        .map(|j| median((0..measured.receivers()).filter_map(|i| measured.get(i, j)).collect()).unwrap_or(0.0))
        .collect();
    (shifted(measured, &shifts), shifts)
}

/// The measurements with a number subtracted from each column, as if the transmitters' clocks were set
/// differently.
fn shifted(measured: &Pseudoranges, shifts: &[f64]) -> Pseudoranges {
    measured.map(|_, j, value| value - shifts[j])
}
