//! New transmitters in a network that is calibrated.
//!
//! Each is located by itself: its place and its offset from the receivers that hear it, as in
//! [`multilateration`](crate::multilateration), with the errors that both the measurements and the receivers have. Places
//! that explain the measurements about as well are given beside the likeliest one.

mod error;
mod fit;
mod place;
mod starts;

use std::collections::HashMap;

pub use error::LocateError;
pub use place::{OtherPlace, Place, Unplaced};

use crate::calibrate::{Calibration, ReceiverErrorKind, RecorderClock};
use crate::clocks::Emissions;
use crate::degeneracy::list;
use crate::points::trace;
use crate::pseudoranges::Pseudoranges;
use fit::Heard;

/// What new transmitters are located by: the receivers of a calibration, and what is known of their errors.
///
/// ```
/// use tdoa::{CalibrateOptions, Locator, SimulateOptions, calibrate, simulate};
///
/// // Twenty transmitters calibrate the network; ten more are new to it.
/// let mut options = SimulateOptions::default();
/// (options.transmitters, options.noise) = (30, 0.01);
/// let made = simulate(&options)?;
/// let receivers: Vec<usize> = (0..8).collect();
/// let known = made.pseudoranges.select(&receivers, &(0..20).collect::<Vec<_>>());
/// let new = made.pseudoranges.select(&receivers, &(20..30).collect::<Vec<_>>());
///
/// let network = calibrate(&known, &CalibrateOptions::default())?;
/// for event in Locator::new(&network, None)?.locate(&new)? {
///     let place = event.place.expect("heard by all");
///     println!("{}: {:?} with {:?} m", event.transmitter, place.position, place.position_std);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Locator<const D: usize = 2> {
    receivers: Vec<Known<D>>,
    /// Places among `receivers`, by name.
    by_name: HashMap<String, usize>,
    clocks: Vec<RecorderClock>,
    /// What is added to a measurement's length by the offset that transmitters share, where they have none of their own.
    shared_offset: Option<f64>,
    /// Standard deviation of measurements, metres, or a factor on those that they carry: the one that was given here, and that of
    /// the calibration.
    given: Option<f64>,
    sigma: Option<f64>,
    sigma_is_factor: bool,
    /// Factor on lengths of the estimated propagation speed.
    speed: f64,
    is_unique: bool,
    notes: Vec<String>,
}

/// A receiver of the network.
#[derive(Debug, Clone)]
struct Known<const D: usize> {
    name: String,
    /// Where it is, if that is known and it is fit for use.
    position: Option<[f64; D]>,
    /// Variance of its place in any one direction, square metres.
    variance: f64,
    /// What its measurements are too long by, metres.
    delay: f64,
}

/// Where a transmitter is, or why that cannot be told.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(bound(serialize = "[f64; D]: serde::Serialize, [[f64; D]; D]: serde::Serialize"))]
#[non_exhaustive]
pub struct LocatedEvent<const D: usize = 2> {
    /// Its name.
    pub transmitter: String,
    /// Number of receivers of the network that hear it.
    pub heard: usize,
    /// Where it is; `None` where that cannot be told.
    #[serde(flatten)]
    pub place: Option<Place<D>>,
    /// Why it cannot be told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<Unplaced>,
}

