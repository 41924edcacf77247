//! From the mixed cells of one lifting to those of another by flips, depth first and without a list
//! of visited cells.
//!
//! The lifting is perturbed symbolically: the first point of the first configuration is lifted by
//! an infinitesimal, the next point by an infinitely smaller one, and so on. A cell has one
//! inequality `sum_j t_j (tau(a_j) - tau(b_j)) + V (tau(b_c) - tau(g)) >= 0` for every point `g`.
//! On the way from there in the direction `tau`, the cell ends where the first of these fails
//! (Jensen 2016, sections 3 to 5).

use super::cell::Cell;
use super::error::Overflow;
use super::integer::Integer;
use super::points::{Column, LANES, Points};
use std::cmp::Ordering;

/// What becomes of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// It arrives at infinity.
    Arrived,
    /// It ends at this column, with these of the two cells behind as its children.
    Ends { column: Column, children: [bool; 2] },
}

/// Memory for the steps of one search.
pub(super) struct Scratch<T> {
    /// Inner products of the direction with all points.
    values: Vec<T>,
    /// The direction in the space of the duals.
    direction: Vec<T>,
    /// Columns whose inequalities fail, and the rates at which they do.
    failing: Vec<(Column, T)>,
    /// Circuit of the column that fails first, known up to some configuration.
    pub(super) circuit: Vec<T>,
    known: usize,
}

impl<T: Integer> Scratch<T> {
    pub(super) fn new(points: &Points<T>) -> Self {
        let zero = T::default();
        Scratch {
            values: vec![zero; points.stride],
            direction: vec![zero; points.n.next_multiple_of(LANES)],
            failing: Vec::new(),
            circuit: vec![zero; points.n],
            known: 0,
        }
    }

    /// One step of the stage that sends the simplex of configuration `k` to minus infinity. Where a
    /// cell ends, `circuit` is that of the column.
    #[inline(always)]
    pub(super) fn regenerate(&mut self, points: &Points<T>, k: usize, cell: &Cell<T>) -> Result<Step, Overflow> {
        let n = points.n;
        let corners = n + 1;
        let zero = T::default();
        let [a, b] = cell.pairs[k];
        let [a_leaves, b_leaves] = [(a as usize) < corners, (b as usize) < corners];
        if !a_leaves && !b_leaves {
            return Ok(Step::Arrived);
        }
        self.failing.clear();
        let own = points.first[k]..points.first[k + 1];
        let lower = cell.volume.negated();
        if a_leaves && b_leaves {
            let point = |q: usize| Column { config: k, point: (corners + q) as u32 };
            self.failing.extend((0..own.len()).map(|q| (point(q), lower)));
        } else {
            // The direction is plus or minus the dual of the edge.
            let dual = cell.dual(k);
            for (w, &u) in self.direction.iter_mut().zip(dual) {
                *w = if b_leaves { u } else { u.negated() };
            }
            let w = &self.direction[..];
            points.values(w, own.end, &mut self.values);
            for c in 0..k {
                let chunk = &self.values[points.first[c]..points.first[c + 1]];
                let base = chunk[cell.pairs[c][1] as usize];
                for (p, &value) in chunk.iter().enumerate() {
                    if value < base {
                        self.failing.push((Column { config: c, point: p as u32 }, T::difference(value, base)));
                    }
                }
            }
            // In configuration k, points that stay behind are favoured over corners.
            let base = points.value(w, k, Column { config: k, point: b });
            let (corner_gain, own_gain) = if b_leaves { (zero, lower) } else { (cell.volume, zero) };
            for p in 0..corners as u32 {
                let column = Column { config: k, point: p };
                let rate = T::sum(T::difference(points.value(w, k, column), base), corner_gain);
                if rate < zero {
                    self.failing.push((column, rate));
                }
            }
            for (q, &value) in self.values[own].iter().enumerate() {
                let rate = T::sum(T::difference(value, base), own_gain);
                if rate < zero {
                    self.failing.push((Column { config: k, point: (corners + q) as u32 }, rate));
                }
            }
            let least = w[..n].iter().copied().fold(zero, T::min);
            for c in k + 1..n {
                let b = cell.pairs[c][1];
                let base = points.value(w, k, Column { config: c, point: b });
                if least < base {
                    for p in 0..corners as u32 {
                        let column = Column { config: c, point: p };
                        let value = points.value(w, k, column);
                        if value < base {
                            self.failing.push((column, T::difference(value, base)));
                        }
                    }
                }
            }
        }
        if self.failing.is_empty() {
            // Unbounded, with a corner of the simplex: none of the supports' own cells.
            let column = Column { config: k, point: 0 };
            return Ok(Step::Ends { column, children: [false; 2] });
        }
        self.first_failing(points, k, cell)
    }

