//! Fingerprints of points: where paths were, in two numbers each. This is enough to tell which paths
//! may have met, without keeping their points.

use crate::distinct::{projection, relative_distance};
use crate::store::{Records, Sorter};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;

/// A projection and the size of a point, and the point itself if it is to be compared in full.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fingerprint {
    key: f64,
    size: f64,
    point: Option<Vec<Complex64>>,
}

impl Fingerprint {
    /// The fingerprint of a point; with `keep` the point stays with it.
    pub(super) fn new(point: &[Complex64], keep: bool) -> Fingerprint {
        let size = point.iter().map(|z| z.re.abs() + z.im.abs()).sum();
        Fingerprint { key: projection(point), size, point: keep.then(|| point.to_vec()) }
    }

    /// The point, if it is kept.
    pub(super) fn point(&self) -> Option<&[Complex64]> {
        self.point.as_deref()
    }
}

/// A projection and roughly the size of a point for every path, twelve bytes; the points themselves
/// only of few.
pub(super) struct Fingerprints {
    paths: usize,
    /// None until a path has a point.
    records: Option<Records>,
    points: BTreeMap<usize, Vec<Complex64>>,
}

/// Bound on what the lower half of a double adds, relative, with a margin.
const ROUGH: f64 = 1.0 / (1 << 19) as f64;

/// Bytes of a fingerprint.
const WIDTH: usize = 12;

/// A fingerprint in bytes, of which the first eight are not all zero and in the order of the keys.
fn written(key: f64, size: f64) -> [u8; WIDTH] {
    let bits = key.to_bits();
    let ordered = if key.is_sign_negative() { !bits } else { bits | 1 << 63 };
    let mut record = [0; WIDTH];
    record[..8].copy_from_slice(&ordered.to_be_bytes());
    // The upper half of the double.
    record[8..].copy_from_slice(&((size.to_bits() >> 32) as u32).to_be_bytes());
    record
}

/// Key and rough size of a fingerprint.
fn read(record: &[u8]) -> (f64, f64) {
    let number = |bytes: &[u8]| bytes.iter().fold(0u64, |number, &byte| number << 8 | u64::from(byte));
    let ordered = number(&record[..8]);
    let key = f64::from_bits(if ordered >> 63 == 1 { ordered ^ 1 << 63 } else { !ordered });
    (key, f64::from_bits(number(&record[8..WIDTH]) << 32))
}

impl Fingerprints {
    pub(super) fn new(paths: usize) -> Self {
        Fingerprints { paths, records: None, points: BTreeMap::new() }
    }

    pub(super) fn forget(&mut self, path: usize) {
        if let Some(records) = &mut self.records {
            records.set(path, &[0; WIDTH]);
            self.points.remove(&path);
        }
    }

    /// Notes where a path was.
    pub(super) fn note(&mut self, path: usize, fingerprint: &Fingerprint) {
        self.forget(path);
        if !fingerprint.key.is_nan() {
            let record = written(fingerprint.key, fingerprint.size);
            self.records.get_or_insert_with(|| Records::new(WIDTH)).set(path, &record);
        }
        if let Some(point) = &fingerprint.point {
            self.points.insert(path, point.clone());
        }
    }

    /// Paths that may share a point: all that are within the relative distance `tolerance` of another,
    /// and perhaps some that merely look so because one of the two points is not kept.
    ///
    /// # Errors
    /// If fingerprints cannot be read back.
    pub(super) fn coinciding(&mut self, tolerance: f64) -> io::Result<Vec<usize>> {
        let Some(records) = &mut self.records else { return Ok(Vec::new()) };
        let mut sorter = Sorter::new(8 + 8 + 4);
        for path in 0..self.paths {
            let record = records.get(path);
            if record[..8] != [0; 8] {
                let [key, size] = [&record[..8], &record[8..]];
                sorter.push(&[key, &(path as u64).to_be_bytes(), size].concat());
            }
        }
        if records.is_broken() {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let mut met = Vec::new();
        let mut sorted = Sorter::merged(vec![sorter])?;
        // Those before that may still be near.
        let mut before: Vec<(f64, usize, f64)> = Vec::new();
        while let Some(record) = sorted.next()? {
            let (key, size) = read(&[&record[..8], &record[16..]].concat());
            let b = record[8..16].iter().fold(0, |path, &byte| path << 8 | usize::from(byte));
            // Projections have coefficients of size at most one; sizes of coinciding points are
            // nearly equal.
            before.retain(|&(other, _, size)| key - other <= 4.0 * tolerance * size);
            for &(other, a, other_size) in &before {
                let largest = size.max(other_size) * (1.0 + ROUGH);
                let same = match (self.points.get(&a), self.points.get(&b)) {
                    (Some(x), Some(y)) => relative_distance(x, y) <= tolerance,
                    _ => (other_size - size).abs() <= (2.0 * tolerance + ROUGH) * largest,
                };
                if same && key - other <= 2.0 * tolerance * largest {
                    met.extend([a, b]);
                }
            }
            before.push((key, b, size));
        }
        met.sort_unstable();
        met.dedup();
        Ok(met)
    }
}

#[cfg(test)]
mod tests {
    use super::{Fingerprint, Fingerprints};
    use num_complex::Complex64;

    #[test]
    fn finds_paths_that_have_met() {
        let z = |re: f64, im: f64| Complex64::new(re, im);
        let points = [[z(1.0, 0.5), z(-2.0, 0.0)], [z(1.0, 0.5), z(-2.0, 1e-13)], [z(1.0, 0.5), z(-2.0, 1e-3)]];
        let mut fingerprints = Fingerprints::new(5);
        for (k, x) in points.iter().enumerate() {
            fingerprints.note(k + 1, &Fingerprint::new(x, false));
        }
        assert_eq!(fingerprints.coinciding(1e-11).unwrap(), [1, 2]);
        fingerprints.forget(1);
        assert_eq!(fingerprints.coinciding(1e-11).unwrap(), [0usize; 0]);
        // A small coordinate beside a large one shows only in points that are kept.
        for keep in [false, true] {
            fingerprints.note(0, &Fingerprint::new(&[z(1e9, 0.0), z(0.0, 0.0)], keep));
            fingerprints.note(1, &Fingerprint::new(&[z(1e9, 0.0), z(1e-5, 0.0)], keep));
            assert_eq!(fingerprints.coinciding(1e-9).unwrap(), [0, 1]);
            assert_eq!(fingerprints.coinciding(1e-11).unwrap(), if keep { vec![] } else { vec![0, 1] });
        }
    }

    #[test]
    fn points_of_any_size_are_told_apart() {
        let mut random = crate::random::Random::new(0, 5);
        let mut fingerprints = Fingerprints::new(8_000);
        let mut last = Vec::new();
        for path in 0..7_999 {
            let size = 10f64.powi(path as i32 % 601 - 300);
            last = random.normals(4).iter().map(|z| z * size).collect();
            fingerprints.note(path, &Fingerprint::new(&last, false));
        }
        assert_eq!(fingerprints.coinciding(1e-11).unwrap(), [0usize; 0]);
        fingerprints.note(7_999, &Fingerprint::new(&last, false));
        assert_eq!(fingerprints.coinciding(1e-11).unwrap(), [7_998, 7_999]);
    }
}
