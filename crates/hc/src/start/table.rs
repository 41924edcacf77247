//! A mixed cell with the circuits of all other columns of the Cayley matrix.
//!
//! Of every configuration `j` the cell holds two columns `a_j`, `b_j`; `E_j = C_{a_j} - C_{b_j}`, `V = |det(E_1 .. E_n)|`. Row `k` of the
//! table holds the integers `t_kj` with `V (C_k - C_{b_c}) = sum_j t_kj E_j`, `c` the configuration of column `k`. Behind the
//! columns stand the `n` unit vectors `e_l`: `V e_l = sum_j t_lj E_j`.

use super::integer::Integer;
use std::cmp::Ordering;

/// Integers have grown beyond the limit of their type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Overflow;

/// The configuration of each column, columns in the order of configurations.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// First column of each configuration, and the number of columns.
    pub(super) first: Vec<usize>,
    /// Configuration of each column.
    pub(super) config: Vec<usize>,
}

impl Layout {
    pub(super) fn new(sizes: impl IntoIterator<Item = usize>) -> Self {
        let mut layout = Layout { first: vec![0], config: Vec::new() };
        for (i, size) in sizes.into_iter().enumerate() {
            layout.config.extend(std::iter::repeat_n(i, size));
            layout.first.push(layout.config.len());
        }
        layout
    }

    pub(super) fn columns(&self) -> usize {
        self.config.len()
    }
}

/// Which column of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    First,
    Second,
}

#[derive(Clone, Debug)]
pub(super) struct Table<T> {
    /// The pairs of columns.
    pub(super) pairs: Vec<[usize; 2]>,
    pub(super) volume: T,
    /// `entries[j * rows + k]`.
    entries: Vec<T>,
    spare: Vec<T>,
    pub(super) rows: usize,
    /// Bound for the entries and the volume.
    bound: T,
}

impl<T: Integer> Table<T> {
    /// From entries in 128 bits, `entries[j * rows + k]`.
    pub(super) fn new(pairs: Vec<[usize; 2]>, volume: i128, entries: &[i128]) -> Result<Self, Overflow> {
        let bound = entries.iter().map(|e| e.unsigned_abs()).max().unwrap_or(0).max(volume.unsigned_abs());
        if bound >= T::LIMIT.unsigned_abs() {
            return Err(Overflow);
        }
        let entries: Vec<T> = entries.iter().map(|&e| T::narrow(e)).collect();
        let rows = entries.len() / pairs.len();
        let spare = entries.clone();
        Ok(Table { pairs, volume: T::narrow(volume), entries, spare, rows, bound: T::narrow(bound as i128) })
    }

    /// The same cell in 128 bits.
    pub(super) fn widened(&self) -> Table<i128> {
        let entries: Vec<i128> = self.entries.iter().map(|e| e.wide()).collect();
        Table {
            pairs: self.pairs.clone(),
            volume: self.volume.wide(),
            spare: entries.clone(),
            entries,
            rows: self.rows,
            bound: self.bound.wide(),
        }
    }

    pub(super) fn entry(&self, row: usize, j: usize) -> i128 {
        self.entries[j * self.rows + row].wide()
    }

    /// Replaces one column of pair `i` by column `g` of the same configuration; unchanged on overflow.
    pub(super) fn pivot(&mut self, layout: &Layout, i: usize, place: Place, g: usize) -> Result<(), Overflow> {
        let rows = self.rows;
        let (zero, v) = (T::default(), self.volume.wide());
        let t_gi = self.entry(g, i);
        let d = if place == Place::First { t_gi } else { v - t_gi };
        let sign = d.signum();
        // t'_kj = sign (d t_kj -/+ t_ki t_gj) / V, with t_ki - V for t_ki where k is of configuration i and the second is replaced.
        let divisor = T::divisor(self.volume);
        let mut bound = zero;
        let own = layout.first[i]..layout.first[i + 1];
        let shift = T::narrow(if place == Place::Second { v } else { 0 });
        let main = T::narrow(d.abs());
        let pivot_column = &self.entries[i * rows..(i + 1) * rows];
        for j in 0..layout.first.len() - 1 {
            let (from, to) = (&self.entries[j * rows..(j + 1) * rows], &mut self.spare[j * rows..(j + 1) * rows]);
            if j == i {
                let unit = T::narrow(sign);
                let back = T::narrow(if place == Place::Second { -sign * t_gi } else { 0 });
                for k in 0..rows {
                    to[k] = T::accumulate(zero, from[k], unit);
                }
                to[own.clone()].iter_mut().for_each(|x| *x = T::accumulate(*x, back, T::narrow(1)));
                bound = to.iter().fold(bound, |b, x| b.max(x.size()));
                continue;
            }
            let t_gj = self.entries[j * rows + g].wide();
            let other = T::narrow(if place == Place::First { -sign * t_gj } else { sign * t_gj });
            if other == zero && main == self.volume {
                to.copy_from_slice(from);
                bound = to.iter().fold(bound, |b, x| b.max(x.size()));
                continue;
            }
            for k in 0..rows {
                to[k] = T::exact(main, from[k], other, pivot_column[k], &divisor);
            }
            if place == Place::Second {
                let less = T::narrow(-1);
                for k in own.clone() {
                    let q = T::accumulate(pivot_column[k], shift, less);
                    to[k] = T::exact(main, from[k], other, q, &divisor);
                }
            }
            bound = to.iter().fold(bound, |b, x| b.max(x.size()));
        }
        bound = bound.max(main);
        if bound.wide() >= T::LIMIT {
            return Err(Overflow);
        }
        std::mem::swap(&mut self.entries, &mut self.spare);
        self.bound = bound;
        self.volume = main;
        self.pairs[i][if place == Place::First { 0 } else { 1 }] = g;
        Ok(())
    }

