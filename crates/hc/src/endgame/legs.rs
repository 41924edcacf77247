//! Straight legs in logarithmic time `s = -ln t`, along the radius or round the origin of the plane
//! of `t`.

use crate::homotopy::{ParameterPath, Segment};
use num_complex::Complex64;
use poly::{ComplexDd, Lane};
use std::f64::consts::TAU;

/// The way of a path in the parameters `target + t direction` of a segment. On it the tracker's own time `u`
/// goes from 1 to 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leg {
    /// Along the radius, from the first value of `s` to the second.
    Radial([f64; 2]),
    /// Once round the circle of this `s`, clockwise, in so many pieces.
    Turn(f64, usize),
    /// Straight from this `t` to zero.
    Home(f64),
}

impl Leg {
    /// `t` at this `u`.
    pub(super) fn at(self, u: f64) -> Complex64 {
        self.time(u)[0]
    }

    /// The number of pieces, each of which ends at a sample.
    fn pieces(self) -> usize {
        if let Leg::Turn(_, pieces) = self { pieces } else { 1 }
    }

    /// Taylor coefficients of `t` at `u`.
    fn time(self, u: f64) -> [Complex64; 4] {
        let zero = Complex64::new(0.0, 0.0);
        let [from, to] = match self {
            Leg::Home(t) => return [(t * u).into(), t.into(), zero, zero],
            Leg::Radial(ends) => ends.map(Complex64::from),
            Leg::Turn(s, _) => [0.0, TAU].map(|angle| Complex64::new(s, angle)),
        };
        // t = exp(-s(u)), s(u) = to - (to - from) u.
        let rate = to - from;
        let value = (rate * u - to).exp();
        [value, value * rate, value * rate * rate / 2.0, value * rate * rate * rate / 6.0]
    }
}

/// One leg per path.
pub(super) struct Legs<'a> {
    pub(super) segment: &'a Segment,
    pub(super) legs: Vec<Leg>,
}

impl Legs<'_> {
    /// The parameters on a leg, where its time is `u`, in double-double: where the Jacobian is nearly
    /// singular, rounding errors of the parameters would show in the samples.
    pub(super) fn precise(&self, leg: usize, u: f64, p: &mut Vec<ComplexDd>) {
        p.resize(self.segment.parameters(), ComplexDd::default());
        self.segment.extended(&ComplexDd::new(self.legs[leg].at(u)), p);
    }
}

impl ParameterPath for Legs<'_> {
    fn parameters(&self) -> usize {
        self.segment.parameters()
    }

    fn pieces(&self, leg: usize) -> usize {
        self.legs[leg].pieces()
    }

    fn is_exponential(&self, leg: usize) -> bool {
        !matches!(self.legs[leg], Leg::Home(_))
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, paths: &[usize], u: &S::Real, p: &mut [S]) {
        let m = self.parameters();
        let mut t = [S::zero(); 4];
        for (l, (&path, &u)) in paths.iter().zip(u.as_ref()).enumerate() {
            for (t, value) in t.iter_mut().zip(self.legs[path].time(u)) {
                t.set(l, value);
            }
        }
        for (i, (target, direction)) in self.segment.target().iter().zip(self.segment.direction()).enumerate() {
            let direction = S::from_c64(*direction);
            p[i] = S::mul_add(&direction, &t[0], &S::from_c64(*target));
            for order in 1..4 {
                p[order * m + i] = S::mul(&direction, &t[order]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Leg, Legs};
    use crate::homotopy::{ParameterPath, Segment};
    use num_complex::Complex64;
    use std::f64::consts::TAU;

    /// Against differences of the parameters themselves.
    #[test]
    fn taylor_coefficients_are_those_of_the_leg() {
        let z = Complex64::new;
        let segment = Segment::new(&[z(1.0, 2.0)], &[z(-0.5, 0.3)]);
        let legs = Legs { segment: &segment, legs: vec![Leg::Radial([3.0, 3.5]), Leg::Turn(3.0, 8), Leg::Home(0.1)] };
        let at = |leg: usize, u: f64| {
            let mut p = [z(0.0, 0.0); 4];
            legs.coefficients::<Complex64>(&[leg], &[u], &mut p);
            p
        };
        let ends = [[(1.0, z(3.0, 0.0)), (0.0, z(3.5, 0.0))], [(1.0, z(3.0, 0.0)), (0.75, z(3.0, TAU / 4.0))]];
        for (leg, (u, s)) in ends.into_iter().enumerate().flat_map(|(leg, ends)| ends.map(|end| (leg, end))) {
            let end = segment.target()[0] + segment.direction()[0] * (-s).exp();
            assert!((at(leg, u)[0] - end).norm() < 1e-15, "{leg}: {u}");
        }
        assert_eq!([0, 1, 2].map(|leg| legs.pieces(leg)), [1, 8, 1]);
        for leg in 0..3 {
            let (p, h) = (at(leg, 0.4), 1e-3);
            let sum = p[0] + p[1] * h + p[2] * (h * h) + p[3] * (h * h * h);
            assert!((at(leg, 0.4 + h)[0] - sum).norm() < 1e-11, "{leg}");
        }
    }
}
