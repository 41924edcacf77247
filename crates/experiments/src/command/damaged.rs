//! `tdoa experiment damaged`.

use std::path::PathBuf;

use crate::trials::calibration::{apart, coverage, damage, oracle};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;
use tdoa::align::align;
use tdoa::calibrate::{Calibrates, Dimension, Hypotheses, MinimalHypotheses};
use tdoa::{CalibrateError, CalibrateOptions, Pseudoranges, calibrate};

use super::book::Rows;
use super::common::{Common, thread_seconds};
use super::recording::{Measured, Recording, open_all};
use super::statistics::{mean, short};
use super::table::Table;
use crate::quantile::{median, quantile};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Calibrates recordings with ground truth as they are, damaged at random and in parts, beside the same
/// refinement started at the truth.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Folders with pseudoranges_m.csv and receivers_gt.csv; named by their last part in the
    /// tables, by their last two where that is the same for several.
    #[arg(long, required = true, value_delimiter = ',')]
    recordings: Vec<PathBuf>,
    /// Coordinates of a position: 2 or 3.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimensions: u8,
    /// Seeds a recording.
    #[arg(long, default_value_t = 20)]
    instances: u64,
    /// Share of the measurements that is removed from the damaged copies.
    #[arg(long, default_value_t = 0.2)]
    missing: f64,
    /// Share of the rest that is replaced by gross errors.
    #[arg(long, default_value_t = 0.1)]
    outliers: f64,
    /// Also undamaged parts with so many of the transmitters, chosen at random.
    #[arg(long, value_delimiter = ',')]
    transmitters: Vec<usize>,
    /// Also undamaged parts with so many of the receivers, chosen at random.
    #[arg(long, value_delimiter = ',')]
    receivers: Vec<usize>,
    /// In the plane, spread triples of transmitters a recording whose 6r/3s candidates are compared
    /// with the truth.
    #[arg(long, default_value_t = 500)]
    triples: u64,
    #[command(flatten)]
    common: Common,
}

/// What is made of a recording.
#[derive(Clone, Copy)]
struct Kind {
    receivers: Option<usize>,
    transmitters: Option<usize>,
    missing: f64,
    outliers: f64,
}

impl Kind {
    const WHOLE: Kind = Kind { receivers: None, transmitters: None, missing: 0.0, outliers: 0.0 };

    /// Its columns, for a recording of this size.
    fn key(self, measured: &Pseudoranges) -> String {
        let Kind { receivers, transmitters, missing, outliers } = self;
        let receivers = receivers.unwrap_or(measured.receivers());
        let transmitters = transmitters.unwrap_or(measured.transmitters());
        format!("{receivers},{transmitters},{missing},{outliers}")
    }

    /// The measurements, and numbers of the receivers among those of the recording.
    fn of(self, measured: &Pseudoranges, seed: u64) -> Result<(Pseudoranges, Vec<usize>), Failure> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut some = |all: usize, count: Option<usize>| {
            let mut order: Vec<usize> = (0..all).collect();
            if let Some(count) = count {
                order.shuffle(&mut rng);
                order.truncate(count);
                order.sort_unstable();
            }
            order
        };
        let receivers = some(measured.receivers(), self.receivers);
        let transmitters = some(measured.transmitters(), self.transmitters);
        let part = measured.select(&receivers, &transmitters);
        let damaged = damage(&part, self.missing, self.outliers, seed).map_err(Failure::unusable)?;
        Ok((damaged, receivers))
    }
}

const HEADER: &str = "recording,receivers,transmitters,missing,outliers,seed,receiver_rms,oracle_rms,ratio,receiver_rms_scaled,from_oracle,\
                      oracle_listed,unique,trusted,covered,covered_systematic,ellipses,starts,processor_seconds";
const CANDIDATES: &str = "recording,triple,candidates,nearest";

/// A candidate is near the truth if its receivers are within this share of the network's size.
const NEAR: f64 = 0.25;

/// Networks whose receivers are this near one another (root mean square, metres) are the same: wrong ones
/// are decimetres and more away.
const SAME: f64 = 0.1;

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if arguments.dimensions == 3 {
        let recordings = open_all::<3>(&arguments.recordings, Measured::Pseudoranges)?;
        return compared(arguments, &recordings, ranks).and_then(|summary| finish(arguments, summary, None));
    }
    let recordings = open_all::<2>(&arguments.recordings, Measured::Pseudoranges)?;
    let summary = compared(arguments, &recordings, ranks)?;
    let common = &arguments.common;
    let all: Vec<(&Recording<2>, u64)> =
        recordings.iter().flat_map(|r| common.seeds(arguments.triples).map(move |triple| (r, triple))).collect();
    let keys: Vec<String> = all.iter().map(|(r, triple)| format!("{},{triple}", r.name)).collect();
    let table = Table::new(common, "candidates.csv", CANDIDATES, &keys, ranks);
    let candidates = table.resume(MinimalHypotheses::new, |source, k| Ok(nearest(source, all[k].0, all[k].1)))?;
    let shares = candidates.map(|candidates| {
        let mut shares = String::from("recording,triples,with_candidate_near_truth,candidates_mean\n");
        let each = arguments.triples as usize;
        for (g, recording) in recordings.iter().enumerate() {
            let of = |column: &str| candidates.numbers(column, g * each..(g + 1) * each);
            let near = of("nearest").iter().filter(|distance| **distance <= NEAR).count();
            let share = short(near as f64 / each.max(1) as f64);
            shares += &format!("{},{each},{share},{}\n", recording.name, short(mean(&of("candidates"))));
        }
        shares
    });
    finish(arguments, summary, shares)
}

