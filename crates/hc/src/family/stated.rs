//! What a family states of its solutions besides its equations, as a [`FibreTracker`](super::FibreTracker) uses it.

use super::fibre::Fibre;
use super::images::Images;
use super::verdict::{Verdict, verdict};
use crate::distinct::{Coincidences, Known};
use crate::refine::Refiner;
use crate::tolerances::{families, same};
use crate::tracker::{PathEnd, PathResult, PathSet};
use num_complex::Complex64;
use poly::{ComplexDd, Evaluate, Isa};
use std::collections::VecDeque;

/// What a family states of its solutions besides the equations that are tracked: further equations, factors that do not
/// vanish, and symmetries. By default nothing.
///
/// [`Family::stated`](crate::Family::stated) and the function `stated()` of generated modules make one for
/// [`FibreTracker::stating`](super::FibreTracker::stating).
#[derive(Default)]
pub struct Stated<'a> {
    equations: Option<&'a dyn Equations>,
    factors: Option<&'a dyn Factors>,
    orbits: Option<Orbits<'a>>,
}

/// Whether a factor vanishes at a solution, by the parameters and its coordinates.
type Vanishes<'a> = dyn FnMut(&[Complex64], &[Complex64]) -> bool + 'a;

/// Factors that must not vanish.
trait Factors: Send + Sync {
    /// Tells whether one vanishes, with memory of its own.
    fn vanish(&self) -> Box<Vanishes<'_>>;
}

impl<N: Evaluate> Factors for N {
    fn vanish(&self) -> Box<Vanishes<'_>> {
        let mut vanishing = Vanishing::new(self);
        Box::new(move |p, x| vanishing.at(p, x))
    }
}

/// Equations that solutions solve.
trait Equations: Send + Sync {
    /// What they say of a point, by its digits in double-double, the parameters and its coordinates.
    fn verdict(&self, precise: &[ComplexDd], p: &[Complex64], x: &[Complex64]) -> Verdict;
}

impl<A: Evaluate> Equations for A {
    fn verdict(&self, precise: &[ComplexDd], p: &[Complex64], x: &[Complex64]) -> Verdict {
        verdict(self, precise, p, x)
    }
}

/// Adds the images of a point, one after the other, by the parameters and its coordinates.
type AddImages<'a> = dyn FnMut(&[Complex64], &[Complex64], &mut Vec<Complex64>) + 'a;

/// Maps that take solutions to solutions.
trait Maps: Send + Sync {
    /// Their images, with memory of its own.
    fn images(&self) -> Box<AddImages<'_>>;
}

impl<S: Evaluate> Maps for S {
    fn images(&self) -> Box<AddImages<'_>> {
        let mut images = Images::new(self);
        Box::new(move |p, x, out| out.extend_from_slice(images.of(p, x)))
    }
}

impl<'a> Stated<'a> {
    /// With these equations, all of which are solved. There may be more than unknowns; what is tracked are then as many
    /// combinations of them, which have further solutions.
    #[must_use]
    pub fn equations<A: Evaluate>(mut self, all: &'a A) -> Self {
        self.equations = Some(all);
        self
    }

    /// With these factors of unknowns and parameters, one an equation, none of which vanishes at a solution.
    #[must_use]
    pub fn nonzero<N: Evaluate>(mut self, factors: &'a N) -> Self {
        self.factors = Some(factors);
        self
    }

    /// With these maps, which take solutions to solutions for the same parameters: the coordinates of all images, one
    /// map after the other, as equations.
    #[must_use]
    pub fn symmetry<S: Evaluate>(mut self, maps: &'a S) -> Self {
        self.orbits = Some(Orbits { maps, unfolding: None, coincidences: Coincidences::default() });
        self
    }

    /// How the solutions of a fibre are images of some; `None` if they are not.
    pub(super) fn orbits(&mut self, fibre: &Fibre) -> Option<&mut Orbits<'a>> {
        let orbits = self.orbits.as_mut()?;
        if orbits.unfolding.as_ref().is_none_or(|known| known.fibre != *fibre) {
            orbits.unfolding = Some(Unfolding::new(&mut *orbits.maps.images(), fibre));
        }
        orbits.unfolding.as_ref().is_some_and(|known| !known.steps.is_empty()).then_some(orbits)
    }

    /// Marks regular ends at which a factor vanishes, or that are not known to solve all equations; returns their number.
    pub(super) fn mark<E: Evaluate>(&mut self, system: &E, p: &[Complex64], paths: &mut PathSet) -> usize {
        let mut vanishes = self.factors.map(|factors| factors.vanish());
        let mut all = self.equations.map(|all| (all, Refiner::new(system)));
        let mut is_outside = |x: &[Complex64]| {
            let solves = |(all, refiner): &mut (&dyn Equations, Refiner<'_, E>)| {
                all.verdict(&refiner.extend(p, x), p, x) == Verdict::Solves
            };
            vanishes.as_mut().is_some_and(|vanishes| vanishes(p, x)) || !all.as_mut().is_none_or(solves)
        };
        let mut marked = 0;
        for k in 0..paths.len() {
            let result = paths.results()[k];
            if result.end == PathEnd::Success && is_outside(paths.point(k)) {
                paths.replace_record(k, PathResult { end: PathEnd::Degenerate, ..result });
                marked += 1;
            }
        }
        marked
    }
}

