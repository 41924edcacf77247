//! Trials on recordings reduced to the smallest sizes in space: the exact candidates beside the oracle,
//! which is least squares from the true positions on the same measurements.

use crate::quantile::median;
use crate::trials::calibration::apart;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;
use tdoa::accuracy::position_error;
use tdoa::loss::Loss;
use tdoa::minimal::{Candidate, MinimalError, MinimalOptions, MinimalSolution, adjust, spatial};
use tdoa::multilateration::{Located, Sight, receiver, transmitter};
use tdoa::{Emissions, Network, Pseudoranges};

/// The loss by which events are located from the true receivers: Cauchy's, in metres.
const LOSS: Loss = Loss { nu: 1.0, scale: 0.05 };

/// Clean events for each that is chosen.
const CHOICE: usize = 2;

/// Events nearer than this, in metres, are at one place: some recordings begin with a loudspeaker at rest, and
/// events that measure the same to the last sample.
const APART: f64 = 0.05;

/// Draws of receivers, until enough events are clean.
const DRAWS: usize = 100;

/// Networks whose nodes differ by less than this share of their size are one.
pub const SAME: f64 = 1e-3;

/// Residuals below this (root mean square, metres) are rounding, those of the recordings millimetres.
const EXACT: f64 = 1e-7;

/// Imaginary parts up to this share of the size of the data are nearly real, as in the calibration.
const NEAR_REAL: f64 = 0.1;

/// Distances that may be negative, as a share of the size of the data, as in the calibration.
const TOLERANCE: f64 = 0.05;

/// Residuals of candidates that are refined, as a share of the size of the data: all of them, because the
/// equations of sizes with a spare measurement or two magnify noise.
const ALL: f64 = 1.0;

/// Spare measurements from which on no paths are tracked, and the solvers have one candidate.
const DIRECT: usize = 3;

/// How far beyond a fold, as shares of the oracle's residuals, until two candidates are near.
const BEYOND: [f64; 3] = [1e-3, 1e-4, 1e-5];

/// Beyond a fold there is a candidate on either side of the oracle, both nearer than this share of the network's
/// size.
pub const FOLD: f64 = 0.1;

/// How many times as large as the truth a network is whose nodes move away.
const AWAY: f64 = 10.0;

/// The share of the oracle's residuals that is left with less noise.
const TENTH: f64 = 0.1;

/// A recording, and where its events were as the true receivers tell.
pub struct Known {
    measured: Pseudoranges,
    emissions: Emissions,
    receivers: Vec<Option<[f64; 3]>>,
    events: Vec<Option<Located<3>>>,
}

/// A part of a recording, all of whose measurements agree with the truth.
pub struct Part {
    /// Its measurements.
    pub measured: Pseudoranges,
    /// What is known of their offsets.
    pub emissions: Emissions,
    /// The true receivers, and the events as these tell.
    pub truth: Network<3>,
}

impl Known {
    /// Locates every event from the true receivers. A constant of all is the median of the offsets that the events
    /// have each by itself.
    pub fn new(measured: &Pseudoranges, emissions: Emissions, receivers: &[Option<[f64; 3]>]) -> Known {
        let sights = |j: usize, offset: f64| -> Vec<Sight<3>> {
            let heard = receivers.iter().enumerate();
            let sight = |(i, r): (usize, &Option<[f64; 3]>)| {
                Some(Sight { position: (*r)?, length: measured.get(i, j)? - offset, precision: 1.0 })
            };
            heard.filter_map(sight).collect()
        };
        let all = 0..measured.transmitters();
        let free: Vec<_> = all.clone().map(|j| transmitter(&sights(j, 0.0), &LOSS)).collect();
        // With a known offset the two roles are the same.
        let with = |offset: f64| -> Vec<Option<Located<3>>> {
            let at = |j: usize| Some(Located { offset, ..receiver(&sights(j, offset), &LOSS)? });
            all.clone().map(at).collect()
        };
        let events = match emissions {
            Emissions::Known => with(0.0),
            Emissions::Constant => {
                let offsets: Vec<f64> = free.iter().flatten().map(|event| event.offset).collect();
                with(median(&offsets))
            }
            _ => free,
        };
        Known { measured: measured.clone(), emissions, receivers: receivers.to_vec(), events }
    }

    /// Whether a measurement is there and within `bound` metres of the truth.
    fn is_clean(&self, i: usize, j: usize, bound: f64) -> bool {
        let (Some(f), Some(r), Some(event)) = (self.measured.get(i, j), self.receivers[i], self.events[j]) else {
            return false;
        };
        (f - event.offset - distance(r, event.position)).abs() <= bound
    }

