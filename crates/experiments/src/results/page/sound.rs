//! Part of docs/results.md: recordings that are simulated.

use super::super::table::{Row, head};
use super::space::{cells, lines};
use anyhow::Result;
use std::path::Path;

/// What is heard in simulated rooms, and how far the network is off.
pub(super) fn sound(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Ten microphones and twenty claps (bursts of noise of 8 ms) in a room of 8 m by 6 m by 3 m whose echoes decay by 60 dB in the time given, by the \
         image method, with white noise: `tdoa listen` and then `tdoa calibrate`, without options. Chirps are from 1 to 6 kHz, and known. Recorders of two \
         channels were started up to a minute apart, with rates up to 20 parts in a million off. Arrivals are wrong if they are more than 30 us from the truth, but \
         for what all channels of an event have in common; the median is that of rooms. Receivers are compared after the best rigid alignment, root \
         mean square; three millimetres are asked.\n\n",
    );
    text += &head(&[
        "",
        "rooms",
        "sounds",
        "found",
        "false",
        "arrivals heard",
        "wrong",
        "median error, us",
        "receivers within 3 mm",
        "median, mm",
        "called unique",
        "beyond and unique",
    ]);
    let columns = [
        "case",
        "rooms",
        "sounds",
        "found",
        "false_events",
        "heard_share",
        "wrong_share",
        "median_us",
        "within_3_mm",
        "error_mm_median",
        "unique",
        "beyond_and_unique",
    ];
    Ok(text + &lines(results, &["sound"], |row: &Row<'_>| cells(row, &columns))?)
}
