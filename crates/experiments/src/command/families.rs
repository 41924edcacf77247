//! `tdoa experiment families`.

use super::common::{Common, thread_seconds};
use super::statistics::short;
use super::table::Table;
use crate::quantile::median;
use crate::trials::families::{End, Kind, Known, Stopped, searched, singular};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Searches for all solutions of parameter families whose numbers are known, as `hc monodromy` does without options,
/// and counts what is wrong and said to be whole.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Kinds of families, such as `orbits` or `minors`. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = kind)]
    kind: Vec<(Kind, &'static str)>,
    /// Number of families of each kind.
    #[arg(long, default_value_t = 50)]
    instances: u64,
    /// Searches of each family, with different seeds.
    #[arg(long, default_value_t = 2)]
    searches: u64,
    /// Writes families.sing instead: input of the program Singular, which counts the solutions of these families modulo
    /// two primes.
    #[arg(long)]
    singular: bool,
    #[command(flatten)]
    common: Common,
}

fn kind(name: &str) -> Result<(Kind, &'static str), String> {
    let names = || Kind::ALL.map(|(_, name)| name).join(", ");
    Kind::ALL.into_iter().find(|kind| kind.1 == name).ok_or_else(|| format!("`{name}` is none of {}", names()))
}

const HEADER: &str =
    "kind,family,search,solutions,right,wrong,no_pair,no_trace,not_excluded,refused,found,multiple,seconds";

fn row(known: &Known, search: u64) -> String {
    let before = thread_seconds();
    let end = searched(known, search);
    let seconds = thread_seconds() - before;
    let (found, multiple) = match &end {
        End::Whole(found, multiple) => (found.to_string(), multiple.len().to_string()),
        _ => Default::default(),
    };
    let is_right = end.is_right(known);
    let no_trace = matches!(end, End::Undetermined(stopped) if stopped != Stopped::OrbitsWhole);
    format!(
        "{},{is_right},{},{},{no_trace},{},{},{found},{multiple},{}",
        known.regular,
        matches!(end, End::Whole(..)) && !is_right,
        end == End::NoPair,
        end == End::Undetermined(Stopped::OrbitsWhole),
        matches!(end, End::Refused(_)),
        short(seconds)
    )
}

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let Arguments { instances, searches, common, .. } = arguments;
    if *instances == 0 || *searches == 0 {
        return Err(Failure::Unusable("--instances and --searches must be at least 1".into()));
    }
    let kinds = if arguments.kind.is_empty() { Kind::ALL.to_vec() } else { arguments.kind.clone() };
    let families: Vec<(String, Known)> = kinds
        .iter()
        .flat_map(|&(kind, name)| {
            common.seeds(*instances).map(move |seed| (format!("{name},{seed}"), kind.family(seed)))
        })
        .collect();
    if arguments.singular {
        return common.write("families.sing", &singular(&families));
    }
    let all: Vec<(&Known, u64)> =
        families.iter().flat_map(|(_, known)| (0..*searches).map(move |search| (known, search))).collect();
    let keys: Vec<String> =
        families.iter().flat_map(|(key, _)| (0..*searches).map(move |search| format!("{key},{search}"))).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(|| (), |(), k| Ok(row(all[k].0, all[k].1)))?;
    let Some(rows) = rows else { return Ok(()) };
    let counted = ["right", "wrong", "no_pair", "no_trace", "not_excluded", "refused"];
    let mut summary = format!(
        "kind,families,searches,solutions_least,solutions_most,{},seconds_median,seconds_most\n",
        counted.join(",")
    );
    let each = (instances * searches) as usize;
    for (g, (_, name)) in kinds.iter().enumerate() {
        let of = |column: &str| rows.numbers(column, g * each..(g + 1) * each);
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let (solutions, seconds) = (of("solutions"), of("seconds"));
        let counts = counted.map(|column| of(column).iter().sum::<f64>().to_string()).join(",");
        summary += &format!(
            "{name},{instances},{each},{},{},{counts},{},{}\n",
            least(&solutions),
            most(&solutions),
            short(median(&seconds)),
            short(most(&seconds)),
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
