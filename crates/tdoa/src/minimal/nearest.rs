//! The stored fibre in the position nearest to the data.
//!
//! Two operations turn the stored fibre into others with known solutions: reordering nodes that the
//! unknowns do not tell apart, and multiplying all lengths by a complex number of size one. The
//! fibre nearest to the data is taken, because its paths are shorter.

use super::formulation::{Formulation, Free, Point};
use hc::Fibre;
use num_complex::Complex64;

/// Scratch space; keeps its memory from call to call.
#[derive(Default)]
pub(crate) struct Nearest {
    products: Vec<Complex64>,
    order: Vec<usize>,
    best: Vec<usize>,
}

impl Nearest {
    /// Turns `stored` towards the data `target` and then by `turn` (radians) away again; a turn
    /// gives other paths to the same ends. The fibre goes into `moved`.
    pub(crate) fn find<F: Formulation>(&mut self, stored: &Fibre, target: &[Complex64], turn: f64, moved: &mut Fibre) {
        let (rows, columns) = (F::RECEIVERS - 1, F::TRANSMITTERS);
        let cell = |node: usize, other: usize| match F::FREE {
            Free::Receivers => node * columns + other,
            Free::Transmitters => other * columns + node,
        };
        let (count, others) = match F::FREE {
            Free::Receivers => (rows, columns),
            Free::Transmitters => (columns, rows),
        };
        self.products.clear();
        self.products.extend((0..count * count).map(|ab| {
            let (a, b) = (ab / count, ab % count);
            (0..others).map(|k| stored.parameters[cell(a, k)].conj() * target[cell(b, k)]).sum::<Complex64>()
        }));
        self.order.clear();
        self.order.extend(0..count);
        let (products, order) = (&self.products, &mut self.best);
        let mut best = BestOrder { products, count, size: -1.0, order, sum: Complex64::new(1.0, 0.0) };
        best.search(&mut self.order, 0, Complex64::new(0.0, 0.0));
        let towards = if best.sum.norm() > 0.0 { best.sum / best.sum.norm() } else { Complex64::new(1.0, 0.0) };
        let factor = towards * Complex64::from_polar(1.0, turn);

        moved.dimension = stored.dimension;
        moved.parameters.clone_from(&stored.parameters);
        for (b, &a) in best.order.iter().enumerate() {
            for k in 0..others {
                moved.parameters[cell(b, k)] = factor * stored.parameters[cell(a, k)];
            }
        }
        let powers: Point = F::WEIGHTS.iter().map(|&w| factor.powi(w)).collect();
        moved.solutions.clear();
        moved.solutions.extend(stored.solutions.iter().enumerate().map(|(k, x)| x * powers[k % powers.len()]));
    }
}

/// The order with the largest sum of products, found by going through all of them.
struct BestOrder<'a> {
    products: &'a [Complex64],
    count: usize,
    size: f64,
    order: &'a mut Vec<usize>,
    sum: Complex64,
}

impl BestOrder<'_> {
    /// `order[..at]` is settled and gives the partial sum `sum`.
    fn search(&mut self, order: &mut [usize], at: usize, sum: Complex64) {
        if at == self.count {
            if sum.norm_sqr() > self.size {
                self.size = sum.norm_sqr();
                self.order.clear();
                self.order.extend_from_slice(order);
                self.sum = sum;
            }
            return;
        }
        for k in at..self.count {
            order.swap(at, k);
            self.search(order, at + 1, sum + self.products[order[at] * self.count + at]);
            order.swap(at, k);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Nearest;
    use crate::minimal::formulation::Formulation;
    use crate::minimal::planar::four_five::FourFive;
    use crate::minimal::planar::three::{FiveFour, SixThree};
    use hc::poly::{Evaluate, Isa};
    use hc::random::Random;
    use num_complex::Complex64;

    /// Solutions stay solutions, and the distance to the data does not grow.
    fn check<F: Formulation>() {
        let stored = F::fibre();
        let (mut nearest, mut moved) = (Nearest::default(), stored.clone());
        let n = stored.dimension;
        let mut memory = F::system().memory(Isa::Portable);
        let (mut values, mut jacobian) = (vec![Complex64::new(0.0, 0.0); n], vec![Complex64::new(0.0, 0.0); n * n]);
        for seed in 0..5 {
            let target = Random::new(seed, 0).normals(stored.parameters.len());
            for turn in [0.0, 1.0] {
                nearest.find::<F>(&stored, &target, turn, &mut moved);
                for x in moved.solutions.chunks_exact(n) {
                    F::system().jacobian(&mut memory, x, &moved.parameters, &mut values, &mut jacobian);
                    for i in 0..n {
                        let scale: f64 = (0..n).map(|j| (jacobian[j * n + i] * x[j]).norm()).sum();
                        assert!(values[i].norm() < 1e-9 * scale, "{}: {:.1e}", F::NAME, values[i].norm() / scale);
                    }
                }
                let distance = |p: &[Complex64]| p.iter().zip(&target).map(|(a, b)| (a - b).norm_sqr()).sum::<f64>();
                assert!(turn > 0.0 || distance(&moved.parameters) <= distance(&stored.parameters));
            }
        }
    }

    #[test]
    fn moved_fibres_are_fibres() {
        check::<SixThree>();
        check::<FiveFour>();
        check::<FourFive>();
    }
}
