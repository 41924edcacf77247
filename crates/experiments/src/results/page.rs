//! docs/results.md from the tables in results/, byte for byte the same from the same tables.

mod clocks;
mod families;
mod solvers;
mod sound;
mod space;

use super::plan::PLAN;
use super::table::{Row, Table, head, line, record, summary};
use anyhow::Result;
use solvers::{clean, clean_space, noise, routes, speed, table2};
use std::path::Path;

/// The whole page.
pub(super) fn write(results: &Path) -> Result<String> {
    let mut text = String::from(
        "# Results\n\n\
         Written by `cargo xtask experiments --page` from the tables in [results](../results); `cargo xtask experiments` makes the tables anew \
         (hours), and with `--quick` a small version of each (minutes). The end of the page says how each was made. \"The paper\" is Ferranti, Åström, Oskarsson, Boutellier, \
         Kannala, *Homotopy Continuation for Sensor Networks Self-Calibration*.\n",
    );
    for (name, title, section) in SECTIONS {
        text += &format!("\n## {title}\n\n");
        if results.join(name).join("summary.csv").exists() {
            text += &section(results)?;
        } else {
            text += &format!("Not run yet: `cargo xtask experiments --only {name}`.\n");
        }
    }
    text += &runs(results)?;
    Ok(text)
}

/// Title and text of the part of the page on an experiment.
type Section = (&'static str, &'static str, fn(&Path) -> Result<String>);

const SECTIONS: &[Section] = &[
    ("table2", "Solutions of 6r/3s (the paper's Table 2)", table2),
    ("clean", "Clean data (the paper's figure 1, upper row)", clean),
    ("clean-space", "Clean data in space", clean_space),
    ("speed", "Speed of the exact solvers", speed),
    ("routes", "The same networks from a polyhedral start system", routes),
    ("noise", "Noise (the paper's figure 1, lower row)", noise),
    ("calibrate", "Calibration of simulated networks", calibration),
    ("small", "Small networks and ambiguity", small),
    ("coverage", "Cramer-Rao bound and ellipses", coverage),
    ("growth", "Large networks", growth),
    ("damaged", "Recordings, as they are and damaged", recordings),
    ("rooms", "In space: rooms", space::rooms),
    ("recordings", "In space: recordings, as they are, damaged and in parts", space::recordings),
    ("reduced", "In space: recordings reduced to the smallest sizes", space::reduced),
    ("dimension", "Plane or space", space::dimension),
    ("kinds", "Networks as rooms, arrays and equipment have them", space::kinds),
    ("clocks", "Clocks", clocks::clocks),
    ("sound", "Recordings that are simulated", sound::sound),
    ("families", "Families with known numbers of solutions", families::families),
];

