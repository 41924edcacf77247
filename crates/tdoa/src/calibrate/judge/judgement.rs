//! What can be said of the best network: its noise and uncertainty, whether it fits, and whether it is the
//! only one.

use crate::align::align;
use crate::calibrate::input::selection::Input;
use crate::calibrate::judge::far_transmitters::{Far, drawn_in, far_transmitters, within_reach};
use crate::calibrate::judge::lines_and_planes::turning;
use crate::calibrate::judge::mirror_images::{Mirrored, Sides, differs_in_sides};
use crate::calibrate::judge::neighbours::{BEYOND, Neighbour, Reason, widen};
use crate::calibrate::judge::orientation::looks_transposed;
use crate::calibrate::judge::raised::may_be_raised;
use crate::calibrate::judge::weak_nodes::{WeakNodes, doubtful_receivers};
use crate::calibrate::options::{CalibrateError, Errors};
use crate::calibrate::search::deviation::{inlier_deviation, typical_deviation};
use crate::calibrate::search::one_sided::Information;
use crate::calibrate::search::same_network::{same, same_receivers, same_transmitters};
use crate::calibrate::search::starts::SETTLED;
use crate::calibrate::state::State;
use crate::minimal::NodeKind;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::trace;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{Covariance, covariance};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Share of measurements that are outliers, above which a network of which the search is not sure does not fit. Of
/// 10r/20s and 10r/30s in space with three tenths late and the deviation given, three networks that fitted and were 0.6 to
/// 1.4 m off left out 31 to 33 %; nine within 0.1 m at most 29 %.
const MOST_OUTLIERS: f64 = 0.3;

/// Receivers of another network that are farther from those of the best one than this share of its size, root mean square,
/// are elsewhere.
const ELSEWHERE: f64 = 0.1;

/// Logarithm of the ratio of likelihoods up to which other heights may be the true ones: odds of a hundred.
const AS_LIKELY: f64 = 2.0 * std::f64::consts::LN_10;

/// What has been decided about the best network of a state.
pub(crate) struct Judged<'s, const D: usize> {
    /// Where errors are one-sided, what the measurements say.
    pub(crate) one_sided: Option<Information<D>>,
    /// Deviation of the measurements: the given one, or that of the residuals.
    pub(crate) sigma: f64,
    /// Deviation of the residuals.
    pub(crate) estimated: f64,
    /// The measurements that are no outliers.
    pub(crate) kept: Observations<D>,
    /// These less the unknowns.
    pub(crate) redundancy: usize,
    /// Radius of 95 % ellipses in standard deviations, if the noise is known.
    pub(crate) ellipse_radius: Option<f64>,
    pub(crate) uncertainty: Covariance<D>,
    /// Whether the residuals are as large as the given deviation has them.
    pub(crate) as_given: bool,
    /// Whether the measurements fit a network in the plane, or in space.
    pub(crate) fits: bool,
    /// Whether they do not for too many outliers, in a network of which the search is not sure.
    pub(crate) overrun: bool,
    /// Whether the rows of the table seem to be transmitters.
    pub(crate) transposed: bool,
    /// Receivers that have no place, since their inliers may agree by chance.
    pub(crate) doubtful: Vec<usize>,
    pub(crate) weak: WeakNodes,
    /// Whether transmitters may be raised, where heights are told by what is expected of them.
    pub(crate) raised: bool,
    /// How far the receivers of networks with other heights that are about as likely lie elsewhere, metres, where heights
    /// are told by what is expected of them.
    pub(crate) other_heights: Option<f64>,
    /// Transmitters of which the direction alone is told.
    pub(crate) far: Vec<Far<D>>,
    /// Kinds of nodes that lie in one line of space, about which the others may turn.
    pub(crate) turning: Vec<NodeKind>,
    pub(crate) mirrored: Vec<Mirrored<D>>,
    /// Whether more other networks fit about as well than starts ended in the best one.
    pub(crate) scattered: bool,
    /// Whether the measurements determine where most receivers are.
    pub(crate) determined: bool,
    pub(crate) anchors_agree: bool,
    /// Likely neighbours beyond what the ellipses hold.
    pub(crate) apart: Vec<&'s Neighbour<D>>,
    /// Networks that explain the measurements about as well, best first, in the frame of the best one; none that differs in
    /// the distances of far transmitters alone.
    pub(crate) others: Vec<Other<D>>,
    pub(crate) receivers_agree: bool,
    transmitters_agree: bool,
    /// Starts of the search that ended in the best network.
    pub(crate) agreeing: usize,
    /// Whether enough of the search did.
    pub(crate) settled: bool,
    sure: bool,
}

