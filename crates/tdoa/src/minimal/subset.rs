//! Which part of a larger matrix to solve: the part whose nodes are farthest apart, as far as the
//! measurements tell.

use crate::pseudoranges::Pseudoranges;
use rand::SeedableRng;
use rand::seq::index::sample;
use rand_pcg::Pcg64Mcg;

/// Parts that are looked at, at most; spread evenly over all of them.
const LOOKED_AT: usize = 400;

/// Some receivers and transmitters of a matrix, by index, ascending.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Subset {
    pub(crate) receivers: Vec<usize>,
    pub(crate) transmitters: Vec<usize>,
}

/// The part of `m` receivers and `n` transmitters with the largest [`spread`]; the whole where it
/// has that size.
pub(crate) fn best(measured: &Pseudoranges, m: usize, n: usize) -> Subset {
    ranked(measured, m, n, 1).remove(0)
}

/// As many parts as [`best`] would be if the ones before were not there, one at least.
pub(crate) fn ranked(measured: &Pseudoranges, m: usize, n: usize, most: usize) -> Vec<Subset> {
    let all = combinations(measured.receivers(), m);
    let others = combinations(measured.transmitters(), n);
    let total = all.len() * others.len();
    // A stride over all pairs, in exact integers.
    let pair = |step: usize| (step as u128 * total as u128 / total.min(LOOKED_AT) as u128) as usize;
    let apart = |k: usize| spread(measured, &all[k / others.len()], &others[k % others.len()]);
    let mut parts: Vec<(f64, usize)> = (0..total.min(LOOKED_AT)).map(pair).map(|k| (apart(k), k)).collect();
    // The sort keeps the order of equal ones.
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    parts.truncate(most);
    let part = |&(_, k): &(f64, usize)| Subset {
        receivers: all[k / others.len()].clone(),
        transmitters: others[k % others.len()].clone(),
    };
    parts.iter().map(part).collect()
}

/// Subsets of `size` out of `count`, each ascending: all of them in lexicographic order if there
/// are at most [`LOOKED_AT`], otherwise that many, drawn at random, the same for the same sizes.
pub(crate) fn combinations(count: usize, size: usize) -> Vec<Vec<usize>> {
    let total = (0..size).try_fold(1usize, |t, k| Some(t.checked_mul(count - k)? / (k + 1)));
    if total.is_none_or(|t| t > LOOKED_AT) {
        let mut rng = Pcg64Mcg::seed_from_u64(count as u64);
        return (0..LOOKED_AT)
            .map(|_| {
                let mut chosen = sample(&mut rng, count, size).into_vec();
                chosen.sort_unstable();
                chosen
            })
            .collect();
    }
    let mut out = Vec::new();
    let mut chosen: Vec<usize> = (0..size).collect();
    loop {
        out.push(chosen.clone());
        let Some(k) = (0..size).rev().find(|&k| chosen[k] < count - size + k) else { return out };
        chosen[k] += 1;
        for i in k + 1..size {
            chosen[i] = chosen[i - 1] + 1;
        }
    }
}

/// The smallest difference between two rows (their common offset apart) or two columns: a bound
/// from below on how near two of the nodes are.
pub(crate) fn spread(measured: &Pseudoranges, receivers: &[usize], transmitters: &[usize]) -> f64 {
    let f = |i: usize, j: usize| measured.get(receivers[i], transmitters[j]).unwrap_or(f64::NAN);
    let (m, n) = (receivers.len(), transmitters.len());
    let mut least = f64::INFINITY;
    for a in 0..m {
        for b in a + 1..m {
            least = least.min((0..n).map(|j| (f(a, j) - f(b, j)).abs()).fold(0.0, f64::max));
        }
    }
    for a in 0..n {
        for b in a + 1..n {
            let differences = (0..m).map(|i| f(i, a) - f(i, b));
            let (low, high) = differences.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
            // Moving a transmitter by d changes its differences by at most 2 d.
            least = least.min(0.5 * (high - low));
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::{best, combinations};
    use crate::pseudoranges::Pseudoranges;

    #[test]
    fn combinations_are_all_or_many_and_valid() {
        assert_eq!(combinations(5, 3).len(), 10);
        assert_eq!(combinations(4, 4), [[0, 1, 2, 3]]);
        for (count, size) in [(30, 6), (1000, 4), (13, 6)] {
            let some = combinations(count, size);
            assert_eq!(some.len(), 400);
            assert!(some.iter().all(|c| c.len() == size && c.windows(2).all(|w| w[0] < w[1]) && c[size - 1] < count));
        }
    }

    #[test]
    fn coincident_nodes_are_avoided() {
        // Receivers 2 and 3 measure nearly the same.
        let f = vec![0.0, 0.0, 1.0, 2.0, 1.0, 2.001, 3.0, -1.0];
        let measured = Pseudoranges::new(4, 2, f).unwrap();
        let chosen = best(&measured, 3, 2);
        assert!(!(chosen.receivers.contains(&1) && chosen.receivers.contains(&2)), "{chosen:?}");
    }
}
