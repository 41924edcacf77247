//! What the data cannot determine, reported before anything is solved.

use hc::poly::{counted, one_or};
use thiserror::Error;

use crate::clocks::Emissions;
use crate::duplicates::{Copied, Copies, constant_difference, counted_once, printed};
use crate::pseudoranges::Pseudoranges;

/// Unknown numbers of a transmitter: its position, and its offset unless measurements are ranges, or all offsets are one.
pub(crate) fn of_transmitter<const D: usize>(emissions: Emissions) -> usize {
    if emissions == Emissions::Unknown { D + 1 } else { D }
}

/// Unknown numbers of m receivers and n transmitters up to a rigid motion: dm + (d + 1)n - d(d + 1)/2; of ranges n less,
/// and one more with a constant.
pub(crate) fn unknowns<const D: usize>(receivers: usize, transmitters: usize, emissions: Emissions) -> usize {
    let shared = usize::from(emissions == Emissions::Constant);
    (D * receivers + of_transmitter::<D>(emissions) * transmitters).saturating_sub(D * (D + 1) / 2) + shared
}

/// A transmitter with an offset needs this many measurements to be kept: as many as its position and offset have
/// numbers, and one to fix which of two solutions is meant.
pub(crate) const fn least_per_transmitter<const D: usize>() -> usize {
    D + 2
}

/// Fewest measurements of a receiver, whose position alone is unknown.
const fn least_per_receiver<const D: usize>() -> usize {
    D + 1
}

/// Receivers at most: the normal equations are dense in their coordinates.
const MAX_RECEIVERS: usize = 2_000;

/// What is known of offsets if nothing else is unknown of clocks. A constant beside clocks of recorders counts as
/// offsets: it is one of about as many unknowns.
pub(crate) fn emissions_alone(measured: &Pseudoranges) -> Emissions {
    match measured.emissions() {
        Emissions::Constant if measured.unknown_clocks().is_some() => Emissions::Unknown,
        emissions => emissions,
    }
}

/// Number of equations minus number of [`unknowns`] of m receivers and n transmitters, all measured.
pub(crate) fn excess<const D: usize>(receivers: usize, transmitters: usize, emissions: Emissions) -> i64 {
    receivers as i64 * transmitters as i64 - unknowns::<D>(receivers, transmitters, emissions) as i64
}

/// Whether a complete matrix of this size has finitely many solutions: receivers that determine a
/// transmitter with one to spare, transmitters that determine a receiver likewise, and no more
/// unknowns than equations.
pub(crate) fn is_solvable<const D: usize>(receivers: usize, transmitters: usize, emissions: Emissions) -> bool {
    receivers > of_transmitter::<D>(emissions)
        && transmitters > D
        && excess::<D>(receivers, transmitters, emissions) >= 0
}

/// The smallest solvable sizes, fewest transmitters first, in words. A matrix is solvable if it holds
/// one of them.
fn smallest<const D: usize>(emissions: Emissions) -> String {
    let most = (D + 1) * (D + 2);
    let sizes = (D + 1..=most).flat_map(|n| (D + 1..=most).map(move |m| (m, n)));
    let is_solvable = |m: usize, n: usize| is_solvable::<D>(m, n, emissions);
    let is_smallest = |&(m, n): &(usize, usize)| is_solvable(m, n) && !is_solvable(m - 1, n) && !is_solvable(m, n - 1);
    let all: Vec<(usize, usize)> = sizes.filter(is_smallest).collect();
    let name = |(k, (m, n)): (usize, &(usize, usize))| match k {
        0 => format!("{m} receivers and {n} transmitters"),
        _ if k + 1 == all.len() => format!("or {m} and {n}"),
        _ => format!("{m} and {n}"),
    };
    all.iter().enumerate().map(name).collect::<Vec<_>>().join(", ")
}

