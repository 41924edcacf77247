//! Receivers that hear a reflection of part of the transmitters.
//!
//! A flat wall reflects as a mirror does: what comes by it has the length of the way to the mirror image of the
//! receiver (the image method; Allen and Berkley 1979). Measurements of one receiver that are wrong and agree on a
//! second place are such reflections. Of the two places the image is the one that is farther from all transmitters, as
//! these are on the receiver's side of the wall. A search may have found either.

use crate::calibrate::judge::neighbours::Reason;
use crate::calibrate::judge::weak_nodes::{BY_CHANCE, agree_by_chance};
use crate::calibrate::options::{CalibrateError, Errors, check};
use crate::calibrate::receivers::echo::{Echo, ReceiverEcho};
use crate::calibrate::search::deviation::{spread_of_residuals, typical_deviation};
use crate::calibrate::state::State;
use crate::loss::{Loss, SEARCH_NU};
use crate::multilateration::{Sight, receiver as locate};
use crate::observations::Observation;
use crate::points::distance;

/// One in so many measurements of a receiver at least is reflected.
const SHARE: usize = 5;

/// Which of two places of a receiver is behind a wall.
#[derive(Clone, Copy, PartialEq)]
enum Image {
    First,
    Second,
    /// Some transmitters are nearer to one, some to the other.
    Neither,
}

impl<const D: usize> State<'_, D> {
    /// Looks for a second place of each receiver, and leaves out what it measured at the one behind a wall.
    pub(crate) fn leave_out_reflections(&mut self) -> Result<(), CalibrateError<D>> {
        if self.options.errors == Errors::OneSided || self.has_delays_of_all() {
            return Ok(());
        }
        for receiver in 0..self.observations.receivers {
            check(self.monitor)?;
            if self.taken.iter().chain(&self.left).any(|fault| fault.receiver == receiver) {
                continue;
            }
            let Some(second) = self.second_place(receiver) else { continue };
            self.take_direct(receiver, second)?;
        }
        Ok(())
    }

    /// Residuals within this are those of good measurements.
    fn reach(&self) -> f64 {
        self.options.inlier_threshold * self.known.unwrap_or(self.deviation)
    }

    /// A measurement of a receiver as a distance from the transmitter.
    fn sight(&self, o: &Observation) -> Sight<D> {
        let best = &self.ranked[0].network;
        Sight { position: best.transmitters[o.transmitter], length: o.length(best), precision: o.precision }
    }

    /// The place on which wrong measurements of a receiver agree, beyond chance.
    fn second_place(&self, receiver: usize) -> Option<[f64; D]> {
        let best = &self.ranked[0].network;
        let wrong = self.observations.of_receiver(receiver).filter(|o| o.residual(best).abs() > self.reach());
        let sights: Vec<Sight<D>> = wrong.map(|o| self.sight(o)).collect();
        if sights.len() <= D + 1 {
            return None;
        }
        let loss = Loss { nu: SEARCH_NU, scale: 3.0 * self.known.unwrap_or(self.deviation) };
        let second = locate(&sights, &loss)?.position;
        let agree = sights.iter().filter(|sight| self.agrees(sight, second)).count();
        // Errors of events one after the other are alike, and a few of them agree on places of their own.
        if SHARE * agree < self.observations.of_receiver(receiver).len() {
            return None;
        }
        let width = 2.0 * self.reach() * typical_deviation(&self.measured) / best.size().max(f64::MIN_POSITIVE);
        let chance = self.observations.receivers as f64 * agree_by_chance::<D>(sights.len(), agree, width);
        (chance <= BY_CHANCE).then_some(second)
    }

    fn agrees(&self, sight: &Sight<D>, place: [f64; D]) -> bool {
        ((sight.length - distance(sight.position, place)) * sight.precision).abs() <= self.reach()
    }

    /// Keeps, of what a receiver measured in two places, that of the one before the wall.
    fn take_direct(&mut self, receiver: usize, second: [f64; D]) -> Result<(), CalibrateError<D>> {
        let first = self.ranked[0].network.receivers[receiver];
        let sights: Vec<(usize, Sight<D>)> =
            self.observations.of_receiver(receiver).map(|o| (o.transmitter, self.sight(o))).collect();
        let image = match image(&sights, first, second, self.reach()) {
            // What is known of a receiver is not moved.
            Image::First if self.observations.held()[receiver] => Image::Neither,
            image => image,
        };
        let (place, direct) = if image == Image::First { (first, second) } else { (second, first) };
        let reflected: Vec<usize> = if image == Image::Neither {
            Vec::new()
        } else {
            let off = |sight: &Sight<D>, place| (sight.length - distance(sight.position, place)).abs();
            let is_reflected = |sight: &Sight<D>| self.agrees(sight, place) && off(sight, place) < off(sight, direct);
            sights.iter().filter(|(_, sight)| is_reflected(sight)).map(|(j, _)| *j).collect()
        };
        let echo = Echo { receiver, measured: sights.len(), apart: distance(first, second), reflected };
        self.neighbours.retain(|other| !matches!(other.reason, Reason::Error(fault) if fault.receiver == receiver));
        if !echo.reflected.is_empty() {
            let is_direct = |i: usize, j: usize| i != receiver || !echo.reflected.contains(&j);
            self.measured = self.measured.filter(|i, j, _| is_direct(i, j));
            self.observations = self.observations.subset(|o| is_direct(o.receiver, o.transmitter));
            if image == Image::First {
                self.ranked[0].network.receivers[receiver] = second;
                let wide = spread_of_residuals(&self.observations, &self.ranked[0].network);
                self.finish(self.known.unwrap_or(wide))?;
            }
        }
        self.echoes.push(echo);
        Ok(())
    }

    /// Receivers with two places, for the report.
    pub(crate) fn receiver_echoes(&self) -> Vec<ReceiverEcho> {
        let named = |echo: &Echo| ReceiverEcho {
            receiver: self.measured.receiver_names()[echo.receiver].clone(),
            transmitters: echo.reflected.iter().map(|&j| self.measured.transmitter_names()[j].clone()).collect(),
            measured: echo.measured,
            wall: 0.5 * echo.apart,
        };
        self.echoes.iter().map(named).collect()
    }

    /// Whether a receiver has two places of which neither is behind a wall.
    pub(crate) fn has_two_places(&self) -> bool {
        self.echoes.iter().any(|echo| echo.reflected.is_empty())
    }
}

