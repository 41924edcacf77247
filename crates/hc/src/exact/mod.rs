//! Everything exact in one unknown or two: the number of all solutions, whether they are simple, and
//! the solutions themselves.
//!
//! Paths do without it. It is asked where their ends leave a doubt, because it is right where doubles
//! have too few digits.

mod eliminant;
mod plane;
mod roots;
mod simple;
mod squarefree;
mod subresultants;
mod system;

pub(crate) use roots::{Digits, number_of_roots};
pub(crate) use system::SmallSystem;
