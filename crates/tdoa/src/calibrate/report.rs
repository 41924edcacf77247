//! The result: the network in a frame, its uncertainty, what may be wrong with it.

use serde::Serialize;

use super::inlier_deviation;
use super::known::{Anchors, SpeedEstimate};
use super::options::CalibrateOptions;
use super::warnings::warn_of_nodes;
use crate::align::{Transform, align, frame};
use crate::degeneracy::Usable;
use crate::network::Network;
use crate::observations::Observations;
use crate::plane::distance;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{Covariance, Refined, covariance};

/// A calibrated network. Lengths are in metres; `None` stands for what could not be determined.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibration {
    /// Size of the matrix, such as `6r/46s`.
    pub configuration: String,
    /// Names of the receivers.
    pub receiver_names: Vec<String>,
    /// Names of the transmitters.
    pub transmitter_names: Vec<String>,
    /// Positions of the receivers. Unless another frame is asked for, the first receiver is the origin, the second lies
    /// on the positive x axis and the third above it.
    pub receivers: Vec<Option<[f64; 2]>>,
    /// Positions of the transmitters.
    pub transmitters: Vec<Option<[f64; 2]>>,
    /// Offsets of the transmitters.
    pub offsets: Vec<Option<f64>>,
    /// Which measurements agree with the network; false where there is none.
    pub inliers: Vec<Vec<bool>>,
    /// Residuals f_ij - o_j - |r_i - s_j|, where measured.
    pub residuals: Vec<Vec<Option<f64>>>,
    /// Standard deviation of the measurements: as given, or estimated from the inliers. A factor on the deviations that
    /// measurements carry, if they do.
    pub sigma: f64,
    /// Whether `sigma` was estimated.
    pub sigma_estimated: bool,
    /// Root mean square of the inliers' residuals.
    pub residual_rms: f64,
    /// Inliers minus unknowns: what the estimate of `sigma` rests on.
    pub redundancy: usize,
    /// Radius of 95 % ellipses in standard deviations; `None` if nothing is left over to estimate `sigma` from.
    pub ellipse_radius: Option<f64>,
    /// Standard deviations of the receivers' coordinates in the gauge.
    pub receiver_std: Vec<Option<[f64; 2]>>,
    /// Covariances of the receivers in the gauge.
    pub receiver_covariance: Vec<Option<[[f64; 2]; 2]>>,
    /// Standard deviations of the transmitters' coordinates in the gauge.
    pub transmitter_std: Vec<Option<[f64; 2]>>,
    /// Covariances of the transmitters in the gauge.
    pub transmitter_covariance: Vec<Option<[[f64; 2]; 2]>>,
    /// Standard deviations of the offsets.
    pub offset_std: Vec<Option<f64>>,
    /// Which receivers were held at known positions.
    pub anchored: Vec<bool>,
    /// The propagation speed, if it was to be estimated; all lengths are those of the estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<SpeedEstimate>,
    /// What the covariances are relative to.
    pub gauge: &'static str,
    /// Whether no other network that was found explains the measurements about as well, and more than one or two starts of the search
    /// found this one.
    pub unique: bool,
    /// Other networks that do, best first.
    pub alternatives: Vec<Alternative>,
    /// Whether the measurements fit a network in the plane.
    pub planar: bool,
    /// What may be wrong, with names and a remedy.
    pub warnings: Vec<String>,
    /// Seed of the search.
    pub seed: u64,
    /// Starts of the search.
    pub starts: usize,
    /// Starts that ended in the best basin.
    pub agreeing: usize,
    /// Probability that a basin which catches one start in twenty would have been seen.
    pub confidence: f64,
    /// Comparison with the truth, if that was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
}

/// Another network that explains the measurements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alternative {
    /// Positions of the receivers.
    pub receivers: Vec<Option<[f64; 2]>>,
    /// Positions of the transmitters.
    pub transmitters: Vec<Option<[f64; 2]>>,
    /// Offsets of the transmitters.
    pub offsets: Vec<Option<f64>>,
    /// Root mean square of the residuals of its own inliers.
    pub residual: f64,
    /// By how much the measurements are less likely than under the best network, natural logarithm.
    pub log_likelihood_loss: f64,
}

