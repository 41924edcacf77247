//! Squares of ranges, doubly centred.

use super::pencil::{DEGENERATE, Pencil, centred};
use crate::clocks::Emissions;
use crate::minimal::normalised::Normalised;
use crate::pseudoranges::Pseudoranges;
use faer::Mat;

/// A node does not depend on the others if its number is less than this share of the largest one, which has fewer digits than
/// the ranges.
const DEPENDENT: f64 = 1e-9;
/// A constant leaves no range below zero by more than this, in units of the ranges.
const NEGATIVE: f64 = 1e-6;

/// `(r_i - r_1) . (s_j - s_1)` of all receivers and transmitters but the first, by ranges in rows of `n`.
fn products(matrix: &[f64], n: usize) -> Mat<f64> {
    centred(matrix.len() / n, n, |k| matrix[k] * matrix[k])
}

/// How well the nodes of either kind span D dimensions: the last of D singular values as a share of the first; zero
/// if they do not, as far as doubles tell. Of ranges with an unknown constant, for the worst of the constants.
pub(super) fn span<const D: usize>(measured: &Pseudoranges) -> f64 {
    let (matrix, n) = (Normalised::new(measured).matrix, measured.transmitters());
    if measured.emissions() == Emissions::Constant {
        return Pencil::new(&matrix, n).span::<D>(most(&matrix));
    }
    let singular = products(&matrix, n).singular_values().unwrap_or_default();
    match (singular.first(), singular.get(D - 1)) {
        (Some(first), Some(last)) if *last > DEGENERATE * first => last / first,
        _ => 0.0,
    }
}

/// How well D + 2 nodes of each kind are in general position: [`span`], or the least of the numbers by which nodes of one kind
/// [depend](dependence) on each other as a share of the largest one, if that is less. Zero where all nodes but one of a
/// kind lie in one line or plane, as far as doubles tell.
pub(super) fn spread<const D: usize>(measured: &Pseudoranges) -> f64 {
    let (matrix, m, n) = (Normalised::new(measured).matrix, measured.receivers(), measured.transmitters());
    let constants = match measured.emissions() {
        Emissions::Constant => Pencil::new(&matrix, n).real_constants(0.0),
        Emissions::Known | Emissions::Unknown => vec![0.0],
    };
    let most = most(&matrix);
    let at = |c: &f64| least_dependence(&matrix.iter().map(|f| f - c).collect::<Vec<f64>>(), m, n);
    constants.iter().filter(|&&c| c <= most).map(at).fold(span::<D>(measured), f64::min)
}

/// The largest constant of some ranges, which leaves none of them below zero.
fn most(matrix: &[f64]) -> f64 {
    matrix.iter().copied().fold(f64::INFINITY, f64::min) + NEGATIVE
}

/// The least of the numbers by which nodes of either kind depend on each other, as a share of the largest one.
fn least_dependence(matrix: &[f64], m: usize, n: usize) -> f64 {
    let transposed: Vec<f64> = (0..m * n).map(|k| matrix[k % m * n + k / m]).collect();
    let share = |matrix: &[f64], n: usize| {
        let sizes: Vec<f64> = dependence(matrix, n).iter().flatten().map(|x| x.abs()).collect();
        let (least, most) = sizes.iter().fold((f64::INFINITY, 0.0f64), |(l, m), &x| (l.min(x), m.max(x)));
        if least > DEPENDENT * most { least / most } else { 0.0 }
    };
    share(matrix, n).min(share(&transposed, m))
}

/// Numbers that add up to zero, of which `sum_i x_i |r_i - s_j|^2` is the same for all transmitters: how D + 2 receivers
/// depend on each other, by ranges in rows of `n`. `None` if they are not finite.
pub(super) fn dependence(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let svd = products(matrix, n).svd().ok()?;
    let u = svd.U();
    let last = u.ncols() - 1;
    let others: Vec<f64> = (0..u.nrows()).map(|i| u[(i, last)]).collect();
    let first = -others.iter().sum::<f64>();
    let all: Vec<f64> = std::iter::once(first).chain(others).collect();
    all.iter().all(|x| x.is_finite()).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::{dependence, span, spread};
    use crate::clocks::Emissions;
    use crate::pseudoranges::Pseudoranges;

    #[test]
    fn receivers_of_a_square_depend_on_each_other() {
        // The corners (0, 0), (1, 0), (1, 1), (0, 1): the sums over each diagonal are equal.
        let transmitters = [[0.3, 0.9], [2.0, -1.0], [0.1, 4.0], [3.0, 3.5]];
        let corners = [[0.0f64, 0.0f64], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let ranges = corners.iter().flat_map(|r| transmitters.iter().map(|s| (r[0] - s[0]).hypot(r[1] - s[1])));
        let measured = Pseudoranges::new(4, 4, ranges.collect()).unwrap().with_emissions(Emissions::Known);
        let found = dependence(measured.cells().values(), 4).unwrap();
        let expected = [1.0, -1.0, 1.0, -1.0];
        assert!(found.iter().zip(expected).all(|(x, e)| (x / found[0] - e).abs() < 1e-12), "{found:?}");
        assert!(span::<2>(&measured) > 0.01 && span::<3>(&measured) == 0.0);
        assert!(spread::<2>(&measured) > 0.01 && spread::<2>(&measured) <= span::<2>(&measured));
        let in_line = measured.select(&[0, 1], &[0, 1, 2, 3]);
        assert_eq!(span::<2>(&in_line), 0.0);
        // Three of the four in one line.
        let nearly = [[0.0f64, 0.0f64], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
        let ranges = nearly.iter().flat_map(|r| transmitters.iter().map(|s| (r[0] - s[0]).hypot(r[1] - s[1])));
        let measured = Pseudoranges::new(4, 4, ranges.collect()).unwrap().with_emissions(Emissions::Known);
        assert!(span::<2>(&measured) > 0.01 && spread::<2>(&measured) == 0.0);
    }
}
