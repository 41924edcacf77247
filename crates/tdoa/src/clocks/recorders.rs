//! Recorders, each with a clock of its own.

use crate::cells::Cells;
use crate::median::median;

/// Share of a recorder's readings that lie within half a recording of its middle.
const WITHIN: f64 = 0.9;

/// Which receivers share a recorder, and so a clock, and what is unknown of these clocks.
#[derive(Debug, Clone)]
pub(crate) struct Recorders {
    /// The recorder of each receiver.
    of_receivers: Vec<usize>,
    /// Where clocks may drift: of each measurement the time by its clock, from about -1 to 1 over the recording.
    times: Option<Cells<f64>>,
    /// Per recorder, the middle of its readings, metres; half the recording.
    middles: Vec<f64>,
    unit: f64,
    /// Per receiver, what has been taken off the measurements for its clock: offset and drift over half the recording.
    taken: Vec<[f64; 2]>,
    /// One over the variances of offsets and drifts that are expected, 0 where nothing is.
    information: [f64; 2],
    /// Whether clocks are told against those that transmitters send by: the rate of the first one is unknown too.
    is_scheduled: bool,
}

impl Recorders {
    /// These recorders of the receivers, each with an unknown offset.
    pub(crate) fn with_offsets(of_receivers: Vec<usize>) -> Recorders {
        Recorders {
            taken: vec![[0.0; 2]; of_receivers.len()],
            of_receivers,
            times: None,
            middles: Vec::new(),
            unit: 0.0,
            information: [0.0; 2],
            is_scheduled: false,
        }
    }

    /// These recorders of the receivers, each with an unknown offset and an unknown rate, from the readings of their clocks.
    pub(crate) fn with_rates(of_receivers: Vec<usize>, all: &Cells<f64>) -> Recorders {
        let count = of_receivers.iter().max().map_or(0, |last| last + 1);
        let mut readings = vec![Vec::new(); count];
        for (i, _, value) in all.iter() {
            readings[of_receivers[i]].push(*value);
        }
        let middles: Vec<f64> = readings.iter().map(|all| median(all.clone()).unwrap_or_default()).collect();
        let mut unit = 0.0f64;
        for (middle, readings) in middles.iter().zip(readings) {
            let mut apart: Vec<f64> = readings.into_iter().map(|reading| (reading - middle).abs()).collect();
            apart.sort_by(f64::total_cmp);
            let most = (WITHIN * apart.len() as f64) as usize;
            unit = unit.max(apart.get(most.min(apart.len().saturating_sub(1))).copied().unwrap_or_default());
        }
        let time = |i: usize, value: f64| if unit > 0.0 { (value - middles[of_receivers[i]]) / unit } else { 0.0 };
        let times = all.map(|i, _, value| time(i, *value));
        Recorders { times: Some(times), middles, unit, ..Recorders::with_offsets(of_receivers) }
    }

    /// These recorders, whose offsets and rates are expected to have these standard deviations, metres and a share.
    pub(crate) fn expecting(self, offset: Option<f64>, rate: Option<f64>) -> Recorders {
        let drift = rate.map(|rate| rate * self.unit).filter(|drift| *drift > 0.0);
        Recorders { information: [offset, drift].map(|of| of.map_or(0.0, |deviation| deviation.powi(-2))), ..self }
    }

    /// These recorders, whose clocks are told against those that transmitters send by.
    pub(crate) fn scheduled(self) -> Recorders {
        Recorders { is_scheduled: true, ..self }
    }

    /// Whether clocks are told against those that transmitters send by: the rate of the first one is unknown too.
    pub(crate) fn is_scheduled(&self) -> bool {
        self.is_scheduled
    }

    /// One over the variances of offsets and drifts that are expected, 0 where nothing is.
    pub(crate) fn information(&self) -> [f64; 2] {
        self.information
    }

    /// Per receiver, what has been taken off the measurements for its clock.
    pub(crate) fn taken(&self) -> &[[f64; 2]] {
        &self.taken
    }

    /// These recorders, once more has been taken off the measurements.
    pub(crate) fn taking(mut self, more: &[[f64; 2]]) -> Recorders {
        self.taken.iter_mut().flatten().zip(more.iter().flatten()).for_each(|(sum, more)| *sum += more);
        self
    }

    /// The recorder of each receiver.
    pub(crate) fn of_receivers(&self) -> &[usize] {
        &self.of_receivers
    }

    /// The recorders of these receivers, in ascending order.
    pub(crate) fn present(&self) -> Vec<usize> {
        let mut all = self.of_receivers.clone();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether clocks may drift.
    pub(crate) fn drift(&self) -> bool {
        self.times.is_some()
    }

    /// The time of a measurement; 0 where clocks do not drift.
    pub(crate) fn time(&self, i: usize, j: usize) -> f64 {
        self.times.as_ref().and_then(|times| times.get(i, j)).copied().unwrap_or(0.0)
    }

    /// The rate of a clock that drifts by this length in half the recording, as a share; 0 where clocks do not drift.
    pub(crate) fn rate(&self, drift: f64) -> f64 {
        if self.unit > 0.0 { drift / self.unit } else { 0.0 }
    }

    /// Half the recording, metres: what nine in ten readings are within of the middle one; 0 where clocks do not drift.
    pub(crate) fn half(&self) -> f64 {
        self.unit
    }

    /// The middle of a receiver's readings, metres; 0 where clocks do not drift.
    pub(crate) fn middle(&self, receiver: usize) -> f64 {
        self.middles.get(self.of_receivers[receiver]).copied().unwrap_or_default()
    }

    /// What a clock adds to a measurement.
    pub(crate) fn delay(&self, [offset, drift]: [f64; 2], i: usize, j: usize) -> f64 {
        offset + drift * self.time(i, j)
    }

    /// Those of these receivers and transmitters, in this order.
    pub(crate) fn select(&self, receivers: &[usize], transmitters: &[usize]) -> Recorders {
        Recorders {
            of_receivers: receivers.iter().map(|&i| self.of_receivers[i]).collect(),
            times: self.times.as_ref().map(|times| times.select(receivers, transmitters)),
            middles: self.middles.clone(),
            taken: receivers.iter().map(|&i| self.taken[i]).collect(),
            ..*self
        }
    }
}
