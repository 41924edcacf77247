//! Larger networks through smaller ones: a well-spread part is solved, the other nodes follow
//! linearly from squared distances, and the last refinement uses all measurements.

use crate::minimal::linear::LeastSquares;
use crate::minimal::normalised::{Normalised, rank};
use crate::minimal::options::MinimalOptions;
use crate::minimal::polish::NetworkPolisher;
use crate::minimal::solution::{Candidate, MinimalSolution};
use crate::minimal::subset::Subset;
use crate::network::Network;
use crate::points::{dot, minus};
use crate::pseudoranges::Pseudoranges;
use std::array::from_fn;

/// Extends the candidates of a part, the receivers and transmitters `part` of `measured`, to the
/// whole.
pub(crate) fn extend(
    measured: &Pseudoranges,
    part: &Subset,
    mut solution: MinimalSolution,
    options: &MinimalOptions,
) -> MinimalSolution {
    let networks = solution.candidates.iter().map(|candidate| &candidate.network);
    solution.candidates = candidates_of_whole(measured, part, networks, options);
    solution.counts.physical = solution.candidates.iter().filter(|c| c.physical).count();
    solution.configuration = measured.configuration();
    solution
}

/// Networks of a part, extended to the whole and refined, best first; those that do not determine a
/// node are left out.
pub(crate) fn candidates_of_whole<'a, const D: usize>(
    measured: &Pseudoranges,
    part: &Subset,
    networks: impl Iterator<Item = &'a Network<D>>,
    options: &MinimalOptions,
) -> Vec<Candidate<D>> {
    let data = Normalised::new(measured);
    let (mut squares, mut polisher) = (LeastSquares::default(), NetworkPolisher::default());
    let mut whole = |network: &Network<D>| {
        let mut network = spread_out(measured, part, network, &mut squares)?;
        data.enter(&mut network);
        Some(data.candidate(network, options, &mut polisher))
    };
    let mut candidates: Vec<Candidate<D>> = networks.filter_map(&mut whole).collect();
    rank(&mut candidates);
    for candidate in &mut candidates {
        data.restore(&mut candidate.network);
        candidate.residual = candidate.network.rms(measured);
    }
    candidates
}

/// The network of all nodes from that of a part; `None` where a node cannot be determined.
fn spread_out<const D: usize>(
    measured: &Pseudoranges,
    part: &Subset,
    known: &Network<D>,
    squares: &mut LeastSquares,
) -> Option<Network<D>> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let f = |i: usize, j: usize| measured.get(i, j).unwrap_or(f64::NAN);
    let mut network = Network::new(vec![[f64::NAN; D]; m], vec![[f64::NAN; D]; n], vec![f64::NAN; n]);
    for (k, &i) in part.receivers.iter().enumerate() {
        network.receivers[i] = known.receivers[k];
    }
    for (k, &j) in part.transmitters.iter().enumerate() {
        network.transmitters[j] = known.transmitters[k];
        network.offsets[j] = known.offsets[k];
    }
    for j in (0..n).filter(|j| !part.transmitters.contains(j)) {
        let sights: Vec<([f64; D], f64)> = part.receivers.iter().map(|&i| (network.receivers[i], f(i, j))).collect();
        let (position, offset) = transmitter(&sights, squares)?;
        network.transmitters[j] = position;
        network.offsets[j] = offset;
    }
    for i in (0..m).filter(|i| !part.receivers.contains(i)) {
        let sights: Vec<([f64; D], f64)> =
            (0..n).map(|j| (network.transmitters[j], f(i, j) - network.offsets[j])).collect();
        network.receivers[i] = receiver(&sights, squares)?;
    }
    network.is_finite().then_some(network)
}

/// A transmitter from D + 2 or more receivers: `|r_i - s|^2 = (f_i - o)^2`, the first subtracted, is
/// linear in `s` and `o`.
fn transmitter<const D: usize>(sights: &[([f64; D], f64)], squares: &mut LeastSquares) -> Option<([f64; D], f64)> {
    let (origin, first) = sights[0];
    let at = |i: usize| {
        let (r, f) = sights[i + 1];
        (minus(r, origin), f - first)
    };
    let x = squares.fit(
        sights.len() - 1,
        D + 1,
        |i, c| {
            let (r, f) = at(i);
            r.get(c).map_or(-2.0 * f, |r| 2.0 * r)
        },
        |i| {
            let (r, f) = at(i);
            dot(r, r) - f * f
        },
    )?;
    Some((from_fn(|k| origin[k] + x[k]), first + x[D]))
}

/// A receiver from its distances to D + 1 or more transmitters.
fn receiver<const D: usize>(sights: &[([f64; D], f64)], squares: &mut LeastSquares) -> Option<[f64; D]> {
    let (origin, first) = sights[0];
    let at = |i: usize| {
        let (s, d) = sights[i + 1];
        (minus(s, origin), d)
    };
    let x = squares.fit(
        sights.len() - 1,
        D,
        |i, c| 2.0 * at(i).0[c],
        |i| {
            let (s, d) = at(i);
            dot(s, s) - d * d + first * first
        },
    )?;
    Some(from_fn(|k| origin[k] + x[k]))
}

#[cfg(test)]
mod tests {
    use super::{LeastSquares, receiver, transmitter};

    #[test]
    fn nodes_by_hand() {
        // A transmitter at (3, 4) with offset 10: distances 5, 5, 4, 3 from the corners of a 6 by 8
        // cross.
        let sights =
            [([0.0, 0.0], 15.0), ([6.0, 0.0], 15.0), ([3.0, 0.0], 14.0), ([0.0, 4.0], 13.0), ([3.0, 8.0], 14.0)];
        let mut squares = LeastSquares::default();
        let (position, offset) = transmitter(&sights, &mut squares).unwrap();
        assert!(
            (position[0] - 3.0).abs() < 1e-12 && (position[1] - 4.0).abs() < 1e-12 && (offset - 10.0).abs() < 1e-12
        );
        let sights = [([0.0, 0.0], 5.0), ([6.0, 0.0], 5.0), ([3.0, 0.0], 4.0), ([0.0, 4.0], 3.0)];
        let found = receiver(&sights, &mut squares).unwrap();
        assert!((found[0] - 3.0).abs() < 1e-12 && (found[1] - 4.0).abs() < 1e-12);
    }

    #[test]
    fn nodes_in_one_line_do_not_determine_another() {
        let sights = [([0.0, 0.0], 5.0), ([1.0, 0.0], 4.0), ([2.0, 0.0], 4.5)];
        assert_eq!(receiver(&sights, &mut LeastSquares::default()), None);
    }
}
