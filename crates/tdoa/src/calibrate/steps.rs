//! The steps of a calibration, from measurements to a report.

use crate::calibrate::input::anchors;
use crate::calibrate::input::distances::with_distances;
use crate::calibrate::input::impossible::without_impossible;
use crate::calibrate::input::ranges::with_clocks;
use crate::calibrate::input::selection::Input;
use crate::calibrate::options::{CalibrateError, CalibrateOptions, Errors, check};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::candidates::search_candidates;
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::search::local::{ReceiverLayout, hearing_is_local, lay_out};
use crate::calibrate::search::submaps::overlap;
use crate::calibrate::state::State;
use crate::calibrate::unfinished::Unfinished;
use crate::degeneracy::{Usable, least_per_transmitter, list, usable};
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// What `calibrate_with` does, for any number of coordinates.
pub(crate) fn calibrate_with<const D: usize>(
    measured: &Pseudoranges,
    options: &CalibrateOptions<D>,
    sources: &[&dyn Hypotheses<D>],
    monitor: &Monitor,
) -> Result<Calibration<D>, CalibrateError<D>> {
    Draft::searched(measured, options, sources, monitor)?.cleared()?.judged()
}

/// A calibration that is not finished: what takes part, and what the steps so far have found.
#[derive(Clone)]
pub(crate) struct Draft<'a, const D: usize> {
    pub(crate) state: State<'a, D>,
    pub(crate) input: Input<'a>,
}

impl<'a, const D: usize> Draft<'a, D> {
    /// Networks for the measurements that take part, before errors of receivers are looked for.
    pub(crate) fn searched(
        measured: &'a Pseudoranges,
        options: &'a CalibrateOptions<D>,
        sources: &[&dyn Hypotheses<D>],
        monitor: &'a Monitor,
    ) -> Result<Draft<'a, D>, CalibrateError<D>> {
        Draft::new(measured, options, monitor)?.then(|draft| draft.search(sources))
    }

    /// Networks from these sources alone, near enough to the best ones to be compared with others.
    pub(crate) fn roughly(
        measured: &'a Pseudoranges,
        options: &'a CalibrateOptions<D>,
        source: &dyn Hypotheses<D>,
        monitor: &'a Monitor,
    ) -> Result<Draft<'a, D>, CalibrateError<D>> {
        let mut draft = Draft::new(measured, options, monitor)?;
        draft.state.is_rough = true;
        draft.then(|draft| draft.search(&[source]))
    }

    /// Nothing is searched yet.
    fn new(
        measured: &'a Pseudoranges,
        options: &'a CalibrateOptions<D>,
        monitor: &'a Monitor,
    ) -> Result<Draft<'a, D>, CalibrateError<D>> {
        options.validate()?;
        anchors::validate(measured, options)?;
        let (table, impossible) = without_impossible(measured);
        let (table, negative) = with_clocks(table, options.clocks)?;
        let table = with_distances(table, options);
        let left_out = impossible.into_iter().chain(negative);
        check(monitor)?;
        let mut usable = usable::<D>(&table)?;
        check(monitor)?;
        usable.warnings.extend(left_out);
        let known = options.sigma.or(if table.knows_sigmas() { Some(1.0) } else { None });
        let input = Input::new(table, usable);
        let state = State::new(input.centred(), known, options, monitor);
        let observations = &state.observations;
        let (measurements, unknowns) = (observations.len(), observations.unknowns());
        let of_clocks = observations.clocks().count();
        if of_clocks > 0 && measurements < unknowns {
            return Err(CalibrateError::Clocks { measurements, unknowns, of_clocks });
        }
        Ok(Draft { state, input })
    }

    /// Without the errors that receivers show, and without reflections.
    pub(crate) fn cleared(self) -> Result<Draft<'a, D>, CalibrateError<D>> {
        self.then(|Draft { state, .. }| {
            if std::mem::take(&mut state.is_rough) {
                state.finish(state.known.unwrap_or(state.deviation))?;
            }
            state.clear()?;
            state.leave_out_reflections()
        })
    }

    /// Without reflections alone.
    pub(crate) fn without_reflections(self) -> Result<Draft<'a, D>, CalibrateError<D>> {
        self.then(|Draft { state, .. }| state.leave_out_reflections())
    }

    /// The calibration: the network with what is known beforehand, and how sure it is.
    pub(crate) fn judged(self) -> Result<Calibration<D>, CalibrateError<D>> {
        let draft = self.then(Draft::settle)?;
        let found = draft.state.judge(&draft.input).and_then(|judged| draft.state.report(&draft.input, &judged));
        let mut found = found.map_err(|error| draft.with_the_best_so_far(error))?;
        let options = draft.state.options;
        if options.knows_heights_alone() {
            found.stand_upright(&options.positions, options.alternative_margin);
        }
        Ok(found)
    }

    /// The draft after a step.
    fn then(
        mut self,
        step: impl FnOnce(&mut Draft<'a, D>) -> Result<(), CalibrateError<D>>,
    ) -> Result<Draft<'a, D>, CalibrateError<D>> {
        match step(&mut self) {
            Ok(()) => Ok(self),
            Err(error) => Err(self.with_the_best_so_far(error)),
        }
    }

    fn with_the_best_so_far(&self, error: CalibrateError<D>) -> CalibrateError<D> {
        error.leaving(self.state.so_far.clone().map(|best| self.input.whole(best)))
    }

    fn search(&mut self, sources: &[&dyn Hypotheses<D>]) -> Result<(), CalibrateError<D>> {
        let Draft { state, input } = self;
        if let Some((layout, places)) = local_layout(input, state, sources)? {
            layout.refine(state, &places)?;
            state.settle_candidates()?;
        } else {
            search_candidates(state, sources)?;
        }
        state.take_off_clocks();
        let best = &state.ranked[0];
        state.so_far = Some(Unfinished::of(&best.network, state.starts, best.starts));
        Ok(())
    }

    /// Known positions, heights that the measurements hardly tell, and one-sided errors in comparison.
    fn settle(&mut self) -> Result<(), CalibrateError<D>> {
        let Draft { state, input } = self;
        state.hold(&input.usable)?;
        state.level()?;
        check(state.monitor)?;
        if state.anchors.is_some() {
            // They were found without the known positions.
            state.neighbours.clear();
        } else if state.options.errors != Errors::OneSided && !state.has_clocks_of_receivers() {
            state.compare_with_one_sided()?;
        }
        Ok(())
    }
}

