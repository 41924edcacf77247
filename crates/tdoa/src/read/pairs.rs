//! Differences of the times of two receivers, made into times: for each transmitter those that agree
//! with its differences best, by least squares. They are known up to a constant, which belongs to the
//! transmitter's offset.

use std::collections::{BTreeMap, BTreeSet};

/// Differences by transmitter: of each the two receivers, and the time of the first minus that of the
/// second.
#[derive(Default)]
pub(super) struct Pairs {
    of: BTreeMap<usize, Vec<([usize; 2], f64)>>,
    count: usize,
}

impl Pairs {
    pub(super) fn add(&mut self, transmitter: usize, receivers: [usize; 2], difference: f64) {
        self.of.entry(transmitter).or_default().push((receivers, difference));
        self.count += 1;
    }

    /// How many differences there are.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The times: receiver, transmitter and time.
    ///
    /// # Errors
    /// For a receiver that is compared with itself, and for receivers that no differences connect.
    pub(super) fn times(
        &self,
        receivers: &[String],
        transmitters: &[String],
    ) -> Result<Vec<(usize, usize, f64)>, String> {
        let mut all = Vec::new();
        for (&j, differences) in &self.of {
            let event = &transmitters[j];
            if let Some(([a, _], _)) = differences.iter().find(|([a, b], _)| a == b) {
                return Err(format!(
                    "transmitter {event}: receiver {} is compared with itself; leave that out",
                    receivers[*a]
                ));
            }
            let heard: BTreeSet<usize> = differences.iter().flat_map(|(pair, _)| *pair).collect();
            let heard: Vec<usize> = heard.into_iter().collect();
            let place = |i: usize| heard.binary_search(&i).unwrap_or_default();
            let local: Vec<([usize; 2], f64)> =
                differences.iter().map(|([a, b], value)| ([place(*a), place(*b)], *value)).collect();
            if let Some(k) = apart(heard.len(), &local) {
                return Err(format!(
                    "transmitter {event}: no differences connect receiver {} with {}, so that their times cannot be compared; \
                     give one transmitter for each group of receivers, or more differences",
                    receivers[heard[k]], receivers[heard[0]]
                ));
            }
            let times = least_squares(heard.len(), &local);
            all.extend(heard.iter().zip(times).map(|(&i, time)| (i, j, time)));
        }
        Ok(all)
    }
}

/// A node that no differences connect with the first, if there is one.
fn apart(nodes: usize, differences: &[([usize; 2], f64)]) -> Option<usize> {
    let mut neighbours = vec![Vec::new(); nodes];
    for ([a, b], _) in differences {
        neighbours[*a].push(*b);
        neighbours[*b].push(*a);
    }
    let mut seen = vec![false; nodes];
    let mut open = vec![0];
    while let Some(node) = open.pop() {
        if !std::mem::replace(&mut seen[node], true) {
            open.extend(neighbours[node].iter().filter(|&&next| !seen[next]));
        }
    }
    seen.iter().position(|seen| !seen)
}

/// The numbers, of mean zero, whose differences fit best: conjugate gradients on the normal equations,
/// whose matrix is the Laplacian of the graph of differences.
fn least_squares(nodes: usize, differences: &[([usize; 2], f64)]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut residual = vec![0.0; nodes];
    for ([a, b], value) in differences {
        residual[*a] += value;
        residual[*b] -= value;
    }
    let laplacian = |x: &[f64]| {
        let mut y = vec![0.0; nodes];
        for ([a, b], _) in differences {
            y[*a] += x[*a] - x[*b];
            y[*b] += x[*b] - x[*a];
        }
        y
    };
    let mut found = vec![0.0; nodes];
    let mut direction = residual.clone();
    let mut size = dot(&residual, &residual);
    let enough = 1e-30 * size;
    // Exact arithmetic needs as many steps as there are nodes.
    for _ in 0..4 * nodes {
        let image = laplacian(&direction);
        let curvature = dot(&direction, &image);
        if size <= enough || curvature <= 0.0 {
            break;
        }
        let step = size / curvature;
        for k in 0..nodes {
            found[k] += step * direction[k];
            residual[k] -= step * image[k];
        }
        let next = dot(&residual, &residual);
        for k in 0..nodes {
            direction[k] = residual[k] + next / size * direction[k];
        }
        size = next;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(kind: &str, count: usize) -> Vec<String> {
        (1..=count).map(|k| format!("{kind}{k}")).collect()
    }

    #[test]
    fn times_come_back_from_their_differences() {
        let times = [0.25, -3.5, 12.0, 7.0, 1.0];
        let stars: Vec<[usize; 2]> = (1..5).map(|k| [k, 0]).collect();
        let chain: Vec<[usize; 2]> = (1..5).map(|k| [k - 1, k]).collect();
        let all: Vec<[usize; 2]> = (0..5).flat_map(|a| (0..a).map(move |b| [a, b])).collect();
        for graph in [stars, chain, all] {
            let mut pairs = Pairs::default();
            for [a, b] in &graph {
                pairs.add(0, [*a, *b], times[*a] - times[*b]);
            }
            let found = pairs.times(&names("m", 5), &names("e", 1)).unwrap();
            let shift = found[0].2 - times[0];
            for (k, (i, j, time)) in found.iter().enumerate() {
                assert!((*i, *j) == (k, 0) && (time - shift - times[k]).abs() < 1e-12, "{graph:?}: {found:?}");
            }
        }
    }

    /// The mean of two routes: 1 directly, 2 by the third receiver, with weights 2 and 1.
    #[test]
    fn differences_that_disagree_are_balanced() {
        let mut pairs = Pairs::default();
        for (pair, value) in [([1, 0], 1.0), ([1, 2], 1.0), ([2, 0], 1.0)] {
            pairs.add(3, pair, value);
        }
        let found = pairs.times(&names("m", 3), &names("e", 4)).unwrap();
        assert!((found[1].2 - found[0].2 - 4.0 / 3.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn receivers_that_nothing_connects_are_named() {
        let mut pairs = Pairs::default();
        pairs.add(0, [0, 1], 1.0);
        pairs.add(0, [2, 3], 1.0);
        let said = pairs.times(&names("m", 4), &names("e", 1)).unwrap_err();
        assert!(said.contains("receiver m3 with m1") && said.contains("transmitter e1"), "{said}");
        let mut pairs = Pairs::default();
        pairs.add(0, [2, 2], 0.0);
        assert!(pairs.times(&names("m", 4), &names("e", 1)).unwrap_err().contains("m3 is compared with itself"));
    }
}
