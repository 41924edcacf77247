//! The choice of a fibre from which the paths to other members of a family take little work.

use super::fibre::{Fibre, FibreOptions};
use super::track::{move_fibre, track_fibre};
use crate::monitor::Monitor;
use crate::random::Random;
use crate::tracker::TrackerOptions;
use num_complex::Complex64;
use poly::Evaluate;
use std::ops::Range;

/// The numbers of the random streams; others would give other fibres.
const FIRST_SAMPLE: u64 = 1000;
const FIRST_MEMBER: u64 = 2000;

/// What a lost path counts, in Jacobians.
const LOST: usize = 1_000;

/// Of the members that have been tried, so many go on to more samples: one in ...
const BEST: usize = 4;
/// ... and to so many times as many.
const MORE: u64 = 3;

/// Settings of [`easiest_fibre`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ChoiceOptions {
    /// Random members of the family that are tried, besides the given one. Default 24.
    pub members: usize,
    /// Samples to which the best of them are tracked; all are tracked to a ninth of them. Default 36.
    pub samples: usize,
    /// Solutions of a fibre, spread evenly over it, that are tracked for the choice; the fibre that is chosen is
    /// whole. A few hundred of thousands tell as much. Default `None`: all.
    pub solutions: Option<usize>,
    /// Seed of the members. Default 0.
    pub seed: u64,
    /// Settings of the paths to samples. Default: fast, quick steps, no second try.
    pub paths: FibreOptions,
}

impl Default for ChoiceOptions {
    fn default() -> Self {
        let tracker = TrackerOptions { quick: true, ..TrackerOptions::fast() };
        let paths = FibreOptions { tracker, retries: 0, ..FibreOptions::default() };
        ChoiceOptions { members: 24, samples: 36, solutions: None, seed: 0, paths }
    }
}

impl ChoiceOptions {
    /// The samples of one round after the other.
    fn rounds(&self) -> Vec<Range<u64>> {
        let all = self.samples.max(1) as u64;
        let ends = [all / (MORE * MORE), all / MORE, all].map(|end| end.max(1));
        (0..3).map(|k| if k == 0 { 0..ends[0] } else { ends[k - 1]..ends[k] }).filter(|r| !r.is_empty()).collect()
    }

    /// How many samples [`easiest_fibre`] asks for, if no member is lost: for its progress.
    pub fn work(&self) -> u64 {
        let mut members = self.members as u64 + 1;
        let rounds = self.rounds();
        let works = rounds.iter().map(|samples| {
            members = members.div_ceil(if samples.start > 0 { BEST as u64 } else { 1 });
            members * (samples.end - samples.start)
        });
        works.sum()
    }
}

/// Of some random members of a family and the given one, the fibre from which the paths to sample members take
/// fewest Jacobians, and how many these are per path. Lost paths count a thousand more.
///
/// `sample(fibre, k)` gives the parameters of sample `k`, which may be another for another fibre where the family
/// has a symmetry. [`real_sample`] will do where nothing is known. The work of a path differs from member to member
/// by a third; the choice pays if a fibre is stored and tracked often.
///
/// # Panics
/// If the system is not square, or the fibre or a sample does not fit it.
///
/// ```
/// use hc::family::{ChoiceOptions, Fibre, easiest_fibre, real_sample};
/// use hc::poly::Complex64;
///
/// let family = hc::Family::from_formulas(&["x"], &["a", "b"], &["x^2 + a*x + b"])?;
/// let fibre = Fibre::new(vec![Complex64::new(0.0, 0.0), Complex64::new(-4.0, 0.0)], 1, vec![2.0.into(), (-2.0).into()]);
/// let (easiest, jacobians) =
///     easiest_fibre(family.program(), &fibre, |_, k| real_sample(2, k), &ChoiceOptions::default());
/// assert!(easiest.len() == 2 && jacobians > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn easiest_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    sample: impl Fn(&Fibre, u64) -> Vec<Complex64>,
    options: &ChoiceOptions,
) -> (Fibre, f64) {
    let member = |k: u64| Random::new(options.seed, FIRST_MEMBER + k).normals(fibre.parameters.len());
    let (given, monitor) = (FibreOptions::default(), Monitor::default());
    let to = |fibre: &Fibre, parameters: &[Complex64]| move_fibre(system, fibre, parameters, &given, &monitor);
    let part = evenly(fibre, options.solutions.unwrap_or(usize::MAX));
    let moved = (0..options.members as u64).filter_map(|k| to(&part, &member(k)));
    let mut tried: Vec<(usize, Fibre)> = std::iter::once(part.clone()).chain(moved).map(|part| (0, part)).collect();
    for samples in options.rounds() {
        tried.truncate(tried.len().div_ceil(if samples.start > 0 { BEST } else { 1 }));
        for (work, fibre) in &mut tried {
            for k in samples.clone() {
                let (ends, counts) = track_fibre(system, fibre, &sample(fibre, k), &options.paths, &monitor);
                *work += ends.results().iter().map(|path| path.jacobians).sum::<usize>() + LOST * counts.failed;
            }
        }
        // Stable: of equals the first.
        tried.sort_by_key(|(work, _)| *work);
    }
    let whole = |chosen: Fibre| {
        if chosen.parameters == fibre.parameters {
            Some(fibre.clone())
        } else if chosen.len() == fibre.len() {
            Some(chosen)
        } else {
            to(fibre, &chosen.parameters)
        }
    };
    let paths = (options.samples.max(1) * part.len()).max(1);
    let mut best = tried.into_iter();
    match best.find_map(|(work, chosen)| Some((whole(chosen)?, work))) {
        Some((fibre, work)) => (fibre, work as f64 / paths as f64),
        // No member is reached by all paths.
        None => easiest_fibre(system, fibre, sample, &ChoiceOptions { members: 0, ..options.clone() }),
    }
}

