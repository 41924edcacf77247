//! The solvers with paths, each made when it is first needed.

use super::dual::{Dual, EightFive, SevenFive, TenFour};
use super::gram::SixSix;
use crate::minimal::engine::Engine;
use crate::minimal::formulation::FormulationIn;
use crate::minimal::proofs::RootProofs;
use hc::Monitor;

/// A formulation whose solver is kept.
pub(super) trait Kept: FormulationIn<3> + Sized {
    /// Its solver, if it was needed so far.
    fn engine(engines: &Engines) -> Option<&Engine<Self, 3>>;

    /// Its solver.
    fn ready(engines: &mut Engines) -> &mut Engine<Self, 3>;
}

/// Defines the solvers of these formulations.
macro_rules! engines {
    ($($name:ident: $formulation:ty),*) => {
        /// The solvers that were needed so far; they keep their memory from call to call.
        #[derive(Default)]
        pub(super) struct Engines {
            $($name: Option<Engine<$formulation, 3>>,)*
            /// What proves the roots of the solver that was used last.
            prove: Option<fn(&Engines, &Monitor) -> Option<RootProofs>>,
        }

        $(impl Kept for $formulation {
            fn engine(engines: &Engines) -> Option<&Engine<Self, 3>> {
                engines.$name.as_ref()
            }

            fn ready(engines: &mut Engines) -> &mut Engine<Self, 3> {
                engines.$name.get_or_insert_with(Engine::new)
            }
        })*
    };
}

engines!(eight_five: Dual<EightFive>, seven_five: Dual<SevenFive>, six_six: SixSix, ten_four: Dual<TenFour>);

impl Engines {
    /// The solver of a formulation, whose roots are the ones to prove from now on.
    pub(super) fn used<F: Kept>(&mut self) -> &mut Engine<F, 3> {
        self.prove = Some(|engines, monitor| F::engine(engines)?.prove(monitor));
        F::ready(self)
    }

    /// From now on there are no roots to prove.
    pub(super) fn none_used(&mut self) {
        self.prove = None;
    }

    /// Proofs of the roots of the solver that was used last, if one was.
    pub(super) fn prove(&self, monitor: &Monitor) -> Option<RootProofs> {
        self.prove.and_then(|prove| prove(self, monitor))
    }
}
