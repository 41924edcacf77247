//! The measurement matrix.

use crate::cells::Cells;
use hc::poly::counted;
use thiserror::Error;

/// Largest number of cells (receivers times transmitters) of a matrix: 24 million. Memory is
/// proportional to the number of measured cells.
pub const MAX_CELLS: usize = 24_000_000;

/// Largest magnitude of a value, in metres. Above it a double cannot resolve a tenth of a
/// millimetre.
pub const MAX_MAGNITUDE: f64 = 1e12;

/// Why numbers do not form a [`Pseudoranges`] matrix. Receivers and transmitters are given by name,
/// or counted from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PseudorangeError {
    /// No receivers or no transmitters.
    #[error("the matrix is empty ({}, {})", counted(*.receivers, "receiver"), counted(*.transmitters, "transmitter"))]
    Empty {
        /// Number of rows.
        receivers: usize,
        /// Number of columns.
        transmitters: usize,
    },
    /// More than [`MAX_CELLS`] cells.
    #[error(
        "{} times {} are more than {MAX_CELLS} cells; split the recording",
        counted(*.receivers, "receiver"),
        counted(*.transmitters, "transmitter")
    )]
    TooLarge {
        /// Number of rows.
        receivers: usize,
        /// Number of columns.
        transmitters: usize,
    },
    /// The number of values is not receivers times transmitters.
    #[error("{expected} {what} are needed, one a {per}, but {found} were given")]
    Count {
        /// What is counted.
        what: &'static str,
        /// What each of them belongs to.
        per: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An infinite value, or one above [`MAX_MAGNITUDE`].
    #[error(
        "receiver {receiver}, transmitter {transmitter}: {value:e} is not a usable pseudorange (metres, magnitude at \
         most {MAX_MAGNITUDE:e}); leave the cell empty or write nan if it was not measured, and subtract a common \
         time from each transmitter's column if the clock starts long ago"
    )]
    Unusable {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// The value.
        value: f64,
    },
    /// A standard deviation that is not positive and finite.
    #[error(
        "receiver {receiver}, transmitter {transmitter}: the standard deviation must be positive and finite, not {value}"
    )]
    Sigma {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// The value.
        value: f64,
    },
    /// A cell beyond the last receiver or transmitter.
    #[error("receiver {receiver}, transmitter {transmitter}: there are only {configuration}")]
    Outside {
        /// Number of the receiver, from 1.
        receiver: usize,
        /// Number of the transmitter, from 1.
        transmitter: usize,
        /// The size of the matrix, such as `6r/3s`.
        configuration: String,
    },
    /// Two values for one cell.
    #[error("receiver {receiver}, transmitter {transmitter} is there twice; keep one measurement of each pair")]
    Twice {
        /// Number of the receiver, from 1.
        receiver: usize,
        /// Number of the transmitter, from 1.
        transmitter: usize,
    },
    /// Two receivers, or two transmitters, with the same name.
    #[error("two {kind}s are named {name:?}; names must differ")]
    DuplicateName {
        /// "receiver" or "transmitter".
        kind: &'static str,
        /// The name.
        name: String,
    },
}

/// The matrix f_ij of pseudoranges in metres: f_ij = |r_i - s_j| + o_j + noise, receivers i in
/// rows, transmitters j in columns. Cells that were not measured are missing.
///
/// ```
/// use tdoa::Pseudoranges;
/// let f = Pseudoranges::new(2, 3, vec![1.0, 2.0, f64::NAN, 4.0, 5.0, 6.0])?;
/// assert_eq!(f.get(0, 1), Some(2.0));
/// assert_eq!(f.get(0, 2), None);
/// assert_eq!(f.observed(), 5);
/// # Ok::<(), tdoa::PseudorangeError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Pseudoranges {
    cells: Cells<f64>,
    /// The standard deviations of the same cells.
    sigmas: Option<Cells<f64>>,
    receiver_names: Vec<String>,
    transmitter_names: Vec<String>,
    /// Whether the receivers' names were given, not counted.
    receivers_named: bool,
}

