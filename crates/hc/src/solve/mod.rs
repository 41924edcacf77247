//! All isolated solutions of a polynomial system.

mod classify;
mod cluster;
mod conditioned;
mod counted;
mod ends;
mod equations;
mod error;
mod excess;
mod fingerprints;
mod formulas;
mod infinity;
mod member;
mod options;
mod paths;
mod polynomials;
mod portions;
mod record;
mod singular_ends;
mod slack;
mod solutions;
mod start;
mod summary;
mod warning;
mod written;

pub(crate) use equations::combinations;
pub use error::SolveError;
pub(crate) use excess::Stray;
pub(crate) use formulas::Formulas;
pub(crate) use member::{ends, solve_member};
pub use options::{SolveOptions, Start};
pub(crate) use polynomials::{SolveContext, solve_polynomials};
pub use solutions::{Direction, Solution, Solutions, Unresolved};
pub use summary::coordinates;
pub use warning::Warning;
pub(crate) use written::sizes;

use crate::checkpoint::{Hash, Job};
use crate::monitor::Monitor;
use crate::ranks::{Lead, Worker};
use crate::run::{RanksRun, Run};
use crate::tolerances;
use poly::System;
use solutions::Member;

/// Finds the isolated solutions of a system with at least as many polynomials as unknowns.
///
/// From the solutions of a start system, paths lead along a straight line in the coefficients to
/// all isolated solutions. The start system is polyhedral (Huber & Sturmfels 1995, with the origin
/// added to supports for zero coordinates, Li & Wang 1996) or one with fewer stages ([`Start`]).
/// Where ten sums or more are multiplied, as in `(x + y)^20`, these have unknowns of their own
/// ([`System::with_named_sums`]), which the result does not have; numbers of paths are those of that
/// system. Formulas that cannot be expanded even so are tracked as they are written.
/// Ends that are not regular go through the endgame. More equations than unknowns are combined at
/// random, and excess solutions are removed again. The same seed gives the same bits on any number
/// of threads.
///
/// ```
/// let system = hc::poly::parse::phcpack("2\nx*(x - y);\n(y - 1)^2*(y + x);")?;
/// let found = hc::solve(&system, &hc::SolveOptions::new().seed(1))?;
/// let mut multiplicities: Vec<usize> = found.iter().map(|s| s.multiplicity).collect();
/// multiplicities.sort();
/// // The origin and (0, 1), (1, 1), each double.
/// assert_eq!((multiplicities, found.paths.failed), (vec![2, 2, 2], 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If there are too few equations or too many paths, an equation has no unknowns, or a number or an
/// option is out of range.
pub fn solve(system: &System, options: &SolveOptions) -> Result<Solutions, SolveError> {
    Run::new().solve(system, options)
}

impl Run {
    /// [`solve`], run in this way. Batches of paths are recorded. All options except
    /// [`max_paths`](SolveOptions::max_paths) and [`certify`](SolveOptions::certify) must be those
    /// of the run that a checkpoint belongs to.
    ///
    /// # Errors
    /// Those of [`solve`]; also if the checkpoint belongs to another run, or cannot be written.
    pub fn solve(&self, system: &System, options: &SolveOptions) -> Result<Solutions, SolveError> {
        self.install(|| {
            let formulas = Formulas::new(system, tolerances::equations::FACTORS, options)?;
            let context = SolveContext { checkpoint: self.checkpoint(), ..SolveContext::default() };
            solve_formulas(&formulas, options, self.monitor(), context)
        })
    }
}

impl RanksRun<'_> {
    /// [`solve`] on all ranks. The paths are divided; preparations and the work after the paths are
    /// not.
    ///
    /// # Errors
    /// Those of [`Run::solve`]; on rank 0 also if another rank fails or has another job.
    pub fn solve(&self, system: &System, options: &SolveOptions) -> Result<Option<Solutions>, SolveError> {
        let Some(ranks) = self.ranks else { return self.run.solve(system, options).map(Some) };
        self.run.install(|| {
            let formulas = Formulas::new(system, tolerances::equations::FACTORS, options);
            let fingerprint = formulas.as_ref().map(|formulas| job(formulas, options).fingerprint());
            let fingerprint = fingerprint.unwrap_or_default();
            if ranks.is_lead() {
                return Lead::at(ranks, &fingerprint, |lead| {
                    let formulas = formulas?;
                    let (checkpoint, lead) = (self.run.checkpoint(), Some(lead));
                    let context = SolveContext { checkpoint, lead, ..SolveContext::default() };
                    solve_formulas(&formulas, options, self.run.monitor(), context).map(Some)
                });
            }
            Worker::at(ranks, &fingerprint, |worker| {
                let context = SolveContext { worker: Some(worker), ..SolveContext::default() };
                formulas?.solve(options, worker.monitor(), context).map(|_| None)
            })
        })
    }
}

fn solve_formulas(
    formulas: &Formulas<'_>,
    options: &SolveOptions,
    monitor: &Monitor,
    context: SolveContext<'_>,
) -> Result<Solutions, SolveError> {
    if let Some(checkpoint) = context.checkpoint {
        checkpoint.begin(job(formulas, options))?;
    }
    let mut found = formulas.in_given(formulas.solve(options, monitor, context)?);
    found.variables = formulas.given.variables().to_vec();
    found.member = Member::new(formulas.given, &[]);
    if options.certify {
        found.certify()?;
    }
    Ok(found)
}

/// The job: what a checkpoint of this work describes, and what all ranks do.
fn job(formulas: &Formulas<'_>, options: &SolveOptions) -> Job {
    let names: Vec<&str> = formulas.solved.variables().iter().map(String::as_str).collect();
    let hash = match &formulas.polynomials {
        Ok(polynomials) => Hash::of(polynomials.iter().map(|polynomial| polynomial.display(&names).to_string())),
        Err(_) => Hash::of([formulas.solved.to_string()]),
    };
    let (unknowns, equations) = (formulas.given.variables().to_vec(), formulas.given.len());
    Job::new("solve", crate::checkpoint::System { unknowns, equations, hash }, options)
}

#[cfg(all(test, feature = "threads"))]
#[path = "recorded_tests.rs"]
mod tests;

#[cfg(all(test, feature = "threads"))]
mod ranks_tests;
