//! An order of rows in which pivots are as large at many points as others would be.
//!
//! Jacobians of systems as people write them often have zeros on the diagonal: the second equation may know
//! nothing of the second unknown. At solutions, moreover, leading minors may vanish that vanish nowhere else. Where
//! rows are not exchanged lane by lane, every path would break off there. Exchanges that serve some solutions of a
//! generic member of a family serve the others too, and those of other members: where a minor is not zero at one
//! solution, it is zero at few.

use num_complex::Complex64;
use poly::Evaluate;
use poly::simd::Isa;

/// Rows to exchange, one pair after the other, before Jacobians are factored in order.
pub(crate) type RowExchanges = Vec<[usize; 2]>;

/// Most solutions of a fibre at which Jacobians are looked at; one might lie close to a zero of a minor.
const SAMPLES: usize = 16;
/// Share of the largest candidate from which on the diagonal is kept, as for lanes.
const KEPT: f64 = super::lu::THRESHOLD;

/// The exchanges for a square system from solutions (`n` coordinates each, one after the other) for the
/// parameters `p`.
pub(crate) fn exchanges_at<E: Evaluate>(system: &E, p: &[Complex64], solutions: &[Complex64]) -> RowExchanges {
    let n = system.variables();
    let mut memory = system.memory(Isa::Portable);
    let mut values = vec![Complex64::default(); n];
    let jacobian = |x: &[Complex64]| {
        let mut jacobian = vec![Complex64::default(); n * n];
        system.jacobian(&mut memory, x, p, &mut values, &mut jacobian);
        jacobian
    };
    let jacobians: Vec<Vec<Complex64>> = solutions.chunks_exact(n.max(1)).take(SAMPLES).map(jacobian).collect();
    exchanges(n, jacobians)
}

/// Eliminates in all matrices at once, with the pivots that are best where they are worst.
fn exchanges(n: usize, mut matrices: Vec<Vec<Complex64>>) -> RowExchanges {
    // Singular and infinite ones tell nothing.
    matrices.retain(|a| a.iter().all(|z| z.is_finite()));
    for a in &mut matrices {
        for i in 0..n {
            let largest = (0..n).map(|j| a[j * n + i].norm()).fold(0.0, f64::max);
            (0..n).filter(|_| largest > 0.0).for_each(|j| a[j * n + i] /= largest);
        }
    }
    let mut found = RowExchanges::new();
    for k in 0..n {
        let measure = |i: usize| matrices.iter().map(|a| a[k * n + i].norm()).fold(f64::INFINITY, f64::min);
        let best =
            (k..n).map(|i| (measure(i), i)).fold((0.0, k), |best, next| if next.0 > best.0 { next } else { best });
        if measure(k) < KEPT * best.0 {
            found.push([k, best.1]);
            matrices.iter_mut().for_each(|a| (0..n).for_each(|j| a.swap(j * n + k, j * n + best.1)));
        }
        for a in &mut matrices {
            for i in k + 1..n {
                let factor = a[k * n + i] / a[k * n + k];
                for j in k + 1..n {
                    let top = a[j * n + k];
                    a[j * n + i] -= factor * top;
                }
            }
        }
        matrices.retain(|a| a.iter().all(|z| z.is_finite()));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{exchanges, exchanges_at};
    use num_complex::Complex64;

    fn matrix<const N: usize>(rows: [[f64; N]; N]) -> Vec<Complex64> {
        (0..N * N).map(|e| Complex64::from(rows[e % N][e / N])).collect()
    }

    #[test]
    fn zeros_leave_the_diagonal_and_what_serves_stays() {
        let cycle = matrix([[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [3.0, 0.0, 0.0]]);
        assert_eq!(exchanges(3, vec![cycle]), [[0, 2], [1, 2]]);
        // A fifth of the largest entry is enough.
        assert_eq!(exchanges(2, vec![matrix([[0.2, 1.0], [1.0, 1.0]])]), [[0usize; 2]; 0]);
    }

    #[test]
    fn rows_serve_the_worst_of_all_points() {
        // The first row would do at two points, the second only at one; the third does at both.
        let a = matrix([[1.0, 0.0, 1.0], [1.0, 1.0, 0.0], [0.5, 1.0, 1.0]]);
        let b = matrix([[1e-9, 0.0, 1.0], [1e-9, 1.0, 0.0], [0.5, 1.0, 1.0]]);
        assert_eq!(exchanges(3, vec![a, b])[0], [0, 2]);
    }

    /// The first equation is `(x + y + 3) (y^2 - a)`. Its derivative by `x` vanishes at solutions with `y^2 = a`, and
    /// nowhere else.
    #[test]
    fn minors_that_vanish_at_solutions_alone_are_seen_there() {
        let text = "name = 'n'\nunknowns = ['x', 'y']\nparameters = ['a']\n\
                    equations = ['x*(y^2 - a) + 3*y^2 - 3*a + y*(y^2 - a)', 'x + y^2 - 2*a']";
        let program = poly::parse::family(text).unwrap().system.compile().unwrap();
        let elsewhere = [3.0, 5.0].map(Complex64::from);
        assert_eq!(exchanges_at(&program, &[Complex64::from(4.0)], &elsewhere), [[0usize; 2]; 0]);
        // At a = 4 the points (4, 2) and (4, -2): the first equation has the factor y^2 - a.
        let solutions = [4.0, 2.0, 4.0, -2.0].map(Complex64::from);
        assert_eq!(exchanges_at(&program, &[Complex64::from(4.0)], &solutions), [[0, 1]]);
    }
}
