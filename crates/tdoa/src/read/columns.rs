//! Where a list has its columns, by their headings or as the options say.

use super::candidates::{check_further, first_of_numbered, further_columns};
use super::error::ReadError;
use super::heading::{Heading, check_unit, quoted};
use super::role::Role;
use super::units::ReadOptions;
use super::words::{CHANNEL, LENGTH, RECEIVER, RECORDER, REFERENCE, SIGMA, TIME, TRANSMITTER, WEIGHT, Words};

/// Where a list has its columns.
pub(super) struct Columns {
    pub(super) receiver: usize,
    /// The recorder of the receiver.
    pub(super) recorder: Option<usize>,
    /// Whether receivers are channels, which each recorder may count for itself.
    pub(super) are_channels: bool,
    pub(super) transmitter: usize,
    pub(super) value: usize,
    /// Further candidates for the value.
    pub(super) further: Vec<usize>,
    /// Whether several lines of one pair are its candidates.
    pub(super) repeats: bool,
    pub(super) sigma: Option<usize>,
    pub(super) weight: Option<usize>,
    /// Where each line is the difference of two receivers' times, that of the second.
    pub(super) reference: Option<usize>,
    /// Where each line may be there several times, as in Raven's selection tables, its number.
    pub(super) selection: Option<usize>,
    pub(super) count: usize,
}

/// Columns by what their headings say that they hold.
struct Roles {
    receivers: Vec<usize>,
    recorders: Vec<usize>,
    transmitters: Vec<usize>,
    /// Measurements of either kind.
    values: Vec<usize>,
    times: Vec<usize>,
    sigmas: Vec<usize>,
    weights: Vec<usize>,
    references: Vec<usize>,
    /// Further candidates, as far as the options say them.
    candidates: Vec<usize>,
    /// How many of receiver, transmitter and value are said for sure.
    sure: usize,
}

impl Roles {
    fn of(headings: &[Heading]) -> Roles {
        let under = |names: &[&str]| -> Vec<usize> { (0..headings.len()).filter(|&k| headings[k].is(names)).collect() };
        let mut sure = 0;
        let mut found = |words: &[&Words]| -> Vec<usize> {
            let all = |of: fn(&Words) -> &'static [&'static str]| -> Vec<usize> {
                words.iter().flat_map(|words| under(of(words))).collect()
            };
            let said = all(|words| words.sure);
            sure += usize::from(!said.is_empty());
            if said.is_empty() { all(|words| words.weak) } else { said }
        };
        let (all, transmitters, values) = (found(&[&RECEIVER]), found(&[&TRANSMITTER]), found(&[&LENGTH, &TIME]));
        let (mut recorders, mut receivers) = all.iter().copied().partition::<Vec<_>, _>(|&k| headings[k].is(RECORDER));
        if receivers.is_empty() {
            (receivers, recorders) = (recorders, Vec::new());
        }
        let times = values.iter().copied().filter(|&k| headings[k].may_be(&TIME)).collect();
        let (sigmas, weights, references) = (under(SIGMA.sure), under(WEIGHT.sure), under(REFERENCE.sure));
        let candidates = Vec::new();
        Roles { receivers, recorders, transmitters, values, times, sigmas, weights, references, candidates, sure }
    }

    /// Puts what the options say in the place of what headings do.
    fn given(&mut self, said: &[(Role, usize)]) {
        let (nodes, measured) = ([&mut self.receivers, &mut self.transmitters], [&mut self.values, &mut self.times]);
        for of in nodes.into_iter().chain(measured).chain([&mut self.sigmas, &mut self.weights, &mut self.recorders]) {
            of.retain(|k| said.iter().all(|(_, given)| given != k));
        }
        let given = |role: Role| said.iter().filter(move |(given, _)| *given == role).map(|(_, k)| *k);
        let put = |role: Role, place: &mut Vec<usize>| {
            if given(role).next().is_some() {
                *place = given(role).collect();
            }
        };
        put(Role::Receiver, &mut self.receivers);
        put(Role::Recorder, &mut self.recorders);
        put(Role::Transmitter, &mut self.transmitters);
        put(Role::Sigma, &mut self.sigmas);
        put(Role::Weight, &mut self.weights);
        put(Role::Reference, &mut self.references);
        put(Role::Candidate, &mut self.candidates);
        let values: Vec<usize> = given(Role::Value).chain(given(Role::Time)).collect();
        if !values.is_empty() {
            (self.values, self.times) = (values, given(Role::Time).collect());
        }
    }

    /// Whether these are the columns of a list: two of the three that it needs are said for sure, or
    /// each is there once, or there are two receivers to each measurement.
    fn are_of_list(&self, headings: &[Heading]) -> bool {
        let once = [&self.receivers, &self.transmitters, &self.values].iter().all(|found| found.len() == 1);
        let is_raven =
            ["selection", "begin_time"].iter().all(|name| headings.iter().any(|heading| heading.name == *name));
        self.sure >= 2 || once || self.pair(headings).is_some() || is_raven
    }

    /// Whether the two receivers of differences are there, in place of one.
    fn pair(&self, headings: &[Heading]) -> Option<[usize; 2]> {
        if self.values.is_empty() || !self.receivers.is_empty() {
            return None;
        }
        let of_pairs: Vec<(usize, (usize, usize))> =
            (0..headings.len()).filter_map(|k| Some((k, headings[k].of_pair()?))).collect();
        match *of_pairs.as_slice() {
            // Letters alone may name anything where no column is the event.
            [(a, _), (b, _)] if self.transmitters.is_empty() && [a, b].iter().any(|&k| headings[k].is_mark()) => None,
            [(a, (marks, 0)), (b, (same, 1))] if marks == same => Some([a, b]),
            _ => None,
        }
    }
}

