//! The local structure of solutions: whether they are isolated, their multiplicity, and their
//! digits by deflation.
//!
//! It is found from the given equations, with their exact coefficients, in numbers of 32 to 308
//! digits. The precision is the lowest in which zeros are clearly separated from other numbers.

mod census;
mod cluster;
mod deflate;
mod dual;
mod eliminate;
mod empty;
mod equations;
mod kinds;
mod local_structure;
mod many_digits;
mod modular;
mod monomials;
mod multiplicity;
mod number;
mod prime_field;
mod quotient;
mod rational;
mod series;
mod sheet;

pub(crate) use census::{Census, census};
pub(crate) use cluster::ClusterEquations;
pub(crate) use eliminate::{Elimination, PivotLimit};
pub(crate) use empty::is_missed;
pub(crate) use equations::ExactEquations;
pub(crate) use kinds::{Effort, LocalStructure, UnresolvedReason, residual};
pub(crate) use local_structure::{is_moved, local_structure, on_set_nearby};
pub(crate) use many_digits::{Consistency, consistency, is_real};
pub(crate) use modular::{is_squarefree, resultant, trimmed};
pub(crate) use number::Number;
pub(crate) use prime_field::{PrimeField, Residue};
