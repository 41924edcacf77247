//! The clocks of a group of recorders by all matches together.

use crate::quantile::quantile;

use super::line::Line;
use super::pair::Pair;

/// Rounds in which each clock is fitted to all others.
const ROUNDS: usize = 20;

/// The clock of a recorder beside the reference.
pub(super) struct Clock {
    pub(super) line: Line,
    /// How many sounds match those of others.
    pub(super) matched: usize,
}

/// The clocks of recorders that hang together by pairs, beside the first; `sounds` are those of all recorders, and
/// `max_rate` says by how much a clock may be fast or slow, a share.
///
/// Each clock is fitted to the middle of the others. None is fixed meanwhile: errors of a fixed one would have to pass
/// through all others, one round after the other.
pub(super) fn adjust(group: &[usize], pairs: &[Pair], sounds: &[Vec<f64>], max_rate: f64) -> Vec<Clock> {
    let mut lines = along_tree(group, pairs, sounds.len());
    let partners: Vec<Vec<Vec<[usize; 2]>>> = group.iter().map(|&recorder| partners(recorder, pairs, sounds)).collect();
    for _ in 0..ROUNDS {
        for (&recorder, partners) in group.iter().zip(&partners) {
            let of = partners.iter().zip(&sounds[recorder]);
            let middle = |partners: &[[usize; 2]]| {
                quantile(partners.iter().map(|&[r, k]| lines[r].at(sounds[r][k])).collect(), 0.5)
            };
            let points: Vec<(f64, f64)> = of.filter_map(|(partners, &x)| Some((x, middle(partners)?))).collect();
            if let Some(line) = Line::fit(&points, max_rate) {
                lines[recorder] = line;
            }
        }
    }
    let Some(reference) = group.first().map(|&first| lines[first]) else { return Vec::new() };
    let clock = |(&recorder, partners): (&usize, &Vec<Vec<[usize; 2]>>)| {
        let matched = partners.iter().filter(|partners| !partners.is_empty()).count();
        let line = lines[recorder];
        let beside = if recorder == group[0] {
            Line { scatter: line.scatter, ..Line::same() }
        } else {
            let rate = (1.0 + line.rate) / (1.0 + reference.rate) - 1.0;
            Line {
                to: reference.inverse(line.to),
                rate,
                rate_sigma: line.rate_sigma.hypot(reference.rate_sigma),
                ..line
            }
        };
        Clock { line: beside, matched }
    };
    group.iter().zip(&partners).map(clock).collect()
}

/// The clock of each recorder by the pairs with most matches that lead to it from the first of the group.
fn along_tree(group: &[usize], pairs: &[Pair], count: usize) -> Vec<Line> {
    let mut lines = vec![Line::same(); count];
    let mut is_known = vec![false; count];
    if let Some(&first) = group.first() {
        is_known[first] = true;
    }
    let mut order: Vec<&Pair> = pairs.iter().collect();
    order.sort_by_key(|pair| std::cmp::Reverse(pair.matches.len()));
    // The strongest pair that leads on from what is known, until none does.
    while let Some(pair) = order.iter().find(|pair| is_known[pair.recorders[0]] != is_known[pair.recorders[1]]) {
        let [a, b] = pair.recorders;
        let (known, new) = if is_known[a] { (a, b) } else { (b, a) };
        let line = if new == b { pair.line } else { turned(&pair.line) };
        let (outer, to) = (lines[known], lines[known].at(line.to));
        lines[new] = Line { to, rate: (1.0 + outer.rate) * (1.0 + line.rate) - 1.0, ..line };
        is_known[new] = true;
    }
    lines
}

/// The first clock beside the second.
fn turned(line: &Line) -> Line {
    Line { from: line.to, to: line.from, rate: 1.0 / (1.0 + line.rate) - 1.0, ..*line }
}

/// For each sound of a recorder, the recorder and the number of each sound that it matches.
fn partners(recorder: usize, pairs: &[Pair], sounds: &[Vec<f64>]) -> Vec<Vec<[usize; 2]>> {
    let mut all = vec![Vec::new(); sounds[recorder].len()];
    for pair in pairs {
        let [a, b] = pair.recorders;
        for &[i, j] in &pair.matches {
            if a == recorder {
                all[i].push([b, j]);
            } else if b == recorder {
                all[j].push([a, i]);
            }
        }
    }
    all
}
