//! Measurements of transmitters whose send times are known: distances.

use crate::calibrate::options::CalibrateError;
use crate::clocks::{Clocks, Emissions, ReceiverClocks};
use crate::degeneracy::list;
use crate::pseudoranges::Pseudoranges;
use crate::quantity::number;
use std::borrow::Cow;

/// Negative values, one in so many of all, above which measurements are no distances with gross errors.
const MANY: usize = 5;

/// Measurements with what is unknown of clocks. Where that is nothing they are distances, and a warning names the negative
/// ones, which are left out.
///
/// # Errors
/// If many distances are negative.
pub(crate) fn with_clocks<const D: usize>(
    measured: Cow<'_, Pseudoranges>,
    clocks: Clocks,
) -> Result<(Cow<'_, Pseudoranges>, Option<String>), CalibrateError<D>> {
    if clocks == Clocks::default() {
        return Ok((measured, None));
    }
    let measured = clocks.of(&measured);
    if clocks.emissions != Emissions::Known || clocks.receivers != ReceiverClocks::Common {
        return Ok((Cow::Owned(measured), None));
    }
    as_ranges(&measured).map(|(ranges, warning)| (Cow::Owned(ranges), warning))
}

fn as_ranges<const D: usize>(measured: &Pseudoranges) -> Result<(Pseudoranges, Option<String>), CalibrateError<D>> {
    let length = |j: usize, value: f64| value - measured.emission_time(j);
    let negative = measured.cells().iter().map(|(i, j, value)| (i, j, length(j, *value)));
    let negative: Vec<_> = negative.filter(|(.., length)| *length < 0.0).collect();
    let Some(&(i, j, value)) = negative.first() else {
        return Ok((measured.clone(), None));
    };
    let names = |i: usize, j: usize| (measured.receiver_names()[i].clone(), measured.transmitter_names()[j].clone());
    if MANY * negative.len() > measured.observed() {
        let (receiver, transmitter) = names(i, j);
        return Err(CalibrateError::NegativeRanges { count: negative.len(), receiver, transmitter, value });
    }
    let name = |&(i, j, value): &(usize, usize, f64)| {
        let (receiver, transmitter) = names(i, j);
        format!("{receiver}-{transmitter} ({} m)", number(value, 12))
    };
    let warning = format!(
        "left out, for distances are positive: {}; leave cells empty where nothing was measured",
        list(&negative.iter().map(name).collect::<Vec<_>>())
    );
    Ok((measured.filter(|_, j, value| length(j, value) >= 0.0), Some(warning)))
}

#[cfg(test)]
mod tests {
    use crate::accuracy::{cramer_rao, cramer_rao_with_clocks};
    use crate::align::align;
    use crate::calibrate::{Calibrates, Dimension};
    use crate::{CalibrateError, CalibrateOptions, Clocks, Emissions, SimulateOptions, calibrate, simulate};

    /// Networks are as near to the truth as distances tell, or distances with a constant, which is nearer than pseudoranges
    /// do.
    fn are_at_the_bound<const D: usize>(emissions: Emissions)
    where
        Dimension<D>: Calibrates<D>,
    {
        let (mut squares, mut of_bound) = (0.0, 0.0);
        for seed in 0..6 {
            let mut options = SimulateOptions::<D>::new();
            (options.receivers, options.transmitters, options.noise, options.seed) = (10, 20, 0.01, seed);
            (options.missing, options.outliers, options.emissions) = (0.1, 0.05, emissions);
            let made = simulate(&options).unwrap();
            let mut options = CalibrateOptions::<D>::new();
            (options.clocks.emissions, options.seed) = (emissions, seed);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let truth = &made.network;
            assert!(found.unique, "seed {seed}");
            for (offset, deviation) in found.offsets.iter().zip(&found.offset_std) {
                let (off, deviation) = ((offset.unwrap() - truth.offsets[0]).abs(), deviation.unwrap());
                match emissions {
                    Emissions::Constant => assert!(off < 4.0 * deviation && deviation < 0.01, "{off} {deviation}"),
                    _ => assert!(off == 0.0 && deviation == 0.0, "seed {seed}"),
                }
            }
            assert!(found.offsets.windows(2).all(|pair| pair[0] == pair[1]), "seed {seed}");
            let receivers: Vec<[f64; D]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&receivers, &truth.receivers, false).unwrap().rms;
            let ranges = made.pseudoranges.clone().with_emissions(emissions);
            let bound = cramer_rao(&ranges, &made.outliers, truth, 0.01);
            assert!(bound < cramer_rao(&made.pseudoranges, &made.outliers, truth, 0.01), "seed {seed}");
            assert!(apart < 3.0 * bound, "seed {seed}: {apart} {bound}");
            squares += apart * apart;
            of_bound += bound * bound;
        }
        // Six networks of 17 coordinates each in the plane, more in space: if all were equally certain, a mean square 1.5 times the
        // bound's would have a chance of one in a thousand.
        assert!(squares < 1.5 * of_bound, "{squares} {of_bound}");
    }

    #[test]
    fn distances_are_calibrated_at_the_bound() {
        for emissions in [Emissions::Known, Emissions::Constant] {
            are_at_the_bound::<2>(emissions);
            are_at_the_bound::<3>(emissions);
        }
    }

    /// Six receivers hear each transmitter, which has three coordinates: what is left over tells the noise, and the noise how
    /// far the heights are to be believed.
    #[test]
    fn heights_of_ranges_are_believed() {
        for seed in 0..6 {
            let mut made = SimulateOptions::<3>::new();
            (made.receivers, made.transmitters, made.noise, made.seed) = (6, 30, 0.1, seed);
            (made.missing, made.outliers, made.emissions) = (0.1, 0.05, Emissions::Known);
            let made = simulate(&made).unwrap();
            let mut options = CalibrateOptions::<3>::new();
            (options.clocks.emissions, options.seed) = (Emissions::Known, seed);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let receivers: Vec<[f64; 3]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&receivers, &made.network.receivers, false).unwrap().rms;
            let bound = cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, &made.network, 0.1, &options.clocks);
            assert!(found.fits && apart < 3.0 * bound, "seed {seed}: {apart} {bound} {:?}", found.warnings);
        }
    }

    #[test]
    fn pseudoranges_are_no_distances() {
        let made = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        let options = CalibrateOptions {
            clocks: Clocks { emissions: Emissions::Known, ..Default::default() },
            ..Default::default()
        };
        let found = calibrate(&made.pseudoranges, &options);
        assert!(matches!(found, Err(CalibrateError::NegativeRanges { .. })), "{found:?}");
        let late = made.pseudoranges.map(|_, _, value| value + 30.0);
        assert!(calibrate(&late, &options).is_ok_and(|found| !found.fits));
    }
}
