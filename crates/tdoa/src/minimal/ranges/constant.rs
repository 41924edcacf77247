//! The Gram matrix of D + 1 receivers and the constant that all ranges have in common: three receivers with four
//! transmitters in the plane, four with seven in space.
//!
//! The equations are in `families/3r4s_constant.toml` and `4r7s_constant.toml`. Parameters are the ranges, as they were measured.

use super::gram::{IN_PLANE, IN_SPACE, Size, define_size, distances, inverse, placed, reordered};
use crate::clocks::Emissions;
use crate::generated::{four_seven_constant, three_four_constant};
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::minimal::normalised::Normalised;
use crate::minimal::orders::Orders;
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use hc::Fibre;
use num_complex::Complex64;
use std::marker::PhantomData;

define_size!(
    "Three receivers, four transmitters in the plane: 43 paths.",
    ThreeFour,
    2,
    three_four_constant,
    "3r4s_constant",
    "3r/4s",
    3,
    4,
    [2, 2, 0, 1],
    IN_PLANE
);
define_size!(
    "Four receivers, seven transmitters in space: 388 paths.",
    FourSeven,
    3,
    four_seven_constant,
    "4r7s_constant",
    "4r/7s",
    4,
    7,
    [2, 2, 2, 0, 0, 0, 1],
    IN_SPACE
);

/// The formulation of a size in D dimensions. Unknowns are those of [`super::gram::Gram`], and then the constant `c`.
pub(crate) struct GramAndConstant<S, const D: usize>(PhantomData<S>);

impl<S: Size<D>, const D: usize> Formulation for GramAndConstant<S, D> {
    type System = S::System;
    const NAME: &'static str = S::NAME;
    const FAMILY: &'static str = S::FAMILY;
    const RECEIVERS: usize = S::RECEIVERS;
    const TRANSMITTERS: usize = S::TRANSMITTERS;
    const WEIGHTS: &'static [i32] = S::WEIGHTS;
    const EMISSIONS: Emissions = Emissions::Constant;
    const CHARTS: usize = S::CHARTS.len();

    fn system() -> &'static Self::System {
        S::system()
    }

    fn fibre() -> Fibre {
        S::fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        let n = S::TRANSMITTERS;
        S::CHARTS[chart].iter().flat_map(|&i| &f[i * n..(i + 1) * n]).copied().collect()
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        in_order::<D>(S::CHARTS[chart], x)
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        in_order::<D>(&inverse(S::CHARTS[chart])[..=D], x)
    }

    fn orders(_: &Pseudoranges) -> Option<Orders> {
        Some(Orders::of_data(S::RECEIVERS, S::TRANSMITTERS))
    }

    fn given(data: &Normalised, out: &mut Vec<f64>) {
        out.extend_from_slice(&data.matrix);
    }

    fn offsets(_: &[Complex64], x: &[Complex64]) -> Point {
        let mut all = distances::<D>(x);
        all.extend(x.last().copied());
        all
    }
}

impl<S: Size<D>, const D: usize> FormulationIn<D> for GramAndConstant<S, D> {
    fn network(f: &[f64], x: &[f64], _: &mut LeastSquares) -> Option<Network<D>> {
        let (n, constant) = (S::TRANSMITTERS, *x.last()?);
        if !x[..D].iter().all(|&e| e > 0.0) {
            return None;
        }
        let (receivers, transmitters) = placed(x, n, |i, j| (f[i * n + j] - constant).powi(2));
        let network = Network::new(receivers, transmitters, vec![constant; n]);
        network.is_finite().then_some(network)
    }
}

/// The unknowns with the receivers in another order, which leaves the constant as it is.
fn in_order<const D: usize>(order: &[usize], x: &[Complex64]) -> Point {
    let mut all = reordered::<D>(order, x);
    all.extend(x.last().copied());
    all
}
