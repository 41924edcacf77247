//! The last refinement of a nearly flat network in space: heights that the measurements hardly tell are near the
//! plane of the nodes.

use crate::calibrate::judge::dimension_test::{DimensionTest, PlaneDistances};
use crate::calibrate::judge::neighbours::{Neighbour, Reason, each_once};
use crate::calibrate::options::{CalibrateError, Errors};
use crate::calibrate::state::State;
use crate::flatness::levelled;
use crate::refine::Heights;

/// Share of the heights that the measurements tell, above which they need no expectation.
const TOLD: f64 = 0.95;

/// Deviation of the heights of the flatter kind of nodes as a share of the receivers' spread, above which no plane is
/// worth an expectation.
const NEARLY_FLAT: f64 = 0.25;

/// Heights that a plane and its tilt take up.
const PLANE: f64 = 3.0;

impl<const D: usize> State<'_, D> {
    /// Refines with heights that are expected to be near the plane of the nodes, where the measurements do not tell
    /// nearly all of them.
    pub(crate) fn level(&mut self) -> Result<(), CalibrateError<D>> {
        let State { options, known, .. } = *self;
        if D != 3 || self.anchors.is_some() || self.has_clocks_of_receivers() || options.errors == Errors::OneSided {
            return Ok(());
        }
        let (modes, of_plane) = self.height_modes()?;
        let Some((_, heights)) = modes.first() else { return Ok(()) };
        let of_heights = modes.iter().map(|(evidence, _)| *evidence).fold(f64::NEG_INFINITY, f64::max);
        let [change, in_deviations] = heights.change(&self.observations);
        let evidence = Some(of_heights - of_plane).filter(|evidence| evidence.is_finite());
        self.dimension_test = DimensionTest { evidence, change: Some(in_deviations), ..DimensionTest::default() };
        let nodes = heights.network.receivers.len() + heights.network.transmitters.len();
        // What is told without the expectation of two levels.
        let told = self.on_one_level(heights)?.map_or(heights.told, |plain| plain.told);
        if told >= TOLD * (nodes as f64 - PLANE) || heights.flatness() > NEARLY_FLAT {
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
        let pinned = self.observations.clone().pinned(&heights.pins()).levelled(heights.levels());
        self.observations = pinned.with_other_unknowns(told);
        self.plane_distances = Some(PlaneDistances {
            receivers: heights.distance_from_plane(),
            transmitters: heights.transmitters.hypot(heights.between),
            levels: (heights.apart != 0.0).then(|| 2.0 * heights.apart.abs()),
            change,
        });
        self.finish(known.unwrap_or(heights.deviation))
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