/// Writes the sums, on rank 0, which alone has them.
fn finish(arguments: &Arguments, summary: Option<String>, shares: Option<String>) -> Result<(), Failure> {
    let Some(summary) = summary else { return Ok(()) };
    arguments.common.write("summary.csv", &summary)?;
    let Some(shares) = shares else { return output::print(&summary) };
    arguments.common.write("candidates_summary.csv", &shares)?;
    output::print(&(summary + "\n" + &shares))
}

/// Calibrates every recording as it is, damaged and in parts; the sums, on rank 0.
fn compared<const D: usize>(
    arguments: &Arguments,
    recordings: &[Recording<D>],
    ranks: Option<&Ranks<'_>>,
) -> Result<Option<String>, Failure>
where
    Dimension<D>: Calibrates<D>,
{
    let common = &arguments.common;
    for recording in recordings {
        let (m, n) = (recording.measured.receivers(), recording.measured.transmitters());
        for (option, counts, all) in
            [("--receivers", &arguments.receivers, m), ("--transmitters", &arguments.transmitters, n)]
        {
            if let Some(count) = counts.iter().find(|count| !(1..=all).contains(*count)) {
                let name = &recording.name;
                return Err(Failure::Unusable(format!("{option} {count}: {name} has {all}; give 1 to {all}")));
            }
        }
    }
    let Arguments { missing, outliers, .. } = *arguments;
    let mut kinds = vec![Kind::WHOLE, Kind { missing, outliers, ..Kind::WHOLE }];
    kinds.extend(arguments.transmitters.iter().map(|&count| Kind { transmitters: Some(count), ..Kind::WHOLE }));
    kinds.extend(arguments.receivers.iter().map(|&count| Kind { receivers: Some(count), ..Kind::WHOLE }));
    let mut trials = Vec::new();
    for recording in recordings {
        for &kind in &kinds {
            trials.extend(common.seeds(arguments.instances).map(|seed| (recording, kind, seed)));
        }
    }
    let key = |recording: &Recording<D>, kind: Kind| format!("{},{}", recording.name, kind.key(&recording.measured));
    let keys: Vec<String> =
        trials.iter().map(|&(recording, kind, seed)| format!("{},{seed}", key(recording, kind))).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(|| (), |(), k| row(trials[k].0, trials[k].1, trials[k].2))?;
    let Some(rows) = rows else { return Ok(None) };
    let mut summary = String::from(
        "recording,receivers,transmitters,missing,outliers,runs,within_1.1_of_oracle,receiver_rms_median,oracle_rms_median,ratio_median,\
         ratio_max,receiver_rms_scaled_median,oracle_found,oracle_among_alternatives,trusted,unique,unique_and_wrong,trusted_and_unlisted,\
         coverage_95,coverage_95_systematic,processor_seconds_median\n",
    );
    let each = arguments.instances as usize;
    let mut first = 0;
    for recording in recordings {
        for &kind in &kinds {
            let sums = sums(&rows, first..first + each);
            summary += &format!("{},{each},{}\n", key(recording, kind), sums.join(","));
            first += each;
        }
    }
    Ok(Some(summary))
}

