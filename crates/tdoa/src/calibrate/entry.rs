//! The way into a calibration, compiled once for the plane and once for space.

use crate::calibrate::model::errors_chosen::with_errors_chosen;
use crate::calibrate::options::{CalibrateError, CalibrateOptions};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::steps;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// A number of coordinates, as a type: see [`Calibrates`].
#[derive(Debug, Clone, Copy)]
pub struct Dimension<const D: usize>;

/// Which networks [`calibrate()`] finds: those of [`Dimension<2>`], the plane, and of [`Dimension<3>`], space.
///
/// Generic code is compiled by every crate that uses it, each time in minutes and with the optimisation
/// of that crate. Through this trait the search is compiled with this crate alone. A function that is
/// itself generic asks for it:
///
/// ```
/// use tdoa::calibrate::{Calibrates, Dimension};
/// use tdoa::{CalibrateError, CalibrateOptions, Pseudoranges, calibrate};
///
/// fn deviation<const D: usize>(measured: &Pseudoranges) -> Result<f64, CalibrateError<D>>
/// where
///     Dimension<D>: Calibrates<D>,
/// {
///     Ok(calibrate(measured, &CalibrateOptions::new())?.sigma)
/// }
/// ```
pub trait Calibrates<const D: usize>: Sealed {
    /// [`calibrate_with`] in this dimension.
    #[doc(hidden)]
    fn calibrate_with(
        measured: &Pseudoranges,
        options: &CalibrateOptions<D>,
        sources: &[&dyn Hypotheses<D>],
        monitor: &Monitor,
    ) -> Result<Calibration<D>, CalibrateError<D>>;
}

/// Implemented here alone.
pub trait Sealed {}

macro_rules! calibrates {
    ($($dimension:literal)*) => {$(
        impl Sealed for Dimension<$dimension> {}

        impl Calibrates<$dimension> for Dimension<$dimension> {
            fn calibrate_with(
                measured: &Pseudoranges,
                options: &CalibrateOptions<$dimension>,
                sources: &[&dyn Hypotheses<$dimension>],
                monitor: &Monitor,
            ) -> Result<Calibration<$dimension>, CalibrateError<$dimension>> {
                let calibrate = |options: &CalibrateOptions<$dimension>| steps::calibrate_with(measured, options, sources, monitor);
                let found = with_errors_chosen(options, monitor, calibrate)?;
                // Nobody asked.
                Ok(Calibration { dimension_test: None, ..found })
            }
        }
    )*};
}

calibrates!(2 3);

/// Calibrates a network in the plane or in space (`CalibrateOptions::<3>::new()`) from its pseudoranges, by restarts of the robust refinement and from the
/// networks that the minimal solvers find for subsets.
///
/// ```
/// let mut options = tdoa::SimulateOptions::default();
/// options.noise = 0.01;
/// let simulation = tdoa::simulate(&options)?;
/// let calibration = tdoa::calibrate(&simulation.pseudoranges, &tdoa::CalibrateOptions::default())?;
/// let receivers: Vec<[f64; 2]> = calibration.receivers.iter().flatten().copied().collect();
/// let alignment = tdoa::align::align(&receivers, &simulation.network.receivers, false).unwrap();
/// assert!(alignment.rms < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the data cannot determine a network, an option is out of range, or no network is found.
pub fn calibrate<const D: usize>(
    measured: &Pseudoranges,
    options: &CalibrateOptions<D>,
) -> Result<Calibration<D>, CalibrateError<D>>
where
    Dimension<D>: Calibrates<D>,
{
    calibrate_with(measured, options, &[], &Monitor::default())
}

/// [`calibrate()`] with further sources of starts besides the restarts, which take turns, and with
/// progress and cancellation.
///
/// # Errors
/// Those of [`calibrate()`], and [`CalibrateError::Cancelled`].
pub fn calibrate_with<const D: usize>(
    measured: &Pseudoranges,
    options: &CalibrateOptions<D>,
    sources: &[&dyn Hypotheses<D>],
    monitor: &Monitor,
) -> Result<Calibration<D>, CalibrateError<D>>
where
    Dimension<D>: Calibrates<D>,
{
    Dimension::<D>::calibrate_with(measured, options, sources, monitor)
}