/// Comparison with known positions of receivers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// Root mean square distance of the receivers after the best rigid alignment (reflection allowed).
    pub receiver_rms: f64,
    /// The same with a common scale fitted as well.
    pub receiver_rms_scaled: f64,
    /// That scale, from the calibration to the truth.
    pub scale: f64,
    /// Receivers that were compared.
    pub receivers: usize,
    /// The true positions in the frame of the calibration (rigid alignment), in the order of the receivers.
    pub positions: Vec<Option<[f64; 2]>>,
    /// Median distance of the transmitters from the truth after the alignment of the receivers, if true transmitters were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmitter_median: Option<f64>,
    /// Their true positions in the frame of the calibration, in the order of the transmitters; empty if none were given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub transmitter_positions: Vec<Option<[f64; 2]>>,
}

impl Truth {
    fn points(&mut self) -> impl Iterator<Item = &mut Option<[f64; 2]>> {
        self.positions.iter_mut().chain(&mut self.transmitter_positions)
    }
}

impl Calibration {
    /// Measurements of a receiver, and how many of them are outliers.
    pub fn counts_of_receiver(&self, i: usize) -> [usize; 2] {
        self.counts((0..self.transmitter_names.len()).map(|j| (i, j)))
    }

    /// Measurements of a transmitter, and how many of them are outliers.
    pub fn counts_of_transmitter(&self, j: usize) -> [usize; 2] {
        self.counts((0..self.receiver_names.len()).map(|i| (i, j)))
    }

    fn counts(&self, cells: impl Iterator<Item = (usize, usize)>) -> [usize; 2] {
        let measured = cells.filter(|&(i, j)| self.residuals[i][j].is_some());
        measured.fold([0, 0], |[all, outliers], (i, j)| [all + 1, outliers + usize::from(!self.inliers[i][j])])
    }

    /// Moves the whole result into another frame.
    pub fn transform(&mut self, map: &Transform) {
        let point = |p: &mut Option<[f64; 2]>| *p = p.map(|p| map.apply(p));
        self.receivers.iter_mut().chain(&mut self.transmitters).for_each(point);
        for other in &mut self.alternatives {
            other.receivers.iter_mut().chain(&mut other.transmitters).for_each(point);
        }
        if let Some(truth) = &mut self.truth {
            truth.points().for_each(point);
        }
        let turn = |c: &mut Option<[[f64; 2]; 2]>| *c = c.map(|c| map.apply_covariance(c));
        self.receiver_covariance.iter_mut().chain(&mut self.transmitter_covariance).for_each(turn);
        let std = |all: &[Option<[[f64; 2]; 2]>]| -> Vec<Option<[f64; 2]>> {
            all.iter().map(|c| c.map(|c| [c[0][0].max(0.0).sqrt(), c[1][1].max(0.0).sqrt()])).collect()
        };
        self.receiver_std = std(&self.receiver_covariance);
        self.transmitter_std = std(&self.transmitter_covariance);
    }

    /// Multiplies all lengths of the result by a factor, as if the propagation speed were that much larger. A comparison
    /// with the truth keeps its figures.
    pub fn rescale(&mut self, factor: f64) {
        let positions = self.truth.as_ref().map(|truth| [truth.positions.clone(), truth.transmitter_positions.clone()]);
        let map = Transform { rotation: [[1.0, 0.0], [0.0, 1.0]], scale: factor, translation: [0.0; 2] };
        self.transform(&map);
        let lengths = self.offsets.iter_mut().chain(&mut self.offset_std);
        let lengths = lengths.chain(self.residuals.iter_mut().flatten());
        lengths.chain(self.alternatives.iter_mut().flat_map(|a| &mut a.offsets)).flatten().for_each(|x| *x *= factor);
        self.alternatives.iter_mut().for_each(|a| a.residual *= factor);
        self.sigma *= factor;
        self.residual_rms *= factor;
        // The truth stays as large as it is, about the middle of the scaled network.
        if let (Some([positions, transmitters]), Some(truth)) = (positions, &mut self.truth) {
            let known: Vec<[f64; 2]> = positions.iter().flatten().copied().collect();
            let pairs = positions.iter().zip(&self.receivers).filter_map(|(p, r)| Some(((*p)?, (*r)?)));
            let (from, to): (Vec<_>, Vec<_>) = pairs.unzip();
            if !known.is_empty()
                && let Some(back) = align(&from, &to, false)
            {
                truth.positions = positions;
                truth.transmitter_positions = transmitters;
                truth.points().for_each(|p| *p = p.map(|p| back.transform.apply(p)));
            }
        }
    }

