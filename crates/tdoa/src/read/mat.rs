//! MATLAB's .mat files, level 5 (what `save` and scipy write unless told otherwise). Own code
//! because matfile 0.5 prints to standard output, overflows on damaged lengths and unpacks without
//! a bound.
//!
//! The format (MathWorks, "MAT-File Format", 2023): 128 bytes of header whose last four are the
//! version and `IM` if little endian; then elements, each a tag of type and size (4 bytes each, or
//! 2 each with the data in the other 4) and data padded to 8 bytes. Variables are of type 14, or of
//! type 15, which is one of type 14 packed by zlib. A numeric variable has the sub-elements flags,
//! dimensions, name and values, columns first.

use std::io::Read;
use std::ops::Range;

use super::error::{MAX_BYTES, ReadError};
use super::numbers::shorten;
use crate::pseudoranges::{MAX_CELLS, Pseudoranges};

/// Bytes of a variable that are unpacked: values of [`MAX_CELLS`] doubles, and what stands before
/// them.
const MAX_VARIABLE: usize = 8 * MAX_CELLS + MAX_START;

/// Bytes of a packed variable that surely hold its name.
const MAX_START: usize = 4096;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// A two-dimensional array of real numbers.
pub(super) struct Variable {
    pub(super) rows: usize,
    pub(super) columns: usize,
    values: Vec<f64>,
}

impl Variable {
    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        self.values[column * self.rows + row]
    }
}

/// Reads the matrix of this name; without one z, or the only matrix that the file has.
pub(super) fn parse(source: impl Read, file: &str, name: Option<&str>, factor: f64) -> Result<Pseudoranges, ReadError> {
    let found = File::read(source, file)?;
    let has_z = found.entries.iter().any(|entry| entry.name == "z");
    let matrices: Vec<&Entry> = found.entries.iter().filter(|entry| entry.is_matrix()).collect();
    let name = match (name, matrices.as_slice()) {
        (Some(name), _) => name,
        (None, [only]) if !has_z => &only.name,
        (None, _) => "z",
    };
    let Some(values) = found.variable(name)? else {
        return Err(
            found.missing(name, "the matrix of pseudoranges with receivers in rows; choose one with --variable NAME")
        );
    };
    let cells = (0..values.rows * values.columns).map(|k| values.get(k / values.columns, k % values.columns) * factor);
    Pseudoranges::new(values.rows, values.columns, cells.collect())
        .map_err(|source| ReadError::Matrix { file: file.to_string(), source })
}

/// What a file says of one of its variables.
struct Entry {
    name: String,
    /// Rows, columns and further dimensions.
    sizes: Vec<usize>,
    is_numeric: bool,
}

impl Entry {
    /// Whether it may be the measurements: a two-dimensional array of real numbers, no single row
    /// or column, and not the truth.
    fn is_matrix(&self) -> bool {
        let is_truth = ["rgt", "sgt"].contains(&self.name.as_str());
        self.is_numeric && !is_truth && self.sizes.len() == 2 && self.sizes.iter().all(|&size| size > 1)
    }
}

/// A file in memory, with what it says of its variables.
pub(super) struct File<'a> {
    file: &'a str,
    bytes: Vec<u8>,
    order: Order,
    entries: Vec<Entry>,
    /// Type and place of the data of each entry.
    places: Vec<(u32, Range<usize>)>,
}

