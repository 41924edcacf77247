//! Why a recording cannot be read.

use thiserror::Error;

/// Why a recording cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{file}: {source}; check the path and its permissions")]
    Io {
        /// The file.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A directory was given.
    #[error("{file}: is a directory; give the recordings in it")]
    Directory {
        /// The path.
        file: String,
    },
    /// There is nothing in the file.
    #[error("{file}: is empty; was the recorder stopped, and the card removed, properly?")]
    Empty {
        /// The file.
        file: String,
    },
    /// Neither WAV nor FLAC.
    #[error("{file}: is {found}, not WAV or FLAC; {remedy}")]
    NotARecording {
        /// The file.
        file: String,
        /// What it is instead, as far as its first bytes tell.
        found: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// The samples are stored in a way that is not read.
    #[error(
        "{file}: has samples as {encoding}; WAV with integers of 8 to 32 bits or floats of 32 or 64 bits, and FLAC of 8, 12, 16, \
         20 or 24 bits, can be read: convert it, for instance with `ffmpeg -i IN -c:a pcm_s24le OUT.wav`"
    )]
    Encoding {
        /// The file.
        file: String,
        /// Name of the encoding.
        encoding: String,
    },
    /// A header that is cut off, or contradicts itself.
    #[error(
        "{file}: {problem}; is the file complete? If so, repair its header, for instance with `ffmpeg -i IN OUT.wav`"
    )]
    Header {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// Samples that cannot be decoded, although the file goes on.
    #[error(
        "{file}: is damaged {seconds:.3} s after its beginning ({problem}); copy it from the recorder again, \
         or convert it with `flac -d`"
    )]
    Damaged {
        /// The file.
        file: String,
        /// Up to where it can be read, seconds.
        seconds: f64,
        /// What is wrong.
        problem: String,
    },
    /// Somebody who watches the reading has stopped it.
    #[error("reading was stopped")]
    Stopped,
}