    /// Moves the result to where the anchors are: held ones are about their centroid so far, a single one is anywhere.
    fn put_on(&mut self, anchors: &Anchors, rows: &[usize], held: bool) {
        let first = anchors.positions.iter().position(Option::is_some).and_then(|a| self.receivers[rows[a]]);
        let [x, y] = if held { [0.0; 2] } else { first.unwrap_or([0.0; 2]) };
        let mut map = Transform { rotation: [[1.0, 0.0], [0.0, 1.0]], scale: 1.0, translation: [0.0; 2] };
        map.translation = [anchors.centre[0] - x, anchors.centre[1] - y];
        self.transform(&map);
    }

    /// Compares with true positions of receivers, in the order of the receivers, as far as they are known. Does nothing
    /// with fewer than two.
    pub fn compare(&mut self, truth: &[Option<[f64; 2]>]) {
        self.compare_all(truth, &[]);
    }

    /// [`Calibration::compare`] with true transmitters too, in the order of the transmitters, as far as they are known.
    pub fn compare_all(&mut self, truth: &[Option<[f64; 2]>], transmitters: &[Option<[f64; 2]>]) {
        let pairs: Vec<([f64; 2], [f64; 2])> =
            self.receivers.iter().zip(truth).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
        let (found, known): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        if found.len() < 2 {
            return;
        }
        let (Some(rigid), Some(scaled)) = (align(&found, &known, false), align(&found, &known, true)) else { return };
        let Some(back) = align(&known, &found, false) else { return };
        let moved =
            |all: &[Option<[f64; 2]>]| all.iter().map(|p| p.map(|p| back.transform.apply(p))).collect::<Vec<_>>();
        let transmitter_positions = moved(transmitters);
        let pairs = self.transmitters.iter().zip(&transmitter_positions).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        let mut errors: Vec<f64> = pairs.map(|(a, b)| distance(a, b)).collect();
        errors.sort_by(f64::total_cmp);
        self.truth = Some(Truth {
            receiver_rms: rigid.rms,
            receiver_rms_scaled: scaled.rms,
            scale: scaled.transform.scale,
            receivers: found.len(),
            positions: moved(truth),
            transmitter_median: errors.get(errors.len() / 2).copied(),
            transmitter_positions,
        });
    }
}

/// Starts that must end in the best network before it is called unique: one or two may have found it while a better one was missed.
const SETTLED: usize = 3;

/// What the search and the refinement leave to report.
pub(super) struct Solved<'a> {
    pub(super) measured: &'a Pseudoranges,
    pub(super) usable: &'a Usable,
    pub(super) observations: &'a Observations,
    pub(super) centred: &'a Pseudoranges,
    pub(super) shifts: &'a [f64],
    /// At least one network.
    pub(super) ranked: Vec<Refined>,
    pub(super) deviation: f64,
    pub(super) known: Option<f64>,
    pub(super) starts: usize,
    pub(super) agreeing: usize,
    pub(super) anchors: Option<Anchors>,
    pub(super) speed: Option<SpeedEstimate>,
    /// Warnings of the steps before.
    pub(super) warnings: Vec<String>,
}