impl Pseudoranges {
    /// A matrix with `receivers` rows and `transmitters` columns from row-major `values` in metres;
    /// NaN marks a missing cell. Nodes are named `r1`, `r2`, ... and `s1`, `s2`, ...
    ///
    /// # Errors
    /// If the matrix is empty or too large, the number of values is wrong, or a value is infinite
    /// or huge.
    pub fn new(receivers: usize, transmitters: usize, values: Vec<f64>) -> Result<Self, PseudorangeError> {
        check_count("values", "cell", check_size(receivers, transmitters)?, values.len())?;
        let cells = values.iter().enumerate().filter(|(_, value)| !value.is_nan());
        let cells = cells.map(|(k, value)| (k / transmitters, k % transmitters, *value));
        Self::of(Cells::new(receivers, transmitters, cells))
    }

    /// A matrix from its measured cells: receiver, transmitter (both from 0) and value in metres,
    /// in any order. A cell with the value NaN is missing. Memory is proportional to the number of
    /// cells given.
    ///
    /// # Errors
    /// If the matrix is empty or too large, a cell is outside or given twice, or a value is
    /// infinite or huge.
    pub fn from_cells(
        receivers: usize,
        transmitters: usize,
        cells: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Result<Self, PseudorangeError> {
        check_size(receivers, transmitters)?;
        let mut all: Vec<(usize, usize, f64)> = Vec::new();
        for (i, j, value) in cells {
            if i >= receivers || j >= transmitters {
                let configuration = configuration(receivers, transmitters);
                return Err(PseudorangeError::Outside {
                    receiver: i.saturating_add(1),
                    transmitter: j.saturating_add(1),
                    configuration,
                });
            }
            if !value.is_nan() {
                all.push((i, j, value));
            }
        }
        all.sort_unstable_by_key(|cell| (cell.0, cell.1));
        if let Some(pair) = all.windows(2).find(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1)) {
            return Err(PseudorangeError::Twice { receiver: pair[0].0 + 1, transmitter: pair[0].1 + 1 });
        }
        Self::of(Cells::new(receivers, transmitters, all))
    }

    fn of(cells: Cells<f64>) -> Result<Self, PseudorangeError> {
        let matrix = Pseudoranges {
            receiver_names: (1..=cells.rows()).map(|i| format!("r{i}")).collect(),
            transmitter_names: (1..=cells.columns()).map(|j| format!("s{j}")).collect(),
            receivers_named: false,
            sigmas: None,
            cells,
        };
        let unusable = matrix.cells.iter().find(|(.., v)| v.is_infinite() || v.abs() > MAX_MAGNITUDE);
        if let Some((i, j, &value)) = unusable {
            return Err(PseudorangeError::Unusable {
                receiver: matrix.receiver_names[i].clone(),
                transmitter: matrix.transmitter_names[j].clone(),
                value,
            });
        }
        Ok(matrix)
    }

    /// The matrix with these names of receivers and transmitters.
    ///
    /// # Errors
    /// If the number of names is wrong, or a name is given twice.
    pub fn with_names(self, receivers: Vec<String>, transmitters: Vec<String>) -> Result<Self, PseudorangeError> {
        self.with_receiver_names(receivers)?.with_transmitter_names(transmitters)
    }

    /// The matrix with these names of receivers.
    ///
    /// # Errors
    /// If the number of names is wrong, or a name is given twice.
    pub fn with_receiver_names(mut self, names: Vec<String>) -> Result<Self, PseudorangeError> {
        check_names("receiver", self.receivers(), &names)?;
        self.receiver_names = names;
        self.receivers_named = true;
        Ok(self)
    }

    /// The matrix with these names of transmitters.
    ///
    /// # Errors
    /// If the number of names is wrong, or a name is given twice.
    pub fn with_transmitter_names(mut self, names: Vec<String>) -> Result<Self, PseudorangeError> {
        check_names("transmitter", self.transmitters(), &names)?;
        self.transmitter_names = names;
        Ok(self)
    }

    /// This matrix with a standard deviation (metres) for each cell, row-major. Those of missing
    /// cells are ignored.
    ///
    /// # Errors
    /// If their number is wrong, or one is not positive and finite.
    pub fn with_sigmas(self, sigmas: Vec<f64>) -> Result<Self, PseudorangeError> {
        let n = self.transmitters();
        check_count("standard deviations", "cell", self.receivers() * n, sigmas.len())?;
        self.with_sigma_of(|i, j| sigmas[i * n + j])
    }

