//! Settings of the minimal solvers.

use crate::clocks::Emissions;
use hc::family::FibreOptions;

/// Settings of the minimal solvers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MinimalOptions {
    /// What is known of the times at which transmitters send. With [`Emissions::Known`] measurements are ranges, and
    /// offsets are zero; with [`Emissions::Constant`] all are one. Default [`Emissions::Unknown`].
    pub emissions: Emissions,
    /// How far below zero a distance f_ij - o_j may lie if a candidate is to count as physical,
    /// relative to the size of the data (root mean square of f_ij - f_1j). Default 1e-6; for noisy
    /// data, use the noise. In space residuals (root mean square) above it make a warning.
    pub tolerance: f64,
    /// Roots whose imaginary parts are at most this share of the size of the data are also tried as
    /// real roots, because noise can make two real roots complex. Default 0: real roots only.
    pub near_real: f64,
    /// Whether candidates are polished in the primal coordinates. Default true.
    pub polish: bool,
    /// Stops at the first physical candidate whose residual (root mean square, metres) is below
    /// this, for callers in a hurry. Only sizes that are solved by paths without a smaller part
    /// (6r/3s, 5r/4s, 4r/5s, 5r/6s; in space 8r/5s, 7r/5s, 6r/6s, 10r/4s; all smallest of ranges) stop early. In 6r/3s and
    /// 4r/5s, and in 7r/5s, 6r/6s and 10r/4s in space, every candidate fits exactly; the first
    /// physical one is then returned, which need not be the true one. Default `None`: all networks.
    pub first_under: Option<f64>,
    /// Settings for the paths. Default: [quick](hc::TrackerOptions::quick) steps, and a tracker whose steps
    /// are about as long as those of [`hc::TrackerOptions::fast`]. Where a few paths stay lost, all are tracked
    /// again from the fibre turned another way, at most twice, and once for every two `retries`.
    pub paths: FibreOptions,
    /// Where paths start. Default [`MinimalStart::Stored`].
    pub start: MinimalStart,
}

/// Where the paths of the minimal solvers start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MinimalStart {
    /// From the stored solutions of a generic instance: as many paths as roots.
    #[default]
    Stored,
    /// From a polyhedral start system that is computed for the data, as in the paper: slower, and
    /// independent of the stored solutions. If this leaves roots missing, all roots of a random
    /// member of the family are found in this way and tracked to the data. The paths for this count
    /// as tracked again. In the plane only.
    Polyhedral,
}

impl Default for MinimalOptions {
    fn default() -> Self {
        let mut paths = FibreOptions::default();
        paths.tracker.contraction = 0.2;
        paths.tracker.corrector_tolerance = 3e-4;
        paths.tracker.beta_omega = 1.2;
        paths.tracker.beta_tau = 0.75;
        paths.tracker.beta_tau_last = 0.5;
        // Most paths take about 45 steps. One that takes many more is quicker in another chart.
        paths.tracker.max_steps = 200;
        paths.tracker.quick = true;
        MinimalOptions {
            emissions: Emissions::Unknown,
            tolerance: 1e-6,
            near_real: 0.0,
            polish: true,
            first_under: None,
            paths,
            start: MinimalStart::Stored,
        }
    }
}