/// Why measurements cannot determine a network.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Degeneracy {
    /// All cells are empty.
    #[error("nothing was measured; missing: {}", counted(*.0, "cell"))]
    NothingMeasured(usize),
    /// There are so many receivers that the matrix of their coordinates would fill the memory.
    #[error(
        "{receivers} receivers are more than the {MAX_RECEIVERS} that can be calibrated at once; calibrate them in groups that share some"
    )]
    TooManyReceivers {
        /// Number of receivers.
        receivers: usize,
    },
    /// Too few nodes.
    #[error(
        "{} and {} cannot be calibrated{left}: the smallest solvable sizes {} are {smallest}; add {remedy}",
        counted(*.receivers, "receiver"),
        counted(*.transmitters, "transmitter"),
        space(*.dimensions)
    )]
    TooSmall {
        /// 2 in the plane, 3 in space.
        dimensions: usize,
        /// Number of usable receivers.
        receivers: usize,
        /// Number of usable transmitters.
        transmitters: usize,
        /// Which nodes were left out, or empty.
        left: String,
        /// The smallest solvable sizes.
        smallest: String,
        /// The remedy.
        remedy: String,
    },
    /// More unknowns than measurements.
    #[error(
        "{} of {} and {} cannot determine {}{left}; measure at least {missing} of the missing cells, or add nodes",
        counted(*.measurements, "measurement"),
        counted(*.receivers, "receiver"),
        counted(*.transmitters, "transmitter"),
        counted(*.unknowns, "unknown")
    )]
    TooFew {
        /// Number of usable receivers.
        receivers: usize,
        /// Number of usable transmitters.
        transmitters: usize,
        /// Number of measured cells among them.
        measurements: usize,
        /// Number of unknowns.
        unknowns: usize,
        /// How many more measurements are needed.
        missing: usize,
        /// Which nodes were left out, or empty.
        left: String,
    },
    /// Two receivers whose measurements differ by a constant.
    #[error(
        "receivers {first} and {second} measure the same up to a constant ({constant}): they stand in the same place or \
         one is a copy of the other, which determines nothing; remove one of them"
    )]
    IdenticalReceivers {
        /// Name of the one.
        first: String,
        /// Name of the other.
        second: String,
        /// The constant, with its unit.
        constant: String,
    },
}

/// The part of the measurements that can be calibrated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Usable {
    /// Receivers kept.
    pub(crate) receivers: Vec<usize>,
    /// Transmitters kept.
    pub(crate) transmitters: Vec<usize>,
    /// What was left out and why, with names and a remedy.
    pub(crate) warnings: Vec<String>,
}

/// Leaves out what too few measurements tie down and checks that the rest can be determined.
///
/// # Errors
/// When nothing solvable is left, or receivers coincide.
pub(crate) fn usable<const D: usize>(measured: &Pseudoranges) -> Result<Usable, Degeneracy> {
    if measured.observed() == 0 {
        return Err(Degeneracy::NothingMeasured(measured.receivers() * measured.transmitters()));
    }
    let (m, n) = (measured.receivers(), measured.transmitters());
    if m > MAX_RECEIVERS {
        return Err(Degeneracy::TooManyReceivers { receivers: m });
    }
    let emissions = emissions_alone(measured);
    if !is_solvable::<D>(m, n, emissions) {
        return Err(too_small::<D>(m, n, emissions, String::new()));
    }
    let mut kept = Kept { measured, receivers: vec![true; m], transmitters: vec![true; n] };
    let mut warnings = Vec::new();
    kept.drop_sparse(of_transmitter::<D>(emissions) + 1, least_per_receiver::<D>());
    let dropped = kept.names(false);
    if !dropped.is_empty() {
        warnings.push(format!(
            "left out for too few measurements: {dropped}; a transmitter needs at least {} receivers \
             that hear it, a receiver {} transmitters",
            of_transmitter::<D>(emissions) + 1,
            least_per_receiver::<D>()
        ));
    }
    if let Some(rest) = kept.largest_component() {
        warnings.push(format!(
            "the measurements fall into parts that share no node; only the largest is calibrated, without {rest}; \
             measure between the parts"
        ));
    }
    let left = kept.names(false);
    let left = if left.is_empty() { String::new() } else { format!(" (left out: {left})") };
    let index = |flags: &[bool]| -> Vec<usize> { (0..flags.len()).filter(|&k| flags[k]).collect() };
    let (receivers, transmitters) = (index(&kept.receivers), index(&kept.transmitters));
    if let Some((a, b, constant)) = identical_receivers(measured, &receivers, &transmitters) {
        return Err(Degeneracy::IdenticalReceivers {
            first: measured.receiver_names()[a].clone(),
            second: measured.receiver_names()[b].clone(),
            constant: crate::quantity::length(constant),
        });
    }
    let transmitters = without_copies(measured, &receivers, transmitters, &mut warnings);
    let distinct = transmitters.len() - repeated_transmitters(measured, &receivers, &transmitters);
    if !is_solvable::<D>(receivers.len(), distinct, emissions) {
        return Err(too_small::<D>(receivers.len(), distinct, emissions, left));
    }
    let measurements = measured.select(&receivers, &transmitters).observed();
    let unknowns = unknowns::<D>(receivers.len(), transmitters.len(), emissions);
    if measurements < unknowns {
        return Err(Degeneracy::TooFew {
            receivers: receivers.len(),
            transmitters: transmitters.len(),
            measurements,
            unknowns,
            missing: unknowns - measurements,
            left,
        });
    }
    Ok(Usable { receivers, transmitters, warnings })
}

