//! The dual formulation on three transmitters: six receivers with three transmitters, five with
//! four.

use super::chart::{CHARTS, COLUMNS, enter, leave, permute_columns};
use super::dual;
use crate::generated::{five_four, six_three};
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::network::Network;
use hc::Fibre;
use num_complex::Complex64;

/// Weights of `p1 p2 p3 k l m u v`: `k` and `m` are inverse squares of lengths, `l`, `u` and `v`
/// are ratios.
const WEIGHTS: &[i32] = &[1, 1, 1, -2, 0, -2, 0, 0];

/// Six receivers, three transmitters: 180 paths.
pub(crate) struct SixThree;

impl Formulation for SixThree {
    type System = six_three::System;
    const NAME: &'static str = "6r/3s";
    const FAMILY: &'static str = include_str!("../../../families/6r3s.toml");
    const RECEIVERS: usize = 6;
    const TRANSMITTERS: usize = 3;
    const WEIGHTS: &'static [i32] = WEIGHTS;
    const CHARTS: usize = CHARTS.len();

    fn system() -> &'static Self::System {
        &six_three::System
    }

    fn fibre() -> Fibre {
        six_three::fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        permute_columns(f, COLUMNS, &CHARTS[chart])
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        Point::from_slice(&enter(&CHARTS[chart], x))
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        Point::from_slice(&leave(&CHARTS[chart], x))
    }

    fn offsets(_: &[Complex64], x: &[Complex64]) -> Point {
        Point::from_slice(&x[..COLUMNS])
    }
}

impl FormulationIn for SixThree {
    fn network(f: &[f64], x: &[f64], _: &mut LeastSquares) -> Option<Network> {
        dual::network(f, COLUMNS, x)
    }
}

/// Five receivers, four transmitters: 152 paths. The charts reorder the first three transmitters.
pub(crate) struct FiveFour;

/// Transmitters of [`FiveFour`].
const FOUR: usize = 4;

impl Formulation for FiveFour {
    type System = five_four::System;
    const NAME: &'static str = "5r/4s";
    const FAMILY: &'static str = include_str!("../../../families/5r4s.toml");
    const RECEIVERS: usize = 5;
    const TRANSMITTERS: usize = FOUR;
    const WEIGHTS: &'static [i32] = WEIGHTS;
    const CHARTS: usize = CHARTS.len();

    fn system() -> &'static Self::System {
        &five_four::System
    }

    fn fibre() -> Fibre {
        five_four::fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        permute_columns(f, FOUR, &CHARTS[chart])
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        Point::from_slice(&enter(&CHARTS[chart], x))
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        Point::from_slice(&leave(&CHARTS[chart], x))
    }

    fn offsets(_: &[Complex64], x: &[Complex64]) -> Point {
        // The fourth is a rational function of the others.
        Point::from_slice(&x[..COLUMNS])
    }
}

impl FormulationIn for FiveFour {
    fn network(f: &[f64], x: &[f64], squares: &mut LeastSquares) -> Option<Network> {
        let mut network = dual::network(f, FOUR, x)?;
        let (transmitter, offset) = dual::further_transmitter(f, FOUR, COLUMNS, x, &network, squares)?;
        network.transmitters.push(transmitter);
        network.offsets.push(offset);
        network.is_finite().then_some(network)
    }
}