/// Which of two places is farther from all transmitters.
fn image<const D: usize>(sights: &[(usize, Sight<D>)], first: [f64; D], second: [f64; D], reach: f64) -> Image {
    let further = |(_, sight): &(usize, Sight<D>)| {
        (distance(sight.position, second) - distance(sight.position, first)) * sight.precision
    };
    let (low, high) =
        sights.iter().map(further).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low >= -reach {
        Image::Second
    } else if high <= reach {
        Image::First
    } else {
        Image::Neither
    }
}

#[cfg(test)]
mod tests {
    use crate::align::align;
    use crate::{CalibrateOptions, Calibration, Pseudoranges, SimulateOptions, Simulation, calibrate, simulate};

    /// A network in the plane whose first receiver hears a reflection of these transmitters, from the wall x = -0.7.
    fn with_echo(seed: u64, reflected: impl Fn(usize) -> bool) -> (Simulation, Calibration) {
        let made = SimulateOptions { receivers: 8, transmitters: 24, noise: 0.01, seed, ..Default::default() };
        let made = simulate(&made).unwrap();
        let mut image = made.network.clone();
        image.receivers[0][0] = -1.4 - image.receivers[0][0];
        let mut values = made.pseudoranges.dense();
        for j in (0..24).filter(|&j| reflected(j)) {
            values[j] += image.distance(0, j) - made.network.distance(0, j);
        }
        let measured = Pseudoranges::new(8, 24, values).unwrap();
        let found = calibrate(&measured, &CalibrateOptions { seed, ..Default::default() }).unwrap();
        (made, found)
    }

    fn error(made: &Simulation, found: &Calibration) -> f64 {
        let positions: Vec<[f64; 2]> = found.receivers.iter().flatten().copied().collect();
        align(&positions, &made.network.receivers, false).unwrap().rms
    }

    #[test]
    fn the_place_before_the_wall_is_kept() {
        // From a third of the events reflected to two thirds, where the search finds the image.
        for seed in 0..4 {
            for (every, but) in [(3, false), (2, false), (3, true)] {
                let reflected = |j: usize| j.is_multiple_of(every) != but;
                let (made, found) = with_echo(seed, reflected);
                let [echo] = &found.receiver_echoes[..] else { panic!("seed {seed}: {:?}", found.warnings) };
                assert_eq!(echo.receiver, "r1");
                let heard: Vec<&String> = (0..24)
                    .filter(|&j| reflected(j) && made.pseudoranges.get(0, j).is_some())
                    .map(|j| &found.transmitter_names[j])
                    .collect();
                // The image is known from few events, and one in an odd direction may be beyond its noise: an outlier.
                assert!(echo.transmitters.iter().all(|name| heard.contains(&name)), "seed {seed}: {echo:?}");
                assert!(echo.transmitters.len() + 2 >= heard.len(), "seed {seed}: {echo:?} {heard:?}");
                let wall = 0.7 + made.network.receivers[0][0];
                assert!((echo.wall - wall).abs() < 0.05, "seed {seed}: {} {wall}", echo.wall);
                assert!(error(&made, &found) < 0.03, "seed {seed}: {}", error(&made, &found));
                assert!(found.warnings.iter().any(|warning| warning.contains("r1 hears a reflection")));
            }
        }
    }

    #[test]
    fn gross_errors_are_no_echo() {
        for seed in 0..6 {
            let made = SimulateOptions {
                receivers: 8,
                transmitters: 24,
                noise: 0.01,
                outliers: 0.2,
                seed,
                ..Default::default()
            };
            let made = simulate(&made).unwrap();
            let found = calibrate(&made.pseudoranges, &CalibrateOptions { seed, ..Default::default() }).unwrap();
            assert!(found.receiver_echoes.is_empty(), "seed {seed}: {:?}", found.receiver_echoes);
        }
    }
}
