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
    /// Whether a factor that the family declares nonzero vanishes at the solution `x` as far as rounding errors
    /// can tell: a change of `x` by a small share of its largest coordinate would make it vanish.
    fn degenerates(&self, p: &[Complex64], x: &[Complex64]) -> bool {
        let (factors, n) = (self.nonzero.equations(), x.len());
        let zeros = |count: usize| vec![Complex64::new(0.0, 0.0); count];
        let (mut values, mut gradients) = (zeros(factors), zeros(factors * n));
        let mut memory = self.nonzero.memory(Isa::Portable);
        self.nonzero.jacobian(&mut memory, x, p, &mut values, &mut gradients);
        let largest = x.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let slope = |factor: usize| gradients[factor * n..][..n].iter().map(|z| z.norm()).sum::<f64>();
        (0..factors).any(|k| values[k].norm() <= FAMILIES.degenerate * slope(k) * largest)
    }

    /// Drops solutions outside the family. The paths to them count as failed.
    pub(super) fn keep_own(&self, p: &[Complex64], found: &mut Solutions) {
        if self.nonzero.equations() == 0 {
            return;
        }
        let mut paths = 0;
        found.solutions.retain(|solution| {
            let degenerates = self.degenerates(p, &solution.value);
            paths += usize::from(degenerates) * solution.multiplicity;
            !degenerates
        });
        let paths = paths.min(found.paths.finite);
        found.paths.finite -= paths;
        found.paths.failed += paths;
    }
}
