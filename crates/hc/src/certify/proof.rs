//! What is proved about one point.

use super::certificate::{Certificate, Reality};
use poly::Interval;
use poly::{ComplexBall, ComplexDd, ComplexInterval, Scalar};

/// A proved solution: there is exactly one in `centre + large box`, and it lies in
/// `centre + small`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Proof {
    pub(super) centre: Vec<ComplexDd>,
    /// Half-widths of the large box.
    pub(super) large: Vec<f64>,
    /// The small box, relative to the centre.
    pub(super) small: Vec<ComplexInterval>,
}

impl Proof {
    /// Whether the published box, whose bounds are doubles, lies in the large box, so that it
    /// contains no other solution.
    pub(super) fn is_publishable(&self) -> bool {
        self.centre.iter().zip(&self.small).zip(&self.large).all(|((c, small), &large)| {
            let published = shifted(c, small);
            let relative =
                |part: Interval, high: f64, low: f64| part.minus(Interval::point(high)).minus(Interval::point(low));
            symmetric(large).contains_in_interior(relative(published.re, c.re.high, c.re.low))
                && symmetric(large).contains_in_interior(relative(published.im, c.im.high, c.im.low))
        })
    }

    /// The published certificate; `real` says that conjugates of solutions are solutions.
    pub(super) fn certificate(&self, real: bool) -> Certificate {
        let enclosure: Vec<ComplexInterval> = self.centre.iter().zip(&self.small).map(|(c, d)| shifted(c, d)).collect();
        let reality = if enclosure.iter().any(|z| !z.im.contains(0.0)) {
            Reality::NotReal
        } else if real && self.holds_conjugate() {
            Reality::Real
        } else {
            Reality::Undecided
        };
        let value = enclosure.iter().map(ComplexInterval::midpoint).collect();
        Certificate { value, enclosure, reality }
    }

    /// Whether the conjugate of the small box lies in the large one.
    fn holds_conjugate(&self) -> bool {
        let parts = self.centre.iter().zip(&self.small).zip(&self.large);
        parts.into_iter().all(|((c, small), &large)| {
            // Imaginary parts relative to the centre: -(c + d) - c.
            let centre = Interval::point(c.im.high).plus(Interval::point(c.im.low));
            let conjugate = centre.plus(centre).plus(small.im).negated();
            symmetric(large).contains_in_interior(conjugate) && symmetric(large).contains_in_interior(small.re)
        })
    }

    /// The small box of `other` relative to the centre of `self`.
    pub(super) fn relative(&self, other: &Proof) -> impl Iterator<Item = ComplexInterval> {
        self.centre.iter().zip(&other.centre).zip(&other.small).map(|((a, b), small)| {
            let difference = ComplexBall::sub(&ComplexBall::point(b), &ComplexBall::point(a)).interval();
            ComplexInterval::add(&difference, small)
        })
    }

    /// Whether the solution of `other`, in its small box, lies in the large box of this proof and
    /// is therefore the same.
    pub(super) fn holds(&self, other: &Proof) -> bool {
        let large = self.large.iter().map(|&r| symmetric(r));
        large.zip(self.relative(other)).all(|(l, z)| l.contains_in_interior(z.re) && l.contains_in_interior(z.im))
    }

    /// Whether the small boxes have a point in common.
    pub(super) fn meets(&self, other: &Proof) -> bool {
        self.small.iter().zip(self.relative(other)).all(|(a, b)| a.meets(&b))
    }
}

pub(super) fn symmetric(r: f64) -> Interval {
    Interval { low: -r, high: r }
}

/// The box `centre + offset`, rounded outward.
pub(super) fn shifted(centre: &ComplexDd, offset: &ComplexInterval) -> ComplexInterval {
    let part = |high: f64, low: f64, d: Interval| Interval::point(high).plus(Interval::point(low).plus(d));
    ComplexInterval {
        re: part(centre.re.high, centre.re.low, offset.re),
        im: part(centre.im.high, centre.im.low, offset.im),
    }
}
