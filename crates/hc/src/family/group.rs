//! The monodromy group of a fibre, as far as loops show it.
//!
//! Along a loop in the parameters each solution goes to one of them. These permutations generate the monodromy group,
//! which is the Galois group of the family over the complex numbers (Harris 1979, Duke Math. J. 46:685).

use super::fibre::{Fibre, FibreOptions};
use super::permutations::{Permutation, block_systems, is_symmetric, orbits};
use super::reach::Reach;
use super::sides::Searched;
use crate::checkpoint::Pieces;
use crate::distinct::Known;
use crate::random::{Random, Stream};
use num_complex::Complex64;
use poly::Evaluate;
use serde::{Deserialize, Serialize};

/// Sets of solutions that permutations take to each other.
pub type BlockSystem = Vec<Vec<usize>>;

/// Most solutions whose blocks are sought.
const MOST: usize = 2_000;

/// What loops tell of the monodromy group. They generate a subgroup, which is the group itself once there are enough.
/// Solutions are counted from zero, in the order of the fibre.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MonodromyGroup {
    /// Loops that were followed, with the care of [`FibreOptions::default`]. Two paths that change places on a loop,
    /// both of which have then jumped, would not be seen.
    pub loops: usize,
    /// Those of them along which every path led from a solution to another one or back; the others tell nothing.
    pub whole: usize,
    /// Their permutations, each once, without the identity: solution `k` goes to `generators[_][k]`.
    pub generators: Vec<Vec<usize>>,
    /// Sets of solutions that these join.
    pub orbits: Vec<Vec<usize>>,
    /// For each orbit the minimal systems of blocks that are neither single solutions nor the whole orbit: the
    /// permutations take blocks to blocks. An orbit without any is primitive. A system may be broken by loops that have
    /// not been tried. `None` where they were not sought, among more than 2,000 solutions that are not known to have
    /// none.
    pub blocks: Vec<Option<Vec<BlockSystem>>>,
    /// Whether these generate all permutations of the solutions, which are then the whole group. False if that is
    /// not shown.
    pub symmetric: bool,
}

/// What so many loops tell of the group of all solutions of a fibre.
pub(super) fn monodromy_group<E: Evaluate>(
    searched: &Searched<'_, E>,
    fibre: &Fibre,
    loops: usize,
    options: &FibreOptions,
    seed: u64,
    pieces: Pieces<'_>,
) -> MonodromyGroup {
    let (count, n) = (fibre.len(), fibre.dimension.max(1));
    let Reach { natural, wide, .. } = Reach::new(searched.system, fibre);
    let sizes = [wide.parameters, natural.parameters];
    let known = Known::new(fibre.iter());
    let mut group = MonodromyGroup::default();
    for k in 0..loops {
        if pieces.are_stopped() {
            break;
        }
        group.loops += 1;
        let mut random = Random::of(seed, Stream::Loop(k as u64));
        let sizes = &sizes[k % sizes.len()];
        let corners = [0, 1].map(|_| {
            let normals = random.normals(sizes.len());
            normals.into_iter().zip(sizes).map(|(z, size)| z * size).collect::<Vec<Complex64>>()
        });
        let mut moving = Some(Fibre { representatives: None, is_partial: true, ..fibre.clone() });
        for corner in [&corners[0], &corners[1], &fibre.parameters] {
            moving = moving.and_then(|fibre| searched.moved(&fibre, corner, options, pieces));
        }
        let Some(back) = moving else { continue };
        let places = back.solutions.chunks_exact(n).map(|x| known.place(x, options.coincidence));
        let Some(permutation) = places.collect::<Option<Permutation>>().filter(|p| is_permutation(p)) else { continue };
        group.whole += 1;
        let is_new = permutation.iter().enumerate().any(|(k, &to)| k != to) && !group.generators.contains(&permutation);
        if is_new {
            group.generators.push(permutation);
        }
    }
    group.orbits = orbits(count, &group.generators);
    group.symmetric = is_symmetric(count, &group.generators);
    let blocks = |orbit: &Vec<usize>| match group.symmetric {
        true => Some(Vec::new()),
        false => (count <= MOST).then(|| block_systems(count, &group.generators, orbit)),
    };
    group.blocks = group.orbits.iter().map(blocks).collect();
    group
}

/// Whether each number occurs once.
fn is_permutation(places: &[usize]) -> bool {
    let mut seen = vec![false; places.len()];
    places.iter().all(|&k| !std::mem::replace(&mut seen[k], true))
}

#[cfg(test)]
mod tests {
    use crate::{Family, MonodromyOptions};

    fn group(unknown: &str, parameters: &[&str], equation: &str) -> super::MonodromyGroup {
        let family = Family::from_formulas(&[unknown], parameters, &[equation]).unwrap();
        let found = family.monodromy(&MonodromyOptions::new().group(12)).unwrap();
        let group = found.group.unwrap();
        assert_eq!(group.orbits.iter().map(Vec::len).collect::<Vec<_>>(), found.orbits, "{group:?}");
        group
    }

    /// A polynomial whose two lowest coefficients are free: every permutation of the roots, as of `x^d + b x + c`.
    #[test]
    fn of_a_generic_polynomial_is_symmetric() {
        for (d, p) in [(3, vec!["a", "b", "c"]), (5, vec!["a", "b", "c"]), (9, vec!["a", "b", "c"])] {
            let found = group("x", &p, &format!("x^{d} + a*x^2 + b*x + c"));
            assert!(found.symmetric && found.blocks == [Some(Vec::new())], "{d}: {found:?}");
        }
    }

    /// Roots and their negatives: the symmetries of a square, with its diagonals as blocks.
    #[test]
    fn of_a_biquadratic_polynomial_has_blocks() {
        let found = group("x", &["a", "b"], "x^4 + a*x^2 + b");
        let systems = found.blocks[0].clone().unwrap();
        assert!(!found.symmetric && systems.len() == 1, "{found:?}");
        assert!(systems[0].iter().all(|block| block.len() == 2), "{found:?}");
    }

    /// `x^6 = a`: a cyclic group, with systems of blocks of two and of three.
    #[test]
    fn of_a_pure_power_is_cyclic() {
        let found = group("x", &["a"], "x^6 - a");
        let systems = found.blocks[0].clone().unwrap();
        let mut sizes: Vec<usize> = systems.iter().map(|system| system[0].len()).collect();
        sizes.sort_unstable();
        assert!(!found.symmetric && sizes == [2, 3], "{found:?}");
        for a in &found.generators {
            for b in &found.generators {
                assert!((0..6).all(|k| a[b[k]] == b[a[k]]), "{found:?}");
            }
        }
    }
}
