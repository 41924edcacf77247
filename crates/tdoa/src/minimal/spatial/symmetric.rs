//! Complex symmetric matrices of order three, as the equations of space hold them.

use num_complex::Complex64;
use std::array::from_fn;

pub(super) type Vector = [Complex64; 3];
pub(super) type Matrix = [Vector; 3];

/// `M diag(d) M'`, `M` unit lower triangular with the entries 21, 31 and 32 below the diagonal.
#[derive(Clone, Copy)]
pub(super) struct Factored {
    pub(super) diagonal: Vector,
    pub(super) below: Vector,
}

impl Factored {
    /// The factors of a matrix; not finite where a leading minor vanishes.
    pub(super) fn new(a: &Matrix) -> Factored {
        let d1 = a[0][0];
        let [l21, l31] = [a[1][0] / d1, a[2][0] / d1];
        let d2 = a[1][1] - l21 * l21 * d1;
        let l32 = (a[2][1] - l31 * l21 * d1) / d2;
        let d3 = a[2][2] - l31 * l31 * d1 - l32 * l32 * d2;
        Factored { diagonal: [d1, d2, d3], below: [l21, l31, l32] }
    }

    /// The lower triangle `M`.
    fn triangle(&self) -> Matrix {
        let [l21, l31, l32] = self.below;
        let (zero, one) = (Complex64::ZERO, Complex64::ONE);
        [[one, zero, zero], [l21, one, zero], [l31, l32, one]]
    }

    /// The matrix.
    pub(super) fn matrix(&self) -> Matrix {
        let m = self.triangle();
        from_fn(|i| from_fn(|j| (0..3).map(|k| m[i][k] * self.diagonal[k] * m[j][k]).sum()))
    }

    /// `M' v`.
    pub(super) fn transposed_times(&self, v: &Vector) -> Vector {
        let m = self.triangle();
        from_fn(|j| (0..3).map(|i| m[i][j] * v[i]).sum())
    }

    /// `x` with `M' x = v`.
    pub(super) fn solve_transposed(&self, v: &Vector) -> Vector {
        let [l21, l31, l32] = self.below;
        let y = v[1] - l32 * v[2];
        [v[0] - l21 * y - l31 * v[2], y, v[2]]
    }
}

/// `v' A w`.
pub(super) fn form(v: &Vector, a: &Matrix, w: &Vector) -> Complex64 {
    (0..9).map(|k| v[k / 3] * a[k / 3][k % 3] * w[k % 3]).sum()
}

/// `x` with `sum_k x_k rows_k = v`; not finite where the rows depend on each other.
pub(super) fn coordinates(rows: &Matrix, v: &Vector) -> Vector {
    let cross = |a: &Vector, b: &Vector| -> Vector {
        from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
    };
    let dot = |a: &Vector, b: &Vector| (0..3).map(|k| a[k] * b[k]).sum::<Complex64>();
    let volume = dot(&rows[0], &cross(&rows[1], &rows[2]));
    from_fn(|k| dot(v, &cross(&rows[(k + 1) % 3], &rows[(k + 2) % 3])) / volume)
}

#[cfg(test)]
mod tests {
    use super::{Factored, Vector, coordinates};
    use hc::random::Random;
    use num_complex::Complex64;
    use std::array::from_fn;

    fn random(random: &mut Random) -> Vector {
        from_fn(|_| random.normal())
    }

    fn near(a: &Vector, b: &Vector) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-12 * (1.0 + b.norm()))
    }

    #[test]
    fn matrices_are_factored_and_solved() {
        let mut numbers = Random::new(1, 0);
        for _ in 0..20 {
            let v = random(&mut numbers);
            let given = Factored { diagonal: random(&mut numbers), below: random(&mut numbers) };
            let found = Factored::new(&given.matrix());
            assert!(near(&found.diagonal, &given.diagonal) && near(&found.below, &given.below));
            let again = found.matrix();
            assert!(given.matrix().iter().zip(&again).all(|(a, b)| near(a, b)));
            assert!(near(&given.transposed_times(&given.solve_transposed(&v)), &v));
            let rows = [(); 3].map(|()| random(&mut numbers));
            let x = coordinates(&rows, &v);
            let sum: Vector = from_fn(|k| (0..3).map(|row| x[row] * rows[row][k]).sum::<Complex64>());
            assert!(near(&sum, &v), "{sum:?} {v:?}");
        }
    }
}
