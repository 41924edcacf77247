//! Ranges with one unknown constant `c`, doubly centred: `(f_ij - c)^2` gives a matrix that is linear in `c`.

use faer::Mat;
use faer::linalg::solvers::Solve;
use num_complex::Complex64;

/// Nodes span no plane or space if a singular value is less than this share of the largest one.
pub(super) const DEGENERATE: f64 = 1e-12;
/// Newton steps to where a singular value vanishes, at most; it converges quadratically.
const STEPS: usize = 8;

/// A constant is real if its imaginary part is less than this share of its size, as of one that two have become.
const NEARLY_REAL: f64 = 1e-7;

/// The matrix `A - c B` of the products `(r_i - r_1) . (s_j - s_1)`, whose rank is that of the nodes if `c` is the constant.
pub(super) struct Pencil {
    a: Mat<f64>,
    b: Mat<f64>,
}

impl Pencil {
    /// That of ranges in rows of `n`.
    pub(super) fn new(matrix: &[f64], n: usize) -> Pencil {
        // (f - c)^2 = f^2 - 2 c f + c^2, and centring takes c^2 away.
        Pencil {
            a: centred(matrix.len() / n, n, |k| matrix[k] * matrix[k]),
            b: centred(matrix.len() / n, n, |k| 2.0 * matrix[k]),
        }
    }

    fn at(&self, c: f64) -> Mat<f64> {
        &self.a - c * &self.b
    }

    /// How well nodes span D dimensions at the worst of the constants up to `most`: the D-th singular value as a share of the
    /// first; zero if they do not, as far as doubles tell.
    pub(super) fn span<const D: usize>(&self, most: f64) -> f64 {
        // Where the rank falls, that of any D combinations of rows and of columns does.
        let (rows, columns) = (self.a.nrows(), self.a.ncols());
        let left = Mat::from_fn(D, rows, mixing);
        let right = Mat::from_fn(columns, D, |k, j| mixing(D + j, k));
        let part = Pencil { a: &left * &self.a * &right, b: &left * &self.b * &right };
        let at = |c: &Complex64| self.span_near::<D>(c.re).filter(|(c, _)| *c <= most);
        part.constants().iter().filter_map(at).map(|(_, span)| span).fold(1.0, f64::min)
    }

    /// Real constants at which a square pencil is singular, in ascending order; the real parts of those whose imaginary
    /// parts are `near` zero or, of two that are one but for rounding, less.
    pub(super) fn real_constants(&self, near: f64) -> Vec<f64> {
        let is_real = |c: &Complex64| c.im.abs() <= near.max(NEARLY_REAL * (1.0 + c.norm()));
        let mut all: Vec<f64> = self.constants().iter().filter(|c| is_real(c)).map(|c| c.re).collect();
        all.dedup();
        all
    }

    /// Constants at which a square pencil is singular.
    fn constants(&self) -> Vec<Complex64> {
        let quotient = self.b.partial_piv_lu().solve(&self.a);
        if !quotient.col_iter().flat_map(|column| column.iter()).all(|x| x.is_finite()) {
            return Vec::new();
        }
        let mut values: Vec<Complex64> = quotient.eigenvalues().unwrap_or_default();
        values.retain(|c| c.is_finite());
        values.sort_unstable_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        values
    }

    /// Goes from a constant to one near by where the D-th singular value vanishes, if there is one; gives the constant and how
    /// well nodes span D dimensions there.
    fn span_near<const D: usize>(&self, start: f64) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        let mut c = start;
        for _ in 0..STEPS {
            let svd = self.at(c).svd().ok()?;
            let singular = svd.S().column_vector();
            let span = singular[D - 1] / singular[0];
            if !span.is_finite() || best.is_some_and(|(_, least)| span >= least) {
                break;
            }
            best = Some((c, span));
            let (u, v) = (svd.U().col(D - 1), svd.V().col(D - 1));
            c += singular[D - 1] / (u.transpose() * &self.b * v);
        }
        best.map(|(c, span)| (c, if span > DEGENERATE { span } else { 0.0 }))
    }
}

/// `(x_i1 + x_1j - x_11 - x_ij) / 2` of all rows and columns but the first; `cell` gives the numbers of `m` rows of `n`.
pub(super) fn centred(m: usize, n: usize, cell: impl Fn(usize) -> f64) -> Mat<f64> {
    let at = |i: usize, j: usize| cell(i * n + j);
    Mat::from_fn(m - 1, n - 1, |i, j| 0.5 * (at(i + 1, 0) + at(0, j + 1) - at(0, 0) - at(i + 1, j + 1)))
}

/// Numbers without a pattern that nodes could have.
fn mixing(i: usize, k: usize) -> f64 {
    // The sine of a sum would make matrices of rank two.
    ((1 + 7 * i + 3 * k).pow(2) as f64).sin()
}