/// Leaves out transmitters that are copies of another, such as those of a tag that stands still and repeats
/// itself. Warns of these, and of two that may be.
fn without_copies(
    measured: &Pseudoranges,
    receivers: &[usize],
    transmitters: Vec<usize>,
    warnings: &mut Vec<String>,
) -> Vec<usize> {
    let name = |j: usize| &measured.transmitter_names()[j];
    let Copies { kept, copies, doubtful } = counted_once(measured, receivers, transmitters);
    if let Some(Copied { first, second, constant, .. }) = doubtful {
        let (first, second, constant) = (name(first), name(second), crate::quantity::length(constant));
        warnings.push(format!(
            "transmitters {first} and {second} measure the same up to a constant ({constant}): they stand in one place, or one is a copy of \
             the other, which counts twice; if it is a copy, remove it"
        ));
    }
    if !copies.is_empty() {
        let copies: Vec<String> =
            copies.iter().map(|(first, copy)| format!("{} as {}", name(*copy), name(*first))).collect();
        warnings.push(format!(
            "transmitters that measure the same as another up to a constant, such as a tag that stands still and repeats itself, count \
             once: left out are {}",
            list(&copies)
        ));
    }
    kept
}

/// Where networks of so many dimensions lie, in words that follow a noun.
pub(crate) fn space(dimensions: usize) -> &'static str {
    if dimensions == 2 { "in the plane" } else { "in space" }
}

fn too_small<const D: usize>(receivers: usize, transmitters: usize, emissions: Emissions, left: String) -> Degeneracy {
    let remedy = remedy::<D>(receivers, transmitters, emissions);
    Degeneracy::TooSmall { dimensions: D, receivers, transmitters, left, smallest: smallest::<D>(emissions), remedy }
}

/// The fewest nodes to add, receivers or transmitters, in words.
fn remedy<const D: usize>(receivers: usize, transmitters: usize, emissions: Emissions) -> String {
    let most = D * (D + 1);
    let more_receivers = (0..=most).find(|k| is_solvable::<D>(receivers + k, transmitters, emissions));
    let more_transmitters = (0..=most).find(|k| is_solvable::<D>(receivers, transmitters + k, emissions));
    let count = |k: usize, what: &str| format!("{k} {what}{}", if k == 1 { "" } else { "s" });
    match (more_receivers, more_transmitters) {
        (Some(a), Some(b)) => format!("{} or {}", count(a, "receiver"), count(b, "transmitter")),
        (Some(a), None) => count(a, "receiver"),
        (None, Some(b)) => count(b, "transmitter"),
        (None, None) => "receivers and transmitters".to_string(),
    }
}

struct Kept<'a> {
    measured: &'a Pseudoranges,
    receivers: Vec<bool>,
    transmitters: Vec<bool>,
}

