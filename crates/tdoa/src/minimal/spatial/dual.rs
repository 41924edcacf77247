//! The dual equations on four transmitters: ten receivers with four transmitters, seven and eight with
//! five.
//!
//! They are those of the plane with one dimension more (`families/10r4s.toml`): `L` takes three basis
//! vectors to `-2 (s_2 - s_1)`, `-2 (s_3 - s_1)` and `-2 (s_4 - s_1)`, its Gram matrix `G = L'L` is
//! `Z diag(1/k) Z'`, `s_1 = L b` and `u = Z'b`. A fifth transmitter is an affine combination of the others.

use super::stored::{EIGHT_FIVE, EIGHT_FIVE_FAMILY, SEVEN_FIVE, SEVEN_FIVE_FAMILY, Stored, TEN_FOUR, TEN_FOUR_FAMILY};
use super::symmetric::{Factored, Matrix, Vector, coordinates, form};
use crate::minimal::formulation::{Formulation, FormulationIn, Parameters, Point};
use crate::minimal::linear::LeastSquares;
use crate::network::Network;
use hc::Fibre;
use hc::poly::Interpreter;
use num_complex::Complex64;
use std::array::from_fn;
use std::marker::PhantomData;
use std::sync::LazyLock;

/// Transmitters that the unknowns are made of.
const BASIS: usize = 4;

/// Orders of these transmitters, that of the data first.
const CHARTS: [[usize; BASIS]; 8] =
    [[0, 1, 2, 3], [1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2], [1, 0, 3, 2], [3, 2, 1, 0], [0, 2, 3, 1], [2, 1, 0, 3]];

/// By which power of the unit of length the unknowns `p k z u`, without fifth transmitter, grow.
const WEIGHTS: [i32; 13] = [1, 1, 1, 1, -2, -2, -2, 0, 0, 0, 0, 0, 0];
/// Powers for the unknowns `g p5` of a fifth transmitter, before these.
const WEIGHTS_OF_FIVE: [i32; 17] = [0, 0, 0, 1, 1, 1, 1, 1, -2, -2, -2, 0, 0, 0, 0, 0, 0];

/// What distinguishes the sizes.
pub(crate) trait Size {
    const NAME: &'static str;
    const FAMILY: &'static str;
    const RECEIVERS: usize;
    const TRANSMITTERS: usize;
    const WEIGHTS: &'static [i32];
    fn stored() -> &'static LazyLock<Stored>;

    /// Unknowns of the fifth transmitter, if there is one.
    fn further() -> usize {
        if Self::TRANSMITTERS > BASIS { 4 } else { 0 }
    }
}

/// Ten receivers, four transmitters: 6148 paths.
pub(crate) enum TenFour {}

impl Size for TenFour {
    const NAME: &'static str = "10r/4s";
    const FAMILY: &'static str = TEN_FOUR_FAMILY;
    const RECEIVERS: usize = 10;
    const TRANSMITTERS: usize = 4;
    const WEIGHTS: &'static [i32] = &WEIGHTS;

    fn stored() -> &'static LazyLock<Stored> {
        &TEN_FOUR
    }
}

/// Seven receivers, five transmitters: 2321 paths.
pub(crate) enum SevenFive {}

impl Size for SevenFive {
    const NAME: &'static str = "7r/5s";
    const FAMILY: &'static str = SEVEN_FIVE_FAMILY;
    const RECEIVERS: usize = 7;
    const TRANSMITTERS: usize = 5;
    const WEIGHTS: &'static [i32] = &WEIGHTS_OF_FIVE;

    fn stored() -> &'static LazyLock<Stored> {
        &SEVEN_FIVE
    }
}

/// Eight receivers, five transmitters: 256 paths, to solutions of all equations but two.
pub(crate) enum EightFive {}

impl Size for EightFive {
    const NAME: &'static str = "8r/5s";
    const FAMILY: &'static str = EIGHT_FIVE_FAMILY;
    const RECEIVERS: usize = 8;
    const TRANSMITTERS: usize = 5;
    const WEIGHTS: &'static [i32] = &WEIGHTS_OF_FIVE;

    fn stored() -> &'static LazyLock<Stored> {
        &EIGHT_FIVE
    }
}

/// The formulation of a size.
pub(crate) struct Dual<S>(PhantomData<S>);

impl<S: Size> Formulation for Dual<S> {
    type System = Interpreter;
    const NAME: &'static str = S::NAME;
    const FAMILY: &'static str = S::FAMILY;
    const RECEIVERS: usize = S::RECEIVERS;
    const TRANSMITTERS: usize = S::TRANSMITTERS;
    const WEIGHTS: &'static [i32] = S::WEIGHTS;
    const CHARTS: usize = CHARTS.len();
    const MANY: bool = true;

    fn system() -> &'static Interpreter {
        S::stored().system()
    }

    fn fibre() -> Fibre {
        S::stored().fibre()
    }

    fn parameters(chart: usize, f: &[Complex64]) -> Parameters {
        let mut out = Parameters::from_slice(f);
        for (row, from) in out.chunks_exact_mut(S::TRANSMITTERS).zip(f.chunks_exact(S::TRANSMITTERS)) {
            for (to, &j) in row.iter_mut().zip(&CHARTS[chart]) {
                *to = from[j];
            }
        }
        out
    }

    fn enter(chart: usize, x: &[Complex64]) -> Point {
        Unknowns::new::<S>(x).reordered(&CHARTS[chart]).point()
    }

    fn leave(chart: usize, x: &[Complex64]) -> Point {
        let mut inverse = [0; BASIS];
        for (k, &j) in CHARTS[chart].iter().enumerate() {
            inverse[j] = k;
        }
        Unknowns::new::<S>(x).reordered(&inverse).point()
    }

    fn offsets(_: &[Complex64], x: &[Complex64]) -> Point {
        Unknowns::new::<S>(x).p
    }
}