/// Where hearing is local: the layout of the receivers by submaps, and which of them it places. Nodes that
/// do not hang together with these take no part from then on, with a warning.
fn local_layout<const D: usize>(
    input: &mut Input<'_>,
    state: &mut State<'_, D>,
    sources: &[&dyn Hypotheses<D>],
) -> Result<Option<(ReceiverLayout<D>, Vec<usize>)>, CalibrateError<D>> {
    let State { measured: centred, known, options, monitor, so_far, .. } = state;
    let (known, options, monitor) = (*known, *options, *monitor);
    if !hearing_is_local(centred) {
        return Ok(None);
    }
    let mut layout = match sources.first() {
        None => lay_out(centred, known, options, monitor, so_far)?,
        Some(source) => match ReceiverLayout::proposed(centred, *source, options.seed) {
            Some(layout) => layout,
            None => return Ok(None),
        },
    };
    *so_far = Some(layout.unfinished(centred));
    layout.place_strays(centred, monitor)?;
    let places: Vec<usize> = (0..centred.receivers()).filter(|&i| layout.receivers[i].is_some()).collect();
    let heard =
        |&j: &usize| places.iter().filter(|&&i| centred.get(i, j).is_some()).count() >= least_per_transmitter::<D>();
    let columns: Vec<usize> = (0..centred.transmitters()).filter(heard).collect();
    let gone: Vec<String> =
        (0..centred.receivers()).filter(|i| !places.contains(i)).map(|i| centred.receiver_names()[i].clone()).collect();
    let mut warnings = std::mem::take(&mut input.usable.warnings);
    if !gone.is_empty() {
        warnings.push(format!(
            "the measurements tie the receivers together in parts only; the largest part is calibrated, without {}; measure transmitters \
             between the parts that at least {} receivers of each hear",
            list(&gone),
            overlap::<D>()
        ));
    }
    let receivers = places.iter().map(|&i| input.usable.receivers[i]).collect();
    let transmitters = columns.iter().map(|&j| input.usable.transmitters[j]).collect();
    *input = Input::new(input.table.clone(), Usable { receivers, transmitters, warnings });
    let is_rough = state.is_rough;
    *state = State { is_rough, ..State::new(input.centred(), known, options, monitor) };
    Ok(Some((layout, places)))
}