fn headings<S: AsRef<str>>(cells: &[S]) -> Vec<Heading> {
    cells.iter().map(|cell| Heading::new(cell.as_ref())).collect()
}

/// Whether a table with these headings is a list of one measurement a line, as [`read`](super::read) takes it: two of
/// receiver, transmitter and value are there, so that the third is asked for.
pub fn heads_list<S: AsRef<str>>(cells: &[S]) -> bool {
    let headings = headings(cells);
    Roles::of(&headings).are_of_list(&headings)
}

/// The columns that the options name, each with its place.
///
/// # Errors
/// For headings that are not there.
pub(super) fn given(
    cells: &[String],
    options: &ReadOptions,
    file: &str,
    line: u64,
) -> Result<Vec<(Role, usize)>, ReadError> {
    let mut all = Vec::new();
    for (role, wanted) in &options.columns {
        let (same, wanted_name) = (|cell: &String| cell.eq_ignore_ascii_case(wanted.trim()), Heading::new(wanted).name);
        let by_name =
            || cells.iter().position(|cell| !wanted_name.is_empty() && Heading::new(cell).name == wanted_name);
        let Some(place) = cells.iter().position(same).or_else(by_name) else {
            let there: Vec<String> = cells.iter().take(12).map(|cell| format!("{cell:?}")).collect();
            return Err(ReadError::Columns {
                file: file.to_string(),
                line,
                problem: format!("no column is headed {wanted:?}; there are {}", there.join(", ")),
            });
        };
        if let Some((other, _)) = all.iter().find(|(_, given)| *given == place) {
            return Err(ReadError::Columns {
                file: file.to_string(),
                line,
                problem: format!("the column {wanted:?} cannot be two things, {role} and {other}"),
            });
        }
        all.push((*role, place));
    }
    Ok(all)
}

