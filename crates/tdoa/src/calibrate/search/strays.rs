//! Receivers that no small network has, placed from transmitters that the others locate.

use crate::calibrate::input::selection::synchronised;
use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::search::deviation::typical_deviation;
use crate::calibrate::search::local::{ReceiverLayout, heard_by};
use crate::calibrate::search::submaps::{FIT, PlacedReceiver, overlap};
use crate::clocks::Emissions;
use crate::flatness::flatness;
use crate::loss::{Loss, SEARCH_NU};
use crate::multilateration::{self, Sight};
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

impl<const D: usize> ReceiverLayout<D> {
    /// Places receivers that no submap has from transmitters that five placed receivers or more
    /// have located.
    ///
    /// # Errors
    /// Cancelled; no further receiver is then placed.
    pub(crate) fn place_strays(&mut self, measured: &Pseudoranges, monitor: &Monitor) -> Result<(), CalibrateError<D>> {
        let size = self.size / typical_deviation(measured);
        let loss = Loss { nu: SEARCH_NU, scale: FIT * size };
        let precision = |i: usize, j: usize| measured.sigma(i, j).map_or(1.0, |sigma| 1.0 / sigma);
        let all: Vec<usize> = (0..measured.receivers()).collect();
        let clocks = self.clocks(measured, &all);
        let has_clock = |i: usize| clocks.get(i).is_none_or(Option::is_some);
        let known: Vec<[f64; 2]> = clocks.iter().map(|clock| clock.unwrap_or_default()).collect();
        let measured = &synchronised(measured.clone(), &known);
        let located: Vec<Option<multilateration::Located<D>>> = (0..measured.transmitters())
            .map(|j| {
                check(monitor)?;
                let sight = |i: usize| {
                    Some(Sight { position: self.position(i)?, length: measured.get(i, j)?, precision: precision(i, j) })
                };
                let sights: Vec<Sight<D>> = all.iter().filter_map(|&i| sight(i)).collect();
                let locate = if measured.emissions() == Emissions::Known {
                    multilateration::receiver
                } else {
                    multilateration::transmitter
                };
                Ok((sights.len() >= heard_by::<D>()).then(|| locate(&sights, &loss)).flatten())
            })
            .collect::<Result<_, CalibrateError<D>>>()?;
        for i in 0..measured.receivers() {
            if self.receivers[i].is_some() {
                continue;
            }
            let sight = |(j, found): (usize, &Option<multilateration::Located<D>>)| {
                let found = found.as_ref()?;
                let length = measured.get(i, j)? - found.offset;
                Some(Sight { position: found.position, length, precision: precision(i, j) })
            };
            let sights: Vec<Sight<D>> = located.iter().enumerate().filter_map(sight).collect();
            let around: Vec<[f64; D]> = sights.iter().map(|s| s.position).collect();
            if sights.len() >= 2 * overlap::<D>() && flatness(&around) > 0.05 {
                let locate = if has_clock(i) { multilateration::receiver } else { multilateration::transmitter };
                let taken = measured.unknown_clocks().map_or([0.0; 2], |recorders| recorders.taken()[i]);
                let placed = |found: multilateration::Located<D>| {
                    let offset = if has_clock(i) { 0.0 } else { found.offset };
                    PlacedReceiver { position: found.position, clock: [taken[0] + offset, taken[1]] }
                };
                self.receivers[i] = locate(&sights, &loss).map(placed);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::calibrate::input::ranges::with_clocks;
    use crate::calibrate::input::selection::Input;
    use crate::calibrate::search::local::ReceiverLayout;
    use crate::calibrate::search::submaps::PlacedReceiver;
    use crate::degeneracy::Usable;
    use crate::{Clocks, Monitor, ReceiverClocks, SimulateOptions, points, simulate};
    use std::borrow::Cow;

    /// A receiver that no small network has, with a clock of its own or that of another.
    #[test]
    fn strays_are_placed_with_their_clocks() {
        for channels in [1, 2] {
            let made = SimulateOptions { receivers: 12, transmitters: 40, delays: 1e3, channels, ..Default::default() };
            let made = simulate(&made).unwrap();
            let options = Clocks { receivers: ReceiverClocks::Offset, ..Default::default() };
            let (table, _) = with_clocks::<2>(Cow::Borrowed(&made.pseudoranges), options).unwrap();
            let everything =
                Usable { receivers: (0..12).collect(), transmitters: (0..40).collect(), warnings: Vec::new() };
            let centred = Input::new(table, everything).centred();
            let clock = |i: usize| [made.clocks[i][0] - made.clocks[0][0], 0.0];
            let places = made.network.receivers.iter().enumerate();
            let mut receivers: Vec<Option<PlacedReceiver<2>>> =
                places.map(|(i, &position)| Some(PlacedReceiver { position, clock: clock(i) })).collect();
            receivers[11] = None;
            let mut layout = ReceiverLayout { submaps: Vec::new(), receivers, solved: 1, size: 10.0 };
            layout.place_strays(&centred, &Monitor::default()).unwrap();
            let PlacedReceiver { position, clock: [offset, _] } = layout.receivers[11].unwrap();
            assert!(points::distance(position, made.network.receivers[11]) < 1e-4, "{channels}: {position:?}");
            assert!((offset - clock(11)[0]).abs() < 1e-4, "{channels}: {offset} {:?}", clock(11));
        }
    }
}
