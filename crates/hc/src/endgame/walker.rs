//! One path in its endgame: which leg comes next, and when the endgame is over.

use super::ending::Ending;
use super::laurent::{Loop, Unclear};
use super::legs::Leg;
use super::options::EndgameOptions;
use crate::refine;
use crate::tolerances::endgame;
use num_complex::Complex64;

/// A polished point of a path.
pub(super) struct Sample {
    pub(super) point: Vec<Complex64>,
    /// Relative error.
    pub(super) accuracy: f64,
    /// How far each coordinate moves if the coefficients are rounded; empty within a loop, where that hardly
    /// changes.
    pub(super) blur: Vec<f64>,
}

/// A path on its way round smaller and smaller circles.
#[derive(Default)]
pub(super) struct Walker {
    path: usize,
    /// Where the path is: logarithmic time and point.
    at: f64,
    pub(super) x: Vec<Complex64>,
    radius: f64,
    /// Logarithmic time and point at which the endgame began.
    origin: (f64, Vec<Complex64>),
    /// Circles must be wider than this.
    deepest: f64,
    /// Samples of the loop, `x` the last of them, at the beginning of a turn; empty on a leg along the radius.
    samples: Vec<Complex64>,
    per_turn: usize,
    /// Turns after which the loop is given up, and the largest number ever.
    turns: usize,
    max_turns: usize,
    shrunk: u32,
    /// Steps of all legs so far.
    steps: usize,
    /// Whether the next leg leads to zero.
    going_home: bool,
    noise: f64,
    blur: Vec<f64>,
    /// How the path ends by a loop that was not quite clear.
    vague: Option<Ending>,
    /// How it goes to infinity by a clear loop, until it has been followed far out.
    diverges: Option<Ending>,
    /// Whether the equations have not been asked about that yet.
    is_unasked: bool,
    middle: Vec<Complex64>,
    end: Option<Ending>,
}

impl Walker {
    /// A path of this index that has come to the point `x` at `t > 0`.
    pub(super) fn new((path, t, x): (usize, f64, &[Complex64]), max_turns: usize, options: &EndgameOptions) -> Self {
        Walker {
            path,
            at: -t.ln(),
            x: x.to_vec(),
            radius: options.radius,
            origin: (-t.ln(), x.to_vec()),
            deepest: options.min_radius,
            per_turn: endgame::SAMPLES,
            turns: options.turns.min(max_turns).max(1),
            max_turns,
            ..Walker::default()
        }
    }

    pub(super) fn is_live(&self) -> bool {
        self.end.is_none()
    }

    /// The next leg, in logarithmic time.
    pub(super) fn leg(&self) -> Leg {
        if self.going_home {
            return Leg::Home((-self.at).exp());
        }
        let s = -self.radius.ln();
        if self.samples.is_empty() { Leg::Radial([self.at, s]) } else { Leg::Turn(s, self.per_turn) }
    }

    /// Takes the samples of the leg, one for each piece; none if the tracker failed on it.
    pub(super) fn advance(&mut self, mut samples: Vec<Sample>, options: &EndgameOptions) {
        let goes_home = std::mem::take(&mut self.going_home);
        if !samples.iter().flat_map(|sample| &sample.point).all(|z| z.is_finite()) {
            samples.clear();
        }
        let Some(end) = samples.pop() else {
            match (goes_home, self.samples.is_empty(), self.middle.is_empty()) {
                (true, ..) => {}
                (_, false, _) => self.shrink(options),
                (.., true) => self.widen(),
                _ => self.lose(),
            }
            return;
        };
        if goes_home {
            self.end = Some(Ending::Open { t: 0.0, point: end.point });
        } else if self.samples.is_empty() {
            self.arrive(end, options);
        } else {
            for sample in samples.iter().chain([&end]) {
                self.noise = self.noise.max(sample.accuracy);
            }
            self.samples.extend(samples.iter().flat_map(|sample| &sample.point));
            self.turn(&end.point, options);
        }
    }

    /// Counts the steps of a leg. A path that is not over after `limit` steps in all is given up.
    pub(super) fn spend(&mut self, steps: usize, limit: usize) {
        self.steps = self.steps.saturating_add(steps);
        if self.is_live() && self.steps > limit {
            self.lose();
        }
    }

    /// At the end of a leg along the radius.
    fn arrive(&mut self, Sample { point, accuracy, blur }: Sample, options: &EndgameOptions) {
        if self.goes_on_to_infinity(&point)
            && let Some(end) = self.diverges.take()
        {
            return self.settle(end);
        }
        if self.radius == options.radius && self.middle.is_empty() {
            self.middle = point.clone();
        }
        let largest = largest(&point);
        let blurred = |share: f64| point.iter().zip(&blur).any(|(z, b)| *b > share * size(z).max(1e-4 * largest));
        if self.diverges.is_none()
            && blurred(endgame::SHARP)
            && self.widen_to().is_some_and(|wider| wider <= options.start)
        {
            self.widen();
            return;
        }
        if blurred(endgame::HOPELESS) {
            self.lose();
            return;
        }
        let s = -self.radius.ln();
        if (s - self.at).abs() > 1.0 && self.shrunk == 0 {
            self.per_turn = samples_for(steepest(&self.x, &point, s - self.at));
        }
        self.at = s;
        self.noise = accuracy.max(4.0 * f64::EPSILON);
        self.blur = blur;
        self.x.clone_from(&point);
        self.samples = point;
    }

