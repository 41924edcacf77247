//! The Gram matrix of three receivers: six receivers with six transmitters.
//!
//! The equations are in `families/6r6s.toml`. The other two receivers are combinations of the three.

use super::stored::{SIX_SIX, SIX_SIX_FAMILY};
use super::symmetric::{Factored, Matrix, Vector, coordinates, form};
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::network::Network;
use hc::Fibre;
use hc::poly::Interpreter;
use num_complex::Complex64;
use std::array::from_fn;

/// Transmitters.
const COLUMNS: usize = 6;
/// Receivers but the first.
const ROWS: usize = 5;

/// Orders of these receivers, that of the data first; three that come first make the Gram matrix.
const CHARTS: [[usize; ROWS]; 8] = [
    [0, 1, 2, 3, 4],
    [1, 2, 3, 4, 0],
    [2, 3, 4, 0, 1],
    [3, 4, 0, 1, 2],
    [4, 0, 1, 2, 3],
    [0, 2, 4, 1, 3],
    [3, 1, 4, 0, 2],
    [2, 0, 3, 4, 1],
];

/// Six receivers, six transmitters: 3920 paths.
pub(crate) struct SixSix;

impl Formulation for SixSix {
    type System = Interpreter;
    const NAME: &'static str = "6r/6s";
    const FAMILY: &'static str = SIX_SIX_FAMILY;
    const RECEIVERS: usize = 6;
    const TRANSMITTERS: usize = COLUMNS;
    const WEIGHTS: &'static [i32] = &[0, 0, 0, 2, 0, 0, 0, 2, 2, 2, 2, 0, 0, 0];
    const CHARTS: usize = CHARTS.len();
    const MANY: bool = true;

    fn system() -> &'static Interpreter {
        SIX_SIX.system()
    }

    fn fibre() -> Fibre {
        SIX_SIX.fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        CHARTS[chart].iter().flat_map(|&row| &f[row * COLUMNS..(row + 1) * COLUMNS]).copied().collect()
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        Unknowns::new(x).reordered(&CHARTS[chart]).point()
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        let mut inverse = [0; ROWS];
        for (k, &row) in CHARTS[chart].iter().enumerate() {
            inverse[row] = k;
        }
        Unknowns::new(x).reordered(&inverse).point()
    }

    fn offsets(f: &[Complex64], x: &[Complex64]) -> Point {
        let Unknowns { coordinates: [v, _], rest: [c, _], .. } = Unknowns::new(x);
        let offset = |j: usize| {
            let [f2, f3, f4, f5] = from_fn(|row| f[row * COLUMNS + j]);
            let above = v[0] * f2 * f2 + v[1] * f3 * f3 + v[2] * f4 * f4 - f5 * f5 + c;
            above / (2.0 * (v[0] * f2 + v[1] * f3 + v[2] * f4 - f5))
        };
        (0..COLUMNS).map(offset).collect()
    }
}

impl FormulationIn<3> for SixSix {
    /// The rows of `M diag(sqrt e)` are the three receivers; `2 r_t . s_j = |r_t|^2 - f_tj^2 + 2 f_tj p_j`
    /// gives the transmitters.
    fn network(f: &[f64], x: &[f64], _: &mut LeastSquares) -> Option<Network<3>> {
        let (combinations, gram) = x.split_at_checked(8)?;
        let [sixth, fifth] = [&combinations[..4], &combinations[4..]];
        let &[e1, e2, e3, l21, l31, l32] = gram else { return None };
        if !(e1 > 0.0 && e2 > 0.0 && e3 > 0.0) {
            return None;
        }
        let (lengths, at) = ([e1.sqrt(), e2.sqrt(), e3.sqrt()], |row: usize, j: usize| f[row * COLUMNS + j]);
        let basis: [[f64; 3]; 3] =
            [[1.0, 0.0, 0.0], [l21, 1.0, 0.0], [l31, l32, 1.0]].map(|row| from_fn(|k| row[k] * lengths[k]));
        let mut receivers = vec![[0.0; 3]];
        receivers.extend(basis);
        receivers.extend([fifth, sixth].map(|v| from_fn(|k| (0..3).map(|t| v[t] * basis[t][k]).sum())));
        let (mut transmitters, mut offsets) = (Vec::with_capacity(COLUMNS), Vec::with_capacity(COLUMNS));
        for j in 0..COLUMNS {
            let sum = |power: i32| (0..3).map(|t| fifth[t] * at(t, j).powi(power)).sum::<f64>();
            let p = (sum(2) - at(3, j).powi(2) + fifth[3]) / (2.0 * (sum(1) - at(3, j)));
            let product = |t: usize| {
                let square = basis[t].iter().map(|x| x * x).sum::<f64>();
                0.5 * (square - at(t, j) * (at(t, j) - 2.0 * p))
            };
            let x = product(0) / basis[0][0];
            let y = (product(1) - basis[1][0] * x) / basis[1][1];
            transmitters.push([x, y, (product(2) - basis[2][0] * x - basis[2][1] * y) / basis[2][2]]);
            offsets.push(p);
        }
        let network = Network::new(receivers, transmitters, offsets);
        network.is_finite().then_some(network)
    }
}

/// A solution by its parts.
struct Unknowns {
    /// The fifth and the sixth receiver by the three.
    coordinates: [Vector; 2],
    /// `|r|^2` of each less the same combination of the squares of the three.
    rest: [Complex64; 2],
    gram: Factored,
}

impl Unknowns {
    fn new(x: &[Complex64]) -> Unknowns {
        let three = |at: usize| from_fn(|k| x[at + k]);
        Unknowns {
            coordinates: [three(4), three(0)],
            rest: [x[7], x[3]],
            gram: Factored { diagonal: three(8), below: three(11) },
        }
    }

    fn point(&self) -> Point {
        let receivers = self.coordinates.iter().zip(&self.rest).rev().flat_map(|(v, c)| v.iter().chain([c]));
        receivers.chain(&self.gram.diagonal).chain(&self.gram.below).copied().collect()
    }

    /// A network with the receivers but the first in this order.
    fn reordered(&self, order: &[usize; ROWS]) -> Unknowns {
        let unit = |k: usize| -> Vector { from_fn(|i| Complex64::from(f64::from(u8::from(i == k)))) };
        let [fifth, sixth] = self.coordinates;
        let all = [unit(0), unit(1), unit(2), fifth, sixth];
        let old = self.gram.matrix();
        let basis: Matrix = from_fn(|k| all[order[k]]);
        let gram: Matrix = from_fn(|i| from_fn(|j| form(&basis[i], &old, &basis[j])));
        let others = [all[order[3]], all[order[4]]];
        let coordinates = others.map(|v| coordinates(&basis, &v));
        let square = |k: usize| form(&others[k], &old, &others[k]);
        let rest = from_fn(|k| square(k) - (0..3).map(|t| coordinates[k][t] * gram[t][t]).sum::<Complex64>());
        Unknowns { coordinates, rest, gram: Factored::new(&gram) }
    }
}
