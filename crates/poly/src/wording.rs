//! Counts in the messages and summaries of this crate and of those that build on it.

use std::fmt::Display;

/// A count with its noun, in the singular or plural.
///
/// ```
/// use poly::counted;
/// assert_eq!(counted(1, "isolated solution"), "1 isolated solution");
/// assert_eq!(counted(2_u64, "path"), "2 paths");
/// assert_eq!(counted(0_usize, "path"), "0 paths");
/// ```
pub fn counted<N: Display + PartialEq + From<u8>>(count: N, noun: &str) -> String {
    let ending = if count == N::from(1) { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

/// The first of two words for one thing, the second for any other number of them.
///
/// ```
/// use poly::{counted, one_or};
/// let ends = |count: usize| format!("{} {} lost", counted(count, "path"), one_or(count, "is", "are"));
/// assert_eq!([ends(1), ends(2)], ["1 path is lost", "2 paths are lost"]);
/// ```
pub fn one_or<'a, N: PartialEq + From<u8>>(count: N, one: &'a str, others: &'a str) -> &'a str {
    if count == N::from(1) { one } else { others }
}
