//! Nodes exactly in one line, told from the measurements alone.
//!
//! Such networks are no isolated roots: each node off the line may be its mirror image, one by one. But `D_ij = q_ij - q_i1
//! = -2 r_i . (s_j - s_1)`, `q_ij = f_ij (f_ij - 2 p_j)`, then has rank one instead of two, for receivers in a line as for transmitters,
//! and the offsets for which it has follow from linear equations.

use super::linear::LeastSquares;
use super::rank::differences;
use smallvec::SmallVec;

/// Rank one to this precision (minors relative to the square of the largest entry) counts as exact.
const RANK_ONE: f64 = 1e-9;

/// What lies in one line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Line {
    /// All receivers.
    Receivers,
    /// All transmitters.
    Transmitters,
}

/// Whether the data `f_ij - f_1j` (`i = 2..m`, rows of `width`) fit a network with all receivers or all transmitters in one line.
///
/// `None` too for matrices so small that some offsets always give rank one: six receivers with three transmitters, five with four and
/// four with five are the smallest that tell.
pub(crate) fn in_one_line(f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<Line> {
    let rows = f.len() / width;
    let p = match (rows, width) {
        (5.., 3..) | (4, 4..) => by_columns(f, width, squares)?,
        (3, 5..) => by_rows(f, width, squares)?,
        _ => return None,
    };
    let (d, q) = differences(f, &p);
    let w = width - 1;
    let largest = d.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let at = d.iter().position(|x| x.abs() == largest)?;
    let (row, column) = (at / w, at % w);
    let minor = |i: usize, j: usize| d[i * w + j] * d[at] - d[i * w + column] * d[row * w + j];
    let rank_one = (0..rows).all(|i| (0..w).all(|j| minor(i, j).abs() <= RANK_ONE * largest * largest));
    // Written so that NaN is no fit.
    if !(rank_one && largest > 0.0) {
        return None;
    }
    // Receivers in a line: r_i = x_i e, x_i in the ratio of the rows of D, and q_i1 = x_i^2 - 2 x_i (e . s_1), a quadratic without constant.
    let x: SmallVec<[f64; 8]> = (0..rows).map(|i| d[i * w + column] / d[at]).collect();
    let fit = squares.fit(rows, 2, |i, c| if c == 0 { x[i] * x[i] } else { x[i] }, |i| q[i])?;
    let size = q.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let quadratic = (0..rows).all(|i| ((fit[0] * x[i] + fit[1]) * x[i] - q[i]).abs() <= 1e-6 * size);
    Some(if quadratic && fit[0] > 0.0 { Line::Receivers } else { Line::Transmitters })
}

/// Offsets `p_j` that make `D` rank one: three columns of `q` then obey `q_i3 = w q_i1 + (1 - w) q_i2`, which is linear in `w`, `w p_1`, `(1 - w) p_2`
/// and `p_3`; four rows or more.
fn by_columns(f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<SmallVec<[f64; 8]>> {
    let mut p = SmallVec::new();
    for j in 2..width {
        let entry = |i: usize, c: usize| {
            let [a, b, c3] = [f[i * width], f[i * width + 1], f[i * width + j]];
            [a * a - b * b, -2.0 * a, 2.0 * b, 2.0 * c3][c]
        };
        let right = |i: usize| f[i * width + j].powi(2) - f[i * width + 1].powi(2);
        // The third unknown is -(1 - w) p_2.
        let x = squares.fit(f.len() / width, 4, entry, right)?;
        if j == 2 {
            p.extend([x[1] / x[0], -x[2] / (1.0 - x[0])]);
        }
        p.push(x[3]);
    }
    Some(p)
}

/// The same from three rows and five columns or more: `q_ij - g_i q_2j = c_i` for `i = 3, 4`. Without the `p_j` these are linear in
/// `g_3`, `g_4`, `c_3`, `c_4` and `g_3 c_4 - g_4 c_3`.
fn by_rows(f: &[f64], width: usize, squares: &mut LeastSquares) -> Option<SmallVec<[f64; 8]>> {
    let at = |i: usize, j: usize| f[i * width + j];
    let entry = |j: usize, c: usize| {
        let [a, b, d] = [at(0, j), at(1, j), at(2, j)];
        [a * d * (a - d), a * b * (b - a), d, -b, a][c]
    };
    let right = |j: usize| {
        let [b, d] = [at(1, j), at(2, j)];
        b * d * (b - d)
    };
    let x = squares.fit(width, 5, entry, right)?;
    let offset = |j: usize| {
        let [a, b, d] = [at(0, j), at(1, j), at(2, j)];
        let (third, fourth) = (x[0] * a - b, x[1] * a - d);
        if third.abs() >= fourth.abs() {
            (x[0] * a * a - b * b + x[2]) / (2.0 * third)
        } else {
            (x[1] * a * a - d * d + x[3]) / (2.0 * fourth)
        }
    };
    Some((0..width).map(offset).collect())
}

#[cfg(test)]
mod tests {
    use super::{Line, in_one_line};
    use crate::minimal::linear::LeastSquares;
    use crate::simulate::{Layout, SimulateOptions, simulate};

    #[test]
    fn nodes_in_one_line_are_noticed_and_others_are_not() {
        for (receivers, transmitters) in [(6, 3), (5, 4), (4, 5), (7, 3), (6, 5), (4, 6)] {
            for seed in 0..50 {
                let options = SimulateOptions {
                    receivers,
                    transmitters,
                    layout: Layout::Normal,
                    noise: 0.0,
                    seed,
                    ..SimulateOptions::default()
                };
                let plain = simulate(&options).unwrap().network;
                for distance in [1.0, 1e-3, 0.0] {
                    for line in [Line::Receivers, Line::Transmitters] {
                        let mut network = plain.clone();
                        let nodes = match line {
                            Line::Receivers => &mut network.receivers,
                            Line::Transmitters => &mut network.transmitters,
                        };
                        nodes.iter_mut().for_each(|x| x[1] *= distance);
                        let f: Vec<f64> = (transmitters..receivers * transmitters)
                            .map(|k| (k / transmitters, k % transmitters))
                            .map(|(i, j)| network.pseudorange(i, j) - network.pseudorange(0, j))
                            .collect();
                        let expected = (distance == 0.0).then_some(line);
                        assert_eq!(
                            in_one_line(&f, transmitters, &mut LeastSquares::default()),
                            expected,
                            "{receivers}r/{transmitters}s, seed {seed}, {line:?}"
                        );
                    }
                }
            }
        }
    }
}