/// The sums over some rows.
fn sums(rows: &Rows, range: std::ops::Range<usize>) -> Vec<String> {
    let of = |column: &str| rows.numbers(column, range.clone());
    let count = |all: Vec<bool>| all.into_iter().filter(|is| *is).count().to_string();
    let typical = |column: &str| short(median(&of(column)));
    let total = |column: &str| of(column).iter().sum::<f64>();
    // The oracle may end in another network than the true one, too; one no farther from the truth is not wrong.
    let is_found = |(distance, ratio): (f64, f64)| distance <= SAME || ratio <= 1.1;
    let found: Vec<bool> = of("from_oracle").into_iter().zip(of("ratio")).map(is_found).collect();
    let is = |column: &str| of(column).iter().map(|is| *is == 1.0).collect::<Vec<bool>>();
    let (listed, unique, trusted) = (is("oracle_listed"), is("unique"), is("trusted"));
    let both = |a: &[bool], b: &[bool]| a.iter().zip(b).map(|(a, b)| *a && *b).collect::<Vec<bool>>();
    let not = |all: &[bool]| all.iter().map(|is| !is).collect::<Vec<bool>>();
    let wrong = not(&found);
    vec![
        count(of("ratio").iter().map(|ratio| *ratio <= 1.1).collect()),
        typical("receiver_rms"),
        typical("oracle_rms"),
        typical("ratio"),
        short(quantile(&of("ratio"), 1.0)),
        typical("receiver_rms_scaled"),
        count(found),
        count(both(&wrong, &listed)),
        count(trusted.clone()),
        count(unique.clone()),
        count(both(&unique, &wrong)),
        count(both(&both(&trusted, &wrong), &not(&listed))),
        short(total("covered") / total("ellipses")),
        short(total("covered_systematic") / total("ellipses")),
        typical("processor_seconds"),
    ]
}

fn row<const D: usize>(recording: &Recording<D>, kind: Kind, seed: u64) -> Result<String, Failure>
where
    Dimension<D>: Calibrates<D>,
{
    let (measured, receivers) = kind.of(&recording.measured, seed)?;
    let truth: Vec<Option<[f64; D]>> = receivers.iter().map(|&i| recording.truth[i]).collect();
    let mut options = CalibrateOptions::new();
    options.seed = seed;
    let oracle = match oracle(&measured, &truth, &options) {
        // What is left of the recording determines nothing.
        Err(CalibrateError::Degenerate(_) | CalibrateError::NotFound(_)) => {
            return Ok("inf,inf,inf,inf,inf,false,false,false,0,0,0,0,0".to_string());
        }
        result => result.map_err(Failure::unusable)?,
    };
    let best = oracle.truth.as_ref().map_or(f64::NAN, |truth| truth.receiver_rms);
    let started = thread_seconds();
    let found = calibrate(&measured, &options);
    let seconds = thread_seconds() - started;
    match found {
        Ok(mut found) => {
            found.compare(&truth);
            let (rms, scaled) =
                found.truth.as_ref().map_or((f64::NAN, f64::NAN), |t| (t.receiver_rms, t.receiver_rms_scaled));
            let (covered, ellipses) = coverage(&found, &found.receiver_covariance, &truth);
            // Where these are not estimated, the usual ones are all there is.
            let wider =
                found.systematic.as_ref().map_or(&found.receiver_covariance, |errors| &errors.receiver_covariance);
            let (wider, _) = coverage(&found, wider, &truth);
            let from = apart(&found.receivers, &oracle.receivers).unwrap_or(f64::INFINITY);
            let near = |other: &[Option<[f64; D]>]| apart(other, &oracle.receivers).is_some_and(|rms| rms <= SAME);
            let listed = found.alternatives.iter().any(|other| near(&other.receivers));
            Ok(format!(
                "{rms:.5},{best:.5},{:.4},{scaled:.5},{from:.5},{listed},{},{},{covered},{wider},{ellipses},{},{seconds:.4}",
                rms / best,
                found.unique,
                found.distrust().is_none(),
                found.starts
            ))
        }
        // No network is a failure of the run, not of the experiment.
        Err(CalibrateError::Degenerate(_) | CalibrateError::NotFound(_)) => {
            Ok(format!("inf,{best:.5},inf,inf,inf,false,false,false,0,0,0,0,{seconds:.4}"))
        }
        Err(error) => Err(Failure::unusable(error)),
    }
}

/// Candidates of one spread triple, and the distance of the nearest from the truth in sizes of the
/// network, before any refinement with other measurements.
fn nearest(source: &MinimalHypotheses, recording: &Recording<2>, triple: u64) -> String {
    // The sizes of the subsets take turns; the first of the three is 6r/3s.
    let proposals = source.propose(&recording.measured, 3 * triple as usize, 0);
    let known: Vec<[f64; 2]> = recording.truth.iter().flatten().copied().collect();
    let count = known.len().max(1) as f64;
    let centre = [0, 1].map(|k| known.iter().map(|p| p[k]).sum::<f64>() / count);
    let size =
        (known.iter().map(|p| (p[0] - centre[0]).powi(2) + (p[1] - centre[1]).powi(2)).sum::<f64>() / count).sqrt();
    let distances = proposals.iter().filter_map(|part| {
        let pairs = part.receivers.iter().zip(&recording.truth).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        let (found, known): (Vec<_>, Vec<_>) = pairs.unzip();
        if found.len() < 3 { None } else { align(&found, &known, false).map(|alignment| alignment.rms / size) }
    });
    let least = distances.reduce(f64::min);
    format!("{},{}", proposals.len(), least.map_or("inf".into(), |least| format!("{least:.4}")))
}