impl<const D: usize> Locator<D> {
    /// What transmitters are located by in this network. `sigma` is the standard deviation of measurements in metres, or a
    /// factor on those that they carry; `None` for that of the calibration.
    ///
    /// # Errors
    /// If the network is [not to be trusted](Calibration::distrust), or `sigma` is no positive number.
    pub fn new(network: &Calibration<D>, sigma: Option<f64>) -> Result<Locator<D>, LocateError> {
        if let Some(why) = network.distrust() {
            return Err(LocateError::Distrust { why });
        }
        if let Some(value) = sigma.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(LocateError::Sigma { value });
        }
        let [covariances, _] = network.trusted_covariances();
        let mut notes = Vec::new();
        let mut receivers: Vec<Known<D>> = (network.receiver_names.iter().enumerate())
            .map(|(i, name)| Known {
                name: name.clone(),
                position: network.receivers.get(i).copied().flatten(),
                variance: covariances.get(i).copied().flatten().map_or(0.0, |of| trace(&of) / D as f64),
                delay: 0.0,
            })
            .collect();
        let by_name = receivers.iter().enumerate().map(|(i, known)| (known.name.clone(), i)).collect();
        for error in network.receiver_errors.iter().filter(|error| error.taken_out) {
            let Some(known) = receivers.iter_mut().find(|known| known.name == error.receiver) else { continue };
            let is_told = match error.kind {
                ReceiverErrorKind::Delay | ReceiverErrorKind::Jump => true,
                ReceiverErrorKind::Drift => false,
                ReceiverErrorKind::Move => error.place == Some(crate::MovedPlace::After),
            };
            match (is_told, error.kind) {
                (true, ReceiverErrorKind::Move) => {}
                // After a jump measurements are as late as at the end of the calibration.
                (true, _) => known.delay += error.size,
                (false, _) => {
                    known.position = None;
                    notes.push(format!(
                        "receiver {} is left out: it drifted or was moved while the network was calibrated, and what it is now is not \
                         known; calibrate anew",
                        known.name
                    ));
                }
            }
        }
        let missing: Vec<String> = network
            .receiver_names
            .iter()
            .zip(&network.receivers)
            .filter(|(_, p)| p.is_none())
            .map(|(n, _)| n.clone())
            .collect();
        if !missing.is_empty() {
            notes.push(format!("receivers without a place are left out: {}", list(&missing)));
        }
        if !network.unique_receivers {
            notes.push("the receivers of the network are not unique, and so no place is".to_string());
        }
        // One that is known exactly is of a schedule by which these transmitters sent, and new ones need not.
        let constant = network.offsets.iter().zip(&network.offset_std).find_map(|(offset, std)| offset.zip(*std));
        let shared_offset = match network.emissions {
            Emissions::Unknown => None,
            Emissions::Constant => constant.filter(|(_, std)| *std > 0.0).map(|(offset, _)| offset),
            Emissions::Known => Some(0.0),
        };
        Ok(Locator {
            receivers,
            by_name,
            clocks: network.clocks.clone(),
            shared_offset,
            given: sigma,
            sigma: Some(network.sigma).filter(|sigma| *sigma > 0.0 && sigma.is_finite()),
            sigma_is_factor: network.sigma_is_factor,
            speed: network.speed.map_or(1.0, |speed| speed.factor),
            is_unique: network.unique_receivers,
            notes,
        })
    }

    /// What should be known of all places: receivers that are left out, and doubts about the network.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Locates each transmitter of measurements by the network's receivers, which are known by their names, or by their
    /// order where the measurements name none. Values are those that the network would have been calibrated with: by the same
    /// clocks, in metres at the speed that was assumed then, and less the send times where these were known. Where measurements have candidates, the first one counts. Weights
    /// tell measurements of these apart; the median one has the deviation that it had in the calibration.
    ///
    /// # Errors
    /// If a receiver, or its recorder where these have clocks of their own, is none of the network, or the standard deviation of
    /// the measurements is not known.
    pub fn locate(&self, measured: &Pseudoranges) -> Result<Vec<LocatedEvent<D>>, LocateError> {
        let places = self.places(measured)?;
        #[cfg(feature = "csv")]
        if measured.origin().is_some() && self.clocks.iter().any(|clock| clock.rate.is_some()) {
            return Err(LocateError::Moments);
        }
        let clocks: Vec<Option<&RecorderClock>> =
            (0..measured.receivers()).map(|i| self.clock(measured, i)).collect::<Result<_, _>>()?;
        let deviation = self.deviations(measured)?;
        let mut heard: Vec<Vec<Heard<D>>> = vec![Vec::new(); measured.transmitters()];
        for (i, j, value) in measured.cells().iter() {
            let known = &self.receivers[places[i]];
            let Some(position) = known.position else { continue };
            // All that the network says is in metres at the estimated speed.
            let reading = self.speed * value;
            let late = clocks[i].map_or(0.0, |clock| clock.lateness(reading));
            let length = reading - late - self.shared_offset.unwrap_or(0.0) - known.delay;
            let noise = deviation(i, j) * if measured.knows_sigmas() { self.speed } else { 1.0 };
            heard[j].push(Heard { receiver: i, position, length, deviation: noise.hypot(known.variance.sqrt()) });
        }
        let name = |i: usize| self.receivers[places[i]].name.clone();
        let located = heard.iter().zip(measured.transmitter_names()).map(|(heard, transmitter)| {
            let (place, problem) = match fit::place(heard, self.shared_offset.is_some(), self.is_unique, name) {
                Ok(place) => (Some(place), None),
                Err(problem) => (None, Some(problem)),
            };
            LocatedEvent { transmitter: transmitter.clone(), heard: heard.len(), place, problem }
        });
        Ok(located.collect())
    }

    /// The place of each receiver of measurements among those of the network.
    fn places(&self, measured: &Pseudoranges) -> Result<Vec<usize>, LocateError> {
        if !measured.receivers_named() {
            let [given, known] = [measured.receivers(), self.receivers.len()];
            return if given == known { Ok((0..given).collect()) } else { Err(LocateError::Count { given, known }) };
        }
        let names = measured.receiver_names();
        let unknown: Vec<String> = names.iter().filter(|name| !self.by_name.contains_key(*name)).cloned().collect();
        if !unknown.is_empty() {
            let known: Vec<String> = self.receivers.iter().map(|known| known.name.clone()).collect();
            return Err(LocateError::Unknown { names: list(&unknown), known: list(&known) });
        }
        Ok(names.iter().map(|name| self.by_name[name]).collect())
    }

    /// The clock of a receiver, where these have clocks of their own.
    fn clock(&self, measured: &Pseudoranges, i: usize) -> Result<Option<&RecorderClock>, LocateError> {
        if self.clocks.is_empty() {
            return Ok(None);
        }
        let recorder = measured.recorder_name(i);
        let of = |name: &str| self.clocks.iter().find(|clock| clock.recorder == name);
        match of(recorder).or_else(|| of(RecorderClock::ALL_RECEIVERS)) {
            Some(clock) => Ok(Some(clock)),
            None => Err(LocateError::Recorder { recorder: recorder.to_string() }),
        }
    }

    /// The standard deviation of each measurement, metres.
    fn deviations<'a>(
        &self,
        measured: &'a Pseudoranges,
    ) -> Result<impl Fn(usize, usize) -> f64 + use<'a, D>, LocateError> {
        let carry = measured.has_sigmas();
        let factor = match (self.given, self.sigma) {
            (Some(given), _) => given,
            // That of a calibration is in metres, or a factor on what its measurements carried.
            (None, Some(sigma)) if self.sigma_is_factor == carry => sigma,
            _ if measured.knows_sigmas() => 1.0,
            _ => return Err(LocateError::NoSigma),
        };
        Ok(move |i: usize, j: usize| factor * measured.sigma(i, j).unwrap_or(1.0))
    }
}

#[cfg(test)]
mod tests;
