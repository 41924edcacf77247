//! The sizes by which coordinates, and errors in them, are measured.

use num_complex::Complex64;
use poly::{Lane, Lanes8};

/// Squared sizes of the coordinates, none below 1e-4 of the largest.
pub(super) fn weights(x: &[Complex64], squares: &mut Vec<[f64; 1]>) {
    let largest = x.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    squares.clear();
    squares.extend(x.iter().map(|z| [weight_sqr(z.norm_sqr(), largest)]));
}

/// The square of the size of a coordinate as a weight, from its square and that of the largest.
pub(super) fn weight_sqr(square: f64, largest: f64) -> f64 {
    square.max(if largest > 0.0 { 1e-8 * largest } else { 1.0 })
}

/// Squared sizes of the coordinates; those below 1e-12 of the largest, or of one if that is less,
/// count as zero, which is measured on the scale of 1e-4 of that.
pub(super) fn sizes(x: &[Complex64], squares: &mut Vec<[f64; 1]>) {
    let largest = x.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    squares.clear();
    squares.extend(x.iter().map(|z| [size_sqr(z.norm_sqr(), largest)]));
}

/// The square of the [size](size) of a coordinate, from its square and that of the largest.
pub(super) fn size_sqr(square: f64, largest: f64) -> f64 {
    measured(square, largest, 1e-24, 1e-8)
}

/// The size by which refinement measures a coordinate of absolute value `norm`, `largest` that of the
/// largest coordinate: the root of what [`sizes`] gives.
pub(crate) fn size(norm: f64, largest: f64) -> f64 {
    measured(norm, largest, 1e-12, 1e-4)
}

/// `size`, or `scale` where it is below `zero`, both in units of the largest or of one if that is less.
fn measured(size: f64, largest: f64, zero: f64, scale: f64) -> f64 {
    let unit = if largest > 0.0 { largest.min(1.0) } else { 1.0 };
    if size > zero * unit { size } else { scale * unit }
}

/// Squares of sizes, coordinate by coordinate, from their own squares and that of the largest.
pub(super) fn measure(x: &[Lanes8], squares: &mut [<Lanes8 as Lane>::Real], size_sqr: impl Fn(f64, f64) -> f64) {
    let mut largest = Lanes8::real(0.0);
    for (x, square) in x.iter().zip(&mut *squares) {
        *square = x.norm_sqr();
        largest = Lanes8::real_max(square, &largest);
    }
    for (square, largest) in squares.iter_mut().flat_map(|square| square.as_mut().iter_mut().zip(largest.as_ref())) {
        *square = size_sqr(*square, *largest);
    }
}
