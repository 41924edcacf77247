//! `tdoa experiment damaged`.

use std::path::{Path, PathBuf};

use crate::trials::calibration::{damage, oracle};
use tdoa::align::align;
use tdoa::calibrate::{Hypotheses, MinimalHypotheses};
use tdoa::read::{Units, read, read_nodes};
use tdoa::{CalibrateError, CalibrateOptions, Calibration, Pseudoranges, calibrate};

use super::common::Common;
use super::statistics::{mean, short};
use super::table::Table;
use crate::quantile::{median, quantile};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Calibrates recordings with ground truth as they are and damaged at random, beside the same
/// refinement started at the truth.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Folders with pseudoranges_m.csv and receivers_gt.csv; named by their last part in the
    /// tables.
    #[arg(long, required = true, value_delimiter = ',')]
    recordings: Vec<PathBuf>,
    /// Seeds a recording.
    #[arg(long, default_value_t = 20)]
    instances: u64,
    /// Share of the measurements that is removed from the damaged copies.
    #[arg(long, default_value_t = 0.2)]
    missing: f64,
    /// Share of the rest that is replaced by gross errors.
    #[arg(long, default_value_t = 0.1)]
    outliers: f64,
    /// Spread triples of transmitters a recording whose 6r/3s candidates are compared with the
    /// truth.
    #[arg(long, default_value_t = 500)]
    triples: u64,
    #[command(flatten)]
    common: Common,
}

struct Recording {
    name: String,
    measured: Pseudoranges,
    truth: Vec<Option<[f64; 2]>>,
}

const HEADER: &str = "recording,missing,outliers,seed,receiver_rms,oracle_rms,ratio,receiver_rms_scaled,unique,starts";
const CANDIDATES: &str = "recording,triple,candidates,nearest";

/// A candidate is near the truth if its receivers are within this share of the network's size.
const NEAR: f64 = 0.25;

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let common = &arguments.common;
    let recordings = arguments.recordings.iter().map(|folder| open(folder)).collect::<Result<Vec<_>, _>>()?;
    let kinds = [(0.0, 0.0), (arguments.missing, arguments.outliers)];
    let mut trials = Vec::new();
    for recording in &recordings {
        for kind in kinds {
            trials.extend(common.seeds(arguments.instances).map(|seed| (recording, kind, seed)));
        }
    }
    let keys: Vec<String> = trials.iter().map(|(r, (m, o), seed)| format!("{},{m},{o},{seed}", r.name)).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(
        || (),
        |(), k| {
            let (recording, (missing, outliers), seed) = trials[k];
            row(recording, missing, outliers, seed)
        },
    )?;
    let all: Vec<(&Recording, u64)> =
        recordings.iter().flat_map(|r| common.seeds(arguments.triples).map(move |triple| (r, triple))).collect();
    let keys: Vec<String> = all.iter().map(|(r, triple)| format!("{},{triple}", r.name)).collect();
    let table = Table::new(common, "candidates.csv", CANDIDATES, &keys, ranks);
    let candidates = table.resume(MinimalHypotheses::new, |source, k| Ok(nearest(source, all[k].0, all[k].1)))?;
    let (Some(rows), Some(candidates)) = (rows, candidates) else { return Ok(()) };

    let mut summary = String::from(
        "recording,missing,outliers,runs,within_1.1_of_oracle,receiver_rms_median,oracle_rms_median,ratio_median,ratio_max,\
         receiver_rms_scaled_median\n",
    );
    let each = arguments.instances as usize;
    for (g, recording) in recordings.iter().enumerate() {
        for (l, (missing, outliers)) in kinds.iter().enumerate() {
            let first = (g * kinds.len() + l) * each;
            let of = |column: &str| rows.numbers(column, first..first + each);
            let good = of("ratio").iter().filter(|ratio| **ratio <= 1.1).count();
            let typical = |column: &str| short(median(&of(column)));
            summary += &format!(
                "{},{missing},{outliers},{each},{good},{},{},{},{},{}\n",
                recording.name,
                typical("receiver_rms"),
                typical("oracle_rms"),
                typical("ratio"),
                short(quantile(&of("ratio"), 1.0)),
                typical("receiver_rms_scaled"),
            );
        }
    }
    let mut shares = String::from("recording,triples,with_candidate_near_truth,candidates_mean\n");
    let each = arguments.triples as usize;
    for (g, recording) in recordings.iter().enumerate() {
        let of = |column: &str| candidates.numbers(column, g * each..(g + 1) * each);
        let near = of("nearest").iter().filter(|distance| **distance <= NEAR).count();
        let share = short(near as f64 / each.max(1) as f64);
        shares += &format!("{},{each},{share},{}\n", recording.name, short(mean(&of("candidates"))));
    }
    common.write("summary.csv", &summary)?;
    common.write("candidates_summary.csv", &shares)?;
    output::print(&(summary + "\n" + &shares))
}

fn open(folder: &Path) -> Result<Recording, Failure> {
    let measured = read(&folder.join("pseudoranges_m.csv"), Units::Metres).map_err(Failure::unusable)?;
    let nodes = read_nodes(&folder.join("receivers_gt.csv")).map_err(Failure::unusable)?;
    let truth = nodes.in_order(measured.receiver_names()).ok_or_else(|| {
        Failure::Unusable(format!(
            "{}: receivers_gt.csv is not for the receivers of pseudoranges_m.csv",
            folder.display()
        ))
    })?;
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    if name.is_empty() || name.contains(',') {
        return Err(Failure::Unusable(format!("{}: give a folder with a name without commas", folder.display())));
    }
    Ok(Recording { name, measured, truth })
}

fn row(recording: &Recording, missing: f64, outliers: f64, seed: u64) -> Result<String, Failure> {
    let damaged = damage(&recording.measured, missing, outliers, seed).map_err(Failure::unusable)?;
    let mut options = CalibrateOptions::default();
    options.seed = seed;
    let best = oracle(&damaged, &recording.truth, &options).map_err(Failure::unusable)?;
    let best = best.truth.map_or(f64::NAN, |truth| truth.receiver_rms);
    match calibrate(&damaged, &options) {
        Ok(mut found) => {
            found.compare(&recording.truth);
            let Calibration { truth, unique, starts, .. } = found;
            let (rms, scaled) = truth.map_or((f64::NAN, f64::NAN), |t| (t.receiver_rms, t.receiver_rms_scaled));
            Ok(format!("{rms:.5},{best:.5},{:.4},{scaled:.5},{unique},{starts}", rms / best))
        }
        // No network is a failure of the run, not of the experiment.
        Err(CalibrateError::Degenerate(_) | CalibrateError::NotFound(_)) => {
            Ok(format!("inf,{best:.5},inf,inf,false,0"))
        }
        Err(error) => Err(Failure::unusable(error)),
    }
}

/// Candidates of one spread triple, and the distance of the nearest from the truth in sizes of the
/// network, before any refinement with other measurements.
fn nearest(source: &MinimalHypotheses, recording: &Recording, triple: u64) -> String {
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
