//! `tdoa experiment kinds`.

use super::common::Common;
use super::statistics::short;
use super::table::Table;
use crate::quantile::median;
use crate::trials::kinds::{Kind, outcome};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Calibrates networks of the kinds that rooms, arrays and equipment have, of whose model nothing is said, and
/// counts what is wrong and called right.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Kinds of networks, such as `table` or `echo`. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = kind)]
    kind: Vec<Kind>,
    /// Number of networks of each kind.
    #[arg(long, default_value_t = 100)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

fn kind(name: &str) -> Result<Kind, String> {
    let names = || Kind::ALL.map(Kind::name).join(", ");
    Kind::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| format!("`{name}` is none of {}", names()))
}

const HEADER: &str = "kind,seed,dimensions,trusted,unique,error,oracle,wrong,unlisted,covered,ellipses";

fn row(kind: Kind, seed: u64) -> Result<String, Failure> {
    let found = outcome(&kind.network(seed).map_err(Failure::unusable)?);
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.5e}"));
    Ok(format!(
        "{},{},{},{},{},{},{},{},{}",
        found.dimensions,
        found.trusted,
        found.unique,
        number(found.error),
        number(found.oracle),
        found.is_wrong(),
        found.is_unlisted(),
        found.covered.0,
        found.covered.1
    ))
}

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if arguments.instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let common = &arguments.common;
    let kinds = if arguments.kind.is_empty() { Kind::ALL.to_vec() } else { arguments.kind.clone() };
    let all: Vec<(Kind, u64)> =
        kinds.iter().flat_map(|&kind| common.seeds(arguments.instances).map(move |seed| (kind, seed))).collect();
    let keys: Vec<String> = all.iter().map(|(kind, seed)| format!("{},{seed}", kind.name())).collect();
    let rows = Table::new(common, "trials.csv", HEADER, &keys, ranks).resume(|| (), |(), k| row(all[k].0, all[k].1))?;
    let Some(rows) = rows else { return Ok(()) };
    let mut summary = String::from(
        "kind,networks,in_the_plane,in_space,trusted,unique,wrong_and_unique,wrong_and_trusted,unlisted_and_trusted,error_median,oracle_median,\
         error_over_oracle_where_trusted,ellipses_that_hold\n",
    );
    let each = arguments.instances as usize;
    for (g, kind) in kinds.iter().enumerate() {
        let of = |column: &str| rows.numbers(column, g * each..(g + 1) * each);
        let [dimensions, trusted, unique, error, oracle, wrong, unlisted] =
            ["dimensions", "trusted", "unique", "error", "oracle", "wrong", "unlisted"].map(of);
        let count = |is: &dyn Fn(usize) -> bool| (0..each).filter(|&k| is(k)).count();
        let ratios: Vec<f64> = (0..each).filter(|&k| trusted[k] == 1.0).map(|k| error[k] / oracle[k]).collect();
        let present = |values: &[f64]| values.iter().copied().filter(|x| !x.is_nan()).collect::<Vec<f64>>();
        let (mut held, mut ellipses) = (0.0, 0.0);
        for (k, (covered, all)) in of("covered").into_iter().zip(of("ellipses")).enumerate() {
            if trusted[k] == 1.0 {
                held += covered;
                ellipses += all;
            }
        }
        summary += &format!(
            "{},{each},{},{},{},{},{},{},{},{},{},{},{}\n",
            kind.name(),
            count(&|k| dimensions[k] == 2.0),
            count(&|k| dimensions[k] == 3.0),
            count(&|k| trusted[k] == 1.0),
            count(&|k| unique[k] == 1.0),
            count(&|k| unique[k] * wrong[k] == 1.0),
            count(&|k| trusted[k] * wrong[k] == 1.0),
            count(&|k| trusted[k] * unlisted[k] == 1.0),
            short(median(&present(&error))),
            short(median(&present(&oracle))),
            short(median(&present(&ratios))),
            short(held / ellipses),
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
