//! Decomposition into components, dimension by dimension.

use super::equations::NamedEquations;
use super::irreducible::orbits;
use super::set::WitnessSet;
use super::slices::Slices;
use crate::monitor::Monitor;
use crate::run::Run;
use crate::singular::is_missed;
use crate::solve::{Formulas, Solution, SolveContext, SolveError, SolveOptions, Unresolved, solve_polynomials};
use crate::tolerances::equations;
use num_complex::Complex64;
use poly::System;
use serde::Serialize;
use std::collections::BTreeMap;

/// A component of positive dimension.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Component {
    /// Its dimension, at least one.
    pub dimension: usize,
    /// The number of its points in as many general hyperplanes as its dimension.
    pub degree: usize,
    /// The multiplicity of these points there: one for a reduced component.
    pub multiplicity: usize,
    /// Whether it is shown to be one irreducible component: by monodromy, which joins its points,
    /// and by the trace test, which shows that none is missing. If not, it may be several
    /// components of this dimension and multiplicity together, or a part of one.
    pub irreducible: bool,
    /// The points, with their coordinates in the order of the unknowns.
    pub witness_points: Vec<Vec<Complex64>>,
}

/// All solutions of a system.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Decomposition {
    /// The unknowns, in the order of all points.
    #[serde(skip)]
    pub variables: Vec<String>,
    /// Components of positive dimension, higher dimensions first.
    pub components: Vec<Component>,
    /// Isolated solutions.
    pub isolated: Vec<Solution>,
    /// Ends that could not be judged, in all dimensions.
    pub unresolved: Vec<Unresolved>,
    /// Dimensions that were not searched, because this would take more paths than are allowed.
    pub unsearched: Vec<usize>,
    /// Lost paths in all dimensions, witness points that do not fit together, ends that seem to lie on
    /// components where there are none, and dimensions that were not searched. If there are any, something may be missing.
    pub failed: usize,
    /// Whether the work was cancelled: the result is then partial.
    pub partial: bool,
}

/// Finds all components of the solution set of a system with their degrees and multiplicities, and
/// the isolated solutions.
///
/// For the highest dimensions, arithmetic modulo two random primes of 61 bits mostly shows in little
/// time that they have no components. This is wrong only if both divide certain determinants of
/// the equations with random hyperplanes. In each other dimension, the given equations together
/// with as many general hyperplanes are [solved](crate::solve) with these options. These are too
/// many equations: they are combined at random, or get further unknowns that vanish at the
/// solutions (Sommese & Verschelde 2000), whichever makes less work. Where four sums or more are
/// multiplied, these get unknowns of their own, as in [`solve`](fn@crate::solve). Ends of paths that cannot be
/// judged are compared with the components of higher dimensions: one of their witness points is
/// moved there together with its hyperplanes. The same seed gives the same bits on any number of
/// threads.
///
/// The work is bounded. All dimensions together have [`max_paths`](SolveOptions::max_paths) paths,
/// counting paths that are tracked again. Each path has a bounded number of steps, and its end a
/// bounded amount of work. What is left undone for this reason is counted in
/// [`failed`](Decomposition::failed).
///
/// ```
/// // The twisted cubic.
/// let system: hc::System = "y - x^2; z - x*y; x*z - y^2".parse()?;
/// let found = hc::witness::decompose(&system, &hc::SolveOptions::new())?;
/// assert_eq!((found.components.len(), found.isolated.len(), found.failed), (1, 0, 0));
/// let cubic = &found.components[0];
/// assert_eq!((cubic.dimension, cubic.degree, cubic.multiplicity, cubic.irreducible), (1, 3, 1, true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`solve`](fn@crate::solve), but fewer equations than unknowns are not an error.
pub fn decompose(system: &System, options: &SolveOptions) -> Result<Decomposition, SolveError> {
    Run::new().decompose(system, options)
}

impl Run {
    /// [`decompose`], run in this way.
    ///
    /// # Errors
    /// Those of [`decompose`]; also if there is a checkpoint, since a decomposition is not recorded.
    pub fn decompose(&self, system: &System, options: &SolveOptions) -> Result<Decomposition, SolveError> {
        self.unrecorded("a decomposition")?;
        self.install(|| decompose_watched(system, options, self.monitor()))
    }
}

