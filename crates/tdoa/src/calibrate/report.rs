//! From the networks that the search found to the result: residuals, uncertainty, alternatives and
//! warnings.

use super::calibration::{Alternative, Calibration};
use super::delays::without_errors;
use super::deviation::{inlier_deviation, typical_deviation};
use super::input::Input;
use super::mirror::{MirrorImage, Mirrored, Sides, differs_in_sides};
use super::near::{BEYOND, Neighbour, Reason, widen};
use super::one_sided::{Information, LEAST_REDUNDANCY};
use super::options::{CalibrateError, Errors, ReceiverDelays};
use super::orientation::looks_transposed;
use super::residuals::{Residual, Residuals};
use super::same::{same_receivers, same_transmitters};
use super::sides::warn_of_sides;
use super::state::State;
use super::submaps::overlap;
use super::warnings::{doubtful_receivers, warn_of_nodes};
use crate::align::{Transform, align, first_axes, frame};
use crate::cells::Cells;
use crate::degeneracy::{list, space};
use crate::minimal::NodeKind;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::trace;
use crate::pseudoranges::Pseudoranges;
use crate::quantity::length;
use crate::refine::Covariance;
use hc::poly::{counted, one_or};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use std::borrow::Cow;

/// Starts that must end in the best network before it is called unique: one or two may have found
/// it while a better one was missed.
const SETTLED: usize = 3;

