//! Targets of a symmetric family: one solution of each orbit is tracked, and the others are its
//! images.

use super::compiled::Family;
use super::error::FamilyError;
use super::fibre::Fibre;
use super::symmetry::Symmetry;
use crate::distinct::coincidences;
use crate::solve::{Solution, Solutions};
use crate::tolerances::FAMILIES;
use num_complex::Complex64;

/// The representatives of a fibre, and how many solutions each stands for.
pub(super) struct Orbits {
    /// The representatives as a fibre of their own.
    pub(super) tracked: Fibre,
    /// The sizes of the orbits, ascending.
    sizes: Vec<usize>,
}

impl Orbits {
    /// The orbits of a fibre that notes its representatives; `None` if it does not.
    ///
    /// # Errors
    /// If a map of the family takes one of its solutions to a point that is none.
    pub(super) fn of(family: &Family, fibre: &Fibre) -> Result<Option<Orbits>, FamilyError> {
        if fibre.representatives.is_none() {
            return Ok(None);
        }
        family.check_symmetry(fibre)?;
        let tracked = fibre.tracked();
        let size = |x| family.symmetry.orbit(&fibre.parameters, x, FAMILIES.same).len();
        let mut sizes: Vec<usize> = tracked.iter().map(size).collect();
        sizes.sort_unstable();
        Ok(Some(Orbits { tracked, sizes }))
    }

    /// All solutions for a target, from those to which the representatives lead. `None` where they
    /// do not tell how many paths end where, so that all have to be tracked: where one is singular
    /// or lost (of the paths that share a singular end some are missing), where two lie in one
    /// orbit, and where an orbit is smaller than for generic parameters.
    pub(super) fn expand(
        &self,
        symmetry: &Symmetry,
        target: &[Complex64],
        tolerance: f64,
        found: &Solutions,
    ) -> Option<Vec<Solution>> {
        let lost = found.paths.failed > 0 && !found.interrupted;
        if lost || found.iter().any(|s| s.singular || s.multiplicity > 1) {
            return None;
        }
        let orbits: Vec<Vec<Vec<Complex64>>> =
            found.iter().map(|s| symmetry.orbit(target, &s.value, tolerance)).collect();
        let mut sizes: Vec<usize> = orbits.iter().map(Vec::len).collect();
        sizes.sort_unstable();
        // If all orbits have one size, the comparison can do without the paths at infinity.
        let equal = self.sizes.first() == self.sizes.last();
        let generic = if equal { sizes.iter().all(|n| self.sizes.first() == Some(n)) } else { sizes == self.sizes };
        let points = || orbits.iter().flatten().map(Vec::as_slice).enumerate();
        if !generic || !coincidences(points(), tolerance).is_empty() {
            return None;
        }
        let images = |(s, orbit): (&Solution, Vec<Vec<Complex64>>)| {
            orbit.into_iter().map(|value| Solution { value, ..s.clone() }).collect::<Vec<_>>()
        };
        Some(found.iter().zip(orbits).flat_map(images).collect())
    }
}
