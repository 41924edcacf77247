//! The offset between two recorders at which most of their sounds coincide.
//!
//! If their sounds had nothing in common, the differences of their times would be spread evenly over any short stretch.
//! The offset is where so many lie together that this is least likely by chance, among all widths and rates that are
//! tried (A. Desolneux, L. Moisan and J.-M. Morel, From Gestalt Theory to Image Analysis, 2008: detection a contrario).

/// Fewest sounds that must coincide.
pub(super) const LEAST: usize = 4;

/// How many such coincidences chance may bring forth between two recorders that hear different sounds.
const CHANCE: f64 = 1e-3;

/// Which share of the sounds another offset explains if the first one is not certain, without those that chance does.
const AMBIGUOUS: f64 = 2.0 / 3.0;

/// How much more certain than another one the first offset must be, as the logarithm of a probability. Of sounds at regular
/// times as many coincide at several offsets, but for some that stray: each of these counts about 3.
const CERTAIN: f64 = 7.0;

/// Half widths in which differences are counted: the tolerance, and this many halves of it down to what onsets allow,
/// seconds.
const HALVES: i32 = 3;
const NARROWEST: f64 = 5e-3;

/// Rates that are tried to either side of zero at most.
const RATES: f64 = 64.0;

/// How many half widths to either side, at least, tell how many differences lie together by chance, and how much wider the
/// next stretch is that does.
const AROUND: f64 = 32.0;
const WIDER: f64 = 4.0;

/// The offset between two recorders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coincidence {
    /// A time by the clock of the second, and by that of the first, seconds.
    pub(super) from: f64,
    pub(super) to: f64,
    /// How much the clock of the first is fast beside the second, a share.
    pub(super) rate: f64,
    /// By how much more the first clock reads at another offset that explains about as many sounds, seconds.
    pub(super) rival: Option<f64>,
}

/// The offset at which most sounds of two recorders coincide to `tolerance` seconds, if not by chance. Times are in order,
/// those of one recorder further apart than twice the tolerance; the rates of both clocks differ by at most `most`, a share.
pub(super) fn coincidence(a: &[f64], b: &[f64], tolerance: f64, most: f64) -> Option<Coincidence> {
    let middle = 0.5 * (b.first()? + b.last()?);
    let widths: Vec<f64> = (0..=HALVES).map(|k| tolerance * 0.5_f64.powi(k)).collect();
    let widths: Vec<f64> = widths.iter().copied().filter(|&w| w >= NARROWEST || w == tolerance).collect();
    // Between two rates that are tried, the drift to the ends is less than half of the smallest width.
    let drift = most * (b.last()? - middle) / widths.last()?;
    let steps = (2.0 * drift - 0.5).ceil().clamp(0.0, RATES);
    let step = most / (steps + 0.5);
    let tests = (2.0 * steps + 1.0) * widths.len() as f64 * (a.len() * b.len()) as f64;
    // What coincides by chance is exceeded by this, or nothing is found.
    let least = tests.ln() - CHANCE.ln();
    let mut best: Option<(Window, f64, f64)> = None;
    let mut differences = Differences::new(a, b, middle, -steps * step);
    for k in -(steps as i32)..=steps as i32 {
        let rate = f64::from(k) * step;
        for &width in &widths {
            let known = best.map_or(least, |(window, ..)| window.surprise());
            if let Some(window) = differences.best(width, known, Window::surprise, |window| window.count >= LEAST) {
                best = Some((window, width, rate));
            }
        }
        differences.turn(step);
    }
    let (window, width, rate) = best?;
    let differences = Differences::new(a, b, middle, rate);
    let is_other = |other: &Window| (other.middle - window.middle).abs() > 2.0 * tolerance;
    let mut rival = differences.best(width, AMBIGUOUS * window.excess(), Window::excess, is_other);
    for &width in &widths {
        let known = rival.map_or(0.0, |rival| rival.surprise()).max(window.surprise() - CERTAIN);
        rival = differences.best(width, known, Window::surprise, is_other).or(rival);
    }
    let rival = rival.map(|other| other.middle - window.middle);
    Some(Coincidence { from: middle, to: window.middle, rate, rival })
}