impl<'a> File<'a> {
    /// Reads the whole file, and the names and sizes of its variables.
    pub(super) fn read(source: impl Read, file: &'a str) -> Result<File<'a>, ReadError> {
        let bad = |problem: &str| ReadError::Mat { file: file.to_string(), problem: problem.to_string() };
        let mut bytes = Vec::new();
        source
            .take(MAX_BYTES)
            .read_to_end(&mut bytes)
            .map_err(|source| ReadError::Io { file: file.to_string(), source })?;
        let Some((header, mut rest)) = bytes.split_at_checked(128) else { return Err(bad("is not a .mat file")) };
        let order = match (&header[124..128], header.starts_with(b"MATLAB 7.3")) {
            (_, true) => return Err(bad("is of version 7.3 (HDF5), which is not read")),
            ([0, 1, b'I', b'M'], _) => Order::Little,
            ([1, 0, b'M', b'I'], _) => Order::Big,
            _ => return Err(bad("is not a .mat file of level 5")),
        };
        let (mut entries, mut places) = (Vec::new(), Vec::new());
        while !rest.is_empty() {
            let damaged = || bad("is cut off or damaged");
            let (kind, data, after) = element(rest, order).ok_or_else(damaged)?;
            let (_, size, begin) = tag(rest, order).ok_or_else(damaged)?;
            let begin = bytes.len() - rest.len() + begin;
            let unpacked;
            let body = match kind {
                MATRIX => data,
                COMPRESSED if !cfg!(feature = "mat") => {
                    let problem =
                        "has compressed variables, which take tdoa's feature `mat`; save with '-v6'".to_string();
                    return Err(ReadError::Variable { file: file.to_string(), problem });
                }
                COMPRESSED => {
                    unpacked = unpack(data, MAX_START);
                    inner(&unpacked, order).unwrap_or(&[])
                }
                _ => &[],
            };
            if let Some(found) = variable_header(body, order) {
                let name = String::from_utf8_lossy(found.name).into_owned();
                entries.push(Entry { name, is_numeric: found.is_numeric(), sizes: found.dimensions });
                places.push((kind, begin..begin + size));
            }
            rest = after;
        }
        Ok(File { file, bytes, order, entries, places })
    }

    /// The variable of this name; `None` if the file has none.
    pub(super) fn variable(&self, name: &str) -> Result<Option<Variable>, ReadError> {
        let Some(at) = self.entries.iter().position(|entry| entry.name == name) else { return Ok(None) };
        let (kind, place) = &self.places[at];
        let data = &self.bytes[place.clone()];
        let unpacked;
        let body = if *kind == COMPRESSED {
            unpacked = unpack(data, MAX_VARIABLE);
            inner(&unpacked, self.order).unwrap_or(&[])
        } else {
            data
        };
        let found = variable_header(body, self.order).ok_or_else(|| "is damaged".to_string());
        let variable = found.and_then(|found| found.variable(self.order)).map_err(|problem| ReadError::Variable {
            file: self.file.to_string(),
            problem: format!("has a variable {name} that {problem}; {}", self.list()),
        })?;
        Ok(Some(variable))
    }

    /// That a variable is not there, what it would be, and which there are.
    pub(super) fn missing(&self, name: &str, meaning: &str) -> ReadError {
        let problem = format!("has no variable {name}, {meaning}; {}", self.list());
        ReadError::Variable { file: self.file.to_string(), problem }
    }

    /// The variables that there are, with their sizes.
    fn list(&self) -> String {
        const LISTED: usize = 20;
        let shown = self.entries.iter().take(LISTED).map(|entry| {
            let sizes: Vec<String> = entry.sizes.iter().map(usize::to_string).collect();
            let kind = if entry.is_numeric { "" } else { ", no numbers" };
            format!("{} ({}{kind})", shorten(&entry.name), sizes.join(" x "))
        });
        let shown: Vec<String> = shown.collect();
        match self.entries.len() {
            0 => "it has no variables".to_string(),
            count if count > LISTED => format!("it has {} and {} more", shown.join(", "), count - LISTED),
            _ => format!("it has {}", shown.join(", ")),
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Order {
    Little,
    Big,
}

impl Order {
    /// The first bytes as a number.
    fn u32(self, bytes: &[u8]) -> Option<u32> {
        let four = *bytes.first_chunk::<4>()?;
        Some(if self == Order::Little { u32::from_le_bytes(four) } else { u32::from_be_bytes(four) })
    }

    /// These bytes in little-endian order.
    fn little<const N: usize>(self, bytes: &[u8]) -> [u8; N] {
        let mut all = [0; N];
        all.copy_from_slice(bytes);
        if self == Order::Big {
            all.reverse();
        }
        all
    }
}

/// Type, size and start of the data of the element at the front.
fn tag(bytes: &[u8], order: Order) -> Option<(u32, usize, usize)> {
    let first = order.u32(bytes)?;
    if first >> 16 != 0 {
        let size = (first >> 16) as usize;
        return (size <= 4).then_some((first & 0xffff, size, 4));
    }
    let size = usize::try_from(order.u32(bytes.get(4..)?)?).ok()?;
    Some((first, size, 8))
}

/// Type and data of the element at the front, and what follows it.
fn element(bytes: &[u8], order: Order) -> Option<(u32, &[u8], &[u8])> {
    let (kind, size, start) = tag(bytes, order)?;
    let end = start.checked_add(size)?;
    let data = bytes.get(start..end)?;
    let padded = if start == 4 {
        8
    } else if kind == COMPRESSED {
        end
    } else {
        end.checked_next_multiple_of(8)?
    };
    Some((kind, data, bytes.get(padded..).unwrap_or(&[])))
}

/// The first bytes of a packed element, as far as it can be unpacked.
#[cfg(feature = "mat")]
fn unpack(data: &[u8], most: usize) -> Vec<u8> {
    let mut unpacked = Vec::new();
    // On an error, what came before it remains.
    let _ = flate2::read::ZlibDecoder::new(data).take(most as u64).read_to_end(&mut unpacked);
    unpacked
}

/// Nothing: files with packed elements are refused.
#[cfg(not(feature = "mat"))]
fn unpack(_: &[u8], _: usize) -> Vec<u8> {
    Vec::new()
}

/// The variable in an unpacked element. Its tag may promise more than was unpacked; that is noticed
/// where it is needed.
fn inner(unpacked: &[u8], order: Order) -> Option<&[u8]> {
    match tag(unpacked, order)? {
        (MATRIX, _, start) => unpacked.get(start..),
        _ => None,
    }
}

/// What a variable begins with, and the rest.
struct VariableHeader<'a> {
    name: &'a [u8],
    flags: u32,
    dimensions: Vec<usize>,
    rest: &'a [u8],
}

/// `None` for a damaged variable.
fn variable_header(body: &[u8], order: Order) -> Option<VariableHeader<'_>> {
    let (_, flags, rest) = element(body, order)?;
    let (_, dimensions, rest) = element(rest, order)?;
    let (_, name, rest) = element(rest, order)?;
    let sizes = dimensions.chunks_exact(4).map(|size| order.u32(size).map(|size| size as usize));
    Some(VariableHeader { name, flags: order.u32(flags)?, dimensions: sizes.collect::<Option<_>>()?, rest })
}

impl VariableHeader<'_> {
    /// Whether it is an array of real numbers: classes 6 to 15 are numeric, bit 11 says complex.
    fn is_numeric(&self) -> bool {
        (6..=15).contains(&(self.flags & 0xff)) && self.flags & 0x800 == 0
    }

    fn variable(&self, order: Order) -> Result<Variable, String> {
        if !self.is_numeric() {
            return Err("is no array of real numbers".to_string());
        }
        let &[rows, columns] = self.dimensions.as_slice() else {
            return Err(format!("has {} dimensions instead of two", self.dimensions.len()));
        };
        let cells = rows.checked_mul(columns).filter(|&cells| cells <= MAX_CELLS);
        let cells = cells.ok_or_else(|| format!("has {rows} x {columns} cells, more than {MAX_CELLS}"))?;
        let (kind, data, _) = element(self.rest, order).ok_or("is cut off")?;
        let (width, number) = decoder(kind).ok_or("is no array of real numbers")?;
        if data.len() != cells * width {
            return Err(format!("has {} bytes where {cells} values are expected", data.len()));
        }
        let values = data.chunks_exact(width).map(|bytes| number(bytes, order)).collect();
        Ok(Variable { rows, columns, values })
    }
}

/// Size in bytes and conversion of a stored number.
type Decoder = (usize, fn(&[u8], Order) -> f64);

fn decoder(kind: u32) -> Option<Decoder> {
    Some(match kind {
        1 => (1, |b, order| i8::from_le_bytes(order.little(b)).into()),
        2 => (1, |b, order| u8::from_le_bytes(order.little(b)).into()),
        3 => (2, |b, order| i16::from_le_bytes(order.little(b)).into()),
        4 => (2, |b, order| u16::from_le_bytes(order.little(b)).into()),
        5 => (4, |b, order| i32::from_le_bytes(order.little(b)).into()),
        6 => (4, |b, order| u32::from_le_bytes(order.little(b)).into()),
        7 => (4, |b, order| f32::from_le_bytes(order.little(b)).into()),
        9 => (8, |b, order| f64::from_le_bytes(order.little(b))),
        12 => (8, |b, order| i64::from_le_bytes(order.little(b)) as f64),
        13 => (8, |b, order| u64::from_le_bytes(order.little(b)) as f64),
        _ => return None,
    })
}

#[cfg(all(test, feature = "mat"))]
mod tests {
    use proptest::prelude::{any, prop_assert, proptest};

