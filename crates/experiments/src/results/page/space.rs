//! Parts of docs/results.md: networks in space.

use super::super::table::{Row, head, line, summary};
use anyhow::Result;
use std::path::Path;

/// The lines of the tables of some experiments, one below the other; in words, which were not run yet.
pub(super) fn lines(results: &Path, names: &[&str], cells: impl Fn(&Row<'_>) -> Result<Vec<String>>) -> Result<String> {
    let (mut text, mut missing) = (String::new(), String::new());
    for name in names {
        if !results.join(name).join("summary.csv").exists() {
            missing += &format!("\nNot run yet: `cargo xtask experiments --only {name}`.\n");
            continue;
        }
        for row in summary(results, name)?.rows() {
            text += &line(&cells(&row)?);
        }
    }
    Ok(text + &missing)
}

/// The cells of some columns as they stand.
pub(super) fn cells(row: &Row<'_>, columns: &[&str]) -> Result<Vec<String>> {
    columns.iter().map(|column| Ok(row.get(column)?.to_owned())).collect()
}

/// Rooms beside the Cramer-Rao bound.
pub(super) fn rooms(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Rooms of 10 m by 8 m by 3 m, as in the plane: noise of 0.01 m, which is not given, 10 % missing, errors of outliers uniform within 10 m. \
         Success means receivers within three times the Cramer-Rao bound. \"Among\" counts those that the result or an alternative has. \
         Ellipsoids are those of successful networks. The last rows are small networks, with nothing missing and the noise given: they often \
         fit others as well.\n\n",
    );
    text += &head(&[
        "",
        "outliers",
        "networks",
        "undetermined",
        "success",
        "among result and alternatives",
        "unique",
        "unique and wrong",
        "error over bound",
        "in the 95 % ellipsoids",
        "redundancy",
        "s",
    ]);
    let room = |row: &Row<'_>| {
        Ok(vec![
            row.get("configuration")?.to_owned(),
            format!("{:.0} %", 100.0 * row.number("outliers")?),
            row.get("networks")?.to_owned(),
            row.get("undetermined")?.to_owned(),
            row.percent("success")?,
            row.percent("among_alternatives")?,
            row.percent("unique")?,
            row.percent("unique_and_wrong")?,
            row.get("rms_over_bound")?.to_owned(),
            row.percent("coverage_95")?,
            row.get("redundancy")?.to_owned(),
            row.get("processor_seconds_median")?.to_owned(),
        ])
    };
    text += &lines(results, &["rooms", "small-rooms"], room)?;
    text += "\nThe smallest sizes, and others with one or two spare measurements or three (7r/6s), with noise of 1 mm that is not given. Where random networks \
             alone miss the true network, no start ends in it, and another one may pass for the only one. `tdoa calibrate` also starts from all networks of one exactly \
             solved subset, unless three measurements or more are spare.\n\n";
    text += &head(&[
        "",
        "starts",
        "networks",
        "success",
        "among result and alternatives",
        "unique",
        "unique and wrong",
        "error over bound",
        "s",
        "s, 90 %",
    ]);
    let smallest = |row: &Row<'_>| {
        Ok(vec![
            row.get("configuration")?.to_owned(),
            if row.get("method")? == "restarts" { "random networks" } else { "and an exact solver" }.to_owned(),
            row.get("networks")?.to_owned(),
            row.percent("success")?,
            row.percent("among_alternatives")?,
            row.percent("unique")?,
            row.percent("unique_and_wrong")?,
            row.get("rms_over_bound")?.to_owned(),
            row.get("processor_seconds_median")?.to_owned(),
            row.get("processor_seconds_90")?.to_owned(),
        ])
    };
    Ok(text + &lines(results, &["smallest-rooms"], smallest)?)
}

/// Real recordings beside the oracle.
pub(super) fn recordings(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Twelve microphones in rooms with motion capture (data1 to data7: martinkjlarsson/tdoa-self-calibration, xtdoa_real: swing-research/xtdoa; MIT \
         licence), and six ultra-wideband anchors (lps_uwb: kalleastrom/LocoPositioningSystemSlam, MIT licence). They are used as they are, with 20 % \
         of the entries removed and 10 % of the rest replaced by gross errors, and in random parts with fewer transmitters or receivers. The oracle is \
         the same refinement on the same data, started at the true receivers. Independent code with a Cauchy loss found .054, .053, .040, .047, .066, \
         .070 and .064 m for data1 to data7, .087 m for xtdoa_real, .093, .096 and .129 m for lps_uwb. \"Found\" is a network within 0.1 m of the oracle's, or no more \
         than 1.1 times as far from the truth; \"among alternatives\" counts others that list the oracle's; the rest is wrong. \"Trusted\" has exit status 0. \
         Ellipsoids hold the microphone of motion capture or not, by the usual covariance and by the one with systematic errors of receivers.\n\n",
    );
    text += &head(&[
        "",
        "size",
        "missing, outliers",
        "runs",
        "oracle, m (median)",
        "found, m",
        "within 1.1 of the oracle",
        "found",
        "among alternatives",
        "trusted",
        "trusted, wrong, oracle not listed",
        "unique",
        "unique and wrong",
        "in the 95 % ellipsoids",
        "with systematic errors",
        "s",
    ]);
    Ok(text + &lines(results, &["recordings", "ranges"], recording)?)
}