    /// Receivers and events chosen at random, so that all measurements are within `bound` metres of the
    /// truth, and the events at different places and among at least twice as many; `None` if there are none
    /// after a hundred draws of the receivers.
    pub fn part(&self, receivers: usize, transmitters: usize, bound: f64, seed: u64) -> Option<Part> {
        // Recordings of the same receivers differ in the number of events; their parts then differ in both.
        let mut rng = Pcg64Mcg::seed_from_u64(seed ^ ((self.events.len() as u64) << 32));
        let mut some = |mut all: Vec<usize>, count: usize| {
            all.shuffle(&mut rng);
            all.truncate(count);
            all.sort_unstable();
            (all.len() == count).then_some(all)
        };
        let known: Vec<usize> = (0..self.receivers.len()).filter(|&i| self.receivers[i].is_some()).collect();
        for _ in 0..DRAWS {
            let rows = some(known.clone(), receivers)?;
            let clean = |j: &usize| rows.iter().all(|&i| self.is_clean(i, *j, bound));
            let clean: Vec<usize> = (0..self.events.len()).filter(clean).collect();
            // Otherwise the same part would come again and again.
            if clean.len() < CHOICE * transmitters {
                continue;
            }
            let columns = some(clean, transmitters)?;
            let events: Vec<Located<3>> = columns.iter().filter_map(|&j| self.events[j]).collect();
            let coincide =
                |k: usize| events[..k].iter().any(|other| distance(other.position, events[k].position) < APART);
            if (0..events.len()).any(coincide) {
                continue;
            }
            let truth = Network::new(
                rows.iter().filter_map(|&i| self.receivers[i]).collect(),
                events.iter().map(|event| event.position).collect(),
                events.iter().map(|event| event.offset).collect(),
            );
            let measured = self.measured.select(&rows, &columns);
            return Some(Part { measured, emissions: self.emissions, truth });
        }
        None
    }
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
}

/// One part, solved.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedTrial {
    /// Root mean square residual of the oracle, metres.
    pub oracle_residual: f64,
    /// Whether the oracle fits as exactly as rounding allows.
    pub oracle_exact: bool,
    /// How far its receivers are from the true ones after the best rigid alignment, root mean square, metres.
    pub oracle_rms: f64,
    /// How far the receivers of the candidate nearest to the truth are from the true ones, refined, metres.
    pub nearest_rms: f64,
    /// How far those of the candidate with the smallest residual are, refined, metres.
    pub best_rms: f64,
    /// Size of the true network, metres.
    pub size: f64,
    /// Complex roots.
    pub complex: usize,
    /// Paths lost.
    pub lost: usize,
    /// Physical candidates, refined.
    pub candidates: usize,
    /// Relative distance of the nearest candidate from the oracle, as it comes from the solver.
    pub distance_raw: f64,
    /// Relative distance of the nearest candidate from the oracle, refined.
    pub distance: f64,
    /// Whether the one with the smallest residual is the oracle.
    pub best_is_oracle: bool,
    /// Whether another network has a smaller residual than the oracle's.
    pub cheaper: bool,
    /// Whether the oracle is ten times as large as the true network, or more: a node moves away, and least squares has no
    /// minimum.
    pub is_away: bool,
    /// Where the oracle is not among them, and the size takes paths: the relative distance with roots that are
    /// nearly real.
    pub distance_near: Option<f64>,
    /// Where the oracle does not fit exactly, and is not among the candidates of its own network either, if that has
    /// more measurements than unknowns: relative distance of the second nearest candidate, with a thousandth of the oracle's residuals reversed,
    /// or less where that is too far.
    pub beyond: Option<f64>,
    /// Where it is not among them otherwise: the relative distance with a tenth of its residuals, which has the
    /// same oracle.
    pub tenth: Option<f64>,
    /// And with none of them, on the exact measurements of its own network.
    pub control: Option<f64>,
    /// Why there is no candidate.
    pub refused: Option<MinimalError>,
}

impl ReducedTrial {
    /// Whether the oracle is among the candidates of real roots.
    pub fn found(&self) -> bool {
        self.distance <= SAME
    }
}

