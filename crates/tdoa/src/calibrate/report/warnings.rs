//! What the report warns of, with names and a remedy.

use crate::calibrate::input::selection::Input;
use crate::calibrate::judge::far_transmitters::{Far, drawn_in};
use crate::calibrate::judge::judgement::Judged;
use crate::calibrate::judge::lines_and_planes::warn_of_sides;
use crate::calibrate::judge::neighbours::Reason;
use crate::calibrate::judge::raised::RAISED;
use crate::calibrate::judge::weak_nodes::mostly_wrong;
use crate::calibrate::search::deviation::typical_deviation;
use crate::calibrate::search::one_sided::LEAST_REDUNDANCY;
use crate::calibrate::search::submaps::overlap;
use crate::calibrate::state::State;
use crate::degeneracy::{list, of_transmitter, space};
use crate::network::Network;
use crate::points::distance;
use crate::pseudoranges::Pseudoranges;
use crate::quantity::{length, number};
use hc::poly::{counted, one_or};

impl<const D: usize> State<'_, D> {
    /// All that may be wrong with the best network.
    pub(crate) fn warnings(&self, input: &Input<'_>, judged: &Judged<'_, D>) -> Vec<String> {
        let best = &self.ranked[0].network;
        let mut warnings = Vec::new();
        if judged.transposed {
            warnings.push(
                "the offsets that transmitters should have are in the rows of the table, where receivers should be, and the network does \
                 not fit: transpose the table"
                    .to_string(),
            );
        }
        warnings.extend(input.usable.warnings.iter().chain(&self.warnings).cloned());
        if judged.ellipse_radius.is_none() {
            warnings.push(
                "there are only as many measurements as unknowns, so the noise cannot be estimated and no uncertainty is \
                 given; give --sigma"
                    .to_string(),
            );
        }
        self.warn_of_misfit(judged, &mut warnings);
        warnings.extend(self.warn_of_clocks(judged.fits));
        warnings.extend(self.warn_of_rates());
        warnings.extend(self.warn_of_distances());
        let Judged { uncertainty, turning, mirrored, far, .. } = judged;
        warn_of_sides(&self.measured, &drawn_in(best, far), uncertainty, turning, mirrored, &mut warnings);
        self.warn_of_far_transmitters(far, &mut warnings);
        warn_of_nodes(&self.measured, best, judged, &mut warnings);
        warnings.extend(judged.raised.then(|| RAISED.to_string()));
        warnings.extend(self.plane_distances.and_then(|distances| distances.levels).map(|apart| {
            format!(
                "receivers are taken to be at two heights, {} apart, since that makes the measurements likelier; give heights that are known \
                 (--anchors with z alone)",
                length(self.metre() * apart)
            )
        }));
        warnings.extend(judged.other_heights.map(|apart| {
            format!(
                "other heights are about as likely, with receivers that lie {} elsewhere (see alternatives): say how high some receivers are \
                 (--anchors with z alone will do), move some nodes farther from the plane of the others, or measure more",
                length(self.metre() * apart)
            )
        }));
        warnings.extend(judged.apart.iter().filter_map(|other| self.doubt(other)));
        let plain = judged.others.iter().filter(|other| other.reason == Reason::Found).count();
        if plain > 0 {
            warnings.push(format!(
                "{} {} the measurements about as well (see alternatives){}; add receivers or transmitters, or give --sigma if \
                 the noise is known",
                counted(plain, "other network"),
                one_or(plain, "explains", "explain"),
                if judged.receivers_agree { ", with the same receivers and other transmitters" } else { "" },
            ));
        }
        self.warn_of_receivers(&mut warnings);
        warnings.extend(self.receiver_echoes().iter().map(|echo| echo.warning(self.metre())));
        self.warn_of_search(judged, &mut warnings);
        let redundancy = judged.redundancy;
        if let Some(information) = judged.one_sided.as_ref().filter(|information| !information.fits(redundancy)) {
            warnings.push(format!(
                "which measurements are late cannot be told for sure: {:.0} % seem late or wrong, and {redundancy} of the others are left over \
                 where {LEAST_REDUNDANCY} would do; measure more, or remove measurements that are known to be wrong",
                100.0 * (information.mixture.share + information.mixture.gross)
            ));
        }
        warnings.extend(self.doubts_choice.map(str::to_string));
        warnings
    }

    /// Residuals that are larger than they should be.
    fn warn_of_misfit(&self, judged: &Judged<'_, D>, warnings: &mut Vec<String>) {
        if let Some(sigma) = self.known.filter(|_| !judged.as_given) {
            warnings.push(format!(
                "the residuals are {:.1} times as large as the given standard deviation, and standard deviations of the nodes are too small by \
                 that factor: give a larger --sigma, or none; or {}the measurements have errors beside noise",
                judged.estimated / sigma,
                if D == 2 { "the network is not planar, or " } else { "" }
            ));
        }
        if judged.overrun {
            let all = self.observations.len();
            warnings.push(format!(
                "the measurements do not fit a network {}: {} of {all} are outliers, and fewer starts of the search agree than it takes to be sure \
                 of that; at most about three tenths of the measurements may be wrong",
                space(D),
                all - judged.kept.len()
            ));
        } else if !judged.fits {
            let misfit = self.metre() * judged.estimated * typical_deviation(&self.measured);
            let size = self.metre() * self.ranked[0].network.size();
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
        }
    }

    /// Transmitters of which the direction alone is told.
    fn warn_of_far_transmitters(&self, far: &[Far<D>], warnings: &mut Vec<String>) {
        let least = far.iter().map(|far| far.least_distance).reduce(f64::min);
        let worst = far.iter().map(|far| far.direction_std).reduce(f64::max);
        if let (Some(least), Some(worst)) = (least, worst) {
            let names: Vec<String> =
                far.iter().map(|far| self.measured.transmitter_names()[far.transmitter].clone()).collect();
            warnings.push(format!(
                "transmitters too far from the receivers to tell how far: {}; their directions are told, to {} degrees or better, and they \
                 are at least {} away (see far_transmitters); the positions given are each one of many in its direction",
                list(&names),
                number(worst.to_degrees(), 2),
                length(self.metre() * least)
            ));
        }
    }

    /// A search of which too little ended in the best network.
    fn warn_of_search(&self, judged: &Judged<'_, D>, warnings: &mut Vec<String>) {
        if judged.settled {
            return;
        }
        let agreeing = judged.agreeing;
        if judged.scattered {
            warnings.push(format!(
                "only {agreeing} of {} starts of the search ended in this network, fewer than there are others that fit about as well: the \
                 measurements do not tell these apart; move some nodes out of the line, circle or plane that they may lie in, or measure more",
                self.starts
            ));
        } else if let Some(weak) = &self.weak {
            let names: Vec<String> = weak.iter().map(|&i| self.measured.receiver_names()[i].clone()).collect();
            warnings.push(format!(
                "{agreeing} of {} of neighbours {} the whole, but none that overlaps with others places {}; measure \
                 transmitters that these receivers and at least {} of their neighbours hear",
                counted(self.starts, "small network"),
                one_or(agreeing, "fits", "fit"),
                list(&names),
                overlap::<D>()
            ));
        } else {
            warnings.push(format!(
                "only {} of {} starts of the search ended in this network, so that a better one may have been missed; give --sigma, \
                 remove measurements that are known to be wrong, or raise --max-starts",
                agreeing, self.starts
            ));
        }
    }
}