impl<const D: usize> State<'_, D> {
    /// The result of a calibration that has come to its end.
    ///
    /// # Errors
    /// Cancelled.
    pub(super) fn report(&self, input: &Input<'_>) -> Result<Calibration<D>, CalibrateError<D>> {
        let State { options, monitor, .. } = *self;
        let best = &self.ranked[0].network;
        let one_sided = (options.errors == Errors::OneSided)
            .then(|| Information::new(&self.observations, best, self.deviation, self.known, monitor))
            .transpose()?;
        let estimated = match &one_sided {
            // Measurements that are late by little would count as noise.
            Some(information) => information.mixture.deviation,
            None => inlier_deviation(&self.observations, best, self.deviation, options.inlier_threshold),
        };
        let sigma = self.known.unwrap_or(estimated);
        let inlier = |measured: &Pseudoranges, network: &Network<D>, i: usize, j: usize| -> bool {
            let residual = measured.get(i, j).map(|f| f - network.pseudorange(i, j));
            let deviation = sigma * self.measured.sigma(i, j).unwrap_or(1.0);
            residual.is_some_and(|e| e.abs() <= options.inlier_threshold * deviation)
        };
        let held = self.observations.held();
        let is_held = held.contains(&true) || !self.observations.pins().is_empty();
        let kept = Observations::new(&self.measured, |i, j| inlier(&self.measured, best, i, j))
            .holding(held)
            .pinned(self.observations.pins())
            .beside(self.observations.others());
        let mut warnings = [input.usable.warnings.as_slice(), &self.warnings].concat();
        let redundancy = kept.len().saturating_sub(kept.unknowns());
        let ellipse_radius = radius_95::<D>(redundancy, self.known.is_some());
        let mut uncertainty = match ellipse_radius {
            Some(_) => match &one_sided {
                Some(information) => self.covariance(&information.trusted, sigma)?,
                // What the robust loss loses against least squares on normal noise is added.
                None => self.covariance(&kept, sigma / EFFICIENCY.sqrt())?,
            },
            None => {
                warnings.push(
                    "there are only as many measurements as unknowns, so the noise cannot be estimated and no uncertainty is \
                     given; give --sigma"
                        .to_string(),
                );
                Covariance::default()
            }
        };
        let mut apart: Vec<&Neighbour<D>> = Vec::new();
        if let Some(radius) = ellipse_radius {
            let likely = self.neighbours.iter().filter(|n| n.loss <= options.alternative_margin);
            apart.extend(likely.filter(|n| n.distance(&uncertainty) >= BEYOND));
            widen(&mut uncertainty, &self.neighbours, radius);
        }
        let fits = self.fits(estimated, redundancy, &mut warnings);
        let noise_known = ellipse_radius.is_some();
        let band = 2.0 * options.inlier_threshold * sigma * typical_deviation(&self.measured);
        let doubtful = doubtful_receivers(&self.measured, &kept, band / best.size());
        let transposed = self.seems_transposed(input, estimated);
        if transposed {
            warnings.insert(
                0,
                "the offsets that transmitters should have are in the rows of the table, where receivers should be, and the network does \
                 not fit: transpose the table"
                    .to_string(),
            );
        }
        let sides = Sides {
            observations: &self.observations,
            kept: &kept,
            network: best,
            deviation: sigma,
            uncertainty: &uncertainty,
            margin: options.alternative_margin,
        };
        let mut mirrored = sides.mirror_images(monitor)?;
        let placeless = |i: &usize| doubtful.contains(i) || uncertainty.loose.contains(i);
        mirrored.retain(|image| image.kind == NodeKind::Transmitters || !placeless(&image.index));
        let turn = warn_of_sides(&self.measured, best, &uncertainty, &mirrored, &mut warnings);
        let determined =
            warn_of_nodes(&self.measured, best, &kept, &uncertainty, noise_known, &doubtful, &mut warnings)
                && !turn
                && !transposed
                && 2 * doubtful.len() < best.receivers.len();
        let anchors_agree = self.contradiction.is_none_or(|off| off <= options.planar_limit * best.size());

        let (m, n) = (input.table.receivers(), input.table.transmitters());
        let (rows, columns) = (&input.usable.receivers, &input.usable.transmitters);
        let spread_rows = |all: &[[f64; D]]| scatter(m, rows, all);
        let spread_columns = |all: &[[f64; D]]| scatter(n, columns, all);
        let offsets = |network: &Network<D>| -> Vec<Option<f64>> {
            let moved: Vec<f64> = network.offsets.iter().zip(&input.shifts).map(|(o, shift)| o + shift).collect();
            scatter(n, columns, &moved)
        };
        let residual = |(a, b, f): (usize, usize, &f64)| {
            let length = f - best.pseudorange(a, b);
            (rows[a], columns[b], Residual { length, inlier: inlier(&self.measured, best, a, b) })
        };
        let residuals = Cells::new(m, n, self.measured.cells().iter().map(residual));
        let rms = |measured: &Pseudoranges, network: &Network<D>| -> f64 {
            let cells = measured.cells().iter().filter(|&(a, b, _)| inlier(measured, network, a, b));
            let squares: Vec<f64> = cells.map(|(a, b, f)| (f - network.pseudorange(a, b)).powi(2)).collect();
            (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
        };
        let best_cost = self.ranked[0].objective;
        let others = self.ranked[1..].iter().map(|other| (&other.network, other.objective - best_cost, Reason::Found));
        let mut others: Vec<(&Network<D>, f64, Reason<D>)> =
            others.chain(apart.iter().map(|other| (&other.network, other.loss, other.reason))).collect();
        others.retain(|(_, loss, _)| *loss <= options.alternative_margin);
        others.retain(|&(other, _, reason)| reason != Reason::Found || !differs_in_sides(best, other, &mirrored));
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        let alternatives: Vec<Alternative<D>> = others
            .iter()
            .filter_map(|&(other, loss, reason)| {
                let error = if let Reason::Error(fault) = reason { Some(fault) } else { None };
                let network = if is_held {
                    other.clone()
                } else {
                    align(&other.receivers, &best.receivers, false)?.transform.apply_network(other)
                };
                Some(Alternative {
                    receivers: spread_rows(&network.receivers),
                    transmitters: spread_columns(&network.transmitters),
                    offsets: offsets(&network),
                    residual: match error {
                        Some(error) => rms(&without_errors(&self.measured, &[error]), &network),
                        None => rms(&self.measured, &network),
                    },
                    log_likelihood_loss: loss,
                    receiver_error: error.map(|error| self.receiver_error(&error, true)),
                })
            })
            .collect();
        let receivers_agree = apart.is_empty() && others.iter().all(|(other, ..)| same_receivers(other, best));
        let transmitters_agree = apart.is_empty() && others.iter().all(|(other, ..)| same_transmitters(other, best));
        warnings.extend(apart.iter().filter_map(|other| self.doubt(other)));
        let plain = others.iter().filter(|(.., reason)| *reason == Reason::Found).count();
        if plain > 0 {
            warnings.push(format!(
                "{} {} the measurements about as well (see alternatives){}; add receivers or transmitters, or give --sigma if \
                 the noise is known",
                counted(plain, "other network"),
                one_or(plain, "explains", "explain"),
                if receivers_agree { ", with the same receivers and other transmitters" } else { "" },
            ));
        }
        let size = best.size();
        let placed = uncertainty.receivers.iter().all(|c| trace(c).max(0.0).sqrt() <= size);
        let agreeing = self.ranked[0].starts;
        self.warn_of_receivers(&mut warnings);
        let settled = match &self.weak {
            Some(weak) => weak.is_empty(),
            None => agreeing >= options.agreeing.min(options.max_starts).min(SETTLED),
        };
        if let Some(weak) = self.weak.as_ref().filter(|_| !settled) {
            let names: Vec<String> = weak.iter().map(|&i| self.measured.receiver_names()[i].clone()).collect();
            warnings.push(format!(
                "{agreeing} of {} of neighbours {} the whole, but none that overlaps with others places {}; measure \
                 transmitters that these receivers and at least {} of their neighbours hear",
                counted(self.starts, "small network"),
                one_or(agreeing, "fits", "fit"),
                list(&names),
                overlap::<D>()
            ));
        } else if !settled {
            warnings.push(format!(
                "only {} of {} starts of the search ended in this network, so that a better one may have been missed; give --sigma, \
                 remove measurements that are known to be wrong, or raise --max-starts",
                agreeing, self.starts
            ));
        }
        let as_given = self.known.is_none_or(|sigma| !too_large(estimated / sigma, redundancy));
        let as_likely = as_given && one_sided.as_ref().is_none_or(|information| information.fits(redundancy));
        if let Some(information) = one_sided.as_ref().filter(|information| !information.fits(redundancy)) {
            warnings.push(format!(
                "which measurements are late cannot be told for sure: {:.0} % seem late or wrong, and {redundancy} of the others are left over \
                 where {LEAST_REDUNDANCY} would do; measure more, or remove measurements that are known to be wrong",
                100.0 * (information.mixture.share + information.mixture.gross)
            ));
        }
        let sure = settled
            && as_likely
            && fits
            && placed
            && determined
            && self.contradiction.is_none()
            && self.left.is_empty();
        let of_kind = |kind: NodeKind| mirrored.iter().filter(|image| image.kind == kind).count();
        let transmitters: Vec<_> = uncertainty.transmitters.iter().map(|c| c.map(|c| c.rows)).collect();
        let offset_std: Vec<_> = uncertainty.transmitters.iter().map(|c| c.map(|c| c.corner.max(0.0).sqrt())).collect();
        let mut calibration = Calibration {
            configuration: input.table.configuration(),
            receiver_names: input.table.receiver_names().to_vec(),
            transmitter_names: input.table.transmitter_names().to_vec(),
            receivers: spread_rows(&best.receivers),
            transmitters: spread_columns(&best.transmitters),
            offsets: offsets(best),
            residuals: Residuals(residuals),
            sigma,
            sigma_estimated: self.known.is_none(),
            sigma_is_factor: input.table.has_sigmas(),
            residual_rms: rms(&self.measured, best),
            redundancy,
            ellipse_radius,
            receiver_std: Vec::new(),
            receiver_covariance: scatter(m, rows, &uncertainty.receivers),
            transmitter_std: Vec::new(),
            transmitter_covariance: scatter(n, columns, &transmitters).into_iter().map(Option::flatten).collect(),
            offset_std: scatter(n, columns, &offset_std).into_iter().map(Option::flatten).collect(),
            anchored: scatter(m, rows, held).into_iter().map(|held| held == Some(true)).collect(),
            speed: self.speed,
            gauge: Cow::Borrowed(match (is_held, self.speed.is_some()) {
                _ if !self.observations.pins().is_empty() => {
                    "relative to the frame of the known positions, with the errors that these have"
                }
                (false, _) => "inner constraint over the receivers: relative to their best rigid alignment",
                (true, false) => "relative to the receivers of known position, which have no error",
                (true, true) => {
                    "relative to the receivers of known position, which have no error, at the estimated propagation speed"
                }
            }),
            unique: alternatives.is_empty() && mirrored.is_empty() && sure,
            unique_receivers: receivers_agree && of_kind(NodeKind::Receivers) == 0 && sure,
            unique_transmitters: transmitters_agree && 10 * of_kind(NodeKind::Transmitters) <= columns.len() && sure,
            alternatives,
            mirror_images: mirrored.iter().map(|image| self.mirror_image(image)).collect(),
            dimensions: D,
            fits,
            planar: fits && D == 2,
            dimension_test: None,
            determined,
            anchors_agree,
            receiver_errors: self.receiver_errors(),
            systematic: None,
            warnings,
            seed: options.seed,
            starts: self.starts,
            laid_together: self.weak.is_some(),
            agreeing,
            confidence: 1.0 - 0.95f64.powi(self.starts.min(100_000) as i32),
            truth: None,
        };
        for i in &uncertainty.loose {
            calibration.receiver_covariance[rows[*i]] = None;
        }
        for &i in doubtful.iter().filter(|&&i| !held[i]) {
            calibration.receivers[rows[i]] = None;
            calibration.receiver_covariance[rows[i]] = None;
        }
        // Residuals that may be late do not have the covariance that systematic errors are told by.
        if noise_known && one_sided.is_none() {
            calibration.systematic = self.systematic(input, &kept, &calibration)?;
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
        Ok(calibration)
    }

    fn mirror_image(&self, image: &Mirrored<D>) -> MirrorImage<D> {
        let names = match image.kind {
            NodeKind::Receivers => self.measured.receiver_names(),
            NodeKind::Transmitters => self.measured.transmitter_names(),
        };
        MirrorImage {
            node: names[image.index].clone(),
            kind: image.kind,
            position: image.position,
            distance_from_plane: image.height,
            log_likelihood_loss: image.loss,
        }
    }

    /// Whether rows have the offsets of transmitters, and the network that was found leaves residuals
    /// beyond a hundredth of its size.
    fn seems_transposed(&self, input: &Input<'_>, estimated: f64) -> bool {
        let misfit = estimated * typical_deviation(&self.measured);
        self.options.receiver_delays != ReceiverDelays::All
            && misfit > 0.01 * self.ranked[0].network.size()
            && looks_transposed(&input.table.select(&input.usable.receivers, &input.usable.transmitters))
    }

    /// Whether the measurements fit a network in the plane, or in space.
    fn fits(&self, estimated: f64, redundancy: usize, warnings: &mut Vec<String>) -> bool {
        // In metres also where measurements carry their own deviations.
        let metre = self.speed.map_or(1.0, |speed| speed.factor);
        let misfit = metre * estimated * typical_deviation(&self.measured);
        let size = metre * self.ranked[0].network.size();
        if let Some(sigma) = self.known
            && too_large(estimated / sigma, redundancy)
        {
            warnings.push(format!(
                "the residuals are {:.1} times as large as the given standard deviation, and standard deviations of the nodes are too small by \
                 that factor: give a larger --sigma, or none; or {}the measurements have errors beside noise",
                estimated / sigma,
                if D == 2 { "the network is not planar, or " } else { "" }
            ));
        }
        if misfit > self.options.planar_limit * size {
            warnings.push(format!(
                "the measurements do not fit a network {}: the residuals' deviation is {}, {:.1} % of \
                 the network's size {}; {}at most about a \
                 third of the measurements may be wrong",
                space(D),
                length(misfit),
                100.0 * misfit / size,
                length(size),
                if D == 2 { "receivers and transmitters must lie in one plane, and " } else { "" }
            ));
            return false;
        }
        true
    }
}

/// Residuals that are larger than the given deviation by less than this factor pass without a word.
const TOO_LARGE: f64 = 1.5;

fn too_large(ratio: f64, redundancy: usize) -> bool {
    ratio > TOO_LARGE && exceeds_chance(ratio, redundancy)
}

/// Whether residuals of normal noise with `redundancy` left over are this many times as large as
/// their deviation by a chance below one in a thousand: the square has the distribution of
/// chi-squared over its degrees of freedom, whose cube root is nearly normal (Wilson and Hilferty
/// 1931).
fn exceeds_chance(ratio: f64, redundancy: usize) -> bool {
    let variance = 2.0 / (9.0 * redundancy as f64);
    redundancy > 0 && (ratio * ratio).cbrt() > 1.0 - variance + 3.09 * variance.sqrt()
}

/// Efficiency of the last refinement's Cauchy loss on normal noise.
const EFFICIENCY: f64 = 0.95;

/// Radius of the 95 % ellipse, in space of the ellipsoid, in standard deviations. With the deviation
/// known its square is the 95 % quantile of chi-squared with D degrees of freedom, in the plane -2 ln
/// 0.05; with one estimated from k residuals left over it is D times that of F(D, k), in the plane k
/// (0.05^(-2/k) - 1).
fn radius_95<const D: usize>(redundancy: usize, known: bool) -> Option<f64> {
    let k = redundancy as f64;
    if !known && redundancy == 0 {
        return None;
    }
    let square = match (D, known) {
        (2, true) => -2.0 * 0.05f64.ln(),
        (2, false) => k * (0.05f64.powf(-2.0 / k) - 1.0),
        (_, true) => ChiSquared::new(D as f64).ok()?.inverse_cdf(0.95),
        (_, false) => D as f64 * FisherSnedecor::new(D as f64, k).ok()?.inverse_cdf(0.95),
    };
    Some(square.sqrt())
}

/// Values at these indices of a longer list.
fn scatter<T: Copy>(length: usize, at: &[usize], values: &[T]) -> Vec<Option<T>> {
    let mut all = vec![None; length];
    for (&k, &value) in at.iter().zip(values) {
        all[k] = Some(value);
    }
    all
}

/// First receiver at the origin, second on the x axis, third above it, in space the fourth above the
/// plane of these; other receivers take their place where these coincide or are in line.
fn default_frame<const D: usize>(receivers: &[[f64; D]]) -> Transform<D> {
    first_axes(receivers).and_then(|axes| frame(receivers[0], axes)).unwrap_or(Transform::IDENTITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_ends_where_tables_of_chi_squared_end() {
        // 99.9 % quantiles of chi-squared: 10.83, 29.59 and 149.45 with 1, 10 and 100 degrees of
        // freedom; the approximation is good to 2 %.
        for (degrees, quantile) in [(1usize, 10.83f64), (10, 29.59), (100, 149.45)] {
            let ratio = (quantile / degrees as f64).sqrt();
            assert!(exceeds_chance(1.02 * ratio, degrees) && !exceeds_chance(0.98 * ratio, degrees), "{degrees}");
        }
        assert!(!exceeds_chance(100.0, 0));
    }

    #[test]
    fn radius_of_ellipses() {
        // Tables: the 95 % quantile of chi-squared with 2 degrees of freedom is 5.991; of F(2, 1)
        // 199.5, F(2, 10) 4.103.
        let radius_95 = radius_95::<2>;
        assert!((radius_95(7, true).unwrap().powi(2) - 5.991).abs() < 1e-3);
        assert!((radius_95(1, false).unwrap().powi(2) - 2.0 * 199.5).abs() < 0.1);
        assert!((radius_95(10, false).unwrap().powi(2) - 2.0 * 4.103).abs() < 1e-3);
        assert!((radius_95(1_000_000, false).unwrap().powi(2) - 5.991).abs() < 1e-3);
        assert_eq!(radius_95(0, false), None);
        // In space: 7.815 with 3 degrees of freedom; of F(3, 1) 215.7, F(3, 10) 3.708.
        let radius_95 = super::radius_95::<3>;
        assert!((radius_95(7, true).unwrap().powi(2) - 7.815).abs() < 1e-3);
        assert!((radius_95(1, false).unwrap().powi(2) - 3.0 * 215.7).abs() < 0.2);
        assert!((radius_95(10, false).unwrap().powi(2) - 3.0 * 3.708).abs() < 2e-3);
        assert!((radius_95(1_000_000, false).unwrap().powi(2) - 7.815).abs() < 1e-3);
        assert_eq!(radius_95(0, false), None);
    }
}
