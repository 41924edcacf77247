//! The Gram matrix of D + 1 receivers: three receivers with three transmitters in the plane, four with six and five with
//! five in space.
//!
//! The equations are in `families/3r3s_ranges.toml`, `4r6s_ranges.toml` and `5r5s_ranges.toml`. Parameters are the squares of
//! the ranges of these receivers; a further receiver is an affine combination of them.

use super::centred::dependence;
use crate::clocks::Emissions;
use crate::generated::{five_five_ranges, four_six_ranges, three_three_ranges};
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::minimal::normalised::Normalised;
use crate::minimal::orders::Orders;
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use hc::Fibre;
use hc::poly::Evaluate;
use num_complex::Complex64;
use num_traits::Num;
use std::array::from_fn;
use std::marker::PhantomData;

/// What distinguishes the sizes, here and [with a constant](super::constant).
pub(crate) trait Size<const D: usize>: 'static {
    type System: Evaluate + 'static;
    const NAME: &'static str;
    const FAMILY: &'static str;
    const RECEIVERS: usize;
    const TRANSMITTERS: usize;
    /// Powers of the unit, that of squares, for the unknowns; with a constant that of lengths.
    const WEIGHTS: &'static [i32];
    /// Orders of the first D + 1 receivers, that of the data first.
    const CHARTS: &'static [&'static [usize]];
    fn system() -> &'static Self::System;
    fn fibre() -> Fibre;
}

/// Defines a size.
macro_rules! define_size {
    ($doc:literal, $size:ident, $dimensions:literal, $module:ident, $file:literal, $name:literal, $m:literal, $n:literal, $weights:expr, $charts:expr) => {
        #[doc = $doc]
        pub(crate) enum $size {}

        impl Size<$dimensions> for $size {
            type System = $module::System;
            const NAME: &'static str = $name;
            const FAMILY: &'static str = include_str!(concat!("../../../families/", $file, ".toml"));
            const RECEIVERS: usize = $m;
            const TRANSMITTERS: usize = $n;
            const WEIGHTS: &'static [i32] = &$weights;
            const CHARTS: &'static [&'static [usize]] = &$charts;

            fn system() -> &'static Self::System {
                &$module::System
            }

            fn fibre() -> Fibre {
                $module::fibre()
            }
        }
    };
}

pub(super) use define_size;

define_size!(
    "Three receivers, three transmitters in the plane: 8 paths.",
    ThreeThree,
    2,
    three_three_ranges,
    "3r3s_ranges",
    "3r/3s",
    3,
    3,
    [1, 1, 0],
    IN_PLANE
);
define_size!(
    "Four receivers, six transmitters in space: 38 paths.",
    FourSix,
    3,
    four_six_ranges,
    "4r6s_ranges",
    "4r/6s",
    4,
    6,
    [1, 1, 1, 0, 0, 0],
    IN_SPACE
);
define_size!(
    "Five receivers, five transmitters in space: 42 paths.",
    FiveFive,
    3,
    five_five_ranges,
    "5r5s_ranges",
    "5r/5s",
    5,
    5,
    [1, 1, 1, 0, 0, 0],
    IN_SPACE
);

pub(super) const IN_PLANE: [&[usize]; 6] = [&[0, 1, 2], &[1, 2, 0], &[2, 0, 1], &[1, 0, 2], &[0, 2, 1], &[2, 1, 0]];
pub(super) const IN_SPACE: [&[usize]; 8] = [
    &[0, 1, 2, 3],
    &[1, 2, 3, 0],
    &[2, 3, 0, 1],
    &[3, 0, 1, 2],
    &[1, 0, 3, 2],
    &[3, 2, 1, 0],
    &[0, 2, 3, 1],
    &[2, 1, 0, 3],
];

/// The formulation of a size in D dimensions. Unknowns are the Gram matrix `M diag(e) M'` of the receivers 2 to D + 1, the
/// first one in the origin: `e`, then the entries of `M` below its diagonal of ones, by rows.
pub(crate) struct Gram<S, const D: usize>(PhantomData<S>);

