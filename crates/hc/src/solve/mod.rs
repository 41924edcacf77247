//! All isolated solutions of a polynomial system.

mod classify;
mod cluster;
mod conditioned;
mod ends;
mod equations;
mod error;
mod excess;
mod fingerprints;
mod graph;
mod infinity;
mod member;
mod options;
mod paths;
mod plane;
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

pub use error::SolveError;
pub(crate) use member::{ends, solve_member};
pub use options::{SolveOptions, Start};
pub(crate) use polynomials::{SolveContext, solve_polynomials, solve_sliced};
pub use solutions::{Direction, Solution, Solutions, Unresolved};
pub use summary::coordinates;
pub use warning::Warning;

use crate::checkpoint::{Hash, Job};
use crate::monitor::Monitor;
use crate::ranks::{Lead, Worker};
use crate::run::{RanksRun, Run};
use poly::{Exact, ExpandLimits, Polynomial, System};
use solutions::Member;

/// Finds the isolated solutions of a system with at least as many polynomials as unknowns.
///
/// From the solutions of a start system, paths lead along a straight line in the coefficients to
/// all isolated solutions. The start system is polyhedral (Huber & Sturmfels 1995, with the origin
/// added to supports for zero coordinates, Li & Wang 1996) or one with fewer stages ([`Start`]).
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
    /// As for [`solve`]; also if the checkpoint belongs to another run, or cannot be written.
    pub fn solve(&self, system: &System, options: &SolveOptions) -> Result<Solutions, SolveError> {
        self.install(|| {
            let (checkpoint, written) = (self.checkpoint(), written::worth_tracking(system));
            let context = SolveContext { checkpoint, written, ..SolveContext::default() };
            solve_expanded(system, &expanded(system, options)?, options, self.monitor(), context)
        })
    }
}

impl RanksRun<'_> {
    /// [`solve`] on all ranks. The paths are divided; preparations and the work after the paths are
    /// not.
    ///
    /// # Errors
    /// As for [`Run::solve`]; on rank 0 also if another rank fails or has another job.
    pub fn solve(&self, system: &System, options: &SolveOptions) -> Result<Option<Solutions>, SolveError> {
        let Some(ranks) = self.ranks else { return self.run.solve(system, options).map(Some) };
        self.run.install(|| {
            let polynomials = expanded(system, options);
            let job = polynomials.as_ref().map(|polynomials| job(polynomials, system, options).fingerprint());
            let fingerprint = job.unwrap_or_default();
            let written = written::worth_tracking(system);
            if ranks.is_lead() {
                return Lead::at(ranks, &fingerprint, |lead| {
                    let checkpoint = self.run.checkpoint();
                    let context = SolveContext { checkpoint, lead: Some(lead), worker: None, written };
                    solve_expanded(system, &polynomials?, options, self.run.monitor(), context).map(Some)
                });
            }
            Worker::at(ranks, &fingerprint, |worker| {
                let context = SolveContext { worker: Some(worker), written, ..SolveContext::default() };
                solve_polynomials(&polynomials?, system.variables(), options, worker.monitor(), context).map(|_| None)
            })
        })
    }
}

/// The polynomials of a system that can be solved with these options.
fn expanded(system: &System, options: &SolveOptions) -> Result<Vec<Polynomial<Exact>>, SolveError> {
    options.validate()?;
    if !system.parameters().is_empty() {
        return Err(SolveError::Parameters(system.parameters().join(", ")));
    }
    Ok(system.expand(&ExpandLimits::default())?)
}

fn solve_expanded(
    system: &System,
    polynomials: &[Polynomial<Exact>],
    options: &SolveOptions,
    monitor: &Monitor,
    context: SolveContext<'_>,
) -> Result<Solutions, SolveError> {
    if let Some(checkpoint) = context.checkpoint {
        checkpoint.begin(job(polynomials, system, options))?;
    }
    let mut found = solve_polynomials(polynomials, system.variables(), options, monitor, context)?;
    found.variables = system.variables().to_vec();
    found.member = Member::new(system, &[]);
    if options.certify {
        found.certify()?;
    }
    Ok(found)
}

/// The job: what a checkpoint of this work describes, and what all ranks do.
fn job(polynomials: &[Polynomial<Exact>], system: &System, options: &SolveOptions) -> Job {
    let unknowns = system.variables().to_vec();
    let names: Vec<&str> = unknowns.iter().map(String::as_str).collect();
    let expanded = polynomials.iter().map(|polynomial| polynomial.display(&names).to_string());
    // The same polynomials are tracked in another way where they are written in another way.
    let hash = Hash::of(expanded.chain(written::worth_tracking(system).map(System::to_string)));
    let system = crate::checkpoint::System { unknowns, equations: polynomials.len(), hash };
    Job::new("solve", system, options)
}

#[cfg(all(test, feature = "threads"))]
#[path = "recorded_tests.rs"]
mod tests;

#[cfg(all(test, feature = "threads"))]
mod ranks_tests;
