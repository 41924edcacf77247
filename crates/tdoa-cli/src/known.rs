//! Known positions of receivers: the truth to compare with, and anchors.

use hc::poly::counted;
use std::path::Path;

use tdoa::quantity::length;
use tdoa::read::{Nodes, is_mat, read_mat_nodes, read_mat_transmitters, read_nodes};
use tdoa::{MeasuredPosition, Pseudoranges};

use crate::Failure;

/// Names that a message lists at most.
const LISTED: usize = 8;

/// Heights that differ by more than this share of the extent are no plane.
const FLAT: f64 = 0.1;

type Positions = Vec<Option<[f64; 2]>>;

/// True positions, and what is to be said of them.
#[derive(Default)]
pub(crate) struct Truth {
    /// Positions of the receivers, in their order; `None` if nothing is known.
    pub(crate) receivers: Option<Positions>,
    /// Positions of the transmitters, in their order; none if nothing is known.
    pub(crate) transmitters: Positions,
    /// What the user should know, of the file and not of the network.
    pub(crate) notes: Vec<String>,
    /// What may be wrong with the comparison.
    pub(crate) warnings: Vec<String>,
}

impl Truth {
    /// The truth in the file given for it, otherwise the one in the .mat file of the measurements.
    pub(crate) fn read(given: Option<&Path>, file: &Path, measured: &Pseudoranges) -> Result<Truth, Failure> {
        let mut truth = Truth::default();
        if let Some(path) = given {
            let nodes = read_nodes(path).map_err(Failure::unusable)?;
            // A node without a name is whole.
            let partial = nodes.nodes.iter().find(|node| node.whole::<2>().is_none());
            if let Some(name) = partial.and_then(|node| node.name.as_deref()) {
                return Err(Failure::in_file(path, format!("{name} has one coordinate alone; a truth needs both")));
            }
            truth.receivers = Some(truth.place(path, &nodes, measured)?);
        } else if is_mat(file)
            && let Some(nodes) = read_mat_nodes(file).map_err(Failure::unusable)?
        {
            // What stands beside the measurements may be of other receivers.
            truth.receivers = nodes.in_order(measured.receiver_names());
            truth.notes.extend(match truth.receivers {
                Some(_) => heights(file, &nodes),
                None => Some(format!(
                    "{}: rgt has {} for {}, so that nothing is compared with it",
                    file.display(),
                    counted(nodes.nodes.len(), "position"),
                    counted(measured.receivers(), "receiver")
                )),
            });
        }
        let file = given.unwrap_or(file);
        if is_mat(file) {
            let all = read_mat_transmitters(file).map_err(Failure::unusable)?.unwrap_or_default().positions();
            truth.transmitters = if all.len() == measured.transmitters() { all } else { Vec::new() };
        }
        Ok(truth)
    }

    /// The positions in the order of the receivers: by name, or by order where one side has no
    /// names.
    fn place(&mut self, path: &Path, nodes: &Nodes, measured: &Pseudoranges) -> Result<Positions, Failure> {
        let receivers = measured.receiver_names();
        let unusable = |problem: String| Err(Failure::in_file(path, problem));
        let unknown = nodes.unknown(receivers);
        let matched = nodes.names_any(receivers);
        let is_named = nodes.is_named();
        if is_named && !matched && measured.receivers_named() {
            return unusable(format!(
                "no receiver is named {}; the receivers are {}: use their names, or leave out the names (lines x,y) to give the \
                 positions in the order of the receivers",
                quoted(&unknown),
                some(receivers)
            ));
        }
        let Some(found) = nodes.in_order(receivers) else {
            return unusable(format!(
                "has {} for {}, and no name in common; give one line id,x,y for each receiver, in order \
                 or with its name",
                counted(nodes.nodes.len(), "position"),
                counted(measured.receivers(), "receiver")
            ));
        };
        if found.iter().flatten().count() < 2 {
            return unusable(format!(
                "fewer than two receivers are known by name: no receiver is named {}; the receivers are {}",
                quoted(&unknown),
                some(receivers)
            ));
        }
        let file = path.display();
        if matched && !unknown.is_empty() {
            self.notes.push(format!("{file}: no receiver is named {}: left out of the comparison", quoted(&unknown)));
        }
        let by_order = "its positions were taken in the order of the receivers";
        if is_named && !matched {
            self.warnings.push(format!("{file}: no name in common with the receivers, so that {by_order}"));
        } else if !is_named {
            self.notes.push(format!("{file}: has no names, so that {by_order}"));
        }
        self.notes.extend(heights(path, nodes));
        Ok(found)
    }
}

