//! Two recorders that heard the same sounds.

use super::coincidence::coincidence;
use super::line::Line;

/// Rounds in which sounds are matched by a line, and the line is fitted to them.
const ROUNDS: usize = 3;

/// How the clocks of two recorders go beside each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    /// The two, the first one first.
    pub(super) recorders: [usize; 2],
    /// The clock of the second beside that of the first.
    pub(super) line: Line,
    /// The numbers of the sounds of each that are the same.
    pub(super) matches: Vec<[usize; 2]>,
    /// Another offset that explains about as many sounds.
    pub(super) rival: Option<Rival>,
}

/// Another offset between two recorders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rival {
    /// By how much more the clock of the first reads, seconds.
    pub(super) later: f64,
    /// How many sounds are the same then.
    pub(super) matched: usize,
}

impl Pair {
    /// The two recorders of these sounds, if these coincide to `tolerance` seconds at some offset better than by chance.
    /// `max_rate`: by how much a clock may be fast or slow, a share.
    pub(super) fn new(recorders: [usize; 2], sounds: [&[f64]; 2], tolerance: f64, max_rate: f64) -> Option<Pair> {
        let [a, b] = sounds;
        let found = coincidence(a, b, tolerance, 2.0 * max_rate)?;
        let (from, to, rate) = (found.from, found.to, found.rate);
        let mut line = Line { from, to, rate, ..Line::same() };
        let mut matches = Vec::new();
        for _ in 0..ROUNDS {
            matches = matched(a, b, &line, tolerance);
            let points: Vec<(f64, f64)> = matches.iter().map(|&[i, j]| (b[j], a[i])).collect();
            line = Line::fit(&points, max_rate)?;
        }
        let rival = found.rival.map(|later| {
            let other = Line { to: line.to + later, ..line };
            Rival { later, matched: matched(a, b, &other, tolerance).len() }
        });
        Some(Pair { recorders, line, matches, rival })
    }

    /// When a recorder of the pair was started by the clock of the other one, if that clock read `later` seconds more than the
    /// line says.
    pub(super) fn start(&self, recorder: usize, later: f64) -> f64 {
        if self.recorders[1] == recorder { self.line.at(0.0) + later } else { self.line.inverse(-later) }
    }

    /// The recorder that is with this one, if that is in the pair.
    pub(super) fn other(&self, recorder: usize) -> Option<usize> {
        let [a, b] = self.recorders;
        if recorder == a { Some(b) } else { (recorder == b).then_some(a) }
    }
}

/// The sounds that are the same by this line. At most one is so near to each: sounds of a recorder are further apart.
pub(super) fn matched(a: &[f64], b: &[f64], line: &Line, tolerance: f64) -> Vec<[usize; 2]> {
    let mut matches = Vec::new();
    let mut i = 0;
    for (j, &y) in b.iter().enumerate() {
        let expected = line.at(y);
        while a.get(i).is_some_and(|&x| x < expected - tolerance) {
            i += 1;
        }
        if a.get(i).is_some_and(|&x| x <= expected + tolerance) {
            matches.push([i, j]);
            i += 1;
        }
    }
    matches
}
