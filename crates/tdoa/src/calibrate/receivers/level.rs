//! The last refinement of a nearly flat network in space: heights that the measurements hardly tell are near the
//! plane of the nodes.

use crate::calibrate::judge::dimension_test::{DimensionTest, PlaneDistances};
use crate::calibrate::judge::neighbours::{Neighbour, Reason, each_once};
use crate::calibrate::options::{CalibrateError, Errors};
use crate::calibrate::state::State;
use crate::flatness::levelled;
use crate::network::Network;
use crate::observations::Observations;
use crate::refine::{Cancelled, Heights, RefinedNetwork};
#[cfg(feature = "threads")]
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

/// Share of the heights that the measurements tell, above which they need no expectation.
const TOLD: f64 = 0.95;

/// The deviation of measurements in the plane that is tried, as a multiple of the one in space: without heights, that which
/// they explain is noise.
const WIDER: [f64; 2] = [1.0, 5.0];

/// Networks of the search from which heights are looked for, the best first: receivers at two heights and transmitters
/// between them explain about what receivers at one height and transmitters above them do.
const MODES: usize = 3;

/// Standard deviation of a receiver's place as a share of the network's size, above which the measurements do not
/// determine the network.
const LOOSE: f64 = 0.3;

/// Deviation of the heights of the flatter kind of nodes as a share of the receivers' spread, above which no plane is
/// worth an expectation.
const NEARLY_FLAT: f64 = 0.25;

/// Logarithm of the ratio of marginal likelihoods up to which two networks are about as likely, for Laplace's
/// approximation.
const CLOSE: f64 = 5.0;

/// Heights that a plane and its tilt take up.
const PLANE: f64 = 3.0;

/// Heights with the logarithm of their marginal likelihood, if there is one, and that of the likeliest planar network.
type Mode<const D: usize> = (Option<(f64, Heights<D>)>, f64);

