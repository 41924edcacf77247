//! Of many nodes a part tells which start leads to the likeliest heights, and about how high these are.

use crate::calibrate::receivers::height_modes::each;
use crate::calibrate::search::dense::search_part;
use crate::calibrate::state::State;
use crate::degeneracy::Usable;
use crate::network::Network;
use crate::observations::Observations;
use crate::refine::{Cancelled, Heights, has_many};

/// The measurements that fit a network, and one with level planes from which heights are looked for.
pub(super) type Start<const D: usize> = (Observations<D>, Network<D>);

impl<const D: usize> State<'_, D> {
    /// The start that leads to the likeliest heights in a part of the nodes, as high as these are; all starts of fewer
    /// measurements, or where the part does not tell.
    pub(super) fn likeliest_start(&self, mut starts: Vec<Start<D>>) -> Result<Vec<Start<D>>, Cancelled> {
        let State { measured, observations, options, .. } = self;
        let (m, n) = (measured.receivers(), measured.transmitters());
        let part = search_part(measured, options);
        let is_part = part.receivers.len() < m || part.transmitters.len() < n;
        if !is_part || !has_many(observations) || observations.receivers != m || !observations.pins().is_empty() {
            return Ok(starts);
        }
        let among = Observations::new(&measured.select(&part.receivers, &part.transmitters), |_, _| true);
        let search = self.search_of_heights_among(&among);
        let found = each(&starts, |(kept, start)| {
            let is_kept = |i: usize, j: usize| kept.of_transmitter(j).iter().any(|o| o.receiver == i);
            let kept = among.subset(|o| is_kept(part.receivers[o.receiver], part.transmitters[o.transmitter]));
            if kept.len() <= kept.unknowns() { Ok(None) } else { search.with_plane(&kept, &selected(start, &part)) }
        })?;
        let modes = found.into_iter().enumerate().filter_map(|(k, found)| Some((k, found?.0?)));
        let best = modes.max_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b));
        let Some((k, (_, heights))) = best else { return Ok(starts) };
        let (kept, start) = starts.swap_remove(k);
        Ok(vec![(kept, as_high_as(&heights, start))])
    }
}

/// A part of a network.
fn selected<const D: usize>(network: &Network<D>, part: &Usable) -> Network<D> {
    let of = |all: &[[f64; D]], some: &[usize]| some.iter().map(|&k| all[k]).collect();
    let offsets = part.transmitters.iter().map(|&j| network.offsets[j]).collect();
    let (receivers, transmitters) = (&part.receivers, &part.transmitters);
    Network::new(of(&network.receivers, receivers), of(&network.transmitters, transmitters), offsets)
}

/// A network with level planes whose nodes are about as far above and below them as these are.
fn as_high_as<const D: usize>(heights: &Heights<D>, mut network: Network<D>) -> Network<D> {
    let (receivers, transmitters) = (&mut network.receivers, &mut network.transmitters);
    for (points, wanted) in [(receivers, heights.receivers), (transmitters, heights.transmitters)] {
        let count = points.len().max(1) as f64;
        let middle = points.iter().map(|p| p[D - 1]).sum::<f64>() / count;
        let spread = (points.iter().map(|p| (p[D - 1] - middle).powi(2)).sum::<f64>() / count).sqrt();
        if spread > 0.0 {
            points.iter_mut().for_each(|p| p[D - 1] = middle + (p[D - 1] - middle) * wanted / spread);
        }
    }
    network
}
