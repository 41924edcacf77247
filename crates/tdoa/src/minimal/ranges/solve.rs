//! The entry point for ranges of all sizes, with a constant or without.

use super::centred::{span, spread};
use super::constant::{FourSeven, GramAndConstant, ThreeFour};
use super::five_five;
use super::gram::{FiveFive, FourSix, Gram, ThreeThree};
use crate::loss::Loss;
use crate::minimal::check::check;
use crate::minimal::doubts::{allowed, warnings_of_ranges};
use crate::minimal::engine::Engine;
use crate::minimal::engines::{Engines, PathSolver};
use crate::minimal::error::MinimalError;
use crate::minimal::formulation::FormulationIn;
use crate::minimal::normalised::{Normalised, leave_out_copies, rank};
use crate::minimal::options::{MinimalOptions, MinimalStart};
use crate::minimal::polish::NetworkPolisher;
use crate::minimal::solution::{Candidate, MinimalSolution};
use crate::minimal::subset::{Subset, ranked};
use crate::network::Network;
use crate::observations::Observations;
use crate::points::minus;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{PartialNetwork, extend};
use hc::Monitor;

/// Parts of larger measurements that are looked at, those with the nodes farthest apart; the one that spans the plane or
/// space best is solved.
const LOOKED_AT: usize = 12;

/// How networks of one size and all larger ones are solved.
pub(in crate::minimal) struct Method<const D: usize> {
    name: &'static str,
    receivers: usize,
    transmitters: usize,
    /// Whether receivers and transmitters change roles.
    exchanges: bool,
    /// How well nodes are in general position; zero where the equations do not determine them.
    spread: fn(&Pseudoranges) -> f64,
    solve: fn(&mut Engines<D>, &Pseudoranges, &MinimalOptions, &Monitor) -> Result<MinimalSolution<D>, MinimalError>,
}

/// Methods in the plane.
pub(in crate::minimal) const IN_PLANE: [Method<2>; 1] = [by_paths::<Gram<ThreeThree, 2>, 2>(span::<2>)];

/// Methods in the plane for ranges with one unknown constant.
pub(in crate::minimal) const IN_PLANE_WITH_CONSTANT: [Method<2>; 2] = [
    by_paths::<GramAndConstant<ThreeFour, 2>, 2>(span::<2>),
    exchanging("4r/3s", by_paths::<GramAndConstant<ThreeFour, 2>, 2>(span::<2>)),
];

/// Methods in space; the one that takes most measurements comes first.
pub(in crate::minimal) const IN_SPACE: [Method<3>; 3] = [
    by_paths::<Gram<FiveFive, 3>, 3>(spread::<3>),
    by_paths::<Gram<FourSix, 3>, 3>(span::<3>),
    exchanging("6r/4s", by_paths::<Gram<FourSix, 3>, 3>(span::<3>)),
];

const fn by_paths<F: FormulationIn<D> + 'static, const D: usize>(spread: fn(&Pseudoranges) -> f64) -> Method<D>
where
    Engine<F, D>: PathSolver<D>,
{
    Method {
        name: F::NAME,
        receivers: F::RECEIVERS,
        transmitters: F::TRANSMITTERS,
        exchanges: false,
        spread,
        solve: |engines, measured, options, monitor| engines.used::<F>().solve(measured, options, monitor),
    }
}

/// Methods in space for ranges with one unknown constant; the one with the fewest paths comes first.
pub(in crate::minimal) const IN_SPACE_WITH_CONSTANT: [Method<3>; 3] = [
    Method {
        name: "5r/5s",
        receivers: 5,
        transmitters: 5,
        exchanges: false,
        spread: spread::<3>,
        solve: five_five::solve,
    },
    by_paths::<GramAndConstant<FourSeven, 3>, 3>(span::<3>),
    exchanging("7r/4s", by_paths::<GramAndConstant<FourSeven, 3>, 3>(span::<3>)),
];

/// A method with the roles of receivers and transmitters exchanged.
const fn exchanging<const D: usize>(name: &'static str, method: Method<D>) -> Method<D> {
    let (receivers, transmitters) = (method.transmitters, method.receivers);
    Method { name, receivers, transmitters, exchanges: true, ..method }
}

