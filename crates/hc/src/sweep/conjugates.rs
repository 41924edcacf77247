//! Which solutions of a member with real coefficients are real: those that are their own conjugates.

use crate::distinct::is_real;
use crate::tolerances::{ends, sweeps};
use num_complex::Complex64;

/// Of each of all solutions for real parameters, whether it is real; `Err` has the number of those of which this is not
/// clear.
///
/// The conjugate of a solution is a solution too. Where exactly one of the list is near the conjugate, it is this one.
pub(super) fn reality(points: &[&[Complex64]]) -> Result<Vec<bool>, usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let key = |k: usize| points[k].first().map_or(0.0, |z| z.re);
    order.sort_unstable_by(|&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
    let size = |x: &[Complex64]| x.iter().map(|z| z.norm()).fold(0.0, f64::max);
    // Coordinates of a solution that is zero are rounding errors on the scale of the others, or of one.
    let least = points.iter().map(|x| size(x)).fold(0.0, f64::max).min(1.0);
    let mut real = vec![false; points.len()];
    let mut unclear = 0;
    for (k, x) in points.iter().enumerate() {
        let reach = sweeps::NEAR * size(x).max(least);
        let first = order.partition_point(|&j| key(j) < key(k) - reach);
        let near = order[first..].iter().take_while(|&&j| key(j) <= key(k) + reach);
        let mut near = near.filter(|&&j| is_near_conjugate(x, points[j], reach));
        match (near.next(), near.next()) {
            (Some(&j), None) if j != k => {}
            (Some(_), None) if is_real(x, ends::REAL) => real[k] = true,
            _ => unclear += 1,
        }
    }
    if unclear == 0 { Ok(real) } else { Err(unclear) }
}

/// Whether no coordinate of `b` is farther than `reach` from the conjugate of that of `a`.
fn is_near_conjugate(a: &[Complex64], b: &[Complex64], reach: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a.conj() - b).norm() <= reach)
}

#[cfg(test)]
mod tests {
    use super::reality;
    use num_complex::Complex64;

    fn of(points: &[[(f64, f64); 2]]) -> Result<Vec<bool>, usize> {
        let points: Vec<Vec<Complex64>> =
            points.iter().map(|x| x.iter().map(|&(re, im)| Complex64::new(re, im)).collect()).collect();
        reality(&points.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn solutions_are_real_or_have_a_conjugate() {
        let found = of(&[
            [(1.0, 0.0), (2.0, 1e-15)],
            [(1.0, 1.0), (2.0, 0.0)],
            [(1.0, -1.0), (2.0, 0.0)],
            [(0.0, 1e-30), (1e-29, 0.0)],
            [(1.0, 0.0), (3.0, 0.0)],
        ]);
        assert_eq!(found, Ok(vec![true, false, false, true, true]));
        assert_eq!(of(&[]), Ok(vec![]));
    }

    /// A solution whose conjugate is missing, a pair that two real solutions could be, and a point that is nearly real.
    #[test]
    fn what_is_not_clear_is_counted() {
        assert_eq!(of(&[[(1.0, 1.0), (2.0, 0.0)], [(5.0, 0.0), (0.0, 0.0)]]), Err(1));
        assert_eq!(of(&[[(1.0, 1e-9), (2.0, 0.0)], [(1.0, -1e-9), (2.0, 0.0)]]), Err(2));
        assert_eq!(of(&[[(1.0, 0.0), (2.0, 0.0)], [(1.0 + 1e-9, 0.0), (2.0, 0.0)]]), Err(2));
        assert_eq!(of(&[[(1.0, 1e-8), (2.0, 0.0)]]), Err(1));
    }
}
