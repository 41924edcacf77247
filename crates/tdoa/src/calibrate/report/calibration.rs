//! The result of a calibration: the network in a frame, its uncertainty, and what may be wrong with
//! it.

use crate::align::{Alignment, Transform, align, spanned};
use crate::calibrate::input::anchors::Anchors;
use crate::calibrate::input::speed::SpeedEstimate;
use crate::calibrate::judge::dimension_test::{DimensionTest, PlaneDistances};
use crate::calibrate::judge::far_transmitters::FarTransmitter;
use crate::calibrate::judge::mirror_images::MirrorImage;
use crate::calibrate::options::Errors;
use crate::calibrate::receivers::echo::ReceiverEcho;
use crate::calibrate::receivers::errors::ReceiverError;
use crate::calibrate::report::candidates::ChosenCandidate;
use crate::calibrate::report::clocks::RecorderClock;
use crate::calibrate::report::distances::MeasuredDistance;
use crate::calibrate::report::residuals::{Residual, Residuals};
use crate::calibrate::report::systematic::SystematicErrors;
use crate::calibrate::report::truth::Truth;
use crate::clocks::Emissions;
use crate::degeneracy::Usable;
use crate::observations::Node;
use crate::points::{extent, minus};
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use std::borrow::Cow;

/// A calibrated network. Lengths are in metres; `None` marks what could not be determined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(
    serialize = "[f64; D]: Serialize, [[f64; D]; D]: Serialize",
    deserialize = "[f64; D]: Deserialize<'de>, [[f64; D]; D]: Deserialize<'de>"
))]
pub struct Calibration<const D: usize = 2> {
    /// Numbers of a position: 2 in the plane, 3 in space.
    #[serde(default = "plane")]
    pub dimensions: usize,
    /// Size of the matrix, such as `6r/46s`.
    pub configuration: String,
    /// Names of the receivers.
    pub receiver_names: Vec<String>,
    /// Names of the transmitters.
    pub transmitter_names: Vec<String>,
    /// Positions of the receivers. A receiver most of whose measurements are outliers also has
    /// `None`, if the remaining measurements may agree by chance. Unless another frame is
    /// requested, the first receiver is the origin, the second lies on the positive x axis, the
    /// third above it and, in space, the fourth above the plane of these.
    pub receivers: Vec<Option<[f64; D]>>,
    /// Positions of the transmitters.
    pub transmitters: Vec<Option<[f64; D]>>,
    /// Offsets of the transmitters.
    pub offsets: Vec<Option<f64>>,
    /// The residuals of the measurements, and which measurements agree with the network.
    #[serde(flatten)]
    pub residuals: Residuals,
    /// Standard deviation of the measurements: as given, or estimated from the inliers. If
    /// measurements carry their own deviations or weights, a factor on those: with weights, the deviation of one of median
    /// weight.
    pub sigma: f64,
    /// Whether `sigma` was estimated.
    pub sigma_estimated: bool,
    /// Whether measurements carry their own deviations or weights, so that `sigma` is a factor on those.
    #[serde(default)]
    pub sigma_is_factor: bool,
    /// Root mean square of the inliers' residuals.
    pub residual_rms: f64,
    /// Inliers minus unknowns: the redundancy from which `sigma` is estimated.
    pub redundancy: usize,
    /// Radius of 95 % ellipses in standard deviations; `None` if there is no redundancy from which
    /// to estimate `sigma`.
    pub ellipse_radius: Option<f64>,
    /// Standard deviations of the receivers' coordinates in the gauge.
    pub receiver_std: Vec<Option<[f64; D]>>,
    /// Covariances of the receivers in the gauge.
    pub receiver_covariance: Vec<Option<[[f64; D]; D]>>,
    /// Standard deviations of the transmitters' coordinates in the gauge.
    pub transmitter_std: Vec<Option<[f64; D]>>,
    /// Covariances of the transmitters in the gauge.
    pub transmitter_covariance: Vec<Option<[[f64; D]; D]>>,
    /// Standard deviations of the offsets.
    pub offset_std: Vec<Option<f64>>,
    /// Which receivers were held at known positions.
    pub anchored: Vec<bool>,
    /// The propagation speed, if it was to be estimated. All lengths are those for the estimated
    /// speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<SpeedEstimate>,
    /// What the covariances are relative to.
    pub gauge: Cow<'static, str>,
    /// Whether the network is unique. This means that no other network that was found explains the
    /// measurements about as well, nor a mirror image of a node, more than one or two starts of the search found this one, and
    /// the data fit. Also, the receivers are determined, none with a deviation larger than the
    /// network; known positions do not contradict the measurements; and no receiver shows an error
    /// of its own that was left in.
    pub unique: bool,
    /// Whether the receivers are unique: in other networks only transmitters lie elsewhere.
    pub unique_receivers: bool,
    /// Whether the transmitters are unique; one in ten of them may lie elsewhere.
    pub unique_transmitters: bool,
    /// Other networks that explain the measurements about as well, best first.
    pub alternatives: Vec<Alternative<D>>,
    /// In space, places of single nodes on the other side of a plane that explain the measurements as well:
    /// transmitters where the receivers that hear them lie in one plane, receivers likewise. Each node has
    /// its side for itself, relative to all others, so that k of them leave 2^k networks, or 2^(k-1) where
    /// the frame does not tell the sides of the plane. Networks that differ in these sides alone are no
    /// alternatives. None in the plane.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub mirror_images: Vec<MirrorImage<D>>,
    /// Whether the measurements fit a network of these dimensions. This is false, too, where more than three tenths of them are
    /// outliers and fewer than three starts of the search ended in the network.
    #[serde(default = "agree")]
    pub fits: bool,
    /// Whether the measurements fit a network in the plane; false in space, where that is not asked.
    pub planar: bool,
    /// What the measurements say of a third coordinate, where it was theirs to decide.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dimension_test: Option<DimensionTest>,
    /// In space, how far nodes are expected to lie from their plane, where measurements alone do not tell all of these
    /// distances. Positions and covariances take this expectation into account.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane_distances: Option<PlaneDistances>,
    /// Transmitters of which the measurements tell the direction, and no more of the distance than that it is not below a
    /// bound. The position given is one of many in this direction.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub far_transmitters: Vec<FarTransmitter<D>>,
    /// Whether the measurements determine at least half of the receivers to a tenth of the
    /// network's size; true if the noise is not known. This is false, for instance, for a table
    /// with receivers as columns. It is false, too, where receivers or transmitters lie in one line of
    /// space, about which the others may turn, and where fewer than three starts of the search ended in the network and
    /// more other ones, a tenth of its size away, explain the measurements about as well.
    pub determined: bool,
    /// Whether the known positions agree with the measurements, to the same share of the network's
    /// size to which the measurements have to agree with a plane; true if no positions are known.
    #[serde(default = "agree")]
    pub anchors_agree: bool,
    /// Errors of single receivers that the measurements show, most significant first, or delays of
    /// all receivers, relative to their mean, where [`ReceiverDelays::Auto`](crate::ReceiverDelays::Auto) finds these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub receiver_errors: Vec<ReceiverError>,
    /// Receivers of which the measurements show two places, most likely as they hear a reflection, which is left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub receiver_echoes: Vec<ReceiverEcho>,
    /// Measurements of which another candidate than the first was chosen, in the order of the matrix; see
    /// [`Pseudoranges::with_candidates`](crate::Pseudoranges::with_candidates). Residuals are those of the chosen ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub chosen: Vec<ChosenCandidate>,
    /// Number of measurements that have more than one candidate.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub with_candidates: usize,
    /// Systematic errors of the receivers, and the covariances with them. `None` where fewer than ten
    /// measurements are left over, there are more than 100 receivers, or errors are one-sided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub systematic: Option<SystematicErrors<D>>,
    /// What may be wrong, with names and a remedy.
    pub warnings: Vec<String>,
    /// Clocks of the recorders against the first one, where they have clocks of their own. Offsets of transmitters are by the
    /// clock of the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<RecorderClock>,
    /// Distances between receivers that were measured besides; see
    /// [`CalibrateOptions::distances`](crate::CalibrateOptions::distances).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub distances: Vec<MeasuredDistance>,
    /// What was known of the times at which transmitters sent. Where they were known, offsets are zero.
    #[serde(default)]
    pub emissions: Emissions,
    /// How wrong measurements were expected to be wrong: [`Errors::Symmetric`] or [`Errors::OneSided`].
    #[serde(default = "symmetric")]
    pub errors: Errors,
    /// Seed of the search.
    pub seed: u64,
    /// Number of starts of the search, or of small networks if these were laid together.
    pub starts: usize,
    /// Number of starts that ended in the best basin, or of small networks that fit the whole.
    pub agreeing: usize,
    /// Whether hearing is local, so that small networks of neighbours were laid together.
    #[serde(default)]
    pub laid_together: bool,
    /// Probability that a basin which catches one start in twenty would have been found.
    pub confidence: f64,
    /// Comparison with the truth, if it was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth<D>>,
}

