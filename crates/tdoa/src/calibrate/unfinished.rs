//! The result of a calibration that was stopped.

use crate::network::Network;
use serde::{Deserialize, Serialize};

/// The best network so far of a calibration that was stopped, in a frame of its own. A longer
/// search may find a better network, outliers may have bent this one, and its uncertainty is not
/// known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[f64; D]: Serialize", deserialize = "[f64; D]: Deserialize<'de>"))]
#[non_exhaustive]
pub struct Unfinished<const D: usize = 2> {
    /// Positions of the receivers in metres; `None` for receivers that the search had not placed
    /// yet.
    pub receivers: Vec<Option<[f64; D]>>,
    /// Positions of the transmitters in metres, as for receivers.
    pub transmitters: Vec<Option<[f64; D]>>,
    /// Offsets of the transmitters in metres.
    pub offsets: Vec<Option<f64>>,
    /// Number of starts of the search that had ended.
    pub starts: usize,
    /// Number of starts that had ended in this network.
    pub agreeing: usize,
}

impl<const D: usize> Unfinished<D> {
    pub(crate) fn of(network: &Network<D>, starts: usize, agreeing: usize) -> Unfinished<D> {
        Unfinished {
            receivers: network.receivers.iter().copied().map(Some).collect(),
            transmitters: network.transmitters.iter().copied().map(Some).collect(),
            offsets: network.offsets.iter().copied().map(Some).collect(),
            starts,
            agreeing,
        }
    }

    /// Receivers alone, from small networks laid together, beside so many transmitters.
    pub(crate) fn laid(receivers: Vec<Option<[f64; D]>>, transmitters: usize, starts: usize) -> Unfinished<D> {
        let (nowhere, never) = (vec![None; transmitters], vec![None; transmitters]);
        Unfinished { receivers, transmitters: nowhere, offsets: never, starts, agreeing: 0 }
    }

    /// This network as a part of `m` receivers and `n` transmitters; its own nodes are those at `rows`
    /// and `columns`.
    pub(crate) fn among(self, m: usize, rows: &[usize], n: usize, columns: &[usize]) -> Unfinished<D> {
        Unfinished {
            receivers: scatter(m, rows, self.receivers),
            transmitters: scatter(n, columns, self.transmitters),
            offsets: scatter(n, columns, self.offsets),
            ..self
        }
    }

    /// Undoes the centring of the measurements: `shifts` were taken from those of the transmitters.
    pub(crate) fn shifted(mut self, shifts: &[f64]) -> Unfinished<D> {
        for (offset, shift) in self.offsets.iter_mut().zip(shifts) {
            *offset = offset.map(|offset| offset + shift);
        }
        self
    }
}

fn scatter<T: Clone>(length: usize, at: &[usize], values: Vec<Option<T>>) -> Vec<Option<T>> {
    let mut all = vec![None; length];
    for (&k, value) in at.iter().zip(values) {
        all[k] = value;
    }
    all
}

#[cfg(test)]
mod tests {
    use crate::calibrate::{CalibrateError, CalibrateOptions, SearchOptions, calibrate_with};
    use crate::{Clocks, Errors, ReceiverClocks, ReceiverDelays, ReceiverFault, SimulateOptions, simulate};
    use hc::{Monitor, Stage};
    use std::sync::atomic::{AtomicU64, Ordering};

    /// A search that is stopped after its first starts leaves the network, every node in its place.
    #[test]
    fn a_stopped_search_leaves_its_best_network() {
        let made = simulate(&SimulateOptions { seed: 3, ..SimulateOptions::default() }).unwrap();
        // The node that nobody hears is left out of the search.
        let mut values = made.pseudoranges.dense();
        let (m, n) = (made.pseudoranges.receivers(), made.pseudoranges.transmitters());
        for i in 0..m {
            values[i * n + 2] = f64::NAN;
        }
        let measured = crate::Pseudoranges::new(m, n, values).unwrap();
        let mut options = CalibrateOptions::default();
        options.search.max_starts = usize::MAX >> 8;
        options.search.agreeing = options.search.max_starts;
        let monitor = Monitor::asking(|now| now.stage == Stage::Search && now.done >= 48);
        let Err(CalibrateError::Cancelled(Some(best))) = calibrate_with(&measured, &options, &[], &monitor) else {
            panic!("it ended")
        };
        assert!(best.starts >= 48 && best.agreeing > 0);
        assert!(best.transmitters[2].is_none() && best.offsets[2].is_none());
        for (j, s) in best.transmitters.iter().enumerate().filter(|(j, _)| *j != 2) {
            for (i, r) in best.receivers.iter().enumerate() {
                let ([x, y], [u, v]) = (r.unwrap(), s.unwrap());
                let error = (x - u).hypot(y - v) + best.offsets[j].unwrap() - measured.get(i, j).unwrap();
                assert!(error.abs() < 1e-6, "{i} {j} {error}");
            }
        }
        // Stopped among its first starts, it has not counted more that agree than there are.
        let monitor = Monitor::asking(|now| now.stage == Stage::Search);
        if let Err(CalibrateError::Cancelled(Some(best))) = calibrate_with(&measured, &options, &[], &monitor) {
            assert!(best.agreeing <= best.starts && best.starts <= 16, "{best:?}");
        }
        // Nothing had been found.
        let monitor = Monitor::asking(|_| true);
        assert_eq!(calibrate_with(&measured, &options, &[], &monitor).unwrap_err(), CalibrateError::Cancelled(None));
    }

