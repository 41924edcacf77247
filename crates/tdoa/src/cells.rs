//! Values in some of the cells of a matrix, in memory proportional to the number of these cells.

use std::sync::Arc;

/// Which cells of a matrix have a value.
#[derive(Debug, PartialEq)]
struct Pattern {
    rows: usize,
    columns: usize,
    /// Where each row begins in the list of all cells, and where the last one ends.
    starts: Vec<usize>,
    /// The columns of the cells, row by row in ascending order; empty if no cell is missing, or all are.
    places: Vec<u32>,
}

impl Pattern {
    fn is_complete(&self) -> bool {
        self.places.is_empty()
    }

    /// The column of a cell in the list.
    fn column(&self, k: usize) -> usize {
        if self.is_complete() { k % self.columns } else { self.places[k] as usize }
    }

    /// The place of a cell in the list.
    fn find(&self, i: usize, j: usize) -> Option<usize> {
        if i >= self.rows || j >= self.columns {
            return None;
        }
        if self.is_complete() {
            return (self.starts[i] < self.starts[i + 1]).then(|| self.starts[i] + j);
        }
        let row = &self.places[self.starts[i]..self.starts[i + 1]];
        row.binary_search_by(|&place| (place as usize).cmp(&j)).ok().map(|k| self.starts[i] + k)
    }
}

/// Values in some of the cells of a matrix. Copies share memory; so do other values in the same
/// cells.
///
/// ```
/// use tdoa::Pseudoranges;
/// let f = Pseudoranges::from_cells(2, 3, [(0, 2, 5.0), (1, 0, 7.0)])?;
/// let all: Vec<(usize, usize, f64)> = f.cells().iter().map(|(i, j, f)| (i, j, *f)).collect();
/// assert_eq!(all, [(0, 2, 5.0), (1, 0, 7.0)]);
/// # Ok::<(), tdoa::PseudorangeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Cells<T> {
    pattern: Arc<Pattern>,
    values: Arc<Vec<T>>,
}

impl<T> Cells<T> {
    /// The values of these cells: row, column, value; in the order of the rows, those of a row in the
    /// order of the columns, none twice.
    pub(crate) fn new(rows: usize, columns: usize, cells: impl IntoIterator<Item = (usize, usize, T)>) -> Self {
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for (i, j, value) in cells {
            debug_assert!(i < rows && j < columns && i + 1 >= starts.len());
            starts.resize(i + 1, values.len());
            places.push(j as u32);
            values.push(value);
        }
        starts.resize(rows + 1, values.len());
        if rows.checked_mul(columns) == Some(values.len()) {
            places = Vec::new();
        }
        values.shrink_to_fit();
        places.shrink_to_fit();
        Cells { pattern: Arc::new(Pattern { rows, columns, starts, places }), values: Arc::new(values) }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.pattern.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.pattern.columns
    }

    /// Number of cells with a value.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether no cell has a value.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The value in row `i` and column `j`; `None` if there is none.
    pub fn get(&self, i: usize, j: usize) -> Option<&T> {
        self.pattern.find(i, j).map(|k| &self.values[k])
    }

    /// The values row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Row, column and value of each cell, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, &T)> {
        (0..self.rows()).flat_map(|i| self.row(i).map(move |(j, value)| (i, j, value)))
    }

    /// Column and value of each cell of a row; none if there is no such row.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &T)> {
        let all = match self.pattern.starts.get(i..i + 2) {
            Some(ends) => ends[0]..ends[1],
            None => 0..0,
        };
        all.map(|k| (self.pattern.column(k), &self.values[k]))
    }

    /// Other values in the same cells, by row, column and value.
    pub(crate) fn map<U>(&self, mut to: impl FnMut(usize, usize, &T) -> U) -> Cells<U> {
        let values = self.iter().map(|(i, j, value)| to(i, j, value)).collect();
        Cells { pattern: self.pattern.clone(), values: Arc::new(values) }
    }
}