fn counts<'a>(residuals: impl Iterator<Item = &'a Residual>) -> [usize; 2] {
    residuals.fold([0, 0], |[all, outliers], residual| [all + 1, outliers + usize::from(!residual.inlier)])
}

/// Standard deviations of the coordinates.
fn deviations<const D: usize>(covariances: &[Option<[[f64; D]; D]>]) -> Vec<Option<[f64; D]>> {
    covariances.iter().map(|c| c.map(|c| from_fn(|k| c[k][k].max(0.0).sqrt()))).collect()
}

/// What is left out where nothing has candidates.
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Results that were written before they said so.
fn agree() -> bool {
    true
}

/// Results that were written before they said so.
fn symmetric() -> Errors {
    Errors::Symmetric
}

/// Results that were written before they could be in space.
fn plane() -> usize {
    2
}

/// Another network that explains the measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[f64; D]: Serialize", deserialize = "[f64; D]: Deserialize<'de>"))]
pub struct Alternative<const D: usize = 2> {
    /// Positions of the receivers.
    pub receivers: Vec<Option<[f64; D]>>,
    /// Positions of the transmitters.
    pub transmitters: Vec<Option<[f64; D]>>,
    /// Offsets of the transmitters.
    pub offsets: Vec<Option<f64>>,
    /// Root mean square of the residuals of this network's own inliers.
    pub residual: f64,
    /// How much less likely the measurements are than under the best network (natural logarithm).
    /// If this network lacks an error of a receiver, it says how much less evidence the
    /// measurements give for that error than for one that is taken out. If it has a delay of every
    /// receiver taken out, it contains the price of these unknowns. It is 0 for the network of
    /// one-sided errors, which has a likelihood of its own.
    pub log_likelihood_loss: f64,
    /// The error of a receiver without which the measurements fit this network. The measurements
    /// hint at it, but too weakly for the result to include it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub receiver_error: Option<ReceiverError>,
}