    /// The first column whose inequality fails on the way from the symbolic lifting in the direction `tau`, and the two
    /// entries of its circuit at the pair of its configuration.
    pub(super) fn first_violated(
        &self,
        layout: &Layout,
        tau: &[i64],
        dots: &mut Vec<T>,
    ) -> Result<Option<usize>, Overflow> {
        let m = layout.columns();
        let differences: Vec<i64> = self.pairs.iter().map(|p| tau[p[0]] - tau[p[1]]).collect();
        let spread = tau.iter().map(|t| t.unsigned_abs()).max().unwrap_or(0);
        let total: u128 =
            differences.iter().map(|d| u128::from(d.unsigned_abs())).sum::<u128>() + 2 * u128::from(spread);
        let capacity = (T::LIMIT.unsigned_abs()) << if T::LIMIT > 1 << 40 { 61 } else { 32 };
        match total.checked_mul(self.bound.wide().unsigned_abs()) {
            Some(largest) if largest < capacity => {}
            _ => return Err(Overflow),
        }
        dots.clear();
        for k in 0..m {
            let base = tau[self.pairs[layout.config[k]][1]] - tau[k];
            dots.push(T::accumulate(T::default(), self.volume, T::narrow(i128::from(base))));
        }
        for (j, &difference) in differences.iter().enumerate().filter(|(_, d)| **d != 0) {
            let factor = T::narrow(i128::from(difference));
            let column = &self.entries[j * self.rows..j * self.rows + m];
            dots.iter_mut().zip(column).for_each(|(dot, &t)| *dot = T::accumulate(*dot, t, factor));
        }
        let mut first: Option<usize> = None;
        for k in 0..m {
            if dots[k] < T::default() {
                first = match first {
                    Some(best) if !self.before(layout, (k, dots[k].wide()), (best, dots[best].wide()))? => Some(best),
                    _ => Some(k),
                };
            }
        }
        Ok(first)
    }

    /// Whether the inequality of column `k` fails before that of column `l`: lexicographic order of the circuits, each
    /// times the other's rate.
    fn before(&self, layout: &Layout, (k, dot_k): (usize, i128), (l, dot_l): (usize, i128)) -> Result<bool, Overflow> {
        let mut columns = Vec::with_capacity(4);
        for (j, pair) in self.pairs.iter().enumerate() {
            columns.clear();
            columns.extend(pair);
            columns.extend([k, l].into_iter().filter(|&c| layout.config[c] == j));
            columns.sort_unstable();
            for &c in &columns {
                let left = self.circuit(layout, k, j, c).checked_mul(-dot_l).ok_or(Overflow)?;
                let right = self.circuit(layout, l, j, c).checked_mul(-dot_k).ok_or(Overflow)?;
                match left.cmp(&right) {
                    Ordering::Less => return Ok(true),
                    Ordering::Greater => return Ok(false),
                    Ordering::Equal => {}
                }
            }
        }
        Ok(false)
    }

    /// Entry of the circuit of column `k` at column `c` of configuration `j`.
    fn circuit(&self, layout: &Layout, k: usize, j: usize, c: usize) -> i128 {
        let [a, b] = self.pairs[j];
        let own = layout.config[k] == j;
        if c == a {
            self.entry(k, j)
        } else if c == b {
            (if own { self.volume.wide() } else { 0 }) - self.entry(k, j)
        } else if c == k {
            -self.volume.wide()
        } else {
            0
        }
    }
}
