//! Fibres in few bytes: solutions to four or five digits, which Newton's method brings back to all.
//!
//! A large fibre takes a tenth of its JSON, and can be part of a program. The bytes, all numbers the least
//! significant byte first:
//!
//! * `hcf1`, then as 32 bits each the numbers of parameters, unknowns `n`, solutions, and solutions in full;
//! * the parameters, real and imaginary part as doubles;
//! * the solutions, five bytes a coordinate: an exponent `e`, and as 16 bits each the real and the imaginary
//!   part in units of `2^e / 32767`;
//! * those in full: 32 bits for the place of the solution, then its `n` coordinates as doubles.

use super::error::FamilyError;
use super::fibre::Fibre;
use crate::distinct::{coincidences, relative_distance};
use crate::refine::Refiner;
use crate::threads::{IntoParallelIterator, ParallelIterator};
use crate::tolerances::{families, same};
use num_complex::Complex64;
use poly::{Evaluate, counted};

/// The first bytes of a packed fibre.
const MARK: [u8; 4] = *b"hcf1";
/// Bytes of the mark and of the numbers of parameters, unknowns, solutions, and solutions in full.
const HEADER: usize = 20;
/// Bytes of a number in full: real and imaginary part.
const FULL: usize = 16;
/// Bytes of a rounded number: the exponent of the larger part, and both parts.
const ROUNDED: usize = 5;
/// The largest part of a rounded number.
const LARGEST: f64 = i16::MAX as f64;

/// Why a fibre cannot be packed or unpacked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackedFibreError {
    /// The bytes are not a packed fibre, or not all of one.
    #[error("not a packed fibre: {found} bytes where {expected} belong; write it anew")]
    Length {
        /// Number of bytes that its header asks for; that of the header where there is none.
        expected: usize,
        /// Number of bytes.
        found: usize,
    },
    /// The bytes begin with something else.
    #[error("not a packed fibre: it does not begin with `hcf1`")]
    Mark,
    /// The fibre is that of another system, or the system has no unknowns.
    #[error(transparent)]
    Family(#[from] FamilyError),
    /// A stored point to which Newton's method finds no solution.
    #[error("solution {index} is none of this system, or singular; compute the fibre anew")]
    NoSolution {
        /// The solution, from 1.
        index: usize,
    },
    /// Stored solutions that are the same.
    #[error("solutions {solutions:?} coincide; compute the fibre anew")]
    Coincident {
        /// The solutions, from 1.
        solutions: Vec<usize>,
    },
    /// More solutions than can be counted in the file.
    #[error("{} of a fibre are too many to be packed", counted(*.count, "number"))]
    TooLarge {
        /// Parameters, unknowns or solutions.
        count: usize,
    },
}

