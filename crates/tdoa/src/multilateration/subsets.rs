//! Small subsets of a list.

use smallvec::SmallVec;

/// Most subsets that are tried for one node; fewer when there are no more.
const SUBSETS: usize = 32;

/// Calls `visit` with subsets of 0..count that have this size: all of them if there are at most
/// [`SUBSETS`], otherwise that many, spread evenly by a fixed rule, the first numbers of `draws`
/// each (at least the size).
pub(super) fn for_subsets(count: usize, size: usize, draws: usize, mut visit: impl FnMut(&[usize])) {
    if count < size {
        return;
    }
    if are_few(count, size) {
        let mut chosen: SmallVec<[usize; 4]> = (0..size).collect();
        // The next in lexical order: the last that can go up does so, and those after it follow it.
        loop {
            visit(&chosen);
            let Some(k) = (0..size).rev().find(|&k| chosen[k] < count - size + k) else { return };
            chosen[k] += 1;
            for l in k + 1..size {
                chosen[l] = chosen[l - 1] + 1;
            }
        }
    }
    // A linear congruential generator: the same subsets whenever the same node is located.
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % count
    };
    let mut visited = 0;
    while visited < SUBSETS {
        let all: SmallVec<[usize; 4]> = (0..draws).map(|_| draw()).collect();
        let chosen = &all[..size];
        if (1..size).all(|k| !chosen[..k].contains(&chosen[k])) {
            visit(chosen);
            visited += 1;
        }
    }
}

/// Whether there are at most [`SUBSETS`] subsets of this size.
fn are_few(count: usize, size: usize) -> bool {
    let mut total = 1usize;
    for k in 0..size.min(count - size) {
        total = total * (count - k) / (k + 1);
        // The numbers of smaller subsets are smaller, up to half of the list.
        if total > SUBSETS {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::{SUBSETS, are_few, for_subsets};
    use std::collections::BTreeSet;

    fn subsets(count: usize, size: usize) -> Vec<Vec<usize>> {
        let mut all = Vec::new();
        for_subsets(count, size, 4, |subset| all.push(subset.to_vec()));
        all
    }

    #[test]
    fn all_subsets_of_a_short_list_in_order() {
        assert_eq!(subsets(3, 2), [[0, 1], [0, 2], [1, 2]]);
        assert_eq!(subsets(4, 3), [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]);
        assert_eq!(subsets(4, 4), [[0, 1, 2, 3]]);
        // Binomial coefficients.
        for (count, size, total) in [(8, 2, 28), (6, 3, 20), (6, 4, 15), (5, 4, 5), (30, 1, 30)] {
            let all = subsets(count, size);
            assert!(all.is_sorted() && all.iter().all(|subset| subset.is_sorted()), "{count} {size}");
            assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), total);
        }
        assert!(subsets(2, 3).is_empty());
    }

    #[test]
    fn some_subsets_of_a_long_list() {
        for (count, size) in [(9, 2), (7, 3), (7, 4), (24_000_000, 4)] {
            assert!(!are_few(count, size));
            let all = subsets(count, size);
            assert_eq!(all.len(), SUBSETS);
            for subset in &all {
                assert_eq!(subset.iter().filter(|&&k| k < count).collect::<BTreeSet<_>>().len(), size);
            }
        }
    }
}
