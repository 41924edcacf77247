//! Charts of the dual formulation on three transmitters: the same network with the transmitters in
//! another order.
//!
//! A path that comes near a far transmitter, or near a triangle of transmitters whose first side is
//! isotropic, is hard in one chart and easy in another. The equations keep their form when the
//! columns of the measurements are permuted. A path can therefore continue in another chart with
//! the same family: its start solution is carried over, and its end carried back.

use crate::minimal::formulation::Parameters;
use num_complex::Complex64;

/// Transmitters of the formulation.
pub(crate) const COLUMNS: usize = 3;
/// Unknowns `p1 p2 p3 k l m u v`.
const UNKNOWNS: usize = 8;

/// Orders of the transmitters, that of the data first.
pub(crate) const CHARTS: [[usize; COLUMNS]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]];

/// Parameters (rows of `width`) with the first columns in the order of a chart.
pub(crate) fn permute_columns(f: &[Complex64], width: usize, chart: &[usize; COLUMNS]) -> Parameters {
    let mut out = Parameters::from_slice(f);
    for (row, from) in out.chunks_exact_mut(width).zip(f.chunks_exact(width)) {
        for (to, &j) in chart.iter().enumerate() {
            row[to] = from[j];
        }
    }
    out
}

/// Carries a solution over into a chart.
///
/// In the basis `L e_1 = -2 (s_2 - s_1)`, `L e_2 = -2 (s_3 - s_1)` with Gram matrix `G = L'L` the
/// transmitters are `b`, `b - e_1 / 2` and `b - e_2 / 2`. The basis of the chart is `L T` with an
/// integer matrix `T` of determinant one or minus one, so `G' = T' G T` and `b' = T^{-1} s`, `s`
/// the new first transmitter; `det G = 1 / (k m)` stays.
pub(crate) fn enter(chart: &[usize; COLUMNS], x: &[Complex64]) -> [Complex64; UNKNOWNS] {
    let &[_, _, _, k, l, m, u, v] = x else { return [Complex64::new(f64::NAN, 0.0); UNKNOWNS] };
    let b = [u - l * v, v];
    // Twice the displacement of each transmitter from the first, in the basis: integers.
    const SHIFT: [[f64; 2]; COLUMNS] = [[0.0, 0.0], [-1.0, 0.0], [0.0, -1.0]];
    let [first, second, third] = chart.map(|j| SHIFT[j]);
    let column = |to: [f64; 2]| [first[0] - to[0], first[1] - to[1]];
    let (t1, t2) = (column(second), column(third));
    let det = t1[0] * t2[1] - t2[0] * t1[1];
    // t' G s with G = (1, l; l, l^2) / k + (0, 0; 0, 1) / m
    let gram = |s: [f64; 2], t: [f64; 2]| (s[0] + l * s[1]) * (t[0] + l * t[1]) / k + s[1] * t[1] / m;
    let g11 = gram(t1, t1);
    let l_new = gram(t1, t2) / g11;
    let s = [b[0] + 0.5 * first[0], b[1] + 0.5 * first[1]];
    let b_new = [(t2[1] * s[0] - t2[0] * s[1]) / det, (t1[0] * s[1] - t1[1] * s[0]) / det];
    let p = chart.map(|j| x[j]);
    [p[0], p[1], p[2], 1.0 / g11, l_new, k * m * g11, b_new[0] + l_new * b_new[1], b_new[1]]
}

/// Carries a solution of a chart back.
pub(crate) fn leave(chart: &[usize; COLUMNS], x: &[Complex64]) -> [Complex64; UNKNOWNS] {
    let mut inverse = [0; COLUMNS];
    for (k, &j) in chart.iter().enumerate() {
        inverse[j] = k;
    }
    enter(&inverse, x)
}

#[cfg(test)]
mod tests {
    use super::{CHARTS, UNKNOWNS, enter, leave};
    use hc::random::Random;

    #[test]
    fn charts_there_and_back() {
        let mut random = Random::new(0, 0);
        for _ in 0..100 {
            let x = random.normals(UNKNOWNS);
            for chart in &CHARTS {
                let back = leave(chart, &enter(chart, &x));
                assert!(hc::distinct::relative_distance(&back, &x) < 1e-8, "{chart:?}");
            }
        }
    }
}