fn recording(row: &Row<'_>) -> Result<Vec<String>> {
    let mut all = vec![
        row.get("recording")?.to_owned(),
        format!("{}r/{}s", row.get("receivers")?, row.get("transmitters")?),
        format!("{:.0} %, {:.0} %", 100.0 * row.number("missing")?, 100.0 * row.number("outliers")?),
    ];
    let columns = [
        "runs",
        "oracle_rms_median",
        "receiver_rms_median",
        "within_1.1_of_oracle",
        "oracle_found",
        "oracle_among_alternatives",
        "trusted",
        "trusted_and_unlisted",
        "unique",
        "unique_and_wrong",
    ];
    all.extend(cells(row, &columns)?);
    all.extend([row.percent("coverage_95")?, row.percent("coverage_95_systematic")?]);
    all.push(row.get("processor_seconds_median")?.to_owned());
    Ok(all)
}

/// Real recordings reduced to the smallest sizes.
pub(super) fn reduced(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Random parts of the recordings above, solved exactly. All measurements of a part are within 0.06 m of what the measured receivers and the \
         event, as these tell, give; its events are at least 0.05 m apart. The oracle is least squares on the same measurements, started at the \
         measured receivers. It is among the candidates if all nodes of one agree with it within 1e-3 of the network's size.\n\n\
         The smallest sizes have as many measurements as unknowns. An oracle that fits exactly is a real root and has to be among the candidates. \
         One that does not is as a rule a minimum where the Jacobian is singular: errors of millimetres have made the two real roots near it complex. \
         Two things show this. \"Nearly real\" counts oracles that are found from roots with imaginary parts up to a tenth of the size of the \
         data, as `tdoa calibrate` takes them. \"Fold\" counts those with a candidate on either side, within a tenth of the network's size, \
         once a thousandth of the oracle's residuals, or less, is reversed. For the others neither was shown; least squares has no \
         minimum where an event or a microphone moves away without end.\n\n",
    );
    text += &head(&[
        "",
        "parts",
        "candidates, mean",
        "oracle exact",
        "of these found",
        "oracle not exact",
        "of these found",
        "nearly real",
        "fold",
        "neither",
        "candidates without the oracle",
        "oracle near the truth",
        "a candidate near the truth",
        "oracle, m (median)",
        "nearest candidate, m",
        "s",
    ]);
    text += &lines(results, &["reduced"], smallest)?;
    text += "\n\"Near the truth\" are receivers within a quarter of the network's size. Medians of candidates are over the parts that have any. Where \
             candidates are listed without the oracle, `tdoa solve` has nothing to tell it by: all of them fit exactly.\n\n\
             Larger sizes have a few measurements more than unknowns and no exact solution. Candidates are refined by least squares. Where the \
             oracle is not among them, errors keep the solver from it: the table has how often it then finds the same oracle with a tenth of \
             its residuals, and with none. \"Cheaper\" are parts in which a candidate has a smaller residual than the oracle. \"No network\" is \
             what the solver says where no candidate is left.\n\n";
    text += &head(&[
        "",
        "parts",
        "no network",
        "found",
        "and best",
        "nearly real",
        "with a tenth of the residuals",
        "with none",
        "unexplained",
        "cheaper",
        "oracle near the truth",
        "a candidate near the truth",
        "oracle, m (median)",
        "best candidate, m",
        "s",
    ]);
    text += &lines(results, &["reduced-larger"], larger)?;
    text += "\nSix ultra-wideband anchors, whose ranges have errors of centimetres (a moving tag is the transmitter). With an unknown offset of \
             each event:\n\n";
    text +=
        &head(&["", "parts", "no network", "oracle exact", "found", "nearly real", "fold", "with none", "unexplained"]);
    let columns =
        ["configuration", "tried", "refused", "oracle_exact", "found", "nearly_real", "fold", "control", "unexplained"];
    text += &lines(results, &["reduced-ranges"], |row| cells(row, &columns))?;
    text += "\nThe same ranges as they are, without offsets or with one unknown constant; measurements within 0.1 m. Those of 5r/5s \
             without a constant have to fulfil an equation of their own, so that no oracle fits exactly. \"Away\" counts oracles that are ten \
             times as large as the anchors and the tag, because a node moves away without end.\n\n";
    text += &head(&[
        "",
        "parts",
        "candidates, mean",
        "paths lost",
        "oracle exact",
        "of these found",
        "oracle not exact",
        "of these found",
        "nearly real",
        "fold",
        "on measurements of the oracle",
        "away",
        "unexplained",
        "oracle near the truth",
        "a candidate near the truth",
        "oracle, m (median)",
        "s",
    ]);
    let small = |row: &Row<'_>, clocks: &str| {
        let mut all = vec![row.get("configuration")?.to_owned() + clocks];
        all.extend(cells(row, &["tried", "candidates_mean", "lost", "oracle_exact", "exact_found"])?);
        all.extend(inexact(row)?);
        let columns = [
            "nearly_real",
            "fold",
            "control",
            "away",
            "unexplained",
            "oracle_near_truth",
            "candidate_near_truth",
            "oracle_rms_median",
            "processor_seconds_median",
        ];
        all.extend(cells(row, &columns)?);
        Ok(all)
    };
    text += &lines(results, &["smallest-ranges"], |row| small(row, ""))?;
    Ok(text + &lines(results, &["smallest-constants"], |row| small(row, ", constant"))?)
}

