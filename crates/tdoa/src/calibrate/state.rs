//! A calibration on its way from one step to the next.

use super::known::{Anchors, SpeedEstimate};
use super::near::Neighbour;
use super::options::CalibrateOptions;
use super::receiver_errors::Fault;
use super::unfinished::Unfinished;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::RefinedNetwork;
use hc::Monitor;

/// Measurements, the networks that fit them, and what the steps so far have found out.
pub(super) struct State<'a, const D: usize> {
    pub(super) options: &'a CalibrateOptions<D>,
    pub(super) monitor: &'a Monitor,
    /// Deviation of the measurements, if it is given.
    pub(super) known: Option<f64>,
    /// No measurement is trusted beyond this.
    pub(super) floor: f64,
    /// The measurements of the nodes that take part, less a length for each transmitter; once errors of
    /// receivers have been looked for, without those that are taken out.
    pub(super) measured: Pseudoranges,
    /// The measurements without the errors that are taken out, with what is known of receivers.
    pub(super) observations: Observations<D>,
    /// Networks, best first; at least one once the search has ended.
    pub(super) ranked: Vec<RefinedNetwork<D>>,
    /// Deviation of the measurements: the given one, or that at the best network.
    pub(super) deviation: f64,
    /// Networks near the best one, or with an error that is worth a doubt.
    pub(super) neighbours: Vec<Neighbour<D>>,
    /// Starts of the search; small networks that were laid together.
    pub(super) starts: usize,
    /// Where small networks were laid together, receivers whose place no overlap of them supports.
    pub(super) weak: Option<Vec<usize>>,
    /// Errors of receivers that are taken out.
    pub(super) taken: Vec<Fault<D>>,
    /// Errors of receivers that were found and left in.
    pub(super) left: Vec<Fault<D>>,
    /// Known positions of receivers.
    pub(super) anchors: Option<Anchors<D>>,
    /// The propagation speed, if it was to be estimated.
    pub(super) speed: Option<SpeedEstimate>,
    /// How far the known positions are from where the measurements put these receivers, root mean
    /// square, where that is no chance.
    pub(super) contradiction: Option<f64>,
    pub(super) warnings: Vec<String>,
    /// What a calibration that is stopped now has found.
    pub(super) so_far: Option<Unfinished<D>>,
}

impl<'a, const D: usize> State<'a, D> {
    /// Measurements, before the search.
    pub(super) fn new(
        measured: Pseudoranges,
        known: Option<f64>,
        options: &'a CalibrateOptions<D>,
        monitor: &'a Monitor,
    ) -> State<'a, D> {
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
            weak: None,
            taken: Vec::new(),
            left: Vec::new(),
            anchors: None,
            speed: None,
            contradiction: None,
            warnings: Vec::new(),
            so_far: None,
        }
    }
}
