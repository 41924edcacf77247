//! Rows of small records, one for each path or mixed cell. There may be far more of them than
//! solutions; what exceeds a fixed amount of memory lies in a temporary file.
//!
//! If a file cannot be written, the records stay in memory.

mod place;
mod records;
mod sorter;

pub(crate) use place::{read_at, write_at};
pub(crate) use records::Records;
pub(crate) use sorter::Sorter;
