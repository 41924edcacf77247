//! Options of a calibration, and how it ends early.

use crate::calibrate::unfinished::Unfinished;
use crate::clocks::{Clocks, ReceiverClocks};
use crate::degeneracy::Degeneracy;
use crate::observations::Node;
use crate::refine::Cancelled;
use hc::Monitor;
use hc::poly::counted;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How to treat errors that all measurements of one receiver have in common. Where clocks were started apart, all receivers have
/// one: [`Clocks::receivers`](crate::Clocks::receivers).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ReceiverDelays {
    /// Such errors are looked for and reported.
    #[default]
    None,
    /// Such errors are looked for, reported, and taken out. Delays, drifts and jumps are estimated
    /// together with the network. For a receiver that was moved, the longer part of the
    /// measurements is kept.
    Auto,
}

/// How measurements are wrong if they are wrong by more than noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Errors {
    /// Too long as often as too short; where no network fits so, and one-sided errors leave a tenth of the deviation or less,
    /// one-sided, which a warning says.
    #[default]
    Auto,
    /// Too long as often as too short.
    Symmetric,
    /// Nearly all too long, for instance because sound or radio takes a detour. Cannot be combined
    /// with [`CalibrateOptions::receiver_delays`].
    OneSided,
}

/// How networks are searched. All fields have defaults; start from `SearchOptions::default()`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct SearchOptions {
    /// Smallest number of starts of the search. Default 48: a basin that catches one start in
    /// sixteen is then missed with a probability of 5 %.
    pub min_starts: usize,
    /// Largest number of starts of the search. Default 480.
    pub max_starts: usize,
    /// The search ends, after the smallest number of starts, when this many starts have found the
    /// best network. Default 10.
    pub agreeing: usize,
    /// Whether the search starts from random networks, besides any other sources. Default true.
    pub restarts: bool,
    /// Number of starts, besides those from random networks, that come from solving a small part of
    /// the data exactly. Default 6. With few nodes, random networks alone miss networks that fit as
    /// well. With many nodes, each of these starts ends in the best basin more often than a random
    /// one. In space with fewer than nine receivers or five transmitters it is one at most, and none where more
    /// than two measurements are spare. 0 for none.
    pub minimal_subsets: usize,
    /// Largest number of transmitters on which the search works; the others are located after it.
    /// Default 48.
    pub transmitters: usize,
    /// Largest number of receivers on which the search works; the others are located after it.
    /// Default 32.
    pub receivers: usize,
}

impl Default for SearchOptions {
    fn default() -> Self {
        SearchOptions {
            min_starts: 48,
            max_starts: 480,
            agreeing: 10,
            restarts: true,
            minimal_subsets: 6,
            transmitters: 48,
            receivers: 32,
        }
    }
}

/// Options of a calibration. All fields have defaults; start from `CalibrateOptions::default()`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CalibrateOptions<const D: usize = 2> {
    /// Standard deviation of the measurements in metres. If measurements carry their own
    /// deviations, a factor on those. Default `None`: estimated, or 1 if measurements carry their
    /// own.
    pub sigma: Option<f64>,
    /// Seed of all random draws. The same seed gives the same result on any number of threads.
    /// Default 0.
    pub seed: u64,
    /// How networks are searched. Default [`SearchOptions::default()`].
    pub search: SearchOptions,
    /// Measurements whose residual exceeds this many standard deviations are outliers. Default 3.5.
    pub inlier_threshold: f64,
    /// Another network is an alternative if the data are less likely under it by at most this much
    /// (natural logarithm). Default 8.
    pub alternative_margin: f64,
    /// The data are said not to fit a network in the plane, or in space, above this ratio of the residuals' deviation to the network's
    /// size (root mean square distance of the receivers from their centroid), unless they are as large as the deviation that is given.
    /// Default 0.04.
    pub planar_limit: f64,
    /// Known positions of receivers in metres, in the order of the receivers, `None` if unknown.
    /// They fix the frame. If they are in at least two places, the receivers are held there in the
    /// last refinement. Default empty: none are known.
    pub anchors: Vec<Option<[f64; D]>>,
    /// Positions of receivers that were measured by other means, with an error or in only one
    /// coordinate, and positions of transmitters. All coordinates of two nodes or more must be known, in space of
    /// three that are not in one line, here or among the anchors. Exact transmitters are held to a millionth of the size of
    /// the known positions. In space, heights (z) of three nodes or more may be all that is known: they turn the network
    /// upright once it is found. Default empty.
    pub positions: Vec<MeasuredPosition<D>>,
    /// How to treat receivers whose measurements are all too long or too short. Default
    /// [`ReceiverDelays::None`]: a warning names the receivers that show such an error.
    pub receiver_delays: ReceiverDelays,
    /// What is unknown of the clocks of transmitters and recorders. Default: every transmitter has an offset, and receivers
    /// share a clock.
    pub clocks: Clocks,
    /// How measurements are wrong if they are wrong by more than noise. Default
    /// [`Errors::Auto`].
    pub errors: Errors,
    /// Known distances between receivers: measurements beside the others, or for `estimate_speed`. Default empty.
    pub distances: Vec<KnownDistance>,
    /// Whether the propagation speed with which the measurements were converted to metres is a
    /// guess. It is then replaced by the speed that follows from the known distances and the
    /// distances between anchors. Default false.
    pub estimate_speed: bool,
}

