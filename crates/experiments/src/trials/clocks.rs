//! Simulated networks with clocks of every kind.

use super::calibration::distance_from;
use tdoa::accuracy::cramer_rao_with_clocks;
use tdoa::calibrate::{Calibrates, Dimension};
use tdoa::{CalibrateOptions, Clocks, Emissions, ReceiverClocks, SimulateError, SimulateOptions, calibrate, simulate};

/// Standard deviation of the measurements, metres.
const NOISE: f64 = 0.01;

/// Standard deviation of recorders' offsets, metres, and of their rates, a share.
const OFFSETS: f64 = 1000.0;
const RATES: f64 = 2e-5;

/// Ten minutes of sound, metres.
const DURATION: f64 = 600.0 * 343.0;

/// What clocks do, and what is taken for unknown of them.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The name in tables.
    pub name: &'static str,
    /// What transmitters and recorders do.
    made: (Emissions, ReceiverClocks),
    /// What is unknown to the calibration.
    unknown: (Emissions, ReceiverClocks),
    /// Receivers that share a recorder.
    channels: usize,
    /// Whether the rates' standard deviation is given.
    expecting: bool,
    /// Whether transmitters send by a schedule that is known, and all receivers share a recorder.
    scheduled: bool,
}

const fn case(name: &'static str, emissions: Emissions, receivers: ReceiverClocks, channels: usize) -> Case {
    let model = (emissions, receivers);
    Case { name, made: model, unknown: model, channels, expecting: false, scheduled: false }
}

use Emissions::{Constant, Known, Unknown};
use ReceiverClocks::{Common, Offset, Rate};

/// All cases; the first is that of receivers that share a clock.
pub const CASES: [Case; 15] = [
    case("common", Unknown, Common, 1),
    case("ranges", Known, Common, 1),
    case("constant", Constant, Common, 1),
    case("offsets", Unknown, Offset, 1),
    case("offsets-2", Unknown, Offset, 2),
    case("offsets-4", Unknown, Offset, 4),
    case("rates", Unknown, Rate, 1),
    Case { expecting: true, ..case("rates-expected", Unknown, Rate, 1) },
    case("rates-2", Unknown, Rate, 2),
    case("rates-4", Unknown, Rate, 4),
    case("ranges-offsets", Known, Offset, 1),
    Case { made: (Unknown, Rate), scheduled: true, ..case("schedule", Constant, Common, 1) },
    // More unknowns than there need be.
    Case { made: (Known, Common), ..case("constant-of-ranges", Constant, Common, 1) },
    Case { made: (Unknown, Common), ..case("offsets-of-common", Unknown, Offset, 1) },
    Case { made: (Unknown, Offset), ..case("rates-of-offsets", Unknown, Rate, 1) },
];

/// A calibration beside the truth.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Root mean square distance of the receivers from the truth after the best rigid alignment, metres; `None` without a
    /// calibration of all of them.
    pub error: Option<f64>,
    /// The Cramer-Rao bound on it with these unknowns, metres.
    pub bound: f64,
    /// Whether the network was called unique.
    pub unique: bool,
}

impl Case {
    /// A network of so many receivers and transmitters, a tenth of the measurements missing and a twentieth gross errors,
    /// calibrated.
    ///
    /// # Errors
    /// Sizes that [`simulate()`] refuses.
    pub fn outcome<const D: usize>(
        self,
        receivers: usize,
        transmitters: usize,
        seed: u64,
    ) -> Result<Outcome, SimulateError>
    where
        Dimension<D>: Calibrates<D>,
    {
        let mut made = SimulateOptions::<D>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (receivers, transmitters, NOISE, seed);
        (made.missing, made.outliers, made.emissions, made.channels) = (0.1, 0.05, self.made.0, self.channels);
        if self.made.1 != Common {
            made.delays = OFFSETS;
        }
        if self.made.1 == Rate {
            made.rates = RATES;
        }
        if self.unknown.1 == Rate || self.scheduled {
            made.duration = Some(DURATION);
        }
        if self.scheduled {
            made.channels = receivers.max(1);
        }
        let made = simulate(&made)?;
        let measured = match self.scheduled {
            true => made.pseudoranges.clone().with_emission_times(made.network.offsets.clone())?,
            false => made.pseudoranges.clone(),
        };
        let mut options = CalibrateOptions::<D>::new();
        options.seed = seed;
        options.clocks = Clocks::default();
        (options.clocks.emissions, options.clocks.receivers) = self.unknown;
        options.clocks.rate_sigma = self.expecting.then_some(RATES);
        let truth = &made.network;
        let bound = cramer_rao_with_clocks(&measured, &made.outliers, truth, NOISE, &options.clocks);
        let found = calibrate(&measured, &options).ok();
        let error = found.as_ref().and_then(|found| distance_from(&found.receivers, truth));
        Ok(Outcome { error, bound, unique: found.is_some_and(|found| found.unique) })
    }
}

impl Outcome {
    /// Whether the receivers are within three times the bound.
    pub fn is_at_the_bound(&self) -> bool {
        self.error.is_some_and(|error| error <= 3.0 * self.bound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_calibrated_at_the_bound_with_the_clocks_they_have() {
        for case in CASES.iter().filter(|case| case.unknown.1 == Common) {
            let found = case.outcome::<2>(12, 20, 1).unwrap();
            assert!(found.is_at_the_bound() && found.unique, "{}: {found:?}", case.name);
        }
        // Ranges are no pseudoranges: their unknown constant costs certainty.
        let bound = |name: &str| {
            let case = CASES.iter().find(|case| case.name == name).unwrap();
            case.outcome::<2>(12, 20, 1).unwrap().bound
        };
        assert!(bound("ranges") < bound("constant-of-ranges"));
    }
}