/// Solves a part and compares its candidates with the oracle.
///
/// # Errors
/// If the size is none that is solved in space, two nodes coincide, or the truth is none of the part's size.
pub fn reduced_trial(part: &Part) -> Result<ReducedTrial, MinimalError> {
    let Part { measured, emissions, truth } = part;
    let (m, n) = (measured.receivers(), measured.transmitters());
    let offsets = match emissions {
        Emissions::Known => 0,
        Emissions::Constant => 1,
        _ => n,
    };
    let spare = (m * n + 6).saturating_sub(3 * (m + n) + offsets);
    let mut judged = MinimalOptions::default();
    judged.emissions = *emissions;
    let mut options = judged.clone();
    judged.tolerance = TOLERANCE;
    options.tolerance = if spare < DIRECT { ALL } else { TOLERANCE };
    let oracle = adjust(measured, truth, &judged)?;
    let solved = spatial::solve(measured, &options);
    if let Some(error) = solved.as_ref().err().filter(|error| !is_of_data(error)) {
        return Err(error.clone());
    }
    let found = solved.as_ref().ok();
    let refined = refined(measured, found, &judged);
    let best = refined.iter().min_by(|a, b| a.residual.total_cmp(&b.residual));
    let rms = |network: &Network<3>| from_truth(network, truth);
    let from = |candidates: &[Candidate<3>]| distances(candidates, &oracle)[0];
    let cheaper = |c: &Candidate<3>| c.residual < 0.999 * oracle.residual && from(std::slice::from_ref(c)) > SAME;
    let mut trial = ReducedTrial {
        oracle_residual: oracle.residual,
        oracle_exact: oracle.residual <= EXACT,
        oracle_rms: rms(&oracle.network),
        nearest_rms: refined.iter().map(|c| rms(&c.network)).fold(f64::INFINITY, f64::min),
        best_rms: best.map_or(f64::INFINITY, |c| rms(&c.network)),
        size: truth.size(),
        complex: found.map_or(0, |solution| solution.counts.complex),
        lost: found.map_or(0, |solution| solution.paths.failed),
        candidates: refined.len(),
        distance_raw: from(found.map_or(&[], |solution| &solution.candidates)),
        distance: from(&refined),
        best_is_oracle: best.is_some_and(|c| from(std::slice::from_ref(c)) <= SAME),
        cheaper: spare > 0 && refined.iter().any(cheaper),
        is_away: oracle.network.size() > AWAY * truth.size(),
        distance_near: None,
        beyond: None,
        tenth: None,
        control: None,
        refused: solved.as_ref().err().cloned(),
    };
    if trial.found() {
        return Ok(trial);
    }
    if spare < DIRECT {
        let mut nearly = options.clone();
        nearly.near_real = NEAR_REAL;
        trial.distance_near =
            Some(from(&self::refined(measured, spatial::solve(measured, &nearly).ok().as_ref(), &judged)));
    }
    // The measurements of the oracle's own network with a share of its residuals; it remains the oracle.
    let own = oracle.network.pseudoranges();
    let with = |share: f64| -> [f64; 2] {
        let values = own.iter().zip(measured.cells().values()).map(|(p, f)| p + share * (f - p)).collect();
        let Ok(other) = Pseudoranges::new(m, n, values) else { return [f64::INFINITY; 2] };
        distances(&self::refined(&other, spatial::solve(&other, &options).ok().as_ref(), &judged), &oracle)
    };
    if spare > 0 || trial.oracle_exact {
        trial.tenth = Some(with(TENTH)[0]);
        trial.control = Some(with(0.0)[0]);
    }
    // Measurements may have to fulfil an equation of their own, as of ranges 5r/5s; a spare one then does not tell
    // roots apart.
    if !trial.oracle_exact && spare < DIRECT && trial.control.is_none_or(|distance| distance > SAME) {
        let mut second = f64::INFINITY;
        for share in BEYOND {
            second = with(-share)[1];
            if second <= FOLD {
                break;
            }
        }
        trial.beyond = Some(second);
    }
    Ok(trial)
}

/// Whether the measurements, and not the size, are why there is no network.
fn is_of_data(error: &MinimalError) -> bool {
    use MinimalError::{InOnePlane, NoNetwork, SpecialPosition, TransmittersInOnePlane};
    matches!(error, NoNetwork | SpecialPosition | InOnePlane | TransmittersInOnePlane { .. })
}

/// The candidates of a solution, each led on by least squares; of these the physical ones.
fn refined(
    measured: &Pseudoranges,
    solution: Option<&MinimalSolution<3>>,
    options: &MinimalOptions,
) -> Vec<Candidate<3>> {
    let all = solution.map_or(&[][..], |solution| &solution.candidates);
    // One that cannot be refined is none.
    all.iter().filter_map(|c| adjust(measured, &c.network, options).ok()).filter(|c| c.physical).collect()
}

