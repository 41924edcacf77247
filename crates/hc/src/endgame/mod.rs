//! The end of paths that do not run into a regular solution.
//!
//! Near `t = 0` such a path is a Puiseux series in `t`, or it is not known yet that it is none. It is tracked in logarithmic time
//! `s = -ln t`, in which steps need not shrink, to a small circle round `t = 0`, and round the circle until it closes (Cauchy's
//! endgame: Morgan, Sommese & Wampler 1991): the number of turns is the winding number, the Laurent coefficients tell whether the
//! path is finite or diverges, with valuations that are exact fractions, and the mean of the samples is the end,
//! far more accurate than any point near it. Where the coefficients do not decay, the circle was too wide and a
//! smaller one follows; once it is plain that singularities lie close to zero the regular tracker tries too.
//!
//! All paths take their legs together, in lanes and on all threads; the result does not depend on how they are spread.

mod laurent;
mod legs;
mod walker;

use crate::homotopy::Segment;
use crate::monitor::{Monitor, Stage};
use crate::refine::Refiner;
use crate::tracker::{OptionError, PathEnd, PathResult, PathSet, TrackerOptions, Trackers};
use legs::{Leg, Legs};
use num_complex::Complex64;
use poly::Evaluate;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use walker::{LEAST_SHRINK, Sample, Walker};

/// Settings of the endgame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EndgameOptions {
    /// A path whose `t` has fallen below this without reaching the target goes to the endgame. Default 1e-5.
    pub start: f64,
    /// Radius of the first loop. Default 1e-6.
    pub radius: f64,
    /// By what a radius is divided when the loop was too wide, at least 1.5. Default 30.
    pub shrink: f64,
    /// Paths that are undecided below this radius are lost. Default 1e-13.
    pub min_radius: f64,
    /// Turns after which the first loop is given up as too wide; each smaller loop may take twice as many. Default 16.
    pub turns: usize,
}

impl Default for EndgameOptions {
    fn default() -> Self {
        EndgameOptions { start: 1e-5, radius: 1e-6, shrink: 30.0, min_radius: 1e-13, turns: 16 }
    }
}

impl EndgameOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        OptionError::positive(&[
            ("endgame.start", self.start),
            ("endgame.radius", self.radius),
            ("endgame.min_radius", self.min_radius),
            ("endgame.shrink", self.shrink),
        ])?;
        OptionError::at_least("endgame.shrink", self.shrink, LEAST_SHRINK, "at least 1.5")?;
        OptionError::at_least("endgame.turns", self.turns as f64, 1.0, "at least 1")
    }
}

/// Share of a leg to zero that may be left before it is given up.
const HOME_MIN: f64 = 1e-7;

/// A leg may take the steps of a path divided by this.
const LEGS: usize = 20;

/// How a path ends, after its endgame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub(crate) enum Verdict {
    /// At a point; after `winding` turns round zero the path comes back to itself.
    Finite {
        /// Winding number.
        winding: usize,
        /// Error of the point, relative to the path's size on the last loop.
        error: f64,
    },
    /// At a point to which the path could be tracked like a regular one.
    Reached,
    /// At infinity: coordinate `j` is of order `t^(valuations[j] / winding)`, one of them being negative.
    Infinite {
        /// Winding number.
        winding: usize,
        /// The direction: valuations times the winding number.
        valuations: Vec<i64>,
    },
    /// Not known: the path could not be tracked, or no loop closed and showed a decaying series.
    Lost,
}

/// A path and its end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ending {
    /// Index of the path, as given.
    pub(crate) path: usize,
    /// How it ends.
    pub(crate) verdict: Verdict,
    /// The end if it is finite, otherwise the last point.
    pub(crate) point: Vec<Complex64>,
    /// The point at the first radius, common to all paths: two that coincide here have crossed. Empty if not reached.
    pub(crate) middle: Vec<Complex64>,
    /// Radius of the last loop.
    pub(crate) radius: f64,
}

/// A path that goes to the endgame: its index, its `t > 0` and its point there.
pub(crate) type Handed<'a> = (usize, f64, &'a [Complex64]);

/// Finds the ends of paths along `segment`, in the order given.
///
/// `tracker` are the settings for the legs; `turns` bounds the winding number, for instance by the number of all paths.
///
/// # Panics
/// If the system is not square or points and segment do not fit it.
pub(crate) fn endgame<'a, E: Evaluate>(
    trackers: &Trackers<'_, E>,
    segment: &Segment,
    paths: impl IntoIterator<Item = Handed<'a>>,
    turns: usize,
    tracker: &TrackerOptions,
    options: &EndgameOptions,
    monitor: &Monitor,
) -> Vec<Ending> {
    let mut walkers: Vec<Walker> = paths.into_iter().map(|handed| Walker::new(handed, turns, options)).collect();
    let settings = TrackerOptions {
        corrector_tolerance: tracker.corrector_tolerance.min(1e-5),
        // A leg is short, and one that needs many steps leads nowhere.
        max_steps: tracker.max_steps / LEGS,
        // Legs end at points like any others.
        endgame_start: 0.0,
        min_t: 0.0,
        ..tracker.clone()
    };
    monitor.enter(Stage::Endgame, walkers.len() as u64);
    // Legs are no paths: they are not counted.
    let nobody = Monitor::default();
    let to_zero = TrackerOptions { min_t: HOME_MIN, ..settings.clone() };
    let mut undecided = walkers.len();
    let mut starts: Vec<Complex64> = Vec::new();
    loop {
        let live: Vec<usize> = (0..walkers.len()).filter(|&k| walkers[k].is_live()).collect();
        monitor.add((undecided - live.len()) as u64, 0);
        undecided = live.len();
        if live.is_empty() || monitor.is_cancelled() {
            return walkers.into_iter().map(Walker::ending).collect();
        }
        let legs = Legs { segment, legs: live.iter().map(|&k| walkers[k].leg()).collect() };
        starts.clear();
        live.iter().for_each(|&k| starts.extend_from_slice(walkers[k].point()));
        let (home, round): (Vec<usize>, Vec<usize>) =
            (0..live.len()).partition(|&i| matches!(legs.legs[i], Leg::Home(_)));
        let ends = [
            trackers.track(&legs, &starts, &round, &settings, &nobody),
            trackers.track(&legs, &starts, &home, &to_zero, &nobody),
        ];
        let ends: Vec<(&PathResult, &[Complex64])> = ends.iter().flat_map(PathSet::iter).collect();
        let polished: Vec<Option<Sample>> = ends
            .par_iter()
            .map_init(
                || (Refiner::new(trackers.system()), Vec::new()),
                |(refiner, p), (result, point)| {
                    if result.end != PathEnd::Success {
                        return None;
                    }
                    legs.precise(result.path, p);
                    let mut point = point.to_vec();
                    let (accuracy, blur) = refiner.polish_and_blur(p, &mut point);
                    Some(Sample { point, accuracy, blur })
                },
            )
            .collect();
        for ((result, _), end) in ends.iter().zip(polished) {
            walkers[live[result.path]].advance(end, options);
        }
    }
}
