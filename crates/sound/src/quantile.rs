//! Numbers that a share of others is below.

/// The median of the amounts of a normal variable of standard deviation 1.
pub(crate) const MEDIAN: f64 = 0.6745;

/// The number that this share of all, 0 to 1, is below: on a line between two of them (R. J. Hyndman and Y. Fan, Sample
/// quantiles in statistical packages, The American Statistician 50, 1996, definition 7), so that half gives the median, in
/// the middle of the middle two of an even number. `None` of none.
pub(crate) fn quantile(mut all: Vec<f64>, share: f64) -> Option<f64> {
    let last = all.len().checked_sub(1)?;
    let place = share * last as f64;
    let (_, &mut lower, above) = all.select_nth_unstable_by((place as usize).min(last), f64::total_cmp);
    let upper = above.iter().copied().min_by(f64::total_cmp);
    // Of infinite ones there is no difference.
    let upper = upper.filter(|upper| place.fract() > 0.0 && *upper > lower);
    Some(upper.map_or(lower, |upper| lower + place.fract() * (upper - lower)))
}

#[cfg(test)]
mod tests {
    use super::quantile;

    #[test]
    fn shares_of_few_numbers() {
        for (all, share, expected) in [
            (&[][..], 0.5, None),
            (&[7.0], 0.9, Some(7.0)),
            (&[3.0, 1.0], 0.5, Some(2.0)),
            (&[5.0, 1.0, 3.0], 0.5, Some(3.0)),
            (&[4.0, 1.0, f64::INFINITY, 2.0], 0.5, Some(3.0)),
            (&[f64::INFINITY, 1.0, 2.0], 0.5, Some(2.0)),
            (&[f64::INFINITY, 1.0, 2.0], 1.0, Some(f64::INFINITY)),
            // Five numbers have four steps, of which 0.9 is 3.6.
            (&[5.0, 4.0, 3.0, 2.0, 1.0], 0.9, Some(4.6)),
            (&[2.0, 3.0], 0.0, Some(2.0)),
            (&[f64::INFINITY, f64::INFINITY], 0.5, Some(f64::INFINITY)),
        ] {
            assert_eq!(quantile(all.to_vec(), share), expected, "{all:?}");
        }
    }
}