impl<const D: usize> Calibration<D> {
    /// Why the result cannot be trusted; `None` if it can.
    pub fn distrust(&self) -> Option<&'static str> {
        if !self.fits {
            Some(if D == 2 {
                "the measurements do not fit a network in the plane"
            } else {
                "the measurements do not fit a network in space"
            })
        } else if !self.determined {
            Some("the measurements do not determine where most nodes are")
        } else if !self.anchors_agree {
            Some("the known positions contradict the measurements")
        } else {
            None
        }
    }

    /// Calls a network not unique, with a warning that says why.
    pub(crate) fn call_not_unique(&mut self, why: String) {
        (self.unique, self.unique_receivers, self.unique_transmitters) = (false, false, false);
        self.warnings.push(why);
    }

    /// The largest distance between two receivers in metres; `None` if fewer than two could be
    /// located.
    pub fn extent(&self) -> Option<f64> {
        let located: Vec<[f64; D]> = self.receivers.iter().flatten().copied().collect();
        extent(&located)
    }

    /// Systematic errors of the receivers, if they [matter](SystematicErrors::matter): the covariances
    /// with them are then those to trust.
    pub fn relevant_systematic(&self) -> Option<&SystematicErrors<D>> {
        self.systematic.as_ref().filter(|errors| errors.matter())
    }

    /// The covariances to trust, in square metres, which tables and pictures show: of the receivers, then of
    /// the transmitters. They include systematic errors of the receivers where these matter.
    pub fn trusted_covariances(&self) -> [&[Option<[[f64; D]; D]>]; 2] {
        match self.relevant_systematic() {
            Some(errors) => [&errors.receiver_covariance, &errors.transmitter_covariance],
            None => [&self.receiver_covariance, &self.transmitter_covariance],
        }
    }

    /// The square roots of the diagonals of [`trusted_covariances`](Self::trusted_covariances), in metres.
    pub fn trusted_deviations(&self) -> [Vec<Option<[f64; D]>>; 2] {
        self.trusted_covariances().map(deviations)
    }

    /// Number of measurements of a receiver, and how many of them are outliers.
    pub fn counts_of_receiver(&self, i: usize) -> [usize; 2] {
        counts(self.residuals.row(i).map(|(_, residual)| residual))
    }

    /// Number of measurements of a transmitter, and how many of them are outliers.
    pub fn counts_of_transmitter(&self, j: usize) -> [usize; 2] {
        counts((0..self.receiver_names.len()).filter_map(|i| self.residuals.get(i, j)))
    }

    /// Whether receiver `i` measured transmitter `j` and the measurement agrees with the network.
    pub fn is_inlier(&self, i: usize, j: usize) -> bool {
        self.residuals.get(i, j).is_some_and(|residual| residual.inlier)
    }

    /// Moves the whole result into another frame.
    pub fn transform(&mut self, map: &Transform<D>) {
        let point = |p: &mut Option<[f64; D]>| *p = p.map(|p| map.apply(p));
        self.receivers.iter_mut().chain(&mut self.transmitters).for_each(point);
        for other in &mut self.alternatives {
            other.receivers.iter_mut().chain(&mut other.transmitters).for_each(point);
        }
        self.mirror_images.iter_mut().for_each(|image| image.position = map.apply(image.position));
        self.far_transmitters.iter_mut().for_each(|far| far.transform(map));
        if let Some(truth) = &mut self.truth {
            truth.points().for_each(point);
        }
        let turn = |c: &mut Option<[[f64; D]; D]>| *c = c.map(|c| map.apply_covariance(c));
        self.receiver_covariance.iter_mut().chain(&mut self.transmitter_covariance).for_each(turn);
        if let Some(systematic) = &mut self.systematic {
            systematic.transform(map);
        }
        self.receiver_std = deviations(&self.receiver_covariance);
        self.transmitter_std = deviations(&self.transmitter_covariance);
    }

    /// Multiplies all lengths of the result by a factor, as if the propagation speed were larger by
    /// that factor. A comparison with the truth keeps its figures.
    pub fn rescale(&mut self, factor: f64) {
        let positions = self.truth.as_ref().map(|truth| [truth.positions.clone(), truth.transmitter_positions.clone()]);
        self.transform(&Transform { scale: factor, ..Transform::IDENTITY });
        let lengths = self.offsets.iter_mut().chain(&mut self.offset_std);
        self.residuals.0.for_each(|residual| residual.length *= factor);
        for x in lengths.chain(self.alternatives.iter_mut().flat_map(|a| &mut a.offsets)).flatten() {
            *x *= factor;
        }
        for a in self.alternatives.iter_mut() {
            a.residual *= factor;
        }
        self.clocks.iter_mut().for_each(|clock| clock.rescale(factor));
        for known in &mut self.distances {
            [&mut known.measured, &mut known.sigma, &mut known.found].into_iter().for_each(|length| *length *= factor);
        }
        for error in self.receiver_errors.iter_mut() {
            error.size *= factor;
        }
        self.receiver_echoes.iter_mut().for_each(|echo| echo.wall *= factor);
        self.chosen.iter_mut().for_each(|chosen| chosen.value *= factor);
        if let Some(PlaneDistances { receivers, transmitters, levels, change }) = &mut self.plane_distances {
            [receivers, transmitters, change].into_iter().chain(levels).for_each(|length| *length *= factor);
        }
        if let Some(systematic) = &mut self.systematic {
            systematic.rescale(factor);
        }
        for image in self.mirror_images.iter_mut() {
            image.distance_from_plane *= factor;
        }
        self.sigma *= factor;
        self.residual_rms *= factor;
        // The truth stays as large as it is, about the middle of the scaled network.
        if let (Some([positions, transmitters]), Some(truth)) = (positions, &mut self.truth) {
            let known: Vec<[f64; D]> = positions.iter().flatten().copied().collect();
            let pairs = positions.iter().zip(&self.receivers).filter_map(|(p, r)| Some(((*p)?, (*r)?)));
            let (from, to): (Vec<_>, Vec<_>) = pairs.unzip();
            if !known.is_empty()
                && let Some(back) = align(&from, &to, false)
            {
                truth.positions = positions;
                truth.transmitter_positions = transmitters;
                for p in truth.points() {
                    *p = p.map(|p| back.transform.apply(p));
                }
            }
        }
    }

    /// Moves the result to where the anchors are: held ones are about their centroid so far, those that
    /// fix no frame are anywhere.
    pub(crate) fn put_on(&mut self, anchors: &Anchors<D>, usable: &Usable, held: bool) {
        let place = |node: Node| match node {
            Node::Receiver(a) => self.receivers[usable.receivers[a]],
            Node::Transmitter(b) => self.transmitters[usable.transmitters[b]],
        };
        let known = anchors.whole.iter().filter_map(|&(node, p)| Some((place(node)?, p)));
        let (found, known): (Vec<_>, Vec<_>) = known.unzip();
        let aligned = align(&found, &known, false).filter(|_| !held && spanned(&known) > 0);
        let map = match aligned {
            Some(Alignment { transform, .. }) => {
                let translation = from_fn(|k| transform.translation[k] + anchors.centre[k]);
                Transform { translation, ..transform }
            }
            None => {
                let from = if held { [0.0; D] } else { found.first().copied().unwrap_or([0.0; D]) };
                Transform { translation: minus(anchors.centre, from), ..Transform::IDENTITY }
            }
        };
        self.transform(&map);
    }
}
