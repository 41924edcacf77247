//! Whether three recorders agree, and which recorders hang together.

use std::collections::{HashMap, HashSet};

use super::pair::Pair;

/// Standard deviations of drift that two ways may differ by.
const DRIFTS: f64 = 3.0;

/// A pair of recorders that was taken out because others contradict it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contradicted {
    /// The two and a third one, by which they should be otherwise, in their order.
    pub(super) recorders: [usize; 3],
    /// By how much, seconds.
    pub(super) seconds: f64,
}

/// Takes out the pairs that do not agree with the others of most triangles, and says which these were. Of pairs about which
/// there is equally much doubt none stays: which is wrong cannot be told.
pub(super) fn take_out_contradicted(pairs: &mut Vec<Pair>, tolerance: f64) -> Vec<Contradicted> {
    let mut triangles = triangles(pairs, tolerance);
    let (mut is_out, mut out) = (vec![false; pairs.len()], Vec::new());
    loop {
        // How many more triangles of a pair do not close than do.
        let mut doubts = vec![0_i64; pairs.len()];
        let mut is_doubtful = vec![false; pairs.len()];
        for triangle in &triangles {
            for &pair in &triangle.pairs {
                doubts[pair] += if triangle.closes { -1 } else { 1 };
                is_doubtful[pair] |= !triangle.closes;
            }
        }
        let Some(most) = (0..pairs.len()).filter(|&k| is_doubtful[k]).map(|k| doubts[k]).max() else { break };
        let worst = |k: usize| is_doubtful[k] && doubts[k] == most;
        for triangle in triangles.iter().filter(|triangle| !triangle.closes) {
            for &k in triangle.pairs.iter().filter(|&&k| worst(k)) {
                if !is_out[k] {
                    is_out[k] = true;
                    out.push(Contradicted { recorders: triangle.recorders, seconds: triangle.gap });
                }
            }
        }
        triangles.retain(|triangle| triangle.pairs.iter().all(|&k| !is_out[k]));
    }
    let mut is_in = is_out.into_iter().map(|is_out| !is_out);
    pairs.retain(|_| is_in.next().unwrap_or(true));
    out
}

struct Triangle {
    /// In their order.
    recorders: [usize; 3],
    pairs: [usize; 3],
    /// By how much the ways differ, seconds.
    gap: f64,
    closes: bool,
}

/// All triangles of pairs, whose first recorder is before the second one.
fn triangles(pairs: &[Pair], tolerance: f64) -> Vec<Triangle> {
    let place: HashMap<[usize; 2], usize> = pairs.iter().zip(0..).map(|(pair, k)| (pair.recorders, k)).collect();
    let mut later: HashMap<usize, Vec<usize>> = HashMap::new();
    for pair in pairs {
        later.entry(pair.recorders[0]).or_default().push(pair.recorders[1]);
    }
    let mut found = Vec::new();
    for (first, pair) in pairs.iter().enumerate() {
        let [a, b] = pair.recorders;
        for &c in later.get(&b).into_iter().flatten() {
            let Some(&across) = place.get(&[a, c]) else { continue };
            let Some(&second) = place.get(&[b, c]) else { continue };
            // From the last to the first one directly, and by the one between, where the direct way is known best.
            let (ab, bc, ac) = (&pair.line, &pairs[second].line, &pairs[across].line);
            let x = ac.from;
            let gap = (ab.at(bc.at(x)) - ac.at(x)).abs();
            // Each pair is wrong by as much as sound takes, at most, and by what its rate does.
            let allowed = 3.0 * tolerance + DRIFTS * (bc.drift(x) + ab.drift(bc.at(x)));
            found.push(Triangle { recorders: [a, b, c], pairs: [first, second, across], gap, closes: gap <= allowed });
        }
    }
    found
}

/// The largest group of these recorders that hang together by pairs; of equally large ones the one that has the first.
pub(super) fn largest_group(recorders: &[usize], pairs: &[Pair]) -> Vec<usize> {
    let mut partners: HashMap<usize, Vec<usize>> = HashMap::new();
    for pair in pairs {
        let [a, b] = pair.recorders;
        partners.entry(a).or_default().push(b);
        partners.entry(b).or_default().push(a);
    }
    let mut is_seen = HashSet::new();
    let mut largest = Vec::new();
    for &begin in recorders {
        let mut group = Vec::new();
        let mut next = vec![begin];
        while let Some(recorder) = next.pop() {
            if is_seen.insert(recorder) {
                group.push(recorder);
                next.extend(partners.get(&recorder).into_iter().flatten());
            }
        }
        if group.len() > largest.len() {
            largest = group;
        }
    }
    largest.sort_unstable();
    largest
}
