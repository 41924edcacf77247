//! Directions in which paths to infinity may go.

use super::solutions::Direction;
use num_complex::Complex64;
use std::cmp::Ordering;

/// A system whose coefficients move along a straight line to the target.
pub(super) struct Line<'a> {
    /// Exponent vectors of the terms of each equation.
    pub(super) supports: &'a [Vec<Vec<i32>>],
    /// The coefficients at the end, of all equations in one row; some may be zero.
    pub(super) target: &'a [Complex64],
}

impl Line<'_> {
    /// The number of paths that cannot have ended in this direction, as they seem to: no paths go there,
    /// or they make an incomplete cycle.
    pub(super) fn impossible(&self, direction: &Direction) -> usize {
        let Direction { valuations, denominator, paths } = direction;
        if self.is_balanced(valuations, *denominator) { paths % (*denominator).max(1) } else { *paths }
    }

    /// Whether the leading terms of every equation can cancel where unknowns grow like powers
    /// `t^(valuation / winding)`: there are at least two of them. Terms whose coefficient vanishes
    /// at the end have a coefficient of first order in `t`. Unknowns of valuation zero may vanish
    /// as well, too fast to be seen, and terms with them cancel with any.
    fn is_balanced(&self, valuations: &[i64], winding: usize) -> bool {
        let mut coefficients = self.target.iter();
        self.supports.iter().all(|support| {
            let (mut least, mut cancels) = (i64::MAX, false);
            for (point, c) in support.iter().zip(&mut coefficients) {
                let order: i64 = point.iter().zip(valuations).map(|(&a, &v)| i64::from(a).saturating_mul(v)).sum();
                let order = if *c == Complex64::new(0.0, 0.0) { order.saturating_add(winding as i64) } else { order };
                let may_vanish = point.iter().zip(valuations).any(|(&a, &v)| a != 0 && v == 0);
                match order.cmp(&least) {
                    Ordering::Less => (least, cancels) = (order, may_vanish),
                    Ordering::Equal => cancels = true,
                    Ordering::Greater => {}
                }
            }
            cancels
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Line;
    use num_complex::Complex64;

    #[test]
    fn leading_terms_must_cancel() {
        // x^2 + x y + 0, x y - 1: where x falls like t, y grows like 1 / t.
        let supports = [vec![vec![2, 0], vec![1, 1], vec![0, 0]], vec![vec![1, 1], vec![0, 0]]];
        let target = [1.0, 1.0, 0.0, 1.0, -1.0].map(|c| Complex64::new(c, 0.0));
        let line = Line { supports: &supports, target: &target };
        assert!(!line.is_balanced(&[1, -1], 1) && !line.is_balanced(&[-1, -1], 1));
        // x^2 + x y is t^2 + 1, and the missing constant is of order t.
        let line = Line { supports: &supports[..1], target: &target };
        assert!(line.is_balanced(&[-1, -1], 1) && line.is_balanced(&[1, 1], 2) && !line.is_balanced(&[-1, 0], 1));
        // Beside x y, what is not seen of x may count.
        assert!(line.is_balanced(&[0, -1], 1));
    }
}