impl<const D: usize> State<'_, D> {
    /// Refines with heights that are expected to be near the plane of the nodes, where the measurements do not tell
    /// nearly all of them.
    pub(crate) fn level(&mut self) -> Result<(), CalibrateError<D>> {
        let State { options, known, .. } = *self;
        if D != 3 || self.anchors.is_some() || self.has_delays_of_all() || options.errors == Errors::OneSided {
            return Ok(());
        }
        let (modes, of_plane) = self.modes()?;
        let Some((_, heights)) = modes.first() else { return Ok(()) };
        let of_heights = modes.iter().map(|(evidence, _)| *evidence).fold(f64::NEG_INFINITY, f64::max);
        let [change, in_deviations] = heights.change(&self.observations);
        let evidence = Some(of_heights - of_plane).filter(|evidence| evidence.is_finite());
        self.dimension_test = DimensionTest { evidence, change: Some(in_deviations), ..DimensionTest::default() };
        let nodes = heights.network.receivers.len() + heights.network.transmitters.len();
        if heights.told >= TOLD * (nodes as f64 - PLANE) || heights.flatness() > NEARLY_FLAT {
            return Ok(());
        }
        self.neighbours.extend(neighbours_of_the_first(&modes));
        // Under the likeliest deviation alone the heights of few receivers would be too certain.
        let mut heights = heights.clone();
        heights.receivers =
            heights.likely_receivers(&self.observations, known, self.ranked[0].network.size(), self.monitor)?;
        for other in &mut self.ranked[1..] {
            if let Some(motion) = levelled(&other.network) {
                other.network = motion.apply_network(&other.network);
            }
        }
        self.ranked[0].network.clone_from(&heights.network);
        let told = self.observations.other_unknowns() + heights.told.round() as usize;
        self.observations = self.observations.clone().pinned(&heights.pins()).with_other_unknowns(told);
        self.plane_distances = Some(PlaneDistances {
            receivers: heights.receivers,
            transmitters: heights.transmitters.hypot(heights.between),
            change,
        });
        self.finish(known.unwrap_or(heights.deviation))
    }

    /// Heights near the best networks with the logarithms of their marginal likelihoods, the likeliest first, and that
    /// of the likeliest network without heights.
    fn modes(&self) -> Result<(Vec<(f64, Heights<D>)>, f64), CalibrateError<D>> {
        let State { options, monitor, known, deviation, ref observations, .. } = *self;
        let sigma = known.unwrap_or(deviation);
        let limit = options.inlier_threshold * sigma;
        let width = self.ranked[0].network.size();
        let starts = self.ranked.iter().take(MODES).filter_map(|RefinedNetwork { network, .. }| {
            let kept = observations.subset(|o| o.residual(network).abs() <= limit);
            let motion = levelled(network).filter(|_| kept.len() > kept.unknowns())?;
            let level = motion.apply_network(network);
            Some([(kept.clone(), one_sided(&level)), (kept, level)])
        });
        let starts: Vec<(Observations<D>, Network<D>)> = starts.flatten().collect();
        let mode = |(kept, start): &(Observations<D>, Network<D>)| -> Result<Option<Mode<D>>, Cancelled> {
            let found = Heights::of(kept, start, known, sigma, monitor)?;
            // Of networks that the measurements do not determine, likelihoods say little.
            let Some(heights) = found.filter(|heights| heights.loosest <= LOOSE * width) else { return Ok(None) };
            let evidence = heights.evidence(observations, known, width, monitor)?;
            let evidence = evidence.map(|evidence| evidence + heights.log_prior(width));
            let mut of_plane = f64::NEG_INFINITY;
            for factor in WIDER {
                let flat = heights.flat(observations, factor * heights.deviation, monitor)?;
                let plane = flat.evidence(observations, known, width, monitor)?;
                of_plane = of_plane.max(plane.unwrap_or(f64::NEG_INFINITY));
            }
            Ok(Some((evidence.map(|evidence| (evidence, heights)), of_plane)))
        };
        #[cfg(feature = "threads")]
        let found: Vec<Result<Option<Mode<D>>, Cancelled>> = starts.par_iter().map(mode).collect();
        #[cfg(not(feature = "threads"))]
        let found: Vec<Result<Option<Mode<D>>, Cancelled>> = starts.iter().map(mode).collect();
        let mut modes: Vec<(f64, Heights<D>)> = Vec::new();
        let mut of_plane = f64::NEG_INFINITY;
        for mode in found {
            let Some((heights, plane)) = mode? else { continue };
            modes.extend(heights);
            of_plane = of_plane.max(plane);
        }
        modes.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Of those that are about as likely the one that fits best.
        let close = modes.partition_point(|(evidence, _)| *evidence >= modes[0].0 - CLOSE);
        let misfit = |(_, heights): &(f64, Heights<D>)| -> f64 {
            observations.all().iter().map(|o| o.residual(&heights.network).abs().min(limit).powi(2)).sum()
        };
        if let Some(best) = (0..close).min_by(|&a, &b| misfit(&modes[a]).total_cmp(&misfit(&modes[b]))) {
            modes[..=best].rotate_right(1);
        }
        Ok((modes, of_plane))
    }
}

/// The other networks as neighbours of the first.
fn neighbours_of_the_first<const D: usize>(modes: &[(f64, Heights<D>)]) -> Vec<Neighbour<D>> {
    let [(of_first, first), others @ ..] = modes else { return Vec::new() };
    let near = others.iter().filter_map(|(evidence, other)| {
        let loss = (of_first - evidence).max(0.0);
        Neighbour::new(&other.network, loss, Reason::Found, &first.network)
    });
    each_once(near.collect(), &first.network)
}

/// The network with all nodes of one kind on one side of the plane of the other, where that is the flatter one: their
/// mirror images in it fit as well.
fn one_sided<const D: usize>(network: &Network<D>) -> Network<D> {
    let z = D - 1;
    let (receivers, transmitters) = (&network.receivers, &network.transmitters);
    let middle = transmitters.iter().map(|p| p[z]).sum::<f64>() / transmitters.len().max(1) as f64;
    let spread = |points: &[[f64; D]], about: f64| {
        points.iter().map(|p| (p[z] - about).powi(2)).sum::<f64>() / points.len().max(1) as f64
    };
    let mut folded = network.clone();
    if spread(receivers, 0.0) < spread(transmitters, middle) {
        folded.transmitters.iter_mut().for_each(|p| p[z] = p[z].abs());
    } else {
        folded.receivers.iter_mut().for_each(|p| p[z] = middle + (p[z] - middle).abs());
    }
    folded
}