impl<S: Size<D>, const D: usize> Formulation for Gram<S, D> {
    type System = S::System;
    const NAME: &'static str = S::NAME;
    const FAMILY: &'static str = S::FAMILY;
    const RECEIVERS: usize = S::RECEIVERS;
    const TRANSMITTERS: usize = S::TRANSMITTERS;
    const WEIGHTS: &'static [i32] = S::WEIGHTS;
    /// Squares of ranges, and the square `c` of a further receiver.
    const SCALED: usize = (D + 1) * S::TRANSMITTERS + S::RECEIVERS - (D + 1);
    const EMISSIONS: Emissions = Emissions::Known;
    const CHARTS: usize = S::CHARTS.len();

    fn system() -> &'static Self::System {
        S::system()
    }

    fn fibre() -> Fibre {
        S::fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        let (n, order) = (S::TRANSMITTERS, S::CHARTS[chart]);
        let (squares, rest) = f.split_at((D + 1) * n);
        let mut all: Parameters = order.iter().flat_map(|&i| &squares[i * n..(i + 1) * n]).copied().collect();
        if let [c, weights @ ..] = rest {
            all.push(*c);
            all.extend(order.iter().map(|&i| weights[i]));
        }
        all
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        reordered::<D>(S::CHARTS[chart], x)
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        reordered::<D>(&inverse(S::CHARTS[chart])[..=D], x)
    }

    /// The receiver that the others determine best comes last.
    fn orders(measured: &Pseudoranges) -> Option<Orders> {
        let mut orders = Orders::of_data(S::RECEIVERS, S::TRANSMITTERS);
        if S::RECEIVERS > D + 1 {
            let size = |x: &f64| x.abs();
            let matrix = Normalised::new(measured).matrix;
            let sizes: Vec<f64> = dependence(&matrix, S::TRANSMITTERS).iter().flatten().map(size).collect();
            let last = (0..sizes.len()).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
            last.into_iter().for_each(|last| orders.receivers.swap(last, D + 1));
        }
        Some(orders)
    }

    fn given(data: &Normalised, out: &mut Vec<f64>) {
        let n = S::TRANSMITTERS;
        let squares = data.matrix.iter().map(|f| f * f);
        out.extend(squares.clone().take((D + 1) * n));
        if S::RECEIVERS == D + 1 {
            return;
        }
        let Some(found) = dependence(&data.matrix, n) else {
            out.resize(Self::SCALED + D + 1, f64::NAN);
            return;
        };
        let weights: [f64; 4] = from_fn(|k| -found[k] / found[D + 1]);
        // The sum of the weights is one.
        let sum: f64 = squares.enumerate().map(|(k, square)| weights.get(k / n).unwrap_or(&-1.0) * square).sum();
        out.push(sum / n as f64);
        out.extend(weights);
    }

    fn offsets(_: &[Complex64], x: &[Complex64]) -> Point {
        distances::<D>(x)
    }
}

impl<S: Size<D>, const D: usize> FormulationIn<D> for Gram<S, D> {
    fn network(f: &[f64], x: &[f64], _: &mut LeastSquares) -> Option<Network<D>> {
        let n = S::TRANSMITTERS;
        if !x[..D].iter().all(|&e| e > 0.0) {
            return None;
        }
        let (mut receivers, transmitters) = placed(x, n, |i, j| f[i * n + j]);
        if let Some((_, weights)) = f[(D + 1) * n..].split_first() {
            let sum: f64 = weights.iter().sum();
            let others = || receivers.iter().zip(weights);
            receivers.push(from_fn(|k| others().map(|(r, weight)| weight * r[k]).sum::<f64>() / sum));
        }
        let network = Network::new(receivers, transmitters, vec![0.0; n]);
        network.is_finite().then_some(network)
    }
}