    /// The next wider radius, if it is not beyond the point at which the endgame began.
    fn widen_to(&self) -> Option<f64> {
        let start = (-self.origin.0).exp();
        (self.radius < start).then(|| (10.0 * self.radius).min(start))
    }

    /// Goes from the point at which the endgame began to a wider circle than the one that was too
    /// deep.
    fn widen(&mut self) {
        match self.widen_to().filter(|_| self.diverges.is_none()) {
            Some(radius) => {
                self.deepest = self.radius;
                self.radius = radius;
                self.at = self.origin.0;
                self.x.clone_from(&self.origin.1);
            }
            None => self.lose(),
        }
    }

    /// At the end of a turn.
    fn turn(&mut self, end: &[Complex64], options: &EndgameOptions) {
        let n = self.x.len();
        let winding = self.samples.len() / n / self.per_turn;
        let first = &self.samples[..n];
        let gap = distance(first, end);
        let spread = self.samples.chunks(n).map(|x| distance(first, x)).fold(0.0, f64::max);
        if gap <= endgame::CLOSED.max(100.0 * self.noise).max(1e-7 * spread) {
            let all = Loop { n, per_turn: self.per_turn, samples: &self.samples, noise: self.noise, blur: &self.blur };
            match all.read(endgame::CLEAR) {
                Err(Unclear::TooWide) => {
                    let vague = all.read(endgame::VAGUE).ok().map(reduced);
                    self.suppose(vague);
                    self.shrink(options);
                }
                Err(Unclear::TooDeep) => self.lose(),
                Ok(end) => self.conclude(end),
            }
        } else if winding >= self.turns {
            self.shrink(options);
        } else {
            self.samples.extend_from_slice(end);
            self.x.copy_from_slice(end);
        }
    }

    /// At the end of a clear loop. Where a coefficient is small, a solution is large, and at first its path seems to go
    /// to infinity.
    fn conclude(&mut self, end: Ending) {
        let Ending::Infinite { valuations, winding } = &end else { return self.settle(end) };
        if let Some(before) = self.diverges.take() {
            // Far out, coordinates that vanish may be too small to be seen.
            return self.settle(before);
        }
        let steepest = valuations.iter().map(|v| v.unsigned_abs()).max().unwrap_or(1) as f64 / *winding as f64;
        let n = self.x.len();
        let first = &self.samples[..n];
        let radius = self.radius * (endgame::FAR / largest(first).max(1.0)).powf(-1.0 / steepest);
        if radius >= self.radius {
            return self.settle(end);
        }
        self.x.copy_from_slice(first);
        self.samples.clear();
        self.radius = radius.max(endgame::LEAST_RADIUS);
        self.is_unasked = true;
        self.diverges = Some(end);
    }

    /// Time and point of a path that goes to infinity by a loop, if the equations have not been asked about it.
    pub(super) fn claim(&self) -> Option<(f64, &[Complex64])> {
        self.is_unasked.then_some((self.at, &self.x))
    }

    /// Takes what the equations say of that: whether their leading terms cancel. If they do not, the path is followed
    /// until it is very far out.
    pub(super) fn judge(&mut self, cancels: bool) {
        self.is_unasked = false;
        if cancels && let Some(end) = self.diverges.take() {
            self.settle(end);
        }
    }

    /// Whether a path that goes to infinity by a loop has grown as that says up to a point far out.
    fn goes_on_to_infinity(&self, far: &[Complex64]) -> bool {
        let Some(Ending::Infinite { valuations, winding }) = &self.diverges else { return false };
        let ds = -self.radius.ln() - self.at;
        let grown = |((&v, a), b): ((&i64, &Complex64), &Complex64)| {
            let expected = -v as f64 * ds / *winding as f64;
            v >= 0 || ((size(b) / size(a)).ln() - expected).abs() <= 1.0 + endgame::GROWN * expected
        };
        valuations.iter().zip(&self.x).zip(far).all(grown)
    }

    /// Notes how the path ends by a loop that is not quite clear. If there are several, the first counts,
    /// but all loops must agree that a path diverges.
    fn suppose(&mut self, vague: Option<Ending>) {
        let diverges = |vague: &Option<Ending>| matches!(vague, Some(Ending::Infinite { .. }));
        if self.vague.is_none() && (self.shrunk == 0 || !diverges(&vague)) {
            self.vague = vague;
        } else if diverges(&self.vague) && self.vague != vague {
            self.vague = vague.filter(|end| matches!(end, Ending::Singular(_)));
        }
    }

