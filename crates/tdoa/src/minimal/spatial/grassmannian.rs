//! Planes through the origin on which bilinear forms vanish.

use super::monomials::{Monomial, Monomials, of_unit_length};
use super::offsets::DEGENERATE;
use faer::{Mat, MatRef};

/// Eigenvalues with imaginary parts up to this are also tried as real ones: rounding makes pairs of
/// nearly double ones.
const NEARLY_REAL: f64 = 1e-4;

/// The alternating form `a(x) b(y) - b(x) a(y)` of two linear ones.
pub(super) type Form = [Vec<f64>; 2];

/// How planes of a space are found among lines of Plücker coordinates.
pub(super) struct Shape {
    /// Dimension of the space.
    pub(super) dimension: usize,
    /// Planes on which as many generic forms vanish as the Grassmannian has dimensions: its degree.
    pub(super) planes: usize,
    /// Degree from which on polynomials tell the planes apart, and one more.
    regularity: usize,
}

/// Planes in a space of five dimensions, by six forms.
pub(super) const IN_FIVE: Shape = Shape { dimension: 5, planes: 5, regularity: 3 };
/// Planes in a space of six dimensions, by eight forms.
pub(super) const IN_SIX: Shape = Shape { dimension: 6, planes: 14, regularity: 4 };

/// Bases of the real planes on which all forms vanish; `None` if there are not finitely many, as far as
/// rounding tells.
///
/// The Plücker coordinates of a plane are linear in what the forms leave, and satisfy quadratic equations.
/// Products of these with monomials have the planes for their common kernel, on which quotients of linear
/// forms act as matrices; a plane is an eigenvector (Auzinger & Stetter 1988).
pub(super) fn planes(forms: &[Form], shape: &Shape) -> Option<Vec<Form>> {
    let pairs: Vec<(usize, usize)> =
        (0..shape.dimension).flat_map(|i| (i + 1..shape.dimension).map(move |j| (i, j))).collect();
    let row = |[a, b]: &Form| pairs.iter().map(|&(i, j)| a[i] * b[j] - a[j] * b[i]).collect();
    let svd = of_unit_length(forms.iter().map(row).collect()).svd().ok()?;
    let (first, last) = (svd.S()[0], svd.S()[forms.len() - 1]);
    // Written so that NaN is refused.
    let independent = last > DEGENERATE * first;
    if !independent {
        return None;
    }
    // Plücker coordinates in terms of what is left.
    let left = svd.V().subcols(forms.len(), pairs.len() - forms.len());
    let kernel = kernel(&quadrics(left, &pairs, shape.dimension), left.ncols(), shape)?;
    let points = points(kernel.as_ref(), left.ncols(), shape)?;
    Some(points.iter().filter_map(|y| basis(left, &pairs, y, shape.dimension)).collect())
}

/// The Plücker relations, one for each four coordinates, by their coefficients in the monomials of degree
/// two.
fn quadrics(left: MatRef<'_, f64>, pairs: &[(usize, usize)], dimension: usize) -> Vec<Vec<(Monomial, f64)>> {
    let monomials = Monomials::new(left.ncols(), 2);
    let place = |i: usize, j: usize| pairs.iter().position(|&pair| pair == (i, j)).unwrap_or(0);
    let fours = (0..dimension).flat_map(|a| {
        (a + 1..dimension)
            .flat_map(move |b| (b + 1..dimension).flat_map(move |c| (c + 1..dimension).map(move |d| [a, b, c, d])))
    });
    let relation = |[a, b, c, d]: [usize; 4]| {
        let products =
            [(1.0, place(a, b), place(c, d)), (-1.0, place(a, c), place(b, d)), (1.0, place(a, d), place(b, c))];
        let coefficient = |m: &Monomial| {
            let (k, l) = (usize::from(m[0]), usize::from(m[1]));
            let term = |&(sign, p, q): &(f64, usize, usize)| {
                let mixed = if k == l { 0.0 } else { left[(p, l)] * left[(q, k)] };
                sign * (left[(p, k)] * left[(q, l)] + mixed)
            };
            products.iter().map(term).sum::<f64>()
        };
        monomials.all().iter().map(|m| (m.clone(), coefficient(m))).collect()
    };
    fours.map(relation).collect()
}

/// What all products of the quadrics with monomials leave of the monomials of the highest degree, a column
/// for each plane.
fn kernel(quadrics: &[Vec<(Monomial, f64)>], variables: usize, shape: &Shape) -> Option<Mat<f64>> {
    let all = Monomials::new(variables, shape.regularity);
    let factors = Monomials::new(variables, shape.regularity - 2);
    let product = |quadric: &Vec<(Monomial, f64)>, factor: &Monomial| {
        let mut row = vec![0.0; all.len()];
        quadric.iter().for_each(|(m, coefficient)| row[all.place(m, factor)] += coefficient);
        row
    };
    let rows = quadrics.iter().flat_map(|quadric| factors.all().iter().map(move |factor| product(quadric, factor)));
    let svd = of_unit_length(rows.collect()).svd().ok()?;
    let rank = all.len() - shape.planes;
    let finitely_many = svd.S()[rank - 1] > DEGENERATE * svd.S()[0];
    finitely_many.then(|| svd.V().subcols(rank, shape.planes).to_owned())
}