/// The solutions of a fibre in five bytes for each coordinate, from which [`unpack_fibre`] has them
/// back. A solution to which Newton's method does not return from its rounded coordinates is kept in
/// full, as the parameters are.
///
/// ```
/// use hc::family::{Fibre, pack_fibre, unpack_fibre};
/// use hc::{Family, poly::Complex64};
///
/// let family = Family::from_formulas(&["x"], &["a"], &["x^2 = a"])?;
/// let numbers = |all: &[f64]| all.iter().map(|&x| Complex64::from(x)).collect();
/// let fibre = Fibre::new(numbers(&[2.0]), 1, numbers(&[2f64.sqrt(), -2f64.sqrt()]));
/// let bytes = pack_fibre(family.program(), &fibre)?;
/// assert_eq!(bytes.len(), 20 + 16 + 2 * 5);
/// assert_eq!(unpack_fibre(family.program(), &bytes)?.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the fibre does not fit the system, or its solutions are not regular and distinct.
///
/// # Panics
/// If the system does not have as many equations as unknowns.
pub fn pack_fibre<E: Evaluate>(system: &E, fibre: &Fibre) -> Result<Vec<u8>, PackedFibreError> {
    fits(system, fibre.parameters.len(), fibre.dimension)?;
    let solutions = refined(system, &fibre.parameters, fibre.dimension, fibre.solutions.clone())?;
    let rounded: Vec<[u8; ROUNDED]> = solutions.iter().map(|&z| round(z)).collect();
    let near: Vec<Complex64> = rounded.iter().map(|&bytes| number(bytes)).collect();
    let mut refiner = Refiner::new(system);
    let mut returns = |k: usize| {
        let places = k * fibre.dimension..(k + 1) * fibre.dimension;
        let back = refiner.refine(&fibre.parameters, &near[places.clone()]);
        settled(back.accuracy) && relative_distance(&back.point, &solutions[places]) < same::REGULAR
    };
    let full: Vec<usize> = (0..fibre.len()).filter(|&k| !returns(k)).collect();
    let mut bytes = MARK.to_vec();
    for count in [fibre.parameters.len(), fibre.dimension, fibre.len(), full.len()] {
        bytes.extend(u32::try_from(count).map_err(|_| PackedFibreError::TooLarge { count })?.to_le_bytes());
    }
    let in_full = |z: &Complex64| [z.re.to_le_bytes(), z.im.to_le_bytes()].concat();
    bytes.extend(fibre.parameters.iter().flat_map(in_full));
    bytes.extend(rounded.iter().flatten());
    for k in full {
        bytes.extend((k as u32).to_le_bytes());
        bytes.extend(solutions[k * fibre.dimension..(k + 1) * fibre.dimension].iter().flat_map(in_full));
    }
    Ok(bytes)
}

/// The fibre that was packed, its solutions refined to the last digit.
///
/// # Errors
/// If the bytes are not a packed fibre of the system, or what they hold is not made of regular and
/// distinct solutions.
///
/// # Panics
/// If the system does not have as many equations as unknowns.
pub fn unpack_fibre<E: Evaluate>(system: &E, bytes: &[u8]) -> Result<Fibre, PackedFibreError> {
    let short = PackedFibreError::Length { expected: HEADER, found: bytes.len() };
    let (header, rest) = bytes.split_at_checked(HEADER).ok_or(short)?;
    if header[..4] != MARK {
        return Err(PackedFibreError::Mark);
    }
    let count = |k: usize| u32::from_le_bytes([0, 1, 2, 3].map(|b| header[4 * k + b])) as usize;
    let [m, n, solutions, full] = [1, 2, 3, 4].map(count);
    fits(system, m, n)?;
    let sizes = [m * FULL, (n * ROUNDED).saturating_mul(solutions), (4 + n * FULL).saturating_mul(full)];
    let expected = sizes.iter().fold(HEADER, |sum, size| sum.saturating_add(*size));
    if expected != bytes.len() {
        return Err(PackedFibreError::Length { expected, found: bytes.len() });
    }
    let (parameters, rest) = rest.split_at(sizes[0]);
    let (rounded, rest) = rest.split_at(sizes[1]);
    let mut points: Vec<Complex64> = rounded.as_chunks().0.iter().map(|&bytes| number(bytes)).collect();
    for exact in rest.chunks_exact(4 + n * FULL) {
        let (index, exact) = exact.split_at(4);
        let k = u32::from_le_bytes([0, 1, 2, 3].map(|b| index[b])) as usize;
        let place = points.chunks_exact_mut(n).nth(k).ok_or(PackedFibreError::NoSolution { index: k + 1 })?;
        place.copy_from_slice(&numbers(exact));
    }
    let parameters = numbers(parameters);
    let points = refined(system, &parameters, n, points)?;
    Ok(Fibre::new(parameters, n, points))
}

fn fits<E: Evaluate>(system: &E, parameters: usize, unknowns: usize) -> Result<(), FamilyError> {
    if system.variables() == 0 {
        return Err(FamilyError::Underdetermined { equations: system.equations(), unknowns: 0 });
    }
    FamilyError::unless_fits(system, parameters, unknowns)
}

