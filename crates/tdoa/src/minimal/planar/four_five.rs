//! Four receivers, five transmitters: 344 paths, in the Gram matrix of the receivers.

use crate::generated::four_five as generated;
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::network::Network;
use hc::Fibre;
use num_complex::Complex64;
use num_traits::Num;
use smallvec::smallvec;

/// Receivers.
const ROWS: usize = 4;
/// Transmitters.
const COLUMNS: usize = 5;
/// `alpha beta e l h C`: ratios, then `e`, `h` and `C` squares of lengths.
const WEIGHTS: &[i32] = &[0, 0, 2, 0, 2, 2];

/// Orders of the receivers, that of the data first: each receiver is once the origin and once the
/// one expressed by the others, with both directions of elimination.
const CHARTS: [[usize; ROWS]; 8] =
    [[0, 1, 2, 3], [1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2], [0, 2, 1, 3], [1, 3, 2, 0], [2, 0, 3, 1], [3, 1, 0, 2]];

/// The formulation; the equations are in `families/4r5s.toml`.
pub(crate) struct FourFive;

impl Formulation for FourFive {
    type System = generated::System;
    const NAME: &'static str = "4r/5s";
    const FAMILY: &'static str = include_str!("../../../families/4r5s.toml");
    const RECEIVERS: usize = ROWS;
    const TRANSMITTERS: usize = COLUMNS;
    const WEIGHTS: &'static [i32] = WEIGHTS;
    const CHARTS: usize = CHARTS.len();

    fn system() -> &'static Self::System {
        &generated::System
    }

    fn fibre() -> Fibre {
        generated::fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        let row = |i: usize, j: usize| if i == 0 { Complex64::new(0.0, 0.0) } else { f[(i - 1) * COLUMNS + j] };
        let order = CHARTS[chart];
        order[1..].iter().flat_map(|&i| (0..COLUMNS).map(move |j| row(i, j) - row(order[0], j))).collect()
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        reorder(&CHARTS[chart], x)
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        let mut inverse = [0; ROWS];
        for (k, &i) in CHARTS[chart].iter().enumerate() {
            inverse[i] = k;
        }
        reorder(&inverse, x)
    }

    fn offsets(f: &[Complex64], x: &[Complex64]) -> Point {
        (0..COLUMNS).map(|j| Sight::new(f, x, j).p()).collect()
    }
}

impl FormulationIn for FourFive {
    fn network(f: &[f64], x: &[f64], _: &mut LeastSquares) -> Option<Network> {
        let &[alpha, beta, e, l, h, _] = x else { return None };
        if !(e > 0.0 && h > 0.0) {
            return None;
        }
        let (root_e, root_h) = (e.sqrt(), h.sqrt());
        let (r2, r3) = ([root_e, 0.0], [l * root_e, root_h]);
        let r4 = [alpha * r2[0] + beta * r3[0], beta * r3[1]];
        let (transmitters, offsets) = (Vec::with_capacity(COLUMNS), Vec::with_capacity(COLUMNS));
        let mut network = Network::new(vec![[0.0, 0.0], r2, r3, r4], transmitters, offsets);
        for j in 0..COLUMNS {
            let sight = Sight::new(f, x, j);
            let p = sight.p();
            // r_2 . s and r_3 . s
            let (along, across) =
                (0.5 * (e - sight.a * (sight.a - 2.0 * p)), { 0.5 * (e * l * l + h - sight.b * (sight.b - 2.0 * p)) });
            network.transmitters.push([along / root_e, (across - l * along) / root_h]);
            network.offsets.push(p);
        }
        network.is_finite().then_some(network)
    }
}

/// What one transmitter says of `p_j = n / (2 d)`.
struct Sight<T> {
    a: T,
    b: T,
    n: T,
    d: T,
}

impl<T: Num + Copy> Sight<T> {
    fn new(f: &[T], x: &[T], j: usize) -> Self {
        let [a, b, c] = [0, 1, 2].map(|i| f[i * COLUMNS + j]);
        let (alpha, beta, gap) = (x[0], x[1], x[5]);
        Sight { a, b, n: alpha * a * a + beta * b * b - c * c + gap, d: alpha * a + beta * b - c }
    }

    fn p(&self) -> T {
        self.n / (self.d + self.d)
    }
}

/// The unknowns with the receivers in another order: the Gram matrix of the new basis, and the
/// fourth receiver in it.
fn reorder(order: &[usize; ROWS], x: &[Complex64]) -> Point {
    let &[alpha, beta, e, l, h, _] = x else { return smallvec![Complex64::new(f64::NAN, 0.0); WEIGHTS.len()] };
    let (zero, one) = (Complex64::new(0.0, 0.0), Complex64::new(1.0, 0.0));
    let receivers = [[zero, zero], [one, zero], [zero, one], [alpha, beta]];
    let origin = receivers[order[0]];
    let [u, v, w] = [1, 2, 3].map(|k| [0, 1].map(|c| receivers[order[k]][c] - origin[c]));
    // Products of vectors given in the basis r_2, r_3: e (1, l; l, l^2) + h (0, 0; 0, 1).
    let dot = |s: [Complex64; 2], t: [Complex64; 2]| e * (s[0] + l * s[1]) * (t[0] + l * t[1]) + h * s[1] * t[1];
    let det = u[0] * v[1] - u[1] * v[0];
    let alpha_new = (w[0] * v[1] - w[1] * v[0]) / det;
    let beta_new = (u[0] * w[1] - u[1] * w[0]) / det;
    let e_new = dot(u, u);
    let gap = dot(w, w) - alpha_new * e_new - beta_new * dot(v, v);
    smallvec![alpha_new, beta_new, e_new, dot(u, v) / e_new, e * h * det * det / e_new, gap]
}