impl Solved<'_> {
    pub(super) fn report(&self, options: &CalibrateOptions) -> Calibration {
        let best = &self.ranked[0].network;
        let estimated = inlier_deviation(self.observations, best, self.deviation, options.inlier_threshold);
        let sigma = self.known.unwrap_or(estimated);
        let inlier = |network: &Network, i: usize, j: usize| -> bool {
            let residual = self.centred.get(i, j).map(|f| f - network.pseudorange(i, j));
            let deviation = sigma * self.centred.sigma(i, j).unwrap_or(1.0);
            residual.is_some_and(|e| e.abs() <= options.inlier_threshold * deviation)
        };
        let held = self.observations.held();
        let is_held = held.contains(&true);
        let kept = Observations::new(self.centred, |i, j| inlier(best, i, j)).holding(held);
        let mut warnings = [self.usable.warnings.as_slice(), &self.warnings].concat();
        let redundancy = kept.len().saturating_sub(kept.unknowns());
        let ellipse_radius = radius_95(redundancy, self.known.is_some());
        let uncertainty = match ellipse_radius {
            // What the robust loss loses against least squares on normal noise is added.
            Some(_) => covariance(&kept, best, sigma / EFFICIENCY.sqrt()).unwrap_or_default(),
            None => {
                warnings.push(
                    "there are only as many measurements as unknowns, so the noise cannot be estimated and no uncertainty is \
                     given; give --sigma"
                        .to_string(),
                );
                Covariance::default()
            }
        };
        let planar = self.planar(best, estimated, options, &mut warnings);
        warn_of_nodes(self.centred, best, &kept, &uncertainty, ellipse_radius.is_some(), &mut warnings);

        let (m, n) = (self.measured.receivers(), self.measured.transmitters());
        let (rows, columns) = (&self.usable.receivers, &self.usable.transmitters);
        let spread_rows = |all: &[[f64; 2]]| scatter(m, rows, all);
        let spread_columns = |all: &[[f64; 2]]| scatter(n, columns, all);
        let offsets = |network: &Network| -> Vec<Option<f64>> {
            let moved: Vec<f64> = network.offsets.iter().zip(self.shifts).map(|(o, shift)| o + shift).collect();
            scatter(n, columns, &moved)
        };
        let mut inliers = vec![vec![false; n]; m];
        let mut residuals = vec![vec![None; n]; m];
        for (a, &i) in rows.iter().enumerate() {
            for (b, &j) in columns.iter().enumerate() {
                inliers[i][j] = inlier(best, a, b);
                residuals[i][j] = self.centred.get(a, b).map(|f| f - best.pseudorange(a, b));
            }
        }
        let rms = |network: &Network| -> f64 {
            let cells = (0..rows.len()).flat_map(|a| (0..columns.len()).map(move |b| (a, b)));
            let squares: Vec<f64> = cells
                .filter(|&(a, b)| inlier(network, a, b))
                .filter_map(|(a, b)| self.centred.get(a, b).map(|f| (f - network.pseudorange(a, b)).powi(2)))
                .collect();
            (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
        };
        let alternatives: Vec<Alternative> = self.ranked[1..]
            .iter()
            .map(|other| (other, other.objective - self.ranked[0].objective))
            .filter(|(_, loss)| *loss <= options.alternative_margin)
            .filter_map(|(other, loss)| {
                let network = if is_held {
                    other.network.clone()
                } else {
                    align(&other.network.receivers, &best.receivers, false)?.transform.apply_network(&other.network)
                };
                Some(Alternative {
                    receivers: spread_rows(&network.receivers),
                    transmitters: spread_columns(&network.transmitters),
                    offsets: offsets(&network),
                    residual: rms(&network),
                    log_likelihood_loss: loss,
                })
            })
            .collect();
        if !alternatives.is_empty() {
            warnings.push(format!(
                "{} other network{} explain{} the measurements about as well (see alternatives); add receivers or transmitters, \
                 or give --sigma if the noise is known",
                alternatives.len(),
                if alternatives.len() == 1 { "" } else { "s" },
                if alternatives.len() == 1 { "s" } else { "" },
            ));
        }
        let settled = self.agreeing >= options.agreeing.min(options.max_starts).min(SETTLED);
        if !settled {
            warnings.push(format!(
                "only {} of {} starts of the search ended in this network, so that a better one may have been missed; give --sigma, \
                 remove measurements that are known to be wrong, or raise --max-starts",
                self.agreeing, self.starts
            ));
        }
        let located = |c: &Option<[[f64; 3]; 3]>| c.map(|c| [[c[0][0], c[0][1]], [c[1][0], c[1][1]]]);
        let transmitters: Vec<_> = uncertainty.transmitters.iter().map(located).collect();
        let offset_std: Vec<_> = uncertainty.transmitters.iter().map(|c| c.map(|c| c[2][2].max(0.0).sqrt())).collect();
        let mut calibration = Calibration {
            configuration: self.measured.configuration(),
            receiver_names: self.measured.receiver_names().to_vec(),
            transmitter_names: self.measured.transmitter_names().to_vec(),
            receivers: spread_rows(&best.receivers),
            transmitters: spread_columns(&best.transmitters),
            offsets: offsets(best),
            inliers,
            residuals,
            sigma,
            sigma_estimated: self.known.is_none(),
            residual_rms: rms(best),
            redundancy,
            ellipse_radius,
            receiver_std: Vec::new(),
            receiver_covariance: scatter(m, rows, &uncertainty.receivers),
            transmitter_std: Vec::new(),
            transmitter_covariance: scatter(n, columns, &transmitters).into_iter().map(Option::flatten).collect(),
            offset_std: scatter(n, columns, &offset_std).into_iter().map(Option::flatten).collect(),
            anchored: scatter(m, rows, held).into_iter().map(|held| held == Some(true)).collect(),
            speed: self.speed,
            gauge: match (is_held, self.speed.is_some()) {
                (false, _) => "inner constraint over the receivers: relative to their best rigid alignment",
                (true, false) => "relative to the receivers of known position, which have no error",
                (true, true) => {
                    "relative to the receivers of known position, which have no error, at the estimated propagation speed"
                }
            },
            unique: alternatives.is_empty() && settled,
            alternatives,
            planar,
            warnings,
            seed: options.seed,
            starts: self.starts,
            agreeing: self.agreeing,
            confidence: 1.0 - 0.95f64.powi(self.starts.min(100_000) as i32),
            truth: None,
        };
        for i in &uncertainty.loose {
            calibration.receiver_covariance[rows[*i]] = None;
        }
        if !is_held {
            calibration.transform(&default_frame(&best.receivers));
        }
        if let Some(speed) = &self.speed {
            calibration.rescale(speed.factor);
        }
        if let Some(anchors) = &self.anchors {
            calibration.put_on(anchors, rows, is_held);
        }
        calibration
    }

    fn planar(&self, best: &Network, estimated: f64, options: &CalibrateOptions, warnings: &mut Vec<String>) -> bool {
        // In metres also where measurements carry their own deviations.
        let metre = self.speed.map_or(1.0, |speed| speed.factor);
        let misfit = metre * estimated * super::typical_deviation(self.centred);
        let size = metre * best.size();
        if let Some(sigma) = self.known
            && estimated > 3.0 * sigma
        {
            warnings.push(format!(
                "the residuals are {:.1} times as large as the given standard deviation: it is too small, or the network is \
                 not planar",
                estimated / sigma
            ));
        }
        if misfit > options.planar_limit * size {
            warnings.push(format!(
                "the measurements do not fit a network in the plane: the residuals' deviation is {misfit:.3} m, {:.1} % of \
                 the network's size {size:.3} m; receivers and transmitters must lie in one plane, and at most about a \
                 third of the measurements may be wrong",
                100.0 * misfit / size
            ));
            return false;
        }
        true
    }
}

