//! A calibration on its way from one step to the next.

use crate::calibrate::input::anchors::Anchors;
use crate::calibrate::input::speed::SpeedEstimate;
use crate::calibrate::judge::dimension_test::{DimensionTest, PlaneDistances};
use crate::calibrate::judge::neighbours::Neighbour;
use crate::calibrate::options::CalibrateOptions;
use crate::calibrate::receivers::echo::Echo;
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind};
use crate::calibrate::unfinished::Unfinished;
use crate::clocks::Emissions;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::RefinedNetwork;
use hc::Monitor;

/// Measurements, the networks that fit them, and what the steps so far have found out.
#[derive(Clone)]
pub(crate) struct State<'a, const D: usize> {
    pub(crate) options: &'a CalibrateOptions<D>,
    pub(crate) monitor: &'a Monitor,
    /// Deviation of the measurements, if it is given.
    pub(crate) known: Option<f64>,
    /// No measurement is trusted beyond this.
    pub(crate) floor: f64,
    /// The measurements of the nodes that take part, less a length for each transmitter; once errors of
    /// receivers have been looked for, without those that are taken out.
    pub(crate) measured: Pseudoranges,
    /// The measurements without the errors that are taken out, with what is known of receivers.
    pub(crate) observations: Observations<D>,
    /// Whether the networks are good enough that are near the best ones.
    pub(crate) is_rough: bool,
    /// Networks, best first; at least one once the search has ended.
    pub(crate) ranked: Vec<RefinedNetwork<D>>,
    /// Deviation of the measurements: the given one, or that at the best network.
    pub(crate) deviation: f64,
    /// Networks near the best one, or with an error that is worth a doubt.
    pub(crate) neighbours: Vec<Neighbour<D>>,
    /// Starts of the search; small networks that were laid together.
    pub(crate) starts: usize,
    /// What speaks against the choice among the candidates of the measurements.
    pub(crate) doubts_choice: Option<&'static str>,
    /// Where small networks were laid together, receivers whose place no overlap of them supports.
    pub(crate) weak: Option<Vec<usize>>,
    /// Errors of receivers that are taken out.
    pub(crate) taken: Vec<Fault<D>>,
    /// Errors of receivers that were found and left in.
    pub(crate) left: Vec<Fault<D>>,
    /// Receivers with two places, of which reflections are left out.
    pub(crate) echoes: Vec<Echo>,
    /// Known positions of receivers.
    pub(crate) anchors: Option<Anchors<D>>,
    /// How far nodes lie from their plane in space, where the measurements hardly tell it.
    pub(crate) plane_distances: Option<PlaneDistances>,
    /// What measurements in space say of heights.
    pub(crate) dimension_test: DimensionTest,
    /// The propagation speed, if it was to be estimated.
    pub(crate) speed: Option<SpeedEstimate>,
    /// How far the known positions are from where the measurements put these receivers, root mean
    /// square, where that is no chance.
    pub(crate) contradiction: Option<f64>,
    pub(crate) warnings: Vec<String>,
    /// What a calibration that is stopped now has found.
    pub(crate) so_far: Option<Unfinished<D>>,
}

impl<'a, const D: usize> State<'a, D> {
    /// Measurements, before the search.
    pub(crate) fn new(
        measured: Pseudoranges,
        known: Option<f64>,
        options: &'a CalibrateOptions<D>,
        monitor: &'a Monitor,
    ) -> State<'a, D> {
        // What is known besides is compared with measurements of this deviation.
        let measured = measured.at_deviation(known.unwrap_or(1.0));
        State {
            observations: Observations::new(&measured, |_, _| true),
            options,
            monitor,
            known,
            floor: 0.0,
            measured,
            ranked: Vec::new(),
            deviation: 0.0,
            neighbours: Vec::new(),
            starts: 0,
            doubts_choice: None,
            weak: None,
            taken: Vec::new(),
            left: Vec::new(),
            echoes: Vec::new(),
            anchors: None,
            is_rough: false,
            plane_distances: None,
            dimension_test: DimensionTest::default(),
            speed: None,
            contradiction: None,
            warnings: Vec::new(),
            so_far: None,
        }
    }

    /// Whether it is known when transmitters send: they have no offsets but the times that were given.
    pub(crate) fn sends_at_known_times(&self) -> bool {
        match self.options.clocks.emissions {
            Emissions::Unknown => false,
            Emissions::Known => true,
            // The clock of the receivers has the constant then.
            Emissions::Constant => self.measured.emission_times().is_some(),
        }
    }

    /// The errors taken out whose sizes are unknowns: of delays of all receivers, one follows from the others.
    pub(crate) fn unknown_errors(&self) -> &[Fault<D>] {
        if self.has_delays_of_all() { &self.taken[1..] } else { &self.taken }
    }

    /// Whether each receiver's clock, or that of its recorder, is unknown.
    pub(crate) fn has_clocks_of_receivers(&self) -> bool {
        self.measured.unknown_clocks().is_some() || self.has_delays_of_all()
    }

    /// Whether a delay of every receiver is taken out.
    pub(crate) fn has_delays_of_all(&self) -> bool {
        self.taken.len() == self.measured.receivers()
            && self.taken.iter().all(|fault| fault.kind == ReceiverErrorKind::Delay)
    }
}
