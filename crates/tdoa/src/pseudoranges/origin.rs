//! From when on measurements count that are moments.

/// What kind of moments they are: those of one kind can be subtracted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum TimeScale {
    /// Times of some day.
    OfDay,
    /// Dates and times, of a zone that is not said.
    Local,
    /// Dates and times with their zone.
    Universal,
}

/// A whole second from which moments count.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct TimeOrigin {
    /// Since 1970, or since midnight.
    pub(crate) seconds: i64,
    pub(crate) scale: TimeScale,
}
