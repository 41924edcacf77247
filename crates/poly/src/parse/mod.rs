//! Text to systems, with errors that point at the place: plain text, PHCpack's format, and families
//! in TOML.

mod detect;
mod error;
mod family;
mod formula;
mod given;
mod phcpack;
mod plain;
mod token;

pub use error::ParseError;
pub use family::{Family, family};
pub use phcpack::phcpack;
pub(crate) use token::{begins_name, continues_name};
