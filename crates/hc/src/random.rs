//! Random numbers: every stream has a seed and a number, and does not depend on threads.

use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The purpose of random numbers. Streams of one seed for different purposes, or attempts, share no
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Stream {
    /// A random member of a family and a point, by attempt.
    Member(u64),
    /// Coefficients and lifting of a polyhedral start system, by attempt.
    Polyhedral(u64),
    /// Coefficients of a total degree start system, by attempt.
    TotalDegree(u64),
    /// Linear forms of a multihomogeneous start system, by attempt.
    Multihomogeneous(u64),
    /// Hyperplanes that tell points on components from others, by attempt.
    Slice(u64),
    /// Points beside a point whose neighbourhood is searched.
    Beside,
    /// Combinations of the equations of an overdetermined system.
    Combinations,
    /// Conditions on the null vectors that serve as further unknowns.
    Multipliers,
    /// Hyperplanes through a point, which show that it lies on a component.
    Through,
    /// Directions in which a solution is left, to see whether Newton's method returns.
    Perturbation,
    /// Changes of the parameters, to see how far rounding them moves a solution.
    Rounding,
    /// Points at which the sizes of formulas are measured.
    Sizes,
    /// The line of a trace test.
    Trace,
    /// The parameters of a loop of monodromy, by number.
    Loop(u64),
    /// A point of parameters through which a detour leads, by number.
    Detour(u64),
    /// Parameters at which it is seen whether a solution is one for all.
    Elsewhere,
    /// Products of permutations.
    Products,
    /// Primes, modulo which exact numbers have images.
    Primes,
}

impl Stream {
    /// Its number; the numbers of purposes that have few attempts lie between each other, sixteen
    /// apart.
    fn number(self) -> u64 {
        let between = |first: u64, attempt: u64| attempt.wrapping_mul(16).wrapping_add(first);
        let from = |first: u64, k: u64| k.wrapping_add(first);
        match self {
            Stream::Member(k) => between(0, k),
            Stream::Polyhedral(k) => between(1, k),
            Stream::TotalDegree(k) => between(2, k),
            Stream::Multihomogeneous(k) => between(3, k),
            Stream::Slice(k) => between(7, k),
            Stream::Detour(k) => between(9, k),
            Stream::Rounding => 4,
            Stream::Elsewhere => 14,
            Stream::Products => 15,
            Stream::Perturbation => 6,
            Stream::Combinations => 11,
            Stream::Beside => 13,
            Stream::Multipliers => 8,
            Stream::Through => 10,
            Stream::Sizes => 12,
            Stream::Primes => 16 + 4,
            Stream::Trace => 0x7ACE,
            Stream::Loop(k) => from(1 << 32, k),
        }
    }
}

/// What the coordinates of short numbers are multiples of the reciprocal of.
const SHORT: f64 = 16_777_216.0;

/// A stream of generic complex numbers.
pub struct Random(Pcg64);

impl Random {
    /// The stream of a seed with this number. Streams of one seed with different numbers share no
    /// numbers. Take numbers below 2^32 that leave 5 when divided by 16: this crate has no such
    /// stream of its own.
    ///
    /// ```
    /// use hc::random::Random;
    /// assert_eq!(Random::new(1, 5).normals(3), Random::new(1, 5).normals(3));
    /// assert_ne!(Random::new(1, 5).unit(), Random::new(1, 21).unit());
    /// ```
    pub fn new(seed: u64, number: u64) -> Self {
        let mixed = seed ^ number.wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(17);
        Random(Pcg64::seed_from_u64(mixed))
    }

    /// The stream of a seed for a purpose of this crate.
    pub(crate) fn of(seed: u64, stream: Stream) -> Self {
        Random::new(seed, stream.number())
    }

    /// A complex standard normal number: `E |z|^2 = 1`.
    pub fn normal(&mut self) -> Complex64 {
        // Box and Muller; 1 - u lies in (0, 1].
        let radius = (-(1.0 - self.0.random::<f64>()).ln()).sqrt();
        Complex64::from_polar(radius, std::f64::consts::TAU * self.0.random::<f64>())
    }

    /// A point on the unit circle.
    pub fn unit(&mut self) -> Complex64 {
        Complex64::from_polar(1.0, std::f64::consts::TAU * self.0.random::<f64>())
    }

    /// A point near the unit circle whose coordinates have at most 24 digits: sums of several such
    /// points, and of their multiples, are exact.
    pub(crate) fn short_unit(&mut self) -> Complex64 {
        let Complex64 { re, im } = self.unit();
        let short = |x: f64| (x * SHORT).round() / SHORT;
        Complex64::new(short(re), short(im))
    }

    /// An integer from zero up to, but not including, a bound.
    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        self.0.random_range(0..bound)
    }

    /// Independent complex standard normal numbers.
    pub fn normals(&mut self, len: usize) -> Vec<Complex64> {
        (0..len).map(|_| self.normal()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Stream;
    use std::collections::HashSet;

    #[test]
    fn purposes_share_no_stream() {
        let single = [
            Stream::Combinations,
            Stream::Beside,
            Stream::Perturbation,
            Stream::Rounding,
            Stream::Trace,
            Stream::Elsewhere,
            Stream::Products,
            Stream::Primes,
        ];
        let mut numbers = HashSet::from(single.map(Stream::number));
        for attempt in 0..60 {
            let purposes = [
                Stream::Member,
                Stream::Polyhedral,
                Stream::TotalDegree,
                Stream::Multihomogeneous,
                Stream::Slice,
                Stream::Loop,
                Stream::Detour,
            ];
            for purpose in purposes {
                let number = purpose(attempt).number();
                assert!(numbers.insert(number), "{:?}", purpose(attempt));
                // Those are left to others.
                assert!(number >= 1 << 32 || number % 16 != 5, "{:?}", purpose(attempt));
            }
        }
        assert!((60..100_000).all(|k| numbers.insert(Stream::Loop(k).number())));
    }
}