/// A distance between two receivers that is known beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownDistance {
    /// Indices of the two receivers.
    pub receivers: [usize; 2],
    /// Metres.
    pub distance: f64,
    /// Its standard deviation, metres, which it needs as a measurement; for `estimate_speed`, `None` is exact.
    pub sigma: Option<f64>,
}

/// A position of a receiver or transmitter that was measured by other means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPosition<const D: usize = 2> {
    /// The receiver or transmitter.
    pub node: Node,
    /// x and y, in space z, in metres, `None` if unknown.
    pub position: [Option<f64>; D],
    /// Standard deviations of the coordinates, metres; all zero if they are exact.
    pub sigma: [f64; D],
}

impl Default for CalibrateOptions {
    fn default() -> Self {
        CalibrateOptions::new()
    }
}

impl<const D: usize> MeasuredPosition<D> {
    /// The position, if all coordinates are known.
    pub(crate) fn whole(&self) -> Option<[f64; D]> {
        let position = self.position.map(|x| x.unwrap_or(f64::NAN));
        self.position.iter().all(Option::is_some).then_some(position)
    }
}

impl<const D: usize> CalibrateOptions<D> {
    /// Whether all that is known of positions are heights, of three nodes or more.
    pub(crate) fn knows_heights_alone(&self) -> bool {
        let is_height = |known: &MeasuredPosition<D>| (0..D).all(|k| known.position[k].is_some() == (k == 2));
        D == 3
            && self.anchors.iter().all(Option::is_none)
            && self.positions.len() >= 3
            && self.positions.iter().all(is_height)
    }