/// Every network that explains ranges, best first; `methods` are those of `options.emissions`.
pub(in crate::minimal) fn solve<const D: usize>(
    engines: &mut Engines<D>,
    methods: &[Method<D>],
    measured: &Pseudoranges,
    options: &MinimalOptions,
    monitor: &Monitor,
) -> Result<MinimalSolution<D>, MinimalError> {
    engines.none_used();
    let measured = &measured.clone().with_emissions(options.emissions);
    check::<D>(measured)?;
    if options.start != MinimalStart::Stored {
        return Err(MinimalError::StoredOnly { configuration: measured.configuration() });
    }
    let (m, n) = (measured.receivers(), measured.transmitters());
    let mut best: Option<(f64, &Method<D>, Subset)> = None;
    for method in methods.iter().filter(|method| m >= method.receivers && n >= method.transmitters) {
        for part in ranked(measured, method.receivers, method.transmitters, LOOKED_AT) {
            let spread = (method.spread)(&measured.select(&part.receivers, &part.transmitters));
            if spread > best.as_ref().map_or(0.0, |best| best.0) {
                best = Some((spread, method, part));
            }
        }
        // Parts of another size only where none of this one is determined.
        if best.is_some() {
            break;
        }
    }
    let Some((_, method, part)) = best else {
        return Err(match (span::<D>(measured) > 0.0, D) {
            (true, _) => MinimalError::SpecialPosition,
            (false, 2) => MinimalError::InOneLine,
            (false, _) => MinimalError::InOnePlane,
        });
    };
    let is_whole = (part.receivers.len(), part.transmitters.len()) == (m, n);
    // Only all measurements together tell which candidate of a part is the network.
    let settings = MinimalOptions { first_under: options.first_under.filter(|_| is_whole), ..options.clone() };
    let mut solution =
        method.of_part(engines, &measured.select(&part.receivers, &part.transmitters), &settings, monitor)?;
    if monitor.is_cancelled() {
        return Err(MinimalError::Cancelled);
    }
    if !is_whole {
        let networks = solution.candidates.iter().map(|candidate| &candidate.network);
        let mut candidates = extended(measured, &part, networks, options, monitor)?;
        candidates.sort_by(|a, b| a.residual.total_cmp(&b.residual));
        let enough = allowed(measured, options);
        let explaining = candidates.iter().filter(|candidate| candidate.residual <= enough).count();
        // Of ranges that no network explains, the one that comes nearest.
        candidates.truncate(explaining.max(1));
        leave_out_copies(&mut candidates);
        rank(&mut candidates);
        solution.counts.physical = candidates.iter().filter(|candidate| candidate.physical).count();
        solution.candidates = candidates;
    }
    solution.configuration = measured.configuration();
    solution.warnings = warnings_of_ranges(measured, &solution.paths, &solution.candidates, options);
    Ok(solution)
}

/// Networks of a part, extended to all nodes and refined over all ranges; those that do not determine a node are left out.
fn extended<'a, const D: usize>(
    measured: &Pseudoranges,
    part: &Subset,
    networks: impl Iterator<Item = &'a Network<D>>,
    options: &MinimalOptions,
    monitor: &Monitor,
) -> Result<Vec<Candidate<D>>, MinimalError> {
    let (observations, data) = (Observations::<D>::new(measured, |_, _| true), Normalised::new(measured));
    let (loss, mut polisher) = (Loss { nu: f64::INFINITY, scale: data.size() }, NetworkPolisher::default());
    let mut candidates = Vec::new();
    for network in networks {
        let mut known = PartialNetwork::unknown(measured.receivers(), measured.transmitters());
        known.place(network, &part.receivers, &part.transmitters);
        let whole = extend(&observations, &known, &loss, monitor).map_err(|_| MinimalError::Cancelled)?;
        let Some(mut network) = whole.filter(Network::is_finite) else { continue };
        data.enter(&mut network);
        let mut candidate = data.candidate(network, options, &mut polisher);
        data.restore(&mut candidate.network);
        candidate.residual = candidate.network.rms(measured);
        candidates.push(candidate);
    }
    Ok(candidates)
}

impl<const D: usize> Method<D> {
    /// The networks of ranges of this size.
    fn of_part(
        &self,
        engines: &mut Engines<D>,
        part: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution<D>, MinimalError> {
        if !self.exchanges {
            return (self.solve)(engines, part, options, monitor);
        }
        let mut solution = (self.solve)(engines, &exchanged(part)?, options, monitor)?;
        solution.solver = self.name;
        for Candidate { network, .. } in &mut solution.candidates {
            exchange(network);
        }
        Ok(solution)
    }
}

/// The ranges of the transmitters as receivers.
fn exchanged(part: &Pseudoranges) -> Result<Pseudoranges, MinimalError> {
    let (m, n, values) = (part.receivers(), part.transmitters(), part.cells().values());
    let cells = (0..m * n).map(|k| (k / m, k % m, values[k % m * n + k / m]));
    let exchanged = Pseudoranges::from_cells(n, m, cells);
    exchanged.map(|ranges| ranges.with_emissions(part.emissions())).map_err(|_| MinimalError::NoNetwork)
}

/// Makes receivers of transmitters, the first of them in the origin.
fn exchange<const D: usize>(network: &mut Network<D>) {
    std::mem::swap(&mut network.receivers, &mut network.transmitters);
    // All are one.
    let offset = network.offsets[0];
    network.offsets.clear();
    network.offsets.resize(network.transmitters.len(), offset);
    let origin = network.receivers[0];
    for place in network.receivers.iter_mut().chain(&mut network.transmitters) {
        *place = minus(*place, origin);
    }
}