/// At least the amount of the logarithm of the probability of so many by chance where this many are expected: the bound of
/// Chernoff for a Poisson distribution.
pub(super) fn surprise(count: f64, expected: f64) -> f64 {
    if count > expected { count * (count / expected).ln() - count + expected } else { 0.0 }
}

/// Differences that lie together.
#[derive(Debug, Clone, Copy)]
struct Window {
    /// The middle one, seconds.
    middle: f64,
    count: usize,
    /// How many would lie there by chance.
    expected: f64,
}

impl Window {
    /// How surprising so many are. A window begins at a difference, which does not count.
    fn surprise(&self) -> f64 {
        surprise(self.count as f64 - 1.0, self.expected)
    }

    /// How many chance does not explain.
    fn excess(&self) -> f64 {
        self.count as f64 - self.expected
    }
}

/// The differences between all sounds of two recorders, in order, each with the time of the second from the middle.
struct Differences(Vec<(f64, f64)>);

impl Differences {
    fn new(a: &[f64], b: &[f64], middle: f64, rate: f64) -> Differences {
        let by_second = |&y: &f64| a.iter().map(move |x| (x - (1.0 + rate) * (y - middle), y - middle));
        let mut all: Vec<(f64, f64)> = b.iter().flat_map(by_second).collect();
        all.sort_by(|p, q| p.0.total_cmp(&q.0));
        Differences(all)
    }

    /// Goes to a rate that is larger by a step. That moves few past each other: they are put in order one by one.
    fn turn(&mut self, step: f64) {
        for place in 0..self.0.len() {
            let (difference, at) = self.0[place];
            let moved = (difference - step * at, at);
            let mut to = place;
            while to > 0 && self.0[to - 1].0 > moved.0 {
                self.0[to] = self.0[to - 1];
                to -= 1;
            }
            self.0[to] = moved;
        }
    }

    /// Of all stretches of twice this width that begin at a difference, the one of most value, if that is above `least`.
    /// The value falls with what is expected.
    fn best(
        &self,
        width: f64,
        mut least: f64,
        value: impl Fn(&Window) -> f64,
        is_allowed: impl Fn(&Window) -> bool,
    ) -> Option<Window> {
        let all = &self.0;
        let span = self.span(width);
        let (mut fewest, mut best) = (1, None);
        for begin in 0..all.len() {
            let end = all[begin].0 + 2.0 * width;
            // Most stretches have too few: they are not counted.
            if all.get(begin + fewest - 1).is_none_or(|last| last.0 > end) {
                continue;
            }
            let more = all[begin + fewest..].iter().take_while(|difference| difference.0 <= end).count();
            let count = fewest + more;
            let everywhere = self.density(count, all.len(), span, width);
            let mut window = Window { middle: all[begin + count / 2].0, count, expected: 2.0 * width * everywhere };
            // Around the stretch there may be more, not fewer, than everywhere.
            if value(&window) <= least {
                fewest = count + 1;
            } else if is_allowed(&window) {
                window.expected = 2.0 * width * self.densest(&window, everywhere, span, width);
                if value(&window) > least {
                    (least, best) = (value(&window), Some(window));
                }
            }
        }
        best
    }

    /// From the first difference to the last one, at least the stretch.
    fn span(&self, width: f64) -> f64 {
        let ends = self.0.first().zip(self.0.last());
        ends.map_or(0.0, |(first, last)| last.0 - first.0).max(2.0 * width)
    }

    /// How many differences there are a second by chance, if `within` are in a time of which the stretch has `count`.
    fn density(&self, count: usize, within: usize, time: f64, width: f64) -> f64 {
        let others = within.saturating_sub(count) as f64 / (time - 2.0 * width).max(width);
        // There may always be one somewhere.
        others.max(1.0 / self.span(width))
    }

    /// The greatest density in any time around the stretch.
    fn densest(&self, window: &Window, everywhere: f64, span: f64, width: f64) -> f64 {
        let all = &self.0;
        let (Some(first), Some(last)) = (all.first(), all.last()) else { return everywhere };
        let (mut densest, mut around) = (everywhere, AROUND * width);
        while around < span {
            let (low, high) = ((window.middle - around).max(first.0), (window.middle + around).min(last.0));
            let within = all.partition_point(|x| x.0 <= high) - all.partition_point(|x| x.0 < low);
            densest = densest.max(self.density(window.count, within, high - low, width));
            around *= WIDER;
        }
        densest
    }
}
