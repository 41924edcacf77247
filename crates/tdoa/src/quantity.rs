//! Numbers and lengths in readable form.

/// A number with at most this many significant digits and no trailing zeros: `0.3`, `343`,
/// `299792458`. Powers of ten appear only below a millionth and from 10^15 on.
///
/// ```
/// use tdoa::quantity::number;
/// assert_eq!(number(0.299_999_999_999_999_8, 6), "0.3");
/// assert_eq!(number(342.8332, 6), "342.833");
/// assert_eq!(number(299_792_458.0, 6), "299792458");
/// ```
pub fn number(value: f64, digits: usize) -> String {
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    // Infinite or not a number.
    let Some(exponent) = exponent else { return value.to_string() };
    if value != 0.0 && !(-6..15).contains(&exponent) {
        return scientific;
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    // No sign before a zero.
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// A length with three significant digits in a suitable unit, from micrometres to kilometres.
///
/// ```
/// use tdoa::quantity::length;
/// assert_eq!([length(0.0172), length(0.35), length(6123.0)], ["17.2 mm", "0.35 m", "6.12 km"]);
/// ```
pub fn length(metres: f64) -> String {
    // What is rounded up to the next unit belongs to it.
    let size = metres.abs();
    let (factor, unit) = if size >= 999.5 {
        (1e-3, "km")
    } else if size >= 0.09995 || size == 0.0 || !size.is_finite() {
        (1.0, "m")
    } else if size >= 9.995e-5 {
        (1e3, "mm")
    } else {
        (1e6, "µm")
    };
    format!("{} {unit}", number(metres * factor, 3))
}

/// Number of decimals that show coordinates to a hundred thousandth of the size of the network, in
/// metres: 4 for ten metres.
pub fn decimals(size: f64) -> usize {
    if size > 0.0 && size.is_finite() { (5.0 - size.log10().floor()).clamp(1.0, 12.0) as usize } else { 4 }
}

/// A coordinate with this many decimals; zero has no sign.
pub fn coordinate(metres: f64, decimals: usize) -> String {
    let text = format!("{metres:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.parse() == Ok(0.0) => zero.to_string(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{any, prop_assert, proptest};

    #[test]
    fn numbers_for_people() {
        for (value, digits, text) in [
            (0.1 + 0.2, 6, "0.3"),
            (3.428332e2, 6, "342.833"),
            (1e-6, 3, "0.000001"),
            (1.234e-9, 3, "1.23e-9"),
            (9.9999, 3, "10"),
            (-0.0, 3, "0"),
            (1e15, 3, "1.00e15"),
            (100.0, 3, "100"),
            (f64::NAN, 3, "NaN"),
            (f64::INFINITY, 3, "inf"),
        ] {
            assert_eq!(number(value, digits), text);
        }
    }

    #[test]
    fn lengths_in_the_unit_that_suits() {
        for (metres, text) in [
            (0.0, "0 m"),
            (1.5e-7, "0.15 µm"),
            (1.6e-5, "16 µm"),
            (0.0123, "12.3 mm"),
            (0.1, "0.1 m"),
            (0.09999, "0.1 m"),
            (12.34567, "12.3 m"),
            (999.9, "1 km"),
            (-6100.0, "-6.1 km"),
        ] {
            assert_eq!(length(metres), text);
        }
    }

    #[test]
    fn coordinates_show_a_hundred_thousandth_of_the_network() {
        assert_eq!([decimals(10.0), decimals(0.017), decimals(6100.0), decimals(0.0)], [4, 7, 2, 4]);
        assert_eq!([coordinate(-0.00001, 4), coordinate(-1.25, 4)], ["0.0000", "-1.2500"]);
    }

    proptest! {
        #[test]
        fn what_is_shown_is_near(value in -1e14..1e14f64, digits in 1usize..8) {
            let shown: f64 = number(value, digits).parse().unwrap();
            prop_assert!((shown - value).abs() <= value.abs() * 0.51 * 10f64.powi(1 - digits as i32) + 1e-20);
        }

        #[test]
        fn any_double_is_shown(value in any::<f64>(), digits in 0usize..20) {
            prop_assert!(!number(value, digits).is_empty() && !length(value).is_empty());
            prop_assert!(!coordinate(value, decimals(value)).is_empty());
        }
    }
}
