//! The points of all supports, for inner products with many duals.
//!
//! Stage `k` of a search has the supports `A_0 .. A_{k-1}`, then `d_k Delta` together with `A_k`,
//! then standard simplices `Delta`. Points of a configuration are numbered: first the corners of a
//! simplex (the origin and the unit vectors), then the points of a support in their order.

use super::integer::Integer;

/// Duals are padded with zeros to whole vectors of this length.
pub(super) const LANES: usize = 8;

/// A point of a configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Column {
    pub(super) config: usize,
    pub(super) point: u32,
}

pub(super) struct Points<T> {
    /// Number of unknowns.
    pub(super) n: usize,
    /// Degree of each support, once its least exponents are zero.
    pub(super) degrees: Vec<T>,
    /// First point of each support, and the number of points.
    pub(super) first: Vec<usize>,
    /// `coordinates[l * stride + p]`, the stride rounded up to whole vectors.
    coordinates: Vec<T>,
    pub(super) stride: usize,
    /// The nonzero coordinates of each point, and where they begin.
    terms: Vec<(u32, T)>,
    first_term: Vec<usize>,
    /// Duals stay below this, so that their inner products with differences of points stay below
    /// [`Integer::HALF`].
    pub(super) limit: T,
    /// Twice the largest degree: inner products with differences of points are at most so many
    /// times as large as the dual.
    pub(super) reach: u128,
}

impl<T: Integer> Points<T> {
    /// The points of supports whose least exponents are zero; `None` if the integers are too small.
    pub(super) fn new(supports: &[Vec<Vec<i64>>]) -> Option<Self> {
        let n = supports.len();
        let mut first = vec![0];
        for s in supports.iter() {
            first.push(first[first.len() - 1] + s.len());
        }
        let total = first[n];
        let stride = total.next_multiple_of(LANES);
        let mut coordinates = vec![T::default(); n * stride];
        let (mut terms, mut first_term) = (Vec::new(), vec![0]);
        let mut degrees = Vec::with_capacity(n);
        let mut highest = 1i128;
        for (p, point) in supports.iter().flatten().enumerate() {
            for (l, &x) in point.iter().enumerate().filter(|(_, x)| **x != 0) {
                coordinates[l * stride + p] = T::narrow(i128::from(x))?;
                terms.push((l as u32, T::narrow(i128::from(x))?));
            }
            first_term.push(terms.len());
        }
        for support in supports {
            let degree = support.iter().map(|p| p.iter().map(|&x| i128::from(x)).sum()).max().unwrap_or(0);
            highest = highest.max(degree);
            degrees.push(T::narrow(degree)?);
        }
        let reach = 2 * highest.unsigned_abs();
        let limit = T::narrow((T::HALF / reach) as i128)?;
        Some(Points { reach, n, degrees, first, coordinates, stride, terms, first_term, limit })
    }

    /// Inner product of a dual with a point at stage `stage`.
    #[inline(always)]
    pub(super) fn value(&self, dual: &[T], stage: usize, column: Column) -> T {
        let Column { config, point } = column;
        let point = point as usize;
        if config > stage {
            return if point == 0 { T::default() } else { dual[point - 1] };
        }
        let mut own = point;
        if config == stage {
            if point == 0 {
                return T::default();
            }
            if point <= self.n {
                return T::accumulate(T::default(), self.degrees[config], dual[point - 1]);
            }
            own = point - self.n - 1;
        }
        let p = self.first[config] + own;
        let mut sum = T::default();
        for &(l, x) in &self.terms[self.first_term[p]..self.first_term[p + 1]] {
            sum = T::accumulate(sum, x, dual[l as usize]);
        }
        sum
    }

    /// Inner products of a dual with the first `count` points of the supports.
    #[inline(always)]
    pub(super) fn values(&self, dual: &[T], count: usize, values: &mut [T]) {
        let whole = count.next_multiple_of(LANES);
        let values = &mut values[..whole];
        values.fill(T::default());
        for l in 0..self.n {
            let factor = dual[l];
            if factor == T::default() {
                continue;
            }
            let row = &self.coordinates[l * self.stride..l * self.stride + whole];
            for (v, &x) in values.iter_mut().zip(row) {
                *v = T::accumulate(*v, factor, x);
            }
        }
    }
}