/// The solutions near these points, which must be regular and distinct.
fn refined<E: Evaluate>(
    system: &E,
    parameters: &[Complex64],
    n: usize,
    points: Vec<Complex64>,
) -> Result<Vec<Complex64>, PackedFibreError> {
    let count = points.len() / n;
    let found: Vec<Option<Vec<Complex64>>> = (0..count)
        .into_par_iter()
        .map_init(
            || Refiner::new(system),
            |refiner, k| {
                let refined = refiner.refine(parameters, &points[k * n..(k + 1) * n]);
                let regular = settled(refined.accuracy) && refined.condition < families::STORED_CONDITION;
                regular.then_some(refined.point)
            },
        )
        .collect();
    let mut solutions = Vec::with_capacity(points.len());
    for (k, found) in found.into_iter().enumerate() {
        solutions.extend(found.ok_or(PackedFibreError::NoSolution { index: k + 1 })?);
    }
    let same = coincidences(solutions.chunks_exact(n).enumerate(), same::REGULAR);
    match same.first() {
        Some(group) => Err(PackedFibreError::Coincident { solutions: group.iter().map(|k| k + 1).collect() }),
        None => Ok(solutions),
    }
}

/// Whether Newton's method has found a solution. NaN is none.
fn settled(accuracy: f64) -> bool {
    accuracy < families::STORED_MOVED
}

/// A number to 15 bits of its larger part; what is too large or too small for the exponent becomes the
/// nearest number that is not, and numbers that are not finite some number.
fn round(z: Complex64) -> [u8; ROUNDED] {
    let size = z.re.abs().max(z.im.abs());
    // The power of two above.
    let exponent = ((size.to_bits() >> 52) as i32 - 1022).clamp(i8::MIN.into(), i8::MAX.into());
    let part = |x: f64| ((x / 2f64.powi(exponent) * LARGEST).round() as i16).to_le_bytes();
    let ([a, b], [c, d]) = (part(z.re), part(z.im));
    [(exponent as i8).to_le_bytes()[0], a, b, c, d]
}

/// The number that these bytes stand for.
fn number([exponent, a, b, c, d]: [u8; ROUNDED]) -> Complex64 {
    let unit = 2f64.powi(i8::from_le_bytes([exponent]).into()) / LARGEST;
    let part = |bytes: [u8; 2]| f64::from(i16::from_le_bytes(bytes)) * unit;
    Complex64::new(part([a, b]), part([c, d]))
}

/// Numbers in full.
fn numbers(bytes: &[u8]) -> Vec<Complex64> {
    let pairs: &[[u8; FULL]] = bytes.as_chunks().0;
    let part = |pair: &[u8; FULL], at: usize| f64::from_le_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(|b| pair[at + b]));
    pairs.iter().map(|pair| Complex64::new(part(pair, 0), part(pair, 8))).collect()
}

#[cfg(test)]
mod tests {
    use super::{LARGEST, PackedFibreError, number, pack_fibre, round, unpack_fibre};
    use crate::distinct::relative_distance;
    use crate::family::{Family, FamilyError, Fibre};
    use crate::random::Random;
    use num_complex::Complex64;
    use proptest::prelude::*;

    fn complex(x: f64) -> Complex64 {
        Complex64::new(x, 0.0)
    }

    /// (x - a)^2 = b, y = a x.
    fn roots(a: f64, b: f64) -> (Family, Fibre) {
        let family = Family::from_formulas(&["x", "y"], &["a", "b"], &["(x - a)^2 - b", "y - a*x"]).unwrap();
        let [x, y] = [a + b.sqrt(), a - b.sqrt()];
        let solutions = [x, a * x, y, a * y].map(complex).to_vec();
        (family, Fibre::new(vec![complex(a), complex(b)], 2, solutions))
    }

