//! Points from which paths are resumed.

use num_complex::Complex64;

/// The work on a path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) accepted: usize,
    pub(super) rejected: usize,
    pub(super) jacobians: usize,
}

/// A point from which a path is resumed.
#[derive(Clone, Copy, Debug)]
pub(super) struct ResumePoint {
    pub(super) path: usize,
    pub(super) t: f64,
    /// Number of the point.
    pub(super) point: usize,
    /// The work so far.
    pub(super) counts: Counts,
}

impl ResumePoint {
    /// The start of a path, whose points are numbered as the paths are.
    pub(super) fn at_start(path: usize) -> Self {
        ResumePoint { path, t: 1.0, point: path, counts: Counts::default() }
    }
}

/// Paths to be resumed, with their points.
#[derive(Debug, Default)]
pub(super) struct ResumePoints {
    pub(super) list: Vec<ResumePoint>,
    /// One point after the other.
    pub(super) points: Vec<Complex64>,
}

impl ResumePoints {
    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.points.clear();
    }

    /// Makes room for so many paths in all, with points of `n` coordinates.
    pub(super) fn reserve(&mut self, paths: usize, n: usize) {
        self.list.reserve(paths.saturating_sub(self.list.len()));
        self.points.reserve(paths.saturating_mul(n).saturating_sub(self.points.len()));
    }

    /// Adds a path that is resumed from this point.
    pub(super) fn push(&mut self, at: ResumePoint, point: impl IntoIterator<Item = Complex64>) {
        self.points.extend(point);
        self.list.push(ResumePoint { point: self.list.len(), ..at });
    }
}
