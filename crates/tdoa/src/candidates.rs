//! What a detector found for one cell of a matrix, where that is more than one value.

/// The candidates of a cell in the order of the detector, of which one is the measurement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidates {
    all: Vec<f64>,
    chosen: usize,
}

impl Candidates {
    /// These candidates, metres, of which the first is chosen.
    pub(crate) fn new(all: Vec<f64>) -> Candidates {
        Candidates { all, chosen: 0 }
    }

    /// All of them, metres.
    pub(crate) fn all(&self) -> &[f64] {
        &self.all
    }

    /// The place of the chosen one among them.
    pub(crate) fn chosen(&self) -> usize {
        self.chosen
    }

    /// The chosen one, metres.
    pub(crate) fn value(&self) -> f64 {
        self.all.get(self.chosen).copied().unwrap_or(f64::NAN)
    }

    /// One more, metres, the last.
    pub(crate) fn push(&mut self, value: f64) {
        self.all.push(value);
    }

    /// These candidates with another choice; one that is not there chooses the first.
    pub(crate) fn choosing(&self, chosen: usize) -> Candidates {
        Candidates { all: self.all.clone(), chosen: if chosen < self.all.len() { chosen } else { 0 } }
    }

    /// Other values, with the same choice.
    pub(crate) fn map(&self, to: impl FnMut(&f64) -> f64) -> Candidates {
        Candidates { all: self.all.iter().map(to).collect(), chosen: self.chosen }
    }
}
