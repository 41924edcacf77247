//! Text to systems: parameter families in TOML and PHCpack's format, with errors that point at the place.

mod error;
mod family;
mod formula;
mod phcpack;
mod token;

pub use error::ParseError;
pub use family::{Family, family};
pub use phcpack::phcpack;
