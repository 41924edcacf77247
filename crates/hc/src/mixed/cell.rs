//! A mixed cell as its edges and their duals.
//!
//! A cell has two points `a_j`, `b_j` of every configuration `j`. With the edges `E_j = a_j - b_j`
//! and `V = |det(E_0 .. E_{n-1})|`, the duals are the integer vectors `u_j` with `<u_j, E_i> = V`
//! for `i = j`, and zero otherwise. The circuit of any other point `g` of configuration `c` on the
//! columns of the Cayley matrix has the entries `t_j = <u_j, g - b_c>`:
//! `V (g - b_c) = sum_j t_j E_j`.

use super::error::Overflow;
use super::integer::Integer;
use super::points::{Column, LANES, Points};

/// Which point of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EdgeEnd {
    First,
    Second,
}

/// One point of an edge replaced by another of the same configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flip {
    pub(super) end: EdgeEnd,
    pub(super) column: Column,
}

#[derive(Clone, Debug)]
pub(super) struct Cell<T> {
    /// The points of each edge.
    pub(super) pairs: Vec<[u32; 2]>,
    pub(super) volume: T,
    /// `duals[j * width + l]`.
    duals: Vec<T>,
    /// Largest size of an entry of each dual.
    bounds: Vec<T>,
    width: usize,
}

impl<T: Integer> Cell<T> {
    /// The mixed cell of `n` standard simplices: with the lifting of the first point the largest,
    /// the second next, and so on, its edges are `(j, j + 1)`.
    pub(super) fn of_simplices(n: usize) -> Option<Self> {
        let width = n.next_multiple_of(LANES);
        let minus = T::narrow(-1)?;
        let one = T::narrow(1)?;
        let mut duals = vec![T::default(); n * width];
        // e_l = -(E_0 + .. + E_l), with e_0 the first unit vector.
        for j in 0..n {
            duals[j * width + j..j * width + n].fill(minus);
        }
        let pairs = (0..n as u32).map(|j| [j, j + 1]).collect();
        Some(Cell { pairs, volume: one, duals, bounds: vec![one; n], width })
    }

    #[inline(always)]
    pub(super) fn dual(&self, j: usize) -> &[T] {
        &self.duals[j * self.width..(j + 1) * self.width]
    }

    /// The largest entry of a dual.
    pub(super) fn largest_dual(&self) -> T {
        self.bounds.iter().copied().fold(T::default(), T::max)
    }

    /// Makes this cell a copy of another of the same size, without allocation.
    pub(super) fn assign(&mut self, other: &Self) {
        self.pairs.copy_from_slice(&other.pairs);
        self.volume = other.volume;
        self.duals.copy_from_slice(&other.duals);
        self.bounds.copy_from_slice(&other.bounds);
    }

    /// This cell in integers of another size, if it fits.
    pub(super) fn converted<U: Integer>(&self, points: &Points<U>) -> Option<Cell<U>> {
        let convert = |v: &T| U::narrow(v.wide());
        let bounds = self.bounds.iter().map(convert).collect::<Option<Vec<U>>>()?;
        if bounds.iter().any(|b| *b >= points.limit) {
            return None;
        }
        Some(Cell {
            pairs: self.pairs.clone(),
            volume: U::narrow(self.volume.wide())?,
            duals: self.duals.iter().map(convert).collect::<Option<Vec<U>>>()?,
            bounds,
            width: self.width,
        })
    }

    /// Entries of the circuit of a column from configuration `from` on.
    #[inline(always)]
    pub(super) fn circuit(&self, points: &Points<T>, stage: usize, column: Column, from: usize, entries: &mut [T]) {
        let base = Column { config: column.config, point: self.pairs[column.config][1] };
        for j in from..points.n {
            let dual = self.dual(j);
            entries[j] = T::difference(points.value(dual, stage, column), points.value(dual, stage, base));
        }
    }

    /// Does a flip, given the circuit of its column, whose entry at the point that leaves is
    /// positive; unchanged on overflow.
    #[inline(always)]
    pub(super) fn flip(&mut self, points: &Points<T>, flip: Flip, circuit: &[T]) -> Result<(), Overflow> {
        let (n, width) = (points.n, self.width);
        let i = flip.column.config;
        let zero = T::default();
        // With d the entry at the point that leaves: u'_j = (d u_j -/+ t_j u_i) / V, the dual u_i
        // stays.
        let d = if flip.end == EdgeEnd::First { circuit[i] } else { T::difference(self.volume, circuit[i]) };
        if d.wide() >= T::HALF as i128 {
            return Err(Overflow);
        }
        let divisor = T::divisor(self.volume);
        let is_same = d == self.volume;
        let factor = |j: usize| if flip.end == EdgeEnd::First { circuit[j].negated() } else { circuit[j] };
        let touched = |j: usize| j != i && !(is_same && circuit[j] == zero);
        for j in (0..n).filter(|&j| touched(j)) {
            if T::surely_below(d, self.bounds[j], circuit[j].size(), self.bounds[i], &divisor, points.limit) {
                continue;
            }
            let (f, pivot) = (factor(j), self.dual(i));
            for (&x, &y) in self.dual(j).iter().zip(pivot) {
                if T::checked_exact(d, x, f, y, &divisor).is_none_or(|q| q.size() >= points.limit) {
                    return Err(Overflow);
                }
            }
        }
        let (before, rest) = self.duals.split_at_mut(i * width);
        let (pivot, after) = rest.split_at_mut(width);
        for j in (0..n).filter(|&j| touched(j)) {
            let f = factor(j);
            let dual =
                if j < i { &mut before[j * width..][..width] } else { &mut after[(j - i - 1) * width..][..width] };
            let mut bound = [zero; LANES];
            for (dual, pivot) in dual.chunks_exact_mut(LANES).zip(pivot.chunks_exact(LANES)) {
                for l in 0..LANES {
                    dual[l] = T::exact(d, dual[l], f, pivot[l], &divisor);
                    bound[l] = bound[l].max(dual[l].size());
                }
            }
            self.bounds[j] = bound.iter().copied().fold(zero, T::max);
        }
        self.volume = d;
        self.pairs[i][usize::from(flip.end == EdgeEnd::Second)] = flip.column.point;
        Ok(())
    }

    /// From the end of stage `k - 1` to the start of stage `k`: the simplex of configuration `k`
    /// grows by its degree; unchanged on overflow.
    pub(super) fn enter(&mut self, points: &Points<T>, k: usize) -> Result<(), Overflow> {
        let degree = points.degrees[k].wide();
        let fits = |x: T, limit: i128| x.wide().checked_mul(degree).is_some_and(|y| y < limit);
        let limit = points.limit.wide();
        if !fits(self.volume, T::HALF as i128) || (0..points.n).any(|j| j != k && !fits(self.bounds[j], limit)) {
            return Err(Overflow);
        }
        let degree = points.degrees[k];
        let times = |x: &mut T| *x = T::accumulate(T::default(), *x, degree);
        for j in (0..points.n).filter(|&j| j != k) {
            self.duals[j * self.width..(j + 1) * self.width].iter_mut().for_each(times);
            times(&mut self.bounds[j]);
        }
        times(&mut self.volume);
        Ok(())
    }

    /// Renumbers the points of configuration `k`, all of which belong to its support, without the corners of
    /// the simplex.
    pub(super) fn leave(&mut self, points: &Points<T>, k: usize) {
        let corners = points.n as u32 + 1;
        for p in self.pairs[k].iter_mut() {
            *p -= corners;
        }
    }
}
