//! Rows of small records, one a path or a mixed cell, that may be far more than the solutions: what
//! exceeds a fixed amount of memory lies in a temporary file.
//!
//! A file that cannot be written is done without: the records then stay in memory.

mod place;
mod records;
mod sorter;

pub(crate) use place::{read_at, write_at};
pub(crate) use records::Records;
pub(crate) use sorter::Sorter;