    /// One step on the way to the lifting `-tau` of the supports alone, one value per point.
    #[inline(always)]
    pub(super) fn lift(&mut self, points: &Points<T>, tau: &[i64], cell: &Cell<T>) -> Result<Step, Overflow> {
        let n = points.n;
        let zero = T::default();
        let tau_of = |c: usize, p: u32| tau[points.first[c] + p as usize];
        let differences =
            (0..n).map(|j| i128::from(tau_of(j, cell.pairs[j][0])) - i128::from(tau_of(j, cell.pairs[j][1])));
        let highest = tau.iter().map(|t| t.unsigned_abs()).max().unwrap_or(0);
        // Inner products with the direction are sums of multiples of inner products with duals;
        // volumes come beside them.
        let spread = differences.clone().try_fold(0u128, |sum, d| sum.checked_add(d.unsigned_abs()));
        let slopes =
            spread.and_then(|s| s.checked_mul(points.reach)?.checked_mul(cell.largest_dual().wide().unsigned_abs()));
        let rises = (2 * u128::from(highest)).checked_mul(cell.volume.wide().unsigned_abs());
        let largest = slopes.zip(rises).and_then(|(s, r)| s.checked_add(r));
        if largest.is_none_or(|largest| largest >= T::HALF) {
            return Err(Overflow);
        }
        self.direction.fill(zero);
        for (j, difference) in differences.enumerate() {
            let factor = T::narrow(difference).ok_or(Overflow)?;
            for (w, &u) in self.direction.iter_mut().zip(cell.dual(j)) {
                *w = T::accumulate(*w, factor, u);
            }
        }
        points.values(&self.direction, points.first[n], &mut self.values);
        self.failing.clear();
        for c in 0..n {
            let own = points.first[c]..points.first[c + 1];
            let b = own.start + cell.pairs[c][1] as usize;
            for (p, (&value, &t)) in self.values[own.clone()].iter().zip(&tau[own]).enumerate() {
                let rise = T::narrow(i128::from(tau[b]) - i128::from(t)).ok_or(Overflow)?;
                let rate = T::accumulate(T::difference(value, self.values[b]), cell.volume, rise);
                if rate < zero {
                    self.failing.push((Column { config: c, point: p as u32 }, rate));
                }
            }
        }
        if self.failing.is_empty() { Ok(Step::Arrived) } else { self.first_failing(points, n, cell) }
    }

    /// The column whose inequality fails first, and the cells behind it.
    #[inline(always)]
    fn first_failing(&mut self, points: &Points<T>, stage: usize, cell: &Cell<T>) -> Result<Step, Overflow> {
        let mut best = 0;
        self.known = 0;
        for candidate in 1..self.failing.len() {
            self.challenge(points, stage, cell, candidate, &mut best)?;
        }
        let column = self.failing[best].0;
        cell.circuit(points, stage, column, self.known, &mut self.circuit);
        self.known = points.n;
        // A child with two parents belongs to the one of them whose column stands first.
        let [a, b] = cell.pairs[column.config];
        let zero = T::default();
        let c_a = self.circuit[column.config];
        let c_b = T::difference(cell.volume, c_a);
        let g = column.point;
        let children = [c_a > zero && (c_b >= zero || b < g), c_b > zero && (c_a >= zero || a < g)];
        Ok(Step::Ends { column, children })
    }

    /// Puts the candidate in the place of the best if it fails before it: lexicographic order of
    /// the circuits, each times the other's rate.
    #[inline(always)]
    fn challenge(
        &mut self,
        points: &Points<T>,
        stage: usize,
        cell: &Cell<T>,
        candidate: usize,
        best: &mut usize,
    ) -> Result<(), Overflow> {
        let (k, k_rate) = self.failing[candidate];
        let (l, l_rate) = self.failing[*best];
        let (k_size, l_size) = (k_rate.negated(), l_rate.negated());
        for j in 0..points.n {
            if j == self.known {
                self.circuit[j] = entry(points, stage, cell, l, j);
                self.known += 1;
            }
            let k_entry = entry(points, stage, cell, k, j);
            let l_entry = self.circuit[j];
            let [a, b] = cell.pairs[j];
            let order = if k.config != j && l.config != j {
                // Entries at a and b are opposite.
                let order = T::compare(k_entry, l_size, l_entry, k_size).ok_or(Overflow)?;
                if a < b { order } else { order.reverse() }
            } else {
                own_order(cell, j, (k, k_entry, k_size), (l, l_entry, l_size))?
            };
            match order {
                Ordering::Less => {
                    *best = candidate;
                    // Entries before entry j are equal up to the rates only.
                    self.known = usize::from(j == 0);
                    self.circuit[j] = k_entry;
                    return Ok(());
                }
                Ordering::Greater => return Ok(()),
                Ordering::Equal => {}
            }
        }
        Ok(())
    }
}

/// Entry `t_j` of the circuit of a column.
#[inline(always)]
fn entry<T: Integer>(points: &Points<T>, stage: usize, cell: &Cell<T>, column: Column, j: usize) -> T {
    let base = Column { config: column.config, point: cell.pairs[column.config][1] };
    let dual = cell.dual(j);
    T::difference(points.value(dual, stage, column), points.value(dual, stage, base))
}

/// Order of two circuits at the columns of configuration `j`, to which the column of at least one of
/// them belongs.
fn own_order<T: Integer>(
    cell: &Cell<T>,
    j: usize,
    (k, k_entry, k_size): (Column, T, T),
    (l, l_entry, l_size): (Column, T, T),
) -> Result<Ordering, Overflow> {
    let [a, b] = cell.pairs[j];
    let mut columns = [Some(a), Some(b), None, None];
    columns[2] = (k.config == j).then_some(k.point);
    columns[3] = (l.config == j).then_some(l.point);
    columns.sort_unstable();
    let at = |column: Column, entry: T, c: u32| {
        let own = column.config == j;
        if c == a {
            entry
        } else if c == b {
            T::difference(if own { cell.volume } else { T::default() }, entry)
        } else if own && c == column.point {
            cell.volume.negated()
        } else {
            T::default()
        }
    };
    for c in columns.into_iter().flatten() {
        let order = T::compare(at(k, k_entry, c), l_size, at(l, l_entry, c), k_size).ok_or(Overflow)?;
        if order != Ordering::Equal {
            return Ok(order);
        }
    }
    Ok(Ordering::Equal)
}
