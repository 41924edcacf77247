//! A part of docs/results.md: families whose numbers of solutions are known.

use super::super::table::{head, line, summary};
use anyhow::Result;
use std::path::Path;

/// Families by their kinds, and a line for all of them.
pub(super) fn families(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Random families in two to four unknowns and one to three parameters, each searched as `hc monodromy` does without options. The numbers of \
         solutions follow from how the families are made; Singular has confirmed those of all families at random parameters modulo two primes \
         (`--singular` writes its input). Right and wrong end with exit status 0; wrong is another number of solutions, or other multiplicities. The \
         others end with exit status 1, because orbits are whole but others are not excluded, because the trace test does not show that, or without a \
         first solution. Seconds are processor seconds of one thread.\n\n",
    );
    text += &head(&[
        "",
        "families",
        "solutions",
        "searches",
        "right",
        "wrong",
        "others not excluded",
        "no trace test",
        "no first solution",
        "refused",
        "s (median)",
        "s (most)",
    ]);
    let counted = ["families", "searches", "right", "wrong", "not_excluded", "no_trace", "no_pair", "refused"];
    let mut sums = [0.0; 8];
    for row in summary(results, "families")?.rows() {
        for (sum, column) in sums.iter_mut().zip(counted) {
            *sum += row.number(column)?;
        }
        let of = |column: &str| Ok::<_, anyhow::Error>(row.get(column)?.to_owned());
        text += &line(&[
            of("kind")?,
            of("families")?,
            format!("{} to {}", of("solutions_least")?, of("solutions_most")?),
            of("searches")?,
            of("right")?,
            of("wrong")?,
            of("not_excluded")?,
            of("no_trace")?,
            of("no_pair")?,
            of("refused")?,
            of("seconds_median")?,
            of("seconds_most")?,
        ]);
    }
    let [families, searches, right, wrong, not_excluded, no_trace, no_pair, refused] = sums.map(|sum| sum.to_string());
    let none = String::new;
    text += &line(&[
        "all".to_owned(),
        families,
        none(),
        searches,
        right,
        wrong,
        not_excluded,
        no_trace,
        no_pair,
        refused,
        none(),
        none(),
    ]);
    Ok(text)
}
