//! Mixed cells and mixed volume.
//!
//! Stage `k` has the supports `A_1 .. A_{k-1}`, then `d_k Delta` together with `A_k`, then standard simplices `Delta`. Sending the lifting of
//! `d_k Delta` to minus infinity leaves the mixed cells of `A_1 .. A_k, Delta, ..`, each of which is a start for the next stage.

use super::table::{Layout, Overflow, Table};
use super::walk::AnyTable;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

/// A fine mixed cell: the sum of one edge of each support.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MixedCell {
    /// The edge of each support, as indices of two of its points.
    pub edges: Vec<[usize; 2]>,
    /// Volume `V`.
    pub volume: u64,
    /// `V` times the inner normal `g`: `<g, a> + lift(a)` is least over each support just on its edge.
    pub normal: Vec<i128>,
}

/// A mixed volume and how it was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MixedVolume {
    /// The mixed volume.
    pub volume: u64,
    /// Number of mixed cells in the subdivision that gave it.
    pub cells: usize,
}

/// Why there are no mixed cells.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MixedError {
    /// Not as many supports as unknowns.
    #[error("{supports} supports in {unknowns} unknowns; as many supports as unknowns are needed")]
    NotSquare {
        /// Number of supports.
        supports: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// An exponent vector of the wrong length.
    #[error("a point of support {support} has {found} exponents, there are {unknowns} unknowns")]
    Length {
        /// The support, from 1.
        support: usize,
        /// Length of the exponent vector.
        found: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A lifting that does not fit the supports.
    #[error("support {support} has {points} points but its lifting {values} values")]
    Lifting {
        /// The support, from 1.
        support: usize,
        /// Its points.
        points: usize,
        /// Its values.
        values: usize,
    },
    /// Determinants beyond 61 bits.
    #[error("the exponents are so large that volumes of cells exceed 61 bits; divide exponents by common factors")]
    TooLarge,
}

impl From<Overflow> for MixedError {
    fn from(_: Overflow) -> Self {
        MixedError::TooLarge
    }
}

/// The mixed volume of `n` supports in `n` unknowns: by Bernstein's theorem the number of solutions with all coordinates nonzero of
/// a system with generic coefficients. Runs on the threads of the current rayon pool.
///
/// ```
/// use hc::start::mixed_volume;
/// // a + b x + c y + d x y and the same again
/// let square = vec![vec![0, 0], vec![1, 0], vec![0, 1], vec![1, 1]];
/// assert_eq!(mixed_volume(2, &[square.clone(), square])?.volume, 2);
/// # Ok::<(), hc::start::MixedError>(())
/// ```
///
/// # Errors
/// If the supports are not as many as the unknowns, an exponent vector has another length, or volumes exceed 61 bits.
pub fn mixed_volume(unknowns: usize, supports: &[Vec<Vec<i32>>]) -> Result<MixedVolume, MixedError> {
    let volumes = run(unknowns, supports, |_, table, out| {
        out.push(u64::try_from(table.volume).map_err(|_| Overflow)?);
        Ok(())
    })?;
    let volume = volumes.iter().try_fold(0u64, |sum, &v| sum.checked_add(v)).ok_or(MixedError::TooLarge)?;
    Ok(MixedVolume { volume, cells: volumes.len() })
}

/// The mixed cells of the regular subdivision of a lifting (one value a point), in an order that depends on the input alone.
///
/// The lifting is perturbed symbolically, so that all cells are fine and their volumes add up to the mixed volume; where
/// it was not generic, the least value over a support is taken at further points besides those of the edge.
///
/// # Errors
/// If the numbers of supports, exponents, points and values do not fit, or integers exceed 61 bits.
pub fn mixed_cells(
    unknowns: usize,
    supports: &[Vec<Vec<i32>>],
    lifting: &[Vec<i32>],
) -> Result<Vec<MixedCell>, MixedError> {
    for (i, points) in supports.iter().enumerate() {
        let values = lifting.get(i).map_or(0, Vec::len);
        if values != points.len() {
            return Err(MixedError::Lifting { support: i + 1, points: points.len(), values });
        }
    }
    let layout = Layout::new(supports.iter().map(Vec::len));
    let tau: Vec<i64> = lifting.iter().take(supports.len()).flatten().map(|&l| -i64::from(l)).collect();
    run(unknowns, supports, |stages, table, out| {
        let start = stages.settled(table)?;
        start.walk(&layout, &tau, &mut |table| {
            out.push(cell(&layout, &tau, table)?);
            Ok(())
        })
    })
}

fn cell(layout: &Layout, tau: &[i64], table: &Table<i128>) -> Result<MixedCell, Overflow> {
    let n = table.pairs.len();
    let normal = (0..n).map(|l| {
        let terms = table.pairs.iter().enumerate().map(|(j, [a, b])| {
            // lift_b - lift_a, the lifting being -tau.
            table.entry(layout.columns() + l, j).checked_mul(i128::from(tau[*a] - tau[*b]))
        });
        terms.into_iter().try_fold(0i128, |sum, term| sum.checked_add(term?)).ok_or(Overflow)
    });
    let edges = table.pairs.iter().enumerate().map(|(j, p)| [p[0] - layout.first[j], p[1] - layout.first[j]]);
    Ok(MixedCell {
        edges: edges.collect(),
        volume: u64::try_from(table.volume).map_err(|_| Overflow)?,
        normal: normal.collect::<Result<_, _>>()?,
    })
}

/// Cells that are spread over threads: many more than threads, and few enough to be kept.
const FRONTIER: usize = 512;

/// What is done with each mixed cell of the supports.
type Sink<'a, R> = &'a (dyn Fn(&Stages, &Table<i128>, &mut Vec<R>) -> Result<(), Overflow> + Sync);

fn run<R: Send>(
    unknowns: usize,
    supports: &[Vec<Vec<i32>>],
    sink: impl Fn(&Stages, &Table<i128>, &mut Vec<R>) -> Result<(), Overflow> + Sync,
) -> Result<Vec<R>, MixedError> {
    if supports.len() != unknowns || unknowns == 0 {
        return Err(MixedError::NotSquare { supports: supports.len(), unknowns });
    }
    for (i, points) in supports.iter().enumerate() {
        if let Some(point) = points.iter().find(|p| p.len() != unknowns) {
            return Err(MixedError::Length { support: i + 1, found: point.len(), unknowns });
        }
    }
    // A single point has no edge.
    if supports.iter().any(|a| a.iter().all(|p| p == &a[0])) {
        return Ok(Vec::new());
    }
    let stages = Stages::new(supports);
    let mut frontier = vec![stages.start()?];
    let mut k = 0;
    while k + 1 < unknowns && frontier.len() < FRONTIER {
        let next: Vec<Vec<AnyTable>> = frontier
            .into_par_iter()
            .map(|table| {
                let mut out = Vec::new();
                stages.walk(k, table, &mut |t| {
                    out.push(stages.enter(k + 1, t)?);
                    Ok(())
                })?;
                Ok(out)
            })
            .collect::<Result<_, Overflow>>()?;
        frontier = next.into_iter().flatten().collect();
        k += 1;
    }
    let found: Vec<Vec<R>> = frontier
        .into_par_iter()
        .map(|table| {
            let mut out = Vec::new();
            stages.descend(k, table, &sink, &mut out)?;
            Ok(out)
        })
        .collect::<Result<_, Overflow>>()?;
    Ok(found.into_iter().flatten().collect())
}

struct Stages {
    n: usize,
    /// The supports, moved so that the least exponent of each unknown is zero.
    points: Vec<Vec<Vec<i64>>>,
    /// Degree of each support.
    degrees: Vec<i128>,
    layouts: Vec<Layout>,
    directions: Vec<Vec<i64>>,
}

impl Stages {
    fn new(supports: &[Vec<Vec<i32>>]) -> Self {
        let n = supports.len();
        let points: Vec<Vec<Vec<i64>>> = supports
            .iter()
            .map(|support| {
                let least = |l: usize| support.iter().map(|p| i64::from(p[l])).min().unwrap_or(0);
                let corner: Vec<i64> = (0..n).map(least).collect();
                support.iter().map(|p| p.iter().zip(&corner).map(|(&x, c)| i64::from(x) - c).collect()).collect()
            })
            .collect();
        let degree = |s: &Vec<Vec<i64>>| s.iter().map(|p| p.iter().sum::<i64>()).max().unwrap_or(0);
        let degrees = points.iter().map(|s| i128::from(degree(s))).collect();
        let size = |k: usize, i: usize| match i.cmp(&k) {
            std::cmp::Ordering::Less => points[i].len(),
            std::cmp::Ordering::Equal => n + 1 + points[i].len(),
            std::cmp::Ordering::Greater => n + 1,
        };
        let layouts: Vec<Layout> = (0..n).map(|k| Layout::new((0..n).map(|i| size(k, i)))).collect();
        let directions = layouts.iter().enumerate().map(|(k, layout)| {
            let simplex = layout.first[k]..layout.first[k] + n + 1;
            (0..layout.columns()).map(|c| -i64::from(simplex.contains(&c))).collect()
        });
        Stages { n, directions: directions.collect(), points, degrees, layouts }
    }

    /// The mixed cell of `n` standard simplices: with the lifting of the first column the largest, the second
    /// next, and so on, the edges are `(i, i + 1)`; brought to the first stage.
    fn start(&self) -> Result<AnyTable, Overflow> {
        let n = self.n;
        let rows = (n + 1) * n + n;
        let mut entries = vec![0i128; n * rows];
        // P_p - P_b = sum of P_i - P_{i+1} over i from p to b - 1.
        let mut chain = |row: usize, p: usize, b: usize| {
            (p..b).for_each(|i| entries[i * rows + row] = 1);
            (b..p).for_each(|i| entries[i * rows + row] = -1);
        };
        for c in 0..n {
            (0..=n).for_each(|p| chain(c * (n + 1) + p, p, c + 1));
        }
        (1..=n).for_each(|l| chain((n + 1) * n + l - 1, l, 0));
        let pairs = (0..n).map(|c| [c * (n + 1) + c, c * (n + 1) + c + 1]).collect();
        let table = Table::new(pairs, 1, &entries)?;
        self.enter(0, &table)
    }

    /// Brings a cell from the end of stage `k - 1` to the start of stage `k`: the simplex of configuration `k` grows by
    /// `d = d_k` and the columns of `A_k` come in.
    fn enter(&self, k: usize, from: &Table<i128>) -> Result<AnyTable, Overflow> {
        let n = self.n;
        let d = self.degrees[k];
        let layout = &self.layouts[k];
        let units = layout.columns();
        let mut entries = vec![0i128; n * (units + n)];
        let first = |c: usize| self.first_before(k, c);
        let from_units = from.rows - n;
        for j in 0..n {
            let scale = if j == k { 1 } else { d };
            let column = &mut entries[j * (units + n)..(j + 1) * (units + n)];
            for (row, entry) in column.iter_mut().enumerate() {
                let value = if row >= units {
                    Some(from.entry(from_units + row - units, j))
                } else {
                    let c = layout.config[row];
                    let p = row - layout.first[c];
                    if c != k {
                        Some(from.entry(first(c) + p, j))
                    } else if p <= n {
                        from.entry(first(c) + p, j).checked_mul(d)
                    } else {
                        // The point minus the second point of the pair, a corner of d Delta, in unit vectors.
                        let corner = from.pairs[k][1] - first(k);
                        let point = &self.points[k][p - n - 1];
                        (0..n).filter(|&l| point[l] != 0 || l + 1 == corner).try_fold(0i128, |sum, l| {
                            let w = i128::from(point[l]) - if l + 1 == corner { d } else { 0 };
                            sum.checked_add(w.checked_mul(from.entry(from_units + l, j))?)
                        })
                    }
                };
                *entry = value.and_then(|v| v.checked_mul(scale)).ok_or(Overflow)?;
            }
        }
        let pairs = self.moved_pairs(k, layout, from);
        AnyTable::new(pairs, from.volume.checked_mul(d).ok_or(Overflow)?, &entries)
    }

    /// A cell from the end of the last stage without the columns of the simplex.
    fn settled(&self, from: &Table<i128>) -> Result<AnyTable, Overflow> {
        let n = self.n;
        let layout = Layout::new(self.points.iter().map(Vec::len));
        let units = layout.columns();
        let row = |r: usize| match layout.config.get(r) {
            Some(&c) => self.first_before(n, c) + r - layout.first[c],
            None => from.rows - n + r - units,
        };
        let entries: Vec<i128> =
            (0..n).flat_map(|j| (0..units + n).map(move |r| (j, r))).map(|(j, r)| from.entry(row(r), j)).collect();
        AnyTable::new(self.moved_pairs(n, &layout, from), from.volume, &entries)
    }

    /// First column of configuration `c` at the end of stage `k - 1` (before stage 0: of the simplices), without the
    /// columns that are dropped.
    fn first_before(&self, k: usize, c: usize) -> usize {
        match k.checked_sub(1) {
            None => c * (self.n + 1),
            Some(last) => self.layouts[last].first[c] + if c == last { self.n + 1 } else { 0 },
        }
    }

    fn moved_pairs(&self, k: usize, layout: &Layout, from: &Table<i128>) -> Vec<[usize; 2]> {
        let moved = |c: usize, column: usize| layout.first[c] + column - self.first_before(k, c);
        from.pairs.iter().enumerate().map(|(c, p)| [moved(c, p[0]), moved(c, p[1])]).collect()
    }

    /// Stage `k` from one of its start cells; `emit` is called for the cells without columns of the simplex.
    fn walk(
        &self,
        k: usize,
        table: AnyTable,
        emit: &mut dyn FnMut(&Table<i128>) -> Result<(), Overflow>,
    ) -> Result<(), Overflow> {
        let layout = &self.layouts[k];
        let own = layout.first[k] + self.n + 1;
        table.walk(layout, &self.directions[k], &mut |t| {
            if t.pairs[k].iter().all(|&c| c >= own) { emit(t) } else { Ok(()) }
        })
    }

    /// All stages from `k` on.
    fn descend<R>(&self, k: usize, table: AnyTable, sink: Sink<'_, R>, out: &mut Vec<R>) -> Result<(), Overflow> {
        self.walk(k, table, &mut |t| {
            if k + 1 == self.n { sink(self, t, out) } else { self.descend(k + 1, self.enter(k + 1, t)?, sink, out) }
        })
    }
}