    /// This matrix with a standard deviation (metres) for each measured cell, by receiver and
    /// transmitter.
    ///
    /// # Errors
    /// If one is not positive and finite.
    pub fn with_sigma_of(mut self, sigma: impl Fn(usize, usize) -> f64) -> Result<Self, PseudorangeError> {
        let sigmas = self.cells.map(|i, j, _| sigma(i, j));
        if let Some((i, j, &value)) = sigmas.iter().find(|(.., sigma)| !(sigma.is_finite() && **sigma > 0.0)) {
            return Err(PseudorangeError::Sigma {
                receiver: self.receiver_names[i].clone(),
                transmitter: self.transmitter_names[j].clone(),
                value,
            });
        }
        self.sigmas = Some(sigmas);
        Ok(self)
    }

    /// Number of receivers (rows).
    pub fn receivers(&self) -> usize {
        self.cells.rows()
    }

    /// Number of transmitters (columns).
    pub fn transmitters(&self) -> usize {
        self.cells.columns()
    }

    /// The pseudorange of receiver `i` and transmitter `j` in metres; `None` if it is missing or
    /// out of range.
    pub fn get(&self, i: usize, j: usize) -> Option<f64> {
        self.cells.get(i, j).copied()
    }

    /// The standard deviation (metres) given for a cell; `None` if there is none.
    pub fn sigma(&self, i: usize, j: usize) -> Option<f64> {
        self.sigmas.as_ref()?.get(i, j).copied()
    }

    /// Whether the cells carry their own standard deviations.
    pub fn has_sigmas(&self) -> bool {
        self.sigmas.is_some()
    }

    /// The measured cells.
    pub fn cells(&self) -> &Cells<f64> {
        &self.cells
    }

    /// All values row by row, NaN where missing: a copy with receivers times transmitters numbers.
    pub fn dense(&self) -> Vec<f64> {
        let n = self.transmitters();
        let mut all = vec![f64::NAN; self.receivers() * n];
        for (i, j, value) in self.cells.iter() {
            all[i * n + j] = *value;
        }
        all
    }

    /// Number of measured cells.
    pub fn observed(&self) -> usize {
        self.cells.len()
    }

    /// Names of the receivers.
    pub fn receiver_names(&self) -> &[String] {
        &self.receiver_names
    }

    /// Whether the receivers were given names; otherwise they are numbered, `r1`, `r2`, ...
    pub fn receivers_named(&self) -> bool {
        self.receivers_named
    }

    /// Names of the transmitters.
    pub fn transmitter_names(&self) -> &[String] {
        &self.transmitter_names
    }

    /// The size as the literature writes it, such as `6r/3s`.
    pub fn configuration(&self) -> String {
        configuration(self.receivers(), self.transmitters())
    }

    /// This matrix with other values in the same cells, usable ones, by receiver, transmitter and value.
    pub(crate) fn map(&self, value: impl FnMut(usize, usize, &f64) -> f64) -> Pseudoranges {
        Pseudoranges { cells: self.cells.map(value), ..self.clone() }
    }

    /// This matrix without the cells for which `keep` does not hold, by receiver, transmitter and value.
    pub(crate) fn filter(&self, mut keep: impl FnMut(usize, usize, f64) -> bool) -> Pseudoranges {
        let cells = self.cells.filter(|i, j, value| keep(i, j, *value));
        let sigmas = self.sigmas.as_ref().map(|sigmas| sigmas.filter(|i, j, _| cells.get(i, j).is_some()));
        Pseudoranges { cells, sigmas, ..self.clone() }
    }