    /// Goes back to where the loop began and on to a smaller one.
    fn shrink(&mut self, options: &EndgameOptions) {
        if self.diverges.is_some() {
            return self.lose();
        }
        let n = self.x.len();
        self.x.copy_from_slice(&self.samples[..n]);
        self.samples.clear();
        self.shrunk += 1;
        self.going_home = self.shrunk == endgame::STRAIGHT_AFTER;
        self.turns = self.turns.saturating_mul(2).min(self.max_turns).max(1);
        // Circles that never shrink would never end.
        let shrink = options.shrink.max(endgame::LEAST_SHRINK);
        // Where a deeper circle was too deep already: one halfway there.
        let halfway = (self.radius * self.deepest).sqrt();
        if self.radius / shrink > self.deepest {
            self.radius /= shrink;
        } else if self.deepest > options.min_radius && self.radius > 2.0 * halfway {
            self.radius = halfway;
        } else if self.per_turn < endgame::MOST_SAMPLES_WIDE {
            // No smaller circle will do: once more with more samples, which may also stand a
            // singularity not far outside.
            self.per_turn *= 2;
        } else {
            self.lose();
        }
    }

    /// Ends the path without a clear loop, as a vague one says if there was one. What a clear loop has said does not
    /// count if the equations deny it.
    fn lose(&mut self) {
        let vague = self.vague.take().filter(|_| self.diverges.is_none());
        self.settle(vague.unwrap_or(Ending::Lost));
    }

    fn settle(&mut self, end: Ending) {
        self.going_home = false;
        self.end = Some(end);
    }

    /// The index of the path, its end, and its point at the first radius.
    pub(super) fn ended(self) -> (usize, Ending, Vec<Complex64>) {
        (self.path, self.end.unwrap_or(Ending::Lost), self.middle)
    }
}

/// A direction to infinity in lowest terms. Branch points within a loop make it unclear. They can
/// join cycles that go the same way, and only the winding number of one of these is of interest.
fn reduced(end: Ending) -> Ending {
    let Ending::Infinite { valuations, winding } = end else { return end };
    let common = valuations.iter().fold(winding as u64, |divisor, v| gcd(v.unsigned_abs(), divisor)).max(1);
    let valuations = valuations.into_iter().map(|v| v / common as i64).collect();
    Ending::Infinite { valuations, winding: winding / common as usize }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Absolute value; `norm` takes many times longer, to be right for numbers beyond 1e154 too.
fn size(z: &Complex64) -> f64 {
    z.norm_sqr().sqrt()
}

fn largest(x: &[Complex64]) -> f64 {
    x.iter().map(Complex64::norm_sqr).fold(0.0, f64::max).sqrt()
}

/// Relative distance of two points of a path. Each coordinate is measured by its own size, because
/// cycles may differ only in the small ones.
fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let largest = largest(a).max(largest(b));
    a.iter().zip(b).map(|(a, b)| size(&(a - b)) / refine::size(size(a).max(size(b)), largest)).fold(0.0, f64::max)
}

/// The largest valuation in size, from points `ds` apart in logarithmic time; coordinates that may
/// be rounding error are left out.
fn steepest(from: &[Complex64], to: &[Complex64], ds: f64) -> f64 {
    let floor = |x: &[Complex64]| 1e-12 * largest(x).min(1.0);
    let (a, b) = (floor(from), floor(to));
    let sizes = from.iter().zip(to).map(|(x, y)| (size(x), size(y)));
    let clear = sizes.filter(|(x, y)| *x > a && *y > b);
    clear.map(|(x, y)| ((y / x).ln() / ds).abs()).fold(0.0, f64::max)
}

/// Samples per turn that separate powers up to `steepest` from their aliases, with room for the
/// decay beyond them.
fn samples_for(steepest: f64) -> usize {
    let mut samples = endgame::SAMPLES;
    while samples < endgame::MOST_SAMPLES && steepest > 0.25 * samples as f64 + 0.25 {
        samples *= 2;
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::{Ending, distance, reduced};
    use num_complex::Complex64;

    #[test]
    fn directions_in_lowest_terms() {
        let infinite = |winding, valuations: &[i64]| Ending::Infinite { winding, valuations: valuations.to_vec() };
        let lowest = |winding, valuations| reduced(infinite(winding, valuations));
        assert_eq!(lowest(12, &[2, 0, -2]), infinite(6, &[1, 0, -1]));
        assert_eq!(lowest(2, &[-2, 3]), infinite(2, &[-2, 3]));
        assert_eq!(lowest(1, &[-4, 2]), infinite(1, &[-4, 2]));
    }

    #[test]
    fn small_coordinates_count() {
        let z = |re| Complex64::new(re, 0.0);
        assert_eq!(distance(&[z(1e6), z(1e-9)], &[z(1e6), z(-1e-9)]), 2.0);
        // One below a share of 1e-12 counts as zero.
        assert!(distance(&[z(1.0), z(1e-13)], &[z(1.0), z(-1e-13)]) < 1e-8);
    }
}
