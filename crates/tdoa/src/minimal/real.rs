//! Which complex roots are real.

use super::formulation::{Formulation, Point};
use hc::refine::{Refined, Refiner};
use num_complex::Complex64;
use smallvec::SmallVec;

/// The real root near a complex one, and whether it is that very root: Newton's method from the
/// real parts stays real.
///
/// With `near > 0` a root whose offsets have imaginary parts up to `near` is given back as real
/// too, with `false`. `refined` is scratch.
pub(crate) fn real_root<F: Formulation>(
    refiner: &mut Refiner<'_, F::System>,
    target: &[Complex64],
    root: &[Complex64],
    near: f64,
    refined: &mut Refined,
) -> Option<(SmallVec<[f64; 8]>, bool)> {
    let offsets = F::offsets(target, root);
    let size = offsets.iter().map(|z| z.norm()).fold(1.0, f64::max);
    let imaginary = largest_imaginary(&offsets);
    // Newton's method decides; this only spares it the roots that are far from real. Ends of
    // ill-conditioned paths at real roots have been seen with imaginary parts above 1e-4 of their
    // size.
    if imaginary > 1e-2 * size && imaginary > near {
        return None;
    }
    // Ends of difficult paths are known to a few digits only; the last ones decide between a real
    // root and a complex pair.
    refiner.refine_into(target, root, refined);
    let root = Point::from_slice(if refined.accuracy < 1e-10 { &refined.point } else { root });
    let imaginary = largest_imaginary(&F::offsets(target, &root));
    let start: Point = root.iter().map(|z| z.re.into()).collect();
    refiner.refine_into(target, &start, refined);
    let distance = hc::distinct::relative_distance(&refined.point, &root);
    if refined.accuracy < 1e-6 && distance < 1e-7 {
        Some((refined.point.iter().map(|z| z.re).collect(), true))
    } else {
        (imaginary <= near).then(|| (root.iter().map(|z| z.re).collect(), false))
    }
}

fn largest_imaginary(offsets: &[Complex64]) -> f64 {
    // A number that is not finite is not real.
    offsets.iter().map(|z| if z.im.is_nan() { f64::INFINITY } else { z.im.abs() }).fold(0.0, f64::max)
}
