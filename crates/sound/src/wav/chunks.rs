//! The chunks of a RIFF file up to its samples. Sizes in headers are wishes: a recorder that was
//! switched off has not written them, and one that streams never knew them.

use super::encoding::{self, Encoding};
use crate::error::ReadError;
use crate::input::Input;

/// What stands before the samples.
pub(super) struct Chunks {
    pub(super) encoding: Encoding,
    /// Bytes of samples; `None` for all up to the end of the file.
    pub(super) data: Option<u64>,
}

/// A size that stands for another one elsewhere, or for none.
const NO_SIZE: u32 = u32::MAX;

/// SoX writes this size, less what is no whole sample, where it cannot go back to write the right one.
const SIZE_OF_SOX: u32 = 0x7fff_f000;

/// Reads up to the samples, which come next.
pub(super) fn read(input: &mut Input) -> Result<Chunks, ReadError> {
    let Some(head) = input.array::<12>()? else { return Err(input.bad_header("its header is cut off")) };
    if &head[8..] != b"WAVE" {
        return Err(input.bad_header("is a RIFF file, but has no sound (WAVE)"));
    }
    let whole = number(&head[4..8]);
    // Sizes of 64 bits: of the whole and of the samples.
    let mut long: Option<u64> = None;
    let mut encoding = None;
    loop {
        let Some(chunk) = input.array::<8>()? else {
            return Err(input.bad_header(match encoding {
                None => "ends before the format of its samples",
                Some(_) => "ends before its samples",
            }));
        };
        let size = number(&chunk[4..]);
        match &chunk[..4] {
            b"data" => {
                let Some(encoding) = encoding else {
                    return Err(input.bad_header("has no format (fmt) before its samples"));
                };
                let data = samples(input, size, whole, long, &encoding);
                return Ok(Chunks { encoding, data });
            }
            b"fmt " => {
                let mut bytes = [0; encoding::LONGEST];
                let wanted = bytes.len().min(usize::try_from(size).unwrap_or(usize::MAX));
                if input.fill(&mut bytes[..wanted])? < wanted {
                    return Err(input.bad_header("ends in the format of its samples"));
                }
                encoding = Some(encoding::parse(&bytes[..wanted], &input.file)?);
                skip(input, u64::from(size) - wanted as u64, size)?;
            }
            b"ds64" => {
                let Some(bytes) = input.array::<16>()? else {
                    return Err(input.bad_header("ends in its sizes (ds64)"));
                };
                long = Some(u64::from(number(&bytes[8..12])) | u64::from(number(&bytes[12..])) << 32);
                skip(input, u64::from(size).saturating_sub(16), size)?;
            }
            _ => skip(input, size.into(), size)?,
        }
    }
}

/// The bytes of samples, from what headers say: the size of their chunk, of the whole file, and of
/// the samples in 64 bits.
fn samples(input: &Input, size: u32, whole: u32, long: Option<u64>, encoding: &Encoding) -> Option<u64> {
    let remaining = input.remaining();
    if size == NO_SIZE {
        // A recorder that was switched off leaves these at zero.
        return long.filter(|&long| long != 0 && long != u64::MAX);
    }
    if size == 0 {
        // Nothing, if the size of the file has been written and other chunks follow; else it streams.
        let end = u64::from(whole) + 8;
        let is_beyond = remaining.is_some_and(|remaining| end > input.position().saturating_add(remaining));
        let is_written = whole != NO_SIZE && end > input.position() && !is_beyond;
        return is_written.then_some(0);
    }
    if remaining.is_some() && size == SIZE_OF_SOX - SIZE_OF_SOX % encoding.frame_bytes as u32 {
        return None;
    }
    // Recorders that know no RF64 write the lower 32 bits of a larger size.
    let size = u64::from(size);
    let missed = remaining.map_or(0, |remaining| remaining.saturating_sub(size) >> 32 << 32);
    Some(size.saturating_add(missed))
}

/// Leaves out the rest of a chunk, and the byte that makes odd sizes even, which is zero; some
/// programs do not write it.
fn skip(input: &mut Input, rest: u64, size: u32) -> Result<(), ReadError> {
    input.skip(rest)?;
    if size % 2 == 1 && input.look_ahead(1)? == [0] {
        input.skip(1)?;
    }
    Ok(())
}

/// A number of 32 bits, from its four bytes.
fn number(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}