    #[test]
    fn numbers_keep_fifteen_bits() {
        let mut random = Random::new(5, 0);
        for k in -120..120 {
            let z = random.normal() * 2f64.powi(k);
            let size = z.re.abs().max(z.im.abs());
            let near = number(round(z));
            assert!((near.re - z.re).abs().max((near.im - z.im).abs()) <= size / LARGEST, "{z} {near}");
        }
        assert_eq!(number(round(complex(0.0))), complex(0.0));
        assert_eq!(number(round(complex(0.5))), complex(0.5 / LARGEST * (0.5f64 * LARGEST).round() * 2.0));
    }

    #[test]
    fn solutions_come_back_to_the_last_digit() {
        // In the last case one solution is rounded to the point between them, where the Jacobian is singular, and
        // the other to three times its distance from there, too far for the few steps of refinement.
        for (a, b, full) in [(2.0, 3.0, 0), (1e-6, 1e6, 0), (1.0, 1e-10, 2)] {
            let (family, fibre) = roots(a, b);
            let bytes = pack_fibre(family.program(), &fibre).unwrap();
            assert_eq!(bytes.len(), 20 + 2 * 16 + 4 * 5 + full * (4 + 2 * 16), "{a} {b}");
            let back = unpack_fibre(family.program(), &bytes).unwrap();
            assert_eq!(back.parameters, fibre.parameters);
            for (x, y) in back.iter().zip(fibre.iter()) {
                assert!(relative_distance(x, y) < 1e-15 / b.min(1.0).sqrt(), "{x:?} {y:?}");
            }
        }
    }

    #[test]
    fn what_is_no_fibre_of_the_system_is_refused() {
        let (family, fibre) = roots(2.0, 3.0);
        let pack = |fibre: &Fibre| pack_fibre(family.program(), fibre).unwrap_err();
        let mut twice = fibre.clone();
        twice.solutions.extend_from_within(..2);
        assert_eq!(pack(&twice), PackedFibreError::Coincident { solutions: vec![1, 3] });
        let mut wrong = fibre.clone();
        wrong.solutions[2] = Complex64::new(f64::NAN, 0.0);
        assert_eq!(pack(&wrong), PackedFibreError::NoSolution { index: 2 });
        let mut long = fibre.clone();
        long.parameters.push(complex(1.0));
        assert!(matches!(
            pack(&long),
            PackedFibreError::Family(FamilyError::Misfit { found_parameters: 3, parameters: 2, .. })
        ));

        let bytes = pack_fibre(family.program(), &fibre).unwrap();
        let unpack = |bytes: &[u8]| unpack_fibre(family.program(), bytes).unwrap_err();
        assert_eq!(unpack(&bytes[..9]), PackedFibreError::Length { expected: 20, found: 9 });
        assert_eq!(unpack(&bytes[..70]), PackedFibreError::Length { expected: 72, found: 70 });
        assert_eq!(unpack(&[&b"HCF1"[..], &bytes[4..]].concat()), PackedFibreError::Mark);
        // The second solution overwritten by the first, and one in full that is not there.
        let mut same = bytes.clone();
        same.copy_within(52..62, 62);
        assert_eq!(unpack(&same), PackedFibreError::Coincident { solutions: vec![1, 2] });
        let (near, fibre) = roots(1.0, 1e-10);
        let mut beyond = pack_fibre(near.program(), &fibre).unwrap();
        beyond[72] = 7;
        assert_eq!(unpack_fibre(near.program(), &beyond), Err(PackedFibreError::NoSolution { index: 8 }));
    }

    proptest! {
        #[test]
        fn no_bytes_panic(
            counts in prop::array::uniform4(prop_oneof![0..4u32, Just(u32::MAX)]),
            rest in prop::collection::vec(any::<u8>(), 0..120),
        ) {
            let (family, _) = roots(2.0, 3.0);
            let counts = counts.iter().flat_map(|c| c.to_le_bytes());
            let bytes: Vec<u8> = b"hcf1".iter().copied().chain(counts).chain(rest).collect();
            if let Ok(fibre) = unpack_fibre(family.program(), &bytes) {
                prop_assert!(fibre.solutions.iter().all(|z| z.is_finite()));
            }
        }
    }
}