/// Efficiency of the last refinement's Cauchy loss on normal noise.
const EFFICIENCY: f64 = 0.95;

/// Radius of the 95 % ellipse in standard deviations. With the deviation known its square is the 95 % quantile of
/// chi-squared with two degrees of freedom, -2 ln 0.05; with one estimated from k residuals left over it is twice that of
/// F(2, k), which is k (0.05^(-2/k) - 1).
fn radius_95(redundancy: usize, known: bool) -> Option<f64> {
    let k = redundancy as f64;
    if known {
        Some((-2.0 * 0.05f64.ln()).sqrt())
    } else if redundancy == 0 {
        None
    } else {
        Some((k * (0.05f64.powf(-2.0 / k) - 1.0)).sqrt())
    }
}

/// Values at these indices of a longer list.
fn scatter<T: Copy>(length: usize, at: &[usize], values: &[T]) -> Vec<Option<T>> {
    let mut all = vec![None; length];
    for (&k, &value) in at.iter().zip(values) {
        all[k] = Some(value);
    }
    all
}

/// First receiver at the origin, second on the x axis, third above; other receivers take their place where these
/// coincide or are in line.
fn default_frame(receivers: &[[f64; 2]]) -> Transform {
    let identity = Transform { rotation: [[1.0, 0.0], [0.0, 1.0]], scale: 1.0, translation: [0.0; 2] };
    let origin = receivers[0];
    let candidates = receivers[1..].iter().flat_map(|&x| receivers[1..].iter().map(move |&up| (x, up)));
    candidates.filter_map(|(x, up)| frame(origin, x, up)).next().unwrap_or(identity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radius_of_ellipses() {
        // Tables: the 95 % quantile of chi-squared with 2 degrees of freedom is 5.991; of F(2, 1) 199.5, F(2, 10) 4.103.
        assert!((radius_95(7, true).unwrap().powi(2) - 5.991).abs() < 1e-3);
        assert!((radius_95(1, false).unwrap().powi(2) - 2.0 * 199.5).abs() < 0.1);
        assert!((radius_95(10, false).unwrap().powi(2) - 2.0 * 4.103).abs() < 1e-3);
        assert!((radius_95(1_000_000, false).unwrap().powi(2) - 5.991).abs() < 1e-3);
        assert_eq!(radius_95(0, false), None);
    }
}