/// Warnings about nodes in one place, hardly tied down, or with many outliers.
pub(crate) fn warn_of_nodes<const D: usize>(
    measured: &Pseudoranges,
    network: &Network<D>,
    judged: &Judged<'_, D>,
    warnings: &mut Vec<String>,
) {
    let Judged { kept, uncertainty, weak, doubtful, .. } = judged;
    let noise_known = judged.ellipse_radius.is_some();
    let size = network.size();
    let names = measured.receiver_names();
    for (a, p) in network.receivers.iter().enumerate() {
        for (b, q) in network.receivers.iter().enumerate().skip(a + 1) {
            if distance(*p, *q) < 1e-3 * size {
                warnings.push(format!("receivers {} and {} stand in the same place; remove one", names[a], names[b]));
            }
        }
    }
    let named = |names: &[String], all: &[usize]| list(&all.iter().map(|&k| names[k].clone()).collect::<Vec<_>>());
    if !uncertainty.loose.is_empty() {
        warnings.push(format!(
            "the measurements do not determine where {} are; measure more of them",
            named(names, &uncertainty.loose)
        ));
    }
    if noise_known && weak.are_most_receivers() {
        warnings.push(
            "most receivers are poorly determined: are receivers the rows of the table, and transmitters its columns? else measure more"
                .to_string(),
        );
    }
    let all =
        [("receivers", names, &weak.receivers), ("transmitters", measured.transmitter_names(), &weak.transmitters)];
    for (kind, names, nodes) in all {
        if noise_known && !nodes.is_empty() {
            warnings.push(format!(
                "poorly determined {kind} (standard deviation above a tenth of the network's size): {}; measure more, or \
                 from more directions",
                named(names, nodes)
            ));
        }
    }
    let least = of_transmitter::<D>(measured.emissions()) + 1;
    let astray: Vec<usize> = (0..measured.transmitters())
        .filter(|&j| {
            let all = (0..measured.receivers()).filter(|&i| measured.get(i, j).is_some()).count();
            let good = kept.of_transmitter(j).len();
            good < least || 2 * good < all
        })
        .collect();
    if !astray.is_empty() {
        let astray = named(measured.transmitter_names(), &astray);
        warnings.push(format!("transmitters most of whose measurements are outliers: {astray}; check them"));
    }
    let (none, some): (Vec<usize>, Vec<usize>) =
        mostly_wrong(measured, kept).into_iter().partition(|i| doubtful.contains(i));
    if !none.is_empty() {
        warnings.push(format!(
            "receivers most of whose measurements are outliers: {}; no position is given for them; check them",
            named(names, &none)
        ));
    }
    if !some.is_empty() {
        warnings.push(format!(
            "receivers most of whose measurements are outliers: {}; those that are left agree on their positions; check them",
            named(names, &some)
        ));
    }
}
