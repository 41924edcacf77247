//! `tdoa experiment reduced`.

use std::ops::Range;
use std::path::PathBuf;

use crate::quantile::median;
use crate::trials::reduced::{FOLD, Known, ReducedTrial, SAME, reduced_trial};
use tdoa::Emissions;
use tdoa::minimal::MinimalError;

use super::book::Rows;
use super::common::{Common, Size, thread_seconds};
use super::recording::{Measured, Recording, open_all};
use super::statistics::{mean, short};
use super::table::Table;
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Reduces recordings in space to the smallest sizes, at random and without gross errors, solves them
/// exactly and compares all candidates with the oracle: least squares from the true positions.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Folders with pseudoranges_m.csv (or ranges_m.csv) and receivers_gt.csv; named by their last part in the
    /// tables, by their last two where that is the same for several.
    #[arg(long, required = true, value_delimiter = ',')]
    recordings: Vec<PathBuf>,
    /// Solves ranges, of ranges_m.csv, which have no offsets.
    #[arg(long)]
    ranges: bool,
    /// Solves ranges that have one unknown constant.
    #[arg(long, conflicts_with = "ranges")]
    constant: bool,
    /// The configurations; a recording with fewer receivers is left out. Times are those of all threads with
    /// --threads 1 alone.
    #[arg(long, default_value = "7r/5s,10r/4s,6r/6s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Parts of each size a recording.
    #[arg(long, default_value_t = 13)]
    instances: u64,
    /// Measurements are clean if they are so many metres from what the true receivers and the event, as these
    /// tell, give.
    #[arg(long, default_value_t = 0.06)]
    bound: f64,
    #[command(flatten)]
    common: Common,
}

/// A network is near the truth if its receivers are within this share of their size.
const NEAR: f64 = 0.25;

const HEADER: &str = "configuration,recording,bound,seed,clean,refused,special,complex,lost,candidates,oracle_residual,oracle_exact,oracle_rms,nearest_rms,\
                      best_rms,size,distance_raw,distance,best_is_oracle,cheaper,distance_near,beyond,tenth,control,\
                      away,processor_seconds";

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if !(arguments.bound > 0.0 && arguments.bound.is_finite()) {
        return Err(Failure::Unusable(format!("--bound {}: give metres, above 0", arguments.bound)));
    }
    if arguments.instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let (table, emissions) = match (arguments.ranges, arguments.constant) {
        (true, _) => (Measured::Ranges, Emissions::Known),
        (_, true) => (Measured::Ranges, Emissions::Constant),
        _ => (Measured::Pseudoranges, Emissions::Unknown),
    };
    let recordings = open_all::<3>(&arguments.recordings, table)?;
    let known: Vec<Known> = recordings.iter().map(|r| Known::new(&r.measured, emissions, &r.truth)).collect();
    let (mut trials, mut groups) = (Vec::new(), Vec::new());
    for &size in &arguments.configuration {
        let first = trials.len();
        for (r, recording) in recordings.iter().enumerate() {
            if size.receivers <= known_receivers(recording) {
                trials.extend(arguments.common.seeds(arguments.instances).map(|seed| (size, r, seed)));
            }
        }
        groups.push((size, first..trials.len()));
    }
    if let Some((size, _)) = groups.iter().find(|(_, range)| range.is_empty()) {
        let least = size.receivers;
        return Err(Failure::Unusable(format!("{size}: no recording has {least} receivers that are known")));
    }
    let keys: Vec<String> = trials
        .iter()
        .map(|&(size, r, seed)| format!("{size},{},{},{seed}", recordings[r].name, arguments.bound))
        .collect();
    let table = Table::new(&arguments.common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(|| (), |(), k| row(trials[k].0, &known[trials[k].1], trials[k].2, arguments.bound))?;
    let Some(rows) = rows else { return Ok(()) };
    let mut summary = String::from(
        "configuration,tried,refused,special,lost,candidates_mean,with_candidates,oracle_exact,exact_found,found,nearly_real,fold,tenth,control,\
         away,unexplained,others_only,best_is_oracle,cheaper,oracle_near_truth,candidate_near_truth,oracle_rms_median,nearest_rms_median,best_rms_median,\
         oracle_residual_median,processor_seconds_median\n",
    );
    for (size, range) in groups {
        summary += &format!("{size},{}\n", sums(&rows, range).join(","));
    }
    arguments.common.write("summary.csv", &summary)?;
    output::print(&summary)
}