/// The real points in projective space whose monomials the kernel holds.
fn points(kernel: MatRef<'_, f64>, variables: usize, shape: &Shape) -> Option<Vec<Vec<f64>>> {
    let all = Monomials::new(variables, shape.regularity);
    let lower = Monomials::new(variables, shape.regularity - 1);
    let shifted = |variable: usize| {
        let place = |m: &Monomial| all.place(m, &[variable as u8]);
        let places: Vec<usize> = lower.all().iter().map(place).collect();
        Mat::from_fn(lower.len(), shape.planes, |i, k| kernel[(places[i], k)])
    };
    let shifts: Vec<Mat<f64>> = (0..variables).map(shifted).collect();
    // Two linear forms in general position.
    let by = |phase: f64| {
        let weight = |k: usize| libm::cos(phase * (k + 1) as f64);
        let term = |sum: Mat<f64>, (k, shift): (usize, &Mat<f64>)| sum + faer::Scale(weight(k)) * shift;
        shifts.iter().enumerate().fold(Mat::zeros(lower.len(), shape.planes), term)
    };
    let (divisor, dividend) = (by(1.3), by(2.9));
    let svd = divisor.thin_svd().ok()?;
    let apart = svd.S()[shape.planes - 1] > DEGENERATE * svd.S()[0];
    if !apart {
        return None;
    }
    let turned = svd.U().transpose() * &dividend;
    let scaled = Mat::from_fn(shape.planes, shape.planes, |i, k| turned[(i, k)] / svd.S()[i]);
    let quotient = svd.V() * &scaled;
    let point = |value: f64| {
        let less = Mat::from_fn(shape.planes, shape.planes, |i, k| quotient[(i, k)] - if i == k { value } else { 0.0 });
        let svd = less.svd().ok()?;
        let vector = svd.V().col(shape.planes - 1).to_owned();
        let values = &divisor * &vector;
        let largest = (0..lower.len()).max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()))?;
        let y: Vec<f64> = shifts.iter().map(|shift| shift.row(largest) * &vector).collect();
        y.iter().all(|y| y.is_finite()).then_some(y)
    };
    let values = quotient.eigenvalues().ok()?;
    let nearly_real = values.iter().filter(|value| value.im.abs() <= NEARLY_REAL * (1.0 + value.norm()));
    Some(nearly_real.filter_map(|value| point(value.re)).collect())
}

/// A basis of the plane with these coordinates.
fn basis(left: MatRef<'_, f64>, pairs: &[(usize, usize)], y: &[f64], dimension: usize) -> Option<Form> {
    let plücker: Vec<f64> =
        (0..pairs.len()).map(|p| y.iter().enumerate().map(|(k, y)| left[(p, k)] * y).sum()).collect();
    let largest = (0..pairs.len()).max_by(|&a, &b| plücker[a].abs().total_cmp(&plücker[b].abs()))?;
    let column = |j: usize| {
        let entry = |i: usize| {
            let place = |pair: (usize, usize)| pairs.iter().position(|&p| p == pair).map_or(0.0, |p| plücker[p]);
            if i < j { place((i, j)) } else { -place((j, i)) }
        };
        (0..dimension).map(entry).collect::<Vec<f64>>()
    };
    let (i, j) = pairs[largest];
    Some([column(i), column(j)])
}

#[cfg(test)]
mod tests {
    use super::{IN_FIVE, IN_SIX, planes};
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    /// Forms that vanish on a known plane, one of as many as the degree of the Grassmannian is at most.
    #[test]
    fn a_known_plane_is_among_those_found() {
        for (shape, count) in [(&IN_FIVE, 6), (&IN_SIX, 8)] {
            for seed in 0..20 {
                let mut rng = Pcg64Mcg::seed_from_u64(seed);
                let mut vector = || (0..shape.dimension).map(|_| rng.sample(StandardNormal)).collect::<Vec<f64>>();
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let known = [vector(), vector()];
                let forms: Vec<_> = (0..count)
                    .map(|_| {
                        // b = c - (something along the first entry), so that a(x) b(y) = b(x) a(y) on the plane.
                        let (a, mut b) = (vector(), vector());
                        let [x, y] = &known;
                        let wrong = dot(&a, x) * dot(&b, y) - dot(&b, x) * dot(&a, y);
                        let slope = dot(&a, x) * y[0] - x[0] * dot(&a, y);
                        b[0] -= wrong / slope;
                        [a, b]
                    })
                    .collect();
                let found = planes(&forms, shape).unwrap();
                assert!(!found.is_empty() && found.len() <= shape.planes, "{}", found.len());
                // The part of a vector that is orthogonal to a plane, by Gram and Schmidt.
                let off = |v: &[f64], [x, y]: &[Vec<f64>; 2]| {
                    let along = |v: &[f64], e: &[f64]| {
                        let share = dot(v, e) / dot(e, e);
                        v.iter().zip(e).map(|(v, e)| v - share * e).collect::<Vec<f64>>()
                    };
                    let rest = along(&along(v, x), &along(y, x));
                    (dot(&rest, &rest) / dot(v, v)).sqrt()
                };
                let near = found.iter().any(|plane| known.iter().all(|v| off(v, plane) < 1e-7));
                assert!(near, "dimension {}, seed {seed}", shape.dimension);
            }
        }
    }
}
