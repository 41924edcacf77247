//! Known positions of nodes: the truth to compare with, and anchors.

use cli::input::name;
use hc::poly::counted;
use std::path::Path;

use tdoa::quantity::length;
use tdoa::read::{Nodes, is_mat, read_mat_nodes, read_mat_transmitters};
use tdoa::{MeasuredPosition, Node, Pseudoranges};

use crate::Failure;

/// Names that a message lists at most.
const LISTED: usize = 8;

/// Heights that differ by more than this share of the extent are no plane.
const FLAT: f64 = 0.1;

type Positions<const D: usize> = Vec<Option<[f64; D]>>;

/// True positions, and what is to be said of them.
#[derive(Default)]
pub(crate) struct Truth<const D: usize> {
    /// Positions of the receivers, in their order; `None` if nothing is known.
    pub(crate) receivers: Option<Positions<D>>,
    /// Positions of the transmitters, in their order; none if nothing is known.
    pub(crate) transmitters: Positions<D>,
    /// What the user should know, of the file and not of the network.
    pub(crate) notes: Vec<String>,
    /// What may be wrong with the comparison.
    pub(crate) warnings: Vec<String>,
}

impl<const D: usize> Truth<D> {
    /// The truth in the file given for it, otherwise the one in the .mat file of the measurements.
    pub(crate) fn read(
        given: Option<(&Path, &Nodes)>,
        file: &Path,
        measured: &Pseudoranges,
    ) -> Result<Truth<D>, Failure> {
        let mut truth = Truth::default();
        if let Some((path, nodes)) = given {
            if let Some(k) = nodes.positions::<D>().iter().position(Option::is_none) {
                let name = nodes.nodes[k].name.clone().unwrap_or_else(|| format!("position {}", k + 1));
                let lacks = match nodes.nodes[k].whole::<2>() {
                    Some(_) => "has no z; a truth in space needs x, y and z",
                    None => "has one coordinate alone; a truth needs both",
                };
                return Err(Failure::in_file(path, format!("{name} {lacks}")));
            }
            truth.receivers = Some(truth.place(path, nodes, measured)?);
        } else if is_mat(file)
            && let Some(nodes) = read_mat_nodes(file).map_err(Failure::unusable)?
        {
            // What stands beside the measurements may be of other receivers.
            truth.receivers = nodes.in_order(measured.receiver_names());
            truth.notes.extend(match truth.receivers {
                Some(_) => heights::<D>(file, &nodes),
                None => Some(format!(
                    "{}: rgt has {} for {}, so that nothing is compared with it",
                    name(file),
                    counted(nodes.nodes.len(), "position"),
                    counted(measured.receivers(), "receiver")
                )),
            });
        }
        let file = given.map_or(file, |(path, _)| path);
        if is_mat(file) {
            let all = read_mat_transmitters(file).map_err(Failure::unusable)?.unwrap_or_default().positions();
            truth.transmitters = if all.len() == measured.transmitters() { all } else { Vec::new() };
        }
        Ok(truth)
    }

    /// The positions in the order of the receivers: by name, or by order where one side has no
    /// names.
    fn place(&mut self, path: &Path, nodes: &Nodes, measured: &Pseudoranges) -> Result<Positions<D>, Failure> {
        let receivers = measured.receiver_names();
        let unusable = |problem: String| Err(Failure::in_file(path, problem));
        let unknown = nodes.unknown(receivers);
        let matched = nodes.names_any(receivers);
        let is_named = nodes.is_named();
        if is_named && !matched && measured.receivers_named() {
            return unusable(format!(
                "no receiver is named {}; the receivers are {}: use their names, or leave out the names (lines {}) to give the \
                 positions in the order of the receivers",
                quoted(&unknown),
                some(receivers),
                axes::<D>()
            ));
        }
        let Some(found) = nodes.in_order(receivers) else {
            return unusable(format!(
                "has {} for {}, and no name in common; give one line id,{} for each receiver, in order \
                 or with its name",
                counted(nodes.nodes.len(), "position"),
                counted(measured.receivers(), "receiver"),
                axes::<D>()
            ));
        };
        if found.iter().flatten().count() < 2 {
            return unusable(format!(
                "fewer than two receivers are known by name: no receiver is named {}; the receivers are {}",
                quoted(&unknown),
                some(receivers)
            ));
        }
        let file = name(path);
        if matched && !unknown.is_empty() {
            self.notes.push(format!("{file}: no receiver is named {}: left out of the comparison", quoted(&unknown)));
        }
        let by_order = "its positions were taken in the order of the receivers";
        if is_named && !matched {
            self.warnings.push(format!("{file}: no name in common with the receivers, so that {by_order}"));
        } else if !is_named {
            self.notes.push(format!("{file}: has no names, so that {by_order}"));
        }
        self.notes.extend(heights::<D>(path, nodes));
        Ok(found)
    }
}

