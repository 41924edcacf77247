//! Signals that are known before they are looked for, such as a chirp from a loudspeaker.
//!
//! Compared with the signal itself at every delay, a recording has a short pulse where the signal begins, however long it
//! is: it is compressed. The pulse rises over noise in which the signal cannot be seen.

mod chirp;
mod compression;
mod error;
mod known;
mod samples;
mod stream;
mod template;

pub(crate) use chirp::chirp;
pub(crate) use compression::Compression;
pub use error::{SignalError, TemplateError};
pub use known::Signal;
pub(crate) use stream::Stream;
