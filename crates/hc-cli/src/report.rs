//! What `hc solve` and `hc track` write: JSON, and a summary of one screen at most.

use hc::solve::{Solved, Start};
use serde::Serialize;
use std::collections::BTreeMap;

/// Solutions that a summary shows.
const LISTED: usize = 20;

/// The JSON of one system.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    variables: &'a [String],
    seed: u64,
    seconds: f64,
    #[serde(flatten)]
    found: &'a Solved,
}

impl<'a> Report<'a> {
    pub(crate) fn new(variables: &'a [String], found: &'a Solved, seed: u64, seconds: f64) -> Report<'a> {
        Report { variables, seed, seconds, found }
    }

    /// In words.
    pub(crate) fn summary(&self) -> String {
        let found = self.found;
        let paths = &found.paths;
        let real = found.solutions.iter().filter(|s| s.real).count();
        let mut text = String::new();
        if found.interrupted {
            text += "interrupted: this is a partial result\n";
        }
        text += &format!("{} isolated solutions, {real} real, {:.3} s\n", found.solutions.len(), self.seconds);
        let mut multiplicities: BTreeMap<usize, usize> = BTreeMap::new();
        let singular = found.solutions.iter().filter(|s| s.singular);
        singular.for_each(|s| *multiplicities.entry(s.multiplicity).or_default() += 1);
        for (multiplicity, count) in multiplicities {
            text += &format!("  {count} of them singular, of multiplicity {multiplicity}\n");
        }
        if found.solutions.iter().any(|s| s.certified.is_some()) {
            let certified = found.solutions.iter().filter(|s| s.certified == Some(true)).count();
            text += &format!("  {certified} of them certified\n");
        }
        let start = match found.start {
            None => String::new(),
            Some(start) => format!(" ({}{})", name(start), self.others(start)),
        };
        text += &format!(
            "{} paths{start}: {} finite, {} at infinity, {} failed, {} tracked again\n",
            paths.tracked, paths.finite, paths.at_infinity, paths.failed, paths.retracked
        );
        if found.on_components > 0 {
            text += &format!(
                "there are solution sets of positive dimension: {} paths end on them, at {} points\n",
                found.on_components,
                found.component_points.len()
            );
        }
        if found.excess > 0 {
            text += &format!(
                "{} finite ends are left out: they do not solve all equations, or lie outside the torus\n",
                found.excess
            );
        }
        if found.start_systems > 1 {
            text += &format!("{} start systems were used, since paths were lost\n", found.start_systems);
        }
        if paths.failed > 0 {
            text += &format!("the list may be incomplete: it is not known where {} paths end\n", paths.failed);
        }
        text
    }

    /// The first real solutions, a line each.
    pub(crate) fn listing(&self) -> String {
        let real: Vec<_> = self.found.solutions.iter().filter(|s| s.real).collect();
        let mut text = String::new();
        for solution in real.iter().take(LISTED) {
            let values = self.variables.iter().zip(&solution.value).map(|(name, v)| format!("{name} = {:.12}", v[0]));
            text += &format!("  {}\n", values.collect::<Vec<_>>().join(", "));
        }
        if real.len() > LISTED {
            text += &format!("  and {} real ones more\n", real.len() - LISTED);
        }
        text
    }

    /// The numbers of paths of the start systems that were not chosen, as far as they are known.
    fn others(&self, chosen: Start) -> String {
        let found = self.found;
        let all = [
            (Start::Polyhedral, found.mixed_volume),
            (Start::Multihomogeneous, found.multihomogeneous_number),
            (Start::TotalDegree, found.bezout_number),
        ];
        let others = all.into_iter().filter(|(start, _)| *start != chosen);
        let known: Vec<String> =
            others.filter_map(|(start, paths)| Some(format!("{}: {}", name(start), paths?))).collect();
        if known.is_empty() { String::new() } else { format!("; {}", known.join(", ")) }
    }

    /// Regular solutions for which certification was asked and failed.
    pub(crate) fn uncertified(&self) -> usize {
        self.found.solutions.iter().filter(|s| s.certified == Some(false) && !s.singular).count()
    }
}

fn name(start: Start) -> &'static str {
    match start {
        Start::TotalDegree => "total degree",
        Start::Multihomogeneous => "multihomogeneous",
        _ => "polyhedral",
    }
}