fn decompose_watched(system: &System, options: &SolveOptions, monitor: &Monitor) -> Result<Decomposition, SolveError> {
    let formulas = Formulas::new(system, equations::FACTORS_OF_COMPONENTS, options)?;
    let polynomials = formulas.polynomials.as_ref().map_err(Clone::clone)?;
    let names = system.variables();
    let equations = NamedEquations::new(polynomials, names.len(), options.seed);
    let lowest = names.len().saturating_sub(system.len());
    let mut all = Decomposition { variables: names.to_vec(), ..Decomposition::default() };
    let mut missed = true;
    let mut paths = options.max_paths;
    let mut sets: Vec<WitnessSet> = Vec::new();
    for dimension in (lowest..names.len()).rev() {
        missed = missed && is_missed(&equations.all, dimension, monitor);
        if missed {
            continue;
        }
        let slices = Slices::new(names.len(), dimension, options.seed);
        let planes = slices.polynomials(equations.all.unknowns());
        let sliced = equations.with_planes(&planes);
        let context = SolveContext { named_sums: equations.named_sums(), sliced: true, ..SolveContext::default() };
        let (unknowns, options) = (formulas.solved.variables(), &options.clone().max_paths(paths));
        let mut found = match solve_polynomials(&sliced, unknowns, options, monitor, context) {
            Err(SolveError::TooManyPaths { .. }) => {
                all.unsearched.push(dimension);
                all.failed += 1;
                continue;
            }
            other => other?,
        };
        let tracked = found.paths.tracked * found.start_systems as usize + found.paths.retracked;
        paths = paths.saturating_sub(tracked as u64);
        all.failed += found.paths.failed;
        all.partial |= found.interrupted;
        for mut end in std::mem::take(&mut found.unresolved) {
            end.value.truncate(names.len());
            if sets.iter().any(|set| set.contains(&end.value, options.seed, monitor)) {
                all.failed = all.failed.saturating_sub(end.paths);
            } else {
                all.unresolved.push(end);
            }
        }
        // Where higher dimensions have no components, no end lies on one.
        if all.components.is_empty() && all.failed == 0 {
            all.failed += found.component_points.len();
        }
        if dimension == 0 {
            all.isolated = formulas.in_given(found).solutions;
        } else {
            sets.extend(all.add(&equations, &slices, found.solutions, options.seed, monitor));
            all.partial |= monitor.is_cancelled();
        }
        if all.partial {
            break;
        }
    }
    Ok(all)
}

impl Decomposition {
    /// Adds the components of as high a dimension as there are hyperplanes, by their witness points, and
    /// returns what can be tracked of these.
    fn add(
        &mut self,
        equations: &NamedEquations<'_>,
        slices: &Slices,
        solutions: Vec<Solution>,
        seed: u64,
        monitor: &Monitor,
    ) -> Vec<WitnessSet> {
        let mut by_multiplicity: BTreeMap<usize, Vec<Vec<Complex64>>> = BTreeMap::new();
        for solution in solutions {
            by_multiplicity.entry(solution.multiplicity).or_default().push(solution.value);
        }
        let mut all = Vec::new();
        for (multiplicity, points) in by_multiplicity {
            let mut add = |which: Vec<usize>, irreducible: bool| {
                let witness_points: Vec<Vec<Complex64>> =
                    which.iter().map(|&k| points[k][..equations.unknowns].to_vec()).collect();
                let (dimension, degree) = (slices.dimension(), which.len());
                self.components.push(Component { dimension, degree, multiplicity, irreducible, witness_points });
            };
            let sets = WitnessSet::all(equations, slices, &points, seed);
            let mut left: Vec<usize> = (0..points.len()).collect();
            for set in &sets {
                left.retain(|k| !set.numbers.contains(k));
                for orbit in orbits(set, equations, seed, monitor) {
                    self.failed += orbit.further;
                    let whole = orbit.is_whole();
                    add(orbit.points, whole);
                }
            }
            if !left.is_empty() {
                let single = left.len() == 1;
                add(left, single);
            }
            all.extend(sets);
        }
        all
    }
}
