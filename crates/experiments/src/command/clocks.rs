//! `tdoa experiment clocks`.

use super::common::{Common, Size, thread_seconds};
use super::statistics::short;
use super::table::Table;
use crate::quantile::median;
use crate::trials::clocks::{CASES, Case};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Calibrates simulated networks with clocks of every kind, and sets the errors against the bound of the same unknowns:
/// noise of 1 cm, a tenth of the measurements missing, a twentieth gross errors, rates of 20 parts in a million over ten
/// minutes.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// What clocks do, such as `ranges` or `offsets`. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = case)]
    case: Vec<Case>,
    /// The plane, space, or both.
    #[arg(long, value_delimiter = ',', default_value = "2,3", value_parser = clap::value_parser!(u8).range(2..=3))]
    dimensions: Vec<u8>,
    /// The configurations.
    #[arg(long, value_delimiter = ',', default_value = "10r/20s,12r/60s")]
    configuration: Vec<Size>,
    /// Number of networks of each case, dimension and configuration.
    #[arg(long, default_value_t = 200)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

fn case(name: &str) -> Result<Case, String> {
    let names = || CASES.map(|case| case.name).join(", ");
    CASES.into_iter().find(|case| case.name == name).ok_or_else(|| format!("`{name}` is none of {}", names()))
}

const HEADER: &str = "case,dimensions,configuration,seed,error,bound,unique,processor_seconds";

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if arguments.instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let common = &arguments.common;
    let cases = if arguments.case.is_empty() { CASES.to_vec() } else { arguments.case.clone() };
    let mut rows: Vec<(Case, u8, Size)> = Vec::new();
    for &size in &arguments.configuration {
        for &case in &cases {
            rows.extend(arguments.dimensions.iter().map(|&dimensions| (case, dimensions, size)));
        }
    }
    let trials: Vec<((Case, u8, Size), u64)> =
        rows.iter().flat_map(|&row| common.seeds(arguments.instances).map(move |seed| (row, seed))).collect();
    let key = |((case, dimensions, size), seed): &((Case, u8, Size), u64)| {
        format!("{},{dimensions},{size},{seed}", case.name)
    };
    let keys: Vec<String> = trials.iter().map(key).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let found = table.resume(
        || (),
        |(), k| {
            let ((case, dimensions, size), seed) = trials[k];
            let (m, n) = (size.receivers, size.transmitters);
            let started = thread_seconds();
            let found = if dimensions == 2 { case.outcome::<2>(m, n, seed) } else { case.outcome::<3>(m, n, seed) };
            let found = found.map_err(Failure::unusable)?;
            let error = found.error.map_or_else(String::new, |error| format!("{error:.5e}"));
            let seconds = thread_seconds() - started;
            Ok(format!("{error},{:.5e},{},{seconds:.4}", found.bound, found.unique))
        },
    )?;
    let Some(found) = found else { return Ok(()) };
    let mut summary = String::from(
        "case,dimensions,configuration,networks,within_three_bounds,unique,beyond_and_unique,rms_over_bound_within,processor_seconds_median\n",
    );
    let each = arguments.instances as usize;
    for (g, (case, dimensions, size)) in rows.iter().enumerate() {
        let [errors, bounds, unique, seconds] = ["error", "bound", "unique", "processor_seconds"]
            .map(|column| found.numbers(column, g * each..(g + 1) * each));
        let within = |k: usize| errors[k] <= 3.0 * bounds[k];
        let count = |is: &dyn Fn(usize) -> bool| (0..each).filter(|&k| is(k)).count();
        let squares: f64 = (0..each).filter(|&k| within(k)).map(|k| (errors[k] / bounds[k]).powi(2)).sum();
        summary += &format!(
            "{},{dimensions},{size},{each},{},{},{},{},{}\n",
            case.name,
            count(&within),
            count(&|k| unique[k] == 1.0),
            count(&|k| unique[k] == 1.0 && !within(k)),
            short((squares / count(&within) as f64).sqrt()),
            short(median(&seconds)),
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
