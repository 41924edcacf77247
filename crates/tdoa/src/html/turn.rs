//! A view of a network in space that turns under the mouse, as a part of the report. Without scripts
//! it stays hidden; the picture is always there.

use crate::calibrate::Calibration;
use crate::picture::{Layout, Scene};
use crate::quantity::{coordinate, decimals, number};

pub(super) const STYLE: &str = include_str!("turn.css");
const SCRIPT: &str = include_str!("turn.js");

/// The view as HTML, with the nodes that the picture shows.
pub(super) fn view<const D: usize>(calibration: &Calibration<D>) -> String {
    let scene = Scene::of(calibration);
    let layout = Layout::of(&scene);
    let data = data(calibration, &scene, &layout);
    let has_ellipsoids = data.contains("\"ellipsoid\":");
    let ellipsoids = match (has_ellipsoids, layout.magnified) {
        (false, _) => String::new(),
        (true, factor) if factor > 1.0 => format!("; 95 % ellipsoids are drawn {} times as large", number(factor, 3)),
        (true, _) => "; ellipsoids are those of 95 %".to_string(),
    };
    format!(
        "<figure class=\"turn\" id=\"turn\" hidden>\n\
         <div class=\"views\" role=\"group\" aria-label=\"Views\"></div>\n\
         <svg viewBox=\"0 0 900 600\" tabindex=\"0\" role=\"img\" aria-label=\"The network in space\"></svg>\n\
         <figcaption class=\"note\">Triangles are receivers, dots are transmitters{}{ellipsoids}. Drag, or use the arrow keys, \
         to turn the network; Home turns it back. Point at a node to see its name.</figcaption>\n</figure>\n\
         <script type=\"application/json\" id=\"network\">{data}</script>\n<script>\n{SCRIPT}</script>\n",
        if calibration.truth.is_some() { ", crosses are true positions" } else { "" },
    )
}

/// The nodes as JSON: `{"receivers": [{"name": "a", "at": [1, 2, 3], "truth": [1, 2, 3], "held": true,
/// "ellipsoid": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}], "transmitters": []}`. An ellipsoid of matrix A has the points x with
/// x' A^-1 x = 1 about its node; it is as large as it is drawn.
fn data<const D: usize>(calibration: &Calibration<D>, scene: &Scene<D>, layout: &Layout) -> String {
    let decimals = decimals(calibration.extent().unwrap_or(0.0));
    let point = |p: [f64; D]| format!("[{}]", p.map(|x| coordinate(x, decimals)).join(","));
    let radius = layout.radius(scene);
    let matrix = |covariance: &[[f64; D]; D]| {
        let rows = covariance.map(|row| format!("[{}]", row.map(|c| format!("{:.5e}", radius * radius * c)).join(",")));
        format!("[{}]", rows.join(","))
    };
    let node = |name: &str, at: Option<[f64; D]>, truth: Option<[f64; D]>, held: bool, covariance: Option<_>| {
        let at = at.filter(|p| layout.shows(p))?;
        // Numbers of JSON are finite.
        let truth = truth.filter(|p| p.iter().all(|x| x.is_finite()));
        let truth = truth.map_or_else(String::new, |p| format!(",\"truth\":{}", point(p)));
        let held = if held { ",\"held\":true" } else { "" };
        let covariance =
            covariance.filter(|c: &[[f64; D]; D]| radius > 0.0 && c.iter().flatten().all(|x| x.is_finite()));
        let ellipsoid = covariance.map_or_else(String::new, |c| format!(",\"ellipsoid\":{}", matrix(&c)));
        Some(format!("{{\"name\":{},\"at\":{}{truth}{held}{ellipsoid}}}", quoted(name), point(at)))
    };
    let truth = calibration.truth.as_ref();
    let known = |i: usize| truth.and_then(|truth| *truth.positions.get(i)?);
    let known_transmitter = |j: usize| truth.and_then(|truth| *truth.transmitter_positions.get(j)?);
    let held = |i: usize| calibration.anchored.get(i) == Some(&true);
    let [of_receivers, of_transmitters] = calibration.trusted_covariances();
    let of = |all: &[Option<[[f64; D]; D]>], k: usize| all.get(k).copied().flatten();
    let receivers = calibration.receiver_names.iter().zip(&calibration.receivers).enumerate();
    let receivers = receivers.filter_map(|(i, (name, at))| node(name, *at, known(i), held(i), of(of_receivers, i)));
    let transmitters = calibration.transmitter_names.iter().zip(&calibration.transmitters).enumerate();
    let transmitters =
        transmitters.filter_map(|(j, (name, at))| node(name, *at, known_transmitter(j), false, of(of_transmitters, j)));
    let [receivers, transmitters] = [receivers.collect::<Vec<_>>(), transmitters.collect()];
    format!("{{\"receivers\":[{}],\n\"transmitters\":[{}]}}", receivers.join(",\n"), transmitters.join(",\n"))
}

