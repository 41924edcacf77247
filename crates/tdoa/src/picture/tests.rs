use super::*;
use crate::minimal::NodeKind;
use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

#[test]
fn shows_every_node_and_escapes_names() {
    let mut options = SimulateOptions { noise: 0.01, outliers: 0.02, ..Default::default() };
    options.missing = 0.02;
    let simulation = simulate(&options).unwrap();
    let names = |kind: &str, count: usize| (0..count).map(|k| format!("{kind}<{k}&\"")).collect();
    let measured = simulation.pseudoranges.with_names(names("r", 8), names("s", 12)).unwrap();
    let mut calibration = calibrate(&measured, &CalibrateOptions::default()).unwrap();
    let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
    calibration.compare(&truth);
    let svg = picture(&calibration);
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    for name in ["r&lt;0&amp;&quot;", "r&lt;7&amp;&quot;", "s&lt;11&amp;&quot;", "true position"] {
        assert!(svg.contains(name), "{name}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    // Eight receivers and one in the legend; twelve transmitters and one.
    assert_eq!(svg.matches("class=\"receiver\"").count(), 9);
    assert_eq!(svg.matches("class=\"transmitter\"").count(), 13);
    assert_eq!(svg.matches("class=\"truth\"").count(), 9);
    assert!(!svg.contains("class=\"anchor\""));
}

#[test]
fn small_ellipses_are_magnified_by_a_stated_number() {
    for (noise, least) in [(1e-4, 100.0), (0.01, 2.0), (0.5, 1.0)] {
        let simulation = simulate(&SimulateOptions { noise, ..Default::default() }).unwrap();
        let calibration = calibrate(&simulation.pseudoranges, &CalibrateOptions::default()).unwrap();
        let (factor, svg) = (ellipse_magnification(&calibration), picture(&calibration));
        assert!(factor >= least && (least > 1.0 || factor == 1.0), "{noise}: {factor}");
        let stated = format!("receiver, with 95 % ellipse, {factor} times as large");
        assert_eq!(svg.contains(&stated), factor > 1.0, "{noise}");
        // Half of the ellipses are larger than the triangles of 6 pixels.
        let radii = svg.split("rx=\"").skip(1).filter_map(|rest| rest.split('"').next()?.parse::<f64>().ok());
        let mut radii: Vec<f64> = radii.collect();
        radii.sort_by(f64::total_cmp);
        assert!(radii[radii.len() / 2] > 6.0, "{noise}: {radii:?}");
    }
}

#[test]
fn marks_anchors_and_true_transmitters() {
    let simulation = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
    let known: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
    let mut options = CalibrateOptions { anchors: known.clone(), ..Default::default() };
    options.anchors[3..].fill(None);
    let mut calibration = calibrate(&simulation.pseudoranges, &options).unwrap();
    let mut transmitters: Vec<_> = simulation.network.transmitters.iter().copied().map(Some).collect();
    transmitters[5] = None;
    calibration.compare_all(&known, &transmitters);
    assert!(calibration.truth.as_ref().unwrap().transmitter_median.unwrap() < 0.1);
    let svg = picture(&calibration);
    // Three anchors and one in the legend; eight receivers, eleven transmitters and the legend.
    assert_eq!(svg.matches("class=\"anchor\"").count(), 4);
    assert_eq!(svg.matches("class=\"truth\"").count(), 20);
}

fn in_space() -> Calibration<3> {
    let simulation = simulate(&SimulateOptions::<3> { noise: 0.01, ..SimulateOptions::new() }).unwrap();
    let names = |kind: &str, count: usize| (0..count).map(|k| format!("{kind}<{k}&\"")).collect();
    let measured = simulation.pseudoranges.with_names(names("r", 8), names("s", 12)).unwrap();
    let mut calibration = calibrate(&measured, &CalibrateOptions::<3>::new()).unwrap();
    let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
    calibration.compare(&truth);
    calibration
}

#[test]
fn three_views_show_every_node_in_space() {
    let mut calibration = in_space();
    calibration.anchored[4] = true;
    let svg = picture(&calibration);
    // Each of the eight receivers and twelve transmitters in all views, and one in the legend.
    assert_eq!(svg.matches("class=\"receiver\"").count(), 25);
    assert_eq!(svg.matches("class=\"transmitter\"").count(), 37);
    assert_eq!(svg.matches("class=\"truth\"").count(), 25);
    assert_eq!(svg.matches("class=\"anchor\"").count(), 4);
    assert_eq!(svg.matches("r&lt;7&amp;&quot;<").count(), 3);
    for once in ["from above", "from the front", "from the side", "shadow of the 95 % ellipsoid"] {
        assert_eq!(svg.matches(once).count(), 1, "{once}");
    }
    for axis in [">x (m)<", ">y (m)<", ">z (m)<"] {
        assert_eq!(svg.matches(axis).count(), 2, "{axis}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("r<7"));
}

/// The numbers of an attribute, of all elements that contain a text, up to the end of the attribute.
fn numbers(svg: &str, element: &str, attribute: &str) -> Vec<Vec<f64>> {
    let lines = svg.lines().filter(|line| line.contains(element));
    let values = lines.filter_map(|line| line.split_once(attribute)?.1.split('"').next());
    let split = |text: &str| text.split(|c: char| !"-.0123456789".contains(c)).filter_map(|n| n.parse().ok()).collect();
    values.map(split).collect()
}

#[test]
fn ellipses_in_space_are_shadows_of_ellipsoids() {
    let mut calibration = in_space();
    calibration.truth = None;
    calibration.transmitters.fill(None);
    calibration.receiver_covariance.fill(None);
    calibration.receivers.fill(None);
    calibration.receivers[0] = Some([0.0, 0.0, 0.0]);
    calibration.receivers[1] = Some([10.0, 4.0, 2.0]);
    // Seen from above, eigenvalues 8 and 2 along the diagonals; from the front and the side, 5 and 1 along the axes.
    calibration.receiver_covariance[0] = Some([[5.0, 3.0, 0.0], [3.0, 5.0, 0.0], [0.0, 0.0, 1.0]]);
    calibration.ellipse_radius = Some(0.5);
    let svg = picture(&calibration);
    assert!(!svg.contains("times as large"));
    // Two receivers a view, and the legend.
    let at = receivers(&svg);
    let [above, front, side] = [0, 2, 4].map(|k| [at[k], at[k + 1]]);
    let scale = (above[1][0] - above[0][0]) / 10.0;
    let near = |a: f64, b: f64| (a - b).abs() < 0.02;
    // One scale.
    assert!(near(above[0][1] - above[1][1], 4.0 * scale) && near(front[0][1] - front[1][1], 2.0 * scale));
    assert!(near(side[1][0] - side[0][0], 4.0 * scale));
    // What is in two views is on one line.
    assert!((0..2).all(|k| near(above[k][0], front[k][0]) && near(front[k][1], side[k][1])));
    assert!(above[0][1] < front[1][1] && front[1][0] < side[0][0]);
    // Semi-axes and their directions; y is downwards in SVG.
    let places = numbers(&svg, "<ellipse", "transform=\"");
    let radii = [numbers(&svg, "<ellipse", " rx=\""), numbers(&svg, "<ellipse", " ry=\"")];
    assert_eq!(places.len(), 4);
    let expected = [(above, [8.0, 2.0, -45.0]), (front, [5.0, 1.0, 0.0]), (side, [5.0, 1.0, 0.0])];
    for (k, (view, [long, short, angle])) in expected.into_iter().enumerate() {
        let [long, short] = [long, short].map(|variance: f64| 0.5 * variance.sqrt() * scale);
        assert!(near(radii[0][k][0], long) && near(radii[1][k][0], short) && places[k][2] == angle, "{places:?}");
        assert!(near(places[k][0], view[0][0]) && near(places[k][1], view[0][1]));
    }
}

#[test]
fn mirror_images_are_hollow() {
    let mut calibration = in_space();
    assert!(!picture(&calibration).contains("mirror"));
    let image = |node: &str, kind, position| crate::MirrorImage {
        node: node.to_string(),
        kind,
        position,
        distance_from_plane: 1.0,
        log_likelihood_loss: 0.0,
    };
    let near = calibration.receivers[0].unwrap();
    calibration.mirror_images = vec![
        image("s", NodeKind::Transmitters, near),
        image("r", NodeKind::Receivers, near),
        image("s", NodeKind::Transmitters, [1e9, f64::NAN, 0.0]),
    ];
    let svg = picture(&calibration);
    // Two in all views, and one in the legend; the one that is nowhere is left out.
    assert_eq!(svg.matches("class=\"mirror\"").count(), 7);
    assert!(svg.contains("mirror image that fits as well") && !svg.contains("NaN"));
}

#[test]
fn pictures_of_little_or_nothing_in_space() {
    let mut calibration = in_space();
    calibration.truth = None;
    for kept in [[Some([1.0, 2.0, 3.0]), None], [Some([1.0, 2.0, 3.0]), Some([1e9, 2.0, 3.0])], [None, None]] {
        calibration.receivers.fill(None);
        calibration.receivers[..2].copy_from_slice(&kept);
        calibration.transmitters.fill(None);
        let svg = picture(&calibration);
        assert_eq!(svg.matches("class=\"receiver\"").count(), 1 + 3 * kept.iter().flatten().count());
        assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.len() < 100_000);
    }
}

/// The middle of the marker of each receiver, in pixels. The one in the legend is the last.
fn receivers(svg: &str) -> Vec<[f64; 2]> {
    // A marker is drawn from six pixels above its point.
    numbers(svg, "class=\"receiver\"", " d=\"M").iter().map(|m| [m[0], m[1] + 6.0]).collect()
}

/// The texts that are numbers of an axis: where they stand, and the number.
fn ticks(svg: &str, anchor: &str) -> Vec<([f64; 2], f64)> {
    let kind = format!("text-anchor=\"{anchor}\" font-size=\"11\" fill=\"#222\"");
    let lines = svg.lines().filter(|line| line.contains(&kind));
    let tick = |line: &str| {
        let number = line.split_once('>')?.1.split('<').next()?.parse().ok()?;
        let [x, y] = ["<text x=\"", "y=\""].map(|at| numbers(line, at, at)[0][0]);
        Some(([x, y], number))
    };
    lines.filter_map(tick).collect()
}

#[test]
fn the_axes_of_the_plane_are_in_metres() {
    let mut calibration: Calibration = serde_json::from_str(include_str!("plane.json")).unwrap();
    calibration.receivers.fill(None);
    calibration.receivers[..2].copy_from_slice(&[Some([-3.0, 1.0]), Some([9.0, 7.0])]);
    calibration.transmitters.fill(None);
    calibration.truth = None;
    let svg = picture(&calibration);
    let [first, second] = [0, 1].map(|k| receivers(&svg)[k]);
    let scale = (second[0] - first[0]) / 12.0;
    assert!((first[1] - second[1] - 6.0 * scale).abs() < 0.02, "one scale");
    for name in [">x (m)<", ">y (m)<"] {
        assert_eq!(svg.matches(name).count(), 1, "{name}");
    }
    // The histogram below has numbers too.
    let right = ticks(&svg, "middle").into_iter().filter(|([_, y], _)| *y < 680.0);
    let right: Vec<f64> = right.map(|([x, _], metres)| (x - first[0]) / scale - 3.0 - metres).collect();
    let up = ticks(&svg, "end").into_iter().map(|([_, y], metres)| (first[1] + 4.0 - y) / scale + 1.0 - metres);
    let up: Vec<f64> = up.collect();
    assert!(right.len() > 3 && up.len() > 3, "{right:?} {up:?}");
    assert!(right.iter().chain(&up).all(|off| off.abs() < 1e-3), "{right:?} {up:?}");
}

/// A rectangle by its corners.
fn rectangle(line: &str) -> [f64; 4] {
    let [x, y, width, height] = [" x=\"", " y=\"", " width=\"", " height=\""].map(|at| numbers(line, at, at)[0][0]);
    [x, y, x + width, y + height]
}

/// The ellipses of the views, each with the box that cuts it: left, top, right, bottom.
fn ellipses(svg: &str) -> Vec<([f64; 4], [f64; 4])> {
    let (mut cut, mut found) = (None, Vec::new());
    for line in svg.lines() {
        if line.contains("<clipPath") {
            cut = Some(rectangle(line));
        } else if line == "</g>" {
            cut = None;
        } else if line.contains("<ellipse")
            && let Some(cut) = cut
        {
            let [place, rx, ry] = [" transform=\"", " rx=\"", " ry=\""].map(|at| numbers(line, at, at).remove(0));
            // The extent of a turned ellipse.
            let (s, c) = place[2].to_radians().sin_cos();
            let (dx, dy) = ((rx[0] * c).hypot(ry[0] * s), (rx[0] * s).hypot(ry[0] * c));
            found.push((cut, [place[0] - dx, place[1] - dy, place[0] + dx, place[1] + dy]));
        }
    }
    found
}

/// Whether an ellipse lies in its box, whose edges are whole pixels.
fn is_whole((cut, ellipse): &([f64; 4], [f64; 4])) -> bool {
    (0..2).all(|k| cut[k] <= ellipse[k] + 0.51 && ellipse[k + 2] <= cut[k + 2] + 0.51)
}

#[test]
fn the_view_grows_to_hold_ellipses() {
    let mut calibration = in_space();
    let svg = picture(&calibration);
    assert!(ellipses(&svg).len() >= 60 && ellipses(&svg).iter().all(is_whole));
    // One as large as half the network, at its edge, in each direction.
    let size = calibration.extent().unwrap();
    let wide = (0.2 * size / calibration.ellipse_radius.unwrap()).powi(2);
    let mut plane: Calibration = serde_json::from_str(include_str!("plane.json")).unwrap();
    let across = plane.extent().unwrap();
    let long = (0.2 * across / plane.ellipse_radius.unwrap()).powi(2);
    plane.receiver_covariance.fill(Some([[long, 0.5 * long], [0.5 * long, long]]));
    calibration.receiver_covariance.fill(Some([[wide, 0.0, 0.0], [0.0, wide, 0.0], [0.0, 0.0, wide]]));
    (calibration.systematic, plane.systematic) = (None, None);
    for svg in [picture(&calibration), picture(&plane)] {
        assert!(ellipses(&svg).iter().all(is_whole) && !svg.contains("cut at the edge"));
    }
}

#[test]
fn ellipses_larger_than_the_network_are_said_to_be_cut() {
    let mut calibration: Calibration = serde_json::from_str(include_str!("plane.json")).unwrap();
    calibration.systematic = None;
    let huge = |times: f64| {
        let deviation = times * calibration.extent().unwrap() / calibration.ellipse_radius.unwrap();
        Some([[deviation * deviation, 0.0], [0.0, 1e-6]])
    };
    let (twice, hundredfold) = (huge(2.0), huge(100.0));
    let located = calibration.receivers.iter().position(Option::is_some).unwrap();
    calibration.receiver_covariance[located] = twice;
    let svg = picture(&calibration);
    assert_eq!(ellipses(&svg).iter().filter(|ellipse| !is_whole(ellipse)).count(), 1);
    assert!(svg.contains("1 ellipse larger than the network, cut at the edge") && !svg.contains("not drawn"));
    calibration.receiver_covariance[located] = hundredfold;
    let svg = picture(&calibration);
    assert!(ellipses(&svg).iter().all(is_whole));
    assert!(svg.contains("1 ellipse larger than the picture, not drawn") && !svg.contains("cut at the edge"));
}

/// Whether two boxes have an area in common.
fn meet(a: &[f64; 4], b: &[f64; 4]) -> bool {
    (0..2).all(|k| a[k] < b[k + 2] && b[k] < a[k + 2])
}

/// The boxes of all marks, legend included: left, top, right, bottom.
fn marks(svg: &str) -> Vec<[f64; 4]> {
    let about = |[x, y]: [f64; 2], half: f64| [x - half, y - half, x + half, y + half];
    let mut found: Vec<[f64; 4]> = receivers(svg).into_iter().map(|at| about(at, 5.0)).collect();
    for line in svg.lines() {
        let at = |attribute: &str| numbers(line, attribute, attribute)[0][0];
        if line.starts_with("<circle") {
            found.push(about([at(" cx=\""), at(" cy=\"")], at(" r=\"")));
        } else if line.starts_with("<rect class=\"anchor\"") {
            found.push(about([at(" x=\"") + 9.0, at(" y=\"") + 9.0], 9.0));
        } else if line.starts_with("<path class=\"truth\"") {
            found.push(about([at(" d=\"M") + 5.0, numbers(line, " d=\"", " d=\"M")[0][1]], 5.0));
        }
    }
    found
}

#[test]
fn names_stay_free_of_marks_and_of_each_other() {
    let mut space = in_space();
    space.anchored.fill(true);
    let mut plane: Calibration = serde_json::from_str(include_str!("plane.json")).unwrap();
    // Two rows of nodes as close together as their marks.
    let reach = plane.extent().unwrap();
    let near = |k: usize, y: f64| Some([0.04 * reach * k as f64, y]);
    plane.receivers.iter_mut().enumerate().for_each(|(k, p)| *p = near(k, 0.0));
    plane.transmitters.iter_mut().enumerate().for_each(|(k, p)| *p = near(k, 0.03 * reach));
    plane.truth = None;
    for (svg, least) in [(picture(&space), 3 * 20), (picture(&plane), 13)] {
        let mut names: Vec<[f64; 4]> = Vec::new();
        for line in svg.lines().filter(|line| line.starts_with("<text class=\"name\"")) {
            let [x, y] = [" x=\"", " y=\""].map(|at| numbers(line, at, at)[0][0]);
            let text = line.split_once('>').unwrap().1.split('<').next().unwrap();
            // An escaped letter is one letter, here about five pixels wide.
            let text = text.replace("&lt;", "<").replace("&amp;", "&").replace("&quot;", "\"");
            let width = 5.0 * text.len() as f64;
            let left = match line.split_once("text-anchor=\"").unwrap().1.split('"').next().unwrap() {
                "end" => x - width,
                "middle" => x - 0.5 * width,
                _ => x,
            };
            names.push([left, y - 8.0, left + width, y]);
        }
        assert_eq!(names.len(), least);
        for (k, name) in names.iter().enumerate() {
            assert!(!marks(&svg).iter().any(|mark| meet(name, mark)), "{name:?}");
            assert!(!names[..k].iter().any(|other| meet(name, other)), "{name:?}");
        }
    }
}

#[test]
fn flat_and_slender_networks_fill_a_picture_that_holds_everything() {
    let mut calibration = in_space();
    calibration.truth = None;
    calibration.receiver_covariance.fill(None);
    calibration.transmitter_covariance.fill(None);
    for [x, y, z] in [[50.0, 2.0, 3.0], [2.0, 50.0, 0.0], [1.0, 1.0, 80.0], [10.0, 8.0, 3.0], [0.0, 7.0, 0.0]] {
        for (k, p) in calibration.receivers.iter_mut().chain(&mut calibration.transmitters).enumerate() {
            let corner = |bit: usize, length: f64| if k >> bit & 1 == 1 { length } else { 0.0 };
            *p = Some([corner(0, x), corner(1, y), corner(2, z)]);
        }
        let svg = picture(&calibration);
        let [width, height] = numbers(&svg, "<svg", "viewBox=\"0 0 ")[0][..] else { panic!("size") };
        let shown = |[left, top, right, bottom]: [f64; 4]| left > 0.0 && top > 0.0 && right < width && bottom < height;
        assert!(marks(&svg).into_iter().all(shown) && marks(&svg).len() == 3 * 20 + 2, "{x} {y} {z}");
        // Neither views nor the words of the legend overlap.
        let outlines: Vec<[f64; 4]> = svg.lines().filter(|line| line.contains("<clipPath")).map(rectangle).collect();
        let words: Vec<[f64; 4]> = svg
            .lines()
            .filter(|line| line.contains("font-size=\"12\"") && line.contains("\"start\""))
            .map(|line| {
                let [x, y] = [" x=\"", " y=\""].map(|at| numbers(line, at, at)[0][0]);
                let letters = line.split_once('>').unwrap().1.split('<').next().unwrap().len();
                [x, y - 9.0, x + 5.0 * letters as f64, y]
            })
            .collect();
        // Three views, each with two numbers at least on its upward axis; the words of the legend.
        assert!(ticks(&svg, "end").len() >= 6, "{x} {y} {z}");
        assert!(outlines.len() == 3 && words.len() >= 4);
        let boxes: Vec<[f64; 4]> = outlines.into_iter().chain(words).collect();
        for (k, one) in boxes.iter().enumerate() {
            assert!(shown(*one) && !boxes[..k].iter().any(|other| meet(one, other)), "{x} {y} {z}: {one:?}");
        }
    }
}