fn calibration(results: &Path) -> Result<String> {
    let table = summary(results, "calibrate")?;
    // Those that were not run leave dashes.
    let others: Vec<Option<Table>> =
        ["calibrate-restarts", "calibrate-minimal"].map(|name| summary(results, name).ok()).into_iter().collect();
    let mut text = String::from(
        "The networks lie in a room of 10 m by 10 m. The noise is 0.01 m and is not given to the calibration. 10 % of the measurements are missing; \
         outliers are as stated (shares of all cells, errors uniform within 10 m). Success means receivers within three times the Cramer-Rao bound \
         (root mean square), over the networks that the good measurements determine at all. The portfolio of `tdoa calibrate` is compared with random \
         restarts alone and with exactly solved subsets alone, with numbers of starts that take about as long. Seconds are processor seconds of one \
         thread, median.\n\n",
    );
    text += &head(&[
        "",
        "outliers",
        "networks",
        "undetermined",
        "portfolio",
        "s",
        "called unique but wrong",
        "restarts alone (networks)",
        "s",
        "subsets alone (networks)",
        "s",
    ]);
    for row in table.rows() {
        let (size, outliers) = (row.get("configuration")?, row.get("outliers")?);
        let mut cells: Vec<String> = vec![size.into(), format!("{:.0} %", 100.0 * row.number("outliers")?)];
        cells.extend([row.get("networks")?.to_owned(), row.get("undetermined")?.to_owned()]);
        cells.extend([row.percent("success")?, row.get("processor_seconds_median")?.to_owned()]);
        cells.push(row.percent("unique_and_wrong")?);
        for other in &others {
            let same = |row: &Row<'_>| row.is(&[("configuration", size), ("outliers", outliers)]);
            match other.as_ref().and_then(|table| table.rows().find(same)) {
                Some(row) => {
                    cells.push(format!("{} ({})", row.percent("success")?, row.get("networks")?));
                    cells.push(row.get("processor_seconds_median")?.to_owned());
                }
                None => cells.extend(["-".to_owned(), "-".to_owned()]),
            }
        }
        text += &line(&cells);
    }
    text += "\nWhere the share is low, the outliers leave too few good measurements. With 30 % of the cells wrong and 10 % missing, 6r/10s has 36 good measurements for 39 unknowns: \
             no network is determined. 8r/12s has 57 good measurements for 49 unknowns, and 29 wrong ones: a wrong network that fits 49 of the 86 exactly needs only a few chance agreements \
             to fit as many as the true one. 10r/20s has 120 good measurements for 77 unknowns and 60 wrong ones. That is a third of the measurements, \
             while the estimate of the noise from the data breaks down at a share of (1 - 77/180)/2 = 29 % (see the module `loss`). 6r/10s with 10 % \
             has 48 good measurements for 39 unknowns and 6 wrong ones: nine spare measurements are few for finding six wrong ones. Networks that are \
             wrong there and yet called unique mostly have an outlier of some decimetres that passes for noise. Among the first 250 there are 17 such \
             networks. In 15 of them the noise is estimated 1.6 to 33 times too large. In 13 a search that starts at the true positions fails as well, \
             so that these data prefer another network (`cargo run --release -p experiments --example mistaken`). 25r/20s has 300 good measurements \
             for 107 unknowns, and stays below its share of 39 %.\n";
    Ok(text)
}

fn small(results: &Path) -> Result<String> {
    let table = summary(results, "small")?;
    let mut text = String::from(
        "Nothing is missing, there are no outliers, and the noise is given to the calibration (the smallest sizes leave no measurements from which to \
         estimate it). \"Among\" means that the true network is the result or among its alternatives (receivers within three times the Cramer-Rao \
         bound or 2 % of the network's size). \"Unique\" means that no alternative was found.\n\n",
    );
    text += &head(&[
        "",
        "noise, m",
        "networks",
        "result is the true one",
        "among result and alternatives",
        "unique",
        "unique and wrong",
        "s",
    ]);
    for row in table.rows() {
        text += &line(&[
            row.get("configuration")?.to_owned(),
            row.get("noise")?.to_owned(),
            row.get("networks")?.to_owned(),
            row.percent("success")?,
            row.percent("among_alternatives")?,
            row.percent("unique")?,
            row.percent("unique_and_wrong")?,
            row.get("processor_seconds_median")?.to_owned(),
        ]);
    }
    text += "\nThe minimal sizes 6r/3s and 4r/5s fit every physical solution exactly. The true one cannot be told from the others, so that all are \
             listed.\n";
    Ok(text)
}

fn coverage(results: &Path) -> Result<String> {
    let table = summary(results, "coverage")?;
    let mut text = String::from(
        "As above, without outliers. The table has the root mean square of the receiver error divided by the bound of the same network, and the share \
         of true receivers in their 95 % ellipses, over the successful networks. The robust loss loses 5 % of efficiency on normal noise; the expected \
         ratio is therefore 1/sqrt(0.95) = 1.026.\n\n",
    );
    text += &head(&["", "networks", "success", "error over bound", "in the 95 % ellipses", "s"]);
    for row in table.rows() {
        text += &line(&[
            row.get("configuration")?.to_owned(),
            row.get("networks")?.to_owned(),
            row.percent("success")?,
            row.get("rms_over_bound")?.to_owned(),
            row.percent("coverage_95")?,
            row.get("processor_seconds_median")?.to_owned(),
        ]);
    }
    Ok(text)
}

