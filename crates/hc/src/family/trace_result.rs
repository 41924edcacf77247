//! What a trace test found.

use crate::tolerances::FAMILIES;
use serde::{Deserialize, Serialize};

/// What the trace test found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct TraceTest {
    /// Deviation of the sum of the points from linear motion, relative to the deviations of the
    /// single points. It is rounding error if the fibre is whole, and of the order of one if a
    /// point is missing.
    pub deviation: f64,
    /// Points of the fibre that were counted after the further points had been added.
    pub fibre: usize,
    /// Number of further points.
    pub further: usize,
    /// Whether every path of the test ended well; otherwise the deviation means nothing.
    pub complete: bool,
}

impl TraceTest {
    /// Whether the test shows that a fibre of `len` points is whole: it has a
    /// [result](Self::result), and the result is below 1e-18.
    pub fn passed(&self, len: usize) -> bool {
        self.result(len).is_some_and(|deviation| deviation < FAMILIES.trace_passed)
    }

    /// The deviation for a fibre of `len` points, if it means something: every path ended well, and
    /// exactly these points were found on the fibre.
    pub fn result(&self, len: usize) -> Option<f64> {
        (self.complete && self.fibre == len && self.deviation.is_finite()).then_some(self.deviation)
    }
}
