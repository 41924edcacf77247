//! The CSV list: one measurement a line.

use std::borrow::Cow;
use std::collections::hash_map::Entry::{Occupied, Vacant};
use std::collections::{HashMap, HashSet};

use hc::poly::counted;

use super::cells::{Record, Separator};
use super::columns::Columns;
use super::error::ReadError;
use super::numbers::{Numbers, shorten};
use super::pairs::Pairs;
use super::thousands::refuse_thousands;
use super::units::Units;
use crate::pseudoranges::{MAX_CELLS, Pseudoranges};

/// Reads the lines below the first.
pub(super) fn list(
    records: impl Iterator<Item = Result<Record, ReadError>>,
    columns: &Columns,
    mut numbers: Numbers,
    separator: Separator,
    file: &str,
    units: Units,
) -> Result<Pseudoranges, ReadError> {
    let factor = units.factor()?;
    let mut receivers = Names::default();
    let mut transmitters = Names::default();
    let mut entries: HashMap<(usize, usize), Entry> = HashMap::new();
    let mut recorders: HashMap<usize, String> = HashMap::new();
    // Candidates behind the first of a pair.
    let mut further: Vec<(usize, usize, f64)> = Vec::new();
    let mut pairs = Pairs::default();
    let mut selections = HashSet::new();
    for record in records {
        let record = record?;
        if record.is_blank() {
            continue;
        }
        let Record { line, cells } = record;
        let bad = |problem: String| ReadError::Line { file: file.to_string(), line, problem };
        let extra = cells.get(columns.count..).unwrap_or_default();
        if cells.len() < columns.count || extra.iter().any(|cell| !cell.is_empty()) {
            return Err(bad(format!(
                "has {} where the header has {}; write decimal points, or decimal commas with semicolons between cells",
                counted(cells.len(), "cell"),
                columns.count
            )));
        }
        // Raven writes a line for each view of a selection.
        if columns.selection.is_some_and(|k| !selections.insert(cells[k].clone())) {
            continue;
        }
        let (receiver, transmitter) = (&cells[columns.receiver], &cells[columns.transmitter]);
        let recorder = columns.recorder.map(|k| &cells[k]);
        let receiver = &match recorder {
            Some(recorder) if columns.are_channels && !recorder.is_empty() => {
                Cow::Owned(format!("{recorder}:{receiver}"))
            }
            _ => Cow::Borrowed(receiver.as_str()),
        };
        if receiver.is_empty() || transmitter.is_empty() {
            return Err(bad("names no receiver or no transmitter; both are needed".to_string()));
        }
        let not_a_number = |column: usize, remedy: String| ReadError::NotANumber {
            file: file.to_string(),
            line,
            column: column + 1,
            place: format!("receiver {receiver}, transmitter {transmitter}"),
            text: shorten(&cells[column]),
            remedy,
        };
        let mut measurement = |k: usize| {
            let value = numbers.measurement(&cells[k], units).map_err(|why| not_a_number(k, why))?;
            Ok::<f64, ReadError>(value * factor)
        };
        let mut value = measurement(columns.value)?;
        let mut others: Vec<f64> = columns.further.iter().map(|&k| measurement(k)).collect::<Result<_, _>>()?;
        others.retain(|other| !other.is_nan());
        if value.is_nan() && !others.is_empty() {
            value = others.remove(0);
        }
        let mut number = |k: usize| numbers.number(&cells[k]).map_err(|why| not_a_number(k, why));
        let sigma = columns.sigma.map(&mut number).transpose()?;
        let weight = columns.weight.map(&mut number).transpose()?;
        let sigma_or_weight = weight.unwrap_or_else(|| sigma.map_or(1.0, |sigma| sigma * factor));
        let at = (receivers.index(receiver), transmitters.index(transmitter));
        let reference = columns.reference.map(|k| &cells[k]);
        if let Some(recorder) = recorder {
            if recorder.is_empty() {
                return Err(bad(format!("names no recorder of receiver {receiver}; each line needs it")));
            }
            let known = recorders.entry(at.0).or_insert_with(|| recorder.clone());
            if known != recorder {
                return Err(bad(format!(
                    "receiver {receiver} has the recorders {} and {}; give receivers of different recorders different names",
                    shorten(known),
                    shorten(recorder)
                )));
            }
        }
        let second = reference.map(|reference| receivers.index(reference));
        if value.is_nan() {
            continue;
        }
        if (entries.len() + further.len() + others.len()).max(pairs.len()) >= MAX_CELLS {
            return Err(ReadError::TooManyCells { file: file.to_string(), line });
        }
        if let (Some(second), Some(reference)) = (second, reference) {
            if reference.is_empty() {
                return Err(bad("names no reference; a difference has two receivers".to_string()));
            }
            pairs.add(at.1, [at.0, second], value);
            continue;
        }
        match entries.entry(at) {
            Vacant(free) => _ = free.insert(Entry { value, sigma_or_weight, line }),
            Occupied(earlier) if !columns.repeats => {
                return Err(bad(format!(
                    "receiver {receiver}, transmitter {transmitter} is there twice, on line {} too; keep one measurement of each pair, or \
                     give --candidates if only one of them is right and it is not known which",
                    earlier.get().line
                )));
            }
            Occupied(earlier) if earlier.get().sigma_or_weight != sigma_or_weight => {
                return Err(bad(format!(
                    "receiver {receiver}, transmitter {transmitter} has another {} than on line {}; give one for all \
                     candidates of a pair",
                    if weight.is_some() { "weight" } else { "standard deviation" },
                    earlier.get().line
                )));
            }
            Occupied(_) => further.push((at.0, at.1, value)),
        }
        further.extend(others.into_iter().map(|other| (at.0, at.1, other)));
    }
    if receivers.names.is_empty() {
        return Err(ReadError::Empty { file: file.to_string() });
    }
    let (m, n) = (receivers.names.len(), transmitters.names.len());
    let wrap = |source| ReadError::Matrix { file: file.to_string(), source };
    let measured = if columns.reference.is_some() {
        let times = pairs.times(&receivers.names, &transmitters.names);
        let times = times.map_err(|problem| ReadError::Pairs { file: file.to_string(), problem })?;
        Pseudoranges::from_cells(m, n, times)
    } else {
        Pseudoranges::from_cells(m, n, entries.iter().map(|(&(i, j), entry)| (i, j, entry.value)))
    };
    let measured = measured.map_err(wrap)?.with_names(receivers.names, transmitters.names).map_err(wrap)?;
    let mut measured = measured.with_candidates(further).map_err(wrap)?;
    if columns.recorder.is_some() {
        let all = (0..m).map(|i| recorders.remove(&i).unwrap_or_default()).collect();
        measured = measured.with_recorders(all).map_err(wrap)?;
    }
    refuse_thousands(&numbers, separator, units, &measured, file)?;
    let measured = measured.with_origin(numbers.origin());
    let sigma_or_weight = |i: usize, j: usize| entries.get(&(i, j)).map_or(f64::NAN, |entry| entry.sigma_or_weight);
    match (columns.sigma, columns.weight) {
        (Some(_), _) => measured.with_sigma_of(sigma_or_weight).map_err(wrap),
        (_, Some(_)) => measured.with_weight_of(sigma_or_weight).map_err(wrap),
        _ => Ok(measured),
    }
}

/// A measurement, its standard deviation or its weight, and where it stands.
struct Entry {
    value: f64,
    sigma_or_weight: f64,
    line: u64,
}

/// Names in the order of their first appearance.
#[derive(Default)]
struct Names {
    names: Vec<String>,
    places: HashMap<String, usize>,
}

impl Names {
    fn index(&mut self, name: &str) -> usize {
        if let Some(&place) = self.places.get(name) {
            return place;
        }
        self.names.push(name.to_string());
        self.places.insert(name.to_string(), self.names.len() - 1);
        self.names.len() - 1
    }
}