impl Kept<'_> {
    fn links(&self, i: usize, j: usize) -> bool {
        self.receivers[i] && self.transmitters[j] && self.measured.get(i, j).is_some()
    }

    /// Leaves out nodes with fewer measurements than these.
    fn drop_sparse(&mut self, per_transmitter: usize, per_receiver: usize) {
        let (m, n) = (self.receivers.len(), self.transmitters.len());
        loop {
            let mut dropped = false;
            for j in 0..n {
                if self.transmitters[j] && (0..m).filter(|&i| self.links(i, j)).count() < per_transmitter {
                    self.transmitters[j] = false;
                    dropped = true;
                }
            }
            for i in 0..m {
                if self.receivers[i] && (0..n).filter(|&j| self.links(i, j)).count() < per_receiver {
                    self.receivers[i] = false;
                    dropped = true;
                }
            }
            if !dropped {
                return;
            }
        }
    }

    /// Keeps the largest connected part; the names of the others if there are any.
    fn largest_component(&mut self) -> Option<String> {
        let (m, n) = (self.receivers.len(), self.transmitters.len());
        let mut part = vec![usize::MAX; m];
        let mut sizes = Vec::new();
        for start in 0..m {
            if !self.receivers[start] || part[start] != usize::MAX {
                continue;
            }
            let label = sizes.len();
            part[start] = label;
            let mut stack = vec![start];
            let mut heard = vec![false; n];
            let mut size = 0;
            while let Some(i) = stack.pop() {
                size += 1;
                for j in (0..n).filter(|&j| self.links(i, j)) {
                    if !std::mem::replace(&mut heard[j], true) {
                        for k in (0..m).filter(|&k| self.links(k, j)) {
                            if part[k] == usize::MAX {
                                part[k] = label;
                                stack.push(k);
                            }
                        }
                    }
                }
            }
            sizes.push(size + heard.iter().filter(|&&h| h).count());
        }
        if sizes.len() < 2 {
            return None;
        }
        let largest = (0..sizes.len()).max_by_key(|&k| (sizes[k], usize::MAX - k))?;
        let before = (self.receivers.clone(), self.transmitters.clone());
        for j in 0..n {
            self.transmitters[j] &= (0..m).any(|i| part[i] == largest && self.measured.get(i, j).is_some());
        }
        for i in 0..m {
            self.receivers[i] &= part[i] == largest;
        }
        let gone = |before: &[bool], now: &[bool], names: &[String]| -> Vec<String> {
            (0..now.len()).filter(|&k| before[k] && !now[k]).map(|k| names[k].clone()).collect()
        };
        let receivers = gone(&before.0, &self.receivers, self.measured.receiver_names());
        let transmitters = gone(&before.1, &self.transmitters, self.measured.transmitter_names());
        Some(nodes(&receivers, &transmitters))
    }

    fn names(&self, kept: bool) -> String {
        let pick = |flags: &[bool], names: &[String]| -> Vec<String> {
            (0..flags.len()).filter(|&k| flags[k] == kept).map(|k| names[k].clone()).collect()
        };
        let receivers = pick(&self.receivers, self.measured.receiver_names());
        nodes(&receivers, &pick(&self.transmitters, self.measured.transmitter_names()))
    }
}

/// Names in a row, at most twelve of them.
pub(crate) fn list(names: &[String]) -> String {
    if names.len() <= 12 {
        return names.join(", ");
    }
    format!("{} and {} more", names[..12].join(", "), names.len() - 12)
}

/// Names of both kinds of nodes, each kind by itself; empty if there are none.
fn nodes(receivers: &[String], transmitters: &[String]) -> String {
    let kinds = [("receiver", receivers), ("transmitter", transmitters)];
    let named = kinds
        .iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(kind, names)| format!("{kind}{} {}", one_or(names.len(), "", "s"), list(names)));
    named.collect::<Vec<_>>().join(", and ")
}

/// Two receivers whose rows differ by a constant to rounding, over at least three common
/// transmitters.
fn identical_receivers(
    measured: &Pseudoranges,
    receivers: &[usize],
    transmitters: &[usize],
) -> Option<(usize, usize, f64)> {
    for (k, &a) in receivers.iter().enumerate() {
        let heard: Vec<(usize, f64)> = transmitters.iter().filter_map(|&j| Some((j, measured.get(a, j)?))).collect();
        for &b in &receivers[k + 1..] {
            let pairs = heard.iter().filter_map(|&(j, value)| Some((value, measured.get(b, j)?)));
            if let Some(constant) = constant_difference(pairs.clone(), printed(pairs)) {
                return Some((a, b, constant));
            }
        }
    }
    None
}

/// How many transmitters repeat the column of an earlier one up to a constant (same place, another
/// time): they are no new information.
fn repeated_transmitters(measured: &Pseudoranges, receivers: &[usize], transmitters: &[usize]) -> usize {
    // Only small networks can fail for it, and comparing all pairs of many is slow.
    if transmitters.len() > 64 {
        return 0;
    }
    let repeats = |k: usize| {
        transmitters[..k].iter().any(|&a| {
            let b = transmitters[k];
            let pairs = receivers.iter().filter_map(|&i| Some((measured.get(i, a)?, measured.get(i, b)?)));
            constant_difference(pairs.clone(), printed(pairs)).is_some()
        })
    };
    (0..transmitters.len()).filter(|&k| repeats(k)).count()
}

#[cfg(test)]
mod tests;