/// A JSON string without characters that mean something in HTML: `</script>` would end the data.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            '<' | '>' | '&' | '\'' | '\u{2028}' | '\u{2029}' => quoted += &format!("\\u{:04x}", u32::from(c)),
            c if c.is_control() => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};
    use serde_json::Value;

    #[test]
    fn any_name_is_read_back_and_none_ends_the_data() {
        for name in ["</script><script>alert(1)</script>", "<!--", "a\"b\\c\n\t\u{7f}\u{2028}", "Bjørn & 声 😀", ""]
        {
            let text = quoted(name);
            assert_eq!(serde_json::from_str::<String>(&text).unwrap(), name);
            assert!(!text.contains(['<', '>', '&', '\n', '\u{2028}']), "{text}");
        }
    }

    #[test]
    fn data_has_the_nodes_that_the_picture_shows() {
        let simulation = simulate(&SimulateOptions::<3> { noise: 0.01, ..SimulateOptions::new() }).unwrap();
        let mut calibration = calibrate(&simulation.pseudoranges, &CalibrateOptions::<3>::new()).unwrap();
        let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
        calibration.compare(&truth);
        calibration.receiver_names[2] = "</script>".to_string();
        calibration.receivers[0] = Some([1.0, -2.5, 0.25]);
        calibration.receivers[1] = None;
        calibration.anchored[3] = true;
        // A sphere whose radius is the one of the confidence region.
        calibration.receiver_covariance[0] = Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        calibration.receiver_covariance[2] = None;
        calibration.systematic = None;
        calibration.transmitters[4] = Some([1e6, 0.0, 0.0]);
        calibration.transmitters[5] = Some([f64::NAN, 0.0, f64::INFINITY]);
        if let Some(truth) = &mut calibration.truth {
            truth.positions[4] = None;
        }
        let scene = Scene::of(&calibration);
        let layout = Layout::of(&scene);
        let data: Value = serde_json::from_str(&data(&calibration, &scene, &layout)).unwrap();
        let receivers = data["receivers"].as_array().unwrap();
        assert_eq!((receivers.len(), data["transmitters"].as_array().unwrap().len()), (7, 10));
        assert_eq!(receivers[0]["at"], serde_json::json!([1.0, -2.5, 0.25]));
        assert_eq!(receivers[1]["name"], "</script>");
        assert_eq!((&receivers[2]["held"], &receivers[1]["held"]), (&Value::Bool(true), &Value::Null));
        let square = (layout.magnified * calibration.ellipse_radius.unwrap()).powi(2);
        let sphere = |i: usize, k: usize| receivers[0]["ellipsoid"][i][k].as_f64().unwrap() / square;
        assert!((0..9).all(|k| (sphere(k / 3, k % 3) - f64::from(k % 4 == 0)).abs() < 1e-4), "{}", receivers[0]);
        assert_eq!(receivers[1]["ellipsoid"], Value::Null);
        assert!(receivers[2]["truth"].is_array() && receivers[3]["truth"].is_null());
    }
}