fn growth(results: &Path) -> Result<String> {
    let table = summary(results, "growth")?;
    let mut text = String::from(
        "30 % of the measurements are missing and 10 % are outliers; one network each. Seconds are wall-clock seconds; memory is that of the whole \
             process so far.\n\n",
    );
    text += &head(&["", "threads", "s", "MB", "success", "error over bound"]);
    for row in table.rows() {
        let columns = ["configuration", "threads", "seconds", "peak_megabytes", "success", "rms_over_bound"];
        let cells = columns.iter().map(|column| Ok(row.get(column)?.to_owned())).collect::<Result<Vec<_>>>()?;
        text += &line(&cells);
    }
    text += "\nThe search works on at most 32 receivers and 48 transmitters. The others are located afterwards and refined with all measurements by a \
             Schur complement over the transmitters. Its cost grows as the square of the receivers times the transmitters.\n";
    Ok(text)
}

fn recordings(results: &Path) -> Result<String> {
    let table = summary(results, "damaged")?;
    let shares = Table::read(&results.join("damaged/candidates_summary.csv"))?;
    let mut text = String::from(
        "The recordings have six microphones and 46, 75 and 132 chirps, and are nearly planar (martinkjlarsson/tdoa-self-calibration, MIT licence). \
         They are used as they are, and with 20 % of the entries removed and 10 % of the rest replaced by gross errors at random. The oracle is the \
         same refinement on the same data, started at the true receivers. The published values for the oracle on the full data are 0.045, 0.048 and \
         0.051 m (scaled 0.020, 0.027, 0.019 m).\n\n",
    );
    text += &head(&[
        "",
        "missing",
        "outliers",
        "runs",
        "within 1.1 of the oracle",
        "receivers, m (median)",
        "oracle, m",
        "ratio: median",
        "largest",
        "scaled, m",
    ]);
    for row in table.rows() {
        let columns = [
            "recording",
            "missing",
            "outliers",
            "runs",
            "within_1.1_of_oracle",
            "receiver_rms_median",
            "oracle_rms_median",
            "ratio_median",
            "ratio_max",
            "receiver_rms_scaled_median",
        ];
        let cells = columns.iter().map(|column| Ok(row.get(column)?.to_owned())).collect::<Result<Vec<_>>>()?;
        text += &line(&cells);
    }
    text += "\nThe next table has candidates of 6r/3s on spread triples of transmitters, before any refinement, and how often one is within a quarter \
             of the network's size of the truth (79 % on h40 and 76 % on h60 were seen elsewhere).\n\n";
    text += &head(&["", "triples", "with such a candidate", "candidates a triple"]);
    for row in shares.rows() {
        text += &line(&[
            row.get("recording")?.to_owned(),
            row.get("triples")?.to_owned(),
            row.percent("with_candidate_near_truth")?,
            row.get("candidates_mean")?.to_owned(),
        ]);
    }
    Ok(text)
}

fn runs(results: &Path) -> Result<String> {
    let mut text = String::from("\n## How these were made\n\n");
    text += &head(&["", "command (with --output DIR)", "seed", "commit", "processor", "cores"]);
    for experiment in PLAN {
        let path = results.join(experiment.name).join("run.csv");
        if !path.exists() {
            continue;
        }
        let items = record(&path)?;
        let item = |name: &str| items.iter().find(|(item, _)| item == name).map_or("", |(_, value)| value.as_str());
        text += &line(&[
            experiment.name.to_owned(),
            format!("`{}`", item("command")),
            item("seed").to_owned(),
            item("commit").to_owned(),
            item("processor").to_owned(),
            item("cores").to_owned(),
        ]);
    }
    text += "\nOther work ran on the same cores, so that wall-clock seconds are too long by some factor; processor seconds are less sensitive. Counts \
             and errors depend neither on other work nor on the number of threads.\n";
    Ok(text)
}
