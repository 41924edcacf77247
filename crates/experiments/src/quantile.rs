//! Quantiles of measured numbers.

/// The value below which this share of the numbers lies; not a number for none.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len() as f64) as usize;
    sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
}

/// The middle one of the numbers; of an even number of them the larger of the two in the middle.
pub(crate) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::{median, quantile};

    #[test]
    fn of_five_numbers() {
        let values = [3.0, 1.0, 2.0, 5.0, 4.0];
        assert_eq!((median(&values), quantile(&values, 0.99), quantile(&values, 1.0)), (3.0, 5.0, 5.0));
        assert_eq!(median(&values[..4]), 3.0);
        assert!(median(&[]).is_nan());
    }
}
