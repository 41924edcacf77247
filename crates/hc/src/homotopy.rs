//! Homotopies `H(x, t) = F(x; p(t))`: a system and a path in its parameters, from `t = 1` (start)
//! to `t = 0` (target).
//!
//! Every homotopy of this crate has this form: the straight line, the parameter, coefficient and
//! toric homotopies differ only in their [`ParameterPath`].

use num_complex::Complex64;
use poly::simd::{Isa, Kernel};
use poly::{ComplexDd, Lane, Scalar};

/// A path `p(t)`, `t` from 1 to 0, in the parameters of a system.
pub trait ParameterPath: Send + Sync {
    /// Number of parameters `m`.
    fn parameters(&self) -> usize;

    /// Taylor coefficients of orders 0 to 3 at `t` (one `t` per lane): `p[k * m + i]` is
    /// coefficient `k` of parameter `i`.
    ///
    /// `paths` holds the index of the path in each lane, for homotopies that differ from path to
    /// path. A lane without a path has the index of some other lane. This is called inside a
    /// kernel: implementations are `#[inline(always)]`.
    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]);

    /// Replaces the parameters at `t` of one path, rounded to double precision, by their values in
    /// double-double.
    ///
    /// A point with a Jacobian of condition `c` moves by `c` times the rounding error of the
    /// parameters. This spoils the predictor's picture of the path long before Newton's method
    /// fails. By default the parameters stay rounded.
    fn extend(&self, _path: usize, _t: f64, _p: &mut [ComplexDd]) {}

    /// Whether coefficients of orders 2 and 3 are zero everywhere. Taylor coefficients then cost
    /// less.
    fn is_straight(&self) -> bool {
        false
    }

    /// Whether the coordinates of a path behave like powers of `e`, as in logarithmic time near its end. The
    /// tracker then predicts their logarithms.
    fn is_exponential(&self, _path: usize) -> bool {
        false
    }

    /// Into how many equal pieces of its time the way of a path is cut. The tracker also records the path
    /// where a piece ends, and allows it so many times the steps. By default there is one piece.
    fn pieces(&self, _path: usize) -> usize {
        1
    }
}

/// The straight segment from `start` (at `t = 1`) to `target` (at `t = 0`).
#[derive(Clone, Debug, Default)]
pub struct Segment {
    target: Vec<Complex64>,
    direction: Vec<Complex64>,
}

impl Segment {
    /// Joins two parameter points of equal length.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn new(start: &[Complex64], target: &[Complex64]) -> Self {
        let mut segment = Segment { target: Vec::new(), direction: Vec::new() };
        segment.join(start, target);
        segment
    }

    /// [`new`](Self::new), with the memory of an earlier segment.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn join(&mut self, start: &[Complex64], target: &[Complex64]) {
        assert_eq!(start.len(), target.len(), "both ends of a segment have the same number of parameters");
        self.target.clear();
        self.target.extend_from_slice(target);
        self.direction.clear();
        self.direction.extend(start.iter().zip(target).map(|(s, t)| s - t));
    }

    /// The parameters at `t = 0`.
    pub fn target(&self) -> &[Complex64] {
        &self.target
    }

    /// The derivative of the parameters by `t`.
    pub fn direction(&self) -> &[Complex64] {
        &self.direction
    }

    /// Writes the parameters at `t`, real or complex, in the numbers of `t` into `p`, one entry per
    /// parameter.
    pub fn extended<S: Scalar>(&self, t: &S, p: &mut [S]) {
        Isa::detect().run(Extended { segment: self, t, p });
    }
}

/// The parameters of a segment in other numbers than doubles.
struct Extended<'a, S> {
    segment: &'a Segment,
    t: &'a S,
    p: &'a mut [S],
}

impl<S: Scalar> Kernel for Extended<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        for ((p, target), direction) in self.p.iter_mut().zip(&self.segment.target).zip(&self.segment.direction) {
            *p = S::mul_add(&S::from_c64(*direction), self.t, &S::from_c64(*target));
        }
    }
}

impl ParameterPath for Segment {
    fn parameters(&self) -> usize {
        self.target.len()
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, _: &[usize], t: &S::Real, p: &mut [S]) {
        let m = self.target.len();
        for i in 0..m {
            let direction = S::from_c64(self.direction[i]);
            p[i] = S::add(&S::from_c64(self.target[i]), &direction.scale_by(t));
            p[m + i] = direction;
        }
        p[2 * m..4 * m].fill(S::zero());
    }

    fn extend(&self, _: usize, t: f64, p: &mut [ComplexDd]) {
        self.extended(&ComplexDd::new(t.into()), p);
    }

    fn is_straight(&self) -> bool {
        true
    }
}
