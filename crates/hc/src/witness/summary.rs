//! A decomposition in words.

use super::decompose::Decomposition;
use crate::solve::coordinates;
use poly::counted;
use std::collections::BTreeMap;
use std::fmt;

/// Points of each component, and isolated solutions, that a summary shows.
const LISTED: usize = 10;

/// A line for each component, with its witness points below, the isolated solutions, and what is left undone.
impl fmt::Display for Decomposition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let isolated = counted(self.isolated.len(), "isolated solution");
        writeln!(f, "{} of positive dimension, {isolated}", counted(self.components.len(), "component"))?;
        for component in &self.components {
            write!(f, "  dimension {}, degree {}", component.dimension, component.degree)?;
            if component.multiplicity > 1 {
                write!(f, ", multiplicity {}", component.multiplicity)?;
            }
            writeln!(f, "{}", if component.irreducible { "" } else { ", perhaps several together" })?;
            let points = component.witness_points.iter().map(|point| coordinates(&self.variables, point));
            list(f, points, "witness point")?;
        }
        if !self.isolated.is_empty() {
            writeln!(f, "  isolated")?;
            list(f, self.isolated.iter().map(|solution| solution.row(&self.variables)), "isolated solution")?;
        }
        for dimension in &self.unsearched {
            writeln!(
                f,
                "dimension {dimension} was not searched: that takes more paths than are left of the allowed ones"
            )?;
        }
        let mut reasons: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for end in &self.unresolved {
            let (ends, paths) = reasons.entry(&end.reason).or_default();
            (*ends, *paths) = (*ends + 1, *paths + end.paths);
        }
        for (reason, (ends, paths)) in reasons {
            writeln!(f, "unresolved: {} of {}: {reason}", counted(ends, "end"), counted(paths, "path"))?;
        }
        Ok(())
    }
}

/// The first of some rows, and how many more there are.
fn list(f: &mut fmt::Formatter<'_>, rows: impl ExactSizeIterator<Item = String>, noun: &str) -> fmt::Result {
    let more = rows.len().saturating_sub(LISTED);
    for row in rows.take(LISTED) {
        writeln!(f, "    {row}")?;
    }
    if more == 0 {
        return Ok(());
    }
    writeln!(f, "    and {} (the JSON has all)", counted(more, &format!("more {noun}")))
}
