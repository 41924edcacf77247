//! FLAC, decoded by claxon. What is not sound, such as tags and pictures, is left out before.

use std::io::{Chain, Cursor, ErrorKind, Read};

use claxon::{Block, FlacReader};

use crate::error::ReadError;
use crate::format::{self, Format};
use crate::input::Input;

/// Why a block cannot be decoded.
enum Problem {
    Damage(String),
    /// It has this, which claxon does not know.
    Unsupported(&'static str),
}

/// Bits of samples that blocks may have: claxon knows no others in their headers.
const BITS: [u32; 5] = [8, 12, 16, 20, 24];

/// The samples of a FLAC file.
pub(crate) struct Flac {
    file: String,
    reader: FlacReader<Chain<Cursor<Vec<u8>>, Input>>,
    pub(crate) format: Format,
    /// What one step of an integer is.
    step: f32,
    /// What was decoded last.
    block: Block,
    /// How much of that has been given.
    given: usize,
    /// Samples of each channel that have been decoded.
    decoded: u64,
    is_finished: bool,
    /// Why nothing more can be decoded.
    problem: Option<Problem>,
    /// Whether the file has ended before its samples.
    pub(crate) is_truncated: bool,
}

impl Flac {
    /// Reads the header.
    ///
    /// # Errors
    /// If it is cut off or wrong, or samples have a number of bits that cannot be decoded.
    pub(crate) fn new(mut input: Input) -> Result<Flac, ReadError> {
        let file = input.file.clone();
        let head = head(&mut input)?;
        let reader = match FlacReader::new(Cursor::new(head).chain(input)) {
            Ok(reader) => reader,
            Err(error) => return Err(header_error(file, error)),
        };
        let info = reader.streaminfo();
        let channels = usize::try_from(info.channels).unwrap_or(usize::MAX);
        if let Some(problem) = format::problem(channels, info.sample_rate) {
            return Err(ReadError::Header { file, problem });
        }
        let bits = info.bits_per_sample;
        if !BITS.contains(&bits) {
            return Err(ReadError::Encoding { file, encoding: format!("FLAC of {bits} bits") });
        }
        let full_scale = format::full_scale(bits);
        let step = (0.5_f64).powi(bits as i32 - 1) as f32;
        let frames = info.samples;
        let format = Format { sample_rate: info.sample_rate, channels, full_scale, frames };
        Ok(Flac {
            file,
            reader,
            format,
            step,
            block: Block::empty(),
            given: 0,
            decoded: 0,
            is_finished: false,
            problem: None,
            is_truncated: false,
        })
    }

    /// Appends the next samples to the channels, at most this many, and says how many: 0 at the end.
    ///
    /// # Errors
    /// If they cannot be decoded and the file goes on. What comes before has been given by then.
    pub(crate) fn read(&mut self, frames: usize, channels: &mut [Vec<f32>]) -> Result<usize, ReadError> {
        let mut done = 0;
        while done < frames {
            let ready = (self.block.duration() as usize).saturating_sub(self.given);
            if ready == 0 {
                match self.decode() {
                    Ok(true) => continue,
                    Ok(false) => break,
                    // What comes before the damage is given first; the damage is met again.
                    Err(_) if done > 0 => break,
                    Err(error) => return Err(error),
                }
            }
            let count = ready.min(frames - done);
            for (k, channel) in (0..).zip(channels.iter_mut()) {
                let samples = self.block.channel(k).get(self.given..self.given + count).unwrap_or_default();
                channel.extend(samples.iter().map(|&sample| sample as f32 * self.step));
            }
            self.given += count;
            done += count;
        }
        Ok(done)
    }

    /// Decodes the next block; `false` at the end.
    fn decode(&mut self) -> Result<bool, ReadError> {
        if let Some(problem) = &self.problem {
            return Err(self.error(problem));
        }
        let said = self.format.frames;
        if self.is_finished || said.is_some_and(|said| self.decoded >= said) {
            return Ok(false);
        }
        let buffer = std::mem::replace(&mut self.block, Block::empty()).into_buffer();
        self.given = 0;
        let problem = match self.reader.blocks().read_next_or_eof(buffer) {
            Ok(Some(block)) if block.channels() as usize == self.format.channels => {
                self.decoded = self.decoded.saturating_add(u64::from(block.duration()));
                self.block = block;
                return Ok(true);
            }
            Ok(Some(block)) => {
                Problem::Damage(format!("{} channels in place of {}", block.channels(), self.format.channels))
            }
            Ok(None) => {
                self.is_finished = true;
                self.is_truncated |= said.is_some_and(|said| self.decoded < said);
                return Ok(false);
            }
            Err(claxon::Error::IoError(error)) if error.kind() == ErrorKind::UnexpectedEof => {
                self.is_finished = true;
                self.is_truncated = true;
                return Ok(false);
            }
            Err(claxon::Error::Unsupported(feature)) => Problem::Unsupported(feature),
            Err(error) => Problem::Damage(error.to_string()),
        };
        // The decoder may be anywhere: samples that it finds later would have the wrong times.
        let error = self.error(&problem);
        self.problem = Some(problem);
        Err(error)
    }

    fn error(&self, problem: &Problem) -> ReadError {
        let file = self.file.clone();
        match problem {
            Problem::Damage(problem) => {
                let seconds = self.decoded as f64 / f64::from(self.format.sample_rate);
                ReadError::Damaged { file, seconds, problem: problem.clone() }
            }
            Problem::Unsupported(feature) => unsupported(file, feature),
        }
    }

    /// The recording's name in messages.
    pub(crate) fn file(&self) -> &str {
        &self.file
    }
}

/// Bytes of the block that says what the samples are.
const INFO: usize = 34;

/// Reads up to the samples, and gives the shortest header that says what they are.
fn head(input: &mut Input) -> Result<Vec<u8>, ReadError> {
    let cut_off = |input: &Input| input.bad_header("its header is cut off");
    let mut head = b"fLaC".to_vec();
    input.skip(head.len() as u64)?;
    loop {
        let Some([flags, a, b, c]) = input.array()? else { return Err(cut_off(input)) };
        let (is_last, kind, length) = (flags & 0x80 != 0, flags & 0x7f, u32::from_be_bytes([0, a, b, c]));
        let is_first = head.len() == 4;
        if is_first != (kind == 0) || (is_first && length as usize != INFO) {
            return Err(input.bad_header("the first block of its header, and no other, must say what its samples are"));
        }
        if is_first {
            let Some(info) = input.array::<INFO>()? else { return Err(cut_off(input)) };
            // The block is now the last one.
            head.extend([0x80, 0, 0, INFO as u8]);
            head.extend(info);
        } else {
            input.skip(length.into())?;
        }
        if is_last {
            return Ok(head);
        }
    }
}

/// The error for what FLAC has and claxon has not.
fn unsupported(file: String, feature: &str) -> ReadError {
    ReadError::Encoding { file, encoding: format!("FLAC that cannot be decoded ({feature})") }
}

fn header_error(file: String, error: claxon::Error) -> ReadError {
    match error {
        claxon::Error::IoError(source) if source.kind() != ErrorKind::UnexpectedEof => ReadError::Io { file, source },
        claxon::Error::IoError(_) => ReadError::Header { file, problem: "its header is cut off".into() },
        claxon::Error::Unsupported(feature) => unsupported(file, feature),
        error => ReadError::Header { file, problem: error.to_string() },
    }
}
