//! Branches: real solutions of neighbouring cells that belong together, and all that these are joined to.

use super::cell::Cell;
use crate::distinct::root;

/// Numbers the branches of all regular solutions, from 0 in the order in which they appear; their number. `pairs` has
/// cells and numbers of solutions that lie on one branch.
pub(super) fn number(cells: &mut [Cell], pairs: impl Iterator<Item = [(usize, usize); 2]>) -> usize {
    let mut first = Vec::with_capacity(cells.len());
    let mut count = 0usize;
    for cell in cells.iter() {
        first.push(count);
        count += cell.solutions.len();
    }
    let mut parent: Vec<usize> = (0..count).collect();
    for pair in pairs {
        let [a, b] = pair.map(|(cell, k)| root(&mut parent, first[cell] + k));
        parent[a.max(b)] = a.min(b);
    }
    // The first of a branch is its root.
    let mut numbers = vec![usize::MAX; count];
    let mut branches = 0;
    for (cell, &first) in cells.iter_mut().zip(&first) {
        for (k, solution) in cell.solutions.iter_mut().enumerate() {
            if solution.multiplicity > 1 {
                continue;
            }
            let root = root(&mut parent, first + k);
            if numbers[root] == usize::MAX {
                numbers[root] = branches;
                branches += 1;
            }
            solution.branch = Some(numbers[root]);
        }
    }
    branches
}

#[cfg(test)]
mod tests {
    use super::number;
    use crate::sweep::cell::{Cell, RealSolution};

    #[test]
    fn what_is_joined_is_one_branch() {
        let cell = |multiplicities: &[usize]| Cell {
            solutions: (multiplicities.iter())
                .map(|&multiplicity| RealSolution { value: vec![], multiplicity, positive: false, branch: None })
                .collect(),
            ..Cell::default()
        };
        let mut cells = [cell(&[1, 1]), cell(&[]), cell(&[1, 2, 1]), cell(&[1])];
        let pairs = [[(2, 0), (3, 0)], [(0, 1), (2, 0)]];
        assert_eq!(number(&mut cells, pairs.into_iter()), 3);
        let found: Vec<Vec<Option<usize>>> =
            cells.iter().map(|cell| cell.solutions.iter().map(|s| s.branch).collect()).collect();
        assert_eq!(found, [vec![Some(0), Some(1)], vec![], vec![Some(1), None, Some(2)], vec![Some(1)]]);
    }
}
