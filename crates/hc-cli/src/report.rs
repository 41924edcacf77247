//! What `hc solve` and `hc track` write: JSON, and a summary of one screen at most.

use hc::fibre::PathCounts;
use hc::solve::{Direction, Solution, Solved, Start};
use serde::Serialize;
use std::collections::BTreeMap;

/// The JSON of one system.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    variables: &'a [String],
    /// Null where the paths came from a stored fibre.
    start: Option<Start>,
    mixed_volume: Option<u64>,
    bezout_number: Option<u64>,
    multihomogeneous_number: Option<u64>,
    seed: u64,
    seconds: f64,
    /// Whether the work was interrupted.
    partial: bool,
    paths: PathCounts,
    excess: usize,
    on_components: usize,
    component_points: &'a [Vec<[f64; 2]>],
    directions: &'a [Direction],
    start_systems: u32,
    solutions: &'a [Solution],
}

impl<'a> Report<'a> {
    pub(crate) fn new(variables: &'a [String], found: &'a Solved, seed: u64, seconds: f64) -> Report<'a> {
        Report {
            variables,
            start: found.start,
            mixed_volume: found.mixed_volume,
            bezout_number: found.bezout_number,
            multihomogeneous_number: found.multihomogeneous_number,
            seed,
            seconds,
            partial: found.interrupted,
            paths: found.paths,
            excess: found.excess,
            on_components: found.on_components,
            component_points: &found.component_points,
            directions: &found.directions,
            start_systems: found.start_systems,
            solutions: &found.solutions,
        }
    }

    /// In words.
    pub(crate) fn summary(&self) -> String {
        let paths = &self.paths;
        let real = self.solutions.iter().filter(|s| s.real).count();
        let mut text = String::new();
        if self.partial {
            text += "interrupted: this is a partial result\n";
        }
        text += &format!("{} isolated solutions, {real} real, {:.3} s\n", self.solutions.len(), self.seconds);
        let mut multiplicities: BTreeMap<usize, usize> = BTreeMap::new();
        let singular = self.solutions.iter().filter(|s| s.singular);
        singular.for_each(|s| *multiplicities.entry(s.multiplicity).or_default() += 1);
        for (multiplicity, count) in multiplicities {
            text += &format!("  {count} of them singular, of multiplicity {multiplicity}\n");
        }
        if self.solutions.iter().any(|s| s.certified.is_some()) {
            let certified = self.solutions.iter().filter(|s| s.certified == Some(true)).count();
            text += &format!("  {certified} of them certified\n");
        }
        let start = match self.start {
            None => String::new(),
            Some(start) => format!(" ({}{})", name(start), self.others(start)),
        };
        text += &format!(
            "{} paths{start}: {} finite, {} at infinity, {} failed, {} tracked again\n",
            paths.tracked, paths.finite, paths.at_infinity, paths.failed, paths.retracked
        );
        if self.on_components > 0 {
            text += &format!(
                "there are solution sets of positive dimension: {} paths end on them, at {} points\n",
                self.on_components,
                self.component_points.len()
            );
        }
        if self.excess > 0 {
            text += &format!(
                "{} finite ends are left out: they do not solve all equations, or lie outside the torus\n",
                self.excess
            );
        }
        if self.start_systems > 1 {
            text += &format!("{} start systems were used, since paths were lost\n", self.start_systems);
        }
        if paths.failed > 0 {
            text += &format!("the list may be incomplete: it is not known where {} paths end\n", paths.failed);
        }
        text
    }

    /// The numbers of paths of the start systems that were not chosen, as far as they are known.
    fn others(&self, chosen: Start) -> String {
        let all = [
            (Start::Polyhedral, self.mixed_volume),
            (Start::Multihomogeneous, self.multihomogeneous_number),
            (Start::TotalDegree, self.bezout_number),
        ];
        let others = all.into_iter().filter(|(start, _)| *start != chosen);
        let known: Vec<String> =
            others.filter_map(|(start, paths)| Some(format!("{}: {}", name(start), paths?))).collect();
        if known.is_empty() { String::new() } else { format!("; {}", known.join(", ")) }
    }

    /// Regular solutions for which certification was asked and failed.
    pub(crate) fn uncertified(&self) -> usize {
        self.solutions.iter().filter(|s| s.certified == Some(false) && !s.singular).count()
    }
}

fn name(start: Start) -> &'static str {
    match start {
        Start::TotalDegree => "total degree",
        Start::Multihomogeneous => "multihomogeneous",
        _ => "polyhedral",
    }
}
