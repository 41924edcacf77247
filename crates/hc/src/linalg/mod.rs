//! LU factorisation of small complex matrices, one or several at once.
//!
//! Entries that are zero whatever the input are left out, with those that the elimination leaves zero.
//!
//! Threshold pivoting is done lane by lane with implicitly scaled rows (Skeel 1979). The measure of
//! a row is `|a_ik| / max_j |a_ij| w_j`, where `w` are the weights of the unknowns. The row on the
//! diagonal stays if its measure is at least a tenth of the largest. Lanes therefore never
//! influence each other, and a lane gives bit for bit what the one-lane factorisation gives. Rows
//! are moved only where it matters, because moving them costs time in lanes.
//!
//! Those who judge the solutions can do without: rows then have one [order](exchanges_at) for all lanes.

mod condition;
mod kernels;
mod lu;
mod order;
#[cfg(test)]
mod tests;

pub(crate) use condition::Estimate;
pub(crate) use lu::Lu;
pub(crate) use order::{RowExchanges, exchanges_at};
