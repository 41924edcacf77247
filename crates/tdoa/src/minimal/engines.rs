//! The solvers with paths, each made when it is first needed.

use super::engine::Engine;
use super::error::MinimalError;
use super::formulation::FormulationIn;
use super::options::MinimalOptions;
use super::proofs::RootProofs;
use super::solution::MinimalSolution;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;
use hc::tracker::PathResult;

/// A solver of one configuration, whatever its formulation: see [`Engine`].
pub(crate) trait PathSolver<const D: usize>: Send + Sync {
    /// [`Engine::solve`].
    fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution<D>, MinimalError>;

    /// [`Engine::forget`].
    fn forget(&mut self);

    /// [`Engine::keep`].
    fn keep(&mut self);

    /// [`Engine::records`].
    fn records(&self) -> &[PathResult];

    /// [`Engine::prove`].
    fn prove(&self, monitor: &Monitor) -> Option<RootProofs>;
}

impl<F: FormulationIn<D>, const D: usize> PathSolver<D> for Engine<F, D>
where
    Engine<F, D>: Send + Sync,
{
    fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
        monitor: &Monitor,
    ) -> Result<MinimalSolution<D>, MinimalError> {
        Engine::solve(self, measured, options, monitor)
    }

    fn forget(&mut self) {
        Engine::forget(self);
    }

    fn keep(&mut self) {
        Engine::keep(self);
    }

    fn records(&self) -> &[PathResult] {
        Engine::records(self)
    }

    fn prove(&self, monitor: &Monitor) -> Option<RootProofs> {
        Engine::prove(self, monitor)
    }
}

/// The solvers that were needed so far, by the names of their formulations; they keep their memory from call to
/// call.
#[derive(Default)]
pub(crate) struct Engines<const D: usize> {
    all: Vec<(&'static str, Box<dyn PathSolver<D>>)>,
    /// The one that was used last.
    last: Option<usize>,
}

impl<const D: usize> Engines<D> {
    /// The solver of a formulation, whose roots are the ones to prove from now on.
    pub(crate) fn used<F: FormulationIn<D> + 'static>(&mut self) -> &mut dyn PathSolver<D>
    where
        Engine<F, D>: PathSolver<D>,
    {
        let place = self.all.iter().position(|(name, _)| *name == F::NAME);
        let place = place.unwrap_or_else(|| {
            self.all.push((F::NAME, Box::new(Engine::<F, D>::new())));
            self.all.len() - 1
        });
        self.last = Some(place);
        let engine = &mut *self.all[place].1;
        engine.forget();
        engine
    }

    /// From now on there are no paths and no roots to prove.
    pub(crate) fn none_used(&mut self) {
        self.last = None;
    }

    /// The records of the paths of the solver that was used last.
    pub(crate) fn records(&self) -> &[PathResult] {
        self.last.map_or(&[], |last| self.all[last].1.records())
    }

    /// Proofs of the roots of the solver that was used last, if one was.
    pub(crate) fn prove(&self, monitor: &Monitor) -> Option<RootProofs> {
        self.last.and_then(|last| self.all[last].1.prove(monitor))
    }
}
