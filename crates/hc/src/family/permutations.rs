//! Groups of permutations: orbits, blocks, and whether all permutations belong to them.

use crate::distinct::root;
use crate::random::{Random, Stream};
use std::collections::{BTreeMap, BTreeSet};

/// Where each point goes.
pub(super) type Permutation = Vec<usize>;

/// Groups of so many points are listed, larger ones are not.
const LISTED: usize = 7;
/// Random products in which a cycle of prime length is sought.
const PRODUCTS: usize = 1_000;

/// Sets of points joined to each other, in the order of their first points.
fn joined(count: usize, joins: &mut Vec<(usize, usize)>, generators: &[Permutation]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..count).collect();
    while let Some((a, b)) = joins.pop() {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        if a != b {
            parent[a.max(b)] = a.min(b);
            joins.extend(generators.iter().map(|g| (g[a], g[b])));
        }
    }
    let mut sets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for k in 0..count {
        sets.entry(root(&mut parent, k)).or_default().push(k);
    }
    sets.into_values().collect()
}

/// The orbits, in the order of their first points.
pub(super) fn orbits(count: usize, generators: &[Permutation]) -> Vec<Vec<usize>> {
    let mut joins = generators.iter().flat_map(|g| g.iter().copied().enumerate()).collect();
    joined(count, &mut joins, &[])
}

/// The minimal systems of blocks of an orbit that are neither single points nor the orbit: what the first point and
/// another one generate (Atkinson 1975, Math. Comp. 29:911).
pub(super) fn block_systems(count: usize, generators: &[Permutation], orbit: &[usize]) -> Vec<Vec<Vec<usize>>> {
    let Some((&first, others)) = orbit.split_first() else { return Vec::new() };
    let mut systems: Vec<Vec<Vec<usize>>> = Vec::new();
    for &other in others {
        let mut system = joined(count, &mut vec![(first, other)], generators);
        system.retain(|block| orbit.binary_search(&block[0]).is_ok());
        let is_proper = system.len() > 1;
        if is_proper && !systems.contains(&system) {
            systems.push(system);
        }
    }
    // The block of the first point comes first. One that holds that of another system is not minimal.
    let within = |a: &[usize], b: &[usize]| a.len() < b.len() && a.iter().all(|k| b.binary_search(k).is_ok());
    let minimal = |system: &Vec<Vec<usize>>| !systems.iter().any(|smaller| within(&smaller[0], &system[0]));
    systems.iter().filter(|system| minimal(system)).cloned().collect()
}

/// Whether all permutations of so many points are products of these; false if that is not shown.
///
/// A primitive group with a cycle of prime length `p <= count - 3` has all even permutations (Jordan 1873). A power of
/// a permutation is such a cycle if that has a cycle of length `p > count / 2`, and no blocks are possible then: the
/// cycle would move `p` of them, more points than there are, or the points of a single one, which are fewer.
pub(super) fn is_symmetric(count: usize, generators: &[Permutation]) -> bool {
    let orbits = orbits(count, generators);
    if orbits.len() != 1 {
        return false;
    }
    if count <= LISTED {
        return elements(count, generators).len() == (1..=count).product::<usize>();
    }
    if !generators.iter().any(|g| is_odd(g)) {
        return false;
    }
    let mut random = Random::of(0, Stream::Products);
    let mut product: Permutation = (0..count).collect();
    (0..PRODUCTS).any(|_| {
        let next = &generators[random.below(generators.len() as u64) as usize];
        product = product.iter().map(|&k| next[k]).collect();
        cycles(&product).into_iter().any(|length| 2 * length > count && length + 3 <= count && is_prime(length))
    })
}

/// All products.
fn elements(count: usize, generators: &[Permutation]) -> BTreeSet<Permutation> {
    let one: Permutation = (0..count).collect();
    let (mut all, mut next) = (BTreeSet::from([one.clone()]), vec![one]);
    while let Some(element) = next.pop() {
        for generator in generators {
            let product: Permutation = element.iter().map(|&k| generator[k]).collect();
            if all.insert(product.clone()) {
                next.push(product);
            }
        }
    }
    all
}

/// The lengths of the cycles.
fn cycles(permutation: &[usize]) -> Vec<usize> {
    let mut seen = vec![false; permutation.len()];
    let mut length = |first: usize| {
        let (mut k, mut length) = (first, 0);
        while !seen[k] {
            seen[k] = true;
            k = permutation[k];
            length += 1;
        }
        length
    };
    (0..permutation.len()).map(&mut length).filter(|&length| length > 0).collect()
}

fn is_odd(permutation: &[usize]) -> bool {
    (permutation.len() - cycles(permutation).len()) % 2 == 1
}

fn is_prime(n: usize) -> bool {
    n > 1 && (2..).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d))
}

#[cfg(test)]
mod tests {
    use super::{block_systems, elements, is_symmetric, orbits};

    /// `k` goes to `k + 1`.
    fn cycle(n: usize) -> Vec<usize> {
        (0..n).map(|k| (k + 1) % n).collect()
    }

    fn swap(n: usize, a: usize, b: usize) -> Vec<usize> {
        let mut swap: Vec<usize> = (0..n).collect();
        swap.swap(a, b);
        swap
    }

    #[test]
    fn a_cycle_and_a_transposition_of_neighbours_generate_all_permutations() {
        for n in 2..=30 {
            assert!(is_symmetric(n, &[cycle(n), swap(n, 0, 1)]), "{n}");
            assert_eq!(is_symmetric(n, &[cycle(n)]), n == 2, "{n}");
        }
        // Cycles of length three: even permutations alone.
        let three = |n: usize, k: usize| {
            let mut cycle: Vec<usize> = (0..n).collect();
            cycle[k..k + 3].rotate_left(1);
            cycle
        };
        for n in 4..=12 {
            let all: Vec<_> = (0..n - 2).map(|k| three(n, k)).collect();
            assert!(!is_symmetric(n, &all), "{n}");
        }
    }

    /// The blocks of cyclic groups are the cosets of their subgroups, of which those of prime order are minimal.
    #[test]
    fn blocks_of_a_cycle_are_cosets() {
        for (n, primes) in [(4, vec![2]), (5, vec![]), (6, vec![3, 2]), (12, vec![3, 2]), (30, vec![5, 3, 2])] {
            let all: Vec<usize> = (0..n).collect();
            let mut sizes: Vec<usize> = block_systems(n, &[cycle(n)], &all).iter().map(|s| s[0].len()).collect();
            sizes.sort_unstable_by(|a, b| b.cmp(a));
            assert_eq!(sizes, primes, "{n}");
        }
    }

    #[test]
    fn symmetries_of_a_square_keep_its_diagonals() {
        let square = [cycle(4), vec![0, 3, 2, 1]];
        assert_eq!(elements(4, &square).len(), 8);
        assert_eq!(block_systems(4, &square, &[0, 1, 2, 3]), [vec![vec![0, 2], vec![1, 3]]]);
    }

    #[test]
    fn points_that_stay_are_orbits() {
        assert_eq!(orbits(5, &[vec![1, 0, 2, 4, 3]]), [vec![0, 1], vec![2], vec![3, 4]]);
        assert_eq!(orbits(2, &[]), [vec![0], vec![1]]);
        assert!(!is_symmetric(2, &[]) && is_symmetric(1, &[]));
    }
}