/// Parts whose oracle does not fit exactly, and in how many of them it is found.
fn inexact(row: &Row<'_>) -> Result<[String; 2]> {
    let without =
        |column: &str, part: &str| Ok::<_, anyhow::Error>((row.number(column)? - row.number(part)?).to_string());
    Ok([without("tried", "oracle_exact")?, without("found", "exact_found")?])
}

fn smallest(row: &Row<'_>) -> Result<Vec<String>> {
    let mut all = cells(row, &["configuration", "tried", "candidates_mean", "oracle_exact", "exact_found"])?;
    all.extend(inexact(row)?);
    let columns = [
        "nearly_real",
        "fold",
        "unexplained",
        "others_only",
        "oracle_near_truth",
        "candidate_near_truth",
        "oracle_rms_median",
        "nearest_rms_median",
        "processor_seconds_median",
    ];
    all.extend(cells(row, &columns)?);
    Ok(all)
}

fn larger(row: &Row<'_>) -> Result<Vec<String>> {
    let columns = [
        "configuration",
        "tried",
        "refused",
        "found",
        "best_is_oracle",
        "nearly_real",
        "tenth",
        "control",
        "unexplained",
        "cheaper",
        "oracle_near_truth",
        "candidate_near_truth",
        "oracle_rms_median",
        "best_rms_median",
        "processor_seconds_median",
    ];
    cells(row, &columns)
}

/// The choice between plane and space.
pub(super) fn dimension(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Networks of whose dimension nothing is said, in the plane and in rooms of 10 m by 8 m, noise of 0.01 m, nothing missing. The gain is that of \
         the logarithm of the likelihood in space, over what is needed (1 %, 50 % and 99 % of the networks). A room that is hardly high is well \
         described by a plane: its heights change distances by about the noise.\n\n",
    );
    text += &head(&[
        "",
        "height, m",
        "outliers",
        "networks",
        "in the plane",
        "in space",
        "not calibrated",
        "gain over needed: 1 %",
        "50 %",
        "99 %",
        "s",
    ]);
    let columns = [
        "networks",
        "in_the_plane",
        "in_space",
        "not_calibrated",
        "gain_over_needed_1",
        "gain_over_needed_50",
        "gain_over_needed_99",
        "processor_seconds_median",
    ];
    let kind = |row: &Row<'_>| {
        let height = row.get("height")?;
        let mut all = vec![
            row.get("configuration")?.to_owned(),
            if height == "0" { "plane".to_owned() } else { height.to_owned() },
            format!("{:.0} %", 100.0 * row.number("outliers")?),
        ];
        all.extend(cells(row, &columns)?);
        Ok(all)
    };
    Ok(text + &lines(results, &["dimension", "low"], kind)?)
}

/// Networks of whose model nothing is said.
pub(super) fn kinds(results: &Path) -> Result<String> {
    let mut text = String::from(
        "Networks of whose model nothing is said (default options). Wrong are receivers farther from the truth than 2 % of the network's size and \
         three times what least squares from the truth has, in the plane where all nodes lie in one. Trusted is exit status 0. Not listed: neither \
         the network, nor one with other sides of its mirror images, nor an alternative beside it is right. Of a source that flies straight nothing \
         is right: receivers may be turned about its line. Where heights alone are known, they must be right too.\n\n",
    );
    text += &head(&[
        "",
        "networks",
        "in the plane",
        "in space",
        "trusted",
        "unique",
        "wrong and unique",
        "wrong and trusted",
        "not listed and trusted",
        "error, m (median)",
        "from the truth",
        "error over that where trusted",
        "95 % ellipses that hold",
    ]);
    let columns = [
        "kind",
        "networks",
        "in_the_plane",
        "in_space",
        "trusted",
        "unique",
        "wrong_and_unique",
        "wrong_and_trusted",
        "unlisted_and_trusted",
        "error_median",
        "oracle_median",
        "error_over_oracle_where_trusted",
    ];
    let kind = |row: &Row<'_>| {
        let mut all = cells(row, &columns)?;
        all.push(row.percent("ellipses_that_hold")?);
        Ok(all)
    };
    Ok(text + &lines(results, &["kinds"], kind)?)
}
