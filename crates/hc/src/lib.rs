//! Homotopy continuation.

pub mod distinct;
pub mod fibre;
pub mod homotopy;
pub mod linalg;
pub mod monodromy;
pub mod pair;
pub mod random;
pub mod refine;
pub mod solve;
pub mod start;
pub mod start_file;
pub mod trace;
pub mod tracker;

pub use poly;
