//! The measurement matrix.

mod clocks;
mod error;
#[cfg(feature = "csv")]
mod origin;

pub use error::{MAX_CELLS, MAX_MAGNITUDE, PseudorangeError};

use crate::candidates::Candidates;
use crate::cells::Cells;
use crate::clocks::{Emissions, Recorders};
use crate::distances::{self, ReceiverDistance};
use crate::median::median;
#[cfg(feature = "csv")]
pub(crate) use origin::{TimeOrigin, TimeScale};

/// The matrix f_ij of pseudoranges in metres: f_ij = |r_i - s_j| + o_j + noise, receivers i in
/// rows, transmitters j in columns. Cells that were not measured are missing. Where a detector found several
/// values for a cell and cannot tell which is right, the cell has them as
/// [candidates](Pseudoranges::with_candidates), of which a calibration picks one.
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
    /// Whether these are shares of one deviation, which is not known.
    are_shares: bool,
    /// All candidates of those cells that have more than one; their values are the chosen ones.
    candidates: Option<Cells<Candidates>>,
    receiver_names: Vec<String>,
    transmitter_names: Vec<String>,
    /// Whether the receivers' names were given, not counted.
    receivers_named: bool,
    /// What is known of the times at which transmitters send.
    emissions: Emissions,
    /// When each transmitter sends, by a clock of their own, metres.
    emission_times: Option<Vec<f64>>,
    /// From when on measurements count, where they were read as moments.
    #[cfg(feature = "csv")]
    origin: Option<TimeOrigin>,
    /// The recorder of each receiver, by name; names of receivers tell where nothing is said.
    recorders: Option<Vec<String>>,
    /// What is unknown of the recorders' clocks.
    unknown_clocks: Option<Recorders>,
    /// Distances between receivers that were measured by themselves.
    distances: Vec<ReceiverDistance>,
    /// Standard deviation of the measurements, metres, or the factor on their own: what is known besides is compared with it.
    deviation: f64,
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
            emissions: Emissions::Unknown,
            emission_times: None,
            #[cfg(feature = "csv")]
            origin: None,
            recorders: None,
            unknown_clocks: None,
            distances: Vec::new(),
            deviation: 1.0,
            sigmas: None,
            are_shares: false,
            candidates: None,
            cells,
        };
        matrix.cells.iter().try_for_each(|(i, j, value)| matrix.check_value(i, j, *value))?;
        Ok(matrix)
    }

    fn check_value(&self, i: usize, j: usize, value: f64) -> Result<(), PseudorangeError> {
        if value.is_finite() && value.abs() <= MAX_MAGNITUDE {
            return Ok(());
        }
        let (receiver, transmitter) = (self.receiver_names[i].clone(), self.transmitter_names[j].clone());
        Err(PseudorangeError::Unusable { receiver, transmitter, value })
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
        (self.sigmas, self.are_shares) = (Some(sigmas), false);
        Ok(self)
    }

    /// This matrix with a weight for each measured cell, by receiver and transmitter: one over the square of its
    /// standard deviation, in any unit. The deviation of a measurement with the median weight is then to be given, or
    /// estimated. Measurements of weight zero are left out.
    ///
    /// # Errors
    /// If a weight is negative or not finite, or all are zero.
    pub fn with_weight_of(self, weight: impl Fn(usize, usize) -> f64) -> Result<Self, PseudorangeError> {
        let mut weights: Vec<f64> = Vec::new();
        for (i, j, _) in self.cells.iter() {
            let value = weight(i, j);
            if !(value.is_finite() && value >= 0.0) {
                let (receiver, transmitter) = (self.receiver_names[i].clone(), self.transmitter_names[j].clone());
                return Err(PseudorangeError::Weight { receiver, transmitter, value });
            }
            weights.extend((value > 0.0).then_some(value));
        }
        let median = median(weights).ok_or(PseudorangeError::NoWeight)?;
        let weighed = self.filter(|i, j, _| weight(i, j) > 0.0);
        let weighed = weighed.with_sigma_of(|i, j| (median / weight(i, j)).sqrt())?;
        Ok(Pseudoranges { are_shares: true, ..weighed })
    }

    /// This matrix with further candidates of some cells: receiver, transmitter (both from 0) and value in
    /// metres, in any order, those of one cell in the order in which they are tried. The value that the cell
    /// has already is its first candidate; one standard deviation holds for all. NaN is no candidate.
    ///
    /// ```
    /// use tdoa::Pseudoranges;
    /// let f = Pseudoranges::new(1, 2, vec![1.0, 2.0])?.with_candidates([(0, 1, 1.5)])?;
    /// assert_eq!((f.candidates(0, 0), f.candidates(0, 1)), (&[1.0][..], &[2.0, 1.5][..]));
    /// # Ok::<(), tdoa::PseudorangeError>(())
    /// ```
    ///
    /// # Errors
    /// If a cell is outside or was not measured, or a value is infinite or huge.
    pub fn with_candidates(
        mut self,
        further: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Result<Self, PseudorangeError> {
        let mut further: Vec<(usize, usize, f64)> = further.into_iter().filter(|(.., value)| !value.is_nan()).collect();
        // Stable: those of a cell stay in their order.
        further.sort_by_key(|&(i, j, _)| (i, j));
        let mut all: Vec<(usize, usize, Candidates)> = Vec::new();
        for (i, j, value) in further {
            if i >= self.receivers() || j >= self.transmitters() {
                let configuration = self.configuration();
                return Err(PseudorangeError::Outside {
                    receiver: i.saturating_add(1),
                    transmitter: j.saturating_add(1),
                    configuration,
                });
            }
            self.check_value(i, j, value)?;
            if all.last().is_none_or(|(a, b, _)| (*a, *b) != (i, j)) {
                let known = self.candidates(i, j).to_vec();
                if known.is_empty() {
                    let (receiver, transmitter) = (self.receiver_names[i].clone(), self.transmitter_names[j].clone());
                    return Err(PseudorangeError::NoFirst { receiver, transmitter });
                }
                all.push((i, j, Candidates::new(known)));
            }
            all.iter_mut().last().into_iter().for_each(|(.., candidates)| candidates.push(value));
        }
        if let Some(known) = &self.candidates {
            let rest = known.iter().filter(|(i, j, _)| all.binary_search_by_key(&(*i, *j), |c| (c.0, c.1)).is_err());
            let rest: Vec<_> = rest.map(|(i, j, candidates)| (i, j, candidates.clone())).collect();
            all.extend(rest);
            all.sort_by_key(|(i, j, _)| (*i, *j));
        }
        self.candidates = (!all.is_empty()).then(|| Cells::new(self.cells.rows(), self.cells.columns(), all));
        Ok(self.choosing(|_, _, _| 0))
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

    /// All candidates of a cell in metres, as they were given; the pseudorange alone where it is the only
    /// one, none where the cell is missing or out of range.
    pub fn candidates(&self, i: usize, j: usize) -> &[f64] {
        match self.candidates.as_ref().and_then(|all| all.get(i, j)) {
            Some(candidates) => candidates.all(),
            None => self.cells.get(i, j).map(std::slice::from_ref).unwrap_or_default(),
        }
    }

    /// Whether some cell has more than one candidate.
    pub fn has_candidates(&self) -> bool {
        self.candidates.is_some()
    }

    /// Receiver, transmitter and candidates of the cells that have more than one.
    pub(crate) fn doubtful(&self) -> impl Iterator<Item = (usize, usize, &Candidates)> {
        self.candidates.iter().flat_map(Cells::iter)
    }

    /// This matrix with a choice among the candidates of each cell that has more than one, by receiver,
    /// transmitter and candidates.
    pub(crate) fn choosing(&self, mut choice: impl FnMut(usize, usize, &Candidates) -> usize) -> Pseudoranges {
        let Some(candidates) = &self.candidates else { return self.clone() };
        let candidates = candidates.map(|i, j, all| all.choosing(choice(i, j, all)));
        let cells = self.cells.map(|i, j, value| candidates.get(i, j).map_or(*value, Candidates::value));
        Pseudoranges { cells, candidates: Some(candidates), ..self.clone() }
    }

    /// Whether another choice among the same candidates differs from this one.
    pub(crate) fn chooses_otherwise(&self, other: &Pseudoranges) -> bool {
        self.doubtful().zip(other.doubtful()).any(|(a, b)| a.2.chosen() != b.2.chosen())
    }

    /// The standard deviation (metres) given for a cell, or its share of that of a measurement with the median weight
    /// where weights are given; `None` if there is none.
    pub fn sigma(&self, i: usize, j: usize) -> Option<f64> {
        self.sigmas.as_ref()?.get(i, j).copied()
    }

    /// Whether the cells carry their own standard deviations, or weights.
    pub fn has_sigmas(&self) -> bool {
        self.sigmas.is_some()
    }

    /// The weight of a cell, in units of the median weight; `None` if no weights are given.
    pub fn weight(&self, i: usize, j: usize) -> Option<f64> {
        self.sigma(i, j).filter(|_| self.are_shares).map(|share| share.powi(-2))
    }

    /// Whether the cells carry standard deviations in metres, not weights.
    pub fn knows_sigmas(&self) -> bool {
        self.has_sigmas() && !self.are_shares
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

    /// This matrix with other values in the same cells and of their candidates, usable ones, by receiver,
    /// transmitter and value.
    pub(crate) fn map(&self, mut value: impl FnMut(usize, usize, &f64) -> f64) -> Pseudoranges {
        let Some(candidates) = &self.candidates else {
            return Pseudoranges { cells: self.cells.map(value), ..self.clone() };
        };
        let candidates = candidates.map(|i, j, all| all.map(|f| value(i, j, f)));
        let cells = self.cells.map(|i, j, f| candidates.get(i, j).map_or_else(|| value(i, j, f), Candidates::value));
        Pseudoranges { cells, candidates: Some(candidates), ..self.clone() }
    }

    /// This matrix without the cells for which `keep` does not hold, by receiver, transmitter and value; a
    /// cell goes with all its candidates.
    pub(crate) fn filter(&self, mut keep: impl FnMut(usize, usize, f64) -> bool) -> Pseudoranges {
        let cells = self.cells.filter(|i, j, value| keep(i, j, *value));
        let sigmas = self.sigmas.as_ref().map(|sigmas| sigmas.filter(|i, j, _| cells.get(i, j).is_some()));
        let candidates = self.candidates.as_ref().map(|all| all.filter(|i, j, _| cells.get(i, j).is_some()));
        let candidates = candidates.filter(|all| !all.is_empty());
        Pseudoranges { cells, sigmas, candidates, ..self.clone() }
    }

    /// This matrix with distances between receivers that were measured by themselves.
    pub(crate) fn with_distances(self, distances: Vec<ReceiverDistance>) -> Pseudoranges {
        Pseudoranges { distances, ..self }
    }

    /// Distances between receivers that were measured by themselves.
    pub(crate) fn distances(&self) -> &[ReceiverDistance] {
        &self.distances
    }

    /// This matrix, of measurements with this standard deviation, metres, or the factor on their own.
    pub(crate) fn at_deviation(self, deviation: f64) -> Pseudoranges {
        Pseudoranges { deviation, ..self }
    }

    /// The standard deviation of the measurements that was given last.
    pub(crate) fn deviation(&self) -> f64 {
        self.deviation
    }

    /// The matrix of these receivers and transmitters, in this order, with their names, standard
    /// deviations and candidates.
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
            emissions: self.emissions,
            emission_times: self.emission_times.as_ref().map(|all| transmitters.iter().map(|&j| all[j]).collect()),
            recorders: self.recorders.as_ref().map(|all| receivers.iter().map(|&i| all[i].clone()).collect()),
            #[cfg(feature = "csv")]
            origin: self.origin,
            unknown_clocks: self.unknown_clocks.as_ref().map(|all| all.select(receivers, transmitters)),
            distances: distances::select(&self.distances, receivers),
            deviation: self.deviation,
            are_shares: self.are_shares,
            cells: self.cells.select(receivers, transmitters),
            sigmas: self.sigmas.as_ref().map(|sigmas| sigmas.select(receivers, transmitters)),
            candidates: (self.candidates.as_ref().map(|all| all.select(receivers, transmitters)))
                .filter(|all| !all.is_empty()),
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
mod tests;
