//! `tdoa experiment sound`.

use super::common::{Common, thread_seconds};
use super::statistics::short;
use super::table::Table;
use crate::quantile::median;
use crate::trials::sound::{CASES, Case};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Receivers further than this from the truth are not found, metres.
const FOUND: f64 = 3e-3;

/// Listens to simulated recordings of a room with echoes, and calibrates what is heard: claps, or chirps that are known, in
/// a room of 8 m by 6 m by 3 m.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Numbers of cases from 1 on, in the order of the table. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u8).range(1..=CASES.len() as i64))]
    case: Vec<u8>,
    /// Number of microphones.
    #[arg(long, default_value_t = 10)]
    microphones: usize,
    /// Number of sounds.
    #[arg(long, default_value_t = 20)]
    sounds: usize,
    /// Number of rooms of each case.
    #[arg(long, default_value_t = 20)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

const HEADER: &str = "case,seed,found,false_events,arrivals,wrong,median_us,error_mm,unique,processor_seconds";

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if arguments.instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let common = &arguments.common;
    let all: Vec<usize> = if arguments.case.is_empty() {
        (0..CASES.len()).collect()
    } else {
        arguments.case.iter().map(|number| usize::from(*number) - 1).collect()
    };
    let trials: Vec<(Case, usize, u64)> = all
        .iter()
        .flat_map(|&case| common.seeds(arguments.instances).map(move |seed| (CASES[case], case + 1, seed)))
        .collect();
    let keys: Vec<String> = trials.iter().map(|(_, number, seed)| format!("{number},{seed}")).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let (microphones, sounds) = (arguments.microphones, arguments.sounds);
    let found = table.resume(
        || (),
        |(), k| {
            let (case, _, seed) = trials[k];
            let started = thread_seconds();
            let folder = tempfile::tempdir().map_err(Failure::unusable)?;
            let found = case.outcome(microphones, sounds, seed, folder.path()).map_err(Failure::unusable)?;
            let error = found.error.map_or_else(String::new, |error| format!("{:.4}", 1e3 * error));
            let seconds = thread_seconds() - started;
            Ok(format!(
                "{},{},{},{},{:.4},{error},{},{seconds:.4}",
                found.found,
                found.false_events,
                found.arrivals,
                found.wrong,
                1e6 * found.median,
                found.unique
            ))
        },
    )?;
    let Some(found) = found else { return Ok(()) };
    let mut summary = String::from(
        "case,rooms,sounds,found,false_events,heard_share,wrong_share,median_us,within_3_mm,error_mm_median,unique,beyond_and_unique\n",
    );
    let each = arguments.instances as usize;
    for (g, &case) in all.iter().enumerate() {
        let of = |column: &str| found.numbers(column, g * each..(g + 1) * each);
        let sum = |column: &str| of(column).into_iter().sum::<f64>();
        let (errors, unique) = (of("error_mm"), of("unique"));
        let within = |k: usize| errors[k] <= 1e3 * FOUND;
        let count = |is: &dyn Fn(usize) -> bool| (0..each).filter(|&k| is(k)).count();
        let known: Vec<f64> = errors.iter().copied().filter(|error| error.is_finite()).collect();
        summary += &format!(
            "{},{each},{},{},{},{},{},{},{},{},{},{}\n",
            CASES[case].name,
            each * sounds,
            sum("found"),
            sum("false_events"),
            short(sum("arrivals") / (sum("found") * microphones as f64)),
            short(sum("wrong") / sum("arrivals")),
            short(median(&of("median_us"))),
            count(&within),
            if known.is_empty() { String::new() } else { short(median(&known)) },
            count(&|k| unique[k] == 1.0),
            count(&|k| unique[k] == 1.0 && !within(k)),
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