/// Known positions: exact ones in the order of the receivers, and those with a standard deviation, without some
/// coordinate, or of transmitters.
type Anchors<const D: usize> = (Positions<D>, Vec<MeasuredPosition<D>>);

/// Refuses known positions of which the plane leaves much out, or that have no third coordinate for space.
pub(crate) fn fit_dimension<const D: usize>(path: &Path, nodes: &Nodes) -> Result<(), Failure> {
    if let Some([low, high]) = nodes.height_range().filter(|_| D == 2)
        && high - low > FLAT * extent(nodes)
    {
        return Err(Failure::in_file(
            path,
            format!(
                "the heights (z) of the anchors differ by {}, but the calibration is in a plane; give anchors at one height, leave out \
                 the column z if the differences do not matter, or calibrate in space (--dimensions 3)",
                length(high - low)
            ),
        ));
    }
    if D == 3 && nodes.nodes.iter().all(|node| node.position[2].is_none()) {
        return Err(Failure::in_file(path, "has no z, which anchors in space need; add a column z"));
    }
    Ok(())
}

/// Known positions in a file. Where it has a column sigma, or std_x and std_y, each has standard
/// deviations, 0 for an exact one. A name that receivers and transmitters have is that of the receiver; one that no
/// node has is more likely a mistake than meant.
pub(crate) fn anchors<const D: usize>(
    path: &Path,
    nodes: &Nodes,
    measured: &Pseudoranges,
) -> Result<Anchors<D>, Failure> {
    let receivers = measured.receiver_names();
    if !nodes.is_named() {
        return Err(Failure::in_file(path, format!("names no nodes; expected lines name,{}", axes::<D>())));
    }
    let mut unknown = nodes.unknown(receivers);
    unknown.retain(|name| !measured.transmitter_names().iter().any(|other| other == name));
    if !unknown.is_empty() {
        return Err(Failure::in_file(
            path,
            format!(
                "no receiver or transmitter is named {}; the receivers are {}, the transmitters {}",
                quoted(&unknown),
                some(receivers),
                some(measured.transmitter_names())
            ),
        ));
    }
    let (mut exact, mut deviating) = (vec![None; receivers.len()], Vec::new());
    let of_receivers = receivers.iter().enumerate().map(|(i, name)| (Node::Receiver(i), name));
    let is_receiver = |name: &String| receivers.contains(name);
    let of_transmitters = measured.transmitter_names().iter().enumerate().filter(|(_, name)| !is_receiver(name));
    let all = of_receivers.chain(of_transmitters.map(|(j, name)| (Node::Transmitter(j), name)));
    for (place, name) in all {
        let Some(node) = nodes.named(name) else { continue };
        let (mut position, mut sigma) = ([None; D], [0.0; D]);
        position.copy_from_slice(&node.position[..D]);
        // Without standard deviations all positions are exact.
        if nodes.has_sigmas {
            sigma.copy_from_slice(&node.sigma[..D]);
        }
        if position.iter().all(Option::is_none) {
            return Err(Failure::in_file(
                path,
                format!("{name} has neither x nor y; give one of them, or leave it out"),
            ));
        }
        let is_missing = |k: usize| position[k].is_some() && (sigma[k].is_nan() || sigma[k] < 0.0);
        if (0..D).any(is_missing) {
            return Err(Failure::in_file(
                path,
                format!(
                    "the standard deviation of {name} is missing or negative; give one in metres, 0 for an exact position"
                ),
            ));
        }
        match (node.whole().filter(|_| sigma == [0.0; D]), place) {
            (Some(whole), Node::Receiver(i)) => exact[i] = Some(whole),
            _ => {
                for (sigma, position) in sigma.iter_mut().zip(position) {
                    // A coordinate that is not known has no deviation.
                    *sigma = if position.is_some() { *sigma } else { 0.0 };
                }
                deviating.push(MeasuredPosition { node: place, position, sigma });
            }
        }
    }
    Ok((exact, deviating))
}

/// The columns of a position.
fn axes<const D: usize>() -> &'static str {
    if D == 2 { "x,y" } else { "x,y,z" }
}

/// Warns that heights are left out of the plane, where there are any.
pub(crate) fn heights<const D: usize>(path: &Path, nodes: &Nodes) -> Option<String> {
    let [low, high] = nodes.height_range().filter(|range| D == 2 && *range != [0.0; 2])?;
    let range = if low == high { length(low) } else { format!("{} to {}", length(low), length(high)) };
    let flat = high - low <= FLAT * extent(nodes);
    let advice = if flat { "" } else { "; receivers at such different heights form no plane" };
    Some(format!("{}: the heights (z, {range}) are left out: the network is taken to be a plane{advice}", name(path)))
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