    /// The matrix of these receivers and transmitters, in this order, with their names and standard
    /// deviations.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn select(&self, receivers: &[usize], transmitters: &[usize]) -> Pseudoranges {
        let (m, n) = (self.receivers(), self.transmitters());
        if receivers.iter().copied().eq(0..m) && transmitters.iter().copied().eq(0..n) {
            return self.clone();
        }
        Pseudoranges {
            receiver_names: receivers.iter().map(|&i| self.receiver_names[i].clone()).collect(),
            transmitter_names: transmitters.iter().map(|&j| self.transmitter_names[j].clone()).collect(),
            receivers_named: self.receivers_named,
            cells: self.cells.select(receivers, transmitters),
            sigmas: self.sigmas.as_ref().map(|sigmas| sigmas.select(receivers, transmitters)),
        }
    }
}

fn configuration(receivers: usize, transmitters: usize) -> String {
    format!("{receivers}r/{transmitters}s")
}

/// The number of cells of a matrix.
fn check_size(receivers: usize, transmitters: usize) -> Result<usize, PseudorangeError> {
    if receivers == 0 || transmitters == 0 {
        return Err(PseudorangeError::Empty { receivers, transmitters });
    }
    let cells = receivers.checked_mul(transmitters).filter(|&cells| cells <= MAX_CELLS);
    cells.ok_or(PseudorangeError::TooLarge { receivers, transmitters })
}

fn check_count(what: &'static str, per: &'static str, expected: usize, found: usize) -> Result<(), PseudorangeError> {
    if expected == found { Ok(()) } else { Err(PseudorangeError::Count { what, per, expected, found }) }
}

fn check_names(kind: &'static str, expected: usize, names: &[String]) -> Result<(), PseudorangeError> {
    check_count("names", kind, expected, names.len())?;
    let mut seen = std::collections::HashSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(name) => Err(PseudorangeError::DuplicateName { kind, name: name.clone() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn select_keeps_order_names_and_sigmas() {
        let f = Pseudoranges::new(2, 3, vec![0.0, 1.0, 2.0, 10.0, 11.0, f64::NAN]).unwrap();
        let f = f.with_sigmas(vec![0.1, 0.2, 0.3, 0.4, 0.5, f64::NAN]).unwrap();
        let g = f.select(&[1, 0], &[2, 0]);
        assert_eq!((g.get(0, 0), g.get(0, 1), g.get(1, 0), g.get(1, 1)), (None, Some(10.0), Some(2.0), Some(0.0)));
        assert_eq!(g.receiver_names(), ["r2", "r1"]);
        assert_eq!(g.transmitter_names(), ["s3", "s1"]);
        assert_eq!((g.sigma(0, 0), g.sigma(1, 0)), (None, Some(0.3)));
        assert_eq!(g.configuration(), "2r/2s");
    }

    #[test]
    fn refuses_what_is_no_matrix() {
        assert!(matches!(Pseudoranges::new(0, 3, vec![]), Err(PseudorangeError::Empty { .. })));
        assert!(matches!(Pseudoranges::new(usize::MAX, 2, vec![]), Err(PseudorangeError::TooLarge { .. })));
        assert!(matches!(Pseudoranges::new(2, 2, vec![0.0; 3]), Err(PseudorangeError::Count { found: 3, .. })));
        for bad in [f64::INFINITY, f64::NEG_INFINITY, 2e12] {
            let error = Pseudoranges::new(1, 2, vec![0.0, bad]).unwrap_err();
            assert!(error.to_string().starts_with("receiver r1, transmitter s2"), "{error}");
        }
        let f = Pseudoranges::new(1, 2, vec![0.0, 1.0]).unwrap();
        assert!(matches!(f.clone().with_sigmas(vec![1.0, 0.0]), Err(PseudorangeError::Sigma { .. })));
        let twice = Pseudoranges::from_cells(2, 2, [(1, 0, 1.0), (0, 1, 2.0), (1, 0, f64::NAN), (1, 0, 3.0)]);
        assert_eq!(twice.unwrap_err(), PseudorangeError::Twice { receiver: 2, transmitter: 1 });
        let outside = Pseudoranges::from_cells(2, 2, [(0, 2, 1.0)]).unwrap_err();
        assert_eq!(outside.to_string(), "receiver 1, transmitter 3: there are only 2r/2s");
        let twice = f.with_names(vec!["a".into()], vec!["b".into(), "b".into()]);
        assert!(matches!(twice, Err(PseudorangeError::DuplicateName { kind: "transmitter", .. })));
    }
}