    use super::*;

    /// Written by scipy.io.savemat (1.17.1) without and with do_compression: counts = uint8 [[1,
    /// 200, 3]], label = "text", z = [[1, 2.5, nan], [4, 5, -6]], rgt = [[0, 1], [2, 3], [0, 0]].
    const PLAIN: &[u8] = include_bytes!("plain.mat");
    const PACKED: &[u8] = include_bytes!("packed.mat");

    #[test]
    fn matrices_as_scipy_writes_them() {
        for file in [PLAIN, PACKED] {
            let f = parse(file, "f.mat", Some("z"), 2.0).unwrap();
            assert_eq!((f.receivers(), f.transmitters(), f.observed()), (2, 3, 5));
            assert_eq!((f.get(0, 1), f.get(0, 2), f.get(1, 0), f.get(1, 2)), (Some(5.0), None, Some(8.0), Some(-12.0)));
            let counts = File::read(file, "f.mat").unwrap().variable("counts").unwrap().unwrap();
            assert_eq!((counts.rows, counts.columns, counts.get(0, 1)), (1, 3, 200.0));
            let all = File::read(file, "f.mat").unwrap();
            assert!(all.variable("nothing").unwrap().is_none());
            let error = all.variable("label").map(|_| ()).unwrap_err().to_string();
            assert!(error.contains("no array of real numbers"), "{error}");
            let error = parse(file, "f.mat", Some("Z"), 1.0).unwrap_err().to_string();
            for part in [
                "has no variable Z",
                "counts (1 x 3)",
                "label (1 x 4, no numbers)",
                "z (2 x 3)",
                "rgt (3 x 2)",
                "--variable",
            ] {
                assert!(error.contains(part), "{part} is not in: {error}");
            }
        }
    }

