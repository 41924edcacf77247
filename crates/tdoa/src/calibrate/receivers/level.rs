//! The last refinement of a nearly flat network in space: heights that the measurements hardly tell are near the
//! plane of the nodes.

use crate::calibrate::judge::dimension_test::{DimensionTest, PlaneDistances};
use crate::calibrate::judge::neighbours::{Neighbour, Reason, each_once};
use crate::calibrate::options::{CalibrateError, Errors};
use crate::calibrate::receivers::height_modes::Mode;
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
    /// Whether heights follow from the measurements alone.
    pub(crate) fn has_heights_of_its_own(&self) -> bool {
        let is_one_sided = self.options.errors == Errors::OneSided;
        D == 3 && self.anchors.is_none() && !self.has_clocks_of_receivers() && !is_one_sided
    }

    /// Refines with heights that are expected to be near the plane of the nodes, where the measurements do not tell
    /// nearly all of them.
    pub(crate) fn level(&mut self) -> Result<(), CalibrateError<D>> {
        if !self.has_heights_of_its_own() {
            return Ok(());
        }
        let (known, modes) = (self.known, self.height_modes()?);
        let Some((heights, test)) = self.likeliest_heights(&modes) else { return Ok(()) };
        self.dimension_test = test;
        let nodes = heights.network.receivers.len() + heights.network.transmitters.len();
        // What is told without the expectation of two levels.
        let told = self.on_one_level(heights)?.map_or(heights.told, |plain| plain.told);
        if told >= TOLD * (nodes as f64 - PLANE) || heights.flatness() > NEARLY_FLAT {
            return Ok(());
        }
        self.neighbours.extend(neighbours_of_the_first(&modes.0));
        let [change, _] = heights.change(&self.observations);
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

    /// The likeliest heights, and what they say of a third coordinate.
    pub(crate) fn likeliest_heights<'m>(
        &self,
        (modes, of_plane): &'m (Vec<Mode<D>>, f64),
    ) -> Option<(&'m Heights<D>, DimensionTest)> {
        let (_, heights) = modes.first()?;
        let of_heights = modes.iter().map(|(evidence, _)| *evidence).fold(f64::NEG_INFINITY, f64::max);
        let evidence = Some(of_heights - of_plane).filter(|evidence| evidence.is_finite());
        let [_, change] = heights.change(&self.observations);
        Some((heights, DimensionTest { evidence, change: Some(change), ..DimensionTest::default() }))
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
