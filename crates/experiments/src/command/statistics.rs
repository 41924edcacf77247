//! Sums over trials.

/// Least, largest, mean and standard deviation of some numbers, of which there must be one at
/// least.
pub(super) fn moments(values: &[f64]) -> [f64; 4] {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [least, largest, mean, variance.sqrt()]
}

/// Mean of the numbers that are numbers; not a number for none.
pub(super) fn mean(values: &[f64]) -> f64 {
    let known: Vec<f64> = values.iter().copied().filter(|v| !v.is_nan()).collect();
    known.iter().sum::<f64>() / known.len() as f64
}

/// Half-decade bins of the logarithm to base ten, from 1e-17 to 1e1: how many of the values fall
/// into each, as shares of all. What lies outside (zero, infinity) counts in the first and the
/// last.
pub(super) fn decades(values: &[f64]) -> Vec<(f64, f64)> {
    const BINS: usize = 36;
    let mut counts = [0usize; BINS];
    for value in values {
        let bin = ((value.log10() + 17.0) * 2.0).floor();
        counts[if bin.is_nan() { BINS - 1 } else { bin.clamp(0.0, BINS as f64 - 1.0) as usize }] += 1;
    }
    let all = values.len().max(1) as f64;
    counts.iter().enumerate().map(|(k, &count)| (k as f64 / 2.0 - 17.0, count as f64 / all)).collect()
}

/// A number in a table: four significant digits, short.
pub(super) fn short(value: f64) -> String {
    if value.is_nan() {
        return String::new();
    }
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        let digits = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize };
        let text = format!("{value:.digits$}");
        return if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text };
    }
    format!("{value:.2e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_five_numbers() {
        let values = [3.0, 1.0, 2.0, 5.0, 4.0];
        // Squares of the differences from 3 add up to 10, over four.
        assert_eq!(moments(&values), [1.0, 5.0, 3.0, 2.5f64.sqrt()]);
        assert_eq!(mean(&[1.0, f64::NAN, 3.0]), 2.0);
    }

    #[test]
    fn bins_by_half_decades() {
        let bins = decades(&[1e-14, 2e-14, 5e-14, 0.0, f64::INFINITY]);
        assert_eq!(bins.len(), 36);
        assert_eq!((bins[0].1, bins[6], bins[7].1, bins[35].1), (0.2, (-14.0, 0.4), 0.2, 0.2));
    }

    #[test]
    fn short_numbers() {
        let texts = [0.0, 1.0, 0.99512, 12.3456, 1234.6, 6.2e-15, 0.00123456, f64::NAN].map(short);
        assert_eq!(texts, ["0", "1", "0.9951", "12.35", "1235", "6.20e-15", "0.001235", ""]);
    }
}