/// Relative distances of the two candidates that are nearest to a network.
fn distances(candidates: &[Candidate<3>], network: &Candidate<3>) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for distance in candidates.iter().map(|c| position_error(&c.network, &network.network)) {
        if distance < least[0] {
            least = [distance, least[0]];
        } else if distance < least[1] {
            least[1] = distance;
        }
    }
    least
}

/// Distance of the receivers from the true ones after the best rigid alignment, root mean square, metres.
fn from_truth(network: &Network<3>, truth: &Network<3>) -> f64 {
    let some = |network: &Network<3>| network.receivers.iter().copied().map(Some).collect::<Vec<_>>();
    apart(&some(network), &some(truth)).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::{Known, SAME, reduced_trial};
    use tdoa::{Emissions, Layout, Pseudoranges, SimulateOptions, Simulation, simulate};

    fn room(noise: f64) -> Simulation<3> {
        let mut options = SimulateOptions::new();
        (options.receivers, options.transmitters, options.seed) = (10, 12, 4);
        (options.layout, options.noise) = (Layout::Normal, noise);
        simulate(&options).unwrap()
    }

    fn known(simulation: &Simulation<3>, wrong: &[(usize, f64)]) -> Known {
        let mut values = simulation.pseudoranges.dense();
        for &(cell, error) in wrong {
            values[cell] += error;
        }
        let measured = Pseudoranges::new(10, 12, values).unwrap();
        let receivers: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
        Known::new(&measured, Emissions::Unknown, &receivers)
    }

    #[test]
    fn parts_have_no_gross_errors_and_lie_at_the_truth() {
        let simulation = room(1e-3);
        // One error in each of the first six events.
        let known = known(&simulation, &[0, 13, 26, 39, 52, 65].map(|cell| (cell, 0.5)));
        for seed in 0..20 {
            let part = known.part(9, 3, 0.02, seed).unwrap();
            let residual = part.truth.rms(&part.measured);
            assert!(residual < 5e-3, "{seed}: {residual}");
        }
        // Six events are clean at all receivers; there is no eleventh receiver.
        assert!(known.part(10, 4, 0.02, 0).is_none() && known.part(11, 3, 0.02, 0).is_none());
    }

    #[test]
    fn the_oracle_is_among_the_candidates() {
        let known = known(&room(1e-5), &[]);
        for (receivers, transmitters) in [(8, 5), (9, 5), (7, 6)] {
            let part = known.part(receivers, transmitters, 0.01, 1).unwrap();
            let trial = reduced_trial(&part).unwrap();
            assert!(trial.found() && trial.distance <= SAME && trial.refused.is_none(), "{trial:?}");
            assert!(trial.best_is_oracle && !trial.cheaper && !trial.oracle_exact, "{trial:?}");
            assert!(trial.oracle_rms < 0.01 && (trial.best_rms - trial.oracle_rms).abs() < 1e-4, "{trial:?}");
        }
    }

    /// Counts of Kuang, Burgess, Torstensson and Astrom 2013 (38 and 42), and of `families/4r7s_constant.toml`.
    #[test]
    fn smallest_sizes_of_ranges_fit_exactly() {
        use Emissions::{Constant, Known as Ranges};
        for (emissions, receivers, transmitters, roots) in
            [(Ranges, 4, 6, 38), (Ranges, 6, 4, 38), (Constant, 4, 7, 388)]
        {
            let mut options = SimulateOptions::new();
            (options.receivers, options.transmitters, options.seed) = (8, 16, 4);
            (options.layout, options.noise) = (Layout::Normal, 1e-5);
            options.emissions = emissions;
            let room: Simulation<3> = simulate(&options).unwrap();
            let truth: Vec<_> = room.network.receivers.iter().copied().map(Some).collect();
            let part =
                Known::new(&room.pseudoranges, emissions, &truth).part(receivers, transmitters, 0.01, 1).unwrap();
            assert!(
                part.truth.rms(&part.measured) < 1e-4
                    && !part.truth.offsets.iter().any(|o| *o != part.truth.offsets[0])
            );
            let trial = reduced_trial(&part).unwrap();
            assert!(trial.oracle_exact && trial.found() && trial.lost == 0 && !trial.is_away, "{trial:?}");
            assert_eq!(trial.complex, roots);
        }
    }

    #[test]
    fn a_smallest_size_fits_exactly() {
        let known = known(&room(1e-5), &[]);
        let trial = reduced_trial(&known.part(7, 5, 0.01, 2).unwrap()).unwrap();
        assert!(trial.oracle_exact && trial.found() && trial.lost == 0, "{trial:?}");
        assert_eq!(trial.complex, 2321);
    }
}