impl<S: Size> FormulationIn<3> for Dual<S> {
    /// With `E_i` and `H = G^-1` as in the family, `r_i = diag(sqrt k) E_i`, `s_1 = diag(1 / sqrt k) u` and
    /// `s_j = s_1 - diag(1 / sqrt k) Z' e / 2`: real if every `k` is positive.
    fn network(f: &[f64], x: &[f64], _: &mut LeastSquares) -> Option<Network<3>> {
        let (fifth, rest) = x.split_at_checked(S::further())?;
        let &[p1, p2, p3, p4, k1, k2, k3, z21, z31, z32, u1, u2, u3] = rest else { return None };
        let p = [p1, p2, p3, p4];
        if !(k1 > 0.0 && k2 > 0.0 && k3 > 0.0) {
            return None;
        }
        let roots = [k1.sqrt(), k2.sqrt(), k3.sqrt()];
        let receiver = |row: &[f64]| {
            let q: [f64; BASIS] = from_fn(|j| row[j] * (row[j] - 2.0 * p[j]));
            let e1 = q[1] - q[0];
            let e2 = q[2] - q[0] - z21 * e1;
            let e3 = q[3] - q[0] - z31 * e1 - z32 * e2;
            [e1 * roots[0], e2 * roots[1], e3 * roots[2]]
        };
        let receivers = std::iter::once([0.0; 3]).chain(f.chunks_exact(S::TRANSMITTERS).map(receiver)).collect();
        let first: [f64; 3] = [u1 / roots[0], u2 / roots[1], u3 / roots[2]];
        let sides =
            [[1.0, 0.0, 0.0], [z21, 1.0, 0.0], [z31, z32, 1.0]].map(|row| from_fn(|k| -0.5 * row[k] / roots[k]));
        let plus = |a: [f64; 3], b: [f64; 3], factor: f64| from_fn(|k| a[k] + factor * b[k]);
        let mut transmitters = vec![first];
        transmitters.extend(sides.iter().map(|&side| plus(first, side, 1.0)));
        let mut offsets = p.to_vec();
        if let &[g2, g3, g4, p5] = fifth {
            offsets.push(p5);
            transmitters.push(plus(plus(plus(first, sides[0], g2), sides[1], g3), sides[2], g4));
        }
        let network = Network::new(receivers, transmitters, offsets);
        network.is_finite().then_some(network)
    }
}

/// A solution by its parts.
struct Unknowns {
    p: Point,
    k: Vector,
    z: Vector,
    u: Vector,
    /// The fifth transmitter by the differences of the others, if there is one.
    g: Option<Vector>,
}

impl Unknowns {
    fn new<S: Size>(x: &[Complex64]) -> Unknowns {
        let (fifth, rest) = x.split_at(S::further());
        let three = |from: &[Complex64], at: usize| from_fn(|i| from[at + i]);
        let p = rest[..BASIS].iter().chain(fifth.get(3)).copied().collect();
        let g = (!fifth.is_empty()).then(|| three(fifth, 0));
        Unknowns { p, k: three(rest, 4), z: three(rest, 7), u: three(rest, 10), g }
    }

    fn point(&self) -> Point {
        let (p, fifth) = self.p.split_at(BASIS);
        let parts = self.k.iter().chain(&self.z).chain(&self.u);
        self.g.iter().flatten().chain(fifth).chain(p).chain(parts).copied().collect()
    }

    /// A network with the first four transmitters in this order.
    ///
    /// The new basis is `L T` with an integer matrix `T` of determinant one or minus one, so that its Gram
    /// matrix is `T' G T` and `b` becomes `T^-1` times the new first transmitter.
    fn reordered(&self, order: &[usize; BASIS]) -> Unknowns {
        let gram = Factored { diagonal: self.k.map(|k| 1.0 / k), below: self.z };
        let b = gram.solve_transposed(&self.u);
        let matrix = gram.matrix();
        // Minus twice the displacement of a transmitter from the first, in the basis.
        let unit = |j: usize| -> Vector { from_fn(|k| Complex64::from(f64::from(u8::from(k + 1 == j)))) };
        let [first, others @ ..] = order.map(unit);
        let basis: Matrix = others.map(|other| from_fn(|k| other[k] - first[k]));
        let new = Factored::new(&from_fn(|i| from_fn(|j| form(&basis[i], &matrix, &basis[j]))));
        let start: Vector = from_fn(|k| b[k] - 0.5 * first[k]);
        let mut p = self.p.clone();
        (0..BASIS).for_each(|k| p[k] = self.p[order[k]]);
        let g = self.g.map(|g| {
            let weights = [1.0 - g[0] - g[1] - g[2], g[0], g[1], g[2]];
            from_fn(|k| weights[order[k + 1]])
        });
        Unknowns {
            p,
            k: new.diagonal.map(|d| 1.0 / d),
            z: new.below,
            u: new.transposed_times(&coordinates(&basis, &start)),
            g,
        }
    }
}