/// Known positions of receivers, and what is to be said of them.
pub(crate) struct Anchors {
    /// Exact ones, in the order of the receivers.
    pub(crate) exact: Positions,
    /// Those with a standard deviation or with one coordinate alone.
    pub(crate) measured: Vec<MeasuredPosition>,
    pub(crate) note: Option<String>,
}

/// Known positions in a file. Where it has a column sigma, or std_x and std_y, each has standard
/// deviations, 0 for an exact one. A name that no receiver has is more likely a mistake than meant.
pub(crate) fn anchors(path: &Path, measured: &Pseudoranges) -> Result<Anchors, Failure> {
    let nodes = read_nodes(path).map_err(Failure::unusable)?;
    let receivers = measured.receiver_names();
    if !nodes.is_named() {
        return Err(Failure::in_file(path, "names no receivers; expected lines name,x,y"));
    }
    let unknown = nodes.unknown(receivers);
    if !unknown.is_empty() {
        return Err(Failure::in_file(
            path,
            format!("no receiver is named {}; they are {}", quoted(&unknown), some(receivers)),
        ));
    }
    if let Some([low, high]) = nodes.height_range()
        && high - low > FLAT * extent(&nodes)
    {
        return Err(Failure::in_file(
            path,
            format!(
                "the heights (z) of the anchors differ by {}, but the calibration is in a plane; give anchors at one height, or \
                 leave out the column z if the differences do not matter",
                length(high - low)
            ),
        ));
    }
    let mut found = Anchors { exact: vec![None; receivers.len()], measured: Vec::new(), note: heights(path, &nodes) };
    for (i, receiver) in receivers.iter().enumerate() {
        let Some(node) = nodes.named(receiver) else { continue };
        let [x, y, _] = node.position;
        let position = [x, y];
        if position == [None; 2] {
            return Err(Failure::in_file(
                path,
                format!("{receiver} has neither x nor y; give one of them, or leave it out"),
            ));
        }
        // Without standard deviations all positions are exact.
        let [of_x, of_y, _] = node.sigma;
        let sigma = if nodes.has_sigmas { [of_x, of_y] } else { [0.0; 2] };
        let is_missing = |k: usize| position[k].is_some() && (sigma[k].is_nan() || sigma[k] < 0.0);
        if is_missing(0) || is_missing(1) {
            return Err(Failure::in_file(
                path,
                format!(
                    "the standard deviation of {receiver} is missing or negative; give one in metres, 0 for an exact position"
                ),
            ));
        }
        match position {
            [Some(x), Some(y)] if sigma == [0.0; 2] => found.exact[i] = Some([x, y]),
            _ => {
                // A coordinate that is not known has no deviation.
                let sigma = [0, 1].map(|k| if position[k].is_some() { sigma[k] } else { 0.0 });
                found.measured.push(MeasuredPosition { receiver: i, position, sigma });
            }
        }
    }
    Ok(found)
}

/// Warns that heights are left out, where there are any.
fn heights(path: &Path, nodes: &Nodes) -> Option<String> {
    let [low, high] = nodes.height_range().filter(|range| *range != [0.0; 2])?;
    let range = if low == high { length(low) } else { format!("{} to {}", length(low), length(high)) };
    let flat = high - low <= FLAT * extent(nodes);
    let advice = if flat { "" } else { "; receivers at such different heights form no plane" };
    Some(format!(
        "{}: the heights (z, {range}) are left out: the network is taken to be a plane{advice}",
        path.display()
    ))
}

/// The largest distance along x or y.
fn extent(nodes: &Nodes) -> f64 {
    let positions: Vec<[f64; 2]> = nodes.positions().into_iter().flatten().collect();
    let range = |k: usize| {
        let all = || positions.iter().map(|p| p[k]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    range(0).max(range(1))
}

/// The first of some names.
fn some(names: &[impl AsRef<str>]) -> String {
    listed(names, |name| name.to_string())
}

/// The first of some names in quotes.
fn quoted(names: &[&str]) -> String {
    listed(names, |name| format!("{name:?}"))
}

fn listed(names: &[impl AsRef<str>], show: impl Fn(&str) -> String) -> String {
    let shown: Vec<String> = names.iter().take(LISTED).map(|name| show(name.as_ref())).collect();
    let rest = if names.len() > LISTED { format!(" and {} more", names.len() - LISTED) } else { String::new() };
    shown.join(", ") + &rest
}