    /// The defaults. `CalibrateOptions::default()` are those of the plane, `CalibrateOptions::<3>::new()`
    /// those of space.
    pub fn new() -> Self {
        CalibrateOptions {
            sigma: None,
            seed: 0,
            search: SearchOptions::default(),
            inlier_threshold: 3.5,
            alternative_margin: 8.0,
            planar_limit: 0.04,
            anchors: Vec::new(),
            positions: Vec::new(),
            receiver_delays: ReceiverDelays::None,
            clocks: Clocks::default(),
            errors: Errors::Auto,
            distances: Vec::new(),
            estimate_speed: false,
        }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first option that is outside its range.
    pub fn validate(&self) -> Result<(), CalibrateError<D>> {
        let positive = |name, value: f64| {
            if value > 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(CalibrateError::Option { name, range: "positive and finite", value })
            }
        };
        if self.errors == Errors::OneSided && self.receiver_delays != ReceiverDelays::None {
            return Err(CalibrateError::OneSidedDelays);
        }
        if self.clocks.receivers != ReceiverClocks::Common && self.errors == Errors::OneSided {
            return Err(CalibrateError::OneSidedDelays);
        }
        if let Some(sigma) = self.sigma {
            positive("sigma", sigma)?;
        }
        let Clocks { receivers, offset_sigma, rate_sigma, .. } = self.clocks;
        let common = receivers == ReceiverClocks::Common;
        for (name, sigma, useless, range) in [
            ("clocks.offset_sigma", offset_sigma, common, "left out where receivers share a clock"),
            ("clocks.rate_sigma", rate_sigma, receivers != ReceiverClocks::Rate, "left out where clocks have no rates"),
        ] {
            let Some(value) = sigma else { continue };
            positive(name, value)?;
            if useless {
                return Err(CalibrateError::Option { name, range, value });
            }
        }
        positive("inlier_threshold", self.inlier_threshold)?;
        positive("alternative_margin", self.alternative_margin)?;
        positive("planar_limit", self.planar_limit)?;
        for (name, value, least) in [
            ("max_starts", self.search.max_starts, 1),
            ("agreeing", self.search.agreeing, 1),
            ("search.transmitters", self.search.transmitters, 8),
            ("search.receivers", self.search.receivers, 8),
        ] {
            if value < least {
                let range = if least == 1 { "at least 1" } else { "at least 8" };
                return Err(CalibrateError::Option { name, range, value: value as f64 });
            }
        }
        Ok(())
    }
}

/// Ends the calibration if it has been cancelled.
pub(crate) fn check<const D: usize>(monitor: &Monitor) -> Result<(), CalibrateError<D>> {
    Ok(crate::refine::check(monitor)?)
}

impl<const D: usize> From<Cancelled> for CalibrateError<D> {
    fn from(_: Cancelled) -> Self {
        CalibrateError::Cancelled(None)
    }
}

/// Why there is no calibration.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrateError<const D: usize = 2> {
    /// The data cannot determine a network.
    #[error(transparent)]
    Degenerate(#[from] Degeneracy),
    /// No start led to a complete, finite network.
    #[error(
        "no network was found in {}; check the units, and that receivers are rows and transmitters columns",
        counted(*.0, "start")
    )]
    NotFound(usize),
    /// An option outside its range.
    #[error("option {name} must be {range}, not {value}")]
    Option {
        /// The name of the option.
        name: &'static str,
        /// The allowed range.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// There are fewer measurements than unknowns, those of clocks among them.
    #[error(
        "{} cannot determine {}, {} of clocks among them; measure more transmitters, put more receivers on one recorder, or leave unknowns of \
         clocks out",
        counted(*.measurements, "measurement"),
        counted(*.unknowns, "unknown"),
        .of_clocks
    )]
    Clocks {
        /// Number of usable measurements.
        measurements: usize,
        /// Number of unknowns.
        unknowns: usize,
        /// Those of clocks.
        of_clocks: usize,
    },
    /// One-sided errors together with errors of receivers that are to be estimated.
    #[error(
        "errors to one side and delays of receivers cannot be estimated together: a receiver all of whose measurements are late looks like one \
         with a delay; give --errors one-sided or --receiver-delays, not both"
    )]
    OneSidedDelays,
    /// Many distances are below zero.
    #[error(
        "{} below zero, among them that of {receiver} and {transmitter}, {value} m; leave --ranges out if transmitters have unknown offsets",
        match count { 1 => "a distance is".to_string(), _ => format!("{count} distances are") }
    )]
    NegativeRanges {
        /// How many.
        count: usize,
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// Metres.
        value: f64,
    },
    /// Known positions or distances that cannot be used.
    #[error("known positions and distances: {0}")]
    Known(String),
    /// The calibration was stopped through its [`Monitor`]; with the best network so far, if there
    /// was one.
    #[error("calibration was cancelled")]
    Cancelled(Option<Box<Unfinished<D>>>),
}

impl<const D: usize> CalibrateError<D> {
    /// With this network where the calibration was stopped.
    pub(crate) fn leaving(self, best: Option<Unfinished<D>>) -> CalibrateError<D> {
        match self {
            CalibrateError::Cancelled(_) => CalibrateError::Cancelled(best.map(Box::new)),
            other => other,
        }
    }
}