/// So many solutions of a fibre, spread evenly over it, not marked as a part: their paths are to be those of the
/// whole fibre.
fn evenly(fibre: &Fibre, count: usize) -> Fibre {
    let (all, n) = (fibre.len(), fibre.dimension);
    if count >= all {
        return fibre.clone();
    }
    let solutions = (0..count).flat_map(|k| fibre.solution(k * all / count)).copied().collect();
    Fibre { is_partial: fibre.is_partial, ..Fibre::new(fibre.parameters.clone(), n, solutions) }
}

/// Random real parameters, normally distributed with variance one, for sample `k`.
pub fn real_sample(parameters: usize, k: u64) -> Vec<Complex64> {
    let normals = Random::new(0, FIRST_SAMPLE + k).normals(parameters);
    normals.iter().map(|z| Complex64::from(z.re * std::f64::consts::SQRT_2)).collect()
}

#[cfg(test)]
mod tests {
    use super::{ChoiceOptions, easiest_fibre, real_sample};
    use crate::family::{Family, Fibre, FibreOptions, track_fibre};
    use crate::monitor::Monitor;
    use num_complex::Complex64;
    use std::cell::Cell;

    /// Paths from a fibre next to a double root take more work than those from most others.
    #[test]
    fn a_bad_fibre_is_left() {
        let family = Family::from_formulas(&["x"], &["a", "b"], &["x^2 + a*x + b"]).unwrap();
        let root = 1e-4;
        let solutions = [root, -root].map(Complex64::from).to_vec();
        let bad = Fibre::new([0.0, -root * root].map(Complex64::from).to_vec(), 1, solutions);
        let options = ChoiceOptions::default();
        let asked = Cell::new(0);
        let sample = |_: &Fibre, k: u64| {
            asked.set(asked.get() + 1);
            real_sample(2, k)
        };
        let (chosen, jacobians) = easiest_fibre(family.program(), &bad, sample, &options);
        // 25 members to 4 samples, 7 to 8, 2 to 24.
        assert_eq!((asked.get(), options.work()), (204, 204));
        assert_eq!(chosen.len(), 2);
        let work = |fibre: &Fibre| {
            let to =
                |k| track_fibre(family.program(), fibre, &real_sample(2, k), &options.paths, &Monitor::default()).0;
            (0..36).map(|k| to(k).results().iter().map(|path| path.jacobians).sum::<usize>()).sum::<usize>()
        };
        assert!(work(&chosen) < work(&bad), "{} {}", work(&chosen), work(&bad));
        assert_eq!(work(&chosen) as f64 / 72.0, jacobians);
        // None is tried: none is chosen.
        let same = ChoiceOptions { members: 0, ..options.clone() };
        assert_eq!(easiest_fibre(family.program(), &bad, |_, k| real_sample(2, k), &same).0, bad);
        // Chosen by one of its two solutions, with half the paths, and whole.
        let half = ChoiceOptions { solutions: Some(1), ..ChoiceOptions::default() };
        let (by_half, jacobians) = easiest_fibre(family.program(), &bad, |_, k| real_sample(2, k), &half);
        assert_eq!(by_half.len(), 2);
        assert!(jacobians > 0.0 && work(&by_half) < work(&bad), "{jacobians} {}", work(&by_half));
        let to = real_sample(2, 40);
        let again = track_fibre(family.program(), &chosen, &to, &FibreOptions::default(), &Monitor::default());
        assert_eq!(again.1.finite, 2);
    }
}
