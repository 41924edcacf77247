//! The charts of a formulation, in the form that the tracker of fibres takes.

use super::formulation::Formulation;
use hc::family::Charts;
use num_complex::Complex64;
use std::marker::PhantomData;

/// The charts of `F`: the nodes in another order.
pub(crate) struct Recharted<F>(PhantomData<F>);

impl<F> Default for Recharted<F> {
    fn default() -> Self {
        Recharted(PhantomData)
    }
}

impl<F: Formulation> Charts for Recharted<F> {
    const COUNT: usize = F::CHARTS;

    fn parameters(&self, chart: usize, p: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend(F::parameters(chart, p));
    }

    fn enter(&self, chart: usize, x: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend(F::enter(chart, x));
    }

    fn leave(&self, chart: usize, x: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend(F::leave(chart, x));
    }
}

#[cfg(test)]
mod tests {
    use crate::minimal::formulation::Formulation;
    use crate::minimal::planar::four_five::FourFive;
    use crate::minimal::planar::three::{FiveFour, SixThree};
    use crate::minimal::ranges::{FiveFive, FourSeven, FourSix, Gram, GramAndConstant, ThreeFour, ThreeThree};
    use crate::minimal::spatial::{Dual, EightFive, SevenFive, SixSix, TenFour};
    use hc::poly::{Evaluate, Isa};
    use num_complex::Complex64;

    /// Solutions of the stored fibre solve the equations of every chart, and come back from there as they
    /// were, but for rounding errors up to `back`.
    fn solutions_stay_solutions<F: Formulation>(back: f64) {
        let fibre = F::fibre();
        let n = fibre.dimension;
        let mut memory = F::system().memory(Isa::Portable);
        let (mut values, mut jacobian) = (vec![Complex64::new(0.0, 0.0); n], vec![Complex64::new(0.0, 0.0); n * n]);
        for chart in 0..F::CHARTS {
            let p = F::parameters(chart, &fibre.parameters);
            for x in fibre.solutions.chunks_exact(n) {
                let y = F::enter(chart, x);
                F::system().jacobian(&mut memory, &y, &p, &mut values, &mut jacobian);
                for i in 0..n {
                    let scale: f64 = (0..n).map(|j| (jacobian[j * n + i] * y[j]).norm()).sum();
                    let error = values[i].norm() / scale;
                    assert!(error < 1e-9, "{}, chart {chart}, equation {i}: {error:.1e}", F::NAME);
                }
                let distance = hc::distinct::relative_distance(&F::leave(chart, &y), x);
                assert!(distance < back, "{}, chart {chart}: {distance:.1e}", F::NAME);
            }
        }
    }

    #[test]
    fn charts_of_the_stored_fibres() {
        solutions_stay_solutions::<SixThree>(1e-9);
        solutions_stay_solutions::<FiveFour>(1e-9);
        solutions_stay_solutions::<FourFive>(1e-9);
    }

    #[test]
    fn charts_of_the_fibres_of_ranges() {
        solutions_stay_solutions::<Gram<ThreeThree, 2>>(1e-9);
        solutions_stay_solutions::<Gram<FourSix, 3>>(1e-9);
        solutions_stay_solutions::<Gram<FiveFive, 3>>(1e-9);
        solutions_stay_solutions::<GramAndConstant<ThreeFour, 2>>(1e-9);
        solutions_stay_solutions::<GramAndConstant<FourSeven, 3>>(1e-9);
    }

    /// The unknowns of 6r/6s reach 6e4, next to others of size one, and lose a digit more than the others.
    #[test]
    fn charts_of_the_fibres_in_space() {
        solutions_stay_solutions::<Dual<EightFive>>(1e-9);
        solutions_stay_solutions::<Dual<SevenFive>>(1e-9);
        solutions_stay_solutions::<Dual<TenFour>>(1e-9);
        solutions_stay_solutions::<SixSix>(1e-8);
    }
}
