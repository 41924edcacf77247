//! Ends of paths outside the family: where a factor vanishes that the family declares nonzero.
//!
//! The solutions of a fibre are of the family, and so are almost all their ends. The equations may have others,
//! often components of them, to which a path can jump. It shares its end with no other path then, so that
//! nothing else shows it.

use super::compiled::Family;
use crate::solve::Solutions;
use crate::tolerances::FAMILIES;
use num_complex::Complex64;
use poly::{Evaluate, Isa};

impl Family {
    /// Drops solutions outside the family. The paths to them count as failed.
    ///
    /// A factor has vanished at a solution `x` if a change of `x` by a small share of its largest coordinate
    /// would make it vanish. Unlike [`accepts`](Self::accepts), which is for generic parameters of size one, this
    /// does not depend on the unit of the unknowns.
    pub(super) fn keep_own(&self, p: &[Complex64], found: &mut Solutions) {
        let (factors, n) = (self.nonzero.equations(), self.nonzero.variables());
        if factors == 0 {
            return;
        }
        let zeros = |count: usize| vec![Complex64::new(0.0, 0.0); count];
        let (mut values, mut gradients) = (zeros(factors), zeros(factors * n));
        let mut memory = self.nonzero.memory(Isa::Portable);
        let mut paths = 0;
        found.solutions.retain(|solution| {
            let x = &solution.value;
            self.nonzero.jacobian(&mut memory, x, p, &mut values, &mut gradients);
            let largest = x.iter().map(|z| z.norm()).fold(0.0, f64::max);
            let slopes = gradients.chunks(n).map(|row| row.iter().map(|z| z.norm()).sum::<f64>());
            let degenerates =
                values.iter().zip(slopes).any(|(value, slope)| value.norm() <= FAMILIES.degenerate * slope * largest);
            paths += usize::from(degenerates) * solution.multiplicity;
            !degenerates
        });
        let paths = paths.min(found.paths.finite);
        found.paths.finite -= paths;
        found.paths.failed += paths;
    }
}