    #[test]
    fn a_stopped_layout_leaves_the_receivers_laid_so_far() {
        let made = simulate(&SimulateOptions {
            receivers: 20,
            transmitters: 60,
            layout: crate::Layout::Chain { extent: [400.0, 50.0] },
            hearing: Some(8),
            noise: 0.1,
            ..SimulateOptions::default()
        });
        let made = made.unwrap();
        let options = CalibrateOptions { sigma: Some(0.1), ..CalibrateOptions::default() };
        let monitor = Monitor::asking(|now| now.stage == Stage::Search && now.counted >= 3);
        let Err(CalibrateError::Cancelled(Some(best))) = calibrate_with(&made.pseudoranges, &options, &[], &monitor)
        else {
            panic!("it ended")
        };
        let pairs = best.receivers.iter().zip(&made.network.receivers).filter_map(|(p, q)| Some(((*p)?, *q)));
        let (found, truth): (Vec<_>, Vec<_>) = pairs.unzip();
        assert!(found.len() >= 10 && best.starts >= 3);
        // Ten neighbours of a road of 400 m reach over 200 m: within a hundredth of that.
        let error = crate::align::align(&found, &truth, false).unwrap().rms;
        assert!(error < 2.0, "{error}");
    }

    /// Whenever a calibration is stopped it says so, whatever it is doing.
    #[test]
    fn no_part_of_a_calibration_takes_a_stop_for_a_result() {
        /// Moments of each calibration.
        const MOMENTS: u64 = 6;
        let moved = SimulateOptions { fault: Some(ReceiverFault::Move(0.3)), ..SimulateOptions::default() };
        let late = SimulateOptions { detours: 0.3, detour_size: 0.5, ..SimulateOptions::default() };
        let outliers = SimulateOptions { outliers: 0.1, ..SimulateOptions::default() };
        let (none, auto) = (ReceiverDelays::None, ReceiverDelays::Auto);
        let (common, offset) = (ReceiverClocks::Common, ReceiverClocks::Offset);
        for (made, errors, receiver_delays, receivers) in [
            (outliers, Errors::Symmetric, none, common),
            (moved, Errors::Symmetric, auto, common),
            (SimulateOptions::default(), Errors::Symmetric, none, offset),
            (late, Errors::OneSided, none, common),
        ] {
            let made = SimulateOptions { receivers: 7, transmitters: 10, noise: 0.01, seed: 3, ..made };
            let made = simulate(&made).unwrap();
            let options = CalibrateOptions {
                errors,
                receiver_delays,
                clocks: Clocks { receivers, ..Clocks::default() },
                search: SearchOptions {
                    max_starts: 32,
                    min_starts: 16,
                    agreeing: 4,
                    minimal_subsets: 0,
                    ..SearchOptions::default()
                },
                ..CalibrateOptions::default()
            };
            // Says no until it has been asked so often.
            let run = |most: u64| {
                let asked: &'static AtomicU64 = Box::leak(Box::default());
                let monitor = Monitor::asking(move |_| asked.fetch_add(1, Ordering::Relaxed) >= most);
                let ended = calibrate_with(&made.pseudoranges, &options, &[], &monitor);
                (ended, asked.load(Ordering::Relaxed))
            };
            let (whole, asked) = run(u64::MAX);
            assert!(whole.is_ok());
            for k in 0..MOMENTS {
                let (ended, _) = run(asked * k / MOMENTS);
                let Err(CalibrateError::Cancelled(best)) = ended else { panic!("{errors:?} {receivers:?} {k}") };
                assert!(best.is_some() || 2 * k < MOMENTS);
                let placed = best.iter().flat_map(|best| best.receivers.iter().chain(&best.transmitters));
                assert!(placed.flatten().flatten().all(|x| x.is_finite()));
            }
            // The last questions of all are asked by what reports.
            for k in 1..3 {
                let (ended, _) = run(asked - k);
                assert!(matches!(ended, Err(CalibrateError::Cancelled(Some(_)))), "{errors:?} {receiver_delays:?} {k}");
            }
        }
    }
}
