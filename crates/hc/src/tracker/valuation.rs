//! How coordinates grow or vanish as `t` falls to zero.

use num_complex::Complex64;

/// Valuation of a coordinate `x ~ c t^v` from its Taylor coefficients at `t`, and how far the
/// estimate is from being constant.
///
/// `v = t Re(x' / x)`; its drift is the larger of its own logarithmic derivative and of its
/// distance to the valuation of `t x'`.
#[inline]
pub(super) fn valuation(t: f64, [x, x1, x2, x3]: [Complex64; 4]) -> (f64, f64) {
    let log_derivative = |x: Complex64, d: Complex64, dd: Complex64| {
        let size = x.norm_sqr();
        let l = (x.conj() * d).re / size;
        let slope = ((x.conj() * dd).re + d.norm_sqr()) / size - 2.0 * l * l;
        (t * l, t * (t * slope + l))
    };
    let (v, dv) = log_derivative(x, x1, 2.0 * x2);
    let (w, dw) = log_derivative(x1, 2.0 * x2, 6.0 * x3);
    let w = w + 1.0;
    let drift = (1.0 - w / v).abs().max((dv / v).abs()).max((dw / w).abs());
    (v, if drift.is_nan() { f64::INFINITY } else { drift })
}

#[cfg(test)]
mod tests {
    use super::valuation;
    use num_complex::Complex64;

    #[test]
    fn valuations_of_powers_are_exact() {
        for v in [-2.0, -0.5, 1.0 / 3.0, 1.5] {
            let t = 0.01f64;
            let c = Complex64::new(0.3, -2.0);
            let series = [
                c * t.powf(v),
                c * v * t.powf(v - 1.0),
                c * v * (v - 1.0) / 2.0 * t.powf(v - 2.0),
                c * v * (v - 1.0) * (v - 2.0) / 6.0 * t.powf(v - 3.0),
            ];
            let (found, drift) = valuation(t, series);
            assert!((found - v).abs() < 1e-12 && drift < 1e-10, "{v}: {found} {drift}");
        }
    }

    #[test]
    fn a_regular_coordinate_has_not_settled_to_a_negative_valuation() {
        // x = 1 - t
        let one = Complex64::new(1.0, 0.0);
        let (v, drift) = valuation(0.01, [one * 0.99, -one, 0.0 * one, 0.0 * one]);
        assert!(!(v + drift < -0.05 && drift < 0.01));
    }
}
