//! A calibration as one self-contained HTML report: the picture, the warnings, and sortable tables
//! of nodes and measurements, and for a network in space a view that turns under the mouse. It refers
//! to nothing outside itself.

use hc::poly::{counted, one_or};
use std::array::from_fn;

mod provenance;
mod section;
mod table;
mod turn;

use crate::calibrate::{Calibration, RecorderClock};
use crate::degeneracy::space;
use crate::picture::{escape, picture};
use crate::quantity::{coordinate, decimals, length, number};
use crate::summary::{CLOCK_HEADINGS, agreement, choice, clock_model, clock_row, deviation, uniqueness};
pub use provenance::Provenance;
pub use section::{Section, page};
use table::{Column, table};

/// Most measurements that the report lists; of more, the outliers and those of largest residual.
const LISTED: usize = 20_000;

/// The coordinates of a position, and what their deviations are called.
const AXES: [[Column<'static>; 3]; 2] =
    [[("x", false), ("y", false), ("z", false)], [("std x", false), ("std y", false), ("std z", false)]];

const OFFSET: [Column<'static>; 2] = [("offset", false), ("std offset", false)];

const COUNTS: [Column<'static>; 2] = [("measured", false), ("outliers", false)];

const MEASUREMENTS: [Column<'static>; 5] = [
    ("receiver", true),
    ("transmitter", true),
    ("residual", false),
    ("residual / rms of inliers", false),
    ("outlier", true),
];

/// The report as HTML text.
pub fn html<const D: usize>(calibration: &Calibration<D>) -> String {
    html_with(calibration, &Provenance::default())
}

/// The report as HTML text, with where the result comes from.
pub fn html_with<const D: usize>(calibration: &Calibration<D>, provenance: &Provenance) -> String {
    // A network in the plane is all in the picture.
    let (view_style, view) = if D == 3 { (turn::STYLE, turn::view(calibration)) } else { ("", String::new()) };
    let mut page = String::new();
    if let Some(why) = calibration.distrust() {
        page += &format!("<p class=\"wrong\">Not to be trusted: {why}.</p>\n");
    }
    for warning in &calibration.warnings {
        page += &format!("<p class=\"warning\">{}</p>\n", escape(warning));
    }
    page += &facts(calibration, provenance);
    page += &provenance::list(provenance);
    page += &view;
    page += &format!("<figure>\n{}</figure>\n", picture(calibration));
    page += &format!(
        "<p class=\"note\">Lengths in metres. Standard deviations: {}{}.</p>\n",
        escape(&calibration.gauge),
        if calibration.relevant_systematic().is_some() { ", with systematic errors of the receivers" } else { "" }
    );
    page += "<h2>Receivers</h2>\n";
    page += &table("receivers", &columns::<D>("receiver", &[]), receivers(calibration));
    page += "<h2>Transmitters</h2>\n";
    page += &table("transmitters", &columns::<D>("transmitter", &OFFSET), transmitters(calibration));
    if let Some(first) = calibration.clocks.first() {
        page += "<h2>Clocks</h2>\n";
        let numbers = clock_row(first, small).len();
        let columns = CLOCK_HEADINGS.iter().take(numbers).map(|heading| (*heading, false));
        page +=
            &table("clocks", &[("recorder", true)].into_iter().chain(columns).collect::<Vec<_>>(), clocks(calibration));
    }
    page += "<h2>Measurements</h2>\n";
    let (rows, left_out) = measurements(calibration);
    if left_out > 0 {
        page += &format!(
            "<p class=\"note\">The outliers and the largest residuals; {} {} in the JSON only.</p>\n",
            counted(left_out, "smaller one"),
            one_or(left_out, "is", "are")
        );
    }
    page += &table("measurements", &MEASUREMENTS, rows);
    provenance.sections.iter().for_each(|section| page += section.html());
    section::frame(&format!("Calibration of {}", calibration.configuration), view_style, &page)
}

/// What the summary says, as a list of terms and values.
fn facts<const D: usize>(calibration: &Calibration<D>, provenance: &Provenance) -> String {
    let (measured, outliers) = (calibration.residuals.len(), calibration.residuals.outliers().count());
    // Where the measurements chose, they say more than the one who let them.
    let dimensions = choice(calibration).filter(|_| calibration.dimension_test.is_some());
    let dimensions = dimensions.unwrap_or_else(|| match &provenance.dimensions {
        Some(by) => format!("{}, {by}", space(D)),
        None => space(D).to_string(),
    });
    let mut list = vec![
        ("Measurements", format!("{measured}, outliers among them: {outliers}")),
        ("Noise", deviation(calibration)),
        ("Residuals of inliers", format!("{} root mean square", length(calibration.residual_rms))),
        ("Dimensions", dimensions),
        ("Size", calibration.extent().map_or_else(String::new, |size| format!("{} across", length(size)))),
        ("Redundancy", counted(calibration.redundancy, "measurement") + " more than unknowns"),
        ("Uniqueness", uniqueness(calibration).to_string()),
        (
            "Other networks",
            match calibration.alternatives.len() {
                0 => "none found that explains the measurements as well".to_string(),
                1 => "1 that explains the measurements about as well".to_string(),
                count => format!("{count} that explain the measurements about as well"),
            },
        ),
        ("Search", agreement(calibration)),
    ];
    if !calibration.mirror_images.is_empty() {
        let nodes: Vec<&str> = calibration.mirror_images.iter().map(|image| image.node.as_str()).collect();
        list.push(("Mirror images", format!("of {}, hollow in the picture", nodes.join(", "))));
    }
    if let Some(errors) = calibration.relevant_systematic() {
        let times = number(errors.factor, 2);
        let size = length(errors.deviation);
        list.push(("Systematic errors", format!("of the receivers, {size}: positions {times} times as uncertain")));
    }
    if let Some(speed) = &calibration.speed {
        let value = speed.metres_per_second.map_or_else(
            || format!("{} times the assumed one", number(speed.factor, 6)),
            |value| format!("{} m/s", number(value, 6)),
        );
        list.push(("Propagation speed", format!("{value}, estimated from {}", counted(speed.distances, "distance"))));
    }
    if let Some(model) = clock_model(calibration) {
        list.push(("Clocks", model));
    }
    let anchored: Vec<&str> = calibration
        .receiver_names
        .iter()
        .zip(&calibration.anchored)
        .filter(|(_, held)| **held)
        .map(|(name, _)| name.as_str())
        .collect();
    if !anchored.is_empty() {
        list.push(("Known positions", anchored.join(", ")));
    }
    if let Some(truth) = &calibration.truth {
        list.push((
            "Against the truth",
            format!(
                "{}, {} root mean square, {} with scale {:.4}",
                counted(truth.receivers, "receiver"),
                length(truth.receiver_rms),
                length(truth.receiver_rms_scaled),
                truth.scale
            ),
        ));
        if let Some(median) = truth.transmitter_median {
            list.push(("True transmitters", format!("median distance {}", length(median))));
        }
    }
    let entries = list.iter().map(|(term, value)| format!("<dt>{term}</dt><dd>{}</dd>\n", escape(value)));
    format!("<dl>\n{}</dl>\n", entries.collect::<String>())
}

/// The columns of a table of nodes; some stand after the deviations.
fn columns<const D: usize>(kind: &'static str, after: &[Column<'static>]) -> Vec<Column<'static>> {
    let axes = AXES.iter().flat_map(|axes| axes.iter().take(D));
    [(kind, true)].iter().chain(axes).chain(after).chain(&COUNTS).copied().collect()
}

fn receivers<const D: usize>(calibration: &Calibration<D>) -> Vec<Vec<String>> {
    let position = position(calibration);
    let [deviations, _] = calibration.trusted_deviations();
    let rows = calibration.receiver_names.iter().enumerate();
    rows.map(|(i, name)| {
        let mut row = vec![name.clone()];
        row.extend(cells(calibration.receivers[i], &position));
        row.extend(cells(deviations[i], small));
        row.extend(calibration.counts_of_receiver(i).map(|count| count.to_string()));
        row
    })
    .collect()
}

fn transmitters<const D: usize>(calibration: &Calibration<D>) -> Vec<Vec<String>> {
    let position = position(calibration);
    let [_, deviations] = calibration.trusted_deviations();
    let rows = calibration.transmitter_names.iter().enumerate();
    rows.map(|(j, name)| {
        let mut row = vec![name.clone()];
        row.extend(cells(calibration.transmitters[j], &position));
        row.extend(cells(deviations[j], small));
        row.push(calibration.offsets[j].map(&position).unwrap_or_default());
        row.push(calibration.offset_std[j].map(small).unwrap_or_default());
        row.extend(calibration.counts_of_transmitter(j).map(|count| count.to_string()));
        row
    })
    .collect()
}

fn clocks<const D: usize>(calibration: &Calibration<D>) -> Vec<Vec<String>> {
    let position = position(calibration);
    let row = |clock: &RecorderClock| [vec![clock.recorder.clone()], clock_row(clock, &position)].concat();
    calibration.clocks.iter().map(row).collect()
}

/// One row a measurement in the order of the matrix, and how many were left out.
fn measurements<const D: usize>(calibration: &Calibration<D>) -> (Vec<Vec<String>>, usize) {
    let mut all: Vec<(usize, usize, f64, bool)> =
        calibration.residuals.iter().map(|(i, j, residual)| (i, j, residual.length, !residual.inlier)).collect();
    let left_out = all.len().saturating_sub(LISTED);
    if left_out > 0 {
        all.sort_by(|a, b| b.3.cmp(&a.3).then(b.2.abs().total_cmp(&a.2.abs())));
        all.truncate(LISTED);
        all.sort_by_key(|entry| (entry.0, entry.1));
    }
    let rows = all.into_iter().map(|(i, j, e, outlier)| {
        let ratio = e / calibration.residual_rms;
        vec![
            calibration.receiver_names[i].clone(),
            calibration.transmitter_names[j].clone(),
            small(e),
            if ratio.is_finite() { format!("{ratio:.2}") } else { String::new() },
            if outlier { "outlier".to_string() } else { String::new() },
        ]
    });
    (rows.collect(), left_out)
}

/// The numbers of a position or its deviations, empty if there is none.
fn cells<const D: usize>(values: Option<[f64; D]>, show: impl Fn(f64) -> String) -> [String; D] {
    from_fn(|k| values.map(|values| show(values[k])).unwrap_or_default())
}

/// Coordinates with decimals that suit the network's size.
fn position<const D: usize>(calibration: &Calibration<D>) -> impl Fn(f64) -> String + use<D> {
    let decimals = decimals(calibration.extent().unwrap_or(0.0));
    move |value| coordinate(value, decimals)
}

/// A standard deviation or residual in metres.
fn small(value: f64) -> String {
    number(value, 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

    fn calibration() -> Calibration {
        let mut options = SimulateOptions { noise: 0.01, outliers: 0.03, ..Default::default() };
        options.missing = 0.02;
        let simulation = simulate(&options).unwrap();
        let names = |kind: &str, count: usize| (0..count).map(|k| format!("{kind}<b>{k}&\"")).collect();
        let measured = simulation.pseudoranges.with_names(names("r", 8), names("s", 12)).unwrap();
        let mut calibration = calibrate(&measured, &CalibrateOptions::default()).unwrap();
        calibration.warnings.push("</p><script>alert(1)</script>".to_string());
        calibration
    }

    #[test]
    fn lists_everything_and_escapes_it() {
        let calibration = calibration();
        let page = html(&calibration);
        let (measured, outliers) = (calibration.residuals.len(), calibration.residuals.outliers().count());
        // A heading and its rows for each of the three tables.
        assert_eq!(page.matches("<tr").count(), 3 + 8 + 12 + measured);
        assert_eq!(page.matches("<tr class=\"outlier\"").count(), outliers);
        assert!(page.contains("<td class=\"text\">r&lt;b&gt;7&amp;&quot;</td>"));
        assert!(!page.contains("<b>") && page.matches("<script").count() == 1);
        // Nothing is fetched: the only address is the name of SVG.
        let addresses = page.matches("://").count();
        assert_eq!(addresses, page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count());
        assert!(!page.contains(" src=") && !page.contains("NaN"));
        // Clips are within the page.
        assert_eq!(page.matches("url(").count(), page.matches("url(#").count());
    }

    /// The headings of a table.
    fn headings<'a>(page: &'a str, id: &str) -> Vec<&'a str> {
        let table = page.split_once(&format!("<table id=\"{id}\">")).unwrap().1;
        let buttons = table.split_once("</thead>").unwrap().0.split("<button type=\"button\">").skip(1);
        buttons.map(|rest| rest.split('<').next().unwrap()).collect()
    }

    #[test]
    fn tables_have_the_coordinates_of_the_plane_or_of_space() {
        let plane = html(&calibration());
        assert_eq!(headings(&plane, "receivers"), ["receiver", "x", "y", "std x", "std y", "measured", "outliers"]);
        let transmitters = ["transmitter", "x", "y", "std x", "std y", "offset", "std offset", "measured", "outliers"];
        assert_eq!(headings(&plane, "transmitters"), transmitters);

        let simulation = simulate(&SimulateOptions::<3> { noise: 0.01, ..SimulateOptions::new() }).unwrap();
        let mut calibration = calibrate(&simulation.pseudoranges, &CalibrateOptions::<3>::new()).unwrap();
        calibration.receiver_names[2] = "</script><b>".to_string();
        let page = html(&calibration);
        let columns = headings(&page, "receivers");
        assert_eq!(columns, ["receiver", "x", "y", "z", "std x", "std y", "std z", "measured", "outliers"]);
        assert_eq!(
            headings(&page, "transmitters")[4..],
            ["std x", "std y", "std z", "offset", "std offset", "measured", "outliers"]
        );
        // As many cells in a row as headings.
        let row = page.split_once("<table id=\"receivers\">").unwrap().1.split("<tr>").nth(2).unwrap();
        assert_eq!(row.split("</tr>").next().unwrap().matches("<td").count(), columns.len());
        assert!(page.contains("from the side") && !page.contains("NaN"));
        // The view that turns: its data, its script, and the one that sorts.
        assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (3, 3));
        assert!(!page.contains("<b>") && !plane.contains("id=\"turn\""));
        // Nothing is fetched: the only address is the name of SVG, and clips are within the page.
        assert_eq!(page.matches("://").count(), page.matches("http://www.w3.org/2000/svg\"").count());
        assert!(!page.contains(" src=") && page.matches("url(").count() == page.matches("url(#").count());
    }
}