    #[test]
    fn what_is_no_such_file() {
        let says = |bytes: &[u8], part: &str| {
            let error = parse(bytes, "f.mat", None, 1.0).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        };
        says(b"", "is not a .mat file");
        says(&[7; 200], "is not a .mat file of level 5");
        says(&[b"MATLAB 7.3 MAT-file".as_slice(), &[b' '; 200]].concat(), "version 7.3");
        says(&PLAIN[..128], "has no variable z");
        // The last variable, rgt, has 112 bytes with its tag.
        says(&PLAIN[..PLAIN.len() - 120], "is cut off or damaged");
    }

    proptest! {
        /// Damaged files give errors or other numbers, never a panic.
        #[test]
        fn damage_does_no_harm(packed: bool, at in 0usize..2000, byte: u8, cut in 0usize..2000) {
            let mut file = if packed { PACKED } else { PLAIN }.to_vec();
            let length = file.len();
            file[at % length] = byte;
            file.truncate(length - cut % 64);
            if let Ok(f) = parse(&*file, "f.mat", None, 1.0) {
                prop_assert!(f.receivers() * f.transmitters() <= MAX_CELLS);
            }
        }

        #[test]
        fn garbage_after_a_header(tail in proptest::collection::vec(any::<u8>(), 0..300)) {
            let file = [&PLAIN[..128], &tail].concat();
            let _ = parse(&*file, "f.mat", None, 1.0);
        }
    }
}