/// The maps of a symmetry, and what they do to a fibre.
pub(super) struct Orbits<'a> {
    maps: &'a dyn Maps,
    unfolding: Option<Unfolding>,
    coincidences: Coincidences,
}

/// How the solutions of a fibre are images of some of them.
struct Unfolding {
    fibre: Fibre,
    /// One solution of each orbit, and their numbers in the fibre.
    tracked: Fibre,
    which: Vec<usize>,
    /// From a solution by a map to another one, each solution that is not tracked once; no steps if some image is not
    /// in the fibre.
    steps: Vec<(usize, usize, usize)>,
}

impl Unfolding {
    fn new(maps: &mut AddImages<'_>, fibre: &Fibre) -> Unfolding {
        let known = Known::new(fibre.iter());
        let mut is_found = vec![false; fibre.len()];
        let (mut which, mut steps, mut images, mut is_whole) = (Vec::new(), Vec::new(), Vec::new(), true);
        for first in 0..fibre.len() {
            if std::mem::replace(&mut is_found[first], true) {
                continue;
            }
            which.push(first);
            let mut next = VecDeque::from([first]);
            while let Some(from) = next.pop_front() {
                images.clear();
                maps(&fibre.parameters, fibre.solution(from), &mut images);
                for (map, image) in images.chunks_exact(fibre.dimension.max(1)).enumerate() {
                    match known.place(image, same::REGULAR) {
                        Some(to) if !is_found[to] => {
                            is_found[to] = true;
                            steps.push((from, map, to));
                            next.push_back(to);
                        }
                        Some(_) => {}
                        None => is_whole = false,
                    }
                }
            }
        }
        if !is_whole {
            steps.clear();
        }
        let tracked = Fibre { representatives: Some(which.clone()), ..fibre.clone() }.tracked();
        Unfolding { fibre: fibre.clone(), tracked, which, steps }
    }
}

impl Orbits<'_> {
    /// The solutions that are tracked; `None` before a fibre is known.
    pub(super) fn tracked(&self) -> Option<&Fibre> {
        self.unfolding.as_ref().map(|known| &known.tracked)
    }

    /// All paths from those of the tracked solutions. False, with the paths as they were, if images meet or are not
    /// finite, or paths are missing: what ends where is then told by the paths themselves.
    pub(super) fn unfold(&mut self, target: &[Complex64], paths: &mut PathSet, coincidence: f64) -> bool {
        let Some(known) = self.unfolding.as_ref().filter(|known| known.which.len() == paths.len()) else {
            return false;
        };
        let (n, zero) = (known.fibre.dimension, Complex64::default());
        let mut ends = vec![PathResult::default(); known.fibre.len()];
        let mut points = vec![zero; known.fibre.len() * n];
        for ((result, point), &k) in paths.iter().zip(&known.which) {
            ends[k] = PathResult { path: k, ..*result };
            points[k * n..(k + 1) * n].copy_from_slice(point);
        }
        let (mut maps, mut images, mut of) = (self.maps.images(), Vec::new(), None);
        for &(from, map, to) in &known.steps {
            if of.replace(from) != Some(from) {
                images.clear();
                maps(target, &points[from * n..(from + 1) * n], &mut images);
            }
            let image = &images[map * n..(map + 1) * n];
            if ends[from].end == PathEnd::Success && image.iter().any(|z| !z.is_finite()) {
                return false;
            }
            points[to * n..(to + 1) * n].copy_from_slice(image);
            ends[to] = PathResult { path: to, accepted: 0, rejected: 0, jacobians: 0, ..ends[from] };
        }
        let regular = (0..ends.len()).filter(|&k| ends[k].end == PathEnd::Success);
        let mut meeting = Vec::new();
        self.coincidences.members(regular, |k| &points[k * n..(k + 1) * n], coincidence, &mut meeting);
        if !meeting.is_empty() {
            return false;
        }
        paths.clear(n);
        for (k, end) in ends.into_iter().enumerate() {
            paths.push(end, points[k * n..(k + 1) * n].iter().copied());
        }
        true
    }
}

/// Factors that must not vanish, with memory for their values.
pub(super) struct Vanishing<'a, N: Evaluate> {
    factors: &'a N,
    memory: N::Memory<Complex64>,
    values: Vec<Complex64>,
    gradients: Vec<Complex64>,
}

impl<'a, N: Evaluate> Vanishing<'a, N> {
    pub(super) fn new(factors: &'a N) -> Self {
        let zeros = |count: usize| vec![Complex64::default(); count];
        let (values, gradients) = (zeros(factors.equations()), zeros(factors.equations() * factors.variables()));
        Vanishing { factors, memory: factors.memory(Isa::Portable), values, gradients }
    }

    /// Whether a factor has vanished at a solution `x` for the parameters `p`: a change of `x` by a small share of its
    /// largest coordinate would make it vanish. Unlike [`accepts`](crate::Family::accepts), which is for generic
    /// parameters of size one, this does not depend on the unit of the unknowns.
    pub(super) fn at(&mut self, p: &[Complex64], x: &[Complex64]) -> bool {
        let Vanishing { factors, memory, values, gradients } = self;
        factors.jacobian(memory, x, p, values, gradients);
        let count = values.len();
        let largest = x.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let slope = |i: usize| gradients.iter().skip(i).step_by(count.max(1)).map(|z| z.norm()).sum::<f64>();
        (0..count).any(|i| values[i].norm() <= families::DEGENERATE * slope(i) * largest)
    }
}
