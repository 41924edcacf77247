//! Part of docs/results.md: clocks.

use super::super::table::{Row, head};
use super::space::{cells, lines};
use anyhow::Result;
use std::path::Path;

/// Clocks of every kind beside the Cramer-Rao bound.
pub(super) fn clocks(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Rooms as above, noise of 0.01 m, which is not given, 10 % missing, 5 % gross errors. Recorders' offsets have a standard deviation of 1 km of \
         sound, rates 20 parts in a million over ten minutes, of which nothing is said but in `rates-expected`; `-2` and `-4` are recorders of two and \
         four channels, `ranges-offsets` ranges with a constant of each receiver, `schedule` a pinger whose \
         times are known by its own clock. In the last three cases clocks are simpler than the model. The bound \
         is that of the model. Seconds are processor seconds, median; `common` is the model of receivers that share a clock.\n\n",
    );
    text += &head(&[
        "",
        "dimensions",
        "size",
        "networks",
        "within three bounds",
        "called unique",
        "beyond and unique",
        "error over bound within",
        "s",
    ]);
    let columns = [
        "case",
        "dimensions",
        "configuration",
        "networks",
        "within_three_bounds",
        "unique",
        "beyond_and_unique",
        "rms_over_bound_within",
        "processor_seconds_median",
    ];
    Ok(text + &lines(results, &["clocks"], |row: &Row<'_>| cells(row, &columns))?)
}
