//! How each measurement depends on the unknowns of clocks.

/// Per measurement, places among the reduced unknowns, and the derivatives of its residual by these, over its precision.
#[derive(Debug, Clone, Default)]
pub(crate) struct ClockTerms {
    /// Where those of each measurement begin, and where the last end; nothing without such unknowns.
    starts: Vec<usize>,
    all: Vec<(usize, f64)>,
}

impl ClockTerms {
    /// Terms of one measurement after the other.
    pub(crate) fn new<T: IntoIterator<Item = (usize, f64)>>(of_each: impl Iterator<Item = T>) -> Self {
        let (mut starts, mut all) = (vec![0], Vec::new());
        for terms in of_each {
            all.extend(terms);
            starts.push(all.len());
        }
        ClockTerms { starts, all }
    }

    /// Those of a measurement by its place among all.
    #[inline]
    pub(crate) fn of(&self, k: usize) -> &[(usize, f64)] {
        if self.starts.is_empty() { &[] } else { &self.all[self.starts[k]..self.starts[k + 1]] }
    }
}