/// The columns of a list; `None` if the first line is not that of a list.
///
/// # Errors
/// For columns that cannot be told apart, that are not there, and in another unit.
pub(super) fn list_columns(
    cells: &[String],
    said: &[(Role, usize)],
    file: &str,
    line: u64,
    options: &ReadOptions,
) -> Result<Option<Columns>, ReadError> {
    let units = options.units;
    let headings = headings(cells);
    let mut roles = Roles::of(&headings);
    let is_list = roles.are_of_list(&headings);
    roles.given(said);
    let is_said = said.iter().any(|(role, _)| !matches!(role, Role::Receiver | Role::Ignore));
    let pair = roles.pair(&headings);
    if !is_list && !is_said {
        return Ok(None);
    }
    let bad = |problem: String| ReadError::Heading { file: file.to_string(), line, problem };
    if let Some([a, b]) = pair {
        if roles.transmitters.is_empty() {
            return Err(bad("no column says which event each difference is of; give it a column event".to_string()));
        }
        let (a, b) = (quoted(&cells[a]), quoted(&cells[b]));
        return Err(ReadError::Columns {
            file: file.to_string(),
            line,
            problem: format!(
                "each line is the difference of two receivers' times, and it is not said which is taken off; give --columns \
                 receiver={b},reference={a} if it is the time at {b} minus that at {a}, otherwise receiver={a},reference={b}"
            ),
        });
    }
    let Roles {
        receivers,
        recorders,
        transmitters,
        mut values,
        mut times,
        sigmas,
        weights,
        references,
        candidates,
        ..
    } = roles;
    if let (true, Some((first, is_time))) = (values.is_empty(), first_of_numbered(&headings)) {
        values.push(first);
        times.extend(is_time.then_some(first));
    }
    let needed = [("receiver", &receivers), ("transmitter", &transmitters), ("value", &values)];
    let others = [("sigma", &sigmas), ("weight", &weights), ("reference", &references), ("recorder", &recorders)];
    for (role, found) in needed.iter().chain(&others) {
        if let [a, b, ..] = found.as_slice() {
            return Err(bad(format!(
                "the columns {:?} and {:?} may both be the {role}; rename one, or say which (--columns {role}={})",
                cells[*a],
                cells[*b],
                quoted(&cells[*a])
            )));
        }
    }
    let ([receiver], [transmitter], [value]) = (receivers.as_slice(), transmitters.as_slice(), values.as_slice())
    else {
        let missing: Vec<&str> = needed.iter().filter(|(_, found)| found.is_empty()).map(|(role, _)| *role).collect();
        let which = missing.iter().map(|role| format!("{role}=...")).collect::<Vec<_>>().join(",");
        return Err(bad(format!("no column is the {}; say which (--columns {which})", missing.join(" or the "))));
    };
    let (sigma, weight) = (sigmas.first().copied(), weights.first().copied());
    if let Some((k, other)) = sigma.zip(weight) {
        return Err(bad(format!(
            "the columns {:?} and {:?} say twice how sure a measurement is; leave one out (--columns ignore={})",
            cells[k],
            cells[other],
            quoted(&cells[other])
        )));
    }
    let wrong = |problem: String| ReadError::Unit { file: file.to_string(), line, problem };
    let is_time = times.contains(value);
    check_unit("column", &cells[*value], headings[*value].unit, is_time, units).map_err(wrong)?;
    if let Some(k) = sigma
        && let (Some(unit), Some(other)) = (headings[k].unit, headings[*value].unit)
        && unit != other
    {
        return Err(wrong(format!(
            "{:?} and {:?} are in different units; give both in {other}",
            cells[*value], cells[k]
        )));
    }
    let is_free = |k: usize| said.iter().all(|(_, given)| *given != k);
    let further = if candidates.is_empty() { further_columns(&headings, *value, is_free) } else { candidates };
    check_further(cells, &headings, *value, &further, is_free, units).map_err(wrong)?;
    let reference = references.first().copied();
    if reference.is_some() && (!further.is_empty() || options.candidates) {
        return Err(bad(
            "candidates of differences are not read; give times, or leave out the further columns (--columns ignore=...) and \
             --candidates"
                .into(),
        ));
    }
    if reference.is_some() && (sigma.is_some() || weight.is_some()) {
        return Err(bad(
            "standard deviations and weights of differences are not read; leave out that column (--columns ignore=...)"
                .into(),
        ));
    }
    let recorder = recorders.first().copied();
    if reference.is_some() && recorder.is_some() {
        return Err(bad(
            "recorders of differences are not read; leave out that column (--columns ignore=...), and give --recorders"
                .into(),
        ));
    }
    let headed = |name: &str| headings.iter().position(|heading| heading.name == name);
    let selection = headed("view").and(headed("selection"));
    let (receiver, transmitter, value) = (*receiver, *transmitter, *value);
    let are_channels = recorder.is_some() && headings[receiver].is(CHANNEL);
    let (repeats, count) = (options.candidates, cells.len());
    Ok(Some(Columns {
        receiver,
        recorder,
        are_channels,
        transmitter,
        value,
        further,
        repeats,
        sigma,
        weight,
        reference,
        selection,
        count,
    }))
}

/// Refuses columns of a matrix that hold something else than measurements.
///
/// # Errors
/// For the first of them.
pub(super) fn refuse_others(header: &[String], file: &str, line: u64) -> Result<(), ReadError> {
    match header.iter().skip(1).find(|cell| Heading::new(cell).heads_other()) {
        None => Ok(()),
        Some(cell) => Err(ReadError::Columns {
            file: file.to_string(),
            line,
            problem: format!(
                "the column {cell:?} seems to hold no arrival times; leave it out (--columns ignore={}), or rename it if it does",
                quoted(cell)
            ),
        }),
    }
}
