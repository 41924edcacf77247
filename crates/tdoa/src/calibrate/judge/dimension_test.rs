//! What measurements say of a third coordinate.

use serde::{Deserialize, Serialize};

/// What the measurements say of a third coordinate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DimensionTest {
    /// How much more likely the measurements are in the best network in space than in the best one in the plane
    /// (natural logarithm); `None` where space could not be tried, for instance because there are too few measurements.
    pub gain: Option<f64>,
    /// The gain above which heights are no chance; `None` where none would do, for lack of measurements beyond the
    /// unknowns in space.
    pub needed: Option<f64>,
    /// How much more likely the measurements are in space than in the plane, over all networks (natural logarithm of
    /// the ratio of marginal likelihoods): below zero they are better explained without heights.
    #[serde(default)]
    pub evidence: Option<f64>,
    /// By how many standard deviations of a measurement the likeliest heights change the distances, root mean square.
    #[serde(default)]
    pub change: Option<f64>,
}

/// How far the nodes of a nearly flat network in space lie from their plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlaneDistances {
    /// Root mean square of the receivers' distances from their plane, metres: the largest that the measurements allow.
    pub receivers: f64,
    /// Root mean square of the transmitters' distances from the plane of the receivers, metres.
    pub transmitters: f64,
    /// How far two levels lie apart on which the receivers are expected, metres; `None` where they are on one.
    #[serde(default)]
    pub levels: Option<f64>,
    /// By how much such distances from the plane change the distances between receivers and transmitters, root mean
    /// square, metres.
    pub change: f64,
}

/// Odds of a hundred, as a natural logarithm.
const SURE: f64 = 2.0 * std::f64::consts::LN_10;

/// Heights that change distances by less than this many deviations of a measurement move no node of the plane by more
/// than its errors.
const MATTER: f64 = 1.0;

/// Without a ratio of marginal likelihoods, as where errors are one-sided, a gain by this factor away from the one needed
/// tells.
const CLEARLY: f64 = 2.0;

impl DimensionTest {
    /// Whether the best network in space fits better than chance would have it, by so many times what that gains at most.
    fn gains(&self, factor: f64) -> bool {
        self.gain.zip(self.needed).is_some_and(|(gain, needed)| gain >= factor * needed)
    }

    /// Whether the measurements ask for space: they are much more likely there, or about as likely where the best
    /// network in the plane fits too badly.
    pub(crate) fn is_space(&self) -> bool {
        let Some(evidence) = self.evidence else { return self.gains(1.0) };
        evidence > SURE || (evidence > -SURE && self.gains(1.0))
    }

    /// Whether the evidence is much larger than that of other heights.
    pub(crate) fn is_likelier_than(&self, other: &DimensionTest) -> bool {
        self.evidence.zip(other.evidence).is_some_and(|(one, other)| one > other + SURE)
    }

    /// Whether the measurements leave both, the plane and space.
    pub(crate) fn leaves_both(&self) -> bool {
        match self.evidence {
            None => self.needed.is_none() || (self.gains(1.0 / CLEARLY) && !self.gains(CLEARLY)),
            Some(evidence) if self.is_space() => evidence < SURE,
            Some(evidence) => {
                let heights_matter = self.change.is_none_or(|change| change > MATTER);
                self.gains(1.0) || (evidence > -SURE && heights_matter)
            }
        }
    }
}
