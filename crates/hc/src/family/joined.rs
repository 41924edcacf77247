//! Which solutions of a fibre loops have joined: those of one orbit of the monodromy group.

use crate::distinct::root;

/// Solutions by the orbits that are known so far. Each solution is alone at first.
#[derive(Clone, Debug, Default)]
pub(super) struct Joined {
    parent: Vec<usize>,
    /// The joins since they were taken last.
    new: Vec<(usize, usize)>,
}

impl Joined {
    /// Room for so many solutions.
    pub(super) fn grow(&mut self, count: usize) {
        self.parent.extend(self.parent.len()..count);
    }

    /// Notes that two solutions lie in one orbit.
    pub(super) fn join(&mut self, a: usize, b: usize) {
        let (top_a, top_b) = (root(&mut self.parent, a), root(&mut self.parent, b));
        if top_a != top_b {
            self.parent[top_a.max(top_b)] = top_a.min(top_b);
            self.new.push((a, b));
        }
    }

    /// The joins since this was asked last.
    pub(super) fn take_new(&mut self) -> Vec<(usize, usize)> {
        std::mem::take(&mut self.new)
    }

    /// The sizes of the orbits, largest first.
    pub(super) fn sizes(&mut self) -> Vec<usize> {
        self.sizes_from(0)
    }

    /// The sizes of the orbits of solutions from this number on.
    pub(super) fn sizes_from(&mut self, first: usize) -> Vec<usize> {
        let mut counts = vec![0; self.parent.len()];
        for k in first..counts.len() {
            counts[root(&mut self.parent, k)] += 1;
        }
        counts.retain(|&count| count > 0);
        counts.sort_unstable_by(|a, b| b.cmp(a));
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::Joined;

    #[test]
    fn what_is_joined_to_one_is_joined_to_all() {
        let mut joined = Joined::default();
        joined.grow(6);
        for (a, b) in [(4, 2), (2, 4), (5, 4), (0, 1)] {
            joined.join(a, b);
        }
        assert_eq!((joined.take_new(), joined.sizes()), (vec![(4, 2), (5, 4), (0, 1)], vec![3, 2, 1]));
        joined.grow(7);
        joined.join(6, 0);
        assert_eq!((joined.take_new(), joined.sizes()), (vec![(6, 0)], vec![3, 3, 1]));
    }
}