/// D + 1 receivers, the first one in the origin, of a Gram matrix with positive `e`, and `n` transmitters by the squares of
/// their distances from receiver `i`.
pub(super) fn placed<const D: usize>(
    x: &[f64],
    n: usize,
    square: impl Fn(usize, usize) -> f64,
) -> (Vec<[f64; D]>, Vec<[f64; D]>) {
    let triangle = triangle::<f64, D>(x);
    let basis: [[f64; D]; D] = triangle.map(|row| from_fn(|k| row[k] * x[k].sqrt()));
    let mut receivers = vec![[0.0; D]];
    receivers.extend(basis);
    let transmitter = |j: usize| {
        let mut place = [0.0; D];
        for (i, r) in basis.iter().enumerate() {
            // r . s, less what the axes before account for.
            let along = 0.5 * (r.iter().map(|x| x * x).sum::<f64>() + square(0, j) - square(i + 1, j));
            let before: f64 = (0..i).map(|k| r[k] * place[k]).sum();
            place[i] = (along - before) / r[i];
        }
        place
    };
    (receivers, (0..n).map(transmitter).collect())
}

/// The unit lower triangular matrix of the unknowns.
fn triangle<T: Num + Copy, const D: usize>(x: &[T]) -> [[T; D]; D] {
    from_fn(|i| {
        from_fn(|k| match k.cmp(&i) {
            std::cmp::Ordering::Less => x[D + i * (i - 1) / 2 + k],
            std::cmp::Ordering::Equal => T::one(),
            std::cmp::Ordering::Greater => T::zero(),
        })
    })
}

/// The Gram matrix of the unknowns.
fn matrix<T: Num + Copy, const D: usize>(x: &[T]) -> [[T; D]; D] {
    let m = triangle::<T, D>(x);
    from_fn(|i| from_fn(|j| (0..D).fold(T::zero(), |sum, k| sum + m[i][k] * x[k] * m[j][k])))
}

/// `(r_a - r_b) . (r_c - r_d)` of receivers from 0.
fn product<T: Num + Copy, const D: usize>(gram: &[[T; D]; D], [a, b]: [usize; 2], [c, d]: [usize; 2]) -> T {
    let entry = |i: usize, k: usize| if i == 0 || k == 0 { T::zero() } else { gram[i - 1][k - 1] };
    entry(a, c) - entry(a, d) - entry(b, c) + entry(b, d)
}

/// The squares of the distances of the receivers.
pub(super) fn distances<const D: usize>(x: &[Complex64]) -> Point {
    let gram = matrix::<Complex64, D>(x);
    let between = |(i, k): (usize, usize)| product(&gram, [i, k], [i, k]);
    (0..=D).flat_map(|i| (0..i).map(move |k| (i, k))).map(between).collect()
}

/// The order that undoes one of at most four nodes.
pub(super) fn inverse(order: &[usize]) -> [usize; 4] {
    let mut inverse = [0; 4];
    order.iter().enumerate().for_each(|(k, &i)| inverse[i] = k);
    inverse
}

/// The unknowns of the Gram matrix with the receivers in another order.
pub(super) fn reordered<const D: usize>(order: &[usize], x: &[Complex64]) -> Point {
    let old = matrix::<Complex64, D>(x);
    let mut rest: [[Complex64; D]; D] =
        from_fn(|i| from_fn(|j| product(&old, [order[i + 1], order[0]], [order[j + 1], order[0]])));
    let (mut diagonal, mut below) = (Point::new(), [[Complex64::ZERO; D]; D]);
    for k in 0..D {
        let e = rest[k][k];
        diagonal.push(e);
        let row = rest[k];
        for i in k + 1..D {
            below[i][k] = row[i] / e;
            (0..D).for_each(|j| rest[i][j] -= below[i][k] * row[j]);
        }
    }
    diagonal.extend((0..D).flat_map(|i| (0..i).map(move |k| (i, k))).map(|(i, k)| below[i][k]));
    diagonal
}