/// Receivers of a recording whose places are known.
fn known_receivers(recording: &Recording<3>) -> usize {
    recording.truth.iter().flatten().count()
}

fn row(size: Size, known: &Known, seed: u64, bound: f64) -> Result<String, Failure> {
    let Some(part) = known.part(size.receivers, size.transmitters, bound, seed) else {
        return Ok(format!("false{}", ",".repeat(21)));
    };
    let started = thread_seconds();
    let trial = reduced_trial(&part).map_err(Failure::unusable)?;
    let seconds = thread_seconds() - started;
    let ReducedTrial { complex, lost, candidates, oracle_exact, best_is_oracle, cheaper, is_away, .. } = trial;
    let special = matches!(
        trial.refused,
        Some(MinimalError::SpecialPosition | MinimalError::InOnePlane | MinimalError::TransmittersInOnePlane { .. })
    );
    let some = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.2e}"));
    Ok(format!(
        "true,{},{special},{complex},{lost},{candidates},{:.2e},{oracle_exact},{:.5},{:.5},{:.5},{:.5},{:.2e},{:.2e},{best_is_oracle},{cheaper},{},{},{},{},\
         {is_away},{seconds:.3}",
        trial.refused.is_some(),
        trial.oracle_residual,
        trial.oracle_rms,
        trial.nearest_rms,
        trial.best_rms,
        trial.size,
        trial.distance_raw,
        trial.distance,
        some(trial.distance_near),
        some(trial.beyond),
        some(trial.tenth),
        some(trial.control),
    ))
}

/// The sums over the parts of one size.
fn sums(rows: &Rows, range: Range<usize>) -> Vec<String> {
    let clean = rows.numbers("clean", range.clone());
    // Rows without a clean part say nothing else.
    let of = |column: &str| -> Vec<f64> {
        let all = rows.numbers(column, range.clone()).into_iter().zip(&clean);
        all.filter(|(_, clean)| **clean == 1.0).map(|(value, _)| value).collect()
    };
    let count = |all: &[bool]| all.iter().filter(|is| **is).count().to_string();
    let is = |column: &str| of(column).into_iter().map(|value| value == 1.0).collect::<Vec<bool>>();
    let within = |column: &str, limit: f64| of(column).into_iter().map(|value| value <= limit).collect::<Vec<bool>>();
    let both = |a: &[bool], b: &[bool]| a.iter().zip(b).map(|(a, b)| *a && *b).collect::<Vec<bool>>();
    let (exact, found) = (is("oracle_exact"), within("distance", SAME));
    // The others are looked for only where the oracle is not among the candidates.
    let away = both(&is("away"), &found.iter().map(|found| !found).collect::<Vec<bool>>());
    let reasons =
        [within("distance_near", SAME), within("beyond", FOLD), within("tenth", SAME), within("control", SAME), away];
    // A network that fits exactly has to be among them, whatever else is found.
    let unexplained: Vec<bool> =
        (0..found.len()).map(|k| !found[k] && (exact[k] || !reasons.iter().any(|all| all[k]))).collect();
    let sizes = of("size");
    let near = |column: &str| {
        let all = of(column).into_iter().zip(&sizes);
        count(&all.map(|(rms, size)| rms <= NEAR * size).collect::<Vec<bool>>())
    };
    // Parts without candidates have none to measure.
    let typical = |column: &str| {
        let all: Vec<f64> = of(column).into_iter().filter(|value| value.is_finite()).collect();
        short(median(&all))
    };
    let candidates = of("candidates");
    let mut cells = vec![
        found.len().to_string(),
        count(&is("refused")),
        count(&is("special")),
        of("lost").iter().sum::<f64>().to_string(),
        short(mean(&candidates)),
        candidates.iter().filter(|count| **count > 0.0).count().to_string(),
        count(&exact),
        count(&both(&exact, &found)),
        count(&found),
    ];
    cells.extend(reasons.iter().map(|all| count(all)));
    // Candidates are listed, none of which is the oracle.
    let others: Vec<bool> = candidates.iter().zip(&found).map(|(count, found)| *count > 0.0 && !found).collect();
    cells.extend([count(&unexplained), count(&others), count(&is("best_is_oracle")), count(&is("cheaper"))]);
    cells.extend(["oracle_rms", "nearest_rms"].map(near));
    let columns = ["oracle_rms", "nearest_rms", "best_rms", "oracle_residual", "processor_seconds"];
    cells.extend(columns.map(typical));
    cells
}