/// A network that explains the measurements about as well as the best one.
pub(crate) struct Other<const D: usize> {
    pub(crate) network: Network<D>,
    /// How much less likely the measurements are (natural logarithm).
    pub(crate) loss: f64,
    pub(crate) reason: Reason<D>,
}

impl<const D: usize> Judged<'_, D> {
    /// Whether no other network explains the measurements, nor other distances of far transmitters.
    pub(crate) fn is_unique(&self) -> bool {
        self.others.is_empty() && self.mirrored.is_empty() && self.far.is_empty() && self.sure
    }

    /// Whether other networks have the receivers in the same places.
    pub(crate) fn are_receivers_unique(&self) -> bool {
        self.receivers_agree && self.images(NodeKind::Receivers) == 0 && self.sure
    }

    /// Whether other networks have nearly all transmitters in the same places.
    pub(crate) fn are_transmitters_unique(&self) -> bool {
        let open = self.images(NodeKind::Transmitters) + self.far.len();
        self.transmitters_agree && 10 * open <= self.kept.transmitters && self.sure
    }

    fn images(&self, kind: NodeKind) -> usize {
        self.mirrored.iter().filter(|image| image.kind == kind).count()
    }
}

impl<const D: usize> State<'_, D> {
    /// Judges the best network.
    ///
    /// # Errors
    /// Cancelled.
    pub(crate) fn judge(&self, input: &Input<'_>) -> Result<Judged<'_, D>, CalibrateError<D>> {
        let State { options, monitor, ref measured, ref observations, .. } = *self;
        let best = &self.ranked[0].network;
        let one_sided = (options.errors == Errors::OneSided)
            .then(|| Information::new(observations, best, self.deviation, self.known, monitor))
            .transpose()?;
        let estimated = match &one_sided {
            // Measurements that are late by little would count as noise.
            Some(information) => information.mixture.deviation,
            None => inlier_deviation(observations, best, self.deviation, options.inlier_threshold),
        };
        let sigma = self.known.unwrap_or(estimated);
        let kept = Observations::new(measured, |i, j| self.is_inlier(measured, best, sigma, i, j))
            .holding(observations.held())
            .pinned_like(observations)
            .with_other_unknowns(observations.other_unknowns())
            .at_deviation(sigma);
        let redundancy = kept.len().saturating_sub(kept.unknowns());
        let ellipse_radius = radius_95::<D>(redundancy, self.known.is_some());
        let mut uncertainty = match (ellipse_radius, &one_sided) {
            (None, _) => Covariance::default(),
            (_, Some(information)) => self.covariance(&information.trusted, sigma)?,
            // What the robust loss loses against least squares on normal noise is added.
            (_, None) => self.covariance(&kept, sigma / EFFICIENCY.sqrt())?,
        };
        let far = self.far_transmitters(&kept, &uncertainty, sigma)?;
        let mut apart: Vec<&Neighbour<D>> = Vec::new();
        if let Some(radius) = ellipse_radius {
            let likely = self.neighbours.iter().filter(|n| n.loss <= options.alternative_margin);
            apart.extend(likely.filter(|n| n.distance(&uncertainty) >= BEYOND));
            widen(&mut uncertainty, &self.neighbours, radius);
        }
        // In metres also where measurements carry their own deviations.
        let misfit = estimated * typical_deviation(measured);
        // Residuals that are as large as the given deviation has them fit, whatever their share of the size.
        let expected = self.known.is_some_and(|sigma| estimated <= TOO_LARGE * sigma);
        let beyond = !expected && misfit > options.planar_limit * best.size();
        let band = 2.0 * options.inlier_threshold * sigma * typical_deviation(measured);
        let doubtful = doubtful_receivers(measured, &kept, band / best.size());
        // Offsets of transmitters in the rows count where residuals are beyond a hundredth of the network's size.
        // Of distances, rows and columns say the same, and recorders have offsets that are as good.
        let transposed = measured.unknown_clocks().is_none()
            && !measured.are_ranges()
            && misfit > 0.01 * best.size()
            && looks_transposed(&input.table.select(&input.usable.receivers, &input.usable.transmitters));
        // On which side of a plane a node is, its expected height must not tell.
        let free = |all: &Observations<D>| {
            if self.plane_distances.is_some() { all.clone().pinned(&[]) } else { all.clone() }
        };
        let sides = Sides {
            observations: &free(observations),
            kept: &free(&kept),
            network: best,
            deviation: sigma,
            uncertainty: &uncertainty,
            margin: options.alternative_margin,
        };
        let mut mirrored = sides.mirror_images(monitor)?;
        let placeless = |i: &usize| doubtful.contains(i) || uncertainty.loose.contains(i);
        mirrored.retain(|image| image.kind == NodeKind::Transmitters || !placeless(&image.index));
        let turning = turning(best, &uncertainty);
        let weak = WeakNodes::new(best, &uncertainty, &far);
        // Where heights are told by what is expected of them, the network lies about the plane z = 0.
        let raised = self.plane_distances.is_some() && !self.is_held() && !uncertainty.receivers.is_empty() && {
            let variance = uncertainty.receivers.iter().map(trace).sum::<f64>() / uncertainty.receivers.len() as f64;
            may_be_raised(best, variance.max(0.0).sqrt())
        };
        let (others, agreeing) = self.others(&apart, &mirrored, &far);
        let off = |other: &Other<D>| {
            let apart = align(&other.network.receivers, &best.receivers, false).map_or(0.0, |found| found.rms);
            Some(apart).filter(|apart| other.reason == Reason::Found && *apart > ELSEWHERE * best.size())
        };
        let scattered = self.weak.is_none()
            && agreeing < SETTLED.min(options.search.max_starts)
            && others.iter().filter(|other| off(other).is_some()).count() > agreeing;
        let as_likely = others.iter().filter(|other| self.plane_distances.is_some() && other.loss <= AS_LIKELY);
        let other_heights = as_likely.filter_map(off).reduce(f64::max);
        let open = ellipse_radius.is_some() && weak.are_most()
            || !turning.is_empty()
            || scattered
            || raised
            || other_heights.is_some();
        let determined = !open && !transposed && 2 * doubtful.len() < best.receivers.len();
        let receivers_agree = apart.is_empty() && others.iter().all(|other| same_receivers(&other.network, best));
        let transmitters_agree = apart.is_empty() && others.iter().all(|other| same_transmitters(&other.network, best));
        let placed = uncertainty.receivers.iter().all(|c| trace(c).max(0.0).sqrt() <= best.size());
        let settled = match &self.weak {
            Some(weak) => weak.is_empty(),
            None => agreeing >= options.search.agreeing.min(options.search.max_starts).min(SETTLED),
        };
        let overrun =
            one_sided.is_none() && !settled && (kept.len() as f64) < (1.0 - MOST_OUTLIERS) * observations.len() as f64;
        let as_given = self.known.is_none_or(|sigma| !too_large(estimated / sigma, redundancy));
        let as_likely = as_given && one_sided.as_ref().is_none_or(|information| information.fits(redundancy));
        Ok(Judged {
            sure: settled
                && as_likely
                && !beyond
                && !overrun
                && placed
                && determined
                && self.contradiction.is_none()
                && !self.distances_contradict()
                && self.left.is_empty()
                && self.doubts_choice.is_none()
                && !self.has_two_places(),
            anchors_agree: self.contradiction.is_none_or(|off| off <= options.planar_limit * best.size()),
            one_sided,
            sigma,
            estimated,
            kept,
            redundancy,
            ellipse_radius,
            uncertainty,
            as_given,
            fits: !beyond && !overrun,
            overrun,
            transposed,
            doubtful,
            weak,
            raised,
            other_heights,
            far,
            turning,
            mirrored,
            scattered,
            determined,
            apart,
            others,
            receivers_agree,
            transmitters_agree,
            agreeing,
            settled,
        })
    }

    /// Far transmitters of the best network.
    fn far_transmitters(
        &self,
        kept: &Observations<D>,
        uncertainty: &Covariance<D>,
        sigma: f64,
    ) -> Result<Vec<Far<D>>, CalibrateError<D>> {
        let best = &self.ranked[0].network;
        // Where a distance is beyond all bounds, arithmetic has no covariance for it.
        let Some(near) = within_reach(best).filter(|_| !uncertainty.receivers.is_empty()) else {
            return Ok(far_transmitters(best, uncertainty));
        };
        let uncertainty = covariance(kept, &near, sigma / EFFICIENCY.sqrt(), self.monitor)?;
        Ok(uncertainty.map_or_else(Vec::new, |uncertainty| far_transmitters(&near, &uncertainty)))
    }

    /// Networks that explain the measurements about as well as the best one and differ in more than the sides
    /// of single nodes and the distances of far ones, best first; and how many starts ended in the best one, distances of
    /// far ones aside.
    fn others(&self, apart: &[&Neighbour<D>], mirrored: &[Mirrored<D>], far: &[Far<D>]) -> (Vec<Other<D>>, usize) {
        let best = &self.ranked[0].network;
        let cost = self.ranked[0].objective;
        let found = self.ranked[1..].iter().map(|other| (&other.network, other.objective - cost, Reason::Found));
        let mut others: Vec<(&Network<D>, f64, Reason<D>)> =
            found.chain(apart.iter().map(|other| (&other.network, other.loss, other.reason))).collect();
        others.retain(|(_, loss, _)| *loss <= self.options.alternative_margin);
        others.retain(|&(other, _, reason)| reason != Reason::Found || !differs_in_sides(best, other, mirrored));
        let mut agreeing = self.ranked[0].starts;
        if !far.is_empty() {
            let near = drawn_in(best, far);
            let is_best = |other: &Network<D>| same(&near, &drawn_in(other, far));
            others.retain(|&(other, _, reason)| reason != Reason::Found || !is_best(other));
            let alike = self.ranked[1..].iter().filter(|other| is_best(&other.network));
            agreeing += alike.map(|other| other.starts).sum::<usize>();
        }
        // A start may count for two networks that are nearly one, and become one later.
        let agreeing = agreeing.min(self.starts);
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        let framed = |(other, loss, reason): (&Network<D>, f64, Reason<D>)| {
            let network = if self.is_held() {
                other.clone()
            } else {
                align(&other.receivers, &best.receivers, false)?.transform.apply_network(other)
            };
            Some(Other { network, loss, reason })
        };
        (others.into_iter().filter_map(framed).collect(), agreeing)
    }

    /// Whether known positions fix the frame.
    pub(crate) fn is_held(&self) -> bool {
        !self.observations.leave_rigid_motions()
    }

    /// Whether a measurement agrees with a network, if its deviation is a share of `sigma`.
    pub(crate) fn is_inlier(
        &self,
        measured: &Pseudoranges,
        network: &Network<D>,
        sigma: f64,
        i: usize,
        j: usize,
    ) -> bool {
        let residual = network.residual(measured, i, j);
        let deviation = sigma * self.measured.sigma(i, j).unwrap_or(1.0);
        residual.is_some_and(|e| e.abs() <= self.options.inlier_threshold * deviation)
    }

    /// Metres of one metre before the propagation speed was estimated.
    pub(crate) fn metre(&self) -> f64 {
        self.speed.map_or(1.0, |speed| speed.factor)
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
    fn residuals_as_large_as_they_are_said_to_be_fit() {
        use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};
        // A deviation of 0.4 m is a tenth of the network's size.
        let made = SimulateOptions { receivers: 10, transmitters: 30, noise: 0.4, seed: 3, ..Default::default() };
        let made = simulate(&made).unwrap();
        let fits =
            |sigma| calibrate(&made.pseudoranges, &CalibrateOptions { sigma, ..Default::default() }).unwrap().fits;
        assert_eq!([fits(None), fits(Some(0.4)), fits(Some(0.1))], [false, true, false]);
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