impl<T: Clone> Cells<T> {
    /// The cells for which `keep` holds, by row, column and value.
    pub(crate) fn filter(&self, mut keep: impl FnMut(usize, usize, &T) -> bool) -> Cells<T> {
        let kept = self.iter().filter(|&(i, j, value)| keep(i, j, value));
        Cells::new(self.rows(), self.columns(), kept.map(|(i, j, value)| (i, j, value.clone())))
    }

    /// The matrix of these rows and columns, in this order.
    pub(crate) fn select(&self, rows: &[usize], columns: &[usize]) -> Cells<T> {
        let mut order: Vec<usize> = (0..columns.len()).collect();
        order.sort_by_key(|&k| columns[k]);
        let mut cells = Vec::new();
        for (a, &i) in rows.iter().enumerate() {
            let first = cells.len();
            for (j, value) in self.row(i) {
                let at = order.partition_point(|&k| columns[k] < j);
                let same = order[at..].iter().take_while(|&&k| columns[k] == j);
                cells.extend(same.map(|&b| (a, b, value.clone())));
            }
            cells[first..].sort_by_key(|cell| cell.1);
        }
        Cells::new(rows.len(), columns.len(), cells)
    }

    /// Changes each value.
    pub(crate) fn for_each(&mut self, mut change: impl FnMut(&mut T)) {
        Arc::make_mut(&mut self.values).iter_mut().for_each(&mut change);
    }
}

#[cfg(test)]
mod tests {
    use super::Cells;
    use proptest::prelude::*;

    /// A dense matrix, with what is missing.
    fn dense() -> impl Strategy<Value = (usize, usize, Vec<Option<u16>>)> {
        (1usize..7, 1usize..9).prop_flat_map(|(m, n)| {
            let cell = prop_oneof![1 => Just(None), 3 => any::<u16>().prop_map(Some)];
            let missing = prop::collection::vec(cell, m * n);
            let complete = prop::collection::vec(any::<u16>().prop_map(Some), m * n);
            (Just(m), Just(n), prop_oneof![3 => missing, 1 => complete])
        })
    }

    fn cells(m: usize, n: usize, all: &[Option<u16>]) -> Cells<u16> {
        Cells::new(m, n, (0..m * n).filter_map(|k| Some((k / n, k % n, all[k]?))))
    }

    proptest! {
        #[test]
        fn cells_are_those_of_the_dense_matrix((m, n, all) in dense(), rows in prop::collection::vec(0usize..7, 1..8),
                                              columns in prop::collection::vec(0usize..9, 1..8)) {
            let sparse = cells(m, n, &all);
            prop_assert_eq!(sparse.len(), all.iter().flatten().count());
            for i in 0..m + 2 {
                for j in 0..n + 2 {
                    let expected = if i < m && j < n { all[i * n + j] } else { None };
                    prop_assert_eq!(sparse.get(i, j).copied(), expected);
                }
            }
            let listed: Vec<(usize, usize, u16)> = sparse.iter().map(|(i, j, v)| (i, j, *v)).collect();
            let expected: Vec<_> = (0..m * n).filter_map(|k| Some((k / n, k % n, all[k]?))).collect();
            prop_assert_eq!(listed, expected);
            prop_assert_eq!(sparse.row(m).count(), 0);

            let (rows, columns): (Vec<_>, Vec<_>) =
                (rows.into_iter().map(|i| i % m).collect(), columns.into_iter().map(|j| j % n).collect());
            let picked: Vec<Option<u16>> = rows.iter().flat_map(|&i| columns.iter().map(move |&j| i * n + j)).map(|k| all[k]).collect();
            prop_assert_eq!(sparse.select(&rows, &columns), cells(rows.len(), columns.len(), &picked));

            let odd: Vec<Option<u16>> = all.iter().map(|v| v.filter(|v| v % 2 == 1)).collect();
            prop_assert_eq!(sparse.filter(|_, _, v| v % 2 == 1), cells(m, n, &odd));
            prop_assert_eq!(sparse.map(|i, j, _| all[i * n + j].unwrap()), sparse);
        }
    }
}
