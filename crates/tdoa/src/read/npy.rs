//! NumPy arrays. Own code because npyz 0.9 overflows (and in debug builds panics) on the product of
//! a damaged shape.
//!
//! The format: "\x93NUMPY", major and minor version, the header's length (2 bytes in version 1,
//! else 4, little endian), the header as a Python dictionary of `descr`, `fortran_order` and
//! `shape`, then the raw elements.

use std::io::Read;

use super::error::ReadError;
use crate::pseudoranges::{MAX_CELLS, Pseudoranges};

/// Headers of plain arrays have 118 bytes.
const MAX_HEADER: usize = 1 << 16;

pub(super) fn parse(mut source: impl Read, file: &str, factor: f64) -> Result<Pseudoranges, ReadError> {
    let bad = |problem: String| ReadError::Npy { file: file.to_string(), problem };
    let header = header(&mut source).map_err(|problem| bad(problem.to_string()))?;
    let field = |name: &str| value_of(&header, name).ok_or_else(|| bad(format!("has no {name} in its header")));
    let kind = field("descr")?;
    let decode = decoder(kind).ok_or_else(|| bad(format!("holds {}; real numbers are needed", described(kind))))?;
    let fortran = field("fortran_order")?.starts_with("True");
    let sizes = sizes(field("shape")?).ok_or_else(|| bad("has an unreadable shape in its header".to_string()))?;
    let &[rows, columns] = sizes.as_slice() else {
        let problem = match sizes.as_slice() {
            [] => "holds a single number".to_string(),
            [size] => format!("holds one row of {size}"),
            more => format!("has {} dimensions", more.len()),
        };
        return Err(bad(format!("{problem}; two dimensions are needed, receivers and transmitters")));
    };
    let Some(cells) = rows.checked_mul(columns).filter(|&cells| cells <= MAX_CELLS) else {
        return Err(bad(format!("has {rows} x {columns} cells, more than {MAX_CELLS}")));
    };
    if cells == 0 {
        return Err(ReadError::Empty { file: file.to_string() });
    }
    let mut bytes = vec![0u8; cells * decode.size];
    source.read_exact(&mut bytes).map_err(|_| bad(format!("ends before its {cells} elements")))?;
    let stored: Vec<f64> = bytes.chunks_exact(decode.size).map(decode.value).collect();
    let at = |i: usize, j: usize| if fortran { stored[j * rows + i] } else { stored[i * columns + j] };
    let values = (0..cells).map(|k| at(k / columns, k % columns) * factor).collect();
    Pseudoranges::new(rows, columns, values).map_err(|source| ReadError::Matrix { file: file.to_string(), source })
}

fn header(source: &mut impl Read) -> Result<String, &'static str> {
    const CUT: &str = "ends within its header";
    let mut start = [0u8; 8];
    source.read_exact(&mut start).map_err(|_| "is not a .npy file")?;
    if &start[..6] != b"\x93NUMPY" {
        return Err("is not a .npy file");
    }
    let mut length = [0u8; 4];
    let width = if start[6] == 1 { 2 } else { 4 };
    source.read_exact(&mut length[..width]).map_err(|_| CUT)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_HEADER {
        return Err("has a header too long for a plain array");
    }
    let mut header = vec![0u8; length];
    source.read_exact(&mut header).map_err(|_| CUT)?;
    String::from_utf8(header).map_err(|_| "has a header that is no text")
}

/// The sizes of a shape, such as `(2, 3)`.
fn sizes(shape: &str) -> Option<Vec<usize>> {
    let (inner, _) = shape.strip_prefix('(')?.split_once(')')?;
    inner.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect()
}

/// What follows `'name':` in the header.
fn value_of<'a>(header: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{name}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// In words, what elements that cannot be read are: byte order, a letter and a size, as in `<c16`.
fn described(kind: &str) -> String {
    let Some(quoted) = kind.strip_prefix(['\'', '"']) else { return "records of several fields".to_string() };
    let code = quoted.split(['\'', '"']).next().unwrap_or_default().trim_start_matches(['<', '>', '|', '=']);
    let words = match code.chars().next() {
        Some('c') => "complex numbers",
        Some('b' | '?') => "truth values",
        Some('u') => "whole numbers without a sign",
        Some('i') => "whole numbers of another size or byte order than is read",
        Some('f') => "floats of another size than is read",
        Some('U' | 'S' | 'a') => "text",
        Some('M' | 'm') => "dates or time spans",
        Some('O') => "Python objects",
        Some('V') => "raw bytes",
        _ => return "elements of an unknown type".to_string(),
    };
    // What is no short code is left out.
    let is_code = code.len() <= 6 && code.chars().all(|c| c.is_ascii_alphanumeric());
    if is_code { format!("{words} ({code})") } else { words.to_string() }
}

/// Name, size in bytes and conversion of an element type.
type Kind = (&'static str, usize, fn(&[u8]) -> f64);

struct Decoder {
    size: usize,
    value: fn(&[u8]) -> f64,
}

/// Copies a chunk of the right size.
fn take<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(bytes);
    array
}

fn decoder(kind: &str) -> Option<Decoder> {
    let kinds: [Kind; 8] = [
        ("<f8", 8, |b| f64::from_le_bytes(take(b))),
        (">f8", 8, |b| f64::from_be_bytes(take(b))),
        ("<f4", 4, |b| f32::from_le_bytes(take(b)).into()),
        (">f4", 4, |b| f32::from_be_bytes(take(b)).into()),
        ("<i8", 8, |b| i64::from_le_bytes(take(b)) as f64),
        ("<i4", 4, |b| i32::from_le_bytes(take(b)).into()),
        ("<i2", 2, |b| i16::from_le_bytes(take(b)).into()),
        ("|i1", 1, |b| i8::from_le_bytes(take(b)).into()),
    ];
    let quoted = kind.strip_prefix(['\'', '"'])?;
    let (_, size, value) = kinds.into_iter().find(|(name, ..)| quoted.starts_with(name))?;
    Some(Decoder { size, value })
}
