//! The end of paths that do not end at a regular solution.
//!
//! Near `t = 0` such a path is a Puiseux series in `t`, as far as is known yet. The endgame is
//! Cauchy's (Morgan, Sommese & Wampler 1991). It tracks the path in logarithmic time `s = -ln t`,
//! in which steps need not shrink, to a small circle round `t = 0`, and round the circle until the
//! path closes. The number of turns is the winding number. The Laurent coefficients tell whether
//! the path is finite or diverges, with valuations that are exact fractions. The mean of the
//! samples is the end, far more accurate than any point near it. Where the coefficients do not
//! decay, the circle was too wide, and a smaller one follows. Once singularities clearly lie close
//! to zero, the regular tracker tries too.
//!
//! All paths take their legs together, in lanes and on all threads. The result does not depend on
//! how the paths are distributed.

mod ending;
mod laurent;
mod leading_terms;
mod legs;
mod options;
mod polish;
mod walker;

pub(crate) use ending::{Ending, SingularEnd};
pub use options::EndgameOptions;

use crate::homotopy::Segment;
use crate::monitor::{Monitor, Stage};
use crate::threads::{IntoParallelIterator, ParallelIterator};
use crate::tolerances::endgame;
use crate::tracker::{PathEnd, PathSet, TrackerOptions, Trackers};
use leading_terms::LeadingTerms;
use legs::{Leg, Legs};
use num_complex::Complex64;
use polish::{LANES, LegEnd, Polisher};
use poly::Evaluate;
use walker::{Sample, Walker};

/// A leg may take the steps of a path divided by this.
const LEGS: usize = 20;

/// All legs of a path may take the steps of a path, or fewer if a step is much work: half as many
/// in a system with this many parameters.
const HEAVY: usize = 256;

/// Finds the ends of paths along `segment`, in the order given.
///
/// A path is given by its index, its `t > 0` and its point there. The result has its index, its end and its point at
/// the first radius, common to all paths: two that coincide there have crossed. It is empty if not reached. `tracker`
/// has the settings for the legs. `turns` bounds the winding number, for instance by the number of all paths.
///
/// # Panics
/// If the system is not square or points and segment do not fit it.
pub(crate) fn endgame<'a, E: Evaluate>(
    trackers: &Trackers<'_, E>,
    segment: &Segment,
    paths: impl IntoIterator<Item = (usize, f64, &'a [Complex64])>,
    turns: usize,
    tracker: &TrackerOptions,
    options: &EndgameOptions,
    monitor: &Monitor,
) -> Vec<(usize, Ending, Vec<Complex64>)> {
    let mut walkers: Vec<Walker> = paths.into_iter().map(|path| Walker::new(path, turns, options)).collect();
    let settings = TrackerOptions {
        corrector_tolerance: tracker.corrector_tolerance.min(1e-5),
        // A leg is short, and one that needs many steps leads nowhere.
        max_steps: tracker.max_steps / LEGS,
        // Legs end at points like any others.
        endgame_start: 0.0,
        min_t: 0.0,
        least_share: 0.0,
        // Nothing shows where a single leg has jumped.
        quick: false,
        ..tracker.clone()
    };
    let max_steps = tracker.max_steps / (1 + segment.target().len() / HEAVY);
    monitor.enter(Stage::Endgame, walkers.len() as u64);
    // Legs are no paths: they are not counted.
    let nobody = Monitor::default();
    let to_zero = TrackerOptions { min_t: endgame::LEFT_OF_LEG, ..settings.clone() };
    let mut undecided = walkers.len();
    let mut starts: Vec<Complex64> = Vec::new();
    let mut leading_terms = LeadingTerms::new(trackers.system());
    loop {
        leading_terms.judge(segment, &mut walkers);
        let live: Vec<usize> = (0..walkers.len()).filter(|&k| walkers[k].is_live()).collect();
        monitor.add((undecided - live.len()) as u64, 0);
        undecided = live.len();
        if live.is_empty() || monitor.is_cancelled() {
            return walkers.into_iter().map(Walker::ended).collect();
        }
        let legs = Legs { segment, legs: live.iter().map(|&k| walkers[k].leg()).collect() };
        starts.clear();
        for &k in live.iter() {
            starts.extend_from_slice(&walkers[k].x);
        }
        let (home, round): (Vec<usize>, Vec<usize>) =
            (0..live.len()).partition(|&i| matches!(legs.legs[i], Leg::Home(_)));
        let ends = [
            trackers.track(&legs, &starts, &round, &settings, &nobody),
            trackers.track(&legs, &starts, &home, &to_zero, &nobody),
        ];
        let results = || ends.iter().flat_map(PathSet::iter);
        let mut arrives = vec![false; legs.legs.len()];
        for (result, _) in results() {
            arrives[result.path] = result.end == PathEnd::Success && result.t == 0.0;
        }
        let arrived: Vec<LegEnd<'_>> = results()
            .filter(|(result, _)| arrives[result.path])
            .map(|(result, point)| LegEnd { leg: result.path, u: result.t, point, omega: result.omega })
            .collect();
        let polished = polished(trackers.system(), &legs, &arrived);
        let mut polished = polished.into_iter().flatten();
        let mut samples = Vec::new();
        for (result, _) in results() {
            if arrives[result.path] {
                samples.extend(polished.next());
            }
            if result.end == PathEnd::Success && result.t > 0.0 {
                // A piece of a leg.
                continue;
            }
            let walker = &mut walkers[live[result.path]];
            walker.advance(std::mem::take(&mut samples), options);
            walker.spend(result.accepted + result.rejected, max_steps);
        }
    }
}

/// The ends of legs, polished eight at a time on all threads.
fn polished<E: Evaluate>(system: &E, legs: &Legs<'_>, ends: &[LegEnd<'_>]) -> Vec<Vec<Sample>> {
    let part = |polisher: &mut Polisher<'_, E>, part: usize| {
        let ends = &ends[part * LANES..];
        polisher.polish(legs, &ends[..ends.len().min(LANES)])
    };
    (0..ends.len().div_ceil(LANES)).into_par_iter().map_init(|| Polisher::new(system), part).collect()
}
